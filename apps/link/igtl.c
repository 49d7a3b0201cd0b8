/* SPDX-License-Identifier: BSD-3-Clause */
/* Parses and writes OpenIGTLink messages; no sockets here. */
#include "link/station.h"

#include "conus/pose.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { TYPE_AT = 2, TYPE_SIZE = 12, DEVICE_AT = 14, DEVICE_SIZE = 20, TIME_AT = 34, SIZE_AT = 42, CRC_AT = 50 };
enum { EXTENDED = 12, TRANSFORM_SIZE = 48, TDATA_SIZE = 70, QTDATA_SIZE = 50, POINT_SIZE = 136 };

static uint64_t get(const uint8_t *bytes, size_t size)
{
    uint64_t value = 0;
    for (size_t i = 0; i < size; i++) {
        value = value << 8 | bytes[i];
    }
    return value;
}

static void put(uint8_t *bytes, size_t size, uint64_t value)
{
    for (size_t i = size; i > 0; i--) {
        bytes[i - 1] = (uint8_t)value;
        value >>= 8;
    }
}

static double get_float(const uint8_t *bytes)
{
    uint32_t bits = (uint32_t)get(bytes, 4);
    float value;
    memcpy(&value, &bits, sizeof value);
    return (double)value;
}

static void put_float(uint8_t *bytes, double value)
{
    float rounded = (float)value;
    uint32_t bits;
    memcpy(&bits, &rounded, sizeof bits);
    put(bytes, 4, bits);
}

/* Copies a field that need not end with a NUL; control characters become "?". */
static void get_name(char *out, const uint8_t *bytes, size_t size)
{
    for (size_t i = 0; i < size; i++) {
        out[i] = bytes[i] > 0 && bytes[i] < ' ' ? '?' : (char)bytes[i];
    }
    out[size] = '\0';
}

uint64_t igtl_crc(const uint8_t *bytes, size_t size)
{
    uint64_t crc = 0;
    for (size_t i = 0; i < size; i++) {
        crc ^= (uint64_t)bytes[i] << 56;
        for (int bit = 0; bit < 8; bit++) {
            crc = crc & UINT64_C(1) << 63 ? crc << 1 ^ UINT64_C(0x42F0E1EBA9EA3693) : crc << 1;
        }
    }
    return crc;
}

/* Adds a pose that the library found to be rigid; NULL, which is none, is counted as refused. */
static void add_pose(struct igtl_reader *reader, struct igtl_poses *poses, const char *name, const conus_pose *given)
{
    if (!given || poses->count == IGTL_TOOLS) {
        reader->counts.refused++;
        return;
    }
    struct igtl_pose *pose = &poses->tools[poses->count++];
    snprintf(pose->name, sizeof pose->name, "%s", name);
    memcpy(pose->matrix, given->world_from_device, sizeof pose->matrix);
    pose->lost = true; /* of the identity */
    for (int i = 0; i < 16; i++) {
        pose->lost = pose->lost && pose->matrix[i] == (i % 5 == 0);
    }
    reader->counts.poses++;
}

/* Of the upper left 3 x 3; NaN is not below 0. */
static double determinant(const double m[16])
{
    return m[0] * (m[5] * m[10] - m[6] * m[9]) - m[1] * (m[4] * m[10] - m[6] * m[8]) +
           m[2] * (m[4] * m[9] - m[5] * m[8]);
}

/* 12 floats: three columns of the rotation, then the position. */
static void add_columns(struct igtl_reader *reader, struct igtl_poses *poses, const char *name, const uint8_t *body)
{
    double matrix[16];
    conus_pose pose;
    for (size_t column = 0; column < 4; column++) {
        for (size_t a = 0; a < 3; a++) {
            matrix[4 * column + a] = get_float(body + 4 * (3 * column + a));
        }
        matrix[4 * column + 3] = column == 3;
    }
    bool fine = !conus_pose_from_matrix(&pose, matrix);
    reader->counts.mirrored += !fine && determinant(matrix) < 0;
    add_pose(reader, poses, name, fine ? &pose : NULL);
}

/* Senders differ in how well they normalise: the protocol's own example has lengths of 0.88. A quaternion far from unit
 * length is refused. @p q is x, y, z, w. */
static void add_quaternion(struct igtl_reader *reader, struct igtl_poses *poses, const char *name,
                           const uint8_t *position, const double q[4])
{
    const double at[3] = {get_float(position), get_float(position + 4), get_float(position + 8)};
    const double wxyz[4] = {q[3], q[0], q[1], q[2]};
    double square = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3];
    conus_pose pose;
    bool fine = square >= 0.5 && square <= 2 && !conus_pose_from_quaternion(&pose, at, wxyz);
    add_pose(reader, poses, name, fine ? &pose : NULL);
}

/* Bodies: false where the size does not fit the type. */

struct body {
    const uint8_t *bytes;
    size_t size;
    const char *device;
};

static bool read_transform(struct igtl_reader *reader, struct igtl_poses *poses, const struct body *body)
{
    if (body->size != TRANSFORM_SIZE) {
        return false;
    }
    add_columns(reader, poses, body->device, body->bytes);
    return true;
}

/* Position alone, or with three or four numbers of a quaternion. */
static bool read_position(struct igtl_reader *reader, struct igtl_poses *poses, const struct body *body)
{
    double q[4] = {0, 0, 0, 1};
    if (body->size != 12 && body->size != 24 && body->size != 28) {
        return false;
    }
    for (size_t i = 0; i < (body->size - 12) / 4; i++) {
        q[i] = get_float(body->bytes + 12 + 4 * i);
    }
    if (body->size == 24) {
        q[3] = sqrt(fmax(1 - q[0] * q[0] - q[1] * q[1] - q[2] * q[2], 0));
    }
    add_quaternion(reader, poses, body->device, body->bytes, q);
    return true;
}

static bool read_tdata(struct igtl_reader *reader, struct igtl_poses *poses, const struct body *body)
{
    char name[IGTL_NAME];
    for (size_t at = 0; at + TDATA_SIZE <= body->size; at += TDATA_SIZE) {
        get_name(name, body->bytes + at, DEVICE_SIZE);
        add_columns(reader, poses, name, body->bytes + at + 22);
    }
    return body->size % TDATA_SIZE == 0;
}

static bool read_qtdata(struct igtl_reader *reader, struct igtl_poses *poses, const struct body *body)
{
    char name[IGTL_NAME];
    for (size_t at = 0; at + QTDATA_SIZE <= body->size; at += QTDATA_SIZE) {
        double q[4];
        get_name(name, body->bytes + at, DEVICE_SIZE);
        for (size_t i = 0; i < 4; i++) {
            q[i] = get_float(body->bytes + at + 34 + 4 * i);
        }
        add_quaternion(reader, poses, name, body->bytes + at + 22, q);
    }
    return body->size % QTDATA_SIZE == 0;
}

static const struct {
    const char *type;
    bool (*read)(struct igtl_reader *reader, struct igtl_poses *poses, const struct body *body);
} types[] = {{"TRANSFORM", read_transform},
             {"POSITION", read_position},
             {"QTRANS", read_position},
             {"TDATA", read_tdata},
             {"QTDATA", read_qtdata}};
enum { TYPES = sizeof types / sizeof types[0] };

/* Entry of the table, TYPES if none. */
static size_t type_of(const uint8_t *header)
{
    char type[TYPE_SIZE + 1];
    size_t i = 0;
    get_name(type, header + TYPE_AT, TYPE_SIZE);
    while (i < TYPES && strcmp(type, types[i].type) != 0) {
        i++;
    }
    return i;
}

/* Leaves only the content: cuts the extended header off its front, and the metadata off its end. */
static bool strip_extended(struct body *body)
{
    if (body->size < EXTENDED) {
        return false;
    }
    uint64_t before = get(body->bytes, 2);
    uint64_t behind = get(body->bytes + 2, 2) + get(body->bytes + 4, 4);
    if (before < EXTENDED || before + behind > body->size) {
        return false;
    }
    body->bytes += before;
    body->size -= (size_t)(before + behind);
    return true;
}

static void read_message(struct igtl_reader *reader, igtl_listener listener, void *user)
{
    const uint8_t *header = reader->bytes;
    char device[IGTL_NAME];
    struct igtl_poses poses = {.time_s = (double)get(header + TIME_AT, 4) +
                                         (double)get(header + TIME_AT + 4, 4) / 4294967296.0};
    struct body body = {header + IGTL_HEADER, (size_t)get(header + SIZE_AT, 8), device};
    size_t type = type_of(header);
    reader->counts.messages++;
    get_name(device, header + DEVICE_AT, DEVICE_SIZE);
    bool fine = igtl_crc(body.bytes, body.size) == get(header + CRC_AT, 8);
    fine = fine && (get(header, 2) == 1 || strip_extended(&body));
    fine = fine && types[type].read(reader, &poses, &body);
    reader->valid += fine;
    reader->counts.broken += !fine;
    if (fine && poses.count) {
        listener(user, &poses);
    }
}

static size_t least(size_t a, size_t b)
{
    return a < b ? a : b;
}

/* Checks a whole header, and begins to pass over the body where it is not wanted. False where it makes no sense. */
static bool check_header(struct igtl_reader *reader)
{
    uint64_t version = get(reader->bytes, 2);
    uint64_t size = get(reader->bytes + SIZE_AT, 8);
    if ((version != 1 && version != 2) || size > IGTL_SKIP_LIMIT) {
        return false;
    }
    if (type_of(reader->bytes) == TYPES || size > IGTL_BODY_LIMIT) {
        reader->skip = size;
        reader->size = 0;
        reader->counts.messages++;
    }
    return true;
}

struct input {
    const uint8_t *bytes;
    size_t size;
};

/* Moves bytes to the reader until it has `wanted`; false: there are not enough. */
static bool take_bytes(struct igtl_reader *reader, struct input *input, size_t wanted)
{
    size_t taken = least(wanted - reader->size, input->size);
    memcpy(reader->bytes + reader->size, input->bytes, taken);
    reader->size += taken;
    input->bytes += taken;
    input->size -= taken;
    return reader->size == wanted;
}

static bool pass_over(struct igtl_reader *reader, struct input *input)
{
    size_t passed = reader->skip < input->size ? (size_t)reader->skip : input->size;
    reader->skip -= passed;
    input->bytes += passed;
    input->size -= passed;
    return reader->skip == 0;
}

bool igtl_read(struct igtl_reader *reader, const uint8_t *bytes, size_t size, igtl_listener listener, void *user)
{
    reader->valid = 0;
    struct input input = {bytes, size};
    while (pass_over(reader, &input)) {
        if (reader->size < IGTL_HEADER) {
            if (!take_bytes(reader, &input, IGTL_HEADER)) {
                return true;
            }
            if (!check_header(reader)) {
                return false;
            }
        }
        if (reader->size >= IGTL_HEADER) {
            if (!take_bytes(reader, &input, IGTL_HEADER + (size_t)get(reader->bytes + SIZE_AT, 8))) {
                return true;
            }
            read_message(reader, listener, user);
            reader->size = 0;
        }
    }
    return true;
}

/* Puts the header before a body that is there already; gives the whole size. */
static size_t finish_message(uint8_t *out, const char *type, const char *device, double time_s, size_t body)
{
    double whole = floor(time_s);
    memset(out, 0, IGTL_HEADER);
    put(out, 2, 1);
    memcpy(out + TYPE_AT, type, least(strlen(type), TYPE_SIZE));
    memcpy(out + DEVICE_AT, device, least(strlen(device), DEVICE_SIZE));
    put(out + TIME_AT, 4, (uint64_t)whole);
    put(out + TIME_AT + 4, 4, (uint64_t)((time_s - whole) * 4294967296.0));
    put(out + SIZE_AT, 8, body);
    put(out + CRC_AT, 8, igtl_crc(out + IGTL_HEADER, body));
    return IGTL_HEADER + body;
}

size_t igtl_write_string(uint8_t *out, size_t capacity, const char *device, double time_s, const char *text)
{
    enum { UTF_8 = 106 }; /* IANA's number */
    size_t length = strlen(text);
    if (length > UINT16_MAX || capacity < IGTL_HEADER + 4 + length) {
        return 0;
    }
    put(out + IGTL_HEADER, 2, UTF_8);
    put(out + IGTL_HEADER + 2, 2, length);
    memcpy(out + IGTL_HEADER + 4, text, length);
    return finish_message(out, "STRING", device, time_s, 4 + length);
}

size_t igtl_write_points(uint8_t *out, size_t capacity, const char *device, double time_s,
                         const struct igtl_point *points, size_t count)
{
    if (capacity < IGTL_HEADER || count > (capacity - IGTL_HEADER) / POINT_SIZE) {
        return 0;
    }
    memset(out + IGTL_HEADER, 0, count * POINT_SIZE);
    for (size_t i = 0; i < count; i++) {
        uint8_t *point = out + IGTL_HEADER + i * POINT_SIZE;
        memcpy(point, points[i].name, least(strlen(points[i].name), 64));
        memcpy(point + 64, "conus", 5);
        memcpy(point + 96, points[i].rgb, 3);
        point[99] = 255;
        for (size_t a = 0; a < 3; a++) {
            put_float(point + 100 + 4 * a, points[i].position[a]);
        }
        put_float(point + 112, 2); /* diameter, mm */
    }
    return finish_message(out, "POINT", device, time_s, count * POINT_SIZE);
}

size_t igtl_write_transform(uint8_t *out, size_t capacity, const char *device, double time_s, const double matrix[16])
{
    if (capacity < IGTL_HEADER + TRANSFORM_SIZE) {
        return 0;
    }
    for (size_t column = 0; column < 4; column++) {
        for (size_t a = 0; a < 3; a++) {
            put_float(out + IGTL_HEADER + 4 * (3 * column + a), matrix[4 * column + a]);
        }
    }
    return finish_message(out, "TRANSFORM", device, time_s, TRANSFORM_SIZE);
}

size_t igtl_write_start(uint8_t *out, size_t capacity, const char *type, uint32_t milliseconds)
{
    if (capacity < IGTL_HEADER + 36) {
        return 0;
    }
    memset(out + IGTL_HEADER, 0, 36);
    put(out + IGTL_HEADER, 4, milliseconds);
    return finish_message(out, type, "", 0, 36);
}
