/* SPDX-License-Identifier: BSD-3-Clause */
/* The stream of meshes from conus-mesh, whole and cut off. */
#include "builders/mesh_builder.h"
#include "loaders/extraction/parts.h"
#include "test.h"

#include <stdio.h>
#include <string.h>

struct seen {
    uint32_t ids[8];
    size_t count;
    struct mesh_shape shape; /* of the last mesh */
    enum mesh_space space;
    char text[64];
};

static conus_status take(void *user, const struct mesh_frame *frame)
{
    struct seen *seen = user;
    struct mesh mesh = {0};
    conus_status status = CONUS_OK;
    assert_true(seen->count < 8);
    seen->ids[seen->count++] = frame->id;
    snprintf(seen->text, sizeof seen->text, "%.*s", (int)frame->text.size, frame->text.data);
    if (frame->kind == MESH_FRAME_MESH) {
        seen->space = frame->space;
        status = mesh_from_frame(&mesh, frame);
        status = status ? status : mesh_measure(&seen->shape, &mesh);
    }
    mesh_finish(&mesh);
    return status;
}

static void build(struct buffer *out)
{
    build_start(out);
    build_tetrahedron(out, 7, MESH_SPACE_LPS, 3);
    build_header(out, (struct built_frame){.kind = MESH_FRAME_FAILURE, .id = 8, .text = "no such thing"});
    build_end(out, 2);
}

static conus_status read_stream(const struct buffer *bytes, size_t size, struct seen *seen)
{
    struct mesh_frames frames = {.take = take, .user = seen};
    size_t used = 0;
    size_t wanted = 0;
    conus_status status = mesh_frames_take(&frames, &used, &wanted, (const uint8_t *)bytes->data, size);
    assert_true(status || used + wanted > size);
    return status || (frames.ended && used == size) ? status : fail(CONUS_ERROR_DATA, "cut off or too long");
}

static void frames_come_as_they_were_written(void **state)
{
    (void)state;
    struct buffer bytes = {0};
    struct seen seen = {0};
    build(&bytes);
    assert_ok(read_stream(&bytes, bytes.size, &seen));
    assert_int_equal(seen.count, 2);
    assert_int_equal(seen.ids[0], 7);
    assert_int_equal(seen.ids[1], 8);
    assert_int_equal(seen.space, MESH_SPACE_LPS);
    assert_string_equal(seen.text, "no such thing");
    assert_true(seen.shape.closed);
    assert_near(seen.shape.volume_mm3, 27.0 / 6, 1e-9);
    buffer_finish(&bytes);
}

static void every_prefix_is_refused(void **state)
{
    (void)state;
    struct buffer bytes = {0};
    build(&bytes);
    for (size_t size = 0; size < bytes.size; size++) {
        struct seen seen = {0};
        assert_fails(read_stream(&bytes, size, &seen), CONUS_ERROR_DATA);
    }
    buffer_text(&bytes, "x");
    struct seen seen = {0};
    assert_fails(read_stream(&bytes, bytes.size, &seen), CONUS_ERROR_DATA);
    buffer_finish(&bytes);
}

static void impossible_headers_are_refused(void **state)
{
    (void)state;
    const struct {
        struct built_frame frame;
        const char *part;
    } cases[] = {
        {{.kind = 0}, "frame of kind 0, allowed are 1 to 3"},
        {{.kind = 4}, "frame of kind 4"},
        {{.kind = MESH_FRAME_MESH, .space = 3}, "space 3"},
        {{.kind = MESH_FRAME_END, .space = 1}, "space 1"},
        {{.kind = MESH_FRAME_END, .id = 0, .text = "hello"}, "5 bytes of text"},
        {{.kind = MESH_FRAME_MESH, .vertices = UINT64_C(1) << 32}, "4294967296 vertices"},
        {{.kind = MESH_FRAME_MESH, .triangles = UINT64_MAX}, "18446744073709551615 triangles"},
        {{.kind = MESH_FRAME_FAILURE, .vertices = 1}, "1 vertices"},
        {{.kind = MESH_FRAME_END, .id = 1}, "its end does not match"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct buffer bytes = {0};
        struct seen seen = {0};
        build_start(&bytes);
        build_header(&bytes, cases[i].frame);
        assert_fails(read_stream(&bytes, bytes.size, &seen), CONUS_ERROR_DATA);
        if (!strstr(conus_message(), cases[i].part)) {
            fail_msg("\"%s\" does not say \"%s\"", conus_message(), cases[i].part);
        }
        buffer_finish(&bytes);
    }
}

static conus_status attempt(void *data)
{
    struct seen seen = {0};
    const struct buffer *bytes = data;
    return read_stream(bytes, bytes->size, &seen);
}

static void every_failing_allocation(void **state)
{
    (void)state;
    struct buffer bytes = {0};
    build(&bytes);
    test_every_allocation(attempt, &bytes);
    buffer_finish(&bytes);
}

TEST_GROUP(mesh_stream)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(frames_come_as_they_were_written),
        cmocka_unit_test(every_prefix_is_refused),
        cmocka_unit_test(impossible_headers_are_refused),
        cmocka_unit_test(every_failing_allocation),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
