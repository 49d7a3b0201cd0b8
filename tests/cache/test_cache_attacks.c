/* SPDX-License-Identifier: BSD-3-Clause */
/* Damaged, foreign or exchanged entries of the cache are never used; failing to write one is no error. */
#include "base/cache/cache_entry.h"
#include "base/files/file.h"
#include "base/system/system.h"
#include "builders/cache_builder.h"
#include "conus/atlas_info.h"
#include "conus/cache.h"
#include "conus/version.h"
#include "test.h"

#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mount.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

static void keep(const char *path)
{
    conus_atlas *atlas = load_and_keep_rested(path, NULL);
    assert_non_null(atlas);
    assert_non_null(atlas->mapped);
    conus_atlas_destroy(atlas);
}

/* Reads the entry of `path`; the caller frees the bytes. */
static struct bytes read_entry(const char *path)
{
    struct bytes bytes = {0};
    assert_ok(file_read(&bytes, entry_of(path), UINT64_MAX));
    return bytes;
}

/* Overwrites an entry in place, without a new file. */
static void overwrite(const char *entry, const void *data, size_t size)
{
    int file = open(entry, O_WRONLY | O_TRUNC | O_CLOEXEC);
    assert_true(file >= 0);
    assert_true(system_write(file, data, size));
    close(file);
}

static bool is_unchecked(size_t at)
{
    return at >= cache_entry_stamp_at() && at < cache_entry_stamp_at() + CACHE_STAMP_SIZE;
}

/* Flips one bit of each byte: of the head, the key, the notes, the trace, the zeros up to the page, and all of the
 * packed atlas. A changed byte of the stamp only makes the entry be verified, which happens anyway. */
static void no_flipped_bit_is_passed_over(void **state)
{
    (void)state;
    size_t taken = 0;
    const char *path = cached_atlas("flip.nii", 5);
    keep(path);
    char *entry = strdup(entry_of(path));
    struct bytes bytes = read_entry(path);
    for (size_t i = 0; i < bytes.size; i++) {
        uint8_t flipped = (uint8_t)(bytes.data[i] ^ 1 << i % 8);
        int file = open(entry, O_WRONLY | O_CLOEXEC);
        assert_int_equal(pwrite(file, &flipped, 1, (off_t)i), 1);
        conus_atlas *atlas = find_in_cache(path, NULL, UINT64_MAX);
        taken += atlas && !is_unchecked(i);
        conus_atlas_destroy(atlas);
        assert_int_equal(pwrite(file, bytes.data + i, 1, (off_t)i), 1);
        close(file);
    }
    assert_int_equal(taken, 0);
    assert_cached_is_loaded(path);
    bytes_finish(&bytes);
    free(entry);
}

static void nothing_that_is_cut_off_or_longer_is_taken(void **state)
{
    (void)state;
    const char *path = cached_atlas("cut.nii", 5);
    keep(path);
    char *entry = strdup(entry_of(path));
    struct bytes bytes = read_entry(path);
    for (size_t size = bytes.size; size-- > 0;) {
        assert_int_equal(truncate(entry, (off_t)size), 0);
        assert_false(is_in_cache(path));
    }
    overwrite(entry, bytes.data, bytes.size);
    assert_true(is_in_cache(path));
    int file = open(entry, O_WRONLY | O_APPEND | O_CLOEXEC);
    assert_int_equal(write(file, "", 1), 1);
    close(file);
    assert_false(is_in_cache(path));
    keep(path); /* in its place */
    assert_cached_is_loaded(path);
    bytes_finish(&bytes);
    free(entry);
}

/* An entry with valid checksums that another version, build or machine wrote under the same name. */
static void entries_of_others_are_not_taken(void **state)
{
    (void)state;
    static const char *const words[] = {"conus " CONUS_VERSION, "little", "foreign.nii"};
    const char *path = cached_atlas("foreign.nii", 5);
    keep(path);
    char *entry = strdup(entry_of(path));
    struct bytes bytes = read_entry(path);
    struct cache_entry parts;
    assert_true(cache_entry_parse(&parts, bytes.data, bytes.size));
    for (size_t i = 0; i < 4; i++) {
        struct buffer forged = {0};
        uint8_t *key = (uint8_t *)parts.key.data; /* in `bytes`, which are ours */
        uint8_t *word = i < 3 ? memmem(key, parts.key.size, words[i], strlen(words[i]))
                              : key + sizeof "=conus " CONUS_VERSION; /* the build's ID, behind its mark */
        if (!word && i == 1) {
            continue; /* on a big-endian machine */
        }
        assert_non_null(word);
        word[i == 3] ^= 1;
        cache_entry_write(&forged, &parts);
        buffer_append(&forged, parts.packed.data, parts.packed.size);
        overwrite(entry, forged.data, forged.size);
        assert_false(is_in_cache(path));
        word[i == 3] ^= 1;
        buffer_finish(&forged);
    }
    overwrite(entry, bytes.data, bytes.size);
    assert_true(is_in_cache(path));
    bytes_finish(&bytes);
    free(entry);
}

/* Whether the entry's stamp belongs to this run of the kernel, this file and its time of writing. */
static bool is_stamped(int file)
{
    struct stat info;
    uint8_t stamp[CACHE_STAMP_SIZE];
    uint8_t wanted[CACHE_STAMP_SIZE];
    assert_int_equal(fstat(file, &info), 0);
    assert_int_equal(pread(file, stamp, sizeof stamp, (off_t)cache_entry_stamp_at()), sizeof stamp);
    assert_true(cache_stamp_find(wanted, file, &info.st_mtim));
    return memcmp(stamp, wanted, sizeof stamp) == 0;
}

/* A large entry is verified as a whole if its stamp does not fit: after it was written to, in another run of the
 * kernel, or in a copy of the file. Then it gets a new stamp. */
static void large_entries_are_verified_once_and_after_each_write(void **state)
{
    (void)state;
    static const uint8_t other[CACHE_STAMP_SIZE] = {1};
    uint8_t stamp[CACHE_STAMP_SIZE];
    struct stat info = {0};
    const char *path = cached_atlas("large.nii", 5);
    keep(path);
    char *entry = strdup(entry_of(path));
    struct bytes bytes = read_entry(path);
    int file = open(entry, O_RDWR | O_CLOEXEC);
    assert_int_equal(fstat(file, &info), 0);
    if (!cache_stamp_find(stamp, file, &info.st_mtim)) {
        print_message("skipped: this system has no boot ID\n");
        skip();
    }
    assert_true(is_stamped(file));
    uint8_t flipped = bytes.data[bytes.size - 65] ^ 1; /* a byte of the last array: up to 64 bytes of padding follow */
    assert_int_equal(pwrite(file, &flipped, 1, (off_t)bytes.size - 65), 1);
    assert_false(is_stamped(file));
    assert_null(find_in_cache(path, NULL, 0));
    const struct timespec times[2] = {info.st_atim, info.st_mtim};
    assert_int_equal(pwrite(file, other, sizeof other, (off_t)cache_entry_stamp_at()), sizeof other);
    assert_int_equal(futimens(file, times), 0);
    assert_null(find_in_cache(path, NULL, 0));
    assert_int_equal(pwrite(file, bytes.data + bytes.size - 65, 1, (off_t)bytes.size - 65), 1);
    for (int i = 0; i < 2; i++) { /* being used is no writing */
        conus_atlas *atlas = find_in_cache(path, NULL, 0);
        assert_non_null(atlas);
        conus_atlas_destroy(atlas);
        assert_true(is_stamped(file));
    }
    close(file);
    bytes_finish(&bytes);
    free(entry);
}

static char *folder_of(const char *entry)
{
    static char folder[8192];
    snprintf(folder, sizeof folder, "%.*s", (int)(strrchr(entry, '/') - entry), entry);
    return folder;
}

/* Files of another owner can only be made by root. */
static void what_others_can_write_is_not_taken(void **state)
{
    (void)state;
    static const mode_t modes[] = {0620, 0602, 0666};
    const char *path = cached_atlas("modes.nii", 5);
    keep(path);
    char *entry = strdup(entry_of(path));
    char *folder = folder_of(entry);
    for (size_t i = 0; i < 3; i++) {
        assert_int_equal(chmod(entry, modes[i]), 0);
        assert_false(is_in_cache(path));
        assert_int_equal(chmod(entry, 0644), 0);
        assert_true(is_in_cache(path));
        assert_int_equal(chmod(folder, modes[i] | 0700), 0);
        assert_false(is_in_cache(path));
        conus_atlas *atlas = load_and_keep_rested(path, NULL); /* nor is anything written there */
        assert_null(atlas->mapped);
        conus_atlas_destroy(atlas);
        assert_int_equal(chmod(folder, 0700), 0);
    }
    if (geteuid() == 0) {
        assert_int_equal(chown(entry, 65534, (gid_t)-1), 0);
        assert_false(is_in_cache(path));
        assert_int_equal(chown(entry, 0, (gid_t)-1), 0);
        assert_int_equal(chown(folder, 65534, (gid_t)-1), 0);
        assert_false(is_in_cache(path));
        assert_int_equal(chown(folder, 0, (gid_t)-1), 0);
    } else {
        print_message("not tried: entries of others, which takes root\n");
    }
    assert_true(is_in_cache(path));
    free(entry);
}

static void links_and_pipes_are_not_taken(void **state)
{
    (void)state;
    char elsewhere[8300];
    const char *path = cached_atlas("links.nii", 5);
    keep(path);
    char *entry = strdup(entry_of(path));
    snprintf(elsewhere, sizeof elsewhere, "%s.elsewhere", entry);
    assert_int_equal(rename(entry, elsewhere), 0);
    assert_int_equal(symlink(elsewhere, entry), 0);
    assert_false(is_in_cache(path));
    keep(path); /* it replaces the link, not the file to which the link leads */
    assert_true(is_in_cache(path));
    unlink(entry);
    assert_int_equal(mkfifo(entry, 0600), 0);
    assert_false(is_in_cache(path));
    unlink(entry);
    assert_int_equal(rename(elsewhere, entry), 0);
    assert_true(is_in_cache(path));
    char *folder = folder_of(entry);
    snprintf(elsewhere, sizeof elsewhere, "%s.elsewhere", folder);
    assert_int_equal(rename(folder, elsewhere), 0);
    assert_int_equal(symlink(elsewhere, folder), 0);
    assert_false(is_in_cache(path));
    unlink(folder);
    assert_int_equal(rename(elsewhere, folder), 0);
    assert_true(is_in_cache(path));
    free(entry);
}

static void an_entry_may_be_replaced_while_it_is_mapped(void **state)
{
    (void)state;
    const char *path = cached_atlas("replaced.nii", 5);
    keep(path);
    conus_atlas *mapped = find_in_cache(path, NULL, UINT64_MAX);
    struct bytes before = packed_bytes(mapped);
    cached_atlas("replaced.nii", 6);
    keep(path);
    struct bytes after = packed_bytes(mapped);
    assert_int_equal(before.size, after.size);
    assert_memory_equal(before.data, after.data, before.size);
    assert_int_equal(conus_atlas_object(mapped, 3)->voxels, 1); /* label 5 */
    conus_atlas *now = find_in_cache(path, NULL, UINT64_MAX);
    assert_int_equal(conus_atlas_object(now, 3)->voxels, 0);
    bytes_finish(&before);
    bytes_finish(&after);
    conus_atlas_destroy(mapped);
    conus_atlas_destroy(now);
}

static size_t files_in_cache(void)
{
    conus_cache *cache = NULL;
    assert_ok(conus_cache_create(&cache));
    size_t count = conus_cache_count(cache);
    conus_cache_destroy(cache);
    return count;
}

static void assert_loads_without(const char *path)
{
    size_t before = files_in_cache();
    conus_atlas *atlas = load_and_keep_rested(path, NULL);
    assert_non_null(atlas);
    assert_null(atlas->mapped);
    assert_int_equal(conus_atlas_object_count(atlas), 4);
    conus_atlas_destroy(atlas);
    assert_int_equal(files_in_cache(), before); /* nothing is left behind, either */
}

static void without_a_folder_nothing_is_kept(void **state)
{
    (void)state;
    char *cache = strdup(getenv("XDG_CACHE_HOME"));
    char *home = getenv("HOME") ? strdup(getenv("HOME")) : NULL;
    static const char *const folders[] = {"relative", "/proc/none", "/dev/null", "/dev/full"};
    const char *path = cached_atlas("nowhere.nii", 5);
    unsetenv("HOME");
    for (size_t i = 0; i < sizeof folders / sizeof folders[0]; i++) {
        setenv("XDG_CACHE_HOME", folders[i], 1);
        assert_loads_without(path);
    }
    setenv("XDG_CACHE_HOME", cache, 1);
    if (home) {
        setenv("HOME", home, 1);
    }
    free(cache);
    free(home);
}

/* Exceeding this limit ends a program by SIGXFSZ. */
static void a_limit_on_sizes_of_files_is_heeded(void **state)
{
    (void)state;
    struct rlimit before;
    const char *path = cached_atlas("limit.nii", 5);
    assert_int_equal(getrlimit(RLIMIT_FSIZE, &before), 0);
    const struct rlimit small = {1000, before.rlim_max};
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &small), 0);
    assert_loads_without(path);
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &before), 0);
    keep(path);
}

/* This needs root, and a system that allows mounting. */
static void a_full_disk_keeps_nothing(void **state)
{
    (void)state;
    char disk[8192];
    const char *path = cached_atlas("full.nii", 5);
    char *cache = strdup(getenv("XDG_CACHE_HOME"));
    snprintf(disk, sizeof disk, "%s-disk", cache);
    assert_int_equal(mkdir(disk, 0700), 0);
    if (mount("none", disk, "tmpfs", 0, "size=8k,mode=700")) {
        print_message("skipped: no tmpfs can be mounted here\n");
        free(cache);
        skip();
    }
    setenv("XDG_CACHE_HOME", disk, 1);
    assert_loads_without(path); /* two pages of two, of which no more than half may be taken */
    assert_int_equal(umount(disk), 0);
    assert_int_equal(mount("none", disk, "tmpfs", 0, "size=1m,nr_inodes=2,mode=700"), 0);
    assert_loads_without(path); /* space enough, and the second inode is the folder's */
    assert_int_equal(umount(disk), 0);
    assert_int_equal(mount("none", disk, "tmpfs", 0, "size=1m,mode=700"), 0);
    keep(path);
    assert_true(is_in_cache(path));
    assert_int_equal(umount2(disk, MNT_DETACH), 0);
    setenv("XDG_CACHE_HOME", cache, 1);
    rmdir(disk);
    free(cache);
}

static pid_t start_writer(const char *path, int times)
{
    pid_t pid = fork();
    for (int n = 0; pid == 0 && n < times; n++) {
        conus_atlas *atlas = load_and_keep_rested(path, NULL);
        if (!atlas || !atlas->mapped || conus_atlas_object_count(atlas) != 4) {
            _exit(1);
        }
        conus_atlas_destroy(atlas);
    }
    if (pid == 0) {
        _exit(0);
    }
    return pid;
}

static void two_writers_and_a_reader_see_whole_entries(void **state)
{
    (void)state;
    enum { TIMES = 60 };
    pid_t pids[2];
    const char *path = cached_atlas("writers.nii", 5);
    conus_atlas *loaded = NULL;
    assert_ok(conus_atlas_load(&loaded, path, NULL));
    struct bytes wanted = packed_bytes(loaded);
    for (int i = 0; i < 2; i++) {
        pids[i] = start_writer(path, TIMES);
    }
    for (int n = 0; n < TIMES; n++) {
        conus_atlas *found = find_in_cache(path, NULL, UINT64_MAX);
        if (found) {
            struct bytes bytes = packed_bytes(found);
            assert_int_equal(bytes.size, wanted.size);
            assert_memory_equal(bytes.data, wanted.data, wanted.size);
            bytes_finish(&bytes);
        }
        conus_atlas_destroy(found);
    }
    for (int i = 0; i < 2; i++) {
        int how;
        assert_int_equal(waitpid(pids[i], &how, 0), pids[i]);
        assert_int_equal(how, 0);
    }
    assert_cached_is_loaded(path);
    bytes_finish(&wanted);
    conus_atlas_destroy(loaded);
}

TEST_GROUP(cache_attacks)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(no_flipped_bit_is_passed_over),
        cmocka_unit_test(nothing_that_is_cut_off_or_longer_is_taken),
        cmocka_unit_test(entries_of_others_are_not_taken),
        cmocka_unit_test(large_entries_are_verified_once_and_after_each_write),
        cmocka_unit_test(what_others_can_write_is_not_taken),
        cmocka_unit_test(links_and_pipes_are_not_taken),
        cmocka_unit_test(an_entry_may_be_replaced_while_it_is_mapped),
        cmocka_unit_test(without_a_folder_nothing_is_kept),
        cmocka_unit_test(a_limit_on_sizes_of_files_is_heeded),
        cmocka_unit_test(a_full_disk_keeps_nothing),
        cmocka_unit_test(two_writers_and_a_reader_see_whole_entries),
    };
    umask(022);
    unsetenv("CONUS_CACHE");
    test_own_cache();
    return cmocka_run_group_tests(tests, NULL, NULL);
}
