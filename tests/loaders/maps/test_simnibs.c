/* SPDX-License-Identifier: BSD-3-Clause */
/* Meshes of SimNIBS as conus-hdf5 gives them: volumes in closed form, and files with one wrong value each. */
#include "loaders/maps/maps.h"

#include "atlas/volume.h"
#include "base/memory.h"
#include "builders/hdf5_builder.h"
#include "conus/own.h"
#include "test.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Changes to the plain file, a cube with edges of 6 mm; 0 or NULL leaves a value as it is. */
struct bent {
    const char *missing; /* an object that is left out */
    const char *twice;   /* a field that another mesh has */
    const char *field;   /* name of a vector field, in place of magnE */
    int32_t corner;      /* in place of a corner of tetrahedron 2 */
    int32_t types;       /* all elements are of this one */
    double node, value;  /* x of node 1; value of tetrahedron 2 */
    bool few_tags, pairs, real_corners, wide_nodes;
};

enum { ELEMENTS = 4 };

static void put(struct hdf5_builder *builder, const struct bent *bent, const char *name, enum hdf5_class class,
                uint32_t size, const uint64_t dims[2], const void *data)
{
    size_t rank = dims[1] ? 2 : 1;
    if (!bent->missing || strcmp(bent->missing, name) != 0) {
        hdf5_frame(builder, (struct built_value){.kind = HDF5_FRAME_OBJECT,
                                                 .class = class,
                                                 .size = size,
                                                 .rank = (uint32_t)rank,
                                                 .dims = {dims[0], dims[1]},
                                                 .address = builder->frames,
                                                 .name = name,
                                                 .data = data,
                                                 .data_size = size * dims[0] * (dims[1] ? dims[1] : 1)});
    }
}

/* A triangle, tetrahedra of 36 and 72 mm³, the latter inside out, and a flat one. */
static void build(struct hdf5_builder *builder, const struct bent *bent)
{
    const double nodes[6][3] = {{bent->node, 0, 0}, {6, 0, 0}, {0, 6, 0}, {0, 0, 6}, {6, 6, 6}, {2, 2, 2}};
    const int32_t types[] = {bent->types ? bent->types : 2, bent->types ? bent->types : 4,
                             bent->types ? bent->types : 4, bent->types ? bent->types : 4};
    const int32_t tags[] = {1005, 2, 1, 2};
    const int32_t corners[][4] = {
        {1, 2, 3, -1}, {1, 2, 3, 4}, {bent->corner ? bent->corner : 5, 2, 3, 4}, {2, 3, 4, 6}};
    const float lengths[] = {9, 1, bent->value != 0 ? (float)bent->value : 2, 3};
    const double vectors[][3] = {{9, 9, 9}, {2, 3, 6}, {1, 4, 8}, {0, 0, NAN}};
    hdf5_begin(builder);
    put(builder, bent, "/mesh_roi/nodes/node_coord", HDF5_FLOAT, 8,
        (const uint64_t[]){bent->wide_nodes ? 3 : 6, bent->wide_nodes ? 6 : 3}, nodes);
    put(builder, bent, "/mesh_roi/elm/elm_type", HDF5_SIGNED, 4, (const uint64_t[]){ELEMENTS, 0}, types);
    put(builder, bent, "/mesh_roi/elm/tag1", HDF5_SIGNED, 4, (const uint64_t[]){bent->few_tags ? 3 : ELEMENTS, 0},
        tags);
    put(builder, bent, "/mesh_roi/elm/node_number_list", bent->real_corners ? HDF5_FLOAT : HDF5_SIGNED, 4,
        (const uint64_t[]){ELEMENTS, 4}, corners);
    if (bent->field) {
        put(builder, bent, bent->field, HDF5_FLOAT, 8, (const uint64_t[]){ELEMENTS, bent->pairs ? 2 : 3}, vectors);
    } else {
        put(builder, bent, "/mesh_roi/elmdata/magnE", HDF5_FLOAT, 4, (const uint64_t[]){ELEMENTS, 0}, lengths);
    }
    if (bent->twice) {
        static const char *const parts[] = {"/b/nodes/node_coord", "/b/elm/elm_type", "/b/elm/node_number_list"};
        for (size_t i = 0; i < 3; i++) {
            put(builder, bent, parts[i], HDF5_SIGNED, 4, (const uint64_t[]){1, 0}, types);
        }
        put(builder, bent, bent->twice, HDF5_SIGNED, 4, (const uint64_t[]){1, 0}, types);
    }
    hdf5_end(builder);
}

/* The region is asked of the mesh in the memory of `job`, and the arrays are given to it. */
static conus_status make_of(conus_roi **out, const struct hdf5_builder *builder, const char *keys,
                            const conus_volume_info *info)
{
    struct job job = {0};
    struct source_keys named;
    const struct hdf5 *hdf5 = hdf5_of_stream(&job, (struct text){builder->bytes.data, builder->bytes.size});
    source_keys_read(&job, &named, keys, KEYS_VOLUME);
    if (job_ok(&job)) {
        assert_true(simnibs_is(hdf5));
        struct roi_mesh mesh = simnibs_find(&job, hdf5, &named);
        mesh.nodes = job_give(&job, mesh.nodes, mesh.node_count * sizeof *mesh.nodes);
        mesh.tetrahedra = job_give(&job, mesh.tetrahedra, mesh.count * sizeof *mesh.tetrahedra);
        if (!JOB_CALL(&job, roi_create_mesh(out, info, &mesh))) {
            memory_free(mesh.nodes);
            memory_free(mesh.tetrahedra);
        }
    }
    return job_close(&job, NULL, NULL);
}

static conus_status make_region(conus_roi **out, const struct bent *bent, const char *keys, double threshold)
{
    struct hdf5_builder builder;
    const conus_volume_info info = {.path = "mesh.hdf5", .threshold = threshold};
    build(&builder, bent);
    conus_status status = make_of(out, &builder, keys, &info);
    buffer_finish(&builder.bytes);
    return status;
}

/* A corner of the cube has 6³ / 6 mm³, the tetrahedron of every other corner 6³ / 3. The flat one has none. */
static void tetrahedra_and_their_values(void **state)
{
    (void)state;
    static const struct {
        struct bent bent;
        const char *keys;
        double threshold;
        uint64_t count;
        double mm3, largest;
    } cases[] = {
        {.threshold = 0.5, .count = 2, .mm3 = 108, .largest = 3},
        {.threshold = 1.5, .count = 1, .mm3 = 72, .largest = 3},
        {.threshold = 0.5, .keys = "mesh.hdf5,tissue=7:2", .count = 1, .mm3 = 36, .largest = 3},
        {.threshold = -1, .bent = {.value = -2}, .count = 1, .mm3 = 72, .largest = 3},
        {.threshold = 0.5, .bent = {.value = NAN}, .count = 1, .mm3 = 36, .largest = 3},
        {.threshold = 0.5, .bent = {.value = -INFINITY}, .count = 1, .mm3 = 36, .largest = 3},
        {.bent = {.field = "/mesh_roi/elmdata/E"}, .threshold = 7, .count = 2, .mm3 = 108, .largest = 9},
        {.bent = {.field = "/mesh_roi/elmdata/E"}, .threshold = 7.5, .count = 1, .mm3 = 72, .largest = 9},
        {.bent = {.field = "/mesh_roi/elmdata/J"},
         .keys = "mesh.hdf5,field=J",
         .threshold = 7.5,
         .count = 1,
         .mm3 = 72,
         .largest = 9},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        conus_roi *roi = NULL;
        assert_ok(make_region(&roi, &cases[i].bent, cases[i].keys ? cases[i].keys : "mesh.hdf5", cases[i].threshold));
        assert_int_equal(roi->voxels, cases[i].count);
        assert_near(roi->mm3, cases[i].mm3, 1e-12);
        assert_near(conus_roi_volume(roi)->maximum, cases[i].largest, 0);
        conus_roi_destroy(roi);
    }
}

static void what_is_refused(void **state)
{
    (void)state;
    static const struct {
        struct bent bent;
        const char *keys;
        double threshold;
        conus_status status;
        const char *part;
    } cases[] = {
        {{.missing = "/mesh_roi/elm/tag1"}, NULL, 1, CONUS_ERROR_DATA, "tag1: a whole number for each of 4 elements"},
        {{.missing = "/mesh_roi/elmdata/magnE"},
         NULL,
         1,
         CONUS_ERROR_DATA,
         "elmdata: a mesh of SimNIBS without fields"},
        {{.field = "/mesh_roi/elmdata/J"},
         NULL,
         1,
         CONUS_ERROR_ARGUMENT,
         "field: no magnE, normE or E of elements "
         "(elmdata); there are J"},
        {{0}, "mesh.hdf5,field=v", 1, CONUS_ERROR_ARGUMENT, "field: no v of elements (elmdata); there are magnE"},
        {{.twice = "/b/elmdata/E"},
         NULL,
         1,
         CONUS_ERROR_DATA,
         "field: two meshes have one, /b/elmdata/E and /mesh_roi/elmdata/magnE"},
        {{.field = "/mesh_roi/elmdata/E", .pairs = true}, NULL, 1, CONUS_ERROR_DATA, "E: one or three numbers"},
        {{.wide_nodes = true}, NULL, 1, CONUS_ERROR_DATA, "node_coord: three numbers for each node"},
        {{.few_tags = true}, NULL, 1, CONUS_ERROR_DATA, "tag1: a whole number for each of 4 elements"},
        {{.real_corners = true}, NULL, 1, CONUS_ERROR_DATA, "node_number_list: four whole numbers"},
        {{.corner = 7}, NULL, 1, CONUS_ERROR_DATA, "node_number_list: element 3: found node 7, allowed are 1 to 6"},
        {{.corner = -1}, NULL, 1, CONUS_ERROR_DATA, "element 3: found node -1, allowed are 1 to 6"},
        {{.node = NAN}, NULL, 1, CONUS_ERROR_DATA, "node_coord: node 1: found nan"},
        {{.node = 10001}, NULL, 1, CONUS_ERROR_DATA, "node_coord: node 1: found 10001"},
        {{.types = 2}, NULL, 1, CONUS_ERROR_DATA, "elm_type: no tetrahedra (4)"},
        {{0},
         "mesh.hdf5,tissue=1005",
         1,
         CONUS_ERROR_ARGUMENT,
         "tissue: no tetrahedron has it "
         "(tag1); there are 2, 1"},
        {{0},
         NULL,
         0,
         CONUS_ERROR_ARGUMENT,
         "mesh.hdf5: has values from 1 to 3 and is no mask: a threshold is needed, "
         "from which on a tetrahedron"},
        {{0}, NULL, 4, CONUS_ERROR_ARGUMENT, "mesh.hdf5: threshold 4, but its values are from 1 to 3"},
        {{0}, NULL, NAN, CONUS_ERROR_ARGUMENT, "mesh.hdf5: threshold nan"},
        {{0}, NULL, 2.5, CONUS_ERROR_ARGUMENT, "mesh.hdf5: threshold 2.5"}, /* only the flat one remains */
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        conus_roi *roi = NULL;
        test_status(make_region(&roi, &cases[i].bent, cases[i].keys ? cases[i].keys : "mesh.hdf5", cases[i].threshold),
                    cases[i].status, cases[i].part, __FILE__, __LINE__);
        if (!strstr(conus_message(), cases[i].part)) {
            fail_msg("case %zu: \"%s\" does not say \"%s\"", i, conus_message(), cases[i].part);
        }
        assert_null(roi);
    }
}

/* Without elements the file is not a mesh, but a file of another kind. */
static void what_is_no_mesh(void **state)
{
    (void)state;
    static const char *const parts[] = {"/mesh_roi/nodes/node_coord", "/mesh_roi/elm/elm_type",
                                        "/mesh_roi/elm/node_number_list"};
    for (size_t i = 0; i < 3; i++) {
        struct hdf5_builder builder;
        struct job job = {0};
        build(&builder, &(struct bent){.missing = parts[i]});
        const struct hdf5 *hdf5 = hdf5_of_stream(&job, (struct text){builder.bytes.data, builder.bytes.size});
        assert_true(job_ok(&job));
        assert_false(simnibs_is(hdf5));
        job_end(&job);
        buffer_finish(&builder.bytes);
    }
}

static conus_status make_of_built(void *builder)
{
    conus_roi *roi = NULL;
    conus_status status = make_of(&roi, builder, "mesh", &(conus_volume_info){.path = "mesh", .threshold = 1});
    conus_roi_destroy(roi);
    return status;
}

static void every_failing_allocation_is_clean(void **state)
{
    (void)state;
    struct hdf5_builder builder;
    build(&builder, &(struct bent){0});
    test_every_allocation(make_of_built, &builder);
    assert_true(test_every_primitive(make_of_built, &builder) > 5);
    buffer_finish(&builder.bytes);
}

TEST_GROUP(simnibs)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(tetrahedra_and_their_values),
        cmocka_unit_test(what_is_refused),
        cmocka_unit_test(what_is_no_mesh),
        cmocka_unit_test(every_failing_allocation_is_clean),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
