/* SPDX-License-Identifier: BSD-3-Clause */
/* Every function of the headers that answers with a table, with each allocation failing in turn: it hands out nothing,
 * and what was asked answers afterwards as a fresh one does, which never failed. */
#include "conus/own.h"
#include "tables.h"
#include "test.h"

#include <glob.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

enum { X = 40, Y = 30, Z = 30, TRIALS = 5 };

struct scene {
    uint8_t labels[Z][Y][X]; /* cell i is [i, i + 1] mm */
    conus_atlas *atlas;
    conus_selector *selector, *posterior;
    conus_roi *roi;
    conus_weight *weight;
    conus_plan *plan;
    conus_together *together;
    conus_probe *probe;
    conus_trial trials[TRIALS];
};

/* Needles from the left into the first box. */
static conus_status open_candidates(conus_pose_stream **out, void *user)
{
    static const double entries[][3] = {{-5, 12, 12}, {-5, 14, 13}, {-5, 13, 15}};
    static const double targets[][3] = {{12, 13, 13}, {15, 14, 12}};
    (void)user;
    return conus_candidates_open(
        out, &(conus_candidates){
                 .entries = entries[0], .entry_count = 3, .targets = targets[0], .target_count = 2, .to_target = true});
}

static void make_atlas(struct scene *scene)
{
    static const float line[][3] = {{12, 12, 12}, {6, 6, 6}, {12, 13, 12}, {30, 12, 12}};
    static const uint64_t first[] = {0, 2, 4};
    conus_voxels voxels = CONUS_VOXELS_INIT;
    conus_polylines lines = CONUS_POLYLINES_INIT;
    const conus_label labels[] = {{.number = 1, .name = "first"}, {.number = 2, .name = "second"}};
    for (int k = 0; k < Z; k++) {
        for (int j = 0; j < Y; j++) {
            for (int i = 0; i < X; i++) {
                bool in_first = i >= 10 && i < 20 && j >= 10 && j < 16 && k >= 10 && k < 16;
                bool in_second = i >= 4 && i < 8 && j >= 4 && j < 8 && k >= 4 && k < 8;
                scene->labels[k][j][i] = in_first ? 1 : in_second ? 2 : 0;
            }
        }
    }
    voxels.data = scene->labels;
    voxels.type = CONUS_SCALAR_UINT8;
    memcpy(voxels.dim, (size_t[]){X, Y, Z}, sizeof voxels.dim);
    memcpy(voxels.stride, (ptrdiff_t[]){1, X, X * Y}, sizeof voxels.stride);
    memcpy(voxels.world_from_voxel, (double[]){1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0.5, 0.5, 0.5, 1},
           sizeof voxels.world_from_voxel);
    assert_ok(conus_atlas_create(&scene->atlas, &voxels, labels, 2, NULL));
    voxels.world_from_voxel[1] = 0.3; /* oblique: polyhedra need memory */
    assert_ok(conus_roi_create(&scene->roi, &voxels, &(conus_roi_options){.threshold = 1}));
    lines.points = line;
    lines.type = CONUS_SCALAR_FLOAT32;
    lines.point_count = 4;
    lines.first = first;
    lines.streamline_count = 2;
    assert_ok(conus_atlas_add_polylines(scene->atlas, &lines, NULL));
}

static void make_plans(struct scene *scene)
{
    const conus_constraint reach = {.kind = CONUS_CONSTRAINT_REACH, .names = "first"};
    const conus_plan_options options = {.threads = 1, .entries = 3, .targets = 2};
    conus_pose_stream *stream = NULL;
    assert_ok(conus_plan_create(&scene->plan, scene->selector, &reach, 1, &options));
    assert_ok(open_candidates(&stream, NULL));
    assert_ok(conus_plan_run(scene->plan, stream, UINT64_MAX));
    conus_pose_stream_destroy(stream);
    const conus_question questions[] = {
        {.needles = "A,B",
         .selector = scene->selector,
         .constraints = &reach,
         .constraint_count = 1,
         .open = open_candidates},
    };
    assert_ok(conus_plan_together(&scene->together, questions, 1, &(conus_together_options){.between = 0.1}));
}

/* Devices that look down -z from above the first box, at points beside the axis. */
static void make_trials(struct scene *scene)
{
    static const double off[TRIALS][2] = {{1, 0}, {3, 0}, {2, 1}, {2, -1}, {2, 0}};
    for (size_t i = 0; i < TRIALS; i++) {
        scene->trials[i] = (conus_trial){.pose = {{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 15, 13, 60, 1}},
                                         .aim = {15 + off[i][0], 13 + off[i][1], 13},
                                         .angle = 10,
                                         .range = {NAN, NAN},
                                         .meant = 1};
    }
}

static void make_scene(struct scene *scene)
{
    static const char contacts[] =
        "{\"specification\":\"probeinterface\",\"probes\":[{\"ndim\":2,\"si_units\":\"um\",\"contact_positions\":"
        "[[0,10],[0,20]],\"probe_planar_contour\":[[0,0],[1,90],[-1,90]]}]}";
    *scene = (struct scene){0};
    make_atlas(scene);
    assert_ok(conus_selector_create(&scene->selector, scene->atlas, &(conus_selector_options){.resolution = 16}));
    assert_ok(conus_weight_create(&scene->weight, "gauss=1"));
    assert_ok(
        conus_selector_create(&scene->posterior, scene->atlas,
                              &(conus_selector_options){.weight = scene->weight, .prior = "equal", .resolution = 16}));
    make_plans(scene);
    make_trials(scene);
    test_folder("studies");
    assert_ok(conus_write_file(test_in("probe.json"), contacts, sizeof contacts - 1));
    assert_ok(conus_probe_load(&scene->probe, test_in("probe.json"), NULL));
}

static void end_scene(struct scene *scene)
{
    conus_probe_destroy(scene->probe);
    conus_together_destroy(scene->together);
    conus_plan_destroy(scene->plan);
    conus_selector_destroy(scene->posterior);
    conus_weight_destroy(scene->weight);
    conus_selector_destroy(scene->selector);
    conus_roi_destroy(scene->roi);
    conus_atlas_destroy(scene->atlas);
}

typedef conus_status study(conus_table **out, struct scene *scene);

#define STUDY(function, ...)                                                                                           \
    static conus_status ask_##function(conus_table **out, struct scene *scene)                                         \
    {                                                                                                                  \
        (void)scene;                                                                                                   \
        return conus_##function(out, __VA_ARGS__);                                                                     \
    }
static const conus_pose from_above = {{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 15, 13, 60, 1}};
STUDY(sweep, scene->selector, &from_above, 60)
STUDY(jitter, scene->selector, &from_above, 20, &(conus_jitter_options){.shift = 1, .samples = 16})
STUDY(segments, scene->selector, &from_above)
STUDY(clearance, scene->selector, &from_above, INFINITY)
STUDY(overlap, scene->selector, scene->roi)
STUDY(clusters, scene->selector, scene->roi)
STUDY(connectivity, scene->selector, NULL, 0, true)
STUDY(atlas_list, scene->atlas, "objects")
STUDY(list_installed, NULL, NULL)
STUDY(list_choices, "scores")
STUDY(plan_list, scene->plan, "entries")
STUDY(together_pairs, scene->together)
STUDY(probe_table, scene->probe)
STUDY(calibrate, scene->trials, TRIALS)
STUDY(reliability, scene->posterior, scene->trials, TRIALS, NULL, NULL)
STUDY(positions, (const char *const[]){"C3", "T4"}, 2, NULL)

#define ROW(function)                                                                                                  \
    {                                                                                                                  \
        "conus_" #function, ask_##function                                                                             \
    }
static const struct {
    const char *name;
    study *ask;
} studies[] = {
    ROW(sweep),        ROW(jitter),     ROW(segments),       ROW(clearance),    ROW(overlap),   ROW(clusters),
    ROW(connectivity), ROW(atlas_list), ROW(list_installed), ROW(list_choices), ROW(plan_list), ROW(together_pairs),
    ROW(probe_table),  ROW(calibrate),  ROW(reliability),    ROW(positions),
};

static bool is_listed(const char *name)
{
    size_t row = 0;
    while (row < sizeof studies / sizeof *studies && strcmp(studies[row].name, name) != 0) {
        row++;
    }
    return row < sizeof studies / sizeof *studies;
}

/* A new function that gives a table fails here until it is in the list above. */
static void the_list_has_all_of_the_headers(void **state)
{
    (void)state;
    size_t count = 0;
    char line[256];
    glob_t headers;
    assert_int_equal(glob(CONUS_SOURCE_DIR "/include/conus/*.h", 0, NULL, &headers), 0);
    for (size_t i = 0; i < headers.gl_pathc; i++) {
        FILE *file = fopen(headers.gl_pathv[i], "r");
        assert_non_null(file);
        while (fgets(line, sizeof line, file)) {
            char *end = strstr(line, "(conus_table **out");
            const char *name = strstr(line, " conus_status ");
            if (end && name) {
                *end = '\0';
                name += strlen(" conus_status ");
                count++;
                if (!is_listed(name)) {
                    fail_msg("%s() is not in the list", name);
                }
            }
        }
        fclose(file);
    }
    globfree(&headers);
    assert_int_equal(count, sizeof studies / sizeof *studies);
}

struct asked {
    study *ask;
    struct scene *scene;
    const conus_table *wanted;
};

static conus_status ask_once(void *data)
{
    const struct asked *asked = data;
    conus_table *const untouched = (conus_table *)data;
    conus_table *out = untouched;
    conus_status status = asked->ask(&out, asked->scene);
    if (status) {
        assert_ptr_equal(out, untouched);
        return status;
    }
    assert_same_tables(out, asked->wanted);
    conus_table_destroy(out);
    return CONUS_OK;
}

static void every_failing_allocation_changes_nothing(void **state)
{
    (void)state;
    static struct scene fresh, poor;
    make_scene(&fresh);
    make_scene(&poor);
    for (size_t i = 0; i < sizeof studies / sizeof *studies; i++) {
        conus_table *wanted = NULL;
        assert_ok(studies[i].ask(&wanted, &fresh));
        test_every_allocation(ask_once, &(struct asked){studies[i].ask, &poor, wanted});
        conus_table_destroy(wanted);
    }
    end_scene(&fresh);
    end_scene(&poor);
}

/* As after a call that failed, in programs that go on to the next. */
static void of_nothing_there_is_nothing(void **state)
{
    (void)state;
    assert_null(conus_sites_points(NULL));
    assert_null(conus_sites_normals(NULL));
    assert_true(conus_sites_source(NULL, 0) == UINT64_MAX);
    assert_true(conus_plan_left(NULL, 0) == 0);
    assert_null(conus_together_combination(NULL, 0));
    assert_null(conus_together_needle(NULL, 0));
    assert_null(conus_together_conflict(NULL));
    assert_null(conus_table_column(NULL, 0));
    assert_null(conus_table_part(NULL, "pairs"));
}

TEST_GROUP(studies)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_list_has_all_of_the_headers),
        cmocka_unit_test(every_failing_allocation_changes_nothing),
        cmocka_unit_test(of_nothing_there_is_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
