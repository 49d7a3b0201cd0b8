/* SPDX-License-Identifier: BSD-3-Clause */
/* Finds tetrahedra and their values in a mesh of SimNIBS (simnibs/mesh_tools/mesh_io.py, Msh.write_hdf5). */
#include "loaders/maps/simnibs.h"

#include "base/geometry/math3.h"
#include "base/memory.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { TETRAHEDRON = 4, CORNERS = 4, LISTED = 200 };

static const double farthest_mm = 10000;

const char *const simnibs_wanted[SIMNIBS_WANTED] = {
    "/nodes/node_coord", "/*/nodes/node_coord",   "/elm/elm_type",           "/*/elm/elm_type", "/elm/tag1",
    "/*/elm/tag1",       "/elm/node_number_list", "/*/elm/node_number_list", "/elmdata/*",      "/*/elmdata/*"};

/* A mesh of the file, in the group `name`; "" is the root. */
struct found {
    struct text name;
    const struct hdf5_value *coordinates, *types, *tags, *corners;
    const struct hdf5_value *field;
};

/* The dataset "PART/NAME" of the mesh, or NULL. */
static const struct hdf5_value *find_in_mesh(const struct hdf5 *hdf5, struct text mesh, const char *part,
                                             const char *name)
{
    char group[HDF5_NAME_LIMIT + 16];
    int length = snprintf(group, sizeof group, "%.*s/%s", (int)mesh.size, mesh.data, part);
    const struct hdf5_object *object = hdf5_find_in(hdf5, (struct text){group, (size_t)length}, name);
    return object ? &object->value : NULL;
}

/* The next mesh from object *at on. */
static bool next_mesh(struct found *out, const struct hdf5 *hdf5, size_t *at)
{
    static const char nodes[] = "/nodes/node_coord";
    bool is = false;
    while (!is && *at < hdf5_count(hdf5)) {
        struct text path = hdf5_object(hdf5, (*at)++)->value.name;
        size_t end = sizeof nodes - 1;
        struct text name = {path.data, path.size >= end ? path.size - end : 0};
        struct found mesh = {.name = name};
        is = path.size >= end && memcmp(path.data + name.size, nodes, end) == 0;
        if (is) {
            mesh.coordinates = &hdf5_object(hdf5, *at - 1)->value;
            mesh.types = find_in_mesh(hdf5, name, "elm", "elm_type");
            mesh.tags = find_in_mesh(hdf5, name, "elm", "tag1");
            mesh.corners = find_in_mesh(hdf5, name, "elm", "node_number_list");
            is = mesh.types && mesh.corners;
        }
        *out = is ? mesh : *out;
    }
    return is;
}

bool simnibs_is(const struct hdf5 *hdf5)
{
    struct found mesh = {0};
    size_t at = 0;
    return next_mesh(&mesh, hdf5, &at);
}

static const struct hdf5_value *find_field(const struct hdf5 *hdf5, struct text mesh, struct text wanted)
{
    static const char *const usual[] = {"magnE", "normE", "E"};
    const struct hdf5_value *field = NULL;
    char name[HDF5_NAME_LIMIT + 1];
    if (wanted.size) {
        snprintf(name, sizeof name, "%.*s", TEXT_SHOW(wanted, (size_t)HDF5_NAME_LIMIT));
        return find_in_mesh(hdf5, mesh, "elmdata", name);
    }
    for (size_t i = 0; !field && i < sizeof usual / sizeof usual[0]; i++) {
        field = find_in_mesh(hdf5, mesh, "elmdata", usual[i]);
    }
    return field;
}

static conus_status fail_without_field(const struct hdf5 *hdf5, struct text wanted)
{
    char names[LISTED + HDF5_NAME_LIMIT] = "";
    size_t length = 0;
    for (size_t i = 0; i < hdf5_count(hdf5) && length < LISTED; i++) {
        struct text path = hdf5_object(hdf5, i)->value.name;
        struct text name = hdf5_last_name(path);
        static const char folder[] = "/elmdata/";
        size_t before = path.size - name.size;
        if (before >= sizeof folder - 1 && memcmp(name.data - (sizeof folder - 1), folder, sizeof folder - 1) == 0) {
            length += (size_t)snprintf(names + length, sizeof names - length, "%s%.*s", length ? ", " : "",
                                       TEXT_SHOW(name, 60U));
        }
    }
    if (!length) {
        return fail(CONUS_ERROR_DATA, "elmdata: a mesh of SimNIBS without fields of elements");
    }
    return fail(CONUS_ERROR_ARGUMENT, "field: no %.*s of elements (elmdata); there are %s",
                TEXT_SHOW(wanted.size ? wanted : text_from("magnE, normE or E"), 60U), names);
}

/* The one mesh that has the field. */
static conus_status find_mesh(struct found *out, const struct hdf5 *hdf5, struct text wanted)
{
    struct found found = {0};
    struct found mesh;
    for (size_t at = 0; next_mesh(&mesh, hdf5, &at);) {
        mesh.field = find_field(hdf5, mesh.name, wanted);
        if (mesh.field && found.field) {
            return fail(CONUS_ERROR_DATA,
                        "field: two meshes have one, %.*s and %.*s; a file with one of them is needed",
                        TEXT_SHOW(found.field->name, 80U), TEXT_SHOW(mesh.field->name, 80U));
        }
        found = mesh.field ? mesh : found;
    }
    *out = found;
    return found.field ? CONUS_OK : fail_without_field(hdf5, wanted);
}

static bool is_whole(const struct hdf5_value *value)
{
    return value->class == HDF5_SIGNED || value->class == HDF5_UNSIGNED;
}

/* Whether the value has so many rows of so many numbers; of 1 number, rows need no second dimension. */
static bool has_shape(const struct hdf5_value *value, uint64_t rows, uint64_t columns)
{
    return value->rank >= 1 && value->dims[0] == rows &&
           (value->rank == 2 ? value->dims[1] == columns : value->rank == 1 && columns == 1);
}

static conus_status check_shapes(const struct found *mesh)
{
    const uint64_t nodes = mesh->coordinates->rank ? mesh->coordinates->dims[0] : 0;
    const uint64_t elements = mesh->corners->rank ? mesh->corners->dims[0] : 0;
    if (!hdf5_is_number(mesh->coordinates) || !has_shape(mesh->coordinates, nodes, 3) || nodes > UINT32_MAX) {
        return fail(CONUS_ERROR_DATA, "node_coord: three numbers for each node are needed");
    }
    if (!is_whole(mesh->corners) || !has_shape(mesh->corners, elements, CORNERS)) {
        return fail(CONUS_ERROR_DATA, "node_number_list: four whole numbers for each element are needed");
    }
    if (!is_whole(mesh->types) || !has_shape(mesh->types, elements, 1)) {
        return fail(CONUS_ERROR_DATA, "elm_type: a whole number for each of %llu elements is needed",
                    (unsigned long long)elements);
    }
    if (!mesh->tags || !is_whole(mesh->tags) || !has_shape(mesh->tags, elements, 1)) {
        return fail(CONUS_ERROR_DATA, "tag1: a whole number for each of %llu elements is needed",
                    (unsigned long long)elements);
    }
    if (!hdf5_is_number(mesh->field) || !(has_shape(mesh->field, elements, 1) || has_shape(mesh->field, elements, 3))) {
        struct text name = hdf5_last_name(mesh->field->name);
        return fail(CONUS_ERROR_DATA, "%.*s: one or three numbers for each of %llu elements are needed",
                    TEXT_SHOW(name, 60U), (unsigned long long)elements);
    }
    return CONUS_OK;
}

static conus_status take_nodes(struct roi_mesh *out, const struct hdf5_value *coordinates)
{
    const size_t count = (size_t)coordinates->dims[0];
    double(*nodes)[3] = memory_raw(count, sizeof *nodes);
    conus_status status = nodes ? CONUS_OK : CONUS_ERROR_MEMORY;
    for (size_t i = 0; !status && i < coordinates->count; i++) {
        double number = hdf5_number(coordinates, i);
        nodes[i / 3][i % 3] = number;
        if (!(fabs(number) <= farthest_mm)) {
            status = fail(CONUS_ERROR_DATA, "node_coord: node %zu: found %g, allowed are -10000 to 10000 mm", i / 3 + 1,
                          number);
        }
    }
    if (status) {
        memory_free(nodes);
        return status;
    }
    out->nodes = nodes;
    out->node_count = count;
    return CONUS_OK;
}

static float value_of(const struct hdf5_value *field, size_t element)
{
    const size_t columns = field->count / (size_t)field->dims[0];
    if (columns == 1) {
        return (float)hdf5_number(field, element);
    }
    const double vector[3] = {hdf5_number(field, 3 * element), hdf5_number(field, 3 * element + 1),
                              hdf5_number(field, 3 * element + 2)};
    return (float)vec3_length(vector);
}

static bool is_chosen(const struct volume_selector *selector, int64_t tissue)
{
    bool is = selector->tissue_count == 0;
    for (size_t i = 0; !is && i < selector->tissue_count; i++) {
        is = tissue == (int64_t)selector->tissues[i];
    }
    return is;
}

static conus_status take_tetrahedron(struct roi_mesh *out, const struct found *mesh, size_t element)
{
    struct tetrahedron tetrahedron = {.value = value_of(mesh->field, element)};
    for (size_t k = 0; k < CORNERS; k++) {
        int64_t node = hdf5_whole(mesh->corners, CORNERS * element + k);
        if (node < 1 || (uint64_t)node > out->node_count) {
            return fail(CONUS_ERROR_DATA, "node_number_list: element %zu: found node %lld, allowed are 1 to %zu",
                        element + 1, (long long)node, out->node_count);
        }
        tetrahedron.nodes[k] = (uint32_t)(node - 1);
    }
    out->tetrahedra[out->count++] = tetrahedron;
    return CONUS_OK;
}

/* Lists the tissues of the tetrahedra, as far as there is space: "1, 2, 5". Returns how many there are. */
static size_t list_tissues(char *out, size_t size, const struct found *mesh)
{
    int64_t seen[TISSUE_LIMIT];
    size_t count = 0;
    size_t length = 0;
    *out = '\0';
    for (size_t i = 0; i < mesh->types->count && count < TISSUE_LIMIT; i++) {
        int64_t tissue = hdf5_whole(mesh->tags, i);
        bool is_new = hdf5_whole(mesh->types, i) == TETRAHEDRON;
        for (size_t k = 0; is_new && k < count; k++) {
            is_new = seen[k] != tissue;
        }
        if (is_new && length < size) {
            seen[count++] = tissue;
            length += (size_t)snprintf(out + length, size - length, "%s%lld", length ? ", " : "", (long long)tissue);
        }
    }
    return count;
}

static conus_status take_tetrahedra(struct roi_mesh *out, const struct found *mesh,
                                    const struct volume_selector *selector)
{
    char tissues[LISTED];
    const size_t elements = mesh->types->count;
    conus_status status = CONUS_OK;
    out->tetrahedra = memory_raw(elements, sizeof *out->tetrahedra);
    if (!out->tetrahedra) {
        return CONUS_ERROR_MEMORY;
    }
    for (size_t i = 0; !status && i < elements; i++) {
        if (hdf5_whole(mesh->types, i) == TETRAHEDRON && is_chosen(selector, hdf5_whole(mesh->tags, i))) {
            status = take_tetrahedron(out, mesh, i);
        }
    }
    if (status || out->count) {
        return status;
    }
    return list_tissues(tissues, sizeof tissues, mesh)
               ? fail(CONUS_ERROR_ARGUMENT, "tissue: no tetrahedron has it (tag1); there are %s", tissues)
               : fail(CONUS_ERROR_DATA, "elm_type: no tetrahedra (4), which alone have a volume");
}

/* Says what was taken: a mesh of a head holds more than its brain. */
static conus_status note_choice(const struct found *mesh, const struct volume_selector *selector, struct notes *notes)
{
    char tissues[LISTED];
    struct text field = hdf5_last_name(mesh->field->name);
    bool is_vector = mesh->field->count != mesh->types->count;
    size_t count = list_tissues(tissues, sizeof tissues, mesh);
    bool are_all = count > 1 && !selector->tissue_count;
    return notes_add(notes, "%s%.*s of tetrahedra%s%s%s", is_vector ? "length of " : "", TEXT_SHOW(field, 60U),
                     are_all ? " of all tissues: tag1 " : "", are_all ? tissues : "",
                     are_all ? "; \",tissue=1:2\" takes white and grey matter" : "");
}

conus_status simnibs_find(struct roi_mesh *out, const struct hdf5 *hdf5, const struct volume_selector *selector,
                          struct notes *notes)
{
    struct roi_mesh found = {0};
    struct found mesh = {0};
    conus_status status = find_mesh(&mesh, hdf5, selector->field);
    status = status ? status : check_shapes(&mesh);
    status = status ? status : take_nodes(&found, mesh.coordinates);
    status = status ? status : take_tetrahedra(&found, &mesh, selector);
    status = status ? status : note_choice(&mesh, selector, notes);
    if (status) {
        memory_free(found.nodes);
        memory_free(found.tetrahedra);
        return status;
    }
    *out = found;
    return CONUS_OK;
}
