/* SPDX-License-Identifier: BSD-3-Clause */
/* conus_atlas_write_meshes() with a conus-mesh that a script plays: files, names, notes, failures; and the formats'
 * bytes. */
#include "atlas/atlas.h"
#include "base/files/file.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "builders/mesh_builder.h"
#include "conus/own.h"
#include "loaders/extraction/parts.h"
#include "loaders/surfaces/surfaces.h"
#include "made_atlas.h"
#include "test.h"
#include "tests/support/mesh_on_job.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* An atlas of 4 voxels: labels 3 and 70000, and a name without voxels. */
static conus_atlas *make_atlas(void)
{
    static const uint32_t labels[4] = {0, 3, 70000, 3};
    conus_volume_info info = {.role = CONUS_ROLE_PARCELLATION, .path = "made", .dim = {4, 1, 1}, .spacing = {1, 1, 1}};
    struct notes notes = {0};
    struct label_table table = {0};
    conus_atlas *atlas;
    mat4_identity(info.world_from_voxel);
    snprintf(info.transform, sizeof info.transform, "sform, code 4 (MNI 152)");
    assert_non_null(label_table_add(&table, 3));
    assert_ok(label_set_text(&table.entries[0].name, (struct text){"a/b <c> & \"d\"", 13}));
    assert_non_null(label_table_add(&table, 5));
    assert_ok(label_set_text(&table.entries[1].name, (struct text){"Absent", 6}));
    assert_ok(atlas_create(&atlas, &info, labels, &table, "none", &notes));
    label_table_finish(&table);
    notes_finish(&notes);
    return atlas;
}

/* Makes $CONUS_MESH write these bytes, whatever its request. */
static void play(const struct buffer *bytes)
{
    struct buffer script = {0};
    const char *stream = test_scratch("stream");
    const char *path = test_scratch("conus-mesh");
    assert_ok(file_write_soon(stream, bytes->data, bytes->size));
    buffer_format(&script, "#!/bin/sh\ncat '%s'\n", stream);
    assert_ok(file_write_soon(path, script.data, script.size));
    assert_int_equal(chmod(path, 0700), 0);
    setenv("CONUS_MESH", path, 1);
    buffer_finish(&script);
}

static void build(struct buffer *out, const uint32_t *ids, uint32_t count)
{
    build_start(out);
    for (uint32_t i = 0; i < count; i++) {
        build_tetrahedron(out, ids[i], MESH_SPACE_RAS, 3.5f);
    }
    build_end(out, count);
}

struct heard {
    size_t done, total, notes;
    size_t cancel_at; /* surfaces; 0 = never */
    char note[200];
};

static bool hear_progress(void *user, size_t done, size_t total)
{
    struct heard *heard = user;
    assert_int_equal(done, heard->done + 1);
    heard->done = done;
    heard->total = total;
    return done != heard->cancel_at;
}

static void hear_note(void *user, const conus_note *note)
{
    struct heard *heard = user;
    heard->notes++;
    snprintf(heard->note, sizeof heard->note, "%s", note->line);
}

static void check_file(const char *path, double size)
{
    struct mesh mesh;
    struct mesh_shape shape;
    struct label about = {0};
    struct notes notes = {0};
    assert_ok(mesh_file_read(&mesh, &about, path, NULL, &notes));
    assert_int_equal(notes.count, 0);
    assert_ok(mesh_measure(&shape, &mesh));
    assert_near(shape.volume_mm3, size * size * size / 6, 1e-9);
    assert_near(shape.centroid[2], size / 4, 1e-9);
    label_finish(&about);
    mesh_finish(&mesh);
}

static void each_area_gets_its_file(void **state)
{
    (void)state;
    struct buffer bytes = {0};
    struct heard heard = {0};
    conus_atlas *atlas = make_atlas();
    const conus_mesh_options options = {
        .progress = hear_progress, .progress_user = &heard, .log = hear_note, .log_user = &heard};
    char folder[200];
    char path[300];
    build(&bytes, (uint32_t[]){3, 70000}, 2);
    play(&bytes);
    snprintf(folder, sizeof folder, "%s", test_scratch("out"));
    assert_ok(conus_atlas_write_meshes(atlas, folder, &options));
    assert_int_equal(heard.done, 2);
    assert_int_equal(heard.total, 2);
    assert_int_equal(heard.notes, 1);
    assert_string_equal(heard.note, "1 areas without voxels get no mesh");
    heard = (struct heard){.cancel_at = 1};
    assert_fails(conus_atlas_write_meshes(atlas, test_scratch("cancelled"), &options), CONUS_ERROR_CANCELLED);
    assert_int_equal(heard.done, 1);
    snprintf(path, sizeof path, "%s/3_a_b__c__&__d_.gii", folder);
    check_file(path, 3.5);
    snprintf(path, sizeof path, "%s/70000_70000.gii", folder);
    check_file(path, 3.5);
    conus_atlas_destroy(atlas);
    buffer_finish(&bytes);
}

static void what_conus_mesh_makes_up_is_refused(void **state)
{
    (void)state;
    const struct {
        uint32_t ids[2];
        uint32_t count;
        const char *part;
    } cases[] = {
        {{4}, 1, "a surface of label 4"},
        {{70000, 3}, 2, "a surface of label 3"},
        {{3, 3}, 2, "a surface of label 3"},
    };
    conus_atlas *atlas = make_atlas();
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct buffer bytes = {0};
        build(&bytes, cases[i].ids, cases[i].count);
        play(&bytes);
        assert_fails(conus_atlas_write_meshes(atlas, test_scratch("bad"), NULL), CONUS_ERROR_DATA);
        assert_non_null(strstr(conus_message(), cases[i].part));
        buffer_finish(&bytes);
    }
    conus_atlas_destroy(atlas);
}

static void options_have_ranges(void **state)
{
    (void)state;
    conus_atlas *atlas = make_atlas();
    const conus_mesh_options cases[] = {
        {.smooth = 1001}, {.decimate = 1}, {.decimate = -0.1}, {.decimate = NAN}, {.format = (conus_mesh_format)5}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        assert_fails(conus_atlas_write_meshes(atlas, "none", &cases[i]), CONUS_ERROR_ARGUMENT);
    }
    assert_fails(conus_atlas_write_meshes(NULL, "none", NULL), CONUS_ERROR_ARGUMENT);
    assert_fails(conus_atlas_write_meshes(atlas, NULL, NULL), CONUS_ERROR_ARGUMENT);
    assert_int_equal(access("none", F_OK), -1);
    conus_atlas_destroy(atlas);
}

static float positions[12] = {0, 0, 0, -1.5f, 0, 0, 0, 1e-7f, 123456.789f, 2e9f, -0.0f, 0.25f};
static uint32_t triangles[6] = {0, 2, 1, 0, 1, 3};
static const struct mesh sample = {
    .positions = positions, .vertex_count = 4, .triangles = triangles, .triangle_count = 2};
static const struct mesh_title title = {7, "A & B", {255, 0, 128}, "NIFTI_XFORM_TALAIRACH"};

static void obj_is_text_to_the_nanometre(void **state)
{
    (void)state;
    struct buffer bytes = {0};
    assert_ok(mesh_format(&bytes, &sample, &title, CONUS_MESH_OBJ));
    assert_string_equal(bytes.data, "# SPACE=RAS\n# label 7 color #ff0080\no A & B\n"
                                    "v 0.000000 0.000000 0.000000\nv -1.500000 0.000000 0.000000\n"
                                    "v 0.000000 0.000000 123456.789063\nv 2000000000 0.000000 0.250000\n"
                                    "f 1 3 2\nf 1 2 4\n");
    buffer_finish(&bytes);
}

static void binary_formats_have_their_sizes(void **state)
{
    (void)state;
    struct buffer stl = {0};
    struct buffer ply = {0};
    assert_ok(mesh_format(&stl, &sample, &title, CONUS_MESH_STL));
    assert_int_equal(stl.size, 80 + 4 + 2 * 50);
    assert_memory_equal(stl.data, "SPACE=RAS label 7 A & B\0", 24);
    assert_memory_equal(stl.data + 80, "\2\0\0\0", 4);
    assert_ok(mesh_format(&ply, &sample, &title, CONUS_MESH_PLY));
    const char *end = strstr(ply.data, "end_header\n");
    assert_non_null(end);
    assert_int_equal(ply.size - (size_t)(end - ply.data), strlen("end_header\n") + 4 * 12 + 2 * 13);
    buffer_finish(&stl);
    buffer_finish(&ply);
}

static void gifti_says_what_it_shows(void **state)
{
    (void)state;
    static const char *const parts[] = {
        "<MD><Name>Name</Name><Value>A &amp; B</Value></MD>",
        "<Label Key=\"7\" Red=\"1\" Green=\"0\" Blue=\"0.501960784\" Alpha=\"1\">A &amp; B</Label>",
        "Intent=\"NIFTI_INTENT_POINTSET\" DataType=\"NIFTI_TYPE_FLOAT32\"",
        "Dim0=\"4\" Dim1=\"3\" Encoding=\"Base64Binary\" Endian=\"LittleEndian\"",
        "<DataSpace>NIFTI_XFORM_TALAIRACH</DataSpace>",
        "<Data>AAAAAAIAAAABAAAAAAAAAAEAAAADAAAA</Data>", /* 0 2 1 0 1 3 */
    };
    struct buffer bytes = {0};
    assert_ok(mesh_format(&bytes, &sample, &title, CONUS_MESH_GIFTI));
    for (size_t i = 0; i < sizeof parts / sizeof parts[0]; i++) {
        if (!strstr(bytes.data, parts[i])) {
            fail_msg("no %s in %s", parts[i], bytes.data);
        }
    }
    buffer_finish(&bytes);
}

static conus_status attempt_format(void *data)
{
    struct buffer bytes = {0};
    conus_status status = mesh_format(&bytes, &sample, &title, *(const conus_mesh_format *)data);
    buffer_finish(&bytes);
    return status;
}

static conus_status attempt_write(void *data)
{
    return conus_atlas_write_meshes(data, test_scratch("again"), NULL);
}

static void every_failing_allocation(void **state)
{
    (void)state;
    struct buffer bytes = {0};
    conus_atlas *atlas = make_atlas();
    for (int format = CONUS_MESH_GIFTI; format <= CONUS_MESH_STL; format++) {
        conus_mesh_format chosen = (conus_mesh_format)format;
        test_every_allocation(attempt_format, &chosen);
    }
    build(&bytes, (uint32_t[]){3, 70000}, 2);
    play(&bytes);
    test_every_allocation(attempt_write, atlas);
    conus_atlas_destroy(atlas);
    buffer_finish(&bytes);
}

TEST_GROUP(mesh_write)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_area_gets_its_file),
        cmocka_unit_test(what_conus_mesh_makes_up_is_refused),
        cmocka_unit_test(options_have_ranges),
        cmocka_unit_test(obj_is_text_to_the_nanometre),
        cmocka_unit_test(binary_formats_have_their_sizes),
        cmocka_unit_test(gifti_says_what_it_shows),
        cmocka_unit_test(every_failing_allocation),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
