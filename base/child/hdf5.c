/* SPDX-License-Identifier: BSD-3-Clause */
/* Asks conus-hdf5 for objects, parses its answer, and finds things in it. */
#include "base/child/hdf5.h"

#include "base/byte_order.h"
#include "base/child/child.h"
#include "base/memory.h"
#include "base/order.h"
#include "base/system/system.h"
#include "base/text.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SWAPPED = !BIG_ENDIAN_IS_SWAPPED };

/* Where the object of an address is. */
struct place {
    uint64_t address;
    size_t index;
};

struct hdf5 {
    struct text stream;
    LIST(struct hdf5_object) objects; /* by path */
    LIST(struct hdf5_value) attributes;
    struct place *places; /* [objects.count], by address */
};

bool hdf5_is(const uint8_t *data, size_t size)
{
    static const char mark[] = "\x89HDF\r\n\x1a\n";
    enum { MARK_SIZE = sizeof mark - 1 };
    bool is = false;
    for (size_t at = 0; !is && size >= MARK_SIZE && at <= size - MARK_SIZE; at = at ? 2 * at : 512) {
        is = memcmp(data + at, mark, MARK_SIZE) == 0;
    }
    return is;
}

/* A frame's header, and where its parts are. */
struct frame {
    enum hdf5_frame_kind kind;
    uint64_t address;
    struct hdf5_value value;
    size_t size; /* of all of it */
};

static size_t padded(size_t size)
{
    return (size + 7) / 8 * 8;
}

static bool is_size_of(enum hdf5_class class, size_t size)
{
    switch (class) {
    case HDF5_FLOAT:
        return size == 4 || size == 8;
    case HDF5_SIGNED:
    case HDF5_UNSIGNED:
        return size == 1 || size == 2 || size == 4 || size == 8;
    case HDF5_REFERENCE:
        return size == 8;
    default:
        return size == 0;
    }
}

/* Takes what says how many elements there are; false where it is impossible. */
static bool take_shape(struct hdf5_value *out, const uint8_t *header)
{
    out->class = (enum hdf5_class)order_u32(header + 4, SWAPPED);
    out->size = order_u32(header + 8, SWAPPED);
    out->rank = order_u32(header + 12, SWAPPED);
    out->count = 1;
    bool fine = out->class >= HDF5_GROUP && out->class <= HDF5_OTHER && is_size_of(out->class, out->size) &&
                out->rank <= HDF5_RANK_LIMIT;
    for (size_t i = 0; fine && i < HDF5_RANK_LIMIT; i++) {
        out->dims[i] = order_u64(header + 24 + 8 * i, SWAPPED);
        fine = i < out->rank ? memory_multiply(out->count, out->dims[i], &out->count) : out->dims[i] == 0;
    }
    return fine;
}

/* Whether the begins of strings are in order and the last is the end. */
static bool strings_are_whole(const struct hdf5_value *value, const uint8_t *data, uint64_t size)
{
    if (size / 8 < 1 || value->count > size / 8 - 1) {
        return false;
    }
    uint64_t heads = 8 * ((uint64_t)value->count + 1);
    uint64_t before = 0;
    bool fine = order_u64(data, SWAPPED) == 0;
    for (size_t i = 0; fine && i <= value->count; i++) {
        uint64_t at = order_u64(data + 8 * i, SWAPPED);
        fine = at >= before && at <= size - heads;
        before = at;
    }
    return fine && before == size - heads;
}

/* Sets the value's data, which has so many bytes. */
static bool take_data(struct hdf5_value *value, const uint8_t *data, uint64_t size)
{
    size_t wanted = 0;
    bool has_data = value->class == HDF5_STRING || value->size;
    value->data = has_data ? data : NULL;
    return value->class == HDF5_STRING ? strings_are_whole(value, data, size)
                                       : memory_multiply(value->count, value->size, &wanted) && wanted == size;
}

static bool are_zeros(const uint8_t *data, size_t size)
{
    bool are = true;
    for (size_t i = 0; are && i < size; i++) {
        are = data[i] == 0;
    }
    return are;
}

static void fail_frame(struct job *job, size_t at, const char *what)
{
    job_bad(job, "HDF5 stream: byte %zu: %s", at, what);
}

static bool is_name_of(enum hdf5_frame_kind kind, struct text name)
{
    bool plain = !memchr(name.data, '\0', name.size);
    return plain && name.size <= HDF5_NAME_LIMIT &&
           (kind == HDF5_FRAME_OBJECT ? name.size && name.data[0] == '/'
            : kind == HDF5_FRAME_END  ? !name.size
                                      : name.size > 0);
}

/* The frame at byte `at` of the stream. */
static struct frame parse_frame(struct job *job, struct text stream, size_t at)
{
    const uint8_t *data = (const uint8_t *)stream.data + at;
    size_t left = stream.size - at;
    struct frame frame = {0};
    if (left < HDF5_FRAME_HEADER_SIZE) {
        fail_frame(job, at, "cut off within a frame's header");
        return frame;
    }
    frame = (struct frame){.kind = (enum hdf5_frame_kind)order_u32(data, SWAPPED),
                           .address = order_u64(data + 16, SWAPPED),
                           .value.name = {(const char *)data + HDF5_FRAME_HEADER_SIZE, order_u32(data + 88, SWAPPED)}};
    struct text *name = &frame.value.name;
    uint64_t size = order_u64(data + 96, SWAPPED);
    bool bare = frame.kind == HDF5_FRAME_FAILURE || frame.kind == HDF5_FRAME_END;
    left -= HDF5_FRAME_HEADER_SIZE;
    if (frame.kind < HDF5_FRAME_OBJECT || frame.kind > HDF5_FRAME_END || order_u32(data + 92, SWAPPED)) {
        fail_frame(job, at, "no frame");
        return frame;
    }
    if (left < padded(name->size) || left - padded(name->size) < size ||
        left - padded(name->size) < padded((size_t)size)) {
        fail_frame(job, at, "cut off within a frame");
        return frame;
    }
    const uint8_t *body = data + HDF5_FRAME_HEADER_SIZE + padded(name->size);
    frame.size = HDF5_FRAME_HEADER_SIZE + padded(name->size) + padded((size_t)size);
    if (!is_name_of(frame.kind, *name) ||
        !are_zeros((const uint8_t *)name->data + name->size, padded(name->size) - name->size) ||
        !are_zeros(body + size, padded((size_t)size) - (size_t)size)) {
        fail_frame(job, at, "a name that is none");
    } else if (bare ? size != 0 : !take_shape(&frame.value, data) || !take_data(&frame.value, body, size)) {
        fail_frame(job, at, "an impossible shape");
    }
    return frame;
}

static void take_frame(struct job *job, struct hdf5 *hdf5, const struct frame *frame, size_t at)
{
    if (frame->kind == HDF5_FRAME_OBJECT) {
        *LIST_ADD(job, &hdf5->objects) = (struct hdf5_object){.value = frame->value, .address = frame->address};
    } else if (hdf5->objects.count) {
        *LIST_ADD(job, &hdf5->attributes) = frame->value;
        hdf5->objects.at[hdf5->objects.count - 1].attribute_count++;
    } else {
        fail_frame(job, at, "an attribute before any object");
    }
}

static void take_frames(struct job *job, struct hdf5 *hdf5)
{
    const struct text stream = hdf5->stream;
    size_t at = HDF5_MAGIC_SIZE;
    if (!text_starts(stream, HDF5_STREAM_MAGIC)) {
        job_bad(job, "HDF5 stream: it does not begin with " HDF5_STREAM_MAGIC);
    }
    for (uint64_t count = 0; stream.data && job_ok(job); count++) {
        const struct frame frame = parse_frame(job, stream, at);
        if (!job_ok(job)) {
            return;
        }
        if (frame.kind == HDF5_FRAME_FAILURE) { /* the name says what is wrong with the file */
            uint32_t kind = order_u32((const uint8_t *)stream.data + at + 12, SWAPPED);
            job_fail(job, kind ? CONUS_ERROR_MEMORY : CONUS_ERROR_DATA, "%.*s", (int)frame.value.name.size,
                     frame.value.name.data);
        } else if (frame.kind == HDF5_FRAME_END) {
            if (frame.address != count || at + frame.size != stream.size) {
                fail_frame(job, at, "its end does not match its frames");
            }
            return;
        } else {
            take_frame(job, hdf5, &frame, at);
        }
        at += frame.size;
    }
}

/* A decimal number without its leading zeros; false for another name. */
static bool number_of(struct text *out, struct text name)
{
    bool is = name.size > 0;
    for (size_t i = 0; is && i < name.size; i++) {
        is = name.data[i] >= '0' && name.data[i] <= '9';
    }
    while (name.size > 1 && name.data[0] == '0') {
        name.data++;
        name.size--;
    }
    *out = name;
    return is;
}

static int compare_names(struct text a, struct text b)
{
    struct text x;
    struct text y;
    bool is_x = number_of(&x, a);
    bool is_y = number_of(&y, b);
    int order = is_x != is_y       ? is_y - is_x /* numbers come first */
                : !is_x            ? 0
                : x.size == y.size ? text_compare(x, y)
                                   : compare_unsigned(x.size, y.size);
    return order ? order : text_compare(a, b);
}

/* Name by name; a path that the other begins with is the smaller one. */
static int compare_paths(struct text a, struct text b)
{
    bool more_a = true;
    bool more_b = true;
    struct text name_a;
    struct text name_b;
    int order = 0;
    while (!order) {
        bool has_a = text_field(&a, '/', &more_a, &name_a);
        bool has_b = text_field(&b, '/', &more_b, &name_b);
        if (!has_a || !has_b) {
            return has_a - has_b;
        }
        order = compare_names(name_a, name_b);
    }
    return order;
}

static int compare_objects(const void *a, const void *b)
{
    return compare_paths(((const struct hdf5_object *)a)->value.name, ((const struct hdf5_object *)b)->value.name);
}

static int compare_addresses(const void *a, const void *b)
{
    return compare_unsigned(((const struct place *)a)->address, ((const struct place *)b)->address);
}

/* Gives objects their attributes, and sorts them. */
static void settle(struct job *job, struct hdf5 *hdf5)
{
    const struct hdf5_value *attributes = hdf5->attributes.at;
    struct hdf5_object *objects = hdf5->objects.at;
    const size_t count = hdf5->objects.count;
    hdf5->places = job_zeroed(job, count, sizeof *hdf5->places);
    if (!hdf5->places) {
        return;
    }
    for (size_t i = 0; i < count; i++) {
        objects[i].attributes = attributes;
        attributes = attributes ? attributes + objects[i].attribute_count : NULL;
    }
    order_sort(objects, count, sizeof *objects, compare_objects);
    for (size_t i = 0; i < count; i++) {
        if (i && compare_objects(&objects[i - 1], &objects[i]) == 0) {
            job_bad(job, "HDF5 stream: %.*s is there twice", TEXT_SHOW(objects[i].value.name, 200));
        }
        hdf5->places[i] = (struct place){objects[i].address, i};
    }
    order_sort(hdf5->places, count, sizeof *hdf5->places, compare_addresses);
}

const struct hdf5 *hdf5_of_stream(struct job *job, struct text stream)
{
    struct hdf5 *hdf5 = job_new(job, struct hdf5);
    if (!hdf5) {
        return job_spare(job, sizeof *hdf5);
    }
    hdf5->stream = stream;
    take_frames(job, hdf5);
    settle(job, hdf5);
    return job_ok(job) ? hdf5 : job_spare(job, sizeof *hdf5);
}

static const struct child_program program = {"conus-hdf5", "CONUS_HDF5", "HDF5"};

const struct hdf5 *hdf5_open(struct job *job, const struct open_file *file, const char *const *wanted, size_t count)
{
    enum { LIBRARIES = 1 << 28, BYTES_A_SECOND = 1 << 22, LEAST_SECONDS = 60 };
    struct file_state now;
    struct bytes stream = {0};
    char **words = job_zeroed(job, count + 3, sizeof *words);
    const uint64_t limit = memory_limit(job->max_memory);
    const uint64_t work = LEAST_SECONDS + file->before.size / BYTES_A_SECOND;
    const uint32_t seconds = work < UINT32_MAX / 4 ? (uint32_t)work : UINT32_MAX / 4;
    for (size_t i = 0; words && i < count + 2; i++) {
        words[i] = i == 0   ? job_copy(job, text_from(program.name))
                   : i == 1 ? job_format(job, "%llu", (unsigned long long)limit)
                            : job_copy(job, text_from(wanted[i - 2]));
    }
    const struct child_task task = {
        .program = &program,
        .limits = {.memory = limit, .beside = LIBRARIES + file->before.size, .seconds = seconds, .wait = 4 * seconds},
        .words = words,
        .descriptor = file->descriptor};
    if (JOB_CALL(job, child_run(&stream, &task)) && !job_adopt(job, stream.data)) {
        stream = (struct bytes){0};
    }
    if (job_ok(job) && !(file_state_of(&now, file->descriptor) && file_state_equal(&now, &file->before))) {
        job_fail(job, CONUS_ERROR_IO, FILE_CHANGED);
    }
    return hdf5_of_stream(job, (struct text){(const char *)stream.data, stream.size});
}

const struct hdf5 *hdf5_of_bytes(struct job *job, struct text file, const char *const *wanted, size_t count,
                                 uint64_t max_memory)
{
    const uint64_t before = job->max_memory;
    char *path = NULL; /* where the program cannot be started, as in WebAssembly, no copy is made for it */
    if (JOB_CALL(job, child_find(&path, &program))) {
        memory_free(path);
    }
    struct open_file copy = {.descriptor = job_step(job) ? system_open_scratch("conus-hdf5") : -1};
    if (job_ok(job) && !(copy.descriptor >= 0 && system_write(copy.descriptor, file.data, file.size) &&
                         file_state_of(&copy.before, copy.descriptor))) {
        job_fail(job, CONUS_ERROR_IO, "HDF5: cannot copy the file: %s", text_error(errno));
    }
    job->max_memory = max_memory;
    const struct hdf5 *hdf5 = hdf5_open(job, &copy, wanted, count);
    job->max_memory = before;
    if (copy.descriptor >= 0) {
        file_close(&copy);
    }
    return hdf5;
}

size_t hdf5_count(const struct hdf5 *hdf5)
{
    return hdf5->objects.count;
}

const struct hdf5_object *hdf5_object(const struct hdf5 *hdf5, size_t index)
{
    return &hdf5->objects.at[index];
}

/* The first object whose path is not below `path`. */
static size_t lower_bound(const struct hdf5 *hdf5, struct text path)
{
    size_t low = 0;
    size_t high = hdf5->objects.count;
    while (low < high) {
        size_t middle = low + (high - low) / 2;
        bool below = compare_paths(hdf5->objects.at[middle].value.name, path) < 0;
        low = below ? middle + 1 : low;
        high = below ? high : middle;
    }
    return low;
}

const struct hdf5_object *hdf5_find(const struct hdf5 *hdf5, const char *path)
{
    size_t at = lower_bound(hdf5, text_from(path));
    return at < hdf5->objects.count && text_equal(hdf5->objects.at[at].value.name, path) ? &hdf5->objects.at[at] : NULL;
}

const struct hdf5_object *hdf5_find_address(const struct hdf5 *hdf5, uint64_t address)
{
    const struct place key = {.address = address};
    const struct place *found = bsearch(&key, hdf5->places, hdf5->objects.count, sizeof key, compare_addresses);
    return found ? &hdf5->objects.at[found->index] : NULL;
}

struct text hdf5_last_name(struct text path)
{
    size_t at = path.size;
    while (at && path.data[at - 1] != '/') {
        at--;
    }
    return (struct text){path.data + at, path.size - at};
}

const struct hdf5_object *hdf5_next_in(const struct hdf5 *hdf5, size_t *at, struct text group)
{
    size_t length = group.size == 1 ? 0 : group.size; /* of "/" */
    for (*at = *at ? *at : lower_bound(hdf5, group); *at < hdf5->objects.count;) {
        const struct hdf5_object *object = &hdf5->objects.at[(*at)++];
        struct text path = object->value.name;
        size_t own = hdf5_last_name(path).size;
        bool below = path.size > length && path.data[length] == '/' && memcmp(path.data, group.data, length) == 0;
        if (below && own && path.size == length + 1 + own) {
            return object;
        }
        if (!below && text_compare(path, group) != 0) {
            break;
        }
    }
    return NULL;
}

const struct hdf5_object *hdf5_find_in(const struct hdf5 *hdf5, struct text group, const char *name)
{
    size_t at = 0;
    const struct hdf5_object *object = NULL;
    while ((object = hdf5_next_in(hdf5, &at, group)) && !text_equal(hdf5_last_name(object->value.name), name)) {
    }
    return object;
}

const struct hdf5_value *hdf5_attribute(const struct hdf5_object *object, const char *name)
{
    for (size_t i = 0; i < object->attribute_count; i++) {
        if (text_equal(object->attributes[i].name, name)) {
            return &object->attributes[i];
        }
    }
    return NULL;
}

bool hdf5_is_number(const struct hdf5_value *value)
{
    return value->class == HDF5_FLOAT || value->class == HDF5_SIGNED || value->class == HDF5_UNSIGNED;
}

int64_t hdf5_whole(const struct hdf5_value *value, size_t index)
{
    return order_whole(value->data + index * value->size, value->size, value->class == HDF5_SIGNED, SWAPPED);
}

double hdf5_number(const struct hdf5_value *value, size_t index)
{
    const uint8_t *at = value->data + index * value->size;
    if (value->class == HDF5_FLOAT) {
        return order_real(at, value->size, SWAPPED);
    }
    int64_t whole = hdf5_whole(value, index);
    return value->class == HDF5_SIGNED ? (double)whole : (double)(uint64_t)whole;
}

struct text hdf5_string(const struct hdf5_value *value, size_t index)
{
    uint64_t begin = order_u64(value->data + 8 * index, SWAPPED);
    uint64_t end = order_u64(value->data + 8 * index + 8, SWAPPED);
    return (struct text){(const char *)value->data + 8 * (value->count + 1) + begin, (size_t)(end - begin)};
}

struct text hdf5_text(const struct hdf5_value *value)
{
    return value && value->class == HDF5_STRING && value->count == 1 ? hdf5_string(value, 0) : text_from("");
}
