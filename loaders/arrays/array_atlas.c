/* SPDX-License-Identifier: BSD-3-Clause */
/* Atlases, surfaces, pathways, contexts and regions of interest from arrays. */
#include "atlas/areas/areas.h"
#include "atlas/atlas.h"
#include "atlas/space.h"
#include "base/memory.h"
#include "base/options.h"
#include "conus/own.h"
#include "loaders/labels/labels.h"
#include "loaders/maps/maps.h"
#include "loaders/scene/scene.h"
#include "loaders/volumes/volumes.h"

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

static void check_shape(struct job *job, const conus_voxels *voxels)
{
    if (!voxels->data) {
        job_fail(job, CONUS_ERROR_ARGUMENT, "data: NULL, voxels are needed");
    }
    if (voxels->type < CONUS_SCALAR_UINT8 || voxels->type > CONUS_SCALAR_FLOAT64) {
        job_fail(job, CONUS_ERROR_ARGUMENT,
                 "type: %d, allowed are CONUS_SCALAR_UINT8 (%d) to CONUS_SCALAR_FLOAT64 (%d)", (int)voxels->type,
                 CONUS_SCALAR_UINT8, CONUS_SCALAR_FLOAT64);
    }
    for (int axis = 0; axis < 3; axis++) {
        if (voxels->dim[axis] < 1 || voxels->dim[axis] > INT32_MAX) {
            job_fail(job, CONUS_ERROR_ARGUMENT, "dim: %zu x %zu x %zu voxels, each is 1 to %d", voxels->dim[0],
                     voxels->dim[1], voxels->dim[2], INT32_MAX);
        }
    }
}

static struct volume_header array_describe(struct job *job, const conus_voxels *voxels)
{
    const int64_t dim[7] = {(int64_t)voxels->dim[0], (int64_t)voxels->dim[1], (int64_t)voxels->dim[2], 1, 1, 1, 1};
    struct volume_header header = {.info = {.slope = 1, .space_code = voxels->space_code}};
    char words[sizeof header.info.transform] = "the caller's world_from_voxel";
    size_t used = strlen(words);
    snprintf(header.info.format, sizeof header.info.format, "array");
    if (voxels->space_code) { /* as of NIfTI: by these words a file of poses is matched */
        snprintf(words + used, sizeof words - used, ", code %d (%s)", voxels->space_code,
                 space_code_name(voxels->space_code));
    }
    if (job_ok(job)) { /* the type is one */
        volume_header_set_datatype(job, &header, datatypes[voxels->type]);
        volume_header_set_dim(job, &header, dim);
        (void)JOB_CALL(job, space_describe(&header.info, voxels->world_from_voxel, words));
    }
    return header;
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

static void take_voxels(struct job *job, struct array_volume *array, const conus_voxels *voxels, size_t size)
{
    size_t voxel_size = volume_datatype_size(array->file.datatype);
    array->is_borrowed = is_dense(voxels, voxel_size);
    array->file.voxels.size = size;
    if (array->is_borrowed) {
        array->file.voxels.data = (uint8_t *)voxels->data; /* only read */
        return;
    }
    uint8_t *out = memory_raw(size, 1);
    array->file.voxels.data = out;
    for (size_t k = 0; job_need(job, out) && k < voxels->dim[2]; k++) {
        for (size_t j = 0; j < voxels->dim[1]; j++) {
            const uint8_t *in = voxels->data;
            in += (ptrdiff_t)j * voxels->stride[1] + (ptrdiff_t)k * voxels->stride[2];
            for (size_t i = 0; i < voxels->dim[0]; i++, out += voxel_size, in += voxels->stride[0]) {
                memcpy(out, in, voxel_size);
            }
        }
    }
}

static void finish_array(void *thing)
{
    struct array_volume *array = thing;
    if (array->is_borrowed) {
        array->file.voxels = (struct bytes){0};
    }
    volume_file_finish(&array->file);
}

static const char *name_of(const conus_voxels *voxels)
{
    return voxels->name ? voxels->name : "array";
}

/* Checks voxels, which must outlive the job. CONUS_ERROR_ARGUMENT for what is out of its range, CONUS_ERROR_DATA for
 * a matrix that cannot be inverted. NULL after a failure. */
static struct volume_file *array_volume_open(struct job *job, const conus_voxels *voxels)
{
    struct array_volume *array = job_new(job, struct array_volume);
    if (!array) {
        return NULL;
    }
    job_own(job, finish_array, array);
    const size_t place = job_in(job, name_of(voxels), JOB_ALONE);
    check_shape(job, voxels);
    const struct volume_header header = array_describe(job, voxels);
    job_out(job, place);
    if (!job_ok(job)) {
        return NULL;
    }
    struct volume_file *file = &array->file;
    file->info = header.info;
    file->datatype = header.datatype;
    file->swapped = voxels->swapped;
    file->path = memory_text(name_of(voxels), strlen(name_of(voxels)));
    file->info.path = file->path;
    if (job_need(job, file->path)) {
        take_voxels(job, array, voxels, header.volume_size);
    }
    if (job_ok(job)) {
        file_sha256(file->info.sha256, &file->voxels);
    }
    return job_ok(job) ? file : NULL;
}

static void check_label(struct job *job, const conus_label *label)
{
    if (!label->number) {
        job_fail(job, CONUS_ERROR_ARGUMENT, "number: 0 is background, allowed is 1 to 4294967295");
    }
    if (label->hemisphere && !strchr("LRB", label->hemisphere)) {
        job_fail(job, CONUS_ERROR_ARGUMENT, "hemisphere of label %u: character %d, allowed are 'L', 'R', 'B' and 0",
                 label->number, label->hemisphere);
    }
}

static void add_label(struct job *job, struct label_table *table, const conus_label *label)
{
    check_label(job, label);
    struct label *entry = labels_add(job, table, label->number);
    labels_set(job, &entry->name, text_from(label->name ? label->name : ""));
    labels_set(job, &entry->abbreviation, text_from(label->abbreviation ? label->abbreviation : ""));
    entry->hemisphere = label->hemisphere;
    entry->has_rgb = label->has_rgb;
    memcpy(entry->rgb, label->rgb, sizeof entry->rgb);
    entry->has_parent = label->parent != 0;
    entry->parent = label->parent;
}

static struct label_table *make_table(struct job *job, const conus_label *labels, size_t count)
{
    struct label_table *table = labels_new(job);
    if (count > LABEL_LIMIT) {
        job_fail(job, CONUS_ERROR_ARGUMENT, "labels: %zu, allowed are up to %d", count, LABEL_LIMIT);
    }
    for (size_t i = 0; i < count && job_ok(job); i++) {
        add_label(job, table, &labels[i]);
    }
    labels_sort(job, table);
    return table;
}

/* Ends the job, and gives its atlas. */
static conus_status give_atlas(struct job *job, conus_atlas **out, conus_atlas *atlas, const char *name)
{
    if (atlas && job_ok(job)) {
        atlas->path = memory_text(name, strlen(name));
        job_need(job, atlas->path);
    }
    (void)JOB_CALL(job, conflicting_sides_note(atlas));
    conus_status status = job_close(job, NULL, NULL);
    if (status || !atlas) {
        conus_atlas_destroy(atlas);
        return status;
    }
    atlas->notes.sink = NULL;
    *out = atlas;
    return CONUS_OK;
}

static conus_status create_of_voxels(conus_atlas **out, const conus_voxels *voxels, const conus_label *labels,
                                     size_t label_count, const conus_create_options *options)
{
    const struct note_sink sink = {options->log, options->log_user, name_of(voxels)};
    struct job job = {.sink = &sink};
    struct label_voxels numbers = {0};
    struct volume_file *file = array_volume_open(&job, voxels);
    struct labelled_volume volume = {.info = file ? &file->info : NULL, .labels = &numbers};
    conus_atlas *atlas = NULL;
    if (file) {
        file->info.role = CONUS_ROLE_PARCELLATION;
        volume_labels(&job, &numbers, file);
    }
    const struct label_table *table = make_table(&job, labels, label_count);
    if (job_ok(&job)) {
        parcellation_check_grey(&job, file, &numbers, table, false, options->labels_anyway);
    }
    struct notes notes = {.sink = &sink};
    (void)JOB_CALL(&job, notes_move(&notes, &job.notes));
    (void)JOB_CALL(&job,
                   atlas_create_of(&atlas, &volume, 1, table, label_count ? "the program" : "none found", &notes));
    notes_finish(&notes);
    label_voxels_finish(&numbers);
    return give_atlas(&job, out, atlas, name_of(voxels));
}

conus_status conus_atlas_create(conus_atlas **out, const conus_voxels *voxels, const conus_label *labels,
                                size_t label_count, const conus_create_options *options)
{
    options = options_of(conus_create_options, options);
    if (!out || (label_count && (!labels || !voxels))) {
        return fail(CONUS_ERROR_ARGUMENT, "conus_atlas_create: %s",
                    !out      ? "a result is needed"
                    : !labels ? "labels: NULL, though there are some"
                              : "labels without voxels; areas that are surfaces bring their own");
    }
    if (voxels) {
        return create_of_voxels(out, options_of(conus_voxels, voxels), labels, label_count, options);
    }
    struct job job = {0};
    conus_atlas *atlas = NULL;
    (void)JOB_CALL(&job, atlas_create_empty(&atlas, "the program"));
    return give_atlas(&job, out, atlas, "arrays");
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

static void check_new_area(struct job *job, const conus_atlas *atlas, const conus_label *area)
{
    const uint32_t parent = area->parent ? find_area(atlas, area->parent) : 0;
    check_label(job, area);
    if (find_area(atlas, area->number)) {
        job_fail(job, CONUS_ERROR_ARGUMENT, "number: %u is that of another area", area->number);
    }
    if (area->parent && !parent) {
        job_fail(job, CONUS_ERROR_ARGUMENT, "parent: no area has the number %u", area->parent);
    }
    if (parent && conus_atlas_depth(atlas, parent) > ATLAS_DEPTH_LIMIT) {
        job_fail(job, CONUS_ERROR_ARGUMENT, "parent: number %u has %d areas above it, and no more are allowed",
                 area->parent, ATLAS_DEPTH_LIMIT);
    }
}

static void add_mesh(struct job *job, conus_atlas *atlas, const conus_label *area, struct mesh *mesh)
{
    char digits[LABEL_DIGITS];
    struct label_table *table = labels_new(job);
    add_label(job, table, area);
    if (job_ok(job)) {
        conus_object object = label_object(&table->entries[0], atlas->object_count, digits);
        object.parent = area->parent ? find_area(atlas, area->parent) : 0;
        (void)JOB_CALL(job, atlas_add_mesh(atlas, &object, mesh));
    }
}

conus_status conus_atlas_add_surface(conus_atlas *atlas, const conus_label *area, const float *positions,
                                     size_t vertex_count, const uint32_t *triangles, size_t triangle_count)
{
    char where[24];
    struct mesh mesh = {0};
    if (!atlas || !area) {
        return fail(CONUS_ERROR_ARGUMENT, "conus_atlas_add_surface: an atlas and an area are needed");
    }
    struct job job = {0};
    const size_t note_count = atlas->notes.count;
    const size_t place = job_in(&job, area->name ? area->name : "surface", JOB_ALONE);
    check_new_area(&job, atlas, area);
    if (!positions || !triangles) {
        job_fail(&job, CONUS_ERROR_ARGUMENT, "%s: NULL", positions ? "triangles" : "positions");
    } else if (JOB_CALL(&job, mesh_init(&mesh, vertex_count, triangle_count))) {
        memcpy(mesh.positions, positions, 3 * vertex_count * sizeof *positions);
        memcpy(mesh.triangles, triangles, 3 * triangle_count * sizeof *triangles);
    }
    (void)JOB_CALL(&job, mesh_check(&mesh, &job.notes));
    job_out(&job, place);
    snprintf(where, sizeof where, "area %u", area->number);
    (void)JOB_CALL(&job, notes_move_in(&atlas->notes, &job.notes, where));
    add_mesh(&job, atlas, area, &mesh);
    if (!job_ok(&job)) {
        notes_cut(&atlas->notes, note_count);
    }
    mesh_finish(&mesh);
    return job_close(&job, NULL, NULL);
}

conus_status conus_atlas_add_pathway_voxels(conus_atlas *atlas, const conus_voxels *voxels,
                                            const conus_pathway_options *options)
{
    if (!atlas || !voxels) {
        return fail(CONUS_ERROR_ARGUMENT, "conus_atlas_add_pathway_voxels: an atlas and voxels are needed");
    }
    options = options_of(conus_pathway_options, options);
    voxels = options_of(conus_voxels, voxels);
    const struct note_sink sink = {options->log, options->log_user, name_of(voxels)};
    struct job job = {.sink = &sink};
    const struct atlas_mark mark = atlas_mark(atlas);
    struct volume_file *file = array_volume_open(&job, voxels);
    struct scene_item item = pathway_item(options);
    bool is_named = (options->name && *options->name) || options->band_count;
    item.label.name = is_named ? item.label.name : (char *)name_of(voxels);
    if (file) {
        pathway_add(&job, atlas, file, &item);
    }
    return atlas_close(&job, atlas, mark);
}

conus_status conus_atlas_set_context_voxels(conus_atlas *atlas, const conus_voxels *voxels,
                                            const conus_context_options *options)
{
    if (!atlas || !voxels) {
        return fail(CONUS_ERROR_ARGUMENT, "conus_atlas_set_context_voxels: an atlas and voxels are needed");
    }
    options = options_of(conus_context_options, options);
    voxels = options_of(conus_voxels, voxels);
    const struct note_sink sink = {options->log, options->log_user, name_of(voxels)};
    struct job job = {.sink = &sink};
    const struct atlas_mark mark = atlas_mark(atlas);
    struct volume_file *file = array_volume_open(&job, voxels);
    if (file) {
        const struct scene_item item = {.blocks = options->block_threshold, .opacity = options->opacity};
        context_set(&job, atlas, file, &item);
    }
    return atlas_close(&job, atlas, mark);
}

conus_status conus_roi_create(conus_roi **out, const conus_voxels *voxels, const conus_roi_options *options)
{
    if (!out || !voxels) {
        return fail(CONUS_ERROR_ARGUMENT, "conus_roi_create: a result and voxels are needed");
    }
    options = options_of(conus_roi_options, options);
    voxels = options_of(conus_voxels, voxels);
    const struct note_sink sink = {options->log, options->log_user, name_of(voxels)};
    struct job job = {.sink = &sink};
    struct volume_file *file = array_volume_open(&job, voxels);
    if (file) {
        roi_of_volume(&job, out, file, options->threshold);
    }
    return job_close(&job, NULL, NULL);
}
