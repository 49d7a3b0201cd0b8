/* SPDX-License-Identifier: BSD-3-Clause */
/* Parses STL, text and binary, and joins the corners that are at one place. */
#include "loaders/surfaces/foreign/foreign_mesh.h"

#include "atlas/surface/mesh_closed.h"
#include "base/byte_order.h"
#include "base/memory.h"
#include "loaders/surfaces/foreign/words.h"

enum { HEADER = 80, COUNT = 4, TRIANGLE = 50, NORMAL = 12, CORNER = 12 };

static conus_status add_triangle(struct foreign_mesh *mesh)
{
    uint32_t last = (uint32_t)mesh->vertex_count - 1;
    mesh->face_count++;
    return foreign_add_triangle(mesh, last - 2, last - 1, last);
}

static conus_status read_binary(struct foreign_mesh *out, const uint8_t *data, size_t size)
{
    const bool swapped = !BIG_ENDIAN_IS_SWAPPED;
    conus_status status = CONUS_OK;
    if (size < HEADER + COUNT) {
        return fail(CONUS_ERROR_DATA, "content: %zu bytes, a binary STL file has %d or more", size, HEADER + COUNT);
    }
    uint64_t needed = HEADER + COUNT + TRIANGLE * (uint64_t)order_u32(data + HEADER, swapped);
    if (size != needed) {
        return fail(CONUS_ERROR_DATA, "content: %zu bytes, a binary STL file of %u triangles has %llu", size,
                    order_u32(data + HEADER, swapped), (unsigned long long)needed);
    }
    for (size_t at = HEADER + COUNT; !status && at < size; at += TRIANGLE) {
        for (size_t k = 0; !status && k < 3; k++) {
            float position[3];
            for (size_t a = 0; a < 3; a++) {
                position[a] = order_f32(data + at + NORMAL + CORNER * k + sizeof(float) * a, swapped);
            }
            status = foreign_add_vertex(out, position);
        }
        status = status ? status : add_triangle(out);
    }
    return status;
}

static conus_status need_word(struct words *words, const char *wanted)
{
    struct text word;
    return words_next(words, &word) && text_equal_ignoring_case(word, wanted) ? CONUS_OK
                                                                              : words_fail(words, word, wanted);
}

static conus_status read_corners(struct foreign_mesh *out, struct words *words)
{
    conus_status status = CONUS_OK;
    for (int k = 0; !status && k < 3; k++) {
        float position[3];
        status = need_word(words, "vertex");
        for (int a = 0; !status && a < 3; a++) {
            status = words_float(&position[a], words, "a vertex of three numbers");
        }
        status = status ? status : foreign_add_vertex(out, position);
    }
    return status ? status : add_triangle(out);
}

/* Reads a facet after the word "facet". */
static conus_status read_facet(struct foreign_mesh *out, struct words *words)
{
    struct text word;
    double value;
    conus_status status = need_word(words, "normal");
    for (int a = 0; !status && a < 3; a++) { /* the normal is not used: "nan" is a number, too */
        status = words_next(words, &word) && text_to_double(word, &value)
                     ? CONUS_OK
                     : words_fail(words, word, "a normal of three numbers");
    }
    if (status || (status = need_word(words, "outer")) || (status = need_word(words, "loop")) ||
        (status = read_corners(out, words)) || (status = need_word(words, "endloop"))) {
        return status;
    }
    return need_word(words, "endfacet");
}

/* From "solid" and its name to "endsolid" and perhaps the same. */
static conus_status read_solid(struct foreign_mesh *out, struct words *words)
{
    struct text word;
    struct text name;
    conus_status status = need_word(words, "solid");
    (void)words_line(words, &name);
    while (!status && words_take(words, "facet")) {
        status = read_facet(out, words);
    }
    if (!status && (!words_next(words, &word) || !text_equal_ignoring_case(word, "endsolid"))) {
        status = words_fail(words, word, "facet or endsolid");
    }
    (void)words_line(words, &name);
    return status;
}

/* Corners at one place become one vertex. */
static conus_status join_corners(struct foreign_mesh *mesh)
{
    const struct mesh all = {.positions = mesh->positions, .vertex_count = mesh->vertex_count};
    uint32_t *first = memory_raw(mesh->vertex_count, sizeof *first);
    conus_status status = first ? mesh_find_first(first, &all) : CONUS_ERROR_MEMORY;
    size_t kept = 0;
    for (size_t v = 0; !status && v < mesh->vertex_count; v++) { /* triangle v / 3 has corner v */
        if (first[v] == v) {
            memmove(&mesh->positions[3 * kept], &mesh->positions[3 * v], 3 * sizeof *mesh->positions);
            mesh->triangles[v] = (uint32_t)kept++;
        } else {
            mesh->triangles[v] = mesh->triangles[first[v]];
        }
    }
    mesh->vertex_count = status ? mesh->vertex_count : kept;
    memory_free(first);
    return status;
}

conus_status stl_parse(struct foreign_mesh *out, const uint8_t *data, size_t size)
{
    struct text header = {(const char *)data, size < HEADER ? size : HEADER};
    struct text line = {0};
    if (text_line(&header, &line)) {
        out->space = foreign_space_in(line);
    }
    /* Text begins with "solid". So may the header of a binary file, which has a 0 somewhere. */
    struct text text = {(const char *)data, size};
    bool is_text = text_starts(text_trim(text), "solid") && !memchr(data, '\0', size);
    struct words words = {.rest = text, .line = 1};
    struct text word;
    conus_status status = is_text ? CONUS_OK : read_binary(out, data, size);
    for (bool more = is_text; !status && more; more = words_peek(&words, &word)) {
        status = read_solid(out, &words);
    }
    return status ? status : join_corners(out);
}
