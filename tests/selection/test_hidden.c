/* SPDX-License-Identifier: BSD-3-Clause */
/* A hidden object is as if it had never been loaded, to the last bit: every answer equals that of a twin in which
 * hidden voxels are background, hidden pathways are volumes without objects, and hidden meshes are left out. */
#include "atlas/atlas.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "conus/own.h"
#include "mesh_scene.h"
#include "same_answer.h"
#include "scene.h"
#include "selection/selection.h"
#include "tables.h"
#include "test.h"
#include "test_gl.h"
#include "value_maps.h"

#include <string.h>
#include <sys/mman.h>

enum { SCENES = 40, DIM = 12, LIMIT = 64 };

/* A parcellation with a random tree, three soups of triangles in general, and two pathways. */
static conus_atlas *make_atlas(uint64_t seed)
{
    uint64_t state = seed;
    conus_atlas *atlas = scene_atlas(&state, DIM, 0);
    if (seed % 4) {
        mesh_scene_add_soups(atlas, &state);
    }
    conus_atlas *others = scene_atlas(&state, DIM, 2);
    for (size_t i = 0; i < others->volume_count; i++) {
        const struct volume *volume = &others->volumes[i];
        if (volume_has_values(volume)) {
            float *values = values_copy(volume);
            assert_ok(pathway_of_values(atlas, &volume->info, values, "tract"));
        }
    }
    conus_atlas_destroy(others);
    for (size_t i = 1; i < atlas->area_count; i++) {
        bool root = test_random(&state, 0, 1) < 0.4;
        atlas->objects[i].parent = root ? 0 : 1 + (uint32_t)test_random(&state, 0, (double)i);
    }
    assert_true(atlas->object_count < LIMIT);
    return atlas;
}

static void forget_voxels(struct volume *volume, const bool *hidden)
{
    for (size_t v = 0; v < volume->voxel_count; v++) {
        if (volume->objects16 && hidden[volume->objects16[v]]) {
            volume->objects16[v] = 0;
        }
    }
}

/* Hides objects by hand, in a way that must give the same answers. */
static void forget(conus_atlas *atlas, const bool *hidden)
{
    forget_voxels(&atlas->volumes[0], hidden);
    for (size_t i = 0; i < atlas->object_count; i++) {
        struct object_place *place = &atlas->places[i];
        if (hidden[i + 1] && atlas->objects[i].kind == CONUS_KIND_PATHWAY) {
            struct volume *volume = &atlas->volumes[place->index];
            volume->step_count = 0;
            volume->info.role = CONUS_ROLE_CONTEXT; /* a context that blocks nothing */
        } else if (hidden[i + 1] && place->is_mesh) {
            mesh_finish(&atlas->meshes[place->index]);
            *place = (struct object_place){.index = SIZE_MAX};
            atlas->objects[i].triangles = 0;
        }
        atlas->objects[i].volume_mm3 = hidden[i + 1] ? 0 : atlas->objects[i].volume_mm3;
    }
}

static void choose(bool hidden[LIMIT], size_t objects, uint64_t seed)
{
    uint64_t state = seed + 1000;
    double part = test_random(&state, 0.1, 0.9);
    hidden[0] = false;
    for (size_t number = 1; number <= objects; number++) {
        hidden[number] = test_random(&state, 0, 1) < part;
    }
}

static void assert_same_sweep(const conus_selector *a, const conus_selector *b, const conus_pose *pose)
{
    conus_table *mine = NULL;
    conus_table *other = NULL;
    assert_ok(conus_sweep(&mine, a, pose, degrees_from_radians(2)));
    assert_ok(conus_sweep(&other, b, pose, degrees_from_radians(2)));
    assert_int_equal(conus_table_rows(mine), conus_table_rows(other));
    assert_memory_equal(conus_table_objects(mine), conus_table_objects(other), conus_table_rows(mine) * 4);
    assert_same_tables(mine, other);
    conus_table_destroy(mine);
    conus_table_destroy(other);
}

static void assert_same_grid(const conus_selection *a, const conus_selection *b, conus_grid_content content,
                             uint32_t object)
{
    const conus_grid_options options = {.content = content, .object = object};
    conus_grid *mine = NULL;
    conus_grid *other = NULL;
    conus_status status = conus_selection_grid(&mine, a, &options);
    assert_int_equal(status, conus_selection_grid(&other, b, &options));
    if (!status) {
        conus_grid_view x = conus_grid_data(mine);
        conus_grid_view y = conus_grid_data(other);
        assert_int_equal(x.count, y.count);
        assert_memory_equal(x.data, y.data, x.count);
    }
    conus_grid_destroy(mine);
    conus_grid_destroy(other);
}

static void assert_same_ball(conus_selector *const selectors[2], const conus_atlas *atlas, uint64_t *state)
{
    conus_selection *balls[2] = {NULL};
    double centre[3];
    size_t voxel = (size_t)test_random(state, 0, (double)atlas->volumes[0].voxel_count);
    scene_voxel(centre, &atlas->volumes[0], voxel);
    for (int k = 0; k < 2; k++) {
        assert_ok(conus_select_ball(&balls[k], selectors[k], centre, 6));
    }
    assert_same_answer(balls[0], balls[1], 0);
    assert_same_grid(balls[0], balls[1], CONUS_GRID_MASK_OF_AREAS, 0);
    conus_selection_destroy(balls[0]);
    conus_selection_destroy(balls[1]);
}

/* Answers of a hidden atlas and of its twin; returns how many results they had. */
static size_t compare_one(conus_atlas *const atlases[2], const conus_selector_options *options, uint64_t *state)
{
    const conus_pose pose = scene_generic_pose(state, atlases[0]);
    conus_selector *selectors[2] = {NULL};
    conus_selection *answers[2] = {NULL};
    for (int k = 0; k < 2; k++) {
        assert_ok(conus_selector_create(&selectors[k], atlases[k], options));
        assert_ok(conus_select(&answers[k], selectors[k], &pose, degrees_from_radians(options->radius > 0 ? 0 : 0.8)));
    }
    size_t count = conus_selection_count(answers[0]);
    assert_same_answer(answers[0], answers[1], 0);
    assert_same_grid(answers[0], answers[1], CONUS_GRID_MASK_OF_AREAS, 0);
    assert_same_grid(answers[0], answers[1], CONUS_GRID_MAP_OF_LABELS, 0);
    if (!conus_atlas_is_hidden(atlases[0], atlases[0]->object_count)) {
        assert_same_grid(answers[0], answers[1], CONUS_GRID_MAP_OF_VALUES, (uint32_t)atlases[0]->object_count);
    }
    if (options->radius == 0 && options->aperture == CONUS_APERTURE_CIRCLE) {
        assert_same_sweep(selectors[0], selectors[1], &pose);
    }
    if (options->range[1] == 0) {
        assert_same_ball(selectors, atlases[0], state);
    }
    for (int k = 0; k < 2; k++) {
        conus_selection_destroy(answers[k]);
        conus_selector_destroy(selectors[k]);
    }
    return count;
}

static bool has_tree(const conus_atlas *atlas)
{
    for (size_t number = 1; number <= atlas->area_count; number++) {
        if (conus_atlas_depth(atlas, number) > 1) {
            return true;
        }
    }
    return false;
}

static void compare(conus_engine engine, size_t scenes)
{
    static const conus_selector_options variants[] = {
        {0},
        {.score = "nearness"},
        {.layers = CONUS_LAYERS_ALL, .score = "smallest"},
        {.layers = CONUS_LAYERS_ALL, .range = {2, 30}},
        {.range = {2, 30}, .aperture = CONUS_APERTURE_SQUARE},
        {.layers = CONUS_LAYERS_ALL, .radius = 5},
        {.layers = CONUS_LAYERS_ALL, .level = "1"},
        {.sampling = CONUS_SAMPLING_SLICES},
    };
    size_t results = 0;
    for (uint64_t seed = 1; seed <= scenes; seed++) {
        conus_atlas *atlases[2] = {make_atlas(seed), make_atlas(seed)};
        uint64_t state = seed;
        bool hidden[LIMIT];
        choose(hidden, atlases[0]->object_count, seed);
        assert_ok(conus_atlas_set_hidden(atlases[0], hidden));
        forget(atlases[1], hidden);
        for (size_t i = 0; i < sizeof variants / sizeof variants[0]; i++) {
            conus_selector_options options = variants[i];
            options.engine = engine;
            options.level = has_tree(atlases[0]) ? options.level : NULL;
            results += compare_one(atlases, &options, &state);
        }
        conus_atlas_destroy(atlases[0]);
        conus_atlas_destroy(atlases[1]);
    }
    assert_true(results > 10 * scenes);
}

static void hidden_is_as_if_never_loaded(void **state)
{
    (void)state;
    compare(CONUS_ENGINE_RAYS, SCENES);
}

static void hidden_is_as_if_never_loaded_with_gl(void **state)
{
    (void)state;
    struct gl_context *context = test_gl_context(NULL, NULL); /* or the test is skipped */
    gl_context_destroy(context);
    compare(CONUS_ENGINE_GL, 4);
}

static void bounds_are_those_of_what_is_shown(void **state)
{
    (void)state;
    for (uint64_t seed = 1; seed <= SCENES; seed++) {
        conus_atlas *atlases[2] = {make_atlas(seed), make_atlas(seed)};
        bool hidden[LIMIT];
        double low[2][3] = {{0}};
        double high[2][3] = {{0}};
        choose(hidden, atlases[0]->object_count, seed);
        assert_ok(conus_atlas_set_hidden(atlases[0], hidden));
        forget(atlases[1], hidden);
        assert_int_equal(conus_atlas_bounds(low[0], high[0], atlases[0]),
                         conus_atlas_bounds(low[1], high[1], atlases[1]));
        assert_same_doubles(low[0], low[1], 3);
        assert_same_doubles(high[0], high[1], 3);
        conus_atlas_destroy(atlases[0]);
        conus_atlas_destroy(atlases[1]);
    }
}

static void assert_answers_as(const conus_atlas *atlas, const conus_atlas *wanted, uint64_t seed)
{
    conus_atlas *const atlases[2] = {(conus_atlas *)atlas, (conus_atlas *)wanted};
    uint64_t state = seed;
    compare_one(atlases, &(conus_selector_options){.layers = CONUS_LAYERS_ALL}, &state);
}

static void what_is_shown_again_is_as_before(void **state)
{
    (void)state;
    for (uint64_t seed = 1; seed <= SCENES; seed++) {
        conus_atlas *atlas = make_atlas(seed);
        conus_atlas *plain = make_atlas(seed);
        bool hidden[LIMIT];
        for (uint64_t change = 0; change < 4; change++) {
            choose(hidden, atlas->object_count, seed + 100 * change);
            assert_ok(conus_atlas_set_hidden(atlas, hidden));
            for (size_t number = 0; number <= atlas->object_count; number++) {
                assert_int_equal(conus_atlas_is_hidden(atlas, number), hidden[number]);
            }
        }
        assert_ok(conus_atlas_set_hidden(atlas, NULL));
        assert_answers_as(atlas, plain, seed);
        for (size_t i = 0; i < plain->volume_count; i++) {
            for (size_t v = 0; v < plain->volumes[i].voxel_count; v++) {
                assert_int_equal(volume_object(&atlas->volumes[i], v), volume_object(&plain->volumes[i], v));
            }
        }
        conus_atlas_destroy(atlas);
        conus_atlas_destroy(plain);
    }
}

/* Memory that cannot be written to, like that of another process. */
static conus_atlas *pack_and_attach(void **memory, size_t *size, const conus_atlas *atlas)
{
    conus_atlas *attached = NULL;
    *size = conus_atlas_packed_size(atlas);
    *memory = mmap(NULL, *size, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    assert_ptr_not_equal(*memory, MAP_FAILED);
    assert_ok(conus_atlas_pack(*memory, *size, atlas));
    mprotect(*memory, *size, PROT_READ);
    assert_ok(conus_atlas_attach(&attached, *memory, *size));
    return attached;
}

static void a_packed_atlas_hides_the_same(void **state)
{
    (void)state;
    for (uint64_t seed = 1; seed <= SCENES / 2; seed++) {
        conus_atlas *atlas = make_atlas(seed);
        conus_atlas *plain = make_atlas(seed);
        bool hidden[LIMIT];
        void *memory;
        size_t size;
        choose(hidden, atlas->object_count, seed);
        assert_ok(conus_atlas_set_hidden(atlas, hidden));
        conus_atlas *attached = pack_and_attach(&memory, &size, atlas);
        assert_answers_as(attached, atlas, seed);
        assert_ok(conus_atlas_set_hidden(attached, NULL));
        assert_answers_as(attached, plain, seed);
        assert_ok(conus_atlas_set_hidden(attached, hidden));
        assert_answers_as(attached, atlas, seed);
        conus_atlas_destroy(attached);
        munmap(memory, size);
        conus_atlas_destroy(atlas);
        conus_atlas_destroy(plain);
    }
}

/* A threshold that is changed while its pathway is hidden counts when the pathway is shown again. */
static void a_hidden_pathway_keeps_its_threshold(void **state)
{
    (void)state;
    conus_atlas *atlas = make_atlas(3);
    conus_atlas *plain = make_atlas(3);
    size_t pathway = atlas->object_count;
    bool hidden[LIMIT] = {false};
    hidden[pathway] = true;
    assert_ok(conus_atlas_set_hidden(atlas, hidden));
    assert_ok(conus_atlas_set_threshold(atlas, pathway, 0.25));
    assert_ok(conus_atlas_set_threshold(plain, pathway, 0.25));
    assert_ok(conus_atlas_set_hidden(atlas, NULL));
    assert_answers_as(atlas, plain, 3);
    conus_atlas_destroy(atlas);
    conus_atlas_destroy(plain);
}

static void hemispheres_come_first(void **state)
{
    (void)state;
    conus_atlas *atlas = make_atlas(4);
    bool hidden[LIMIT] = {false, true};
    assert_ok(conus_atlas_set_hidden(atlas, hidden));
    assert_fails(conus_atlas_set_hemispheres(atlas, CONUS_HEMISPHERES_SPLIT), CONUS_ERROR_ARGUMENT);
    assert_non_null(strstr(conus_message(), "hidden"));
    conus_atlas_destroy(atlas);
}

static void the_centre_of_a_hidden_object_is_known(void **state)
{
    (void)state;
    for (uint64_t seed = 1; seed <= SCENES; seed++) {
        conus_atlas *atlas = make_atlas(seed);
        for (uint32_t number = 1; number <= atlas->object_count; number++) {
            double before[3] = {0};
            double after[3] = {0};
            bool hidden[LIMIT] = {false};
            hidden[number] = true;
            conus_status status = conus_atlas_centre(before, atlas, number);
            assert_ok(conus_atlas_set_hidden(atlas, hidden));
            assert_int_equal(conus_atlas_centre(after, atlas, number), status);
            for (int a = 0; a < 3; a++) {
                assert_near(after[a], before[a], 1e-9); /* the order of sums */
            }
            assert_ok(conus_atlas_set_hidden(atlas, NULL));
        }
        conus_atlas_destroy(atlas);
    }
}

/* 1 Cortex: 2 "V1, left" (V1), 3 V2; 4 Thalamus; pathway "tract": each a voxel of 8. */
static conus_atlas *named_atlas(void)
{
    static const char *const names[] = {"Cortex", "V1, left", "V2", "Thalamus"};
    static const char *const abbreviations[] = {"CTX", "V1", "", "TH"};
    const conus_volume_info grid = scene_plain_grid((size_t[]){8, 1, 1}, NULL);
    conus_atlas *atlas = scene_parcellation(&grid, (const uint32_t[8]){10, 11, 12, 13});
    for (size_t i = 0; i < 4; i++) {
        memory_free((char *)atlas->objects[i].name);
        memory_free((char *)atlas->objects[i].abbreviation);
        atlas->objects[i].name = memory_text(names[i], strlen(names[i]));
        atlas->objects[i].abbreviation = memory_text(abbreviations[i], strlen(abbreviations[i]));
    }
    atlas->objects[1].parent = atlas->objects[2].parent = 1;
    conus_volume_info scalar = grid;
    scalar.role = CONUS_ROLE_SCALAR;
    scalar.threshold = 0.5;
    float *values = memory_zeroed(8, sizeof *values);
    values[7] = 1;
    assert_ok(pathway_of_values(atlas, &scalar, values, "tract"));
    return atlas;
}

/* @p shown: a letter per object, "CVWTt" in their order, those that are left. */
static void assert_shows(const char *only, const char *hide, const char *shown, const char *listed, const char *words)
{
    conus_atlas *atlas = named_atlas();
    struct buffer list = {0};
    struct buffer sentence = {0};
    assert_ok(conus_atlas_show(atlas, only, hide));
    for (size_t number = 1; number <= 5; number++) {
        assert_int_equal(!conus_atlas_is_hidden(atlas, number), strchr(shown, "CVWTt"[number - 1]) != NULL);
    }
    atlas_list_hidden(&list, atlas);
    atlas_describe_shown(&sentence, atlas);
    assert_string_equal(list.data ? list.data : "", listed);
    assert_string_equal(sentence.data ? sentence.data : "", words);
    buffer_finish(&list);
    buffer_finish(&sentence);
    conus_atlas_destroy(atlas);
}

static void names_are_those_of_areas_nodes_and_pathways(void **state)
{
    (void)state;
    assert_shows(NULL, NULL, "CVWTt", "", "");
    assert_shows("thalamus", NULL, "T", "areas 10-12; pathways 1", "only Thalamus");
    assert_shows("CTX", NULL, "CVW", "areas 13; pathways 1", "all but Thalamus, tract");
    assert_shows("\"V1, left\",tract", NULL, "Vt", "areas 10,12-13", "only V1, left, tract");
    assert_shows("13", NULL, "T", "areas 10-12; pathways 1", "only Thalamus");
    assert_shows(NULL, "V1,TRACT", "CWT", "areas 11; pathways 1", "all but V1, left, tract");
    assert_shows(NULL, "10", "Tt", "areas 10-12", "only Thalamus, tract");
    assert_shows("CTX,TH", "12", "CVT", "areas 12; pathways 1", "all but V2, tract");
    assert_shows(NULL, "tract", "CVWT", "pathways 1", "all but tract");
}

static void assert_refused(const char *only, const char *hide, const char *message)
{
    conus_atlas *atlas = named_atlas();
    assert_fails(conus_atlas_show(atlas, only, hide), CONUS_ERROR_ARGUMENT);
    assert_string_equal(conus_message(), message);
    assert_false(atlas_has_hidden(atlas));
    conus_atlas_destroy(atlas);
}

static void what_cannot_be_shown_is_explained(void **state)
{
    (void)state;
    assert_refused("Thalamos", NULL,
                   "only: no area or pathway has the name, abbreviation or label \"Thalamos\"; did you mean "
                   "\"Thalamus\"?");
    assert_refused(NULL, "trakt",
                   "hide: no area or pathway has the name, abbreviation or label \"trakt\"; did you mean \"tract\"?");
    assert_refused("V2,", NULL, "only: an area is missing: names, abbreviations or labels, separated by commas");
    assert_refused("V2", "CTX", "everything is hidden: nothing is left that has voxels, triangles or streamlines");
}

/* An area that only the table names has no voxels to show. */
static void an_area_without_voxels_is_nothing_to_show(void **state)
{
    (void)state;
    conus_atlas *atlas = named_atlas();
    atlas->objects[3].voxels = 0;
    assert_fails(conus_atlas_show(atlas, "Thalamus", NULL), CONUS_ERROR_ARGUMENT);
    assert_ok(conus_atlas_show(atlas, "Thalamus,V2", NULL));
    conus_atlas_destroy(atlas);
}

/* Longer lists are cut: five areas of six are hidden, four are named. */
static void long_lists_are_cut_for_people(void **state)
{
    (void)state;
    struct buffer sentence = {0};
    const conus_volume_info grid = scene_plain_grid((size_t[]){12, 1, 1}, NULL);
    const uint32_t labels[12] = {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12};
    conus_atlas *atlas = scene_parcellation(&grid, labels);
    assert_ok(conus_atlas_show(atlas, NULL, "1,2,3,4,5,6"));
    atlas_describe_shown(&sentence, atlas);
    assert_string_equal(sentence.data, "all but 1, 2, 3, 4 and 2 more");
    buffer_finish(&sentence);
    conus_atlas_destroy(atlas);
}

/* A failing change leaves objects hidden as they were before. */
static conus_status change(void *data)
{
    conus_atlas *atlas = data;
    conus_status status = conus_atlas_show(atlas, "10,tract", "\"V1, left\"");
    if (status) {
        assert_int_equal(atlas->volumes[0].hidden_run_count, 1);
        for (size_t number = 1; number <= atlas->object_count; number++) {
            assert_int_equal(conus_atlas_is_hidden(atlas, number), number == 3);
        }
    }
    return status;
}

static void every_failing_allocation_is_survived(void **state)
{
    (void)state;
    conus_atlas *atlas = named_atlas();
    assert_ok(conus_atlas_show(atlas, NULL, "V2"));
    test_every_allocation(change, atlas);
    conus_atlas_destroy(atlas);
}

TEST_GROUP(hidden)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(hidden_is_as_if_never_loaded),
        cmocka_unit_test(hidden_is_as_if_never_loaded_with_gl),
        cmocka_unit_test(bounds_are_those_of_what_is_shown),
        cmocka_unit_test(what_is_shown_again_is_as_before),
        cmocka_unit_test(a_packed_atlas_hides_the_same),
        cmocka_unit_test(a_hidden_pathway_keeps_its_threshold),
        cmocka_unit_test(hemispheres_come_first),
        cmocka_unit_test(the_centre_of_a_hidden_object_is_known),
        cmocka_unit_test(names_are_those_of_areas_nodes_and_pathways),
        cmocka_unit_test(what_cannot_be_shown_is_explained),
        cmocka_unit_test(an_area_without_voxels_is_nothing_to_show),
        cmocka_unit_test(long_lists_are_cut_for_people),
        cmocka_unit_test(every_failing_allocation_is_survived),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
