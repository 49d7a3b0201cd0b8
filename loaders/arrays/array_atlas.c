/* SPDX-License-Identifier: BSD-3-Clause */
/* Atlases, surfaces, pathways, contexts and regions of interest from arrays. */
#include "atlas/areas/sides.h"
#include "atlas/atlas.h"
#include "atlas/space.h"
#include "base/memory.h"
#include "base/options.h"
#include "loaders/maps/load_scalar.h"
#include "loaders/scene/load_parcellation.h"
#include "loaders/volumes/volume_file.h"
#include "loaders/volumes/volume_header.h"
#include "loaders/volumes/volume_values.h"

#include <stdio.h>
#include <string.h>

struct array_volume {
    struct volume_file file; /**< Its voxels are i fastest, without gaps. */
    bool is_borrowed;        /**< They are the caller's. */
};

static const int datatypes[] = {
    [CONUS_SCALAR_UINT8] = VOLUME_UINT8,     [CONUS_SCALAR_INT8] = VOLUME_INT8,
    [CONUS_SCALAR_UINT16] = VOLUME_UINT16,   [CONUS_SCALAR_INT16] = VOLUME_INT16,
    [CONUS_SCALAR_UINT32] = VOLUME_UINT32,   [CONUS_SCALAR_INT32] = VOLUME_INT32,
    [CONUS_SCALAR_UINT64] = VOLUME_UINT64,   [CONUS_SCALAR_INT64] = VOLUME_INT64,
    [CONUS_SCALAR_FLOAT32] = VOLUME_FLOAT32, [CONUS_SCALAR_FLOAT64] = VOLUME_FLOAT64,
};

static conus_status check_shape(const conus_voxels *voxels)
{
    if (!voxels->data) {
        return fail(CONUS_ERROR_ARGUMENT, "data: NULL, voxels are needed");
    }
    if (voxels->type < CONUS_SCALAR_UINT8 || voxels->type > CONUS_SCALAR_FLOAT64) {
        return fail(CONUS_ERROR_ARGUMENT, "type: %d, allowed are CONUS_SCALAR_UINT8 (%d) to CONUS_SCALAR_FLOAT64 (%d)",
                    (int)voxels->type, CONUS_SCALAR_UINT8, CONUS_SCALAR_FLOAT64);
    }
    for (int axis = 0; axis < 3; axis++) {
        if (voxels->dim[axis] < 1 || voxels->dim[axis] > INT32_MAX) {
            return fail(CONUS_ERROR_ARGUMENT, "dim: %zu x %zu x %zu voxels, each is 1 to %d", voxels->dim[0],
                        voxels->dim[1], voxels->dim[2], INT32_MAX);
        }
    }
    return CONUS_OK;
}

static conus_status array_describe(struct volume_header *header, const conus_voxels *voxels)
{
    const int64_t dim[7] = {(int64_t)voxels->dim[0], (int64_t)voxels->dim[1], (int64_t)voxels->dim[2], 1, 1, 1, 1};
    header->info = (conus_volume_info){.slope = 1, .space_code = voxels->space_code};
    snprintf(header->info.format, sizeof header->info.format, "array");
    char words[sizeof header->info.transform] = "the caller's world_from_voxel";
    size_t used = strlen(words);
    if (voxels->space_code) { /* as of NIfTI: by these words a file of poses is matched */
        snprintf(words + used, sizeof words - used, ", code %d (%s)", voxels->space_code,
                 space_code_name(voxels->space_code));
    }
    conus_status status = volume_header_set_datatype(header, datatypes[voxels->type]);
    status = status ? status : volume_header_set_dim(header, dim);
    return status ? status : space_describe(&header->info, voxels->world_from_voxel, words);
}

/* Whether the voxels lie one after the other, i fastest. */
static bool is_dense(const conus_voxels *voxels, size_t voxel_size)
{
    bool equal = true;
    size_t dense = voxel_size;
    for (int axis = 0; axis < 3; axis++) {
        equal = equal && (voxels->dim[axis] == 1 || voxels->stride[axis] == (ptrdiff_t)dense);
        dense *= voxels->dim[axis];
    }
    return equal || (!voxels->stride[0] && !voxels->stride[1] && !voxels->stride[2]);
}

static conus_status take_voxels(struct array_volume *array, const conus_voxels *voxels, size_t size)
{
    size_t voxel_size = volume_datatype_size(array->file.datatype);
    array->is_borrowed = is_dense(voxels, voxel_size);
    array->file.voxels.size = size;
    if (array->is_borrowed) {
        array->file.voxels.data = (uint8_t *)voxels->data; /* only read */
        return CONUS_OK;
    }
    array->file.voxels.data = memory_raw(size, 1);
    if (!array->file.voxels.data) {
        return CONUS_ERROR_MEMORY;
    }
    uint8_t *out = array->file.voxels.data;
    for (size_t k = 0; k < voxels->dim[2]; k++) {
        for (size_t j = 0; j < voxels->dim[1]; j++) {
            const uint8_t *in = voxels->data;
            in += (ptrdiff_t)j * voxels->stride[1] + (ptrdiff_t)k * voxels->stride[2];
            for (size_t i = 0; i < voxels->dim[0]; i++, out += voxel_size, in += voxels->stride[0]) {
                memcpy(out, in, voxel_size);
            }
        }
    }
    return CONUS_OK;
}

static void array_volume_finish(struct array_volume *array)
{
    if (array->is_borrowed) {
        array->file.voxels = (struct bytes){0};
    }
    volume_file_finish(&array->file);
    *array = (struct array_volume){0};
}

/* Checks voxels, which must outlive out. CONUS_ERROR_ARGUMENT for what is out of its range, CONUS_ERROR_DATA for
 * a matrix that cannot be inverted. */
static conus_status array_volume_open(struct array_volume *out, const conus_voxels *voxels)
{
    struct volume_header header = {0};
    struct array_volume array = {0};
    voxels = options_of(conus_voxels, voxels);
    const char *name = voxels->name ? voxels->name : "array";
    conus_status status = check_shape(voxels);
    status = status ? status : array_describe(&header, voxels);
    if (status) {
        return fail_in(status, name);
    }
    array.file.info = header.info;
    array.file.datatype = header.datatype;
    array.file.swapped = voxels->swapped;
    array.file.path = memory_text(name, strlen(name));
    array.file.info.path = array.file.path;
    status = array.file.path ? take_voxels(&array, voxels, header.volume_size) : CONUS_ERROR_MEMORY;
    if (status) {
        array_volume_finish(&array);
        return status;
    }
    file_sha256(array.file.info.sha256, &array.file.voxels);
    *out = array;
    return CONUS_OK;
}

static conus_status check_label(const conus_label *label)
{
    if (!label->number) {
        return fail(CONUS_ERROR_ARGUMENT, "number: 0 is background, allowed is 1 to 4294967295");
    }
    return !label->hemisphere || strchr("LRB", label->hemisphere)
               ? CONUS_OK
               : fail(CONUS_ERROR_ARGUMENT, "hemisphere of label %u: character %d, allowed are 'L', 'R', 'B' and 0",
                      label->number, label->hemisphere);
}

/* Adds a copy of the label to the table. */
static conus_status add_label(struct label_table *table, const conus_label *label)
{
    conus_status status = check_label(label);
    struct label *entry = status ? NULL : label_table_add(table, label->number);
    if (!entry) {
        return status ? status : CONUS_ERROR_MEMORY;
    }
    status = label_set_text(&entry->name, text_from(label->name ? label->name : ""));
    status = status ? status
                    : label_set_text(&entry->abbreviation, text_from(label->abbreviation ? label->abbreviation : ""));
    entry->hemisphere = label->hemisphere;
    entry->has_rgb = label->has_rgb;
    memcpy(entry->rgb, label->rgb, sizeof entry->rgb);
    entry->has_parent = label->parent != 0;
    entry->parent = label->parent;
    return status;
}

static conus_status add_labels(struct label_table *table, const conus_label *labels, size_t count, struct notes *notes)
{
    if (count > LABEL_LIMIT) {
        return fail(CONUS_ERROR_ARGUMENT, "labels: %zu, allowed are up to %d", count, LABEL_LIMIT);
    }
    conus_status status = CONUS_OK;
    for (size_t i = 0; i < count && !status; i++) {
        status = add_label(table, &labels[i]);
    }
    return status ? status : label_table_sort(table, notes);
}

static conus_status set_words(conus_atlas *atlas, const char *name)
{
    atlas->path = memory_text(name, strlen(name));
    return atlas->path ? CONUS_OK : CONUS_ERROR_MEMORY;
}

static conus_status create_of_voxels(conus_atlas **out, struct volume_file *file, const conus_label *labels,
                                     size_t label_count, const conus_create_options *options)
{
    const struct note_sink sink = {options->log, options->log_user, file->path};
    struct label_table table = {0};
    struct notes notes = {.sink = &sink};
    struct label_voxels numbers = {0};
    struct labelled_volume volume = {.info = &file->info, .labels = &numbers};
    conus_atlas *atlas = NULL;
    file->info.role = CONUS_ROLE_PARCELLATION;
    conus_status status = volume_file_labels(&numbers, file);
    status = status ? status : add_labels(&table, labels, label_count, &notes);
    if (!status) {
        struct job job = {0}; /* Bridge: this room reports a status */
        parcellation_check_grey(&job, file, &numbers, &table, false, options->labels_anyway);
        status = job_close(&job, &notes, NULL);
    }
    status = status ? status
                    : atlas_create_of(&atlas, &volume, 1, &table, label_count ? "the program" : "none found", &notes);
    status = status ? status : set_words(atlas, file->path);
    status = status ? status : conflicting_sides_note(atlas);
    label_voxels_finish(&numbers);
    label_table_finish(&table);
    notes_finish(&notes);
    if (status) {
        conus_atlas_destroy(atlas);
        return status;
    }
    atlas->notes.sink = NULL;
    *out = atlas;
    return CONUS_OK;
}

conus_status conus_atlas_create(conus_atlas **out, const conus_voxels *voxels, const conus_label *labels,
                                size_t label_count, const conus_create_options *options)
{
    struct array_volume array = {0};
    options = options_of(conus_create_options, options);
    if (!out || (label_count && (!labels || !voxels))) {
        return fail(CONUS_ERROR_ARGUMENT, "conus_atlas_create: %s",
                    !out      ? "a result is needed"
                    : !labels ? "labels: NULL, though there are some"
                              : "labels without voxels; areas that are surfaces bring their own");
    }
    if (!voxels) {
        conus_atlas *atlas = NULL;
        conus_status status = atlas_create_empty(&atlas, "the program");
        status = status ? status : set_words(atlas, "arrays");
        if (status) {
            conus_atlas_destroy(atlas);
            return status;
        }
        *out = atlas;
        return CONUS_OK;
    }
    conus_status status = array_volume_open(&array, voxels);
    status = status ? status : create_of_voxels(out, &array.file, labels, label_count, options);
    array_volume_finish(&array);
    return status;
}

/* Number of the area with this label, 0 if there is none. */
static uint32_t find_area(const conus_atlas *atlas, uint32_t label)
{
    for (size_t i = 0; i < atlas->area_count; i++) {
        if (atlas->objects[i].label == label) {
            return (uint32_t)i + 1;
        }
    }
    return 0;
}

static conus_status check_new_area(const conus_atlas *atlas, const conus_label *area)
{
    conus_status status = check_label(area);
    if (!status && find_area(atlas, area->number)) {
        status = fail(CONUS_ERROR_ARGUMENT, "number: %u is that of another area", area->number);
    }
    if (!status && area->parent && !find_area(atlas, area->parent)) {
        status = fail(CONUS_ERROR_ARGUMENT, "parent: no area has the number %u", area->parent);
    }
    if (!status && area->parent && conus_atlas_depth(atlas, find_area(atlas, area->parent)) > ATLAS_DEPTH_LIMIT) {
        status = fail(CONUS_ERROR_ARGUMENT, "parent: number %u has %d areas above it, and no more are allowed",
                      area->parent, ATLAS_DEPTH_LIMIT);
    }
    return status;
}

static conus_status add_mesh(conus_atlas *atlas, const conus_label *area, struct mesh *mesh)
{
    struct label_table table = {0};
    char digits[LABEL_DIGITS];
    conus_status status = add_label(&table, area);
    if (!status) {
        conus_object object = label_object(&table.entries[0], atlas->object_count, digits);
        object.parent = area->parent ? find_area(atlas, area->parent) : 0;
        status = atlas_add_mesh(atlas, &object, mesh);
    }
    label_table_finish(&table);
    return status;
}

conus_status conus_atlas_add_surface(conus_atlas *atlas, const conus_label *area, const float *positions,
                                     size_t vertex_count, const uint32_t *triangles, size_t triangle_count)
{
    char where[24];
    struct mesh mesh = {0};
    struct notes notes = {0};
    if (!atlas || !area) {
        return fail(CONUS_ERROR_ARGUMENT, "conus_atlas_add_surface: an atlas and an area are needed");
    }
    size_t note_count = atlas->notes.count;
    conus_status status = check_new_area(atlas, area);
    if (!status && (!positions || !triangles)) {
        status = fail(CONUS_ERROR_ARGUMENT, "%s: NULL", positions ? "triangles" : "positions");
    }
    status = status ? status : mesh_init(&mesh, vertex_count, triangle_count);
    if (!status) {
        memcpy(mesh.positions, positions, 3 * vertex_count * sizeof *positions);
        memcpy(mesh.triangles, triangles, 3 * triangle_count * sizeof *triangles);
        status = mesh_check(&mesh, &notes);
    }
    if (status) {
        status = fail_in(status, area->name ? area->name : "surface");
    }
    snprintf(where, sizeof where, "area %u", area->number);
    status = status ? status : notes_move_in(&atlas->notes, &notes, where);
    status = status ? status : add_mesh(atlas, area, &mesh);
    if (status) {
        notes_cut(&atlas->notes, note_count);
    }
    notes_finish(&notes);
    mesh_finish(&mesh);
    return status;
}

conus_status conus_atlas_add_values(conus_atlas *atlas, const conus_voxels *voxels,
                                    const conus_pathway_options *options)
{
    struct array_volume array = {0};
    if (!atlas || !voxels) {
        return fail(CONUS_ERROR_ARGUMENT, "conus_atlas_add_values: an atlas and voxels are needed");
    }
    options = options_of(conus_pathway_options, options);
    conus_status status = array_volume_open(&array, voxels);
    const struct note_sink sink = {options->log, options->log_user, array.file.path};
    conus_pathway_options named = *options;
    bool is_named = (options->name && *options->name) || options->band_count;
    named.name = is_named ? options->name : array.file.path;
    if (!status) {
        struct job job = {.sink = &sink};
        const struct atlas_mark mark = atlas_mark(atlas);
        pathway_add(&job, atlas, &array.file, &named);
        status = atlas_close(&job, atlas, mark);
    }
    array_volume_finish(&array);
    return status;
}

conus_status conus_atlas_set_context_values(conus_atlas *atlas, const conus_voxels *voxels,
                                            const conus_context_options *options)
{
    struct array_volume array = {0};
    if (!atlas || !voxels) {
        return fail(CONUS_ERROR_ARGUMENT, "conus_atlas_set_context_values: an atlas and voxels are needed");
    }
    options = options_of(conus_context_options, options);
    conus_status status = array_volume_open(&array, voxels);
    const struct note_sink sink = {options->log, options->log_user, array.file.path};
    if (!status) {
        struct job job = {.sink = &sink};
        const struct atlas_mark mark = atlas_mark(atlas);
        context_set(&job, atlas, &array.file, options);
        status = atlas_close(&job, atlas, mark);
    }
    array_volume_finish(&array);
    return status;
}

conus_status conus_roi_create(conus_roi **out, const conus_voxels *voxels, const conus_roi_options *options)
{
    struct array_volume array = {0};
    if (!out || !voxels) {
        return fail(CONUS_ERROR_ARGUMENT, "conus_roi_create: a result and voxels are needed");
    }
    options = options_of(conus_roi_options, options);
    conus_status status = array_volume_open(&array, voxels);
    const struct note_sink sink = {options->log, options->log_user, array.file.path};
    if (!status) {
        struct job job = {.sink = &sink};
        roi_of_volume(&job, out, &array.file, options->threshold);
        status = job_close(&job, NULL, NULL);
    }
    array_volume_finish(&array);
    return status;
}
