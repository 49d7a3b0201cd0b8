/* SPDX-License-Identifier: BSD-3-Clause */
/* Turns and splines of ITK, images of FreeSurfer, and atlases that transforms move; tests/corpus/transform/ has the
 * formats of affines. tests/oracles/compare_transforms.py has random ones. */
#include "atlas/atlas.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "builders/nifti_builder.h"
#include "conus/own.h"
#include "loaders/transform/transform.h"
#include "mesh_scene.h"
#include "scene.h"
#include "test.h"

#include <jansson.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static conus_status read_bytes(struct transform_chain *out, struct bytes file, const char *path,
                               const conus_transform_options *options)
{
    struct job job = {0};
    transform_read(&job, out, source_of_memory(&job, path, (struct text){(const char *)file.data, file.size}), options);
    if (!job_ok(&job)) {
        transform_chain_finish(out);
    }
    return job_close(&job, NULL, NULL);
}

/* Parses the matrix of an affine. */
static conus_status parse_bytes(double out[16], const void *data, size_t size, const char *path)
{
    struct transform_chain made;
    const struct bytes file = {(uint8_t *)data, size};
    conus_status status = read_bytes(&made, file, path, &(conus_transform_options){0});
    if (!status) {
        assert_int_equal(made.count, 0);
        memcpy(out, made.matrix, sizeof made.matrix);
        transform_chain_finish(&made);
    }
    return status;
}

static conus_status parse(double out[16], const char *text, const char *path)
{
    return parse_bytes(out, text, strlen(text), path);
}

/* Asserts where the matrix of `text` takes the point (1, 2, 3). */
static void check_point(const char *text, double x, double y, double z)
{
    double m[16];
    double p[3] = {1, 2, 3};
    assert_ok(parse(m, text, "x.txt"));
    mat4_point(p, m, p);
    assert_near(p[0], x, 1e-12);
    assert_near(p[1], y, 1e-12);
    assert_near(p[2], z, 1e-12);
}

#define ITK "#Insight Transform File V1.0\n#Transform 0\n"

/* x' = 2 x + 1, y' = y, z' = z + 3 in LPS. The point is (-1, -2, 3) there and comes to (-1, -2, 6): (1, 2, 6) in RAS.
 */
static const char itk_affine[] =
    ITK "Transform: AffineTransform_double_3_3\nParameters: 2 0 0 0 1 0 0 0 1 1 0 3\nFixedParameters: 0 0 0\n";

/* A quarter turn about z takes (x, y) to (-y, x), in LPS as in RAS: (1, 2) comes to (-2, 1). */
static void itk_turns(void **state)
{
    (void)state;
    check_point(ITK "Transform: Euler3DTransform_double_3_3\nParameters: 0 0 1.5707963267948966 0 0 0\n"
                    "FixedParameters: 0 0 0\n",
                -2, 1, 3);
    check_point(ITK "Transform: VersorRigid3DTransform_double_3_3\nParameters: 0 0 0.7071067811865476 0 0 0\n"
                    "FixedParameters: 0 0 0\n",
                -2, 1, 3);
    check_point(ITK "Transform: Similarity3DTransform_double_3_3\nParameters: 0 0 0.7071067811865476 0 0 0 2\n"
                    "FixedParameters: 0 0 0\n",
                -4, 2, 6);
    check_point(ITK "Transform: TranslationTransform_double_3_3\nParameters: 1 2 3\nFixedParameters:\n", 0, 0, 6);
    check_point(ITK "Transform: IdentityTransform_double_3_3\nParameters:\nFixedParameters:\n", 1, 2, 3);
}

/* Quarter turns about x and y, of LPS (-1, -2, 3). By default about y first, (x, z) to (z, -x): (3, -2, 1), then about
 * x, (y, z) to (-z, y): (3, -1, -2). With the fourth fixed parameter about x first: (-1, -3, -2), then y: (-2, -3, 1).
 */
static void the_order_of_euler_angles_is_itks(void **state)
{
    (void)state;
    static const char text[] =
        ITK "Transform: Euler3DTransform_double_3_3\nParameters: 1.5707963267948966 1.5707963267948966 0 0 0 0\n"
            "FixedParameters: 0 0 0%s\n";
    char order[sizeof text];
    snprintf(order, sizeof order, text, "");
    check_point(order, -3, 1, -2);
    snprintf(order, sizeof order, text, " 1");
    check_point(order, 2, 3, 1);
}

static const char plain[] = "# RAS\n2 0 0 1\n0 1 0 0\n0 0 1 3\n0 0 0 1\n";
/* The text of a spline on 4 x 5 x 6 nodes 10 mm apart along LPS, from (-15, -20, -25), or on another grid: `numbers`
 * coefficients, all 1 of the block `ones`, all 0 of the others. */
static char *make_spline(size_t numbers, size_t ones, const char *type, const char *fixed)
{
    struct buffer text = {0};
    buffer_format(&text, "Transform: %s\nParameters:", type);
    for (size_t i = 0; i < numbers; i++) {
        buffer_text(&text, i / 120 == ones ? " 1" : " 0");
    }
    buffer_format(&text, "\nFixedParameters: %s\n", fixed);
    assert_ok(buffer_status(&text));
    return text.data;
}

static const char spline_type[] = "BSplineTransform_double_3_3";
static const char spline_grid[] = "4 5 6 -15 -20 -25 10 10 10 1 0 0 0 1 0 0 0 1";

static char *make_file(const char *entries)
{
    struct buffer text = {0};
    buffer_format(&text, ITK "%s", entries);
    assert_ok(buffer_status(&text));
    return text.data;
}

static void chain_point(double p[3], const struct transform_chain *chain)
{
    for (size_t i = chain->count; i-- > 0;) {
        (void)deformation_point(p, &chain->fields[i], p);
    }
    mat4_point(p, chain->matrix, p); /* the matrix of a chain with fields is the identity */
}

/* The image of a point; false if the text is no transform. */
static bool spline_point(double p[3], const char *entries)
{
    char *text = make_file(entries);
    struct transform_chain made;
    const struct bytes file = {(uint8_t *)text, strlen(text)};
    bool is = !read_bytes(&made, file, "x.tfm", &(conus_transform_options){0});
    if (is) {
        chain_point(p, &made);
        transform_chain_finish(&made);
    }
    memory_free(text);
    return is;
}

/* The grid covers LPS -5 to 5, -10 to 10, -15 to 15 mm; the coefficients of one component move points along that of
 * LPS. */
static void splines_move_along_lps(void **state)
{
    (void)state;
    static const double sides[3] = {-1, -1, 1};
    for (size_t n = 0; n < 3; n++) {
        char *text = make_spline(360, n, n == 1 ? "BSplineDeformableTransform_float_3_3" : spline_type, spline_grid);
        double p[3] = {4.5, -9.5, 14.5};
        double out[3] = {5.5, -9.5, 14.5};
        const double start[3] = {4.5, -9.5, 14.5};
        assert_true(spline_point(p, text));
        for (size_t a = 0; a < 3; a++) {
            assert_near(p[a], start[a] + (a == n ? sides[a] : 0), 1e-12);
        }
        assert_true(spline_point(out, text));
        assert_near(out[0], 5.5, 0);
        memory_free(text);
    }
}

/* Points of RAS go right by 2 (LPS -2), then through the spline, 1 along LPS y, and then are doubled. */
static void splines_are_parts_of_composites(void **state)
{
    (void)state;
    char *spline = make_spline(360, 1, spline_type, spline_grid);
    char text[2000];
    snprintf(text, sizeof text,
             "Transform: CompositeTransform_double_3_3\n"
             "Transform: AffineTransform_double_3_3\nParameters: 2 0 0 0 2 0 0 0 2 0 0 0\nFixedParameters: 0 0 0\n%s"
             "Transform: TranslationTransform_double_3_3\nParameters: -2 0 0\nFixedParameters:\n",
             spline);
    double p[3] = {1, 3, 5};
    assert_true(spline_point(p, text));
    assert_near(p[0], 6, 1e-12);
    assert_near(p[1], 4, 1e-12);
    assert_near(p[2], 10, 1e-12);
    memory_free(spline);
}

/* Compares with the points that ITK 5.2.1 made of its own file. */
static void itk_moves_points_alike(void **state)
{
    (void)state;
    char path[512];
    snprintf(path, sizeof path, "%s", test_shared("files-2026/itk/ffd.tfm"));
    json_t *all = json_load_file(test_shared("files-2026/itk/expected.json"), 0, NULL);
    json_t *points = json_object_get(json_object_get(all, "ffd.tfm"), "points");
    struct transform_chain made;
    struct job job = {0};
    assert_true(json_array_size(points) > 20);
    transform_read(&job, &made, source_open(&job, path), &(conus_transform_options){0});
    assert_ok(job_close(&job, NULL, NULL));
    for (size_t i = 0; i < json_array_size(points); i++) {
        double n[6];
        for (size_t k = 0; k < 6; k++) {
            n[k] = json_number_value(json_array_get(json_array_get(points, i), k));
        }
        chain_point(n, &made);
        for (size_t a = 0; a < 3; a++) {
            assert_near(n[a], n[3 + a], 1e-9);
        }
    }
    transform_chain_finish(&made);
    json_decref(all);
}

/* An image of which only the header matters. */
static const char *write_image(const char *name, const int64_t dim[3], const double *srow)
{
    struct nifti_builder builder;
    nifti_begin(&builder, 1, false, 2, dim);
    for (size_t i = 0; srow && i < 12; i++) {
        nifti_set(&builder, "srow", i, srow[i]);
        nifti_set(&builder, "pixdim", 1 + i % 3, 1);
    }
    for (int64_t i = 0; i < dim[0] * dim[1] * dim[2]; i++) {
        nifti_voxel(&builder, 0);
    }
    const char *path = write_bytes(name, &builder.bytes);
    buffer_finish(&builder.bytes);
    return path;
}

#define REGISTER(edges, more) "bert\n" edges "0.15\n1 0 0 1\n0 0 1 10\n0 -1 0 0\n0 0 0 0.99999994\n" more

/* Voxel (3, 4, 6) of 4 x 6 x 8 voxels of 2 x 3 x 4 mm is (-2, 8, -3) in tkregister RAS. The matrix takes that to
 * (-1, 7, -8), which is voxel (6, 14, 14) of 10 x 12 x 14 of 1 mm; its axes lead to -y, z and x. */
static void a_register_dat_is_between_two_images(void **state)
{
    (void)state;
    static const int64_t dim[][3] = {{4, 6, 8}, {10, 12, 14}};
    static const double srow[12] = {0, 0, 1, 100, -1, 0, 0, 200, 0, 1, 0, 300};
    static const char *const texts[] = {REGISTER("1\n1\n", "round\n"), REGISTER("1\n1\n", ""),
                                        REGISTER("3.5\n5\n", "tkregister\n")};
    conus_transform_options options = {.from = write_image("from.nii", dim[0], NULL)};
    options.to = write_image("to.nii", dim[1], srow);
    struct transform_chain made;
    for (size_t i = 0; i < 3; i++) {
        const struct bytes file = {(uint8_t *)texts[i], strlen(texts[i])};
        double p[3] = {-4, -8, -6};
        assert_ok(read_bytes(&made, file, "register.dat", &options));
        mat4_point(p, made.matrix, p);
        assert_near(p[0], 114, 1e-9);
        assert_near(p[1], 194, 1e-9);
        assert_near(p[2], 314, 1e-9);
        transform_chain_finish(&made);
    }
    static const struct {
        const char *text, *words;
    } bad[] = {
        {REGISTER("2\n4\n", "round\n"), "from is the anatomical image"},
        {REGISTER("1\n1\n", "round\n1 2 3\n"), "\"1 2 3\" behind the matrix and a word"},
        {"bert\n1\n1\n0.15\n1 0 0 1\n0 0 1\n", "matrix: row 2: 3 numbers"},
        {"bert\n1\n1\n0.15\n1 0 0 1\n0 0 1 0\n0 1 0 0\n0 0 1 1\n", "matrix: last row 0 0 1 1"},
        {"bert\n1\n1\n0.15\n1 0 0 1\n0 0 0 0\n0 1 0 0\n0 0 0 1\n", "the matrix is singular"},
    };
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        const struct bytes file = {(uint8_t *)bad[i].text, strlen(bad[i].text)};
        assert_true(read_bytes(&made, file, "register.dat", &options) != CONUS_OK);
        assert_non_null(strstr(conus_message(), bad[i].words));
    }
    for (size_t size = 0; size < strlen(texts[1]) - 9; size++) {
        assert_true(read_bytes(&made, (struct bytes){(uint8_t *)texts[1], size}, "register.dat", &options));
    }
    options.to = NULL;
    const struct bytes file = {(uint8_t *)texts[0], strlen(texts[0])};
    assert_fails(read_bytes(&made, file, "register.dat", &options), CONUS_ERROR_ARGUMENT);
}

static void write_file(char path[64], const char *text)
{
    strncpy(path, "/tmp/conus-transform-XXXXXX.txt", 64);
    int descriptor = mkstemps(path, 4);
    assert_true(descriptor >= 0);
    assert_int_equal(write(descriptor, text, strlen(text)), (ssize_t)strlen(text));
    close(descriptor);
}

/* For a spline, too, every prefix is refused that lacks more than digits of the last number. */
static void no_prefix_is_a_spline(void **state)
{
    (void)state;
    char *entry = make_spline(360, 0, spline_type, spline_grid);
    for (size_t size = strlen(entry) - 3; size-- > 0;) {
        double p[3];
        entry[size] = '\0';
        assert_false(spline_point(p, entry));
    }
    memory_free(entry);
}

/* A voxel atlas and a box in it. */
static conus_atlas *make_atlas(void)
{
    uint32_t labels[64];
    for (size_t i = 0; i < 64; i++) {
        labels[i] = 8;
    }
    const conus_volume_info grid = scene_plain_grid((const size_t[]){4, 4, 4}, NULL);
    conus_atlas *atlas = scene_parcellation(&grid, labels);
    struct mesh box = mesh_scene_box((const double[]){10, 0, 0}, (const double[]){12, 3, 4});
    mesh_scene_add(atlas, &box);
    return atlas;
}

/* x' = 2 x + 1, z' = z + 3 takes poses' points to the atlas: there the atlas is half as long, and 1 / 2 less, 3 lower.
 */
static void an_atlas_goes_to_the_poses(void **state)
{
    (void)state;
    char path[64];
    conus_atlas *atlas = make_atlas();
    double low[3];
    double high[3];
    double point[3] = {5, 0, -3};
    write_file(path, plain);
    assert_ok(conus_atlas_transform(atlas, path, NULL));
    assert_near(atlas->objects[0].volume_mm3, 32, 1e-9);
    assert_near(atlas->objects[1].volume_mm3, 12, 1e-5);
    assert_ok(conus_atlas_bounds(low, high, atlas));
    assert_near(low[0], (-0.5 - 1) / 2, 1e-6);
    assert_near(high[0], (12.0 - 1) / 2, 1e-6);
    assert_near(low[2], -0.5 - 3, 1e-6);
    assert_near(high[2], 4 - 3, 1e-6);
    conus_atlas_own_point(point, atlas, point);
    assert_near(point[0], 11, 1e-12);
    assert_near(point[2], 0, 1e-12);
    assert_true(test_has_note(atlas, "what was 1 mm^3 is 0.5 mm^3"));
    assert_non_null(strstr(conus_atlas_volume(atlas, 0)->transform, ", moved"));
    assert_int_equal(conus_atlas_volume(atlas, 0)->space_code, 0);
    assert_string_equal(conus_atlas_file(atlas, conus_atlas_file_count(atlas) - 1), path);
    assert_ok(conus_atlas_transform(atlas, path, &(conus_transform_options){.inverse = true}));
    assert_near(atlas->objects[0].volume_mm3, 64, 1e-9);
    assert_ok(conus_atlas_bounds(low, high, atlas));
    assert_near(low[0], -0.5, 1e-6);
    unlink(path);
    conus_atlas_destroy(atlas);
}

/* The spline shifts all within LPS -5 to 5, -10 to 10, -15 to 15 by 1 along LPS x: points of (-1, 0, 0) come from
 * (0, 0, 0). Voxels are those of the atlas, on the spline's grid: 11 x 21 x 31 of 1 mm. */
static void a_spline_moves_voxels_and_vertices(void **state)
{
    (void)state;
    char path[64];
    conus_atlas *atlas = make_atlas();
    mesh_scene_add(atlas, &(struct mesh[]){mesh_scene_box((const double[]){-3, 0, 0}, (const double[]){2, 3, 4})}[0]);
    char *entry = make_spline(360, 0, spline_type, spline_grid);
    char *text = make_file(entry);
    write_file(path, text);
    assert_fails(conus_atlas_transform(atlas, path, &(conus_transform_options){.inverse = true}),
                 CONUS_ERROR_UNSUPPORTED);
    assert_fails(conus_atlas_transform(atlas, path, &(conus_transform_options){.vectors = CONUS_VECTORS_RELATIVE}),
                 CONUS_ERROR_ARGUMENT);
    assert_false(atlas->is_moved);
    assert_ok(conus_atlas_transform(atlas, path, NULL));
    assert_near(atlas->objects[0].volume_mm3, 64, 1e-9);
    assert_near(atlas->objects[2].volume_mm3, 60, 1e-4);
    assert_near(atlas->meshes[1].positions[0], -2, 1e-5);
    assert_true(test_has_note(atlas, "on a grid of 11 x 21 x 31 voxels of 1 x 1 x 1 mm"));
    const conus_volume_info *info = conus_atlas_volume(atlas, 0);
    assert_int_equal(info->dim[0] * info->dim[1] * info->dim[2], 11 * 21 * 31);
    double p[3] = {0, 0, 0};
    conus_atlas_own_point(p, atlas, p);
    assert_near(p[0], -1, 1e-12);
    unlink(path);
    memory_free(text);
    memory_free(entry);
    conus_atlas_destroy(atlas);
}

/* Nodes far apart: points within LPS 0 to 10 km go by 1 mm along LPS x, those of the atlas at -1 mm come from 0. The
 * grid has what can come to the atlas's 4 voxels a side, and not 10^21 voxels; where points go by up to 1 m it would
 * have 2 m a side, too many.
 */
static void a_wide_spline_has_the_atlas_s_grid(void **state)
{
    (void)state;
    static const char wide[] = "4 4 4 -15000000 -15000000 -15000000 10000000 10000000 10000000 1 0 0 0 1 0 0 0 1";
    for (int far = 0; far < 2; far++) {
        char path[64];
        conus_atlas *atlas = make_atlas();
        struct buffer text = {0};
        buffer_format(&text, ITK "Transform: %s\nParameters:", spline_type);
        for (int i = 0; i < 192; i++) {
            buffer_text(&text, far ? (i % 2 ? " -1e3" : " 1e3") : i < 64 ? " 1" : " 0");
        }
        buffer_format(&text, "\nFixedParameters: %s\n", wide);
        write_file(path, text.data);
        if (far) {
            assert_fails(conus_atlas_transform(atlas, path, NULL), CONUS_ERROR_DATA);
            assert_non_null(strstr(conus_message(), "grid=IMAGE is needed"));
        } else {
            assert_ok(conus_atlas_transform(atlas, path, NULL));
            const conus_volume_info *info = conus_atlas_volume(atlas, 0);
            assert_true(info->dim[0] <= 10 && info->dim[1] <= 10 && info->dim[2] <= 10);
            assert_near(atlas->objects[0].volume_mm3, 64, 1e-9);
        }
        unlink(path);
        buffer_finish(&text);
        conus_atlas_destroy(atlas);
    }
}

static void names_of_ants_have_a_kind(void **state)
{
    (void)state;
    struct text prefix;
    static const struct {
        const char *name;
        enum ants_kind kind;
    } names[] = {{"d/o_0GenericAffine.mat", ANTS_AFFINE},
                 {"d/o_1Warp.nii.gz", ANTS_WARP},
                 {"d/o_1InverseWarp.nii.gz", ANTS_INVERSE_WARP},
                 {"d/o_3InverseWarp.nii", ANTS_INVERSE_WARP},
                 {"d/o_Affine.txt", ANTS_AFFINE},
                 {"d/o_InverseComposite.h5", ANTS_COMPOSITE},
                 {"d/o_Composite.h5", ANTS_COMPOSITE},
                 {"d/o_y_T1.nii", ANTS_NONE}};
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
        assert_int_equal(transform_name_ants(&prefix, names[i].name), names[i].kind);
        assert_true(names[i].kind == ANTS_NONE || text_equal(prefix, "d/o_"));
    }
}

static void a_mirror_is_warned_of(void **state)
{
    (void)state;
    conus_atlas *atlas = make_atlas();
    double mirror[16];
    mat4_identity(mirror);
    mirror[0] = -1;
    assert_ok(conus_atlas_move(atlas, mirror));
    assert_true(test_has_note(atlas, "mirrors"));
    assert_near(atlas->objects[1].volume_mm3, 24, 1e-5);
    assert_true(atlas->meshes[0].shape.volume_mm3 > 0); /* it still faces outwards */
    conus_atlas_destroy(atlas);
}

static void what_cannot_be_moved_stays(void **state)
{
    (void)state;
    conus_atlas *atlas = make_atlas();
    double far[16];
    double singular[16] = {[15] = 1};
    size_t notes = conus_atlas_note_count(atlas);
    mat4_identity(far);
    far[12] = 2e9;
    assert_fails(conus_atlas_move(atlas, far), CONUS_ERROR_DATA);
    assert_fails(conus_atlas_move(atlas, singular), CONUS_ERROR_DATA);
    assert_fails(conus_atlas_move(atlas, NULL), CONUS_ERROR_ARGUMENT);
    assert_fails(conus_atlas_transform(atlas, "no such file", NULL), CONUS_ERROR_IO);
    assert_fails(conus_atlas_transform(NULL, "x", NULL), CONUS_ERROR_ARGUMENT);
    assert_false(atlas->is_moved);
    assert_int_equal(conus_atlas_note_count(atlas), notes);
    assert_near(atlas->objects[0].volume_mm3, 64, 1e-12);
    conus_atlas_destroy(atlas);
}

struct trial {
    conus_atlas *atlas;
    const char *path;
};

static conus_status transform(void *data)
{
    const struct trial *attempt = data;
    conus_status status = conus_atlas_transform(attempt->atlas, attempt->path, NULL);
    assert_int_equal(attempt->atlas->is_moved, status == CONUS_OK);
    return status;
}

static conus_status transform_anew(void *path)
{
    struct trial attempt = {.atlas = make_atlas(), .path = path};
    conus_status status = transform(&attempt);
    conus_atlas_destroy(attempt.atlas);
    return status;
}

static void every_failing_allocation_is_survived(void **state)
{
    (void)state;
    char path[64];
    char *entry = make_spline(360, 0, spline_type, spline_grid);
    char *text = make_file(entry);
    for (int spline = 0; spline < 2; spline++) {
        struct trial attempt = {make_atlas(), path};
        write_file(path, spline ? text : itk_affine);
        test_every_allocation(transform, &attempt);
        assert_true(test_every_primitive(transform_anew, (void *)attempt.path) > 5);
        unlink(path);
        conus_atlas_destroy(attempt.atlas);
    }
    memory_free(text);
    memory_free(entry);
}

TEST_GROUP(transform)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(itk_turns),
        cmocka_unit_test(the_order_of_euler_angles_is_itks),
        cmocka_unit_test(splines_move_along_lps),
        cmocka_unit_test(splines_are_parts_of_composites),
        cmocka_unit_test(itk_moves_points_alike),
        cmocka_unit_test(no_prefix_is_a_spline),
        cmocka_unit_test(a_spline_moves_voxels_and_vertices),
        cmocka_unit_test(a_register_dat_is_between_two_images),
        cmocka_unit_test(an_atlas_goes_to_the_poses),
        cmocka_unit_test(a_wide_spline_has_the_atlas_s_grid),
        cmocka_unit_test(names_of_ants_have_a_kind),
        cmocka_unit_test(a_mirror_is_warned_of),
        cmocka_unit_test(what_cannot_be_moved_stays),
        cmocka_unit_test(every_failing_allocation_is_survived),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
