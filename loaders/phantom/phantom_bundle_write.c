/* SPDX-License-Identifier: BSD-3-Clause */
/* The bundle phantom: rings of straight lines and of helices round the z axis, as an MRtrix file, with the truth. */
#include "loaders/phantom/phantom_bundle_write.h"

#include "base/buffer.h"
#include "base/files/file.h"
#include "conus/conus.h"

#include <math.h>
#include <string.h>

/* Ring i of radius i mm has straight lines where i is odd, helices of one turn where it is even, all from z = -HALF to
 * HALF mm in SEGMENTS steps. */
enum { RINGS = 12, PER_RING = 12, SEGMENTS = 60, HALF = 30 };

static const double turn = 6.283185307179586;

static bool is_helix(int ring)
{
    return ring % 2 == 0;
}

/* Of the polyline: chords of a helix, each of which rises by 2 HALF / SEGMENTS. */
static double length_of(int ring)
{
    double rise = 2.0 * HALF / SEGMENTS;
    double chord = is_helix(ring) ? 2.0 * ring * sin(turn / (2 * SEGMENTS)) : 0;
    return SEGMENTS * sqrt(rise * rise + chord * chord);
}

static void append_float(struct buffer *out, double value)
{
    uint8_t bytes[4];
    uint32_t bits;
    float rounded = (float)value;
    memcpy(&bits, &rounded, sizeof bits);
    for (int i = 0; i < 4; i++) {
        bytes[i] = (uint8_t)(bits >> 8 * i);
    }
    buffer_append(out, bytes, sizeof bytes);
}

static void append_end(struct buffer *out, double value)
{
    for (int i = 0; i < 3; i++) {
        append_float(out, value);
    }
}

static void append_streamline(struct buffer *out, int ring, int number)
{
    for (int i = 0; i <= SEGMENTS; i++) {
        double turns = (double)number / PER_RING + (is_helix(ring) ? (double)i / SEGMENTS : 0);
        append_float(out, ring * cos(turn * turns));
        append_float(out, ring * sin(turn * turns));
        append_float(out, -HALF + i * 2.0 * HALF / SEGMENTS);
    }
    append_end(out, (double)NAN);
}

static void append_tractogram(struct buffer *out)
{
    enum { DATA_AT = 128 };
    static const char zeros[DATA_AT];
    buffer_format(out, "mrtrix tracks\ncomment: synthetic: conus phantom bundle\ndatatype: Float32LE\ncount: %d\n",
                  RINGS * PER_RING);
    buffer_format(out, "file: . %d\nEND\n", DATA_AT);
    buffer_append(out, zeros, out->size < DATA_AT ? DATA_AT - out->size : 0);
    for (int ring = 1; ring <= RINGS; ring++) {
        for (int number = 0; number < PER_RING; number++) {
            append_streamline(out, ring, number);
        }
    }
    append_end(out, (double)INFINITY);
}

static void append_truth(struct buffer *out)
{
    double total = 0;
    for (int ring = 1; ring <= RINGS; ring++) {
        total += PER_RING * length_of(ring);
    }
    buffer_format(out, "{\n  \"phantom\": \"bundle\",\n  \"conus\": \"%s\",\n  \"space\": \"RAS+, mm\",\n",
                  conus_version());
    buffer_format(out, "  \"streamlines\": %d,\n  \"points\": %d,\n  \"length_mm\": ", RINGS * PER_RING,
                  RINGS * PER_RING * (SEGMENTS + 1));
    buffer_number(out, total);
    buffer_format(out, ",\n  \"z\": [%d, %d],\n  \"segments\": %d,\n  \"rings\": [\n", -HALF, HALF, SEGMENTS);
    for (int ring = 1; ring <= RINGS; ring++) {
        buffer_format(out, "    {\"shape\": \"%s\", \"radius\": %d, \"turns\": %d, \"count\": %d, \"length_mm\": ",
                      is_helix(ring) ? "helix" : "line", ring, is_helix(ring), PER_RING);
        buffer_number(out, length_of(ring));
        buffer_text(out, ring < RINGS ? "},\n" : "}\n");
    }
    buffer_text(out, "  ]\n}\n");
}

static void append_manifest(struct buffer *out)
{
    buffer_text(out, "{\n  \"conus_atlas\": 1,\n  \"comment\": \"synthetic: conus phantom bundle\",\n"
                     "  \"streamlines\": [{\"file\": \"bundle.tck\", \"name\": \"Bundle\"}]\n}\n");
}

conus_status phantom_bundle_write(const char *folder)
{
    static const struct {
        const char *name;
        void (*append)(struct buffer *out);
    } files[] = {
        {"bundle.tck", append_tractogram}, {"bundle.json", append_truth}, {"bundle.atlas.json", append_manifest}};
    conus_status status = CONUS_OK;
    for (size_t i = 0; i < sizeof files / sizeof files[0] && !status; i++) {
        struct buffer content = {0};
        files[i].append(&content);
        status = file_write_in(folder, files[i].name, &content); /* which looks at the buffer's status */
        buffer_finish(&content);
    }
    return status;
}
