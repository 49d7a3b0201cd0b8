/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * @file probe.h
 * The contacts of probes as ProbeInterface describes them, and where a pose puts them.
 */
#ifndef CONUS_PUBLIC_PROBE_H
#define CONUS_PUBLIC_PROBE_H

#include <conus/pose_file.h>

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct conus_probe conus_probe; /**< The probes of a file of ProbeInterface or of a recording. Immutable. */

/** How conus_probe_load() reads. */
typedef struct conus_probe_options {
    size_t struct_size;  /**< Its size, as #CONUS_PROBE_OPTIONS_INIT sets it; 0 = that of this version. */
    double tip;          /**< mm from the tip of each probe to its lowest contact, up to 1000, in place of its contour;
                            0 = by the contour, which it then must have. Of a recording to the lowest row of the probe,
                            recorded or not; 0 = by its part number. */
    uint64_t max_memory; /**< Largest file, bytes; 0 = 1 GiB. */
} conus_probe_options;

/** The defaults, and the size of the struct that the caller was compiled with. */
#define CONUS_PROBE_OPTIONS_INIT CONUS_INIT_(conus_probe_options)

/** A contact. */
typedef struct conus_probe_contact {
    const char *id;    /**< Its contact_id, that of no other in the file: "0", "1" and so on where the file has none. In
                          a file of several probes the name of its probe and a colon stand before it: "probe2:e7". */
    const char *shank; /**< Its shank_id; "" where the file has none. */
    const char *probe; /**< Name of its probe: "probe1", "probe2", in the order of the file. */
    size_t index;      /**< Index of its probe. */
    int64_t channel; /**< The trace that it is recorded on, from 0; -1 = it is not wired, -2 = the file does not say. */
    double position[3]; /**< As in the file, micrometres; the third is NaN of a probe in two dimensions. */
    double offset[3]; /**< mm from the probe's tip in the device's frame (Eq. 2): +x as the probe's x axis, +z along the
                         shank, away from the tip. */
} conus_probe_contact;

/**
 * Loads a file of ProbeInterface, or the probes of a recording: SpikeGLX's .ap.meta or .imro, Open Ephys's settings.xml
 * (docs/formats.md).
 * @param[out] out The probes; end them with conus_probe_destroy().
 * @param path A file.
 * @param options NULL = defaults.
 * @return #CONUS_OK; #CONUS_ERROR_IO or #CONUS_ERROR_DATA for a file that cannot be read, contradicts itself or has no
 * contour, where that is needed; #CONUS_ERROR_ARGUMENT for a tip out of its range; #CONUS_ERROR_MEMORY above
 * max_memory.
 * @threads Any.
 * @since 0.1
 */
CONUS_CHECKED conus_status conus_probe_load(conus_probe **out, const char *path, const conus_probe_options *options);

/**
 * Ends the probes.
 * @param probe NULL is allowed.
 * @threads One at a time for each @p probe.
 * @since 0.1
 */
CONUS_API void conus_probe_destroy(conus_probe *probe);

/**
 * Counts the probes.
 * @param probe NULL counts 0.
 * @return How many the file has.
 * @threads Any: the object does not change.
 * @since 0.1
 */
CONUS_API size_t conus_probe_count(const conus_probe *probe);

/**
 * Counts the contacts of all probes, in the order of the file.
 * @param probe NULL counts 0.
 * @return How many there are.
 * @threads Any: the object does not change.
 * @since 0.1
 */
CONUS_API size_t conus_probe_contact_count(const conus_probe *probe);

/**
 * Gives contact @p index.
 * @param probe The probes.
 * @param index From 0.
 * @return NULL past the last. Borrowed from the probes.
 * @threads Any: the object does not change.
 * @since 0.1
 */
CONUS_API const conus_probe_contact *conus_probe_at(const conus_probe *probe, size_t index);

/**
 * Gives the tip of a probe: the lowest point of its contour, in the middle of an edge that is as low; of several that
 * are as low, shanks side by side, that of the least x.
 * @param[out] out As in the file, micrometres; the third is NaN of a probe in two dimensions. Unchanged for another
 * index.
 * @param probe The probes.
 * @param index Index of the probe, from 0.
 * @threads Any: the object does not change.
 * @since 0.1
 */
CONUS_API void conus_probe_tip(double out[3], const conus_probe *probe, size_t index);

/**
 * Makes several of the one probe of a file, as if the file had them: insertions of one kind.
 * @param[out] out The probes, with these names; end them with conus_probe_destroy().
 * @param probe Of one probe.
 * @param names [count] None twice. Copied.
 * @param count From 1 to 1024.
 * @return #CONUS_OK; #CONUS_ERROR_ARGUMENT for several probes, another count, a name that is there twice, and one that
 * with that of a contact has more than 255 bytes.
 * @threads Any.
 * @since 0.1
 */
CONUS_CHECKED conus_status conus_probe_repeat(conus_probe **out, const conus_probe *probe, const char *const *names,
                                              size_t count);

/**
 * Puts the contacts where poses say: the tip at the pose's position, the shank along its axis, from base to tip, and
 * the probe's x axis along the device's +x.
 * @param[out] out A point for each contact, with its id; its line is its number from 1. End it with
 * conus_pose_list_destroy().
 * @param probe The probes.
 * @param poses [count] One for each probe.
 * @param count As many as there are probes.
 * @param roll Turns each probe about its axis, its +y towards its +x, radians: as conus_candidates.roll_step.
 * @return #CONUS_OK; #CONUS_ERROR_ARGUMENT for another number of poses, and for a turn or a pose that is not finite.
 * @threads Any.
 * @since 0.1
 */
CONUS_CHECKED conus_status conus_probe_place(conus_pose_list **out, const conus_probe *probe, const conus_pose *poses,
                                             size_t count, double roll);

#ifdef __cplusplus
}
#endif

#endif
