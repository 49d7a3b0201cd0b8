/* SPDX-License-Identifier: BSD-3-Clause */
/* FreeSurfer's surfaces and annotations. */
#include "loaders/formats/signatures.h"
#include "loaders/surfaces/freesurfer_labels.h"
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

/* An entry of a colour table; NULL ends a list. */
struct annot_entry {
    const char *name;
    int number, red, green, blue;
};

static void append_text(struct buffer *out, const char *text)
{
    append_ordered(out, strlen(text) + 1, 4, true);
    buffer_append(out, text, strlen(text) + 1);
}

static void append_entries(struct buffer *out, const struct annot_entry *entries, bool numbered)
{
    for (; entries->name; entries++) {
        const int rgbt[4] = {entries->red, entries->green, entries->blue, 0};
        if (numbered) {
            append_ordered(out, (uint64_t)entries->number, 4, true);
        }
        append_text(out, entries->name);
        for (int i = 0; i < 4; i++) {
            append_ordered(out, (uint64_t)rgbt[i], 4, true);
        }
    }
}

/* The vertices have the colours of `colours` (packed), and are stored backwards. */
static void make_annot(struct buffer *out, const uint32_t *colours, size_t count, const struct annot_entry *entries,
                       bool numbered)
{
    size_t entry_count = 0;
    while (entries[entry_count].name) {
        entry_count++;
    }
    append_ordered(out, count, 4, true);
    for (size_t i = count; i-- > 0;) {
        append_ordered(out, i, 4, true);
        append_ordered(out, colours[i], 4, true);
    }
    append_ordered(out, 1, 4, true);
    append_ordered(out, numbered ? (uint64_t)-2 : entry_count, 4, true);
    if (numbered) {
        append_ordered(out, 100, 4, true);
    }
    append_text(out, "/colortable.txt");
    if (numbered) {
        append_ordered(out, entry_count, 4, true);
    }
    append_entries(out, entries, numbered);
}

static conus_status parse_annot(uint32_t **labels, struct label_table *table, const struct buffer *bytes,
                                struct notes *notes)
{
    size_t count = 0;
    conus_status status =
        freesurfer_annot_parse(labels, &count, table, (const uint8_t *)bytes->data, bytes->size, notes);
    assert_int_equal(count, status ? 0 : 4);
    return status;
}

enum { RED = 255, GREEN = 255 << 8, GREY = 0x202020 };

static const struct annot_entry usual[] = {
    {"unknown", 0, 32, 32, 32}, {"V1", 7, 255, 0, 0}, {"V2", 3, 0, 255, 0}, {NULL, 0, 0, 0, 0}};

static void annotations_of_both_versions(void **state)
{
    (void)state;
    static const uint32_t colours[4] = {GREEN, GREY, 0, RED};
    static const uint32_t wanted[2][4] = {{2, 0, 0, 1}, {3, 0, 0, 7}};
    for (int numbered = 0; numbered < 2; numbered++) {
        struct buffer bytes = {0};
        struct label_table table = {0};
        struct notes notes = {0};
        uint32_t *labels = NULL;
        make_annot(&bytes, colours, 4, usual, numbered);
        assert_ok(parse_annot(&labels, &table, &bytes, &notes));
        assert_memory_equal(labels, wanted[numbered], sizeof wanted[0]);
        assert_int_equal(table.count, 2);
        assert_string_equal(label_table_find(&table, wanted[numbered][3])->name, "V1");
        assert_int_equal(label_table_find(&table, wanted[numbered][0])->rgb[1], 255);
        assert_int_equal(notes.count, 0);
        memory_free(labels);
        label_table_finish(&table);
        buffer_finish(&bytes);
    }
}

/* Two areas of one colour, a black one, an area as entry 0, and a colour without an area. */
static void what_colours_cannot_tell_is_noted(void **state)
{
    (void)state;
    static const struct annot_entry entries[] = {
        {"first", 0, 255, 0, 0}, {"black", 1, 0, 0, 0}, {"V2", 3, 0, 255, 0}, {"V3", 4, 0, 255, 0}, {NULL, 0, 0, 0, 0}};
    static const uint32_t colours[4] = {GREEN, 0, GREY, RED};
    static const uint32_t wanted[4] = {3, 0, 0, 5};
    static const char *const said[] = {"\"black\" is black", "\"V3\" has the colour of \"V2\"",
                                       "\"first\", has label 5", "1 vertices have colours that the colour table lacks"};
    struct buffer bytes = {0};
    struct label_table table = {0};
    struct notes notes = {0};
    uint32_t *labels = NULL;
    make_annot(&bytes, colours, 4, entries, true);
    assert_ok(parse_annot(&labels, &table, &bytes, &notes));
    assert_memory_equal(labels, wanted, sizeof wanted);
    assert_string_equal(label_table_find(&table, 5)->name, "first");
    assert_int_equal(notes.count, sizeof said / sizeof said[0]);
    for (size_t i = 0; i < notes.count; i++) {
        assert_non_null(strstr(notes.lines[i], said[i]));
    }
    memory_free(labels);
    notes_finish(&notes);
    label_table_finish(&table);
    buffer_finish(&bytes);
}

static void broken_annotations_are_refused_with_reasons(void **state)
{
    (void)state;
    static const uint32_t colours[4] = {GREEN, GREY, 0, RED};
    enum { TABLE = 36, ENTRIES = TABLE + 12 + 4 + 16 + 4 };
    static const struct {
        size_t offset;
        int32_t value;
        const char *message;
        conus_status status;
    } cases[] = {
        {0, 0, "number of vertices: found 0", CONUS_ERROR_DATA},
        {0, -1, "number of vertices: found -1", CONUS_ERROR_DATA},
        {0, 1 << 30, "number of vertices: found 1073741824, the file has", CONUS_ERROR_DATA},
        {4, 4, "pair 0: vertex 4, allowed are 0 to 3", CONUS_ERROR_DATA},
        {4, 2, "pair 1: vertex 2 again", CONUS_ERROR_DATA},
        {TABLE, 0, "there is none", CONUS_ERROR_UNSUPPORTED},
        {TABLE, 2, "flag: found 2", CONUS_ERROR_DATA},
        {TABLE + 4, -1, "size or version: found -1", CONUS_ERROR_DATA},
        {TABLE + 4, -3, "size or version: found -3", CONUS_ERROR_DATA},
        {TABLE + 12, 99999, "origin: 99999 bytes long", CONUS_ERROR_DATA},
        {TABLE + 12, -5, "origin: found -5", CONUS_ERROR_DATA},
        {ENTRIES - 4, 0, "size: found 0", CONUS_ERROR_DATA},
        {ENTRIES - 4, INT32_MAX, "size: found 2147483647", CONUS_ERROR_DATA},
        {ENTRIES - 4, 4, "number: the file ends before it", CONUS_ERROR_DATA},
        {ENTRIES, -1, "number: found -1", CONUS_ERROR_DATA},
        {ENTRIES + 4, INT32_MAX, "name: 2147483647 bytes long", CONUS_ERROR_DATA},
        {ENTRIES + 16, 256, "colour: found 256, allowed are 0 to 255", CONUS_ERROR_DATA},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct buffer bytes = {0};
        struct label_table table = {0};
        struct notes notes = {0};
        uint32_t *labels = NULL;
        make_annot(&bytes, colours, 4, usual, true);
        for (size_t k = 0; k < 4; k++) {
            bytes.data[cases[i].offset + k] = (char)((uint32_t)cases[i].value >> (24 - 8 * k));
        }
        assert_fails(parse_annot(&labels, &table, &bytes, &notes), cases[i].status);
        if (!strstr(conus_message(), cases[i].message)) {
            fail_msg("%zu: \"%s\" does not say \"%s\"", i, conus_message(), cases[i].message);
        }
        buffer_finish(&bytes);
    }
}

static conus_status attempt_annot(void *data)
{
    struct label_table table = {0};
    struct notes notes = {0};
    uint32_t *labels = NULL;
    size_t count;
    const struct buffer *bytes = data;
    uint8_t *exact = memory_copy(bytes->data, bytes->size, 1);
    conus_status status =
        exact ? freesurfer_annot_parse(&labels, &count, &table, exact, bytes->size, &notes) : CONUS_ERROR_MEMORY;
    memory_free(exact);
    memory_free(labels);
    notes_finish(&notes);
    label_table_finish(&table);
    return status;
}

static void annotations_cut_or_without_memory(void **state)
{
    (void)state;
    static const uint32_t colours[4] = {GREEN, GREY, 1, RED};
    static const struct annot_entry entries[] = {{"a", 0, 255, 0, 0}, {"b", 1, 255, 0, 0}, {NULL, 0, 0, 0, 0}};
    for (int numbered = 0; numbered < 2; numbered++) {
        struct buffer bytes = {0};
        make_annot(&bytes, colours, 4, entries, numbered);
        test_every_allocation(attempt_annot, &bytes);
        for (size_t size = 0; size < bytes.size; size++) {
            struct buffer prefix = {.data = bytes.data, .size = size};
            assert_fails(attempt_annot(&prefix), CONUS_ERROR_DATA);
        }
        buffer_finish(&bytes);
    }
}

TEST_GROUP(freesurfer)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(annotations_of_both_versions),
        cmocka_unit_test(what_colours_cannot_tell_is_noted),
        cmocka_unit_test(broken_annotations_are_refused_with_reasons),
        cmocka_unit_test(annotations_cut_or_without_memory),
        cmocka_unit_test(the_volume_geometry_places_a_surface),
        cmocka_unit_test(the_general_form_agrees),
        cmocka_unit_test(broken_surfaces_are_refused_with_reasons),
        cmocka_unit_test(every_prefix_of_a_surface),
        cmocka_unit_test(every_failing_allocation),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
