/* SPDX-License-Identifier: BSD-3-Clause */
/* CIFTI files of labels: what their kind is called, damage inside the XML, limits. tests/corpus/cifti/ has files that
 * are read, and every contradiction. */
#include "loaders/cifti/cifti.h"

#include "builders/cifti_builder.h"
#include "builders/nifti_builder.h"
#include "loaders/refuse.h"
#include "loaders/surfaces/surfaces.h"
#include "loaders/volumes/volumes.h"
#include "sources/source.h"
#include "test.h"
#include "tests/support/mesh_on_job.h"
#include "volume_on_job.h"

#include <stdio.h>
#include <string.h>

static const char *nearest_words(const struct bytes *bytes)
{
    const struct file_head head = head_of(NULL, bytes);
    return format_nearest(&head)->words;
}

static const uint64_t MEMORY = 1 << 20;

static conus_status read_bytes(const struct buffer *file)
{
    const struct bytes bytes = {(uint8_t *)file->data, file->size};
    struct job job = {.max_memory = MEMORY};
    const struct cifti_choice *choice = cifti_choose(&job, &bytes, text_from("0"));
    assert_int_equal(choice != NULL, job_ok(&job));
    return job_close(&job, NULL, NULL);
}

/* The other contradictions: tests/corpus/cifti. With these two the file is not taken for one of CIFTI's labels. */
static void what_is_no_file_of_labels_is_refused(void **state)
{
    (void)state;
    static const struct {
        struct cifti_spec spec;
        const char *message;
    } cases[] = {
        {{.field = "magic", .index = 1, .value = 'i'}, "not a CIFTI-2 file: a single NIfTI-2 file of an intent_code"},
        {{.find = "TYPE_LABELS", .replace = "TYPE_SCALARS"},
         "XML: line 4: IndicesMapToDataType: found \"CIFTI_INDEX_TYPE_SCALARS\""}};
    for (size_t i = 0; i < 2; i++) {
        struct buffer bytes = {0};
        cifti_build(&bytes, &cases[i].spec);
        assert_true(read_bytes(&bytes) != CONUS_OK);
        assert_non_null(strstr(conus_message(), cases[i].message));
        buffer_finish(&bytes);
    }
}

/* XML that ends early has unclosed elements, whatever follows. */
static void every_prefix_of_the_xml_is_refused(void **state)
{
    (void)state;
    struct buffer bytes = {0};
    cifti_build(&bytes, &(struct cifti_spec){0});
    const char *start = memmem(bytes.data, bytes.size, "<?xml", 5);
    char *end = memmem(bytes.data, bytes.size, "</CIFTI>", 8);
    assert_true(start && end);
    for (char *at = end + 7; at >= start; at--) {
        *at = '\0';
        assert_fails(read_bytes(&bytes), CONUS_ERROR_DATA);
    }
    buffer_finish(&bytes);
}

/* Opens a file; *map is the one that is chosen. */
static conus_status open_file(size_t *map, const char *path, uint64_t max_memory)
{
    struct job job = {.max_memory = max_memory};
    const struct cifti_file *file = cifti_file_open(&job, path);
    assert_int_equal(file != NULL, job_ok(&job));
    if (file) {
        *map = file->choice->map;
        assert_int_equal(strlen(file->sha256), 64);
        assert_null(strstr(file->path, ",map"));
    }
    return job_close(&job, NULL, NULL);
}

static conus_status use_file(void *data)
{
    struct job job = {0};
    const struct cifti_file *file = cifti_file_open(&job, data);
    if (file) {
        const struct cifti *cifti = &file->choice->cifti;
        (void)cifti_voxels(&job, labels_new(&job), file->choice);
        for (size_t i = 0; i < cifti->model_count; i++) {
            if (cifti->models[i].is_surface) {
                (void)cifti_vertices(&job, labels_new(&job), file->choice, &cifti->models[i]);
            }
        }
    }
    return job_close(&job, NULL, NULL);
}

static void files_are_plain_or_packed(void **state)
{
    (void)state;
    struct buffer bytes = {0};
    char path[300];
    cifti_build(&bytes, &(struct cifti_spec){0});
    for (int packed = 0; packed < 2; packed++) {
        size_t map = 0;
        struct source source;
        snprintf(path, sizeof path, "%s,map=two", (packed ? write_packed : write_bytes)("x.dlabel.nii", &bytes));
        assert_ok(source_open_atlas(&source, path));
        assert_int_equal(source_scene(&source), FORMAT_CIFTI);
        source_close(&source);
        assert_ok(open_file(&map, path, 0));
        assert_int_equal(map, 1);
        assert_fails(open_file(&map, path, 100), CONUS_ERROR_MEMORY);
        test_every_allocation(use_file, path);
        assert_true(test_every_primitive(use_file, path) > 50);
    }
    struct source source;
    size_t map;
    assert_ok(source_open_atlas(&source, "absent.dlabel.nii"));
    assert_false(source.is_open);
    assert_int_equal(source_scene(&source), FORMAT_OTHER);
    source_close(&source);
    snprintf(path, sizeof path, "%s,map=", test_scratch("x.dlabel.nii"));
    assert_fails(open_file(&map, path, 0), CONUS_ERROR_ARGUMENT);
    assert_non_null(strstr(conus_message(), "map: found \"\", a number from 0 or a name is needed"));
    bytes.data[bytes.size - 5] = 0x78; /* 7 becomes 3.6e34 */
    assert_fails(open_file(&map, write_bytes("x.dlabel.nii", &bytes), 0), CONUS_ERROR_DATA);
    buffer_finish(&bytes);
}

/* The first version of CIFTI gives files of labels the code of connections. */
static void the_first_version_is_named(void **state)
{
    (void)state;
    struct buffer bytes = {0};
    struct volume_file file;
    struct notes notes = {0};
    const struct cifti_spec spec = {
        .field = "intent_code", .value = 3001, .find = "Version=\"2\"", .replace = "Version=\"1.0\""};
    cifti_build(&bytes, &spec);
    const struct bytes head = {(uint8_t *)bytes.data, bytes.size};
    assert_string_equal(nearest_words(&head), "a CIFTI-1 file");
    assert_fails(volume_file_open(&file, write_bytes("x.nii", &bytes), 0, &notes), CONUS_ERROR_UNSUPPORTED);
    assert_non_null(strstr(conus_message(), "a CIFTI-1 file, allowed are volumes; convert it to CIFTI-2: wb_command "));
    buffer_finish(&bytes);
    notes_finish(&notes);
}

static void other_matrices_are_named(void **state)
{
    (void)state;
    static const struct {
        int intent_code; /* in the header, and what the XML has for columns */
        const char *columns;
        int found;
        const char *words, *way;
    } cases[] = {
        {3000, "PARCELS", 3000, "(a .plabel.nii, say)", "conus reads the .dlabel.nii of its parcels, as ATLAS"},
        {3001, "BRAIN_MODELS", 3001, "connections (.dconn.nii)", "conus has no use for connections"},
        {3002, "SERIES", 3002, "time series (.dtseries.nii)", "'wb_command -cifti-separate' writes its voxels"},
        {3003, "PARCELS", 3003, "connections of parcels (.pconn.nii)", "the .dlabel.nii of its parcels"},
        {3006, "SCALARS", 3006, "values (.dscalar.nii)", "'wb_command -cifti-separate' writes its voxels"},
        {3000, "SCALARS", 3006, "values (.dscalar.nii)", "'wb_command -cifti-separate' writes its voxels"},
        {3007, "SERIES", 3002, "time series (.dtseries.nii)", "'wb_command -cifti-separate' writes its voxels"},
        {3007, "LABELS", 3007, "labels (.dlabel.nii)", "give it as ATLAS, as --labels of a surface"},
        {3099, "PARCELS", 3099, "a CIFTI matrix of an unknown kind", "the .dlabel.nii of its parcels"}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct buffer bytes = {0};
        struct volume_file file;
        struct notes notes = {0};
        char columns[32];
        snprintf(columns, sizeof columns, "INDEX_TYPE_%s", cases[i].columns);
        const struct cifti_spec spec = {.field = "intent_code",
                                        .value = cases[i].intent_code,
                                        .find = "INDEX_TYPE_LABELS",
                                        .replace = columns,
                                        .big = i % 2};
        cifti_build(&bytes, &spec);
        const struct bytes head = {(uint8_t *)bytes.data, bytes.size};
        assert_non_null(strstr(nearest_words(&head), cases[i].words));
        assert_int_equal(nifti_matrix_intent(head.data, head.size), cases[i].found);
        assert_fails(volume_file_open(&file, write_bytes("x.nii", &bytes), 0, &notes), CONUS_ERROR_UNSUPPORTED);
        assert_non_null(strstr(conus_message(), cases[i].words));
        assert_non_null(strstr(conus_message(), cases[i].way));
        if (cases[i].found != NIFTI_DENSE_LABELS) {
            struct vertex_labels labels = {0};
            assert_fails(vertex_labels_read(&labels, test_scratch("x.nii"), NULL, &notes), CONUS_ERROR_DATA);
            assert_non_null(strstr(conus_message(), cases[i].words));
        }
        buffer_finish(&bytes);
    }
}

TEST_GROUP(cifti)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_is_no_file_of_labels_is_refused),
        cmocka_unit_test(every_prefix_of_the_xml_is_refused),
        cmocka_unit_test(files_are_plain_or_packed),
        cmocka_unit_test(the_first_version_is_named),
        cmocka_unit_test(other_matrices_are_named),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
