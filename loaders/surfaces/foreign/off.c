/* SPDX-License-Identifier: BSD-3-Clause */
/* Parses Geomview's OFF as text. */
#include "loaders/surfaces/foreign/foreign_mesh.h"

#include "loaders/surfaces/foreign/words.h"

/* The layout of a vertex. Colours, normals and texture coordinates are numbers behind its position, and are skipped. */
struct off {
    size_t numbers;   /* behind the first three; any number of them for colours */
    bool has_colours; /* of vertices: to the end of the line */
};

/* The word that a file begins with: [ST][C][N]OFF, perhaps with the number of vertices right behind it. */
static conus_status read_keyword(struct off *out, struct words *words, struct text word)
{
    struct text rest = word;
    bool texture = text_starts(rest, "ST");
    rest = texture ? (struct text){rest.data + 2, rest.size - 2} : rest;
    out->has_colours = text_starts(rest, "C");
    rest = out->has_colours ? (struct text){rest.data + 1, rest.size - 1} : rest;
    bool normals = text_starts(rest, "N");
    rest = normals ? (struct text){rest.data + 1, rest.size - 1} : rest;
    out->numbers = (normals ? 3U : 0U) + (texture ? 2U : 0U);
    int64_t count;
    if (text_starts(rest, "OFF") && text_to_int((struct text){rest.data + 3, rest.size - 3}, &count)) {
        words->rest.size += rest.size - 3;
        words->rest.data = rest.data + 3;
        return CONUS_OK;
    }
    return text_equal(rest, "OFF")
               ? CONUS_OK
               : fail(CONUS_ERROR_UNSUPPORTED, "header: \"%.*s\", allowed are OFF, COFF, NOFF, CNOFF and ST in front",
                      TEXT_SHOW(word, 60));
}

/* Takes the numbers that are left on the line; all of them must be numbers. */
static conus_status off_skip_numbers(struct words *words, const char *what)
{
    struct text line = {0};
    struct text word;
    double value;
    (void)words_line(words, &line);
    while (text_word(&line, &word) && *word.data != words->comment) {
        if (!text_to_double(word, &value)) {
            words->line--;
            return words_fail(words, word, what);
        }
    }
    return CONUS_OK;
}

static conus_status read_vertex(struct foreign_mesh *out, const struct off *off, struct words *words)
{
    float position[3];
    double value;
    conus_status status = CONUS_OK;
    for (int a = 0; !status && a < 3; a++) {
        status = words_float(&position[a], words, "a vertex of three numbers");
    }
    for (size_t i = 0; !status && i < off->numbers; i++) {
        status = words_number(&value, words, "a normal or a texture coordinate");
    }
    if (status || (off->has_colours && (status = off_skip_numbers(words, "a colour")))) {
        return status;
    }
    return foreign_add_vertex(out, position);
}

/* A colour may follow the corners. */
static conus_status read_face(struct foreign_mesh *out, struct words *words)
{
    size_t count = 0;
    conus_status status = words_count(&count, words, 2, "number of corners");
    for (size_t i = 0; !status && i < count; i++) {
        int64_t index;
        status = words_whole(&index, words, 0, "the number of a vertex");
        status = status ? status : foreign_add_corner(out, index);
    }
    if (status || (status = off_skip_numbers(words, "a colour"))) {
        return status;
    }
    return foreign_end_polygon(out);
}

conus_status off_parse(struct foreign_mesh *out, const uint8_t *data, size_t size)
{
    struct words words = {.rest = {(const char *)data, size}, .line = 1, .comment = '#'};
    struct off off = {0};
    size_t vertices = 0;
    size_t faces = 0;
    int64_t number;
    struct text word;
    conus_status status = CONUS_OK;
    if (words_peek(&words, &word) && !text_to_int(word, &number)) { /* the keyword may be missing */
        (void)words_next(&words, &word);
        status = read_keyword(&off, &words, word);
    }
    if (status) {
        return status;
    }
    if (words_peek(&words, &word) && text_equal(word, "BINARY")) {
        return fail(CONUS_ERROR_UNSUPPORTED, "header: a binary OFF file, only text is read");
    }
    if ((status = words_count(&vertices, &words, 6, "number of vertices")) ||
        (status = words_count(&faces, &words, 2, "number of faces")) ||
        (status = words_whole(&number, &words, 0, "number of edges")) ||
        (status = foreign_reserve_vertices(out, vertices))) {
        return status;
    }
    for (size_t i = 0; !status && i < vertices; i++) {
        status = read_vertex(out, &off, &words);
    }
    for (size_t i = 0; !status && i < faces; i++) {
        status = read_face(out, &words);
    }
    return status ? status : words_end(&words, "the last face");
}
