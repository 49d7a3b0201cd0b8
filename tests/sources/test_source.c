/* SPDX-License-Identifier: BSD-3-Clause */
/* Files that are opened and known by their first bytes, in each role. */
#include "sources/source.h"

#include "loaders/volumes/volumes.h"
#include "test.h"

#include <stdio.h>
#include <string.h>

#define BYTES(text) (text), sizeof(text) - 1

static const char *write_file(const char *name, const char *data, size_t size, bool packs)
{
    const char *path = test_scratch(name);
    struct job job = {0};
    const struct bytes packed = packs ? gzip_format(&job, data, size) : (struct bytes){0};
    assert_ok(file_write_soon(path, packs ? (const char *)packed.data : data, packs ? packed.size : size));
    job_end(&job);
    return path;
}

/* The id of the row that has the role; -1 where there is none. */
static int id_of(const char *path, unsigned role)
{
    const struct format *format;
    assert_ok(source_find(&format, path, role));
    assert_true(!format || !role || (format->roles & role));
    return format ? (int)format->id : -1;
}

/* The same bytes are another thing, or nothing, in each role, packed or not. */
static void a_role_decides_what_bytes_are(void **state)
{
    (void)state;
    static const struct {
        const char *data;
        size_t size;
        unsigned role;
        int id;
    } files[] = {
        {BYTES("\x89HDF\r\n\x1a\n\0"), ROLE_VOLUME, FORMAT_HDF5},
        {BYTES("\x89HDF\r\n\x1a\n\0"), ROLE_TRANSFORM, FORMAT_HDF5},
        {BYTES("\x89HDF\r\n\x1a\n\0"), ROLE_POSES, FORMAT_HDF5},
        {BYTES("\x89HDF\r\n\x1a\n\0"), ROLE_SURFACE, -1},
        {BYTES("MATLAB 5.0 MAT-file, Platform"), ROLE_POSES, FORMAT_MATLAB},
        {BYTES("MATLAB 5.0 MAT-file, Platform"), ROLE_VOLUME, -1},
        {BYTES("# by hand\n1 0 0 0\n"), ROLE_TRANSFORM, FORMAT_MATRIX},
        {BYTES("# by hand\n1 0 0 0\n"), ROLE_SURFACE, -1},
        {BYTES("#Insight Transform File V1.0\n"), ROLE_TRANSFORM, FORMAT_ITK},
        {BYTES("MNI Transform File\n"), ROLE_TRANSFORM, FORMAT_XFM},
        {BYTES("type      = 1\n"), ROLE_TRANSFORM, FORMAT_LTA},
        {BYTES("type      : 1\n"), ROLE_TRANSFORM, -1},
        {BYTES("bert\n1\n1\n0.15\n1 0 0 0\n"), ROLE_TRANSFORM, FORMAT_REGISTER},
        {BYTES("bert\n1\n1\n0.15\nround\n"), ROLE_TRANSFORM, -1},
        {BYTES("\0\0\0\0\14\0\0\0\1\0\0\0\0\0\0\0\4\0\0\0Aff\0"), ROLE_TRANSFORM, FORMAT_ITK_MATLAB},
        {BYTES("MATLAB 5.0 MAT-file, Platform"), ROLE_TRANSFORM, FORMAT_OTHER},
        {BYTES("// elastix\n(Transform \"Euler\")"), ROLE_TRANSFORM, FORMAT_OTHER},
        {BYTES("NRRD0004\nkinds: vector domain\n"), ROLE_TRANSFORM, FORMAT_NRRD},
        {BYTES("NRRD0004\n"), ROLE_TRANSFORM, -1},
        {BYTES("# vtk DataFile Version 3.0\n"), ROLE_SURFACE, FORMAT_VTK},
        {BYTES("# vtk DataFile Version 3.0\n"), ROLE_TRACTS, FORMAT_VTK},
        {BYTES("# vtk DataFile Version 3.0\n"), ROLE_VOLUME, -1},
        {BYTES("PK\3\4\x14\0"), ROLE_TRACTS, FORMAT_TRX},
        {BYTES("PK\3\4\x14\0"), ROLE_SCENE, -1},
        {BYTES("mrtrix tracks\ncount: 3\n"), ROLE_TRACTS, FORMAT_TCK},
        {BYTES("mrtrix tracksuit\n"), ROLE_TRACTS, -1},
        {BYTES("TRACK\1"), ROLE_TRACTS, FORMAT_TRK},
        {BYTES("\x5c\1\0\0"), ROLE_VOLUME, FORMAT_NIFTI}, /* 348: ANALYZE */
        {BYTES("\x5c\1\0\0"), ROLE_SURFACE, -1},
        {BYTES("NRRD0004\n"), ROLE_VOLUME, FORMAT_NRRD},
        {BYTES("<GIFTI>"), ROLE_VERTEX_LABELS, FORMAT_GIFTI},
        {BYTES("#!ascii label, x\n"), ROLE_VERTEX_LABELS, FORMAT_FREESURFER_LABEL},
        {BYTES("#!ascii label, x\n"), ROLE_SURFACE, -1},
        {BYTES("\0\0\0\0"), ROLE_SCENE, -1},
        {BYTES("<atlas>"), ROLE_SCENE, FORMAT_ATLAS_XML},
        {BYTES("{"), ROLE_SCENE, FORMAT_MANIFEST},
        {BYTES("{"), ROLE_VOLUME, -1},
    };
    for (size_t i = 0; i < sizeof files / sizeof files[0]; i++) {
        for (int packs = 0; packs < 2; packs++) {
            const char *path = write_file("any", files[i].data, files[i].size, packs);
            if (id_of(path, files[i].role) != files[i].id) {
                fail_msg("file %zu is %d, not %d", i, id_of(path, files[i].role), files[i].id);
            }
        }
    }
}

static void folders_are_of_formats_too(void **state)
{
    (void)state;
    test_folder("folder.obj"); /* a name is none of a file's */
    assert_int_equal(id_of(test_in(""), ROLE_VOLUME), -1);
    assert_int_equal(id_of(test_in(""), ROLE_SURFACE), -1);
    assert_ok(file_write_soon(test_in(".zattrs"), "{}", 2));
    assert_int_equal(id_of(test_in(""), ROLE_VOLUME), FORMAT_ZARR);
    assert_int_equal(id_of(test_in(""), ROLE_TRACTS), -1);
    assert_ok(file_write_soon(test_in("header.json"), "{}", 2));
    assert_int_equal(id_of(test_in(""), ROLE_TRACTS), FORMAT_TRX);
    struct job job = {0};
    assert_null(source_open(&job, test_in("")));
    assert_int_equal(job.status, CONUS_ERROR_IO);
    job_end(&job);
}

static void what_cannot_be_read_is_of_no_format(void **state)
{
    (void)state;
    struct source source;
    const char *absent = test_scratch("absent.obj");
    assert_int_equal(id_of(absent, ROLE_SURFACE), -1);
    assert_ok(source_open_atlas(&source, absent)); /* its reader says why */
    assert_false(source.is_open);
    assert_int_equal(source_scene(&source), FORMAT_OTHER);
    source_close(&source);
    const char *damaged = write_file("damaged", "\x1f\x8b\x08\0\xff\xff\xff\xff\xff\xff\xff\xff", 12, false);
    struct job job = {0};
    const struct source *opened = source_open(&job, damaged);
    assert_non_null(opened);
    assert_true(opened->is_packed);
    assert_int_equal(opened->head.bytes.size, 0);
    assert_int_equal(opened->stored.size, 12);
    assert_ok(job_close(&job, NULL, NULL));
}

/* XML and JSON are read unpacked only. */
static void an_atlas_names_others_only_where_it_is_not_packed(void **state)
{
    (void)state;
    static const char *const texts[] = {" {\"conus_atlas\": 1}", "<atlas>"};
    static const int ids[] = {FORMAT_MANIFEST, FORMAT_ATLAS_XML};
    for (int i = 0; i < 2; i++) {
        for (int packs = 0; packs < 2; packs++) {
            struct source source;
            const char *path = write_file("atlas", texts[i], strlen(texts[i]), packs);
            assert_ok(source_open_atlas(&source, path));
            assert_string_equal(source.head.path, path);
            assert_int_equal(source_scene(&source), packs ? FORMAT_OTHER : ids[i]);
            assert_int_equal(source_first(&source), packs ? '\0' : "{<"[i]);
            source_close(&source);
        }
    }
    struct source source;
    char given[256];
    snprintf(given, sizeof given, "%s,map=1", write_file("atlas", "<atlas>", 7, false));
    assert_ok(source_open_atlas(&source, given)); /* no CIFTI labels: there is no such file */
    assert_false(source.is_open);
    source_close(&source);
}

/* Readers take turns, each from the beginning; a folder or an absent file fails without its path, which is a place. */
static void a_source_is_read_unpacked_by_any_number_of_readers(void **state)
{
    (void)state;
    for (int packs = 0; packs < 2; packs++) {
        struct job job = {0};
        const char *path = write_file("twice.off", "OFF\n3 1 0\n", 10, packs);
        struct source *source = source_open(&job, path);
        assert_non_null(source);
        assert_int_equal(source->is_packed, packs);
        assert_int_equal(format_find(&source->head, ROLE_SURFACE)->id, FORMAT_OFF);
        struct reader first = source_reader(&job, source);
        struct reader second = source_reader(&job, source);
        struct text word;
        assert_true(reader_word(&first, &word) && text_equal(word, "OFF"));
        assert_true(reader_word(&first, &word) && text_equal(word, "3"));
        assert_true(reader_word(&second, &word) && text_equal(word, "OFF"));
        source_made_of(&job, source);
        assert_int_equal(job.files.count, 1);
        const struct bytes stored = source_bytes(&job, source, UINT64_MAX);
        char sha256[65];
        file_sha256(sha256, &stored);
        assert_string_equal(job.files.items[0].sha256, sha256);
        struct source *copy = source_of_memory(&job, NULL, (struct text){(char *)stored.data, stored.size});
        assert_int_equal(copy->is_packed, packs);
        struct reader third = source_reader(&job, copy);
        assert_true(reader_word(&third, &word) && text_equal(word, "OFF"));
        assert_string_equal(source_sum(&job, copy), sha256);
        assert_ok(job_close(&job, NULL, NULL));
    }
    struct job job = {0};
    assert_null(source_open(&job, test_scratch("absent.obj")));
    assert_null(source_reader(&job, NULL).source);
    assert_int_equal(job.status, CONUS_ERROR_IO);
    assert_null(strstr(job.message, "absent.obj"));
    job_end(&job);
}

/* The sum of a large file, which is read beside it; who asks for none does not wait, nor leave a thread. */
static void a_sum_is_made_ahead(void **state)
{
    (void)state;
    struct buffer bytes = {0};
    for (size_t i = 0; i < 300000; i++) {
        buffer_format(&bytes, "%zu ", i);
    }
    const char *path = write_file("large", bytes.data, bytes.size, false);
    char sha256[65];
    file_sha256(sha256, &(const struct bytes){(uint8_t *)bytes.data, bytes.size});
    for (int asks = 0; asks < 2; asks++) {
        struct job job = {0};
        struct source *source = source_open(&job, path);
        source_sum_ahead(source);
        struct reader r = source_reader(&job, source);
        reader_skip(&r, bytes.size);
        assert_string_equal(asks ? source_sum(&job, source) : sha256, sha256);
        assert_ok(job_close(&job, NULL, NULL));
    }
    source_sum_ahead(NULL);
    buffer_finish(&bytes);
}

static conus_status open_on_a_job(void *path)
{
    struct job job = {0};
    struct source *source = source_open(&job, path);
    struct reader r = source_reader(&job, source);
    assert_true(reader_has(&r, 1) == job_ok(&job));
    if (job_ok(&job)) {
        source_made_of(&job, source);
    }
    return job_close(&job, NULL, NULL);
}

static conus_status open_and_ask(void *path)
{
    struct source source;
    const struct format *format = NULL;
    conus_status status = source_open_atlas(&source, path);
    source_close(&source);
    return status ? status : source_find(&format, path, ROLE_SURFACE);
}

static conus_status ask_on_a_job(void *path)
{
    struct job job = {0};
    const struct format *format = source_format(&job, path, ROLE_SURFACE);
    assert_true(job_ok(&job) ? format->id == FORMAT_GIFTI : !format);
    return job_close(&job, NULL, NULL);
}

static void every_failing_allocation(void **state)
{
    (void)state;
    char path[256];
    snprintf(path, sizeof path, "%s", write_file("packed.gii.gz", "<GIFTI>", 7, true));
    test_every_allocation(open_and_ask, path);
    test_every_allocation(ask_on_a_job, path);
    test_every_allocation(open_on_a_job, path);
}

TEST_GROUP(source)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_role_decides_what_bytes_are),
        cmocka_unit_test(folders_are_of_formats_too),
        cmocka_unit_test(what_cannot_be_read_is_of_no_format),
        cmocka_unit_test(an_atlas_names_others_only_where_it_is_not_packed),
        cmocka_unit_test(a_source_is_read_unpacked_by_any_number_of_readers),
        cmocka_unit_test(a_sum_is_made_ahead),
        cmocka_unit_test(every_failing_allocation),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
