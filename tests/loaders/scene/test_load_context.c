/* SPDX-License-Identifier: BSD-3-Clause */
/* Surfaces around the areas: from files and manifests, never hit, never moved. */
#include "atlas/atlas.h"
#include "base/memory.h"
#include "builders/label_row.h"
#include "conus/own.h"
#include "loaders/surfaces/surfaces.h"
#include "mesh_scene.h"
#include "test.h"

#include <math.h>
#include <string.h>

static const double low[3] = {-20, -30, -40};
static const double high[3] = {25, 35, 45};

/* Writes a box as a file of the test's folder; returns its path. */
static const char *write_box(const char *name, conus_mesh_format format)
{
    struct mesh box = mesh_scene_box(low, high);
    struct buffer bytes = {0};
    const char *path = test_in(name);
    assert_ok(mesh_check(&box, NULL));
    assert_ok(
        mesh_format(&bytes, &box, &(struct mesh_title){.name = "box", .space = "NIFTI_XFORM_SCANNER_ANAT"}, format));
    assert_ok(conus_write_file(path, bytes.data, bytes.size));
    buffer_finish(&bytes);
    mesh_finish(&box);
    return path;
}

static void put_big(struct buffer *out, const void *value)
{
    const uint8_t *b = value;
    const char turned[4] = {(char)b[3], (char)b[2], (char)b[1], (char)b[0]};
    buffer_append(out, turned, 4);
}

/* FreeSurfer's format: magic number, comment, two line feeds, counts, positions, indices; big-endian. */
static const char *write_freesurfer(const char *name)
{
    struct mesh box = mesh_scene_box(low, high);
    struct buffer bytes = {0};
    const char *path = test_in(name);
    const uint32_t counts[2] = {(uint32_t)box.vertex_count, (uint32_t)box.triangle_count};
    buffer_append(&bytes,
                  "\xff\xff\xfe"
                  "made\n\n",
                  9);
    put_big(&bytes, &counts[0]);
    put_big(&bytes, &counts[1]);
    for (size_t i = 0; i < 3 * box.vertex_count; i++) {
        put_big(&bytes, &box.positions[i]);
    }
    for (size_t i = 0; i < 3 * box.triangle_count; i++) {
        put_big(&bytes, &box.triangles[i]);
    }
    assert_ok(conus_write_file(path, bytes.data, bytes.size));
    buffer_finish(&bytes);
    mesh_finish(&box);
    return path;
}

/* A ball of 10 mm about 0, which the box encloses. */
static conus_atlas *make_ball(void)
{
    conus_atlas *atlas = mesh_scene_atlas();
    struct mesh ball = mesh_scene_sphere((const double[3]){0}, 10, 16, 16);
    mesh_scene_add(atlas, &ball);
    return atlas;
}

static void check_box(const conus_atlas *atlas, size_t index, const char *path)
{
    conus_context_surface surface = CONUS_CONTEXT_SURFACE_INIT;
    assert_ok(conus_atlas_context_surface(&surface, atlas, index));
    assert_string_equal(surface.path, path);
    assert_int_equal(surface.triangles, 12);
    assert_true(surface.closed);
    for (int a = 0; a < 3; a++) {
        assert_near(surface.low[a], low[a], 1e-5);
        assert_near(surface.high[a], high[a], 1e-5);
    }
}

static void all_formats_of_surfaces_are_taken(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        conus_mesh_format format;
    } files[] = {{"box.surf.gii", CONUS_MESH_GIFTI}, {"box.vtp", CONUS_MESH_VTP},
                 {"box.obj", CONUS_MESH_OBJ},        {"box.ply", CONUS_MESH_PLY},
                 {"box.stl", CONUS_MESH_STL},        {"lh.box", CONUS_MESH_STL}}; /* FreeSurfer's */
    conus_context_surface surface = CONUS_CONTEXT_SURFACE_INIT;
    conus_atlas *atlas = make_ball();
    test_folder("formats");
    for (size_t i = 0; i < 6; i++) {
        const char *path = i < 5 ? write_box(files[i].name, files[i].format) : write_freesurfer(files[i].name);
        const conus_context_options options = {.opacity = i ? 0.5 : 0};
        assert_true(conus_context_is_surface(path));
        assert_ok(conus_atlas_set_context(atlas, path, &options));
        assert_int_equal(conus_atlas_context_surface_count(atlas), i + 1);
        check_box(atlas, i, path);
        assert_ok(conus_atlas_context_surface(&surface, atlas, i));
        assert_near(surface.opacity, i ? 0.5 : 0.25, 0);
        assert_int_equal(surface.hemisphere, i < 5 ? 0 : 'L');
        assert_string_equal(conus_atlas_file(atlas, i), path);
    }
    assert_fails(conus_atlas_context_surface(&surface, atlas, 6), CONUS_ERROR_ARGUMENT);
    assert_int_equal(conus_atlas_object_count(atlas), 1);
    assert_int_equal(conus_atlas_volume_count(atlas), 0);
    conus_atlas_destroy(atlas);
}

/* The ball is behind a wall of the box at y = -30, at 10 mm from its middle: 40 mm from an eye at y = -50. */
static void no_ray_hits_them_and_nothing_moves_them(void **state)
{
    (void)state;
    test_folder("around");
    conus_atlas *atlas = make_ball();
    const struct cone cone = mesh_scene_cone((const double[]){0, -50, 0}, (const double[]){0, 0, 0}, 5, 32);
    const char *path = write_box("skin.stl", CONUS_MESH_STL);
    conus_selection *before = mesh_scene_select(atlas, &(conus_selector_options){0}, &cone);
    assert_ok(conus_atlas_set_context(atlas, path, NULL));
    conus_selection *after = mesh_scene_select(atlas, &(conus_selector_options){0}, &cone);
    assert_int_equal(conus_selection_count(after), conus_selection_count(before));
    assert_memory_equal(conus_selection_result(after, 0), conus_selection_result(before, 0), sizeof(conus_result));
    assert_near(conus_selection_result(after, 0)->distance, 40, 0.2);
    conus_selection_destroy(before);
    conus_selection_destroy(after);
    assert_ok(conus_atlas_move(atlas, (const double[16]){1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 3, 4, 5, 1}));
    check_box(atlas, 0, path);
    conus_atlas_destroy(atlas);
}

static void what_is_not_of_surfaces_is_refused(void **state)
{
    (void)state;
    test_folder("refused");
    conus_atlas *atlas = make_ball();
    const char *path = write_box("skin.ply", CONUS_MESH_PLY);
    static const conus_context_options options[] = {
        {.block_threshold = 1}, {.opacity = 1.5}, {.opacity = -0.5}, {.opacity = NAN}};
    for (size_t i = 0; i < 4; i++) {
        assert_fails(conus_atlas_set_context(atlas, path, &options[i]), CONUS_ERROR_ARGUMENT);
        assert_non_null(strstr(conus_message(), path));
    }
    assert_ok(conus_write_file(test_in("bad.obj"), "v 0 0 0\nf 1 2 3\n", 16));
    assert_fails(conus_atlas_set_context(atlas, test_in("bad.obj"), NULL), CONUS_ERROR_DATA);
    assert_fails(conus_atlas_set_context(atlas, test_in("none.obj"), NULL), CONUS_ERROR_IO);
    assert_false(conus_context_is_surface(test_in("none.obj")));
    assert_int_equal(conus_atlas_context_surface_count(atlas), 0);
    assert_int_equal(conus_atlas_note_count(atlas), 0);
    assert_int_equal(conus_atlas_file_count(atlas), 0);
    conus_atlas_destroy(atlas);
}

/* A box like the others', of coordinates times `scale`, and moved along x. */
static const char *write_scaled(const char *name, double scale, double shift)
{
    const double least[3] = {scale * low[0] + shift, scale * low[1], scale * low[2]};
    const double most[3] = {scale * high[0] + shift, scale * high[1], scale * high[2]};
    struct mesh box = mesh_scene_box(least, most);
    struct buffer bytes = {0};
    const char *path = test_in(name);
    assert_ok(mesh_check(&box, NULL));
    assert_ok(mesh_format(&bytes, &box, &(struct mesh_title){.name = "box", .space = "NIFTI_XFORM_SCANNER_ANAT"},
                          CONUS_MESH_GIFTI));
    assert_ok(conus_write_file(path, bytes.data, bytes.size));
    buffer_finish(&bytes);
    mesh_finish(&box);
    return path;
}

/* The note about a context's place, without the path; NULL if there is none. */
static const char *place_note(const conus_atlas *atlas)
{
    const char *found = NULL;
    for (size_t i = 0; conus_atlas_note(atlas, i); i++) {
        const char *note = strstr(conus_atlas_note(atlas, i), ": ");
        bool about = note && (strstr(note, "beside areas of") || strstr(note, "beside the box"));
        assert_true(!about || !found);
        found = about ? note + 2 : found;
    }
    return found;
}

static void assert_place(conus_atlas *atlas, const char *wanted)
{
    const char *found = place_note(atlas);
    if (!wanted != !found || (wanted && strcmp(found, wanted) != 0)) {
        fail_msg("found \"%s\", wanted \"%s\"", found ? found : "nothing", wanted ? wanted : "nothing");
    }
    conus_atlas_destroy(atlas);
}

/* A grid of 4 voxels, 2 x 1 x 2: with edges of 10 mm it is 20 mm long, as the ball is. */
static void volumes_of_other_units_are_noted(void **state)
{
    (void)state;
    static const struct {
        double edge;
        const char *note;
    } cases[] = {
        {10, NULL},
        {2499, NULL},
        {2500, "5000 mm long, beside areas of 20 mm: is one of the two in micrometres, not mm?"},
        {0.041, NULL},
        {0.039, "0.078 mm long, beside areas of 20 mm: is one of the two in metres, not mm?"},
    };
    static const float values[4] = {0, 1, 2, 3};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        conus_atlas *atlas = make_ball();
        conus_voxels voxels = CONUS_VOXELS_INIT;
        const size_t dim[3] = {2, 1, 2};
        voxels.data = values;
        voxels.type = CONUS_SCALAR_FLOAT32;
        memcpy(voxels.dim, dim, sizeof dim);
        for (size_t a = 0; a < 3; a++) {
            voxels.world_from_voxel[5 * a] = cases[i].edge;
        }
        voxels.world_from_voxel[15] = 1;
        assert_ok(conus_atlas_set_context_voxels(atlas, &voxels, NULL));
        assert_place(atlas, cases[i].note);
    }
}

/* The beginning of a manifest. */
#define VOXELS "{\"conus_atlas\": 1, \"parcellation\": \"v.nii\", "

/* Loads m.atlas.json, which is `text`, whole and without its context: it has the same notes, and if its context was
 * left out it is not asked what takes one. */
static void check_left_out(const char *text, bool left_out)
{
    conus_atlas *atlases[2] = {0};
    double inward[3];
    row_text(test_in("m.atlas.json"), text);
    for (int k = 0; k < 2; k++) {
        assert_ok(conus_atlas_load(&atlases[k], test_in("m.atlas.json"), &(conus_load_options){.without_context = k}));
    }
    assert_int_equal(conus_atlas_note_count(atlases[1]), conus_atlas_note_count(atlases[0]));
    for (size_t i = 0; i < conus_atlas_note_count(atlases[0]); i++) {
        assert_string_equal(conus_atlas_note(atlases[1], i), conus_atlas_note(atlases[0], i));
    }
    for (int k = 0; k < 2; k++) {
        const bool lacks = k && left_out;
        assert_int_equal(!atlas_context(atlases[k]) && !conus_atlas_context_surface_count(atlases[k]), lacks);
        assert_int_equal(conus_atlas_inward(inward, NULL, atlases[k], (const double[]){99, 0, 0}),
                         lacks ? CONUS_ERROR_ARGUMENT : CONUS_OK);
        assert_int_equal(conus_atlas_transform(atlases[k], test_in("move.txt"), NULL),
                         lacks ? CONUS_ERROR_ARGUMENT : CONUS_OK);
        conus_atlas_destroy(atlases[k]);
    }
}

static void a_context_that_no_answer_needs_is_left_out(void **state)
{
    (void)state;
    static const char areas[] =
        "{\"conus_atlas\": 1, \"areas\": [{\"file\": \"b.gii\", \"label\": 1, \"name\": \"b\"}], "
        "\"context\": \"image.nii\"}";
    static const conus_load_options without = {.without_context = true};
    conus_atlas *atlas = NULL;
    test_folder("left_out");
    row_write("v.nii", 8, 1);
    row_write("image.nii", 8, 2);
    row_write("far.nii", 8, 1000);
    write_scaled("b.gii", 1, 0);
    row_text(test_in("move.txt"), "1 0 0 3\n0 1 0 0\n0 0 1 0\n0 0 0 1\n");
    check_left_out(VOXELS "\"context\": \"image.nii\"}", true);
    /* It blocks; it is the only volume, whose brain it is; the atlas is compared with its head; it is noted to be long;
     * it is a surface. */
    check_left_out(VOXELS "\"context\": {\"file\": \"image.nii\", \"blocks\": 2}}", false);
    check_left_out(areas, false);
    check_left_out(VOXELS "\"transform\": \"move.txt\", \"context\": \"image.nii\"}", false);
    check_left_out(VOXELS "\"context\": \"far.nii\"}", false);
    check_left_out(VOXELS "\"context\": \"b.gii\"}", false);
    row_text(test_in("m.atlas.json"), VOXELS "\"context\": [\"image.nii\", \"v.nii\"]}");
    assert_fails(conus_atlas_load(&atlas, test_in("m.atlas.json"), &without), CONUS_ERROR_DATA);
    assert_non_null(strstr(conus_message(), "context[1]: file: is no surface, and there is a volume already"));
    row_text(test_in("m.atlas.json"), VOXELS "\"context\": \"move.txt\"}");
    assert_fails(conus_atlas_load(&atlas, test_in("m.atlas.json"), &without), CONUS_ERROR_DATA);
    row_text(test_in("m.atlas.json"), VOXELS "\"context\": \"none.nii\"}");
    assert_fails(conus_atlas_load(&atlas, test_in("m.atlas.json"), NULL), CONUS_ERROR_IO);
    assert_ok(conus_atlas_load(&atlas, test_in("m.atlas.json"), &without)); /* as where verify answers again */
    conus_atlas_destroy(atlas);
}

/* Areas that are surfaces, beside areas of voxels: a grid of 8 mm and the box of 85 mm, 10.625 times as long. */
static void surfaces_of_other_units_are_noted(void **state)
{
    (void)state;
    static const char text[] = "{\"conus_atlas\": 1, \"parcellation\": \"v.nii\", \"areas\": [{\"file\": \"b.gii\","
                               " \"label\": 100, \"name\": \"box\"}]}";
    const char *path;
    test_folder("areas");
    row_write("v.nii", 8, 1);
    assert_ok(conus_write_file(test_in("m.atlas.json"), text, strlen(text)));
    for (int large = 0; large < 2; large++) {
        conus_atlas *atlas = NULL;
        write_scaled("b.gii", large ? 1000 : 1, 0);
        path = test_in("m.atlas.json");
        assert_ok(conus_atlas_load(&atlas, path, NULL));
        assert_place(atlas,
                     large ? "8.5e+04 mm long, beside areas of 8 mm: is one of the two in micrometres, not mm?" : NULL);
    }
}

static conus_status attempt(void *data)
{
    conus_atlas *atlas = make_ball();
    test_fail_allocation(*(long *)data);
    conus_status status = conus_atlas_set_context(atlas, test_in("skin.gii"), NULL);
    test_fail_allocation(-1);
    assert_int_equal(conus_atlas_context_surface_count(atlas), status ? 0 : 1);
    conus_atlas_destroy(atlas);
    return status;
}

static void every_failing_allocation_leaves_the_atlas(void **state)
{
    (void)state;
    test_folder("memory");
    write_box("skin.gii", CONUS_MESH_GIFTI);
    conus_status status = CONUS_ERROR_MEMORY;
    for (long n = 0; status; n++) {
        status = attempt(&n);
        assert_true(!status || status == CONUS_ERROR_MEMORY);
    }
}

/* Writes as many numbers as the box has vertices, or another count: all 0 but the first two, 3 and -2. */
static const char *write_map(const char *name, size_t count, const char *structure)
{
    float values[16] = {3, -2};
    const conus_vertex_map map = {"leeway_mm", values, NULL};
    assert_ok(conus_vertex_maps_write(test_in(name), &map, 1, count, structure));
    return test_in(name);
}

static void a_map_colours_the_surface_that_it_fits(void **state)
{
    (void)state;
    test_folder("map");
    conus_atlas *atlas = make_ball();
    write_map("m.func.gii", 8, NULL);
    write_map("longer.func.gii", 9, NULL);
    write_map("left.func.gii", 8, "CortexLeft");
    assert_fails(conus_atlas_set_context_map(atlas, test_in("m.func.gii"), NULL), CONUS_ERROR_ARGUMENT);
    assert_ok(conus_atlas_set_context(atlas, write_box("skin.gii", CONUS_MESH_GIFTI), NULL));
    static const conus_context_map_options bad[] = {
        {.array = "leeway"}, {.range = {2, 1}}, {.range = {0, INFINITY}}, {.range = {NAN, 1}}, {.opacity = 2}};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        assert_fails(conus_atlas_set_context_map(atlas, test_in("m.func.gii"), &bad[i]), CONUS_ERROR_ARGUMENT);
    }
    assert_fails(conus_atlas_set_context_map(atlas, test_in("longer.func.gii"), NULL), CONUS_ERROR_ARGUMENT);
    assert_non_null(strstr(conus_message(), "longer.func.gii: 9 numbers, but skin.gii has 8 vertices"));
    assert_null(atlas_mapped_surface(atlas));
    assert_int_equal(conus_atlas_file_count(atlas), 1);
    assert_ok(conus_atlas_set_context_map(atlas, test_in("m.func.gii"), NULL));
    const struct context_surface *mapped = atlas_mapped_surface(atlas);
    assert_true(mapped->low == -2 && mapped->high == 3 && mapped->opacity == 1 && mapped->values[1] == -2);
    assert_int_equal(conus_atlas_file_count(atlas), 2);
    assert_ok(conus_atlas_set_context(atlas, write_freesurfer("lh.skin"), NULL));
    assert_fails(conus_atlas_set_context_map(atlas, test_in("m.func.gii"), NULL), CONUS_ERROR_ARGUMENT);
    assert_non_null(strstr(conus_message(), "8 numbers: 2 surfaces of the context have so many vertices, one must"));
    assert_ok(conus_atlas_set_context(atlas, write_freesurfer("rh.skin"), NULL));
    conus_atlas_destroy(atlas);
    atlas = make_ball();
    assert_ok(conus_atlas_set_context(atlas, test_in("rh.skin"), NULL));
    assert_fails(conus_atlas_set_context_map(atlas, test_in("left.func.gii"), NULL), CONUS_ERROR_ARGUMENT);
    assert_ok(conus_atlas_set_context(atlas, test_in("lh.skin"), NULL));
    assert_ok(
        conus_atlas_set_context_map(atlas, test_in("left.func.gii"), &(conus_context_map_options){.opacity = 0.5}));
    assert_int_equal(atlas_mapped_surface(atlas)->hemisphere, 'L');
    assert_near(atlas_mapped_surface(atlas)->opacity, 0.5, 0);
    conus_atlas_destroy(atlas);
}

static conus_status attempt_map(void *atlas)
{
    return conus_atlas_set_context_map(atlas, test_in("m.func.gii"), NULL);
}

static void every_failing_allocation_of_a_map(void **state)
{
    (void)state;
    test_folder("map_memory");
    conus_atlas *atlas = make_ball();
    write_map("m.func.gii", 8, NULL);
    assert_ok(conus_atlas_set_context(atlas, write_box("skin.gii", CONUS_MESH_GIFTI), NULL));
    test_every_allocation(attempt_map, atlas);
    assert_true(test_every_primitive(attempt_map, atlas) > 2);
    conus_atlas_destroy(atlas);
}

TEST_GROUP(load_context)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(all_formats_of_surfaces_are_taken),
        cmocka_unit_test(no_ray_hits_them_and_nothing_moves_them),
        cmocka_unit_test(what_is_not_of_surfaces_is_refused),
        cmocka_unit_test(volumes_of_other_units_are_noted),
        cmocka_unit_test(surfaces_of_other_units_are_noted),
        cmocka_unit_test(a_context_that_no_answer_needs_is_left_out),
        cmocka_unit_test(every_failing_allocation_leaves_the_atlas),
        cmocka_unit_test(a_map_colours_the_surface_that_it_fits),
        cmocka_unit_test(every_failing_allocation_of_a_map),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
