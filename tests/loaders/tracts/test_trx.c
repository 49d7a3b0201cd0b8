/* SPDX-License-Identifier: BSD-3-Clause */
/* TRX: archives, folders, groups, memory. tests/corpus/trx/ has every type, and contradictions. */
#include "loaders/tracts/tracts.h"

#include "base/memory.h"
#include "builders/zip_builder.h"
#include "sources/source.h"
#include "test.h"
#include "tract_scene.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

struct file {
    const char *name;
    const void *data;
    size_t size;
};

#define TEXT_FILE(name, text)                                                                                          \
    {                                                                                                                  \
        name, text, sizeof(text) - 1                                                                                   \
    }
#define DATA_FILE(name, array)                                                                                         \
    {                                                                                                                  \
        name, array, sizeof(array)                                                                                     \
    }

/* Three streamlines, of 2, 0 and 3 points. */
static const char header[] = "{\"DIMENSIONS\": [10, 20, 30], \"NB_STREAMLINES\": 3, \"NB_VERTICES\": 5,"
                             " \"VOXEL_TO_RASMM\": [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]}";
static const float points[15] = {0, 0.5F, 1, 1.5F, 2, 2.5F, -3, 3.5F, 4, 4.5F, -5, 5.5F, 6, 6.5F, 7};
static const uint64_t offsets[4] = {0, 2, 2, 5};
static const uint32_t left_group[2] = {0, 2};
static const uint32_t other_group[4] = {2, 1, 2, 0}; /* not in order, one twice */
static const int16_t algorithm[3] = {-1, 0, 300};
static const uint16_t weights[6] = {0x3c00, 0x4000, 0xbc00, 0x7c00, 0x7e00, 0x0001}; /* 1, 2, -1, inf, NaN, 2^-24 */
static const double anisotropy[5] = {0.5, 0.25, 1e-3, 1, 0};
static const uint8_t colours[15] = {255, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13};

enum { FILES = 11 };

static const struct file standard[FILES] = {
    TEXT_FILE("header.json", header),
    DATA_FILE("positions.3.float32", points),
    DATA_FILE("offsets.uint64", offsets),
    DATA_FILE("groups/AF_L.uint32", left_group),
    DATA_FILE("groups/other.uint32", other_group),
    DATA_FILE("dps/algo.int16", algorithm),
    DATA_FILE("dps/weight.x.2.float16", weights),
    DATA_FILE("dpv/fa.float64", anisotropy),
    DATA_FILE("dpv/colour.3.uint8", colours),
    TEXT_FILE("dpg/AF_L/volume.uint32", "1234"),
    TEXT_FILE("dps/algo.json", "{}"),
};

static void build(struct buffer *out, const struct file *files, size_t count, bool packed)
{
    struct zip_builder builder = {0};
    for (size_t i = 0; i < count; i++) {
        if (files[i].name) {
            zip_add(&builder, files[i].name, files[i].data, files[i].size, packed);
        }
    }
    zip_end(&builder);
    *out = builder.bytes;
}

static bool has_note(const struct notes *notes, const char *part)
{
    bool found = false;
    for (size_t i = 0; i < notes->count; i++) {
        found = found || strstr(notes->lines[i], part);
    }
    return found;
}

static void assert_points(const struct tractogram *tractogram)
{
    assert_int_equal(tractogram->point_count, 5);
    assert_int_equal(tractogram->streamline_count, 3);
    for (size_t i = 0; i < 4; i++) {
        assert_int_equal(tractogram->first[i], offsets[i]);
    }
    for (uint64_t i = 0; i < 5; i++) {
        double point[3];
        tractogram_point(point, tractogram, i);
        for (size_t a = 0; a < 3; a++) {
            assert_near(point[a], points[3 * i + a], 0);
        }
    }
}

static void assert_group(const struct tract_group *group, const char *name, const uint32_t *members, size_t count)
{
    assert_string_equal(group->name, name);
    assert_int_equal(group->count, count);
    assert_memory_equal(group->members, members, count * sizeof *members);
}

static void assert_scalar(const struct tractogram *tractogram, const char *name, bool per_point, uint32_t components,
                          const float *values, size_t count)
{
    const struct tract_scalar *scalar = NULL;
    for (size_t i = 0; i < tractogram->scalar_count; i++) {
        scalar = strcmp(tractogram->scalars[i].name, name) == 0 ? &tractogram->scalars[i] : scalar;
    }
    assert_non_null(scalar);
    assert_int_equal(scalar->per_point, per_point);
    assert_int_equal(scalar->components, components);
    for (size_t i = 0; i < count; i++) {
        assert_true(scalar->values[i] == values[i] || (isnan(values[i]) && isnan(scalar->values[i])));
    }
}

static void assert_standard(struct tractogram *tractogram, struct notes *notes)
{
    static const uint32_t all[3] = {0, 1, 2};
    static const float algo[3] = {-1, 0, 300};
    static const float weight[6] = {1, 2, -1, INFINITY, NAN, 0x1p-24F};
    static const float fa[5] = {0.5F, 0.25F, 1e-3F, 1, 0};
    static const float colour[15] = {255, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13};
    assert_points(tractogram);
    assert_int_equal(tractogram->group_count, 2);
    assert_group(&tractogram->groups[0], "AF_L", left_group, 2);
    assert_group(&tractogram->groups[1], "other", all, 3);
    assert_int_equal(tractogram->scalar_count, 4);
    assert_scalar(tractogram, "algo", false, 1, algo, 3);
    assert_scalar(tractogram, "weight.x", false, 2, weight, 6);
    assert_scalar(tractogram, "fa", true, 1, fa, 5);
    assert_scalar(tractogram, "colour", true, 3, colour, 15);
    assert_true(has_note(notes, "group 'other': 1 of its streamlines"));
    assert_true(has_note(notes, "dpg: values of groups are not read"));
    assert_true(has_note(notes, "dps/algo.json: no array that is read; there are 1 such files"));
}

static void an_archive(void **state)
{
    (void)state;
    for (int packed = 0; packed < 2; packed++) {
        struct buffer archive;
        struct tractogram tractogram;
        struct notes notes = {0};
        build(&archive, standard, FILES, packed);
        const struct bytes head = {(uint8_t *)archive.data, 4};
        assert_int_equal(format_id_of(&head, ROLE_TRACTS), FORMAT_TRX);
        assert_ok(tract_parse(&tractogram, &archive, 1 << 20, &notes));
        assert_standard(&tractogram, &notes);
        assert_string_equal(tractogram.format, packed ? "TRX, packed zip, float32" : "TRX, zip, float32");
        tractogram_finish(&tractogram);
        notes_finish(&notes);
        buffer_finish(&archive);
    }
}

static void a_file(void **state)
{
    (void)state;
    struct buffer archive;
    struct tractogram tractogram;
    struct notes notes = {0};
    char sum[65];
    build(&archive, standard, FILES, false);
    const struct bytes bytes = {(uint8_t *)archive.data, archive.size};
    const char *path = test_scratch("a.trx");
    file_sha256(sum, &bytes);
    assert_ok(file_write(path, archive.data, archive.size));
    assert_ok(tract_read(&tractogram, path, archive.size + 1000, &notes));
    assert_standard(&tractogram, &notes);
    assert_string_equal(tractogram.sha256, sum);
    tractogram_finish(&tractogram);
    notes_finish(&notes);
    assert_true(tract_file_is(path));
    assert_ok(file_write(test_scratch("a.zip"), archive.data, archive.size));
    assert_false(tract_file_is(test_scratch("a.zip")));
    assert_ok(tract_read(&tractogram, test_scratch("a.zip"), 0, &notes));
    assert_string_equal(tractogram.path, test_scratch("a.zip"));
    tractogram_finish(&tractogram);
    notes_finish(&notes);
    notes = (struct notes){0};
    path = test_scratch("a.trx");
    assert_fails(tract_read(&tractogram, path, archive.size - 1, &notes), CONUS_ERROR_MEMORY);
    assert_fails(tract_read(&tractogram, test_scratch("none.trx"), 1000, &notes), CONUS_ERROR_IO);
    buffer_finish(&archive);
}

static void write_folder(const char *name)
{
    static const char *const folders[] = {"dps", "dpv", "dpg", "groups", "dpg/AF_L"};
    test_folder(name);
    for (size_t i = 0; i < sizeof folders / sizeof folders[0]; i++) {
        assert_ok(file_make_folder(test_in(folders[i])));
    }
    for (size_t i = 0; i < FILES; i++) {
        assert_ok(file_write_soon(test_in(standard[i].name), standard[i].data, standard[i].size));
    }
}

static void a_folder(void **state)
{
    (void)state;
    struct tractogram tractogram;
    struct notes notes = {0};
    struct file_sums files = {0};
    const struct format *format;
    write_folder("folder.trx");
    assert_ok(source_find(&format, test_scratch("folder.trx"), ROLE_TRACTS));
    assert_int_equal(format->id, FORMAT_TRX);
    assert_true(tract_file_is(test_scratch("folder.trx")));
    assert_ok(source_find(&format, test_in("dps"), ROLE_TRACTS));
    assert_null(format);
    struct job job = {0};
    tract_file_read(&job, &tractogram, test_scratch("folder.trx"), CONUS_FILE_SPACE_AS_STATED);
    assert_ok(job_close(&job, &notes, &files));
    assert_standard(&tractogram, &notes);
    assert_string_equal(tractogram.format, "TRX, folder, float32");
    assert_string_equal(tractogram.sha256, "");
    assert_true(files.count > 2 && strlen(files.items[0].sha256) == 64);
    assert_non_null(strstr(files.items[0].path, "folder.trx/header.json"));
    file_sums_finish(&files);
    tractogram_finish(&tractogram);
    notes_finish(&notes);
    assert_fails(tract_read(&tractogram, test_scratch("folder.trx"), 60, &notes), CONUS_ERROR_MEMORY);
    assert_fails(tract_read(&tractogram, test_in("dps"), 1 << 20, &notes), CONUS_ERROR_IO);
    assert_non_null(strstr(conus_message(), "dps: cannot read: is a folder"));
}

static void a_member_out_of_range(void **state)
{
    (void)state;
    static const uint32_t members[] = {0, 3};
    const struct file files[] = {standard[0], standard[1], standard[2], DATA_FILE("groups/far.uint32", members)};
    struct buffer archive;
    struct tractogram tractogram;
    build(&archive, files, 4, false);
    assert_fails(tract_parse(&tractogram, &archive, 1 << 20, NULL), CONUS_ERROR_DATA);
    assert_non_null(strstr(conus_message(), "group 'far': found streamline 3"));
    buffer_finish(&archive);
}

/* The limit follows from the sizes of the arrays above: the archive; 32 bytes of first; groups of 8 and 16; 3 + 6 + 5 +
 * 15 floats. Packed ones take their bytes beside the archive, the positions to the end. */
static void memory_has_a_limit(void **state)
{
    (void)state;
    const size_t arrays = 4 * sizeof(uint64_t) + 6 * sizeof(uint32_t) + 29 * sizeof(float);
    for (int packed = 0; packed < 2; packed++) {
        struct buffer archive;
        struct tractogram tractogram;
        struct notes notes = {0};
        build(&archive, standard, FILES, packed);
        size_t needed = archive.size + arrays + (packed ? sizeof points : 0);
        assert_fails(tract_parse(&tractogram, &archive, needed - 1, &notes), CONUS_ERROR_MEMORY);
        assert_non_null(strstr(conus_message(), "--max-memory"));
        assert_ok(
            tract_parse(&tractogram, &archive, needed + (packed ? 200 : 0), &notes)); /* header.json, for a while */
        tractogram_finish(&tractogram);
        notes_finish(&notes);
        buffer_finish(&archive);
    }
}

static void every_prefix(void **state)
{
    (void)state;
    struct buffer archive;
    struct tractogram tractogram;
    build(&archive, standard, FILES, true);
    for (size_t size = 0; size < archive.size; size++) {
        struct buffer prefix = {.data = archive.data, .size = size};
        assert_fails(tract_parse(&tractogram, &prefix, 1 << 20, NULL), CONUS_ERROR_DATA);
    }
    buffer_finish(&archive);
}

static conus_status attempt(void *data)
{
    struct tractogram tractogram = {0};
    struct notes notes = {0};
    conus_status status = tract_read(&tractogram, data, 1 << 20, &notes);
    tractogram_finish(&tractogram);
    notes_finish(&notes);
    return status;
}

static void every_allocation(void **state)
{
    (void)state;
    char path[4096];
    struct buffer archive;
    build(&archive, standard, FILES, true);
    snprintf(path, sizeof path, "%s", test_scratch("memory.trx"));
    assert_ok(file_write(path, archive.data, archive.size));
    test_every_allocation(attempt, path);
    write_folder("memory");
    snprintf(path, sizeof path, "%s", test_scratch("memory"));
    test_every_allocation(attempt, path);
    buffer_finish(&archive);
}

TEST_GROUP(trx)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(an_archive),         cmocka_unit_test(a_file),
        cmocka_unit_test(a_folder),           cmocka_unit_test(a_member_out_of_range),
        cmocka_unit_test(memory_has_a_limit), cmocka_unit_test(every_prefix),
        cmocka_unit_test(every_allocation),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
