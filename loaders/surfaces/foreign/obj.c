/* SPDX-License-Identifier: BSD-3-Clause */
/* Parses Wavefront's OBJ: vertices first, then faces, so that a face may come before its vertices. */
#include "loaders/surfaces/foreign/foreign.h"

#include "loaders/surfaces/foreign/parts.h"

#include <math.h>
#include <string.h>

struct obj {
    struct scan scan;
    size_t began;     /* the line on which the statement begins, */
    struct text text; /* that line, */
    struct text line; /* and what is left of it */
    struct mesh_sink *sink;
    size_t vertices;  /* so far; a negative index counts back from here */
    bool has_strange; /* a statement was noted */
};

/* The next word of the statement, which goes on behind a backslash at the end of a line. */
static bool obj_next_word(struct obj *obj, struct text *word)
{
    bool there = text_word(&obj->line, word);
    while (there && word->data[word->size - 1] == '\\' && !text_trim(obj->line).size) {
        if (--word->size) {
            (void)scan_line(&obj->scan, &obj->line);
            return true;
        }
        there = scan_line(&obj->scan, &obj->line) && text_word(&obj->line, word);
    }
    return there;
}

/* The next statement's first word. */
static bool next_statement(struct obj *obj, struct text *word)
{
    struct text rest = text_trim(obj->line);
    while (rest.size && rest.data[rest.size - 1] == '\\') { /* of a statement that is not read */
        rest = scan_line(&obj->scan, &obj->line) ? text_trim(obj->line) : (struct text){0};
    }
    do {
        obj->began = obj->scan.line;
        if (!scan_line(&obj->scan, &obj->line)) {
            return false;
        }
        obj->text = obj->line;
        if (text_starts(obj->line, "#")) {
            sink_said(obj->sink, obj->line);
            obj->line.size = 0;
        }
    } while (!obj_next_word(obj, word));
    return true;
}

static void fail_at(const struct obj *obj, struct text found, const char *what)
{
    job_bad(obj->sink->job, "line %zu: \"%.*s\", %s", obj->began, TEXT_SHOW(found, 60), what);
}

static void take_vertex(struct obj *obj)
{
    float position[3];
    for (int i = 0; i < 3; i++) {
        struct text word;
        if (!obj_next_word(obj, &word) || !text_to_float(word, &position[i]) || isnan(position[i])) {
            fail_at(obj, obj->text, "a vertex is three numbers");
            return;
        }
    }
    sink_vertex(obj->sink, position);
}

/* "3", "3/1", "3//2" or "3/1/2": the vertex, and texture and normal, which are not read. */
static bool read_corner(int64_t *out, struct text word)
{
    const char *slash = memchr(word.data, '/', word.size);
    size_t length = slash ? (size_t)(slash - word.data) : word.size;
    for (size_t i = length; i < word.size; i++) {
        if (!strchr("/-0123456789", word.data[i]) || !word.data[i]) {
            return false;
        }
    }
    return text_to_int((struct text){word.data, length}, out) && *out != 0;
}

static void take_corner(struct obj *obj, struct text word)
{
    int64_t index;
    size_t count = obj->sink->vertices.count;
    if (!read_corner(&index, word)) {
        fail_at(obj, word, "a corner is the number of a vertex, from 1 or from -1");
        return;
    }
    bool back = index < 0;
    if (back ? index < -(int64_t)obj->vertices : index > (int64_t)count) {
        job_bad(obj->sink->job, "line %zu: vertex %lld, allowed are %s%zu", obj->began, (long long)index,
                back ? "-1 to -" : "1 to ", back ? obj->vertices : count);
        return;
    }
    sink_corner(obj->sink, back ? (int64_t)obj->vertices + index : index - 1);
}

static void take_face(struct obj *obj)
{
    struct text word;
    while (obj_next_word(obj, &word)) {
        take_corner(obj, word);
    }
    if (obj->sink->corners.count < 3) {
        fail_at(obj, obj->text, "a face has three corners or more");
    }
    sink_end(obj->sink, CELL_POLYGON);
}

static void take_object(struct obj *obj, struct text name)
{
    if (obj->sink->objects.count == UINT32_MAX) {
        job_bad(obj->sink->job, "line %zu: more than 4294967295 objects", obj->began);
    }
    *LIST_ADD(obj->sink->job, &obj->sink->objects) = text_trim(name);
}

/* Statements of points, lines, curves and free surfaces, and of how faces look. */
static const char passed_over[] =
    "vt/vn/vp/p/l/g/s/mg/deg/bmat/step/cstype/curv/curv2/surf/parm/trim/hole/scrv/sp/end/con/"
    "bevel/c_interp/d_interp/lod/usemtl/mtllib/usemap/maplib/shadow_obj/trace_obj/ctech/"
    "stech/call/csh";

static void read_faces(struct obj *obj)
{
    struct text word;
    take_object(obj, (struct text){0});
    while (next_statement(obj, &word)) {
        if (text_equal(word, "v")) {
            obj->vertices++;
        } else if (text_equal(word, "f")) {
            take_face(obj);
        } else if (text_equal(word, "o")) {
            take_object(obj, obj->line);
        } else if (!obj->has_strange && !text_is_one_of(word, passed_over, true)) {
            obj->has_strange = true;
            job_note(obj->sink->job, "line %zu: the statement \"%.*s\" is not known, and was passed over", obj->began,
                     TEXT_SHOW(word, 40));
        }
    }
}

void obj_parse(struct mesh_sink *sink, struct text file)
{
    struct text word;
    /* MNI's objects have the same ending; they begin with a letter for their kind */
    if (file.size > 1 && file.data[0] && strchr("PLMmFXxQqTtBb", file.data[0]) && file.data[1] == ' ') {
        job_refuse(sink->job, "content: an MNI object file, not Wavefront's OBJ");
    } else if (file.size && memchr(file.data, '\0', file.size)) {
        job_bad(sink->job, "content: binary data, an OBJ file is text");
    }
    const size_t mark = text_starts(file, "\xef\xbb\xbf") ? 3 : 0; /* of byte order */
    const struct obj begin = {.scan = scan_of(sink->job, (struct text){file.data + mark, file.size - mark}),
                              .sink = sink};
    struct obj obj = begin;
    while (next_statement(&obj, &word)) {
        if (text_equal(word, "v")) {
            take_vertex(&obj);
        }
    }
    obj = begin;
    read_faces(&obj);
}
