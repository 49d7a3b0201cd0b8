/* SPDX-License-Identifier: BSD-3-Clause */
/* FreeSurfer's surfaces; tests/corpus/annot/ has annotations. */
#include "loaders/formats/signatures.h"
#include "loaders/surfaces/freesurfer_surface.h"

#include "base/geometry/math3.h"
#include "base/memory.h"
#include "builders/nifti_builder.h"
#include "test.h"

#include <string.h>

#define FOOTER(valid, xras, yras, zras, cras)                                                                          \
    "valid = " valid "  # volume info valid\nfilename = ../mri/orig.mgz\nvolume = 256 256 256\n"                       \
    "voxelsize = 1.0 1.0 1.0\nxras   = " xras "\nyras   = " yras "\nzras   = " zras "\ncras   = " cras "\n"
#define CONFORMED(cras) FOOTER("1", "-1 0 0", "0 0 -1", "0 1 0", cras)

static const double vertices[12] = {0, 0, 0, 10, 0, 0, 0, 20, 0, 0, 0, 30};
static const int triangles[12] = {0, 2, 1, 0, 3, 2, 0, 1, 3, 1, 2, 3};

/* Makes a tetrahedron. Without the tag if `real_ras` < 0; without the footer if `footer` is NULL. */
static void make_surface(struct buffer *out, const char *comment, int real_ras, const char *footer)
{
    buffer_append(out, "\xff\xff\xfe", 3);
    buffer_text(out, comment);
    append_ordered(out, 4, 4, true);
    append_ordered(out, 4, 4, true);
    for (size_t i = 0; i < 12; i++) {
        append_float(out, vertices[i], true);
    }
    for (size_t i = 0; i < 12; i++) {
        append_ordered(out, (uint64_t)triangles[i], 4, true);
    }
    if (real_ras >= 0) {
        append_ordered(out, 2, 4, true);
        append_ordered(out, (uint64_t)real_ras, 4, true);
    }
    if (footer) {
        append_ordered(out, 20, 4, true);
        buffer_text(out, footer);
    }
}

static conus_status parse(struct mesh *out, const struct buffer *bytes, bool as_stored, struct notes *notes)
{
    return freesurfer_surface_parse(out, (const uint8_t *)bytes->data, bytes->size, as_stored, notes);
}

static void the_volume_geometry_places_a_surface(void **state)
{
    (void)state;
    static const struct {
        const char *comment;
        int real_ras;
        const char *footer;
        double last[3]; /* of the vertex (0, 0, 30) */
        const char *note;
    } cases[] = {
        {"created by x\n\n", 0, CONFORMED("1 2 3"), {1, 2, 33}, "(c_ras 1, 2, 3)"},
        {"created by x\n", -1, CONFORMED("1 2 3"), {1, 2, 33}, "(c_ras 1, 2, 3)"},
        {"\n\n", 1, CONFORMED("1 2 3"), {0, 0, 30}, "useRealRAS"},
        {"a\n\n", 0, FOOTER("0", "-1 0 0", "0 0 -1", "0 1 0", "1 2 3"), {0, 0, 30}, "without a valid volume geometry"},
        {"a\n\n", -1, NULL, {0, 0, 30}, "without a valid volume geometry"},
        {"a\n\n", 0, NULL, {0, 0, 30}, "without a valid volume geometry"},
        /* sagittal: i backwards, j down, k to the right; surface z is -j whatever the volume */
        {"a\n\n", 0, FOOTER("1", "0 -1 0", "0 0 -1", "1 0 0", "5 6 7"), {5, 6, 37}, "(c_ras 5, 6, 7)"},
        /* axial, j up: the surface's z runs downwards */
        {"a\n\n", 0, FOOTER("1", "-1 0 0", "0 0 1", "0 1 0", "0 0 0"), {0, 0, -30}, "(c_ras 0, 0, 0)"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct buffer bytes = {0};
        struct mesh mesh = {0};
        struct mesh_shape shape;
        struct notes notes = {0};
        make_surface(&bytes, cases[i].comment, cases[i].real_ras, cases[i].footer);
        assert_true(freesurfer_is_surface((const uint8_t *)bytes.data, bytes.size));
        assert_ok(parse(&mesh, &bytes, false, &notes));
        assert_int_equal(mesh.vertex_count, 4);
        assert_int_equal(mesh.triangle_count, 4);
        for (int a = 0; a < 3; a++) {
            assert_near(mesh.positions[9 + a], cases[i].last[a], 1e-5);
        }
        assert_int_equal(notes.count, 1);
        assert_non_null(strstr(notes.lines[0], cases[i].note));
        assert_ok(mesh_measure(&shape, &mesh)); /* outward, mirrored or not */
        assert_true(shape.closed);
        assert_near(shape.volume_mm3, 1000, 1e-3);
        mesh_finish(&mesh);
        notes_finish(&notes);
        assert_ok(parse(&mesh, &bytes, true, &notes));
        assert_near(mesh.positions[11], 30, 0);
        assert_int_equal(notes.count, 0);
        mesh_finish(&mesh);
        buffer_finish(&bytes);
    }
}

/* Norig inv(Torig) as FreeSurfer's own documentation has it, for a volume of any size and spacing. */
static void the_general_form_agrees(void **state)
{
    (void)state;
    const double axes[9] = {-0.8, 0.6, 0, 0, 0, -1, 0.6, 0.8, 0};
    const double centre[3] = {3, -4, 5};
    const double size[3] = {176, 256, 240};
    const double step[3] = {1.2, 0.9, 1};
    double world[16];
    double norig[16];
    double torig[16] = {-step[0], 0, 0, 0, 0, 0, -step[1], 0, 0, step[2], 0, 0};
    double half[3];
    mat4_identity(norig);
    torig[15] = 1;
    for (int i = 0; i < 3; i++) {
        vec3_scale(norig + 4 * i, axes + 3 * i, step[i]);
        half[i] = size[i] / 2;
    }
    mat4_direction(norig + 12, norig, half);
    vec3_sub(norig + 12, centre, norig + 12);
    mat4_direction(torig + 12, torig, half);
    vec3_scale(torig + 12, torig + 12, -1);
    assert_true(mat4_invert_affine(torig, torig));
    mat4_multiply(norig, norig, torig);
    assert_true(freesurfer_world_from_surface(world, axes, centre));
    for (int i = 0; i < 16; i++) {
        assert_near(world[i], norig[i], 1e-12);
    }
}

static void broken_surfaces_are_refused_with_reasons(void **state)
{
    (void)state;
    static const struct {
        size_t offset, size;
        uint64_t value;
        const char *footer, *message;
        conus_status status;
    } cases[] = {
        {0, 1, 0x7f, NULL, "must begin with the bytes ff ff fe", CONUS_ERROR_DATA},
        {2, 1, 0xff, NULL, "quadrangles (ff ff ff)", CONUS_ERROR_UNSUPPORTED},
        {2, 1, 0xfd, NULL, "quadrangles (ff ff fd)", CONUS_ERROR_UNSUPPORTED},
        {6, 4, 0, NULL, "0 vertices and 4 triangles, allowed are 1 or more", CONUS_ERROR_DATA},
        {10, 4, UINT32_MAX, NULL, "4 vertices and -1 triangles", CONUS_ERROR_DATA},
        {6, 4, INT32_MAX, NULL, "2147483647 vertices and 4 triangles need 25769803812 bytes, the file has 96",
         CONUS_ERROR_DATA},
        {62, 4, 4, NULL, "triangle 0: vertex index 4, allowed are 0 to 3", CONUS_ERROR_DATA},
        {66, 4, UINT32_MAX, NULL, "triangle 0: vertex index -1", CONUS_ERROR_DATA},
        {3, 0, 0, "valid = 1\n", "line \"filename = ...\" is missing", CONUS_ERROR_DATA},
        {3, 0, 0, FOOTER("1", "-1 0", "0 0 -1", "0 1 0", "1 2 3"), "line \"xras = ...\"", CONUS_ERROR_DATA},
        {3, 0, 0, FOOTER("1", "-1 0 0", "0 0 -1", "0 1 0", "1 2 nan"), "line \"cras = ...\"", CONUS_ERROR_DATA},
        {3, 0, 0, FOOTER("1", "-1 0 0", "-1 0 0", "0 1 0", "1 2 3"), "no directions at right angles", CONUS_ERROR_DATA},
        {3, 0, 0, FOOTER("1", "0 0 0", "0 0 -1", "0 1 0", "1 2 3"), "no directions at right angles", CONUS_ERROR_DATA},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct buffer bytes = {0};
        struct mesh mesh = {0};
        struct notes notes = {0};
        make_surface(&bytes, "a\n\n", -1, cases[i].footer);
        for (size_t k = 0; k < cases[i].size; k++) {
            bytes.data[cases[i].offset + k] = (char)(cases[i].value >> 8 * (cases[i].size - 1 - k));
        }
        assert_fails(parse(&mesh, &bytes, false, &notes), cases[i].status);
        if (!strstr(conus_message(), cases[i].message)) {
            fail_msg("%zu: \"%s\" does not say \"%s\"", i, conus_message(), cases[i].message);
        }
        buffer_finish(&bytes);
    }
}

/* Parses a copy, so that a sanitizer notices one byte too many. */
static conus_status attempt_surface(void *data)
{
    struct mesh mesh = {0};
    struct notes notes = {0};
    const struct buffer *bytes = data;
    uint8_t *exact = memory_copy(bytes->data, bytes->size, 1);
    conus_status status =
        exact ? freesurfer_surface_parse(&mesh, exact, bytes->size, false, &notes) : CONUS_ERROR_MEMORY;
    memory_free(exact);
    mesh_finish(&mesh);
    notes_finish(&notes);
    return status;
}

/* The footer may be missing as a whole, or the number at its end cut; every other prefix is refused. */
static void every_prefix_of_a_surface(void **state)
{
    (void)state;
    struct buffer bytes = {0};
    make_surface(&bytes, "a\n\n", 0, CONFORMED("1 2 3"));
    size_t footer = 3 + 3 + 8 + 96;
    size_t last = bytes.size - strlen("2 3\n");
    for (size_t size = 0; size <= last; size++) {
        bool tag_less = size >= footer && size < footer + 4;
        bool real_ras_only = size >= footer + 8 && size < footer + 12;
        struct buffer prefix = {.data = bytes.data, .size = size};
        assert_fails(attempt_surface(&prefix), tag_less || real_ras_only ? CONUS_OK : CONUS_ERROR_DATA);
    }
    buffer_finish(&bytes);
}

static void every_failing_allocation(void **state)
{
    (void)state;
    struct buffer bytes = {0};
    make_surface(&bytes, "a\n\n", 0, CONFORMED("1 2 3"));
    test_every_allocation(attempt_surface, &bytes);
    buffer_finish(&bytes);
}

TEST_GROUP(freesurfer)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_volume_geometry_places_a_surface),
        cmocka_unit_test(the_general_form_agrees),
        cmocka_unit_test(broken_surfaces_are_refused_with_reasons),
        cmocka_unit_test(every_prefix_of_a_surface),
        cmocka_unit_test(every_failing_allocation),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
