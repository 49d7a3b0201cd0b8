/* SPDX-License-Identifier: BSD-3-Clause */
/* Attacks on the index of a packed 4-D file: a forged, foreign, damaged or exchanged index never gives a wrong voxel,
 * and failing to keep one is no error. */
#include "base/memory.h"
#include "builders/series_builder.h"
#include "conus/cache.h"
#include "loaders/volumes/stored/stored_file.h"
#include "test.h"

#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mount.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

enum { LIES = 8 };

static void lie(uint8_t *index, size_t size, int how)
{
    static const uint8_t none[8];
    struct gzip_point *points = (struct gzip_point *)(void *)(index + SERIES_POINTS_AT);
    struct gzip_point *point = &points[7];
    switch (how) {
    case 0: /* the place */
        point->packed++;
        break;
    case 1:
        point->packed = points[8].packed;
        break;
    case 2: /* the bits */
        point->bits = (point->bits + 3) % 8;
        break;
    case 3: /* the window of another point */
        point->window = points[6].window;
        point->window_size = points[6].window_size;
        break;
    case 4: /* a window of zeros */
        memset(index + size - 100000, 0, 100000);
        break;
    case 5: /* the checksum */
        point->sum ^= 1;
        break;
    case 6: /* the checksum, where the file's own cannot contradict it */
        point->sum ^= 1;
        memcpy(index + SERIES_TRAILER_AT, none, sizeof none);
        break;
    default: /* how much there is before it */
        point->unpacked -= 5;
        break;
    }
}

/* Volumes 6 and 7 lie in the spans around point 7, the last volume in the last spans. */
static void an_index_that_lies_gives_nothing_wrong(void **state)
{
    (void)state;
    struct bytes bytes = {0};
    struct cache_entry parts;
    series_need_index();
    char *entry = strdup(series_entry());
    assert_ok(file_read(&bytes, entry, UINT64_MAX));
    assert_true(cache_entry_parse(&parts, bytes.data, bytes.size));
    for (int how = 0; how < LIES; how++) {
        uint8_t *index = memory_copy(parts.packed.data, parts.packed.size, 1);
        lie(index, parts.packed.size, how);
        series_forge(entry, &bytes, index);
        memory_free(index);
        size_t volume = how == 4 ? SERIES_COUNT - 1 : 7;
        assert_int_equal(series_is_indexed(series_path()), how != 5 && how != 7); /* else it is found out later */
        (void)series_opens_by_index(series_path(), volume - 1);
        (void)series_opens_by_index(series_path(), volume);
        series_assert_opens(series_path(), volume, 0);
    }
    overwrite_file(entry, bytes.data, bytes.size);
    assert_true(series_opens_by_index(series_path(), 7));
    bytes_finish(&bytes);
    free(entry);
}

/* Wrong values that only the spans' checksums reveal, in every other format. */
static void in_no_format_it_gives_anything_wrong(void **state)
{
    (void)state;
    static const int lies[] = {1, 2, 3, 6};
    for (int form = 0; form < SERIES_FORMS; form++) {
        struct bytes bytes = {0};
        struct cache_entry parts;
        char path[8192];
        snprintf(path, sizeof path, "%s", series_make_as((enum series_form)form, 0));
        assert_ok(conus_cache_clear());
        series_open_rested(path);
        char *entry = strdup(series_entry());
        assert_ok(file_read(&bytes, entry, UINT64_MAX));
        assert_true(cache_entry_parse(&parts, bytes.data, bytes.size));
        uint8_t *index = memory_copy(parts.packed.data, parts.packed.size, 1);
        lie(index, parts.packed.size, lies[form % 4]);
        series_forge(entry, &bytes, index);
        memory_free(index);
        assert_false(series_opens_by_index(path, 8));
        series_assert_opens(path, 8, 0); /* in the span of point 7 */
        overwrite_file(entry, bytes.data, bytes.size);
        assert_true(series_opens_by_index(path, 8));
        bytes_finish(&bytes);
        free(entry);
    }
}

static void no_flipped_bit_and_no_part_of_it_is_taken(void **state)
{
    (void)state;
    struct bytes bytes = {0};
    series_need_index();
    char *entry = strdup(series_entry());
    assert_ok(file_read(&bytes, entry, UINT64_MAX));
    for (size_t i = 0; i < bytes.size; i += i < 8192 ? 37 : 9973) {
        bool unchecked = i >= cache_entry_stamp_at() && i < cache_entry_stamp_at() + CACHE_STAMP_SIZE;
        uint8_t flipped = (uint8_t)(bytes.data[i] ^ 1 << i % 8);
        int file = open(entry, O_WRONLY | O_CLOEXEC);
        assert_int_equal(pwrite(file, &flipped, 1, (off_t)i), 1);
        assert_true(unchecked || !series_is_indexed(series_path()));
        assert_int_equal(pwrite(file, bytes.data + i, 1, (off_t)i), 1);
        close(file);
    }
    for (size_t size = bytes.size; size > 1000; size -= size / 10) {
        assert_int_equal(truncate(entry, (off_t)size - 1), 0);
        assert_false(series_is_indexed(series_path()));
    }
    overwrite_file(entry, bytes.data, bytes.size);
    assert_true(series_is_indexed(series_path()));
    bytes_finish(&bytes);
    free(entry);
}

static void what_others_can_write_is_not_taken(void **state)
{
    (void)state;
    static const mode_t modes[] = {0620, 0602, 0666};
    char elsewhere[8300];
    series_need_index();
    char *entry = strdup(series_entry());
    char *folder = strdup(entry);
    *strrchr(folder, '/') = '\0';
    for (size_t i = 0; i < 3; i++) {
        assert_int_equal(chmod(entry, modes[i]), 0);
        assert_false(series_is_indexed(series_path()));
        assert_int_equal(chmod(entry, 0600), 0);
        assert_int_equal(chmod(folder, modes[i] | 0700), 0);
        assert_false(series_is_indexed(series_path()));
        assert_int_equal(chmod(folder, 0700), 0);
    }
    snprintf(elsewhere, sizeof elsewhere, "%s.elsewhere", entry);
    assert_int_equal(rename(entry, elsewhere), 0);
    assert_int_equal(symlink(elsewhere, entry), 0);
    assert_false(series_is_indexed(series_path()));
    unlink(entry);
    assert_int_equal(mkfifo(entry, 0600), 0);
    assert_false(series_is_indexed(series_path()));
    unlink(entry);
    assert_int_equal(rename(elsewhere, entry), 0);
    if (geteuid() == 0) {
        assert_int_equal(chown(entry, 65534, (gid_t)-1), 0);
        assert_false(series_is_indexed(series_path()));
        assert_int_equal(chown(entry, 0, (gid_t)-1), 0);
    }
    assert_true(series_is_indexed(series_path()));
    free(entry);
    free(folder);
}

/* Puts the entry of one file in the place of another's: with its name, its file state, and valid checksums. */
static void forge_for(const char *path, const struct bytes *bytes)
{
    struct index_keeper keeper;
    struct cache_entry parts;
    struct buffer trace = {0};
    struct buffer forged = {0};
    index_keeper_begin(&keeper, path, NULL);
    file_trace_write(&trace, &keeper.trace);
    assert_true(cache_entry_parse(&parts, bytes->data, bytes->size));
    parts.key = (struct cache_part){(const uint8_t *)keeper.store.key.data, keeper.store.key.size};
    parts.trace = (struct cache_part){(const uint8_t *)trace.data, trace.size};
    uint8_t *index = memory_copy(parts.packed.data, parts.packed.size, 1);
    memcpy(index + 8, &keeper.trace.items[0].state.size, 8); /* size of the packed file */
    parts.packed_crc = cache_crc(0, index, parts.packed.size);
    cache_entry_write(&forged, &parts);
    buffer_append(&forged, index, parts.packed.size);
    assert_ok(file_write_soon(keeper.store.path.data, forged.data, forged.size));
    assert_int_equal(chmod(keeper.store.path.data, 0600), 0);
    memory_free(index);
    buffer_finish(&forged);
    buffer_finish(&trace);
    index_keeper_finish(&keeper);
}

/* The forged state imitates a file that changed within one step of the clock. */
static void a_file_that_changed_is_unpacked_anew(void **state)
{
    (void)state;
    struct bytes bytes = {0};
    char path[8192];
    snprintf(path, sizeof path, "%s", series_make("changes.nii.gz", 100, SIZE_MAX));
    assert_ok(conus_cache_clear());
    series_index(path, false); /* it was written just now */
    assert_string_equal(series_entry(), "");
    series_index(path, true);
    assert_true(series_is_indexed(path));
    assert_ok(file_read(&bytes, series_entry(), UINT64_MAX));
    series_make("changes.nii.gz", 200, SIZE_MAX); /* at once, in its place */
    assert_false(series_is_indexed(path));
    series_assert_opens(path, 7, 200);
    forge_for(path, &bytes);
    assert_false(series_is_indexed(path)); /* the file's own checksum is another */
    series_assert_opens(path, 7, 200);
    series_make("changes.nii.gz", 300, 3000000);
    forge_for(path, &bytes);
    series_assert_opens(path, 0, 300);
    series_assert_opens(path, SERIES_COUNT - 1, 300);
    bytes_finish(&bytes);
}

static pid_t start_writer(const char *path, int times)
{
    pid_t pid = fork();
    for (int n = 0; pid == 0 && n < times; n++) {
        series_index(path, true);
        if (!series_opens_by_index(path, 5)) {
            _exit(1);
        }
    }
    if (pid == 0) {
        _exit(0);
    }
    return pid;
}

static void two_processes_fill_it_at_once(void **state)
{
    (void)state;
    enum { TIMES = 2 };
    pid_t pids[2];
    const char *path = series_path();
    assert_ok(conus_cache_clear());
    for (int i = 0; i < 2; i++) {
        pids[i] = start_writer(path, TIMES);
    }
    for (size_t n = 0; n < 2 * TIMES; n++) {
        (void)series_opens_by_index(path, n);
    }
    for (int i = 0; i < 2; i++) {
        int how;
        assert_int_equal(waitpid(pids[i], &how, 0), pids[i]);
        assert_int_equal(how, 0);
    }
    assert_true(series_opens_by_index(path, 5));
}

static void where_nothing_can_be_kept_it_is_no_error(void **state)
{
    (void)state;
    char disk[8192];
    char *cache = strdup(getenv("XDG_CACHE_HOME"));
    static const char *const folders[] = {"relative", "/proc/none", "/dev/full"};
    for (size_t i = 0; i < 3; i++) {
        setenv("XDG_CACHE_HOME", folders[i], 1);
        series_need_index();
        series_assert_opens(series_path(), 2, 0);
    }
    setenv("XDG_CACHE_HOME", cache, 1);
    assert_ok(conus_cache_clear());
    setenv("CONUS_CACHE", "10K", 1); /* it takes more */
    series_need_index();
    unsetenv("CONUS_CACHE");
    assert_string_equal(series_entry(), "");
    snprintf(disk, sizeof disk, "%s-disk", cache);
    assert_int_equal(mkdir(disk, 0700), 0);
    if (mount("none", disk, "tmpfs", 0, "size=8k,mode=700")) {
        print_message("not tried: a full disk, which takes a tmpfs\n");
    } else {
        setenv("XDG_CACHE_HOME", disk, 1);
        series_need_index();
        assert_false(series_is_indexed(series_path()));
        assert_int_equal(umount2(disk, MNT_DETACH), 0);
        setenv("XDG_CACHE_HOME", cache, 1);
    }
    rmdir(disk);
    free(cache);
}

TEST_GROUP(index_attacks)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(an_index_that_lies_gives_nothing_wrong),
        cmocka_unit_test(in_no_format_it_gives_anything_wrong),
        cmocka_unit_test(no_flipped_bit_and_no_part_of_it_is_taken),
        cmocka_unit_test(what_others_can_write_is_not_taken),
        cmocka_unit_test(a_file_that_changed_is_unpacked_anew),
        cmocka_unit_test(two_processes_fill_it_at_once),
        cmocka_unit_test(where_nothing_can_be_kept_it_is_no_error),
    };
    umask(022);
    unsetenv("CONUS_CACHE");
    test_own_cache();
    return cmocka_run_group_tests(tests, NULL, NULL);
}
