/* SPDX-License-Identifier: BSD-3-Clause */
/* Header, XML and values of a .dlabel.nii. */
#include "loaders/cifti/cifti.h"

#include "base/formats/xml.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "base/order.h"
#include "base/tolerance.h"
#include "loaders/labels/label_cells.h"
#include "loaders/volumes/nifti.h"
#include "loaders/volumes/volume_values.h"

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
    struct cifti *cifti;
    uint64_t max_memory;
    size_t maps_wanted;
    size_t model_capacity;
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

static conus_status read_whole(size_t *out, const struct xml_event *event, const char *attribute, uint64_t low,
                               uint64_t high)
{
    const char *given = xml_attribute(event, attribute);
    uint64_t value;
    if (!given || !text_to_uint(text_trim(text_from(given)), high, &value) || value < low) {
        return fail(CONUS_ERROR_DATA, "%s: found \"%.60s\", allowed are whole numbers from %llu to %llu", attribute,
                    quote(given), (unsigned long long)low, (unsigned long long)high);
    }
    *out = (size_t)value;
    return CONUS_OK;
}

static conus_status start_cifti(struct parsing *parsing, const struct xml_event *event)
{
    const char *version = xml_attribute(event, "Version");
    (void)parsing;
    return version && (strcmp(version, "2") == 0 || strcmp(version, "2.0") == 0)
               ? CONUS_OK
               : fail(CONUS_ERROR_UNSUPPORTED,
                      "Version: found \"%.20s\", 2 is read (wb_command -file-convert "
                      "-cifti-version-convert IN 2 OUT)",
                      quote(version));
}

static conus_status start_matrix(struct parsing *parsing, const struct xml_event *event)
{
    (void)event;
    if (parsing->has_matrix) {
        return fail(CONUS_ERROR_DATA, "Matrix twice, allowed is one");
    }
    parsing->has_matrix = true;
    return CONUS_OK;
}

/* Dimension 0 are the maps, 1 the grayordinates. */
static conus_status start_indices(struct parsing *parsing, const struct xml_event *event)
{
    static const char *const types[] = {"CIFTI_INDEX_TYPE_LABELS", "CIFTI_INDEX_TYPE_BRAIN_MODELS"};
    size_t dimension = 0;
    conus_status status = read_whole(&dimension, event, "AppliesToMatrixDimension", 0, 1);
    if (status) {
        return status;
    }
    const char *type = quote(xml_attribute(event, "IndicesMapToDataType"));
    if (strcmp(type, types[dimension]) != 0) {
        return fail(CONUS_ERROR_DATA, "IndicesMapToDataType: found \"%.60s\" for dimension %zu, a .dlabel.nii has %s",
                    type, dimension, types[dimension]);
    }
    bool *seen = dimension ? &parsing->has_models : &parsing->has_labels;
    if (*seen) {
        return fail(CONUS_ERROR_DATA, "AppliesToMatrixDimension: %zu twice, allowed is one MatrixIndicesMap for each",
                    dimension);
    }
    *seen = true;
    parsing->inside = dimension ? IN_MODELS : IN_LABELS;
    return CONUS_OK;
}

static conus_status start_named(struct parsing *parsing, const struct xml_event *event)
{
    struct cifti *cifti = parsing->cifti;
    (void)event;
    if (cifti->map_count == parsing->maps_wanted) {
        return fail(CONUS_ERROR_DATA, "NamedMap: found more than %zu, which is dim[5]", parsing->maps_wanted);
    }
    struct cifti_map *maps = memory_resize(cifti->maps, cifti->map_count + 1, sizeof *maps);
    if (!maps) {
        return CONUS_ERROR_MEMORY;
    }
    cifti->maps = maps;
    maps[cifti->map_count++] = (struct cifti_map){0};
    parsing->has_name = false;
    return CONUS_OK;
}

static struct cifti_map *open_map(const struct parsing *parsing)
{
    return &parsing->cifti->maps[parsing->cifti->map_count - 1];
}

static conus_status end_map_name(struct parsing *parsing, struct text text)
{
    if (parsing->has_name) {
        return fail(CONUS_ERROR_DATA, "MapName twice, allowed is one in each NamedMap");
    }
    parsing->has_name = true;
    return label_set_text(&open_map(parsing)->name, text);
}

static conus_status end_named(struct parsing *parsing, struct text text)
{
    struct cifti_map *map = open_map(parsing);
    (void)text;
    return parsing->has_name ? label_table_sort(&map->table, &map->notes)
                             : fail(CONUS_ERROR_DATA, "MapName is missing, one is needed in each NamedMap");
}

static conus_status start_label(struct parsing *parsing, const struct xml_event *event)
{
    struct job job = {0}; /* Bridge: to label tables on a job. */
    label_entry_start(&job, &parsing->entry, event);
    return job_close(&job, NULL, NULL);
}

static conus_status end_label(struct parsing *parsing, struct text text)
{
    struct cifti_map *map = open_map(parsing);
    struct job job = {0}; /* Bridge: to label tables on a job. */
    label_entry_end(&job, &parsing->entry, &map->table, text);
    return job_close(&job, &map->notes, NULL);
}

static conus_status start_volume(struct parsing *parsing, const struct xml_event *event)
{
    const char *given = quote(xml_attribute(event, "VolumeDimensions"));
    struct text rest = text_from(given);
    struct text field;
    size_t *dim = parsing->cifti->dim;
    size_t count = 1;
    bool more = true;
    if (dim[0]) {
        return fail(CONUS_ERROR_DATA, "Volume twice, allowed is one");
    }
    for (size_t i = 0; i < 3; i++) {
        uint64_t value = 0;
        bool fine = text_field(&rest, ',', &more, &field) && text_to_uint(text_trim(field), INT32_MAX, &value);
        if (!fine || !value || (i == 2 && more)) {
            return fail(CONUS_ERROR_DATA, "VolumeDimensions: found \"%.60s\", allowed are three whole numbers from 1",
                        given);
        }
        dim[i] = (size_t)value;
        if (!memory_multiply(count, dim[i], &count) || count > UINT32_MAX ||
            count > parsing->max_memory / sizeof(uint32_t)) {
            return fail(CONUS_ERROR_MEMORY,
                        "VolumeDimensions: found \"%.60s\", more voxels than fit in %llu bytes (--max-memory) or in "
                        "32 bits",
                        given, (unsigned long long)parsing->max_memory);
        }
    }
    return CONUS_OK;
}

static conus_status start_transform(struct parsing *parsing, const struct xml_event *event)
{
    enum { LEAST = -9, MOST = 3 };
    const char *given = xml_attribute(event, "MeterExponent");
    int64_t exponent;
    if (parsing->has_transform) {
        return fail(CONUS_ERROR_DATA, "TransformationMatrixVoxelIndicesIJKtoXYZ twice, allowed is one");
    }
    if (!given || !text_to_int(text_trim(text_from(given)), &exponent) || exponent < LEAST || exponent > MOST) {
        return fail(CONUS_ERROR_DATA,
                    "MeterExponent: found \"%.60s\", allowed are whole numbers from %d to %d (-3: mm)", quote(given),
                    LEAST, MOST);
    }
    parsing->has_transform = true;
    parsing->exponent = (int)exponent;
    return CONUS_OK;
}

static conus_status end_transform(struct parsing *parsing, struct text text)
{
    double m[16] = {0};
    double inverse[16];
    double *world = parsing->cifti->world_from_voxel;
    double mm = pow(10, parsing->exponent + 3);
    struct text word;
    size_t n = 0;
    bool fine = true;
    while (fine && text_word(&text, &word)) {
        fine = n < 16 && text_to_double(word, &m[4 * (n % 4) + n / 4]) && isfinite(m[4 * (n % 4) + n / 4]);
        n++;
    }
    if (!fine || n != 16 || !mat4_settle_last_row(m)) {
        return fail(CONUS_ERROR_DATA,
                    "TransformationMatrixVoxelIndicesIJKtoXYZ: 16 finite numbers by rows are needed, the last row 0 0 "
                    "0 1");
    }
    for (int i = 0; i < 16; i++) {
        world[i] = m[i] * (i % 4 < 3 ? mm : 1);
    }
    return mat4_invert_affine(inverse, world)
               ? CONUS_OK
               : fail(CONUS_ERROR_DATA, "TransformationMatrixVoxelIndicesIJKtoXYZ: the matrix is singular, an "
                                        "invertible one is needed");
}

static conus_status end_volume(struct parsing *parsing, struct text text)
{
    (void)text;
    return parsing->has_transform ? CONUS_OK
                                  : fail(CONUS_ERROR_DATA, "Volume: TransformationMatrixVoxelIndicesIJKtoXYZ is "
                                                           "missing");
}

static conus_status start_model(struct parsing *parsing, const struct xml_event *event)
{
    struct cifti *cifti = parsing->cifti;
    if (!memory_reserve(&cifti->models, &parsing->model_capacity, cifti->model_count + 1, sizeof *cifti->models)) {
        return CONUS_ERROR_MEMORY;
    }
    struct cifti_model *model = &cifti->models[cifti->model_count++];
    *model = (struct cifti_model){0};
    const char *type = quote(xml_attribute(event, "ModelType"));
    const char *structure = quote(xml_attribute(event, "BrainStructure"));
    model->is_surface = strcmp(type, "CIFTI_MODEL_TYPE_SURFACE") == 0;
    if (!model->is_surface && strcmp(type, "CIFTI_MODEL_TYPE_VOXELS") != 0) {
        return fail(CONUS_ERROR_DATA,
                    "ModelType: found \"%.60s\", allowed are CIFTI_MODEL_TYPE_SURFACE and CIFTI_MODEL_TYPE_VOXELS",
                    type);
    }
    for (size_t i = 0; !model->structure && i < sizeof structures / sizeof structures[0]; i++) {
        model->structure = strcmp(structure, structures[i].word) == 0 ? &structures[i] : NULL;
    }
    if (!model->structure) {
        return fail(CONUS_ERROR_DATA,
                    "BrainStructure: found \"%.60s\", allowed are the names of CIFTI-2 "
                    "(CIFTI_STRUCTURE_CORTEX_LEFT, ...)",
                    structure);
    }
    conus_status status;
    if ((status = read_whole(&model->offset, event, "IndexOffset", 0, cifti->count - 1)) ||
        (status = read_whole(&model->count, event, "IndexCount", 1, cifti->count - model->offset))) {
        return status;
    }
    uint64_t vertices = parsing->max_memory / sizeof(uint32_t);
    return !model->is_surface ? CONUS_OK
                              : read_whole(&model->vertex_count, event, "SurfaceNumberOfVertices", 1,
                                           vertices < INT_MAX ? vertices : INT_MAX);
}

static struct cifti_model *open_model(const struct parsing *parsing)
{
    return &parsing->cifti->models[parsing->cifti->model_count - 1];
}

/* Reads `wanted` numbers below `limit` into model->indices. */
static conus_status read_indices(struct cifti_model *model, const char *name, struct text text, size_t wanted,
                                 uint64_t limit)
{
    struct text word;
    size_t n = 0;
    uint64_t value = 0;
    if (model->indices || wanted > text.size) { /* a number takes a character at least */
        return model->indices ? fail(CONUS_ERROR_DATA, "%s twice, allowed is one in a BrainModel", name)
                              : fail(CONUS_ERROR_DATA, "%s: found %zu characters, IndexCount asks for %zu numbers",
                                     name, text.size, wanted);
    }
    model->indices = memory_raw(wanted, sizeof *model->indices);
    if (!model->indices) {
        return CONUS_ERROR_MEMORY;
    }
    for (; text_word(&text, &word); n++) {
        if (!text_to_uint(word, limit - 1, &value)) {
            return fail(CONUS_ERROR_DATA, "%s: number %zu is \"%.*s\", allowed are whole numbers from 0 to %llu", name,
                        n, TEXT_SHOW(word, 20), (unsigned long long)limit - 1);
        }
        if (n < wanted) {
            model->indices[n] = (uint32_t)value;
        }
    }
    return n == wanted ? CONUS_OK
                       : fail(CONUS_ERROR_DATA, "%s: found %zu numbers, IndexCount asks for %zu", name, n, wanted);
}

static conus_status end_vertices(struct parsing *parsing, struct text text)
{
    struct cifti_model *model = open_model(parsing);
    if (!model->is_surface) {
        return fail(CONUS_ERROR_DATA, "VertexIndices in a model of voxels, allowed is VoxelIndicesIJK");
    }
    conus_status status = read_indices(model, "VertexIndices", text, model->count, model->vertex_count);
    for (size_t i = 1; !status && i < model->count; i++) {
        if (model->indices[i] <= model->indices[i - 1]) {
            return fail(CONUS_ERROR_DATA, "VertexIndices: number %zu is %u behind %u, allowed are ascending ones", i,
                        model->indices[i], model->indices[i - 1]);
        }
    }
    return status;
}

/* The volume may follow: find_voxels() makes one number of the three. */
static conus_status end_voxels(struct parsing *parsing, struct text text)
{
    struct cifti_model *model = open_model(parsing);
    if (model->is_surface) {
        return fail(CONUS_ERROR_DATA, "VoxelIndicesIJK in a model of a surface, allowed is VertexIndices");
    }
    return read_indices(model, "VoxelIndicesIJK", text, 3 * model->count, INT32_MAX);
}

static conus_status end_model(struct parsing *parsing, struct text text)
{
    const struct cifti_model *model = open_model(parsing);
    (void)text;
    return model->indices ? CONUS_OK
                          : fail(CONUS_ERROR_DATA, "BrainModel: %s is missing",
                                 model->is_surface ? "VertexIndices" : "VoxelIndicesIJK");
}

static int compare_models(const void *a, const void *b)
{
    return compare_unsigned(((const struct cifti_model *)a)->offset, ((const struct cifti_model *)b)->offset);
}

/* Sorts the models; every grayordinate must be in one of them. */
static conus_status order_models(struct cifti *cifti)
{
    size_t next = 0;
    if (!cifti->model_count) {
        return fail(CONUS_ERROR_DATA, "BrainModel: found none");
    }
    order_sort(cifti->models, cifti->model_count, sizeof *cifti->models, compare_models);
    for (size_t i = 0; i < cifti->model_count; i++) {
        const struct cifti_model *model = &cifti->models[i];
        if (model->offset != next) {
            return fail(CONUS_ERROR_DATA, "IndexOffset of %s: found %zu, the models before it end at %zu",
                        model->structure->name, model->offset, next);
        }
        next += model->count;
        for (size_t k = 0; k < i; k++) {
            if (cifti->models[k].structure == model->structure && cifti->models[k].is_surface == model->is_surface) {
                return fail(CONUS_ERROR_DATA, "BrainStructure: two models of the %s of %s, allowed is one",
                            model->is_surface ? "surface" : "voxels", model->structure->name);
            }
        }
    }
    return next == cifti->count ? CONUS_OK
                                : fail(CONUS_ERROR_DATA, "IndexCount: the models have %zu grayordinates, dim[6] is %zu",
                                       next, cifti->count);
}

/* Makes i + dim[0] (j + dim[1] k) of i, j, k. `taken` has a bit for each voxel. */
static conus_status find_voxels(struct cifti_model *model, const size_t dim[3], uint8_t *taken)
{
    for (size_t n = 0; n < model->count; n++) {
        const uint32_t *ijk = &model->indices[3 * n];
        size_t voxel = ijk[0] + dim[0] * (ijk[1] + dim[1] * ijk[2]);
        bool inside = ijk[0] < dim[0] && ijk[1] < dim[1] && ijk[2] < dim[2];
        if (!inside || taken[voxel / 8] >> voxel % 8 & 1) {
            return fail(CONUS_ERROR_DATA, "VoxelIndicesIJK of %s: found %u %u %u%s, the volume has %zu x %zu x %zu",
                        model->structure->name, ijk[0], ijk[1], ijk[2], inside ? " again" : "", dim[0], dim[1], dim[2]);
        }
        taken[voxel / 8] |= (uint8_t)(1U << voxel % 8);
        model->indices[n] = (uint32_t)voxel;
    }
    return CONUS_OK;
}

static conus_status find_all_voxels(struct cifti *cifti)
{
    const size_t *dim = cifti->dim;
    uint8_t *taken = memory_zeroed(dim[0] * dim[1] * dim[2] / 8 + 1, 1);
    conus_status status = taken ? CONUS_OK : CONUS_ERROR_MEMORY;
    for (size_t i = 0; !status && i < cifti->model_count; i++) {
        if (!cifti->models[i].is_surface) {
            status = dim[0] ? find_voxels(&cifti->models[i], dim, taken)
                            : fail(CONUS_ERROR_DATA, "Volume is missing, where the voxels of %s lie",
                                   cifti->models[i].structure->name);
        }
    }
    memory_free(taken);
    return status;
}

static conus_status end_cifti(struct parsing *parsing, struct text text)
{
    struct cifti *cifti = parsing->cifti;
    (void)text;
    if (!parsing->has_labels || !parsing->has_models) {
        return fail(CONUS_ERROR_DATA, "MatrixIndicesMap: that of dimension %d is missing", parsing->has_labels);
    }
    if (cifti->map_count != parsing->maps_wanted) {
        return fail(CONUS_ERROR_DATA, "NamedMap: found %zu, dim[5] is %zu", cifti->map_count, parsing->maps_wanted);
    }
    conus_status status = order_models(cifti);
    return status ? status : find_all_voxels(cifti);
}

/* The elements that have a meaning: in which other one each may stand, and what is open between its tags. Others, such
 * as MetaData, are passed over. */
static const struct element {
    const char *name;
    enum inside parent, inside;
    conus_status (*start)(struct parsing *parsing, const struct xml_event *event);
    conus_status (*end)(struct parsing *parsing, struct text text);
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

static const struct element *find_element(const char *name)
{
    for (size_t i = 0; i < sizeof elements / sizeof elements[0]; i++) {
        if (strcmp(elements[i].name, name) == 0) {
            return &elements[i];
        }
    }
    return NULL;
}

static conus_status fail_at_line(conus_status status, const struct xml_event *event)
{
    char where[32];
    snprintf(where, sizeof where, "line %zu", event->line);
    return status && status != CONUS_ERROR_MEMORY ? fail_in(status, where) : status;
}

static conus_status on_start(void *user, const struct xml_event *event)
{
    struct parsing *parsing = user;
    const struct element *element = find_element(event->name);
    conus_status status = CONUS_OK;
    if (parsing->inside == AT_ROOT && strcmp(event->name, "CIFTI") != 0) {
        status = fail(CONUS_ERROR_DATA, "outermost element: found <%.40s>, allowed is <CIFTI>", event->name);
    } else if (element && element->parent != parsing->inside) {
        status = fail(CONUS_ERROR_DATA, "<%s> in the wrong place", event->name);
    } else if (element) {
        parsing->inside = element->inside;
        status = element->start ? element->start(parsing, event) : CONUS_OK;
    }
    return fail_at_line(status, event);
}

static conus_status on_end(void *user, const struct xml_event *event)
{
    struct parsing *parsing = user;
    const struct element *element = find_element(event->name);
    if (!element) {
        return CONUS_OK;
    }
    parsing->inside = element->parent;
    return element->end ? fail_at_line(element->end(parsing, event->text), event) : CONUS_OK;
}

void cifti_finish(struct cifti *cifti)
{
    for (size_t i = 0; i < cifti->map_count; i++) {
        memory_free(cifti->maps[i].name);
        label_table_finish(&cifti->maps[i].table);
        notes_finish(&cifti->maps[i].notes);
    }
    for (size_t i = 0; i < cifti->model_count; i++) {
        memory_free(cifti->models[i].indices);
    }
    memory_free(cifti->maps);
    memory_free(cifti->models);
    *cifti = (struct cifti){0};
}

/* Reads the header, and checks that the file holds what the header announces. */
static conus_status cifti_read_header(struct volume_header *header, size_t shape[2], const uint8_t *data, size_t size,
                                      uint64_t max_memory)
{
    conus_status status = nifti_matrix_parse(header, shape, data, size);
    if (status) {
        return status;
    }
    if (header->info.slope != 1 || header->info.intercept != 0) {
        return fail(CONUS_ERROR_DATA, "scl_slope, scl_inter: found %g and %g, labels are not scaled",
                    header->info.slope, header->info.intercept);
    }
    if (header->offset > CIFTI_HEAD_LIMIT) {
        return fail(CONUS_ERROR_UNSUPPORTED, "vox_offset: found %llu, at most %d bytes of header and XML are read",
                    (unsigned long long)header->offset, CIFTI_HEAD_LIMIT);
    }
    if (shape[1] > max_memory / sizeof(uint32_t)) {
        return fail(CONUS_ERROR_MEMORY, "dim[6]: found %zu, more labels than fit in %llu bytes (--max-memory)",
                    shape[1], (unsigned long long)max_memory);
    }
    size_t values = header->info.volume_count * header->volume_size; /* counted by the header's reader */
    if (header->offset > size || values > size - header->offset) {
        return fail(CONUS_ERROR_DATA, "dim: %zu x %zu values of %s end at byte %llu, the file has %zu", shape[0],
                    shape[1], header->info.datatype, (unsigned long long)header->offset + values, size);
    }
    return CONUS_OK;
}

/* The XML: the only extension with its code. */
static conus_status find_xml(struct text *out, const struct bytes *head, const struct volume_header *header)
{
    struct volume_extension *extensions = NULL;
    size_t count = 0;
    size_t found = 0;
    size_t end;
    conus_status status = nifti_extensions_parse(&extensions, &count, &end, head, header);
    for (size_t i = 0; !status && i < count; i++) {
        if (extensions[i].code == NIFTI_CIFTI_XML) {
            *out = text_from_bytes(extensions[i].data, extensions[i].size);
            found++;
        }
    }
    memory_free(extensions);
    return status || found == 1
               ? status
               : fail(CONUS_ERROR_DATA, "extensions of ecode %d, which hold the XML: found %zu, one is needed",
                      NIFTI_CIFTI_XML, found);
}

conus_status cifti_parse(struct cifti *out, const uint8_t *data, size_t size, uint64_t max_memory)
{
    struct volume_header header;
    size_t shape[2];
    struct text xml = {0};
    conus_status status = cifti_read_header(&header, shape, data, size, max_memory);
    if (status) {
        return status;
    }
    const struct bytes head = {(uint8_t *)data, (size_t)header.offset};
    struct cifti cifti = {
        .count = shape[1], .values = data + header.offset, .datatype = header.datatype, .swapped = header.swapped};
    status = find_xml(&xml, &head, &header);
    if (!status) {
        struct parsing parsing = {.cifti = &cifti, .max_memory = max_memory, .maps_wanted = shape[0]};
        const struct xml_handler handler = {.start = on_start, .end = on_end, .user = &parsing};
        status = xml_parse(&handler, xml);
        label_finish(&parsing.entry.label);
        status = status ? fail_in(status, "XML") : CONUS_OK;
    }
    if (status) {
        cifti_finish(&cifti);
        return status;
    }
    *out = cifti;
    return CONUS_OK;
}

conus_status cifti_labels(uint32_t **out, const struct cifti *cifti, size_t map, struct notes *notes)
{
    size_t size = volume_datatype_size(cifti->datatype);
    size_t negative = 0;
    const struct cifti_map *from = &cifti->maps[map];
    uint32_t *labels = memory_raw(cifti->count, sizeof *labels);
    conus_status status = labels ? CONUS_OK : CONUS_ERROR_MEMORY;
    for (size_t i = 0; !status && i < cifti->count; i++) {
        const uint8_t *at = (const uint8_t *)cifti->values + (i * cifti->map_count + map) * size;
        double value = volume_value_at(at, cifti->datatype, cifti->swapped);
        value = tolerance_whole(value, fabs(value));
        if (!isfinite(value) || value != floor(value) || value > UINT32_MAX) {
            status = fail(CONUS_ERROR_DATA, "grayordinate %zu: label %.9g, allowed are whole numbers up to 4294967295",
                          i, value);
            break;
        }
        labels[i] = value > 0 ? (uint32_t)value : 0;
        if (labels[i] && !label_table_find(&from->table, labels[i])) {
            status = fail(CONUS_ERROR_DATA, "grayordinate %zu: label %u, which the LabelTable of map \"%.60s\" lacks",
                          i, labels[i], from->name ? from->name : "");
        }
        negative += value < 0;
    }
    if (!status && cifti->datatype == VOLUME_FLOAT32) {
        status = label_table_check_singles(&from->table, labels, cifti->count, TOLERANCE_SINGLE_END, "labels", notes);
    }
    if (!status && negative) {
        status = notes_add(notes, "%zu vertices or voxels have labels below 0 and belong to no area", negative);
    }
    if (status) {
        memory_free(labels);
        return status;
    }
    *out = labels;
    return CONUS_OK;
}
