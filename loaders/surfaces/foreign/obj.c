/* SPDX-License-Identifier: BSD-3-Clause */
/* Parses Wavefront's OBJ: vertices first, then faces, so that a face may come before its vertices. */
#include "base/order.h"
#include "loaders/surfaces/foreign/foreign_mesh.h"

#include "base/memory.h"
#include "loaders/surfaces/foreign/words.h"

#include <math.h>
#include <string.h>

/* A statement "o"; of those with one name, the first one stands for all. */
struct object {
    struct text name;
    uint32_t place; /* in the file */
    uint32_t first; /* place of the first one of this name */
};

struct obj {
    struct words words;
    size_t began;     /* the line on which the statement begins, */
    struct text text; /* that line, */
    struct text line; /* and what is left of it */
    struct foreign_mesh *mesh;
    size_t vertices; /* so far; a negative index counts back from here */
    struct object *objects;
    size_t object_count, object_capacity;
    uint32_t *owners; /* [triangle_count] place of the object */
    size_t owner_capacity;
};

static struct words words_of(const uint8_t *data, size_t size)
{
    size_t mark = size >= 3 && memcmp(data, "\xef\xbb\xbf", 3) == 0 ? 3 : 0; /* of byte order */
    return (struct words){.rest = {(const char *)data + mark, size - mark}, .line = 1};
}

/* The next word of the statement, which goes on behind a backslash at the end of a line. */
static bool obj_next_word(struct obj *obj, struct text *word)
{
    bool there = text_word(&obj->line, word);
    while (there && word->data[word->size - 1] == '\\' && !text_trim(obj->line).size) {
        if (--word->size) {
            (void)words_line(&obj->words, &obj->line);
            return true;
        }
        there = words_line(&obj->words, &obj->line) && text_word(&obj->line, word);
    }
    return there;
}

/* The next statement's first word. */
static bool next_statement(struct obj *obj, struct text *word)
{
    struct text rest = text_trim(obj->line);
    while (rest.size && rest.data[rest.size - 1] == '\\') { /* of a statement that is not read */
        rest = words_line(&obj->words, &obj->line) ? text_trim(obj->line) : (struct text){0};
    }
    do {
        obj->began = obj->words.line;
        if (!words_line(&obj->words, &obj->line)) {
            return false;
        }
        obj->text = obj->line;
        if (text_starts(obj->line, "#")) {
            obj->mesh->space = obj->mesh->space ? obj->mesh->space : foreign_space_in(obj->line);
            obj->line.size = 0;
        }
    } while (!obj_next_word(obj, word));
    return true;
}

static conus_status fail_at(const struct obj *obj, struct text found, const char *what)
{
    return fail(CONUS_ERROR_DATA, "line %zu: \"%.*s\", %s", obj->began, TEXT_SHOW(found, 60), what);
}

static conus_status take_vertex(struct obj *obj)
{
    float position[3];
    for (int i = 0; i < 3; i++) {
        struct text word;
        if (!obj_next_word(obj, &word) || !text_to_float(word, &position[i]) || isnan(position[i])) {
            return fail_at(obj, obj->text, "a vertex is three numbers");
        }
    }
    return foreign_add_vertex(obj->mesh, position);
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

static conus_status take_corner(struct obj *obj, struct text word)
{
    int64_t index;
    size_t count = obj->mesh->vertex_count;
    if (!read_corner(&index, word)) {
        return fail_at(obj, word, "a corner is the number of a vertex, from 1 or from -1");
    }
    bool back = index < 0;
    if (back ? index < -(int64_t)obj->vertices : index > (int64_t)count) {
        return fail(CONUS_ERROR_DATA, "line %zu: vertex %lld, allowed are %s%zu", obj->began, (long long)index,
                    back ? "-1 to -" : "1 to ", back ? obj->vertices : count);
    }
    return foreign_add_corner(obj->mesh, back ? (int64_t)obj->vertices + index : index - 1);
}

static conus_status take_face(struct obj *obj)
{
    struct foreign_mesh *mesh = obj->mesh;
    size_t from = mesh->triangle_count;
    conus_status status;
    struct text word;
    while (obj_next_word(obj, &word)) {
        status = take_corner(obj, word);
        if (status) {
            return status;
        }
    }
    if (mesh->face.count < 3) {
        return fail_at(obj, obj->text, "a face has three corners or more");
    }
    status = foreign_end_polygon(mesh);
    if (status) {
        return status;
    }
    if (!memory_reserve(&obj->owners, &obj->owner_capacity, mesh->triangle_count, sizeof *obj->owners)) {
        return CONUS_ERROR_MEMORY;
    }
    for (size_t i = from; i < mesh->triangle_count; i++) {
        obj->owners[i] = (uint32_t)obj->object_count - 1;
    }
    return CONUS_OK;
}

static conus_status take_object(struct obj *obj, struct text name)
{
    size_t count = obj->object_count;
    if (count == UINT32_MAX) {
        return fail(CONUS_ERROR_DATA, "line %zu: more than 4294967295 objects", obj->began);
    }
    if (!memory_reserve(&obj->objects, &obj->object_capacity, count + 1, sizeof *obj->objects)) {
        return CONUS_ERROR_MEMORY;
    }
    obj->objects[obj->object_count++] = (struct object){text_trim(name), (uint32_t)count, 0};
    return CONUS_OK;
}

/* Statements of points, lines, curves and free surfaces, and of how faces look. */
static const char passed_over[] =
    "vt/vn/vp/p/l/g/s/mg/deg/bmat/step/cstype/curv/curv2/surf/parm/trim/hole/scrv/sp/end/con/"
    "bevel/c_interp/d_interp/lod/usemtl/mtllib/usemap/maplib/shadow_obj/trace_obj/ctech/"
    "stech/call/csh";

static conus_status read_faces(struct obj *obj)
{
    struct text word;
    conus_status status = take_object(obj, (struct text){0});
    while (!status && next_statement(obj, &word)) {
        if (text_equal(word, "v")) {
            obj->vertices++;
        } else if (text_equal(word, "f")) {
            status = take_face(obj);
        } else if (text_equal(word, "o")) {
            status = take_object(obj, obj->line);
        } else if (!obj->mesh->notes.count && !text_is_one_of(word, passed_over, true)) {
            status = notes_add(&obj->mesh->notes, "line %zu: the statement \"%.*s\" is not known, and was passed over",
                               obj->began, TEXT_SHOW(word, 40));
        }
    }
    return status;
}

static int by_name(const void *a, const void *b)
{
    return text_compare(((const struct object *)a)->name, ((const struct object *)b)->name);
}

static int by_place(const void *a, const void *b)
{
    return compare_unsigned(((const struct object *)a)->place, ((const struct object *)b)->place);
}

/* Numbers the objects that have triangles, and gives each triangle the number of its own. */
static conus_status number_objects(struct obj_objects *out, struct obj *obj)
{
    size_t triangles = obj->mesh->triangle_count;
    struct object *objects = obj->objects;
    order_sort(objects, obj->object_count, sizeof *objects, by_name);
    for (size_t i = 0; i < obj->object_count; i++) {
        bool same = i > 0 && text_compare(objects[i].name, objects[i - 1].name) == 0;
        objects[i].first = same ? objects[i - 1].first : objects[i].place;
    }
    order_sort(objects, obj->object_count, sizeof *objects, by_place);
    uint32_t *numbers = memory_zeroed(obj->object_count, sizeof *numbers); /* from 1, of the first of a name */
    out->names = memory_zeroed(obj->object_count, sizeof *out->names);
    if (!numbers || !out->names) {
        memory_free(numbers);
        return CONUS_ERROR_MEMORY;
    }
    for (size_t i = 0; i < triangles; i++) {
        uint32_t first = objects[obj->owners[i]].first;
        if (!numbers[first]) {
            out->names[out->count++] = objects[first].name;
            numbers[first] = (uint32_t)out->count;
        }
        obj->owners[i] = numbers[first] - 1;
    }
    memory_free(numbers);
    out->owners = obj->owners;
    obj->owners = NULL;
    return CONUS_OK;
}

void obj_objects_finish(struct obj_objects *objects)
{
    memory_free(objects->names);
    memory_free(objects->owners);
    *objects = (struct obj_objects){0};
}

conus_status obj_parse(struct foreign_mesh *out, struct obj_objects *objects, const uint8_t *data, size_t size)
{
    struct obj obj = {.words = words_of(data, size), .mesh = out};
    struct text word;
    conus_status status = CONUS_OK;
    /* MNI's objects have the same ending; they begin with a letter for their kind */
    if (size > 1 && data[0] && strchr("PLMmFXxQqTtBb", data[0]) && data[1] == ' ') {
        status = fail(CONUS_ERROR_UNSUPPORTED, "content: an MNI object file, not Wavefront's OBJ");
    } else if (size && memchr(data, '\0', size)) {
        status = fail(CONUS_ERROR_DATA, "content: binary data, an OBJ file is text");
    }
    while (!status && next_statement(&obj, &word)) {
        status = text_equal(word, "v") ? take_vertex(&obj) : CONUS_OK;
    }
    obj.words = words_of(data, size);
    obj.line = (struct text){0};
    status = status ? status : read_faces(&obj);
    if (!status && objects) {
        status = number_objects(objects, &obj);
    }
    memory_free(obj.objects);
    memory_free(obj.owners);
    return status;
}
