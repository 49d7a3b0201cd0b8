/* SPDX-License-Identifier: BSD-3-Clause */
/* The space of AFNI's data sets; tests/corpus/afni/ has all else. */
#include "loaders/volumes/text/text_volume.h"

#include "base/memory.h"
#include "test.h"

#include <stdio.h>
#include <string.h>

static const char plain[] = "\ntype = integer-attribute\nname = DATASET_RANK\ncount = 8\n 3 2 0 0 0\n 0 0 0\n"
                            "\ntype = integer-attribute\nname = DATASET_DIMENSIONS\ncount = 5\n 2 3 2 0 0\n"
                            "\ntype = integer-attribute\nname = BRICK_TYPES\ncount = 2\n 0 0\n"
                            "\ntype  = float-attribute\nname  = BRICK_FLOAT_FACS\ncount = 2\n 0 0.5\n"
                            "\ntype = string-attribute\nname = BYTEORDER_STRING\ncount = 10\n'LSB_FIRST~\n"
                            "\ntype = string-attribute\nname = BRICK_LABS\ncount = 6\n'FA~MD~\n"
                            "\ntype = integer-attribute\nname = ORIENT_SPECIFIC\ncount = 3\n 1 2 4\n"
                            "\ntype  = float-attribute\nname  = ORIGIN\ncount = 3\n 10 20 30\n"
                            "\ntype  = float-attribute\nname  = DELTA\ncount = 3\n -2 -3 4\n";

static void the_space_follows_view_and_template(void **state)
{
    (void)state;
    static const struct {
        int view, code;
        const char *space;
    } cases[] = {{0, 1, "MNI"},      {1, 2, "ORIG"},        {2, 3, "TLRC"}, {2, 3, "TT_N27"}, {2, 4, "MNI"},
                 {2, 4, "MNI_ANAT"}, {2, 5, "HaskinsPeds"}, {0, 1, NULL},   {1, 2, NULL},     {2, 3, NULL}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct text_volume volume;
        struct job job = {0};
        char more[200];
        int size = snprintf(more, sizeof more, "\ntype = integer-attribute\nname = SCENE_DATA\ncount = 1\n %d\n",
                            cases[i].view);
        if (cases[i].space) { /* AFNI's older files have none: its +tlrc was Talairach */
            snprintf(more + size, sizeof more - (size_t)size,
                     "\ntype = string-attribute\nname = TEMPLATE_SPACE\ncount = %zu\n'%s~\n",
                     strlen(cases[i].space) + 1, cases[i].space);
        }
        struct buffer text = {0};
        buffer_text(&text, plain);
        buffer_text(&text, more);
        afni_parse(&job, &volume, reader_of(&job, (struct text){text.data, text.size}));
        assert_int_equal(volume.space_code, cases[i].code);
        assert_ok(job_close(&job, NULL, NULL));
        buffer_finish(&text);
    }
}

TEST_GROUP(afni)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_space_follows_view_and_template),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
