/* SPDX-License-Identifier: BSD-3-Clause */
/* A loaded atlas is found in the cache the next time, but only while everything that it depends on is unchanged. */
#include "atlas/bundles.h"
#include "base/files/file.h"
#include "base/memory.h"
#include "builders/cache_builder.h"
#include "cache/atlas_cache.h"
#include "conus/cache.h"
#include "loaders/scene/load.h"
#include "loaders/scene/load_streamlines.h"
#include "mesh_scene.h"
#include "test.h"
#include "tract_scene.h"

#include <fcntl.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static void keep(const char *path)
{
    conus_atlas *atlas = load_and_keep_rested(path, NULL);
    assert_non_null(atlas);
    assert_non_null(atlas->mapped);
    conus_atlas_destroy(atlas);
}

static void a_loaded_atlas_is_mapped_the_next_time(void **state)
{
    (void)state;
    const char *path = cached_atlas("one.nii", 5);
    assert_false(is_in_cache(path));
    keep(path);
    assert_true(is_in_cache(path));
    assert_cached_is_loaded(path);
}

static void the_library_asks_for_no_cache_by_itself(void **state)
{
    (void)state;
    conus_atlas *atlas = NULL;
    const char *path = cached_atlas("default.nii", 5);
    keep(path);
    assert_ok(conus_atlas_load(&atlas, path, NULL));
    assert_null(atlas->mapped);
    conus_atlas_destroy(atlas);
    const conus_load_options options = {.cache = true};
    assert_ok(conus_atlas_load(&atlas, path, &options));
    assert_non_null(atlas->mapped);
    conus_atlas_destroy(atlas);
}

/* A changed file has the same size and the old time of its last change, but setting that time changes another one. */
static void a_file_that_changed_is_read_again(void **state)
{
    (void)state;
    struct stat before;
    const char *path = cached_atlas("changed.nii", 5);
    keep(path);
    assert_int_equal(stat(path, &before), 0);
    assert_ptr_equal(strrchr(cached_atlas("changed.nii", 6), '.') ? path : NULL, path);
    const struct timespec times[2] = {before.st_atim, before.st_mtim};
    assert_int_equal(utimensat(AT_FDCWD, path, times, 0), 0);
    assert_false(is_in_cache(path));
    keep(path);
    assert_true(is_in_cache(path));
    conus_atlas *atlas = find_in_cache(path, NULL, UINT64_MAX);
    assert_string_equal(conus_atlas_object(atlas, 3)->name, "Five"); /* without voxels */
    assert_string_equal(conus_atlas_object(atlas, 4)->name, "Six");
    assert_int_equal(conus_atlas_object(atlas, 4)->voxels, 1);
    conus_atlas_destroy(atlas);
}

/* A new table counts if it has priority over the one that was read, or belongs beside it. */
static void a_file_that_appears_beside_it_counts(void **state)
{
    (void)state;
    char beside[8192];
    const char *path = cached_atlas("beside.nii", 5);
    keep(path);
    snprintf(beside, sizeof beside, "%.*s.txt", (int)(strlen(path) - strlen(".nii")), path);
    assert_int_equal(unlink(beside), 0);
    assert_false(is_in_cache(path));
    keep(path);
    assert_true(is_in_cache(path));
    assert_ok(file_write_soon(beside, "1 Uno 1\n", 8));
    assert_false(is_in_cache(path));
    assert_int_equal(unlink(beside), 0);
}

static void add_to_folder(char out[8192], const char *path, const char *name)
{
    snprintf(out, 8192, "%.*s/%s", (int)(strrchr(path, '/') - path), path, name);
    assert_ok(file_write_soon(out, "1 Uno 1\n", 8));
}

/* Without a table beside it the whole folder is searched: for tables, and for volumes to which they may belong. */
static void only_searched_names_in_the_folder_count(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        bool counts;
    } files[] = {{"notes.md", false},          {"searched.pdf", false}, {"searched_nii", false},  {"txt", false},
                 {"other_searched.tsv", true}, {"LABELS.CSV", true},    {"another.nii", true},    {"b.MGZ", true},
                 {"b_dseg.tsv", true},         {"atlas.xml", true},     {"structures.json", true}};
    char file[8192];
    const char *path = cached_atlas("searched.nii", 5);
    snprintf(file, sizeof file, "%.*s.txt", (int)(strlen(path) - strlen(".nii")), path);
    assert_int_equal(unlink(file), 0);
    keep(path);
    for (size_t i = 0; i < sizeof files / sizeof files[0]; i++) {
        assert_true(is_in_cache(path));
        add_to_folder(file, path, files[i].name);
        assert_int_equal(is_in_cache(path), !files[i].counts);
        assert_int_equal(unlink(file), 0);
    }
    assert_true(is_in_cache(path));
}

static void options_have_entries_of_their_own(void **state)
{
    (void)state;
    const char *path = cached_atlas("options.nii", 5);
    char table[8192];
    snprintf(table, sizeof table, "%.*s.txt", (int)(strlen(path) - strlen(".nii")), path);
    const conus_load_options all[] = {{.cache = true},
                                      {.cache = true, .labels = table},
                                      {.cache = true, .max_memory = 1 << 20},
                                      {.cache = true, .labels_anyway = true}};
    for (size_t i = 0; i < sizeof all / sizeof all[0]; i++) {
        assert_null(find_in_cache(path, &all[i], UINT64_MAX));
        conus_atlas_destroy(load_and_keep_rested(path, &all[i]));
        conus_atlas *found = find_in_cache(path, &all[i], UINT64_MAX);
        assert_non_null(found);
        conus_atlas_destroy(found);
    }
    /* All entries exist now: a different value of one option still finds none of them. */
    const conus_load_options others[] = {{.cache = true, .labels = path},
                                         {.cache = true, .max_memory = 1 << 21},
                                         {.cache = true, .probability = 0.5},
                                         {.cache = true, .probability = 0.2},
                                         {.cache = true, .max_memory = 1 << 20, .labels_anyway = true}};
    for (size_t i = 0; i < sizeof others / sizeof others[0]; i++) {
        assert_null(find_in_cache(path, &others[i], UINT64_MAX));
    }
}

enum stranger { NONE, VOLUME, SOURCE, TRACTOGRAM, SURFACE, STRANGERS };

/* Adds a part that came from a file whose reading was not recorded, or that packing leaves out. */
static void add_stranger(conus_atlas *atlas, enum stranger stranger)
{
    static const char *const unseen = "/nowhere/unseen.trk";
    struct mesh box = mesh_scene_box((const double[]){0, 0, 0}, (const double[]){1, 1, 1});
    struct tractogram line = tract_of(unseen, (const float[]){0, 0, 0, 1, 1, 1}, (const uint64_t[]){0, 2}, 1, 0.5);
    if (stranger == VOLUME) {
        memory_free(atlas->volumes[0].path);
        atlas->volumes[0].path = memory_text(unseen, strlen(unseen));
        atlas->volumes[0].info.path = atlas->volumes[0].path;
    } else if (stranger == SOURCE) {
        atlas->volumes[0].source = memory_zeroed(1, sizeof *atlas->volumes[0].source);
        atlas->volumes[0].source->is_borrowed = true;
    }
    if (stranger == TRACTOGRAM) {
        assert_ok(atlas_add_tractogram(atlas, &line, "line"));
    } else {
        tractogram_finish(&line);
    }
    if (stranger == SURFACE) {
        mesh_scene_add(atlas, &box);
        atlas->meshes[atlas->mesh_count - 1].path = memory_text(unseen, strlen(unseen));
    } else {
        mesh_finish(&box);
    }
}

/* An atlas is kept only if all of it is known to come from the files that were read. Otherwise it could be found again
 * after another file has changed. */
static void parts_from_unrecorded_files_are_not_kept(void **state)
{
    (void)state;
    const conus_load_options options = {.cache = true};
    const char *path = cached_atlas("strangers.nii", 5);
    for (int stranger = STRANGERS - 1; stranger >= NONE; stranger--) {
        struct atlas_cache cache;
        conus_atlas *atlas = NULL;
        atlas_cache_init(&cache, path, "atlas", &options);
        atlas_cache_begin_reading(&cache);
        assert_ok(atlas_load_files(&atlas, path, &cache.options));
        atlas_cache_end_reading(&cache);
        cache.trace.begun.tv_sec += 3600; /* the files have been at rest */
        add_stranger(atlas, (enum stranger)stranger);
        atlas_cache_keep(&cache, &atlas);
        assert_int_equal(is_in_cache(path), stranger == NONE);
        atlas_cache_finish(&cache);
        conus_atlas_destroy(atlas);
    }
}

/* A manifest of the atlas, with the rest of its keys; path in a static buffer. */
static const char *write_manifest(const char *volume, const char *rest)
{
    static char path[8192];
    char text[8192];
    snprintf(path, sizeof path, "%.*s.json", (int)(strlen(volume) - strlen(".nii")), volume);
    int size = snprintf(text, sizeof text, "{\"conus_atlas\": 1, \"parcellation\": {\"file\": \"%s\"}%s}",
                        strrchr(volume, '/') + 1, rest);
    assert_ok(file_write_soon(path, text, (size_t)size));
    return path;
}

/* Packing leaves out surfaces around the areas: a kept atlas would lose them. */
static void surfaces_around_the_areas_are_not_kept(void **state)
{
    (void)state;
    static const char skin[] = "OFF\n4 4 0\n0 0 0\n9 0 0\n0 9 0\n0 0 9\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n";
    const char *volume = cached_atlas("around.nii", 5);
    char path[8192];
    snprintf(path, sizeof path, "%.*s.off", (int)(strlen(volume) - strlen(".nii")), volume);
    assert_ok(file_write_soon(path, skin, strlen(skin)));
    const char *manifest = write_manifest(volume, "");
    keep(manifest);
    assert_true(is_in_cache(manifest));
    manifest = write_manifest(volume, ", \"context\": \"around.off\"");
    conus_atlas *atlas = load_and_keep_rested(manifest, NULL);
    assert_non_null(atlas);
    assert_int_equal(conus_atlas_context_surface_count(atlas), 1);
    assert_null(atlas->mapped);
    assert_false(is_in_cache(manifest));
    conus_atlas_destroy(atlas);
}

static void count_note(void *user, const conus_note *note)
{
    size_t *counts = user;
    counts[0]++;
    counts[1] += strlen(note->line) + (note->path ? strlen(note->path) : 0) + (size_t)note->severity;
}

static void notes_are_heard_again(void **state)
{
    (void)state;
    size_t first[2] = {0};
    size_t again[2] = {0};
    const char *path = cached_atlas("notes.nii", 6); /* label 5 has a name and no voxel, which is noted */
    conus_load_options options = {.cache = true, .log = count_note, .log_user = first};
    conus_atlas_destroy(load_and_keep_rested(path, &options));
    options.log_user = again;
    conus_atlas *atlas = find_in_cache(path, &options, UINT64_MAX);
    assert_non_null(atlas);
    assert_true(first[0] > 0);
    assert_int_equal(first[0], again[0]);
    assert_int_equal(first[1], again[1]);
    conus_atlas_destroy(atlas);
}

/* A file written just now might change again within the same step of the clock. */
static void a_file_that_changed_just_now_is_not_kept(void **state)
{
    (void)state;
    conus_atlas *atlas = NULL;
    const conus_load_options options = {.cache = true};
    const char *path = cached_atlas("fresh.nii", 5);
    assert_ok(conus_atlas_load(&atlas, path, &options));
    assert_null(atlas->mapped);
    assert_int_equal(access(entry_of(path), F_OK), -1);
    conus_atlas_destroy(atlas);
}

static bool stop(void *user, const char *path, size_t done, size_t total)
{
    (void)path;
    *(size_t *)user += 1 + done + total;
    return false;
}

static void progress_can_cancel_what_is_mapped(void **state)
{
    (void)state;
    size_t heard = 0;
    conus_atlas *atlas = NULL;
    const char *path = cached_atlas("cancel.nii", 5);
    keep(path);
    const conus_load_options options = {.cache = true, .progress = stop, .progress_user = &heard};
    assert_fails(conus_atlas_load(&atlas, path, &options), CONUS_ERROR_CANCELLED);
    assert_int_equal(heard, 2); /* 0 of 1, once */
    assert_null(atlas);
}

static void the_environment_sets_the_limit(void **state)
{
    (void)state;
    static const struct {
        const char *text;
        uint64_t limit;
        bool wrong;
    } cases[] = {{"off", 0, false},
                 {"0", 0, false},
                 {"", UINT64_C(4) << 30, false},
                 {"123", 123, false},
                 {"2K", 2048, false},
                 {"3M", 3 << 20, false},
                 {"-1", 0, true},
                 {"1G", 1 << 30, false},
                 {"2T", UINT64_C(2) << 40, false},
                 {"1GB", 0, true},
                 {"K", 0, true},
                 {"12x", 0, true},
                 {"OFF", 0, true},
                 {" 1", 0, true},
                 {"18446744073709551615", UINT64_MAX, false},
                 {"18446744073709551616", 0, true},
                 {"16777216T", 0, true}};
    const char *path = cached_atlas("off.nii", 5);
    const conus_load_options cached = {.cache = true};
    conus_atlas *atlas = NULL;
    uint64_t limit;
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        setenv("CONUS_CACHE", cases[i].text, 1);
        assert_int_equal(cache_limit(&limit), !cases[i].wrong);
        assert_int_equal(limit, cases[i].limit);
        assert_int_equal(conus_cache_limit(), cases[i].limit);
        conus_status status = conus_atlas_load(&atlas, path, &cached);
        assert_int_equal(status, cases[i].wrong ? CONUS_ERROR_ARGUMENT : CONUS_OK);
        assert_true(!cases[i].wrong || strstr(conus_message(), cases[i].text));
        conus_atlas_destroy(atlas);
        atlas = NULL;
        assert_ok(conus_atlas_load(&atlas, path, NULL)); /* the cache is not used */
        conus_atlas_destroy(atlas);
        atlas = NULL;
    }
    setenv("CONUS_CACHE", "off", 1);
    atlas = load_and_keep_rested(path, NULL);
    assert_null(atlas->mapped);
    conus_atlas_destroy(atlas);
    unsetenv("CONUS_CACHE");
    assert_true(cache_limit(&limit));
    assert_int_equal(limit, UINT64_C(4) << 30);
}

static void age(const char *path, time_t seconds)
{
    const struct timespec times[2] = {{.tv_sec = seconds}, {.tv_sec = seconds}};
    assert_int_equal(utimensat(AT_FDCWD, entry_of(path), times, 0), 0);
}

static void what_was_not_used_for_longest_leaves_first(void **state)
{
    (void)state;
    char limit[32];
    struct stat info;
    char paths[4][8192];
    static const char *const names[] = {"lru1.nii", "lru2.nii", "lru3.nii", "lru4.nii"};
    assert_ok(conus_cache_clear());
    for (size_t i = 0; i < 4; i++) {
        snprintf(paths[i], sizeof paths[i], "%s", cached_atlas(names[i], 5));
    }
    for (size_t i = 0; i < 3; i++) {
        keep(paths[i]);
        age(paths[i], 1000 + (time_t)i);
    }
    conus_atlas *used = find_in_cache(paths[0], NULL, UINT64_MAX); /* and mapped, while others leave */
    assert_int_equal(stat(entry_of(paths[0]), &info), 0);
    snprintf(limit, sizeof limit, "%zu", 3 * (size_t)info.st_size);
    setenv("CONUS_CACHE", limit, 1);
    keep(paths[3]);
    assert_int_equal(access(entry_of(paths[0]), F_OK), 0);
    assert_int_equal(access(entry_of(paths[1]), F_OK), -1);
    assert_int_equal(access(entry_of(paths[2]), F_OK), 0);
    assert_int_equal(access(entry_of(paths[3]), F_OK), 0);
    setenv("CONUS_CACHE", "1K", 1);
    conus_atlas *large = load_and_keep_rested(paths[1], NULL); /* larger than all may be: the others stay */
    assert_null(large->mapped);
    assert_int_equal(access(entry_of(paths[0]), F_OK), 0);
    unsetenv("CONUS_CACHE");
    assert_ok(conus_cache_clear());
    struct bytes a = packed_bytes(used); /* the entry's file has no name any more */
    struct bytes b = packed_bytes(large);
    assert_int_equal(a.size, b.size);
    bytes_finish(&a);
    bytes_finish(&b);
    conus_atlas_destroy(used);
    conus_atlas_destroy(large);
}

static void the_list_says_what_is_kept(void **state)
{
    (void)state;
    conus_cache *cache = NULL;
    assert_ok(conus_cache_clear());
    const char *path = cached_atlas("listed.nii", 5);
    keep(path);
    assert_ok(conus_cache_create(&cache));
    assert_null(conus_cache_problem(cache));
    assert_int_equal(conus_cache_count(cache), 1);
    const conus_cache_entry *entry = conus_cache_entry_at(cache, 0);
    assert_string_equal(entry->path, path);
    assert_string_equal(entry->kind, "atlas");
    assert_string_equal(entry->file, strrchr(entry_of(path), '/') + 1);
    assert_null(conus_cache_entry_at(cache, 1));
    conus_cache_destroy(cache);
    assert_ok(conus_cache_clear());
    assert_ok(conus_cache_create(&cache));
    assert_int_equal(conus_cache_count(cache), 0);
    conus_cache_destroy(cache);
    conus_cache_destroy(NULL);
    assert_int_equal(conus_cache_count(NULL), 0);
}

static conus_status attempt(void *data)
{
    conus_cache *cache = NULL;
    conus_atlas *atlas = load_and_keep_rested(data, NULL);
    conus_status status = atlas ? CONUS_OK : CONUS_ERROR_MEMORY;
    conus_atlas_destroy(atlas);
    conus_atlas_destroy(find_in_cache(data, NULL, UINT64_MAX));
    status = status ? status : conus_cache_create(&cache);
    conus_cache_destroy(cache);
    return status;
}

static void every_failing_allocation(void **state)
{
    (void)state;
    test_every_allocation(attempt, (void *)cached_atlas("memory.nii", 5));
}

TEST_GROUP(atlas_cache)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_loaded_atlas_is_mapped_the_next_time),
        cmocka_unit_test(the_library_asks_for_no_cache_by_itself),
        cmocka_unit_test(a_file_that_changed_is_read_again),
        cmocka_unit_test(a_file_that_appears_beside_it_counts),
        cmocka_unit_test(only_searched_names_in_the_folder_count),
        cmocka_unit_test(options_have_entries_of_their_own),
        cmocka_unit_test(parts_from_unrecorded_files_are_not_kept),
        cmocka_unit_test(notes_are_heard_again),
        cmocka_unit_test(surfaces_around_the_areas_are_not_kept),
        cmocka_unit_test(a_file_that_changed_just_now_is_not_kept),
        cmocka_unit_test(progress_can_cancel_what_is_mapped),
        cmocka_unit_test(the_environment_sets_the_limit),
        cmocka_unit_test(what_was_not_used_for_longest_leaves_first),
        cmocka_unit_test(the_list_says_what_is_kept),
        cmocka_unit_test(every_failing_allocation),
    };
    umask(022);
    unsetenv("CONUS_CACHE");
    test_own_cache();
    return cmocka_run_group_tests(tests, NULL, NULL);
}
