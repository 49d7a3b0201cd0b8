/* SPDX-License-Identifier: BSD-3-Clause */
/* Finds the group and the level, and places the array. */
#include "loaders/volumes/volume_zarr.h"

#include "atlas/space.h"
#include "base/files/folder.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "loaders/zarr/ome.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum {
    SPACE = 3,
    ABOVE = 3 /* folders above an array that may be its group */
};

/* A store while its array is looked for. */
struct search {
    char *folder;       /* of the group, or of the array that was given, without '/' at its end */
    struct bytes group; /* the group's metadata; none where there is no group */
    struct bytes array; /* the array's */
    struct ome ome;
    struct file_sums *read;
};

/* Reads the first of the files in the folder that is there, one of at most 16 MiB. */
static conus_status read_metadata(struct bytes *out, const char *folder, const char *const names[2],
                                  struct file_sums *read)
{
    conus_status status = CONUS_OK;
    for (size_t i = 0; !status && !out->data && i < 2; i++) {
        struct buffer path = {0};
        buffer_format(&path, "%s/%s", folder, names[i]);
        status = buffer_status(&path);
        if (!status && file_exists(path.data)) {
            status = file_read(out, path.data, ZARR_JSON_LIMIT);
            status = status ? status : file_sums_add(read, path.data, out);
        }
        buffer_finish(&path);
    }
    return status;
}

static const char *const array_files[2] = {"zarr.json", ".zarray"};
static const char *const group_files[2] = {"zarr.json", ".zattrs"};

static bool is_array(const struct bytes *bytes)
{
    const struct text text = {(const char *)bytes->data, bytes->size};
    return text_mentions(text, "\"data_type\"") || text_mentions(text, "\"dtype\"");
}

/* Finds the level with voxels of this size. */
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

/* Chooses the level of a group: by number, by the size of its voxels, or else the first. */
static conus_status choose_level(size_t *out, const struct ome *ome, const struct volume_selector *selector)
{
    const double *size = selector->place.resolution;
    size_t level = selector->leveled ? (size_t)selector->level : 0;
    bool by_size = !selector->leveled && size[0] > 0 && ome->levels[0].scale[0] > 0;
    if (level >= ome->count) {
        return fail(CONUS_ERROR_ARGUMENT, "level: found %zu, allowed are 0 to %zu", level, ome->count - 1);
    }
    level = by_size ? find_size(ome, size) : level;
    if (level == ome->count) {
        const double *scale = ome->levels[0].scale;
        return fail(CONUS_ERROR_ARGUMENT,
                    "resolution: no level has voxels of %g x %g x %g micrometres, level 0 of %zu has %g x %g x %g",
                    size[0], size[1], size[2], ome->count, 1000 * scale[0], 1000 * scale[1], 1000 * scale[2]);
    }
    *out = level;
    return CONUS_OK;
}

/* Reads the group in the folder that `length` bytes of the given one name, if it is an image, and finds the level whose
 * path is the rest. */
static conus_status look_into(const struct ome_level **out, struct search *search, size_t length)
{
    const char *rest = search->folder + length + (length > 0);
    char *above = length ? memory_text(search->folder, length) : memory_text(".", 1);
    conus_status status = above ? read_metadata(&search->group, above, group_files, search->read) : CONUS_ERROR_MEMORY;
    if (!status && search->group.data) {
        status = ome_parse(&search->ome, text_from_bytes(search->group.data, search->group.size));
        status = status == CONUS_ERROR_MEMORY ? status : CONUS_OK; /* another group says nothing of the array's place */
    }
    for (size_t i = 0; !status && i < search->ome.count; i++) {
        *out = strcmp(search->ome.levels[i].path, rest) == 0 ? &search->ome.levels[i] : *out;
    }
    memory_free(above);
    return status;
}

/* The folder that was given is an array. Its group, a folder above, may know it as a level: "1", or "scale1/image". */
static conus_status look_above(const struct ome_level **out, struct search *search)
{
    conus_status status = CONUS_OK;
    const char *end = search->folder + strlen(search->folder);
    for (int up = 0; !status && !search->ome.count && up < ABOVE && end > search->folder; up++) {
        size_t above = path_length_above(search->folder, (size_t)(end - search->folder));
        end = search->folder + above - (above > 0);
        bytes_finish(&search->group);
        status = look_into(out, search, (size_t)(end - search->folder));
    }
    return status;
}

/* The folder that was given is a group: goes down to the array of the level. */
static conus_status go_down(const struct ome_level **out, struct search *search, const struct volume_selector *selector)
{
    struct buffer folder = {0};
    size_t level = 0;
    conus_status status = ome_parse(&search->ome, (struct text){(const char *)search->group.data, search->group.size});
    status = status ? status : choose_level(&level, &search->ome, selector);
    if (status) {
        return status;
    }
    *out = &search->ome.levels[level];
    buffer_format(&folder, "%s/%s", search->folder, (*out)->path);
    status = buffer_status(&folder);
    if (!status) {
        memory_free(search->folder);
        search->folder = folder.data;
        status = read_metadata(&search->array, search->folder, array_files, search->read);
    }
    return status || search->array.data
               ? status
               : fail(CONUS_ERROR_IO, "level %zu: neither %s/zarr.json nor .zarray is there", level, search->folder);
}

/* The matrix from the voxel to the world. Both of resolution and orientation say all, as of a TIFF stack; else the
 * level does. */
static conus_status find_place(double world[16], const char **source, const struct search *search,
                               const struct ome_level *level, const struct volume_selector *selector)
{
    struct brainglobe_metadata place = selector->place;
    bool has_level = level && level->scale[0] > 0 && level->scale[1] > 0 && level->scale[2] > 0;
    bool is_own = has_level && !(place.resolution[0] > 0 && place.orientation[0]);
    if (!place.orientation[0]) {
        memcpy(place.orientation, search->ome.orientation, sizeof search->ome.orientation);
    }
    if (!place.orientation[0] || (!is_own && !(place.resolution[0] > 0))) {
        return fail(CONUS_ERROR_DATA,
                    "does not say where it lies: no %s; give FOLDER,%s (micrometres; where the axes start)",
                    place.orientation[0] ? "scale with a unit" : "anatomical orientation of its axes",
                    is_own ? "orientation=asr" : "resolution=25,orientation=asr");
    }
    *source = is_own ? "OME scale and translation" : "resolution and orientation";
    if (!is_own) {
        return brainglobe_voxels(world, &place);
    }
    double axes[16];
    const double millimetre[SPACE] = {1, 1, 1};
    conus_status status = brainglobe_axes(axes, place.orientation, millimetre);
    mat4_identity(world);
    for (size_t axis = 0; !status && axis < SPACE; axis++) {
        vec3_scale(world + 4 * (2 - axis), axes + 4 * axis, level->scale[axis]);
        vec3_add_scaled(world + 12, world + 12, level->translation[axis], axes + 4 * axis);
    }
    return status;
}

static conus_status make_header(struct volume_header *out, const struct zarr_array *array, const struct search *search,
                                const struct ome_level *level, const struct volume_selector *selector)
{
    size_t ahead = array->rank - SPACE;
    const uint64_t *shape = array->shape + ahead;
    int64_t dim[7] = {(int64_t)shape[2], (int64_t)shape[1], (int64_t)shape[0], 1, 1, 1, 1};
    struct volume_header header = {.swapped = array->chain.swapped, .footer = true, .has_unit = true};
    const char *source = NULL;
    double world[16];
    header.info.slope = 1;
    snprintf(header.info.format, sizeof header.info.format, "Zarr %d", array->format);
    for (size_t i = 0; i < ahead; i++) {
        dim[SPACE + i] = (int64_t)array->shape[ahead - 1 - i];
    }
    if (search->ome.rank && level && search->ome.rank != array->rank) {
        return fail(CONUS_ERROR_DATA, "shape: found %zu axes, the image has %zu", array->rank, search->ome.rank);
    }
    conus_status status = volume_header_set_datatype(&header, volume_datatype_of(array->kind, array->size));
    status = status ? status : volume_header_set_dim(&header, dim);
    status = status ? status : find_place(world, &source, search, level, selector);
    status = status ? status : space_describe(&header.info, world, source);
    *out = status ? *out : header;
    return status;
}

conus_status volume_zarr_open(struct volume_zarr *out, struct volume_header *header, const char *path,
                              const struct volume_selector *selector, struct file_sums *read)
{
    struct search search = {.read = read};
    struct zarr_array array = {0};
    const struct ome_level *level = NULL;
    search.folder = memory_text(path, path_plain_length(path, strlen(path)));
    conus_status status = search.folder ? CONUS_OK : CONUS_ERROR_MEMORY;
    status = status ? status : read_metadata(&search.array, search.folder, array_files, read);
    if (!status && is_array(&search.array)) {
        status = volume_selector_refuse_level(selector, path);
        status = status ? status : look_above(&level, &search);
    } else if (!status) {
        bytes_finish(&search.array);
        status = read_metadata(&search.group, search.folder, group_files, read);
        status = status ? status : go_down(&level, &search, selector);
    }
    status =
        status ? status : zarr_array_parse(&array, (struct text){(const char *)search.array.data, search.array.size});
    status = status ? status : make_header(header, &array, &search, level, selector);
    if (!status) {
        *out = (struct volume_zarr){search.folder, array, "", {0}};
        const struct text about = text_from_bytes(search.group.data, search.group.size);
        if (text_mentions(about, "\"image-label\"") && text_mentions(about, "\"label-value\"")) {
            out->labels = search.group;
            search.group = (struct bytes){0};
        }
        memcpy(out->orientation, search.ome.orientation, sizeof out->orientation);
        search.folder = NULL;
    } else {
        status = fail_in(status, search.folder ? search.folder : path);
    }
    memory_free(search.folder);
    bytes_finish(&search.group);
    bytes_finish(&search.array);
    ome_finish(&search.ome);
    return status;
}

void volume_zarr_finish(struct volume_zarr *zarr)
{
    memory_free(zarr->folder);
    bytes_finish(&zarr->labels);
    *zarr = (struct volume_zarr){0};
}

conus_status volume_zarr_read(char sha256[65], const struct volume_zarr *zarr, uint64_t volume, uint64_t limit,
                              zarr_sink *sink, void *user, struct notes *notes)
{
    struct zarr_found found;
    conus_status status = zarr_read(&found, &zarr->array, zarr->folder, volume, limit, sink, user);
    if (!status && found.files < found.wanted) {
        status = notes_add(notes, "%llu of %llu chunks are there: the others count as the fill value",
                           (unsigned long long)found.files, (unsigned long long)found.wanted);
    }
    memcpy(sha256, found.sha256, status ? 0 : sizeof found.sha256);
    return status;
}
