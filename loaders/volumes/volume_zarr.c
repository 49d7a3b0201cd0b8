/* SPDX-License-Identifier: BSD-3-Clause */
/* Finds the group and the level, and places the array. */
#include "loaders/volumes/volumes.h"

#include "atlas/space.h"
#include "base/files/file.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "loaders/volumes/parts.h"
#include "loaders/zarr/zarr.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum {
    SPACE = 3,
    ABOVE = 3 /* folders above an array that may be its group */
};

/* A store while its array is looked for. */
struct search {
    struct job *job;
    const struct volume_input *v;
    const char *folder; /* of the group, or of the array that was given, without '/' at its end */
    struct text group;  /* the group's metadata; none where there is no group */
    struct text array;  /* the array's */
    struct ome *ome;    /* the job's */
    const struct ome_level *level;
};

/* Reads the first of the files in the folder that is there, one of at most 16 MiB. */
static struct text read_metadata(struct job *job, const char *folder, const char *const names[2])
{
    for (size_t i = 0; i < 2; i++) {
        const char *path = job_format(job, "%s/%s", folder, names[i]);
        if (job_has_file(job, path)) {
            struct bytes bytes = {0};
            if (JOB_CALL(job, file_read(&bytes, path, ZARR_JSON_LIMIT)) && job_adopt(job, bytes.data)) {
                job_made_of(job, path, &bytes);
            }
            return job_ok(job) ? text_from_bytes(bytes.data, bytes.size) : (struct text){0};
        }
    }
    return (struct text){0};
}

static const char *const array_files[2] = {"zarr.json", ".zarray"};
static const char *const group_files[2] = {"zarr.json", ".zattrs"};

static bool is_array(struct text text)
{
    return text_mentions(text, "\"data_type\"") || text_mentions(text, "\"dtype\"");
}

static size_t find_size(const struct ome *ome, const double micrometres[SPACE])
{
    for (size_t i = 0; i < ome->count; i++) {
        bool same = true;
        for (size_t axis = 0; axis < SPACE; axis++) {
            double wanted = micrometres[axis] / 1000;
            same = same && fabs(ome->levels[i].scale[axis] - wanted) <= 1e-5 * wanted;
        }
        if (same) {
            return i;
        }
    }
    return ome->count;
}

/* Chooses the level of a group: by number, by the size of its voxels, or else the first. NULL after a failure. */
static const struct ome_level *choose_level(struct search *search)
{
    const struct ome *ome = search->ome;
    const double *size = search->v->place.resolution;
    const double *scale = ome->count ? ome->levels[0].scale : NULL;
    const bool is_numbered = search->v->keys.given & KEY_BIT(KEY_LEVEL);
    const size_t level = is_numbered ? (size_t)keys_value(&search->v->keys, KEY_LEVEL)->numbers[0]
                         : size[0] > 0 && scale && scale[0] > 0 ? find_size(ome, size)
                                                                : 0;
    if (level < ome->count) {
        return &ome->levels[level];
    }
    if (is_numbered) {
        job_fail(search->job, CONUS_ERROR_ARGUMENT, "level: found %zu, allowed are 0 to %zu", level, ome->count - 1);
    } else if (scale) {
        job_fail(search->job, CONUS_ERROR_ARGUMENT,
                 "resolution: no level has voxels of %g x %g x %g micrometres, level 0 of %zu has %g x %g x %g",
                 size[0], size[1], size[2], ome->count, 1000 * scale[0], 1000 * scale[1], 1000 * scale[2]);
    }
    return NULL;
}

/* Reads the group in the folder that `length` bytes of the given one name, if it is an image, and finds the level whose
 * path is the rest. Another group says nothing of the array's place. */
static void look_into(struct search *search, size_t length)
{
    struct job *job = search->job;
    const char *rest = search->folder + length + (length > 0);
    search->group =
        read_metadata(job, length ? job_format(job, "%.*s", (int)length, search->folder) : ".", group_files);
    if (search->group.size) {
        const struct attempt attempt = job_try(job);
        ome_parse(job, search->ome, search->group);
        (void)attempt_end(job, &attempt, ATTEMPT_TRY);
    }
    for (size_t i = 0; i < search->ome->count; i++) {
        search->level = strcmp(search->ome->levels[i].path, rest) == 0 ? &search->ome->levels[i] : search->level;
    }
}

/* The folder that was given is an array. Its group, a folder above, may know it as a level: "1", or "scale1/image". */
static void look_above(struct search *search)
{
    const char *end = search->folder + strlen(search->folder);
    for (int up = 0; job_ok(search->job) && !search->ome->count && up < ABOVE && end > search->folder; up++) {
        size_t above = path_length_above(search->folder, (size_t)(end - search->folder));
        end = search->folder + above - (above > 0);
        look_into(search, (size_t)(end - search->folder));
    }
}

/* The folder that was given is a group: goes down to the array of the level. */
static void go_down(struct search *search)
{
    struct job *job = search->job;
    ome_parse(job, search->ome, search->group);
    search->level = job_ok(job) ? choose_level(search) : NULL;
    if (!search->level) {
        return;
    }
    search->folder = job_format(job, "%s/%s", search->folder, search->level->path);
    job_at(job, search->folder, JOB_ALONE);
    search->array = read_metadata(job, search->folder, array_files);
    if (!search->array.size) {
        job_fail(job, CONUS_ERROR_IO, "level %zu: neither %s/zarr.json nor .zarray is there",
                 (size_t)(search->level - search->ome->levels), search->folder);
    }
}

/* The matrix from the voxel to the world. Both of resolution and orientation say all, as of a TIFF stack; else the
 * level does. Gives the words for where it comes from. */
static const char *find_place(struct search *search, double world[16])
{
    struct job *job = search->job;
    const struct ome_level *level = search->level;
    struct brainglobe_metadata place = search->v->place;
    bool has_level = level && level->scale[0] > 0 && level->scale[1] > 0 && level->scale[2] > 0;
    bool is_own = has_level && !(place.resolution[0] > 0 && place.orientation[0]);
    if (!place.orientation[0]) {
        memcpy(place.orientation, search->ome->orientation, sizeof search->ome->orientation);
    }
    mat4_identity(world);
    if (!place.orientation[0] || (!is_own && !(place.resolution[0] > 0))) {
        job_bad(job, "does not say where it lies: no %s; give FOLDER,%s (micrometres; where the axes start)",
                place.orientation[0] ? "scale with a unit" : "anatomical orientation of its axes",
                is_own ? "orientation=asr" : "resolution=25,orientation=asr");
        return "";
    }
    if (!is_own) {
        (void)JOB_CALL(job, brainglobe_voxels(world, &place));
        return "resolution and orientation";
    }
    double axes[16];
    const double millimetre[SPACE] = {1, 1, 1};
    if (JOB_CALL(job, brainglobe_axes(axes, place.orientation, millimetre))) {
        for (size_t axis = 0; axis < SPACE; axis++) {
            vec3_scale(world + 4 * (2 - axis), axes + 4 * axis, level->scale[axis]);
            vec3_add_scaled(world + 12, world + 12, level->translation[axis], axes + 4 * axis);
        }
    }
    return "OME scale and translation";
}

static void describe(struct job *job, struct volume_input *v, struct search *search)
{
    const struct zarr_array *array = &((struct volume_zarr *)v->own)->array;
    size_t ahead = array->rank - SPACE;
    const uint64_t *shape = array->shape + ahead;
    int64_t dim[7] = {(int64_t)shape[2], (int64_t)shape[1], (int64_t)shape[0], 1, 1, 1, 1};
    double world[16];
    v->header.swapped = array->chain.swapped;
    v->header.has_unit = true;
    snprintf(v->header.info.format, sizeof v->header.info.format, "Zarr %d", array->format);
    for (size_t i = 0; i < ahead; i++) {
        dim[SPACE + i] = (int64_t)array->shape[ahead - 1 - i];
    }
    if (search->ome->rank && search->level && search->ome->rank != array->rank) {
        job_bad(job, "shape: found %zu axes, the image has %zu", array->rank, search->ome->rank);
    }
    const char *words = find_place(search, world);
    volume_describe(job, v, volume_datatype_of(array->kind, array->size), dim, world, words);
}

static void zarr_give(struct job *job, struct volume_input *v, size_t first, size_t count,
                      const struct voxel_sink *sink)
{
    const struct volume_zarr *zarr = v->own;
    (void)count; /* one */
    const struct zarr_found found = zarr_read(job, &zarr->array, zarr->folder, first, sink->take, sink->user);
    if (found.files < found.wanted) {
        job_note(job, "%llu of %llu chunks are there: the others count as the fill value",
                 (unsigned long long)found.files, (unsigned long long)found.wanted);
    }
    memcpy(v->header.info.sha256, found.sha256, sizeof found.sha256);
}

static void zarr_open(struct job *job, struct volume_input *v)
{
    const char *path = v->keys.path;
    struct volume_zarr *zarr = job_new(job, struct volume_zarr);
    struct search search = {.job = job, .v = v, .ome = job_new(job, struct ome)};
    search.folder = job_format(job, "%.*s", (int)path_plain_length(path, strlen(path)), path);
    if (!zarr || !search.ome) {
        return;
    }
    job_at(job, search.folder, JOB_ALONE);
    search.array = read_metadata(job, search.folder, array_files);
    if (is_array(search.array)) {
        source_keys_refuse(job, &v->keys, ~KEY_BIT(KEY_LEVEL));
        look_above(&search);
    } else {
        search.group = read_metadata(job, search.folder, group_files);
        go_down(&search);
    }
    zarr_array_parse(job, &zarr->array, search.array);
    if (job_ok(job)) {
        v->own = zarr;
        v->read = zarr_give;
        v->gives_slabs = true;
        zarr->folder = search.folder;
        memcpy(zarr->orientation, search.ome->orientation, sizeof zarr->orientation);
        describe(job, v, &search);
    }
    if (text_mentions(search.group, "\"image-label\"") && text_mentions(search.group, "\"label-value\"")) {
        v->embedded = search.group;
    }
}

const struct volume_reader zarr_reader = {KEY_BIT(KEY_RESOLUTION) | KEY_BIT(KEY_ORIENTATION) | KEY_BIT(KEY_LEVEL),
                                          .is_whole = true, .open = zarr_open};
