/* SPDX-License-Identifier: BSD-3-Clause */
/* GIFTI: every type, labels, external files. tests/corpus/gifti/ has every encoding, placement, and refused files. */
#include "loaders/surfaces/parts.h"

#include "base/files/file.h"
#include "builders/gifti_builder.h"
#include "test.h"

#include <stdio.h>
#include <string.h>

#define DOCTYPE "<!DOCTYPE GIFTI SYSTEM \"http://www.nitrc.org/frs/download.php/115/gifti.dtd\">\n"
#define MD(name, value) "<MD><Name><![CDATA[" name "]]></Name><Value><![CDATA[" value "]]></Value></MD>"

static struct gifti *parse(struct job *job, const struct buffer *bytes, const char *beside)
{
    return gifti_read(job, text_from_bytes((const uint8_t *)bytes->data, bytes->size), beside);
}

static void every_type(void **state)
{
    (void)state;
    static const struct {
        const char *type;
        double low, high;
    } types[] = {{"UINT8", 0, 255},
                 {"INT8", -128, 127},
                 {"INT16", -32768, 32767},
                 {"UINT16", 0, 65535},
                 {"INT32", -0x1p31, 0x1p31 - 1},
                 {"UINT32", 0, 0x1p32 - 1},
                 {"INT64", -0x1p53, 0x1p53},
                 {"UINT64", 0, 0x1p53},
                 {"FLOAT32", -0.5, 0x1p100},
                 {"FLOAT64", 0.1, 1e300}};
    for (size_t i = 0; i < 4 * (sizeof types / sizeof types[0]); i++) {
        const double values[2] = {types[i / 4].low, types[i / 4].high};
        const struct array_spec spec = {.intent = "SHAPE",
                                        .type = types[i / 4].type,
                                        .encoding = i & 1 ? "Base64Binary" : "GZipBase64Binary",
                                        .big_endian = i & 2,
                                        .rows = 2,
                                        .values = values};
        struct buffer bytes = {0};
        struct job job = {0};
        gifti_begin(&bytes, "", 1);
        gifti_append(&bytes, &spec);
        gifti_end(&bytes);
        const struct gifti *gifti = parse(&job, &bytes, NULL);
        assert_non_null(gifti);
        assert_int_equal(gifti->arrays.at[0].intent, GIFTI_OTHER);
        assert_near(gifti->arrays.at[0].values[0], values[0], 0);
        assert_near(gifti->arrays.at[0].values[1], values[1], 0);
        assert_ok(job_close(&job, NULL, NULL));
        buffer_finish(&bytes);
    }
}

static void labels_names_and_hemisphere(void **state)
{
    (void)state;
    static const double values[5] = {0, 7, -1, 3, 7};
    struct buffer bytes = {0};
    struct job job = {0};
    size_t count;
    gifti_begin(&bytes, DOCTYPE, 1);
    buffer_text(
        &bytes,
        "<MetaData>" MD("Name",
                        " Area &\xc3\xbc ") "</MetaData><LabelTable>"
                                            "<Label Key=\"0\">cortex</Label><Label Key=\"-1\"><![CDATA[???]]></Label>"
                                            "<Label Index=\"7\" Red=\"1\" Green=\"0.5\" Blue=\"0\" "
                                            "Alpha=\"1\"><![CDATA[V1]]></Label>"
                                            "<Label Key=\"3\" Index=\"9\">V2</Label></LabelTable>");
    gifti_append(&bytes, &(struct array_spec){
                             .intent = "LABEL",
                             .type = "INT32",
                             .encoding = "GZipBase64Binary",
                             .rows = 5,
                             .values = values,
                             .inside = "<MetaData>" MD("AnatomicalStructurePrimary", "CortexRight") "</MetaData>"});
    gifti_end(&bytes);
    const struct gifti *gifti = parse(&job, &bytes, NULL);
    const struct notes *notes = &job.notes;
    assert_non_null(gifti);
    assert_string_equal(gifti->name, "Area &\xc3\xbc");
    assert_int_equal(gifti->hemisphere, 'R');
    assert_int_equal(gifti->labels.count, 2);
    assert_string_equal(label_table_find(&gifti->labels, 3)->name, "V2");
    assert_string_equal(label_table_find(&gifti->labels, 7)->name, "V1");
    assert_int_equal(label_table_find(&gifti->labels, 7)->rgb[1], 128);
    assert_int_equal(notes->count, 1);
    assert_non_null(strstr(notes->lines[0], "label 0 is called \"cortex\""));
    const uint32_t *labels = gifti_vertices(&job, &count, gifti, 0);
    assert_int_equal(count, 5);
    for (size_t i = 0; i < 5; i++) {
        assert_int_equal(labels[i], values[i] > 0 ? (uint32_t)values[i] : 0);
    }
    assert_non_null(strstr(notes->lines[1], "1 vertices have labels below 0"));
    assert_null(gifti_vertices(&job, &count, gifti, 1));
    assert_int_equal(count, 0);
    assert_fails(job_close(&job, NULL, NULL), CONUS_ERROR_DATA);
    buffer_finish(&bytes);
}

/* Whether the message has a or b of "a|b". */
static bool says(const char *wanted)
{
    const char *bar = strchr(wanted, '|');
    char first[128];
    snprintf(first, sizeof first, "%.*s", bar ? (int)(bar - wanted) : (int)strlen(wanted), wanted);
    return strstr(conus_message(), first) || (bar && strstr(conus_message(), bar + 1));
}

/* Other readers get such a file first. */
static void another_document_is_refused(void **state)
{
    (void)state;
    struct buffer bytes = {0};
    struct job job = {0};
    buffer_text(&bytes, "<atlas/>");
    assert_null(parse(&job, &bytes, NULL));
    assert_fails(job_close(&job, NULL, NULL), CONUS_ERROR_DATA);
    assert_non_null(strstr(conus_message(), "outermost element: found <atlas>, allowed is <GIFTI>"));
    buffer_finish(&bytes);
}

static void external_files_only_where_allowed(void **state)
{
    (void)state;
    static const float numbers[13] = {99, 0, 0, 0, 10, 0, 0, 0, 10, 0, 0, 0, 10};
    static const struct {
        const char *more, *message;
        conus_status status;
    } cases[] = {
        {"ExternalFileName=\"numbers.dat\" ExternalFileOffset=\"4\"", NULL, CONUS_OK},
        {"ExternalFileName=\"numbers.dat\" ExternalFileOffset=\"8\"", "52 bytes, the array needs 48 from 8 on",
         CONUS_ERROR_DATA},
        {"ExternalFileName=\"numbers.dat\" ExternalFileOffset=\"-1\"", "ExternalFileOffset: found \"-1\"",
         CONUS_ERROR_DATA},
        {"ExternalFileName=\"../numbers.dat\"", "ExternalFileName: found \"../numbers.dat\"", CONUS_ERROR_DATA},
        {"ExternalFileName=\"/etc/passwd\"", "ExternalFileName: found \"/etc/passwd\"", CONUS_ERROR_DATA},
        {"ExternalFileName=\"\"", "ExternalFileName: found \"\"", CONUS_ERROR_DATA},
        {"ExternalFileName=\"absent.dat\"", "absent.dat", CONUS_ERROR_IO},
    };
    char path[256];
    snprintf(path, sizeof path, "%s", test_scratch("external.gii"));
    assert_ok(file_write(test_scratch("numbers.dat"), numbers, sizeof numbers));
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct buffer bytes = {0};
        struct job job = {0};
        gifti_begin(&bytes, "", 1);
        gifti_append(&bytes,
                     &(struct array_spec){
                         .encoding = "ExternalFileBinary", .rows = 4, .columns = 3, .data = "", .more = cases[i].more});
        gifti_end(&bytes);
        const struct gifti *gifti = parse(&job, &bytes, path);
        assert_int_equal(gifti != NULL, cases[i].status == CONUS_OK);
        if (gifti) {
            assert_near(gifti->arrays.at[0].values[3], 10, 0);
        }
        assert_fails(job_close(&job, NULL, NULL), cases[i].status);
        assert_true(gifti || says(cases[i].message));
        buffer_finish(&bytes);
    }
}

TEST_GROUP(gifti)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_type),
        cmocka_unit_test(labels_names_and_hemisphere),
        cmocka_unit_test(another_document_is_refused),
        cmocka_unit_test(external_files_only_where_allowed),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
