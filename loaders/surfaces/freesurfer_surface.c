/* SPDX-License-Identifier: BSD-3-Clause */
/* Parses FreeSurfer surfaces. */
#include "loaders/surfaces/freesurfer_surface.h"
#include "sources/signatures.h"

#include "base/byte_order.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "base/text.h"

enum { MAGIC_SIZE = 3, TAG_REAL_RAS = 2, TAG_GEOMETRY = 20 };

/* The volume of the footer. */
struct geometry {
    bool valid;
    double axes[9];
    double centre[3];
};

/* The bytes left to read. */
struct cursor {
    const uint8_t *data;
    size_t size;
};

static bool surface_take_bytes(struct cursor *cursor, size_t size, const uint8_t **out)
{
    if (size > cursor->size) {
        return false;
    }
    *out = cursor->data;
    cursor->data += size;
    cursor->size -= size;
    return true;
}

static bool surface_take_int(struct cursor *cursor, int32_t *out)
{
    const uint8_t *data;
    bool there = surface_take_bytes(cursor, 4, &data);
    *out = there ? order_i32(data, BIG_ENDIAN_IS_SWAPPED) : 0;
    return there;
}

/* The comment: a line, and mostly an empty one. */
static bool skip_comment(struct cursor *cursor)
{
    const uint8_t *end = cursor->size ? memchr(cursor->data, '\n', cursor->size) : NULL;
    const uint8_t *skipped;
    if (!end) {
        return false;
    }
    bool empty_line = end + 1 < cursor->data + cursor->size && end[1] == '\n';
    return surface_take_bytes(cursor, (size_t)(end + 1 - cursor->data) + empty_line, &skipped);
}

bool freesurfer_world_from_surface(double out[16], const double axes[9], const double centre[3])
{
    enum { X = 0, Y = 3, Z = 6 };
    static const double tolerance = 1e-3;
    for (int i = 0; i < 3; i++) {
        const double *a = axes + 3 * i;
        const double *b = axes + 3 * ((i + 1) % 3);
        if (!(fabs(vec3_length(a) - 1) <= tolerance) || !(fabs(vec3_dot(a, b)) <= tolerance)) {
            return false;
        }
    }
    mat4_identity(out);
    vec3_scale(out, axes + X, -1);
    vec3_scale(out + 4, axes + Z, 1);
    vec3_scale(out + 8, axes + Y, -1);
    memcpy(out + 12, centre, 3 * sizeof *centre);
    return true;
}

static bool surface_read_numbers(struct text text, double out[3])
{
    struct text word;
    for (int i = 0; i < 3; i++) {
        if (!text_word(&text, &word) || !text_to_double(word, &out[i]) || !isfinite(out[i])) {
            return false;
        }
    }
    return !text_word(&text, &word);
}

/* "xras   = -1 0 0" */
static bool surface_read_line(struct text *rest, const char *key, struct text *value)
{
    struct text line;
    bool more = true;
    struct text left;
    bool fine = text_line(rest, &line) && text_field(&line, '=', &more, &left) && more;
    *value = fine ? text_trim(line) : (struct text){0};
    return fine && text_equal(text_trim(left), key);
}

static conus_status read_geometry(struct geometry *out, struct text text)
{
    static const char *const keys[] = {"valid", "filename", "volume", "voxelsize", "xras", "yras", "zras", "cras"};
    enum { VALID = 0, VOLUME = 2, AXES = 4, CENTRE = 7 };
    struct geometry geometry = {0};
    for (size_t i = 0; i < sizeof keys / sizeof keys[0]; i++) {
        struct text value;
        double unused[3];
        double *numbers = i < AXES ? unused : i < CENTRE ? geometry.axes + 3 * (i - AXES) : geometry.centre;
        bool fine = surface_read_line(&text, keys[i], &value);
        if (!fine || (i >= VOLUME && !surface_read_numbers(value, numbers))) {
            return fail(CONUS_ERROR_DATA, "volume geometry: line \"%s = ...\" is missing or damaged", keys[i]);
        }
        if (i == VALID) {
            struct text word = {0};
            geometry.valid = text_word(&value, &word) && text_equal(word, "1");
        }
    }
    *out = geometry;
    return CONUS_OK;
}

/* Reads the footer: tags after the triangles, two of which matter. */
static conus_status place_in_world(struct mesh *mesh, struct cursor footer, struct notes *notes)
{
    struct geometry geometry = {0};
    bool real_ras = false;
    int32_t tag;
    int32_t value = 0;
    double world[16];
    if (surface_take_int(&footer, &tag) && tag == TAG_REAL_RAS) {
        if (!surface_take_int(&footer, &value)) {
            return fail(CONUS_ERROR_DATA, "footer: cut off after %zu bytes", footer.size);
        }
        real_ras = value != 0;
        (void)surface_take_int(&footer, &tag); /* 0 where there is none */
    }
    conus_status status = tag == TAG_GEOMETRY
                              ? read_geometry(&geometry, (struct text){(const char *)footer.data, footer.size})
                              : CONUS_OK;
    if (status) {
        return status;
    }
    if (real_ras) {
        return notes_add(notes, "FreeSurfer surface in scanner coordinates (useRealRAS): taken as they are");
    }
    if (!geometry.valid) {
        return notes_warn(notes, "FreeSurfer surface without a valid volume geometry: c_ras is not known, surface "
                                 "coordinates were taken as the world's; behind FILE ',space=ras' says that they are, "
                                 "'mris_convert --to-scanner' makes them so");
    }
    if (!freesurfer_world_from_surface(world, geometry.axes, geometry.centre)) {
        return fail(CONUS_ERROR_DATA, "volume geometry: xras, yras and zras are no directions at right angles");
    }
    mesh_transform(mesh, world);
    return notes_add(notes,
                     "FreeSurfer surface coordinates were moved into the scanner's by the volume geometry in the file "
                     "(c_ras %g, %g, %g)",
                     geometry.centre[0], geometry.centre[1], geometry.centre[2]);
}

static conus_status fill_mesh(struct mesh *mesh, struct cursor *cursor)
{
    const uint8_t *data = NULL;
    bool there = surface_take_bytes(cursor, 12 * mesh->vertex_count, &data);
    for (size_t i = 0; there && i < 3 * mesh->vertex_count; i++) {
        mesh->positions[i] = order_f32(data + 4 * i, BIG_ENDIAN_IS_SWAPPED);
    }
    there = there && surface_take_bytes(cursor, 12 * mesh->triangle_count, &data);
    for (size_t i = 0; there && i < 3 * mesh->triangle_count; i++) {
        mesh->triangles[i] = order_u32(data + 4 * i, BIG_ENDIAN_IS_SWAPPED); /* below 0 becomes too large */
        if (mesh->triangles[i] >= mesh->vertex_count) {
            return fail(CONUS_ERROR_DATA, "triangle %zu: vertex index %d, allowed are 0 to %zu", i / 3,
                        (int)mesh->triangles[i], mesh->vertex_count - 1);
        }
    }
    return CONUS_OK;
}

static conus_status read_counts(struct cursor *cursor, int32_t *vertices, int32_t *triangles)
{
    const uint8_t *magic;
    if (!surface_take_bytes(cursor, MAGIC_SIZE, &magic) || !freesurfer_is_surface(magic, MAGIC_SIZE)) {
        return fail(CONUS_ERROR_DATA, "not a FreeSurfer surface: it must begin with the bytes ff ff fe");
    }
    if (freesurfer_is_curvature(magic, MAGIC_SIZE + cursor->size)) {
        return fail(CONUS_ERROR_UNSUPPORTED, "FreeSurfer's values of vertices (ff ff ff), not a surface");
    }
    if (magic[2] != 0xfe) {
        return fail(CONUS_ERROR_UNSUPPORTED,
                    "a FreeSurfer surface of quadrangles (ff ff %02x), triangles (ff ff fe) are read; mris_convert "
                    "converts it",
                    (unsigned)magic[2]);
    }
    if (!skip_comment(cursor) || !surface_take_int(cursor, vertices) || !surface_take_int(cursor, triangles)) {
        return fail(CONUS_ERROR_DATA, "header: cut off before the numbers of vertices and triangles");
    }
    if (*vertices < 1 || *triangles < 1) {
        return fail(CONUS_ERROR_DATA, "header: %d vertices and %d triangles, allowed are 1 or more", *vertices,
                    *triangles);
    }
    uint64_t needed = 12 * ((uint64_t)*vertices + (uint64_t)*triangles);
    if (needed > cursor->size) {
        return fail(CONUS_ERROR_DATA, "%d vertices and %d triangles need %llu bytes, the file has %zu", *vertices,
                    *triangles, (unsigned long long)needed, cursor->size);
    }
    return CONUS_OK;
}

conus_status freesurfer_surface_parse(struct mesh *out, const uint8_t *data, size_t size, bool as_stored,
                                      struct notes *notes)
{
    struct cursor cursor = {data, size};
    struct mesh mesh = {0};
    int32_t vertices = 0;
    int32_t triangles = 0;
    conus_status status;
    if ((status = read_counts(&cursor, &vertices, &triangles)) ||
        (status = mesh_init(&mesh, (size_t)vertices, (size_t)triangles)) || (status = fill_mesh(&mesh, &cursor)) ||
        (!as_stored && (status = place_in_world(&mesh, cursor, notes)))) {
        mesh_finish(&mesh);
        return status;
    }
    *out = mesh;
    return CONUS_OK;
}
