/* SPDX-License-Identifier: BSD-3-Clause */
/* Header, XML and values of a .dlabel.nii. */
#include "loaders/cifti/cifti.h"

#include "base/formats/xml.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "base/order.h"
#include "base/tolerance.h"
#include "loaders/volumes/volumes.h"

#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

/* The list of structures of the CIFTI-2 specification, "BrainStructure". */
#define WHOLE(word, name)                                                                                              \
    {                                                                                                                  \
        "CIFTI_STRUCTURE_" word, name, 0                                                                               \
    }
#define SIDES(word, name)                                                                                              \
    {"CIFTI_STRUCTURE_" word "_LEFT", name "Left", 'L'},                                                               \
    {                                                                                                                  \
        "CIFTI_STRUCTURE_" word "_RIGHT", name "Right", 'R'                                                            \
    }

static const struct cifti_structure structures[] = {
    SIDES("ACCUMBENS", "Accumbens"),
    WHOLE("ALL_WHITE_MATTER", "AllWhiteMatter"),
    WHOLE("ALL_GREY_MATTER", "AllGreyMatter"),
    SIDES("AMYGDALA", "Amygdala"),
    WHOLE("BRAIN_STEM", "BrainStem"),
    SIDES("CAUDATE", "Caudate"),
    SIDES("CEREBELLAR_WHITE_MATTER", "CerebellarWhiteMatter"),
    WHOLE("CEREBELLUM", "Cerebellum"),
    SIDES("CEREBELLUM", "Cerebellum"),
    SIDES("CEREBRAL_WHITE_MATTER", "CerebralWhiteMatter"),
    WHOLE("CORTEX", "Cortex"),
    SIDES("CORTEX", "Cortex"),
    SIDES("DIENCEPHALON_VENTRAL", "DiencephalonVentral"),
    SIDES("HIPPOCAMPUS", "Hippocampus"),
    WHOLE("OTHER", "Other"),
    WHOLE("OTHER_GREY_MATTER", "OtherGreyMatter"),
    WHOLE("OTHER_WHITE_MATTER", "OtherWhiteMatter"),
    SIDES("PALLIDUM", "Pallidum"),
    SIDES("PUTAMEN", "Putamen"),
    SIDES("THALAMUS", "Thalamus"),
};

/* The open element, if it has a meaning. */
enum inside { AT_ROOT, IN_CIFTI, IN_MATRIX, IN_LABELS, IN_NAMED, IN_MODELS, IN_VOLUME, IN_MODEL };

struct parsing {
    struct job *job;
    struct cifti *cifti;
    size_t maps_wanted;
    enum inside inside;
    bool has_matrix, has_labels, has_models, has_transform;
    bool has_name;            /* of the NamedMap that is open */
    struct label_entry entry; /* the Label that is open */
    int exponent;             /* of the transform that is open */
};

static const char *quote(const char *given)
{
    return given ? given : "";
}

static void start_cifti(struct parsing *parsing, const struct xml_event *event)
{
    const char *version = quote(xml_attribute(event, "Version"));
    if (strcmp(version, "2") != 0 && strcmp(version, "2.0") != 0) {
        job_refuse(parsing->job,
                   "Version: found \"%.20s\", 2 is read (wb_command -file-convert -cifti-version-convert IN 2 OUT)",
                   version);
    }
}

static void start_matrix(struct parsing *parsing, const struct xml_event *event)
{
    (void)event;
    if (parsing->has_matrix) {
        job_bad(parsing->job, "Matrix twice, allowed is one");
    }
    parsing->has_matrix = true;
}

/* Dimension 0 are the maps, 1 the grayordinates. */
static void start_indices(struct parsing *parsing, const struct xml_event *event)
{
    static const char *const types[] = {"CIFTI_INDEX_TYPE_LABELS", "CIFTI_INDEX_TYPE_BRAIN_MODELS"};
    struct job *job = parsing->job;
    const size_t dimension = xml_whole(job, event, "AppliesToMatrixDimension", 0, 1);
    const char *type = quote(xml_attribute(event, "IndicesMapToDataType"));
    bool *seen = dimension ? &parsing->has_models : &parsing->has_labels;
    if (strcmp(type, types[dimension]) != 0) {
        job_bad(job, "IndicesMapToDataType: found \"%.60s\" for dimension %zu, a .dlabel.nii has %s", type, dimension,
                types[dimension]);
    }
    if (*seen) {
        job_bad(job, "AppliesToMatrixDimension: %zu twice, allowed is one MatrixIndicesMap for each", dimension);
    }
    *seen = true;
    parsing->inside = dimension ? IN_MODELS : IN_LABELS;
}

static void start_named(struct parsing *parsing, const struct xml_event *event)
{
    struct cifti *cifti = parsing->cifti;
    (void)event;
    if (cifti->maps.count == parsing->maps_wanted) {
        job_bad(parsing->job, "NamedMap: found more than %zu, which is dim[5]", parsing->maps_wanted);
    }
    (void)LIST_ADD(parsing->job, &cifti->maps);
    parsing->has_name = false;
}

static struct cifti_map *open_map(const struct parsing *parsing)
{
    return &parsing->cifti->maps.at[parsing->cifti->maps.count - 1];
}

static void end_map_name(struct parsing *parsing, struct text text)
{
    if (parsing->has_name) {
        job_bad(parsing->job, "MapName twice, allowed is one in each NamedMap");
    }
    parsing->has_name = true;
    open_map(parsing)->name = job_name(parsing->job, text);
}

static void end_named(struct parsing *parsing, struct text text)
{
    (void)text;
    if (!parsing->has_name) {
        job_bad(parsing->job, "MapName is missing, one is needed in each NamedMap");
    }
}

static void start_label(struct parsing *parsing, const struct xml_event *event)
{
    label_entry_start(parsing->job, &parsing->entry, event);
}

/* The table is made of them where the map is chosen: notes of other maps are dropped. */
static void end_label(struct parsing *parsing, struct text text)
{
    struct job *job = parsing->job;
    *LIST_ADD(job, &open_map(parsing)->labels) = (struct cifti_label){parsing->entry, job_text(job, text)};
}

static void start_volume(struct parsing *parsing, const struct xml_event *event)
{
    struct job *job = parsing->job;
    const uint64_t max_memory = memory_limit(job->max_memory);
    const char *given = quote(xml_attribute(event, "VolumeDimensions"));
    struct text rest = text_from(given);
    struct text field;
    size_t *dim = parsing->cifti->dim;
    size_t count = 1;
    bool more = true;
    if (dim[0]) {
        job_bad(job, "Volume twice, allowed is one");
    }
    for (size_t i = 0; i < 3 && job_ok(job); i++) {
        uint64_t value = 0;
        bool fine = text_field(&rest, ',', &more, &field) && text_to_uint(text_trim(field), INT32_MAX, &value);
        dim[i] = (size_t)value;
        if (!fine || !value || (i == 2 && more)) {
            job_bad(job, "VolumeDimensions: found \"%.60s\", allowed are three whole numbers from 1", given);
        } else if (!memory_multiply(count, dim[i], &count) || count > UINT32_MAX ||
                   count > max_memory / sizeof(uint32_t)) {
            job_fail(job, CONUS_ERROR_MEMORY,
                     "VolumeDimensions: found \"%.60s\", more voxels than fit in %llu bytes (--max-memory) or in 32 "
                     "bits",
                     given, (unsigned long long)max_memory);
        }
    }
}

static void start_transform(struct parsing *parsing, const struct xml_event *event)
{
    enum { LEAST = -9, MOST = 3 };
    const char *given = xml_attribute(event, "MeterExponent");
    int64_t exponent = 0;
    if (parsing->has_transform) {
        job_bad(parsing->job, "TransformationMatrixVoxelIndicesIJKtoXYZ twice, allowed is one");
    }
    if (!given || !text_to_int(text_trim(text_from(given)), &exponent) || exponent < LEAST || exponent > MOST) {
        job_bad(parsing->job, "MeterExponent: found \"%.60s\", allowed are whole numbers from %d to %d (-3: mm)",
                quote(given), LEAST, MOST);
    }
    parsing->has_transform = true;
    parsing->exponent = (int)exponent;
}

static void end_transform(struct parsing *parsing, struct text text)
{
    double m[16];
    double inverse[16];
    double *world = parsing->cifti->world_from_voxel;
    double mm = pow(10, parsing->exponent + 3);
    if (!xml_matrix(m, text) || !mat4_settle_last_row(m)) {
        job_bad(parsing->job, "TransformationMatrixVoxelIndicesIJKtoXYZ: 16 finite numbers by rows are needed, the "
                              "last row 0 0 0 1");
        return;
    }
    for (int i = 0; i < 16; i++) {
        world[i] = m[i] * (i % 4 < 3 ? mm : 1);
    }
    if (!mat4_invert_affine(inverse, world)) {
        job_bad(parsing->job, "TransformationMatrixVoxelIndicesIJKtoXYZ: the matrix is singular, an invertible one is "
                              "needed");
    }
}

static void end_volume(struct parsing *parsing, struct text text)
{
    (void)text;
    if (!parsing->has_transform) {
        job_bad(parsing->job, "Volume: TransformationMatrixVoxelIndicesIJKtoXYZ is missing");
    }
}

static void start_model(struct parsing *parsing, const struct xml_event *event)
{
    struct job *job = parsing->job;
    struct cifti *cifti = parsing->cifti;
    struct cifti_model *model =
        list_add(job, &cifti->models, &cifti->model_count, &cifti->model_capacity, sizeof *cifti->models);
    const char *type = quote(xml_attribute(event, "ModelType"));
    const char *structure = quote(xml_attribute(event, "BrainStructure"));
    const uint64_t vertices = memory_limit(job->max_memory) / sizeof(uint32_t);
    model->is_surface = strcmp(type, "CIFTI_MODEL_TYPE_SURFACE") == 0;
    model->structure = ROW_NAMED(structures, text_from(structure), true);
    if (!model->is_surface && strcmp(type, "CIFTI_MODEL_TYPE_VOXELS") != 0) {
        job_bad(job, "ModelType: found \"%.60s\", allowed are CIFTI_MODEL_TYPE_SURFACE and CIFTI_MODEL_TYPE_VOXELS",
                type);
    }
    if (!model->structure) {
        job_bad(job,
                "BrainStructure: found \"%.60s\", allowed are the names of CIFTI-2 (CIFTI_STRUCTURE_CORTEX_LEFT, ...)",
                structure);
    }
    model->offset = xml_whole(job, event, "IndexOffset", 0, cifti->count - 1);
    model->count = xml_whole(job, event, "IndexCount", 1, cifti->count - model->offset);
    if (model->is_surface) {
        model->vertex_count =
            xml_whole(job, event, "SurfaceNumberOfVertices", 1, vertices < INT_MAX ? vertices : INT_MAX);
    }
}

static struct cifti_model *open_model(const struct parsing *parsing)
{
    return &parsing->cifti->models[parsing->cifti->model_count - 1];
}

/* Reads `wanted` numbers below `limit` into model->indices. */
static void read_indices(struct job *job, struct cifti_model *model, const char *name, struct text text, size_t wanted,
                         uint64_t limit)
{
    struct text word;
    size_t n = 0;
    uint64_t value = 0;
    if (model->indices) {
        job_bad(job, "%s twice, allowed is one in a BrainModel", name);
    }
    if (wanted > text.size) { /* a number takes a character at least */
        job_bad(job, "%s: found %zu characters, IndexCount asks for %zu numbers", name, text.size, wanted);
    }
    model->indices = job_raw(job, wanted, sizeof *model->indices);
    for (; model->indices && text_word(&text, &word); n++) {
        if (!text_to_uint(word, limit - 1, &value)) {
            job_bad(job, "%s: number %zu is \"%.*s\", allowed are whole numbers from 0 to %llu", name, n,
                    TEXT_SHOW(word, 20), (unsigned long long)limit - 1);
            return;
        }
        if (n < wanted) {
            model->indices[n] = (uint32_t)value;
        }
    }
    if (n != wanted) {
        job_bad(job, "%s: found %zu numbers, IndexCount asks for %zu", name, n, wanted);
    }
}

static void end_vertices(struct parsing *parsing, struct text text)
{
    struct cifti_model *model = open_model(parsing);
    if (!model->is_surface) {
        job_bad(parsing->job, "VertexIndices in a model of voxels, allowed is VoxelIndicesIJK");
    }
    read_indices(parsing->job, model, "VertexIndices", text, model->count, model->vertex_count);
    for (size_t i = 1; i < model->count && job_ok(parsing->job); i++) {
        if (model->indices[i] <= model->indices[i - 1]) {
            job_bad(parsing->job, "VertexIndices: number %zu is %u behind %u, allowed are ascending ones", i,
                    model->indices[i], model->indices[i - 1]);
        }
    }
}

/* The volume may follow: find_voxels() makes one number of the three. */
static void end_voxels(struct parsing *parsing, struct text text)
{
    struct cifti_model *model = open_model(parsing);
    if (model->is_surface) {
        job_bad(parsing->job, "VoxelIndicesIJK in a model of a surface, allowed is VertexIndices");
    }
    read_indices(parsing->job, model, "VoxelIndicesIJK", text, 3 * model->count, INT32_MAX);
}

static void end_model(struct parsing *parsing, struct text text)
{
    const struct cifti_model *model = open_model(parsing);
    (void)text;
    if (!model->indices) {
        job_bad(parsing->job, "BrainModel: %s is missing", model->is_surface ? "VertexIndices" : "VoxelIndicesIJK");
    }
}

static int compare_models(const void *a, const void *b)
{
    return compare_unsigned(((const struct cifti_model *)a)->offset, ((const struct cifti_model *)b)->offset);
}

/* Sorts the models; every grayordinate must be in one of them. */
static void order_models(struct job *job, struct cifti *cifti)
{
    size_t next = 0;
    if (!cifti->model_count) {
        job_bad(job, "BrainModel: found none");
    }
    order_sort(cifti->models, cifti->model_count, sizeof *cifti->models, compare_models);
    for (size_t i = 0; i < cifti->model_count; i++) {
        const struct cifti_model *model = &cifti->models[i];
        if (model->offset != next) {
            job_bad(job, "IndexOffset of %s: found %zu, the models before it end at %zu", model->structure->name,
                    model->offset, next);
        }
        next += model->count;
        for (size_t k = 0; k < i; k++) {
            if (cifti->models[k].structure == model->structure && cifti->models[k].is_surface == model->is_surface) {
                job_bad(job, "BrainStructure: two models of the %s of %s, allowed is one",
                        model->is_surface ? "surface" : "voxels", model->structure->name);
            }
        }
    }
    if (next != cifti->count) {
        job_bad(job, "IndexCount: the models have %zu grayordinates, dim[6] is %zu", next, cifti->count);
    }
}

/* Makes i + dim[0] (j + dim[1] k) of i, j, k. `taken` has a bit for each voxel. */
static void find_voxels(struct job *job, struct cifti_model *model, const size_t dim[3], uint8_t *taken)
{
    for (size_t n = 0; n < model->count && job_ok(job); n++) {
        const uint32_t *ijk = &model->indices[3 * n];
        size_t voxel = ijk[0] + dim[0] * (ijk[1] + dim[1] * ijk[2]);
        bool inside = ijk[0] < dim[0] && ijk[1] < dim[1] && ijk[2] < dim[2];
        if (!inside || taken[voxel / 8] >> voxel % 8 & 1) {
            job_bad(job, "VoxelIndicesIJK of %s: found %u %u %u%s, the volume has %zu x %zu x %zu",
                    model->structure->name, ijk[0], ijk[1], ijk[2], inside ? " again" : "", dim[0], dim[1], dim[2]);
        } else {
            taken[voxel / 8] |= (uint8_t)(1U << voxel % 8);
            model->indices[n] = (uint32_t)voxel;
        }
    }
}

static void find_all_voxels(struct job *job, struct cifti *cifti)
{
    const size_t *dim = cifti->dim;
    const struct job_mark mark = job_mark(job);
    uint8_t *taken = job_zeroed(job, dim[0] * dim[1] * dim[2] / 8 + 1, 1);
    for (size_t i = 0; i < cifti->model_count && job_ok(job); i++) {
        struct cifti_model *model = &cifti->models[i];
        if (!model->is_surface && !dim[0]) {
            job_bad(job, "Volume is missing, where the voxels of %s lie", model->structure->name);
        } else if (!model->is_surface) {
            find_voxels(job, model, dim, taken);
        }
    }
    job_release(job, mark);
}

static void end_cifti(struct parsing *parsing, struct text text)
{
    struct job *job = parsing->job;
    struct cifti *cifti = parsing->cifti;
    (void)text;
    if (!parsing->has_labels || !parsing->has_models) {
        job_bad(job, "MatrixIndicesMap: that of dimension %d is missing", parsing->has_labels);
    }
    if (cifti->maps.count != parsing->maps_wanted) {
        job_bad(job, "NamedMap: found %zu, dim[5] is %zu", cifti->maps.count, parsing->maps_wanted);
    }
    order_models(job, cifti);
    find_all_voxels(job, cifti);
}

/* The elements that have a meaning: in which other one each may stand, and what is open between its tags. Others, such
 * as MetaData, are passed over. */
static const struct element {
    const char *name;
    enum inside parent, inside;
    void (*start)(struct parsing *parsing, const struct xml_event *event);
    void (*end)(struct parsing *parsing, struct text text);
} elements[] = {
    {"CIFTI", AT_ROOT, IN_CIFTI, start_cifti, end_cifti},
    {"Matrix", IN_CIFTI, IN_MATRIX, start_matrix, NULL},
    {"MatrixIndicesMap", IN_MATRIX, IN_MATRIX, start_indices, NULL},
    {"NamedMap", IN_LABELS, IN_NAMED, start_named, end_named},
    {"MapName", IN_NAMED, IN_NAMED, NULL, end_map_name},
    {"Label", IN_NAMED, IN_NAMED, start_label, end_label},
    {"Volume", IN_MODELS, IN_VOLUME, start_volume, end_volume},
    {"TransformationMatrixVoxelIndicesIJKtoXYZ", IN_VOLUME, IN_VOLUME, start_transform, end_transform},
    {"BrainModel", IN_MODELS, IN_MODEL, start_model, end_model},
    {"VertexIndices", IN_MODEL, IN_MODEL, NULL, end_vertices},
    {"VoxelIndicesIJK", IN_MODEL, IN_MODEL, NULL, end_voxels},
};

static conus_status on_start(void *user, const struct xml_event *event)
{
    struct parsing *parsing = user;
    struct job *job = parsing->job;
    const struct element *element = ROW_NAMED(elements, text_from(event->name), true);
    const size_t place = job_in(job, "line ", event->line);
    if (parsing->inside == AT_ROOT && strcmp(event->name, "CIFTI") != 0) {
        job_bad(job, "outermost element: found <%.40s>, allowed is <CIFTI>", event->name);
    } else if (element && element->parent != parsing->inside) {
        job_bad(job, "<%s> in the wrong place", event->name);
    } else if (element) {
        parsing->inside = element->inside;
        if (element->start) {
            element->start(parsing, event);
        }
    }
    job_out(job, place);
    return job->status;
}

static conus_status on_end(void *user, const struct xml_event *event)
{
    struct parsing *parsing = user;
    struct job *job = parsing->job;
    const struct element *element = ROW_NAMED(elements, text_from(event->name), true);
    const size_t place = job_in(job, "line ", event->line);
    if (element) {
        parsing->inside = element->parent;
    }
    if (element && element->end) {
        element->end(parsing, event->text);
    }
    job_out(job, place);
    return job->status;
}

/* Reads the header, and checks that the file holds what the header announces. */
static void cifti_read_header(struct job *job, struct volume_header *header, size_t shape[2], const struct bytes *file)
{
    const uint64_t max_memory = memory_limit(job->max_memory);
    nifti_matrix_read(job, header, shape, file->data, file->size);
    if (!job_ok(job)) {
        return;
    }
    if (header->info.slope != 1 || header->info.intercept != 0) {
        job_bad(job, "scl_slope, scl_inter: found %g and %g, labels are not scaled", header->info.slope,
                header->info.intercept);
    }
    if (header->offset > CIFTI_HEAD_LIMIT) {
        job_refuse(job, "vox_offset: found %llu, at most %d bytes of header and XML are read",
                   (unsigned long long)header->offset, CIFTI_HEAD_LIMIT);
    }
    if (shape[1] > max_memory / sizeof(uint32_t)) {
        job_fail(job, CONUS_ERROR_MEMORY, "dim[6]: found %zu, more labels than fit in %llu bytes (--max-memory)",
                 shape[1], (unsigned long long)max_memory);
    }
    size_t values = header->info.volume_count * header->volume_size; /* counted by the header's reader */
    if (header->offset > file->size || values > file->size - header->offset) {
        job_bad(job, "dim: %zu x %zu values of %s end at byte %llu, the file has %zu", shape[0], shape[1],
                header->info.datatype, (unsigned long long)header->offset + values, file->size);
    }
}

/* The XML: the only extension with its code. */
static struct text find_xml(struct job *job, const struct bytes *file, const struct volume_header *header)
{
    struct volume_extension *extensions = NULL;
    struct text xml = {0};
    size_t count = 0;
    size_t found = 0;
    if (!job_ok(job)) {
        return xml;
    }
    const struct text head = {(const char *)file->data, (size_t)header->offset};
    (void)nifti_extensions_read(job, &extensions, &count, head, header);
    for (size_t i = 0; i < count; i++) {
        if (extensions[i].code == NIFTI_CIFTI_XML) {
            xml = text_from_bytes(extensions[i].data, extensions[i].size);
            found++;
        }
    }
    if (found != 1) {
        job_bad(job, "extensions of ecode %d, which hold the XML: found %zu, one is needed", NIFTI_CIFTI_XML, found);
    }
    return xml;
}

void cifti_parse(struct job *job, struct cifti *out, const struct bytes *file)
{
    struct volume_header header = {0};
    size_t shape[2] = {0};
    cifti_read_header(job, &header, shape, file);
    const struct text xml = find_xml(job, file, &header);
    if (!job_ok(job)) {
        return;
    }
    *out = (struct cifti){.count = shape[1],
                          .values = file->data + header.offset,
                          .datatype = header.datatype,
                          .swapped = header.swapped};
    struct parsing parsing = {.job = job, .cifti = out, .maps_wanted = shape[0]};
    const struct xml_handler handler = {.start = on_start, .end = on_end, .user = &parsing};
    const size_t place = job_in(job, "XML", JOB_ALONE);
    (void)JOB_CALL(job, xml_parse(&handler, xml));
    job_out(job, place);
}

void cifti_table(struct job *job, struct label_table *out, const struct cifti_map *map)
{
    for (size_t i = 0; i < map->labels.count && job_ok(job); i++) {
        struct cifti_label label = map->labels.at[i];
        label_entry_end(job, &label.entry, out, label.name);
    }
    labels_sort(job, out);
}

uint32_t *cifti_labels(struct job *job, const struct cifti *cifti, size_t map, const struct label_table *table)
{
    const size_t size = volume_datatype_size(cifti->datatype);
    const char *name = cifti->maps.at[map].name;
    size_t negative = 0;
    uint32_t *labels = job_raw(job, cifti->count, sizeof *labels);
    for (size_t i = 0; job_ok(job) && i < cifti->count; i++) {
        const uint8_t *at = (const uint8_t *)cifti->values + (i * cifti->maps.count + map) * size;
        double value = volume_value_at(at, cifti->datatype, cifti->swapped);
        value = tolerance_whole(value, fabs(value));
        if (!isfinite(value) || value != floor(value) || value > UINT32_MAX) {
            job_bad(job, "grayordinate %zu: label %.9g, allowed are whole numbers up to 4294967295", i, value);
            break;
        }
        labels[i] = value > 0 ? (uint32_t)value : 0;
        if (labels[i] && !label_table_find(table, labels[i])) {
            job_bad(job, "grayordinate %zu: label %u, which the LabelTable of map \"%.60s\" lacks", i, labels[i],
                    quote(name));
        }
        negative += value < 0;
    }
    if (cifti->datatype == VOLUME_FLOAT32) {
        (void)JOB_CALL(
            job, label_table_check_singles(table, labels, cifti->count, TOLERANCE_SINGLE_END, "labels", &job->notes));
    }
    if (negative) {
        job_note(job, "%zu vertices or voxels have labels below 0 and belong to no area", negative);
    }
    return labels;
}
