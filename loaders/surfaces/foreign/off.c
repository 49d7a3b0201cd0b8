/* SPDX-License-Identifier: BSD-3-Clause */
/* Parses Geomview's OFF as text. */
#include "loaders/surfaces/foreign/foreign.h"

#include "loaders/surfaces/foreign/parts.h"

/* The layout of a vertex. Colours, normals and texture coordinates are numbers behind its position, and are skipped. */
struct off {
    size_t numbers;   /* behind the first three; any number of them for colours */
    bool has_colours; /* of vertices: to the end of the line */
};

/* The word that a file begins with, [ST][C][N]OFF, perhaps with the number of vertices right behind it. It may be
 * missing. */
static void read_keyword(struct off *out, struct scan *scan)
{
    struct text word;
    int64_t count;
    if (!scan_peek(scan, &word) || text_to_int(word, &count)) {
        return;
    }
    (void)scan_word(scan, &word);
    struct text rest = word;
    bool texture = text_starts(rest, "ST");
    rest = texture ? (struct text){rest.data + 2, rest.size - 2} : rest;
    out->has_colours = text_starts(rest, "C");
    rest = out->has_colours ? (struct text){rest.data + 1, rest.size - 1} : rest;
    bool normals = text_starts(rest, "N");
    rest = normals ? (struct text){rest.data + 1, rest.size - 1} : rest;
    out->numbers = (normals ? 3U : 0U) + (texture ? 2U : 0U);
    if (text_starts(rest, "OFF") && text_to_int((struct text){rest.data + 3, rest.size - 3}, &count)) {
        scan->r.at = (const uint8_t *)rest.data + 3;
    } else if (!text_equal(rest, "OFF")) {
        job_refuse(scan->r.job, "header: \"%.*s\", allowed are OFF, COFF, NOFF, CNOFF and ST in front",
                   TEXT_SHOW(word, 60));
    }
}

/* Takes the numbers that are left on the line; all of them must be numbers. */
static void skip_colour(struct scan *scan)
{
    struct text line;
    struct text word;
    double value;
    (void)scan_line(scan, &line);
    while (text_word(&line, &word) && *word.data != scan->comment) {
        if (!text_to_double(word, &value)) {
            scan->line--;
            scan_refuse(scan, word, "a colour");
            return;
        }
    }
}

static void read_vertex(struct mesh_sink *sink, const struct off *off, struct scan *scan)
{
    float position[3];
    for (int a = 0; a < 3; a++) {
        position[a] = scan_float(scan, "a vertex of three numbers");
    }
    for (size_t i = 0; i < off->numbers; i++) {
        (void)scan_float(scan, "a normal or a texture coordinate");
    }
    if (off->has_colours) {
        skip_colour(scan);
    }
    sink_vertex(sink, position);
}

/* A colour may follow the corners. */
static void read_face(struct mesh_sink *sink, struct scan *scan)
{
    const size_t count = scan_count(scan, 2, "number of corners");
    for (size_t i = 0; i < count && job_ok(sink->job); i++) {
        sink_corner(sink, scan_whole(scan, 0, "the number of a vertex"));
    }
    skip_colour(scan);
    sink_end(sink, CELL_POLYGON);
}

void off_parse(struct mesh_sink *sink, struct text file)
{
    struct scan scan = scan_of(sink->job, file);
    struct off off = {0};
    struct text word;
    scan.comment = '#';
    read_keyword(&off, &scan);
    if (scan_peek(&scan, &word) && text_equal(word, "BINARY")) {
        job_refuse(sink->job, "header: a binary OFF file, only text is read");
    }
    const size_t vertices = scan_count(&scan, 6, "number of vertices");
    const size_t faces = scan_count(&scan, 2, "number of faces");
    (void)scan_whole(&scan, 0, "number of edges");
    sink_expect(sink, vertices);
    for (size_t i = 0; i < vertices && job_ok(sink->job); i++) {
        read_vertex(sink, &off, &scan);
    }
    for (size_t i = 0; i < faces && job_ok(sink->job); i++) {
        read_face(sink, &scan);
    }
    scan_end(&scan, "the last face");
}
