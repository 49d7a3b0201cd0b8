/* SPDX-License-Identifier: BSD-3-Clause */
/* Finds tetrahedra and their values in a mesh of SimNIBS (simnibs/mesh_tools/mesh_io.py, Msh.write_hdf5). */
#include "loaders/maps/maps.h"

#include "base/geometry/math3.h"

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
    char name[HDF5_NAME_LIMIT + 1];
    const char *const names[] = {name, "magnE", "normE", "E"};
    const struct hdf5_value *field = NULL;
    snprintf(name, sizeof name, "%.*s", TEXT_SHOW(wanted, (size_t)HDF5_NAME_LIMIT));
    for (size_t i = wanted.size ? 0 : 1; !field && i < (wanted.size ? 1 : sizeof names / sizeof names[0]); i++) {
        field = find_in_mesh(hdf5, mesh, "elmdata", names[i]);
    }
    return field;
}

/* Says which fields of elements there are instead. */
static void refuse_field(struct job *job, const struct hdf5 *hdf5, struct text wanted)
{
    static const char folder[] = "/elmdata/";
    const size_t length = sizeof folder - 1;
    struct buffer names = {0};
    for (size_t i = 0; i < hdf5_count(hdf5) && names.size < LISTED; i++) {
        struct text path = hdf5_object(hdf5, i)->value.name;
        struct text name = hdf5_last_name(path);
        size_t before = path.size - name.size;
        if (before >= length && memcmp(name.data - length, folder, length) == 0) {
            buffer_format(&names, "%s%.*s", names.size ? ", " : "", TEXT_SHOW(name, 60U));
        }
    }
    (void)JOB_CALL(job, buffer_status(&names));
    if (!names.size) {
        job_bad(job, "elmdata: a mesh of SimNIBS without fields of elements");
    }
    job_fail(job, CONUS_ERROR_ARGUMENT, "field: no %.*s of elements (elmdata); there are %s",
             TEXT_SHOW(wanted.size ? wanted : text_from("magnE, normE or E"), 60U), names.size ? names.data : "");
    buffer_finish(&names);
}

/* The one mesh that has the field. */
static struct found find_mesh(struct job *job, const struct hdf5 *hdf5, struct text wanted)
{
    struct found found = {0};
    struct found mesh;
    for (size_t at = 0; next_mesh(&mesh, hdf5, &at);) {
        mesh.field = find_field(hdf5, mesh.name, wanted);
        if (mesh.field && found.field) {
            job_bad(job, "field: two meshes have one, %.*s and %.*s; a file with one of them is needed",
                    TEXT_SHOW(found.field->name, 80U), TEXT_SHOW(mesh.field->name, 80U));
        }
        found = mesh.field ? mesh : found;
    }
    if (!found.field) {
        refuse_field(job, hdf5, wanted);
    }
    return found;
}

/* Whether the value has so many rows of so many numbers; of 1 number, rows need no second dimension. */
static bool has_shape(const struct hdf5_value *value, uint64_t rows, uint64_t columns)
{
    return value->rank >= 1 && value->dims[0] == rows &&
           (value->rank == 2 ? value->dims[1] == columns : value->rank == 1 && columns == 1);
}

static bool is_whole(const struct hdf5_value *value, uint64_t rows, uint64_t columns)
{
    return value && (value->class == HDF5_SIGNED || value->class == HDF5_UNSIGNED) && has_shape(value, rows, columns);
}

static void check_shapes(struct job *job, const struct found *mesh)
{
    const uint64_t nodes = mesh->coordinates->rank ? mesh->coordinates->dims[0] : 0;
    const uint64_t elements = mesh->corners->rank ? mesh->corners->dims[0] : 0;
    const unsigned long long count = elements;
    if (!hdf5_is_number(mesh->coordinates) || !has_shape(mesh->coordinates, nodes, 3) || nodes > UINT32_MAX) {
        job_bad(job, "node_coord: three numbers for each node are needed");
    }
    if (!is_whole(mesh->corners, elements, CORNERS)) {
        job_bad(job, "node_number_list: four whole numbers for each element are needed");
    }
    if (!is_whole(mesh->types, elements, 1)) {
        job_bad(job, "elm_type: a whole number for each of %llu elements is needed", count);
    }
    if (!is_whole(mesh->tags, elements, 1)) {
        job_bad(job, "tag1: a whole number for each of %llu elements is needed", count);
    }
    if (!hdf5_is_number(mesh->field) || !(has_shape(mesh->field, elements, 1) || has_shape(mesh->field, elements, 3))) {
        job_bad(job, "%.*s: one or three numbers for each of %llu elements are needed",
                TEXT_SHOW(hdf5_last_name(mesh->field->name), 60U), count);
    }
}

static void take_nodes(struct job *job, struct roi_mesh *out, const struct hdf5_value *coordinates)
{
    out->node_count = (size_t)coordinates->dims[0];
    out->nodes = job_array(job, &out->node_count, sizeof *out->nodes);
    for (size_t i = 0; i < 3 * out->node_count; i++) {
        double number = hdf5_number(coordinates, i);
        out->nodes[i / 3][i % 3] = number;
        if (!(fabs(number) <= farthest_mm)) {
            job_bad(job, "node_coord: node %zu: found %g, allowed are -10000 to 10000 mm", i / 3 + 1, number);
            return;
        }
    }
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

static bool is_chosen(const struct key_value *wanted, int64_t tissue)
{
    bool is = wanted->count == 0;
    for (size_t i = 0; !is && i < wanted->count; i++) {
        is = tissue == (int64_t)wanted->numbers[i];
    }
    return is;
}

static void take_tetrahedron(struct job *job, struct roi_mesh *out, const struct found *mesh, size_t element)
{
    struct tetrahedron tetrahedron = {.value = value_of(mesh->field, element)};
    for (size_t k = 0; k < CORNERS; k++) {
        int64_t node = hdf5_whole(mesh->corners, CORNERS * element + k);
        if (node < 1 || (uint64_t)node > out->node_count) {
            job_bad(job, "node_number_list: element %zu: found node %lld, allowed are 1 to %zu", element + 1,
                    (long long)node, out->node_count);
        }
        tetrahedron.nodes[k] = (uint32_t)(node - 1);
    }
    out->tetrahedra[out->count++] = tetrahedron;
}

/* Lists the tissues of the tetrahedra, as far as there is space: "1, 2, 5". Returns how many there are. */
static size_t list_tissues(char *out, size_t size, const struct found *mesh)
{
    int64_t seen[KEY_NUMBERS];
    size_t count = 0;
    size_t length = 0;
    *out = '\0';
    for (size_t i = 0; i < mesh->types->count && count < KEY_NUMBERS; i++) {
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

/* Takes the tetrahedra of the tissues, and says which: a mesh of a head holds more than its brain. */
static void take_tetrahedra(struct job *job, struct roi_mesh *out, const struct found *mesh,
                            const struct source_keys *keys)
{
    char tissues[LISTED];
    const struct key_value *wanted = keys_value(keys, KEY_TISSUE);
    const size_t elements = mesh->types->count;
    out->tetrahedra = job_raw(job, elements, sizeof *out->tetrahedra);
    for (size_t i = 0; job_ok(job) && i < elements; i++) {
        if (hdf5_whole(mesh->types, i) == TETRAHEDRON && is_chosen(wanted, hdf5_whole(mesh->tags, i))) {
            take_tetrahedron(job, out, mesh, i);
        }
    }
    const size_t count = list_tissues(tissues, sizeof tissues, mesh);
    if (!count) {
        job_bad(job, "elm_type: no tetrahedra (4), which alone have a volume");
    } else if (!out->count) {
        job_fail(job, CONUS_ERROR_ARGUMENT, "tissue: no tetrahedron has it (tag1); there are %s", tissues);
    }
    bool is_vector = mesh->field->count != elements;
    bool are_all = count > 1 && !wanted->count;
    job_note(job, "%s: %s%.*s of tetrahedra%s%s%s", keys->path, is_vector ? "length of " : "",
             TEXT_SHOW(hdf5_last_name(mesh->field->name), 60U), are_all ? " of all tissues: tag1 " : "",
             are_all ? tissues : "", are_all ? "; \",tissue=1:2\" takes white and grey matter" : "");
}

struct roi_mesh simnibs_find(struct job *job, const struct hdf5 *hdf5, const struct source_keys *keys)
{
    struct roi_mesh out = {0};
    const struct found mesh = find_mesh(job, hdf5, keys_value(keys, KEY_FIELD)->text);
    if (!job_ok(job) || !mesh.coordinates) {
        return out;
    }
    check_shapes(job, &mesh);
    if (job_ok(job)) {
        take_nodes(job, &out, mesh.coordinates);
        take_tetrahedra(job, &out, &mesh, keys);
    }
    return out;
}
