/* SPDX-License-Identifier: BSD-3-Clause */
/* Parses FreeSurfer surfaces. */
#include "loaders/surfaces/parts.h"
#include "sources/source.h"

#include "base/byte_order.h"
#include "base/geometry/math3.h"
#include "base/text.h"

enum { MAGIC_SIZE = 3, CURVATURE_SIZE = 15, TAG_REAL_RAS = 2, TAG_GEOMETRY = 20 };

/* The volume of the footer. */
struct geometry {
    bool valid;
    double axes[9];
    double centre[3];
};

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

/* The value of "xras   = -1 0 0"; empty where the line has another key. */
static struct text surface_read_line(struct reader *r, const char *key)
{
    struct text line;
    bool more = true;
    struct text left;
    bool fine = reader_line(r, &line) && text_field(&line, '=', &more, &left) && more;
    return fine && text_equal(text_trim(left), key) ? text_trim(line) : (struct text){0};
}

static struct geometry read_geometry(struct reader *r)
{
    static const char *const keys[] = {"valid", "filename", "volume", "voxelsize", "xras", "yras", "zras", "cras"};
    enum { VALID = 0, VOLUME = 2, AXES = 4, CENTRE = 7 };
    struct geometry geometry = {0};
    for (size_t i = 0; i < sizeof keys / sizeof keys[0]; i++) {
        double unused[3];
        double *numbers = i < AXES ? unused : i < CENTRE ? geometry.axes + 3 * (i - AXES) : geometry.centre;
        struct text value = surface_read_line(r, keys[i]);
        if (!value.data || (i >= VOLUME && !surface_read_numbers(value, numbers))) {
            job_bad(r->job, "volume geometry: line \"%s = ...\" is missing or damaged", keys[i]);
        }
        struct text word = {0};
        if (i == VALID) {
            geometry.valid = text_word(&value, &word) && text_equal(word, "1");
        }
    }
    return geometry;
}

/* The next tag; 0 where there is none. */
static uint32_t next_tag(struct reader *r)
{
    return reader_has(r, 4) ? reader_u32(r) : 0;
}

/* Reads the footer: tags after the triangles, two of which matter. */
static void place_in_world(struct reader *r, struct mesh *mesh)
{
    struct job *job = r->job;
    double world[16];
    uint32_t tag = next_tag(r);
    bool real_ras = false;
    if (tag == TAG_REAL_RAS && !reader_has(r, 4)) {
        job_bad(job, "footer: cut off after %zu bytes", (size_t)(r->end - r->at));
    } else if (tag == TAG_REAL_RAS) {
        real_ras = reader_u32(r) != 0;
        tag = next_tag(r);
    }
    const struct geometry geometry = tag == TAG_GEOMETRY ? read_geometry(r) : (struct geometry){0};
    if (real_ras) {
        job_note(job, "FreeSurfer surface in scanner coordinates (useRealRAS): taken as they are");
    } else if (!geometry.valid) {
        job_warn(job, "FreeSurfer surface without a valid volume geometry: c_ras is not known, surface coordinates "
                      "were taken as the world's; ',space=ras' behind FILE says that they are, 'mris_convert "
                      "--to-scanner' makes them so");
    } else if (!freesurfer_world_from_surface(world, geometry.axes, geometry.centre)) {
        job_bad(job, "volume geometry: xras, yras and zras are no directions at right angles");
    } else {
        mesh_transform(mesh, world);
        job_note(job,
                 "FreeSurfer surface coordinates were moved into the scanner's by the volume geometry in the file "
                 "(c_ras %g, %g, %g)",
                 geometry.centre[0], geometry.centre[1], geometry.centre[2]);
    }
}

static void fill_mesh(struct reader *r, struct mesh *mesh)
{
    const size_t corners = 3 * mesh->triangle_count;
    const size_t numbers = 3 * mesh->vertex_count;
    size_t size = 1;
    for (size_t i = 0; i < numbers && size;) {
        const uint8_t *data = reader_some(r, 4 * (uint64_t)(numbers - i), 4, &size);
        for (size_t k = 0; k < size; k += 4) {
            mesh->positions[i++] = order_f32(data + k, r->swapped);
        }
    }
    for (size_t i = 0; i < corners && size;) {
        const uint8_t *data = reader_some(r, 4 * (uint64_t)(corners - i), 4, &size);
        for (size_t k = 0; k < size; k += 4) {
            const uint32_t vertex = order_u32(data + k, r->swapped); /* below 0 becomes too large */
            if (vertex >= mesh->vertex_count) {
                job_bad(r->job, "triangle %zu: vertex index %d, allowed are 0 to %zu", i / 3, (int)vertex,
                        mesh->vertex_count - 1);
                return;
            }
            mesh->triangles[i++] = vertex;
        }
    }
    if (!size) {
        job_bad(r->job, "cut off at byte %llu, within its vertices and triangles", (unsigned long long)reader_at(r));
    }
}

static void make_mesh(struct reader *r, struct mesh *mesh)
{
    struct job *job = r->job;
    struct text comment; /* a line, and mostly an empty one behind it */
    (void)reader_has(r, CURVATURE_SIZE);
    const size_t at_hand = (size_t)(r->end - r->at);
    if (!freesurfer_is_surface(r->at, at_hand)) {
        job_bad(job, "not a FreeSurfer surface: it must begin with the bytes ff ff fe");
    } else if (freesurfer_is_curvature(r->at, at_hand)) {
        job_refuse(job, "FreeSurfer's values of vertices (ff ff ff), not a surface");
    } else if (r->at[2] != 0xfe) {
        job_refuse(job,
                   "a FreeSurfer surface of quadrangles (ff ff %02x), triangles (ff ff fe) are read; mris_convert "
                   "converts it",
                   (unsigned)r->at[2]);
    }
    reader_skip(r, MAGIC_SIZE);
    (void)reader_line(r, &comment);
    reader_skip(r, reader_has(r, 1) && *r->at == '\n');
    if (!reader_has(r, 8)) {
        job_bad(job, "header: cut off before the numbers of vertices and triangles");
    }
    const int32_t vertices = (int32_t)reader_u32(r);
    const int32_t triangles = (int32_t)reader_u32(r);
    if (vertices < 1 || triangles < 1) {
        job_bad(job, "header: %d vertices and %d triangles, allowed are 1 or more", vertices, triangles);
    }
    const uint64_t needed = 12 * ((uint64_t)vertices + (uint64_t)triangles);
    if (needed > reader_most(r)) {
        job_bad(job, "%d vertices and %d triangles need %llu bytes, the file has %llu", vertices, triangles,
                (unsigned long long)needed, (unsigned long long)reader_most(r));
    }
    (void)JOB_CALL(job, mesh_init(mesh, (size_t)vertices, (size_t)triangles));
}

void freesurfer_surface_read(struct reader *r, struct mesh *out, bool as_stored)
{
    r->swapped = BIG_ENDIAN_IS_SWAPPED;
    make_mesh(r, out);
    fill_mesh(r, out);
    if (job_ok(r->job) && !as_stored) {
        place_in_world(r, out);
    }
}
