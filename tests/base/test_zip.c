/* SPDX-License-Identifier: BSD-3-Clause */
/* Zip archives: stored, packed, ZIP64, streamed; contradicting records, names that lead elsewhere, bombs. */
#include "base/formats/packed.h"

#include "base/memory.h"
#include "builders/zip_builder.h"
#include "test.h"

#include <stdio.h>
#include <string.h>

static const char text[] = "streamlines streamlines streamlines streamlines";

enum { TEXT_BYTES = sizeof text - 1 };

static struct zip parse(struct job *job, const struct buffer *archive)
{
    return zip_parse(job, (const uint8_t *)archive->data, archive->size);
}

/* NULL if there is none. */
static const struct zip_entry *find(const struct zip *zip, const char *name)
{
    const struct zip_entry *found = NULL;
    for (size_t i = 0; i < zip->count; i++) {
        found = text_equal(zip->entries[i].name, name) ? &zip->entries[i] : found;
    }
    return found;
}

static void assert_holds(struct job *job, const struct zip *zip, const char *name, const void *data, size_t size)
{
    const struct zip_entry *entry = find(zip, name);
    assert_non_null(entry);
    assert_int_equal(entry->size, size);
    struct bytes bytes = zip_unpack(job, zip, entry, size);
    assert_int_equal(bytes.size, size);
    assert_memory_equal(bytes.data, data, size);
    if (!entry->is_packed) {
        zip_verify(job, zip, entry);
    }
    assert_true(job_ok(job));
    if (size) {
        struct job less = {0};
        bytes = zip_unpack(&less, zip, entry, size - 1);
        assert_true(!bytes.data && !bytes.size);
        assert_fails(job_close(&less, NULL, NULL), CONUS_ERROR_MEMORY);
    }
}

static void build(struct zip_builder *builder)
{
    zip_add(builder, "z/packed", text, TEXT_BYTES, true);
    zip_add(builder, "z/", "", 0, false);
    zip_add(builder, "b", text, TEXT_BYTES, false);
    zip_add(builder, "none", "", 0, true);
    zip_end(builder);
}

static void every_kind_of_archive(void **state)
{
    (void)state;
    for (int kind = 0; kind < 4; kind++) {
        struct zip_builder builder = {.wide = kind % 2, .behind = kind / 2};
        struct job job = {0};
        build(&builder);
        assert_true(zip_is((const uint8_t *)builder.bytes.data, builder.bytes.size));
        const struct zip zip = parse(&job, &builder.bytes);
        assert_int_equal(zip.count, 3); /* the folder is none */
        assert_true(text_equal(zip.entries[0].name, "b"));
        assert_holds(&job, &zip, "b", text, TEXT_BYTES);
        assert_holds(&job, &zip, "z/packed", text, TEXT_BYTES);
        assert_holds(&job, &zip, "none", "", 0);
        assert_null(find(&zip, "z"));
        assert_ok(job_close(&job, NULL, NULL));
        buffer_finish(&builder.bytes);
    }
}

static void an_empty_archive_and_no_archive(void **state)
{
    (void)state;
    struct zip_builder builder = {0};
    struct job job = {0};
    zip_end(&builder);
    assert_true(zip_is((const uint8_t *)builder.bytes.data, builder.bytes.size));
    struct zip zip = parse(&job, &builder.bytes);
    assert_int_equal(zip.count, 0);
    assert_true(job_ok(&job));
    buffer_finish(&builder.bytes);
    assert_false(zip_is((const uint8_t *)"PK", 2));
    assert_false(zip_is((const uint8_t *)"PACK", 4));
    zip = zip_parse(&job, (const uint8_t *)text, TEXT_BYTES);
    assert_int_equal(zip.count, 0);
    assert_fails(job_close(&job, NULL, NULL), CONUS_ERROR_DATA);
}

/* A comment behind the end record belongs to the archive; other bytes there do not. */
static void remarks(void **state)
{
    (void)state;
    struct zip_builder builder = {0};
    struct job job = {0};
    build(&builder);
    builder.bytes.data[builder.bytes.size - 2] = 5;
    buffer_text(&builder.bytes, "PK\x05\x06!");
    const struct zip zip = parse(&job, &builder.bytes);
    assert_holds(&job, &zip, "b", text, TEXT_BYTES);
    buffer_text(&builder.bytes, "x");
    parse(&job, &builder.bytes);
    assert_fails(job_close(&job, NULL, NULL), CONUS_ERROR_DATA);
    buffer_finish(&builder.bytes);
}

enum place { IN_HEADER, IN_CENTRAL, IN_END, IN_END64 };

/* Changes these bytes of an archive of two files. Parsing or unpacking must fail with this message. */
static void assert_bent(struct zip_builder builder, bool packed, enum place place, size_t at, const char *bytes,
                        size_t size, const char *part)
{
    struct job job = {0};
    zip_add(&builder, "before", text, TEXT_BYTES, false);
    zip_add(&builder, "file", text, TEXT_BYTES, packed);
    zip_end(&builder);
    size_t end = builder.bytes.size - 22;
    size_t from = place == IN_HEADER    ? builder.header_at
                  : place == IN_CENTRAL ? builder.central_at
                  : place == IN_END     ? end
                                        : end - 20 - 56;
    memcpy(builder.bytes.data + from + at, bytes, size);
    const struct zip zip = parse(&job, &builder.bytes);
    if (job_ok(&job)) {
        zip_unpack(&job, &zip, find(&zip, "file"), 1 << 20);
    }
    conus_status status = job_close(&job, NULL, NULL);
    if (!status || !strstr(conus_message(), part)) {
        fail_msg("place %d, byte %zu: \"%s\" and not \"%s\"", (int)place, at, status ? conus_message() : "", part);
    }
    buffer_finish(&builder.bytes);
}

/* Offsets by APPNOTE.TXT, 4.3.7 (header), 4.3.12 (central directory), 4.3.16 (end), 4.3.14 and 4.3.15 (ZIP64). */
static void records_that_lie(void **state)
{
    (void)state;
    const struct zip_builder plain = {0};
    const struct zip_builder wide = {.wide = true};
    const struct zip_builder behind = {.behind = true};
    assert_bent(plain, false, IN_HEADER, 0, "QK", 2, "file: no header");
    assert_bent(plain, false, IN_HEADER, 6, "\1", 1, "differ");
    assert_bent(plain, false, IN_HEADER, 8, "\10", 1, "differ");
    assert_bent(plain, false, IN_HEADER, 14, "????", 4, "differ");
    assert_bent(plain, false, IN_HEADER, 18, "\1", 1, "differ");
    assert_bent(plain, true, IN_HEADER, 22, "\1", 1, "differ");
    assert_bent(plain, false, IN_HEADER, 26, "\3", 1, "differ");
    assert_bent(plain, false, IN_HEADER, 28, "\377\377", 2, "reaches into");
    assert_bent(plain, false, IN_HEADER, 30, "F", 1, "differ");
    assert_bent(plain, false, IN_HEADER, 34, "S", 1, "file: damaged: its checksum");
    assert_bent(plain, true, IN_HEADER, 34, "\6", 1, "file: damaged, or");
    assert_bent(behind, false, IN_HEADER, 34, "S", 1, "its checksum");
    assert_bent(plain, false, IN_CENTRAL, 0, "QK", 2, "fewer files");
    assert_bent(plain, false, IN_CENTRAL, 8, "\1", 1, "file: encrypted");
    assert_bent(plain, false, IN_CENTRAL, 8, "\100", 1, "file: encrypted");
    assert_bent(plain, false, IN_CENTRAL, 9, "\40", 1, "file: encrypted");
    assert_bent(plain, false, IN_CENTRAL, 8, "\40", 1, "method 0");
    assert_bent(plain, false, IN_CENTRAL, 10, "\14", 1, "file: packed by method 12");
    assert_bent(plain, false, IN_CENTRAL, 20, "\1", 1, "file: 1 bytes cannot be 47");
    assert_bent(plain, false, IN_CENTRAL, 24, "\1", 1, "file: 47 bytes cannot be 1");
    assert_bent(plain, true, IN_CENTRAL, 26, "\377", 1, "bytes cannot be 16711727"); /* 0xff002f */
    assert_bent(behind, true, IN_CENTRAL, 24, "\60", 1, "does not unpack to 48 bytes");
    assert_bent(behind, true, IN_CENTRAL, 24, "\56", 1, "does not unpack to 46 bytes");
    assert_bent(behind, false, IN_CENTRAL, 20, "\377\377\0\0\377\377", 6, "reaches into");
    assert_bent(plain, false, IN_CENTRAL, 28, "\377", 1, "fewer files");
    assert_bent(plain, false, IN_CENTRAL, 42, "\377\377\377\176", 4, "file: no header");
    assert_bent(plain, false, IN_CENTRAL, 42, "\377\377\377\377", 4, "ZIP64 are needed");
    assert_bent(wide, false, IN_CENTRAL, 46 + 4 + 5 + 2, "\20", 1, "ZIP64 are needed"); /* two numbers for three */
    assert_bent(wide, false, IN_CENTRAL, 46 + 4 + 2, "\377", 1, "ZIP64 are needed");    /* the field before it */
    assert_bent(wide, false, IN_CENTRAL, 46 + 4 + 5 + 4 + 7, "\1", 1, "cannot be");     /* an exabyte */
    assert_bent(wide, false, IN_CENTRAL, 46 + 4 + 5 + 4 + 23, "\377", 1, "no header");
    assert_bent(plain, false, IN_END, 4, "\1", 1, "one part of several");
    assert_bent(plain, false, IN_END, 8, "\1", 1, "one part of several");
    assert_bent(plain, false, IN_END, 8, "\1\0\1\0", 4, "behind the last file");
    assert_bent(plain, false, IN_END, 8, "\3\0\3\0", 4, "3 files in a central directory of 102 bytes");
    assert_bent(plain, false, IN_END, 12, "\1", 1, "it ends at byte");
    assert_bent(plain, false, IN_END, 16, "\1", 1, "it ends at byte");
    assert_bent(plain, false, IN_END, 15, "\377", 1, "it ends at byte");
    assert_bent(wide, false, IN_END64, 0, "QK", 2, "ZIP64 record");
    assert_bent(wide, false, IN_END64, 4, "\1", 1, "ZIP64 record");
    assert_bent(wide, false, IN_END64, 24, "\1", 1, "one part of several");
    assert_bent(wide, false, IN_END64, 47, "\377", 1, "it ends at byte");
    assert_bent(wide, false, IN_END64, 55, "\377", 1, "it ends at byte");
    assert_bent(wide, false, IN_END64, 56 + 4, "\1", 1, "one part of several");
    assert_bent(wide, false, IN_END64, 56 + 15, "\377", 1, "ZIP64 record");
}

static void assert_refused(const char *first, const char *second, const char *part)
{
    struct zip_builder builder = {0};
    struct job job = {0};
    zip_add(&builder, first, "1", 1, false);
    zip_add(&builder, second, "2", 1, false);
    zip_end(&builder);
    parse(&job, &builder.bytes);
    assert_fails(job_close(&job, NULL, NULL), CONUS_ERROR_DATA);
    if (!strstr(conus_message(), part)) {
        fail_msg("%s, %s: %s", first, second, conus_message());
    }
    buffer_finish(&builder.bytes);
}

static void names(void **state)
{
    (void)state;
    static const char *const bad[] = {"",     "/a",   "../a", "a/../b", "a/..", "..",    ".",     "./a",
                                      "a//b", "a\\b", "C:/a", "a\nb",   "//",   "a/b//", "a\177", "\xff"};
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        assert_refused("good", bad[i], "a file's name is absolute");
    }
    assert_refused("a/b", "a/b", "a/b: there are two");
    assert_refused("a/", "a/", "two");
    assert_refused("a", "folder/", "folder/: a folder with bytes");
}

/* Two entries of the directory share one header: a bomb that is unpacked again and again. */
static void files_that_overlap(void **state)
{
    (void)state;
    struct zip_builder builder = {0};
    struct job job = {0};
    zip_add(&builder, "same", text, TEXT_BYTES, false);
    struct buffer entry = builder.directory;
    builder.directory = (struct buffer){0};
    for (builder.count = 0; builder.count < 2; builder.count++) {
        buffer_append(&builder.directory, entry.data, entry.size);
    }
    buffer_finish(&entry);
    zip_end(&builder);
    parse(&job, &builder.bytes);
    assert_fails(job_close(&job, NULL, NULL), CONUS_ERROR_DATA);
    assert_non_null(strstr(conus_message(), "two files share the byte 0"));
    buffer_finish(&builder.bytes);
}

static void every_prefix(void **state)
{
    (void)state;
    for (int kind = 0; kind < 2; kind++) {
        struct zip_builder builder = {.wide = kind};
        build(&builder);
        for (size_t size = 0; size < builder.bytes.size; size++) {
            struct job job = {0};
            uint8_t *exact = memory_copy(builder.bytes.data, size, 1); /* sanitizers notice one byte too many */
            zip_parse(&job, exact, size);
            assert_fails(job_close(&job, NULL, NULL), CONUS_ERROR_DATA);
            memory_free(exact);
        }
        buffer_finish(&builder.bytes);
    }
}

static conus_status attempt(void *data)
{
    struct job job = {0};
    const struct zip zip = parse(&job, data);
    const struct zip_entry *entry = find(&zip, "z/packed");
    if (entry) {
        zip_unpack(&job, &zip, entry, TEXT_BYTES);
    }
    return job_close(&job, NULL, NULL);
}

static void every_allocation_and_primitive(void **state)
{
    (void)state;
    struct zip_builder builder = {0};
    build(&builder);
    test_every_allocation(attempt, &builder.bytes);
    assert_true(test_every_primitive(attempt, &builder.bytes) > 3);
    buffer_finish(&builder.bytes);
}

TEST_GROUP(zip)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_kind_of_archive),
        cmocka_unit_test(an_empty_archive_and_no_archive),
        cmocka_unit_test(remarks),
        cmocka_unit_test(records_that_lie),
        cmocka_unit_test(names),
        cmocka_unit_test(files_that_overlap),
        cmocka_unit_test(every_prefix),
        cmocka_unit_test(every_allocation_and_primitive),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
