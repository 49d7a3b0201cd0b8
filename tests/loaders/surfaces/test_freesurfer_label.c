/* SPDX-License-Identifier: BSD-3-Clause */
/* FreeSurfer's labels: lists of vertices. tests/corpus/annot/ has the areas that they cut from a surface. */
#include "loaders/surfaces/freesurfer_labels.h"

#include "base/memory.h"
#include "test.h"

#include <string.h>

#define HEAD "#!ascii label  , from subject bert vox2ras=TkReg\n"

static void vertices_of_the_list_are_labelled(void **state)
{
    (void)state;
    uint32_t *labels = NULL;
    size_t count = 0;
    assert_ok(freesurfer_label_parse(&labels, &count, text_from(HEAD "3\n5 0 0 0 0\r\n2 0 0 0 0\n2 0 0 0 0")));
    static const uint32_t wanted[6] = {0, 0, 1, 0, 0, 1};
    assert_int_equal(count, 6);
    assert_memory_equal(labels, wanted, sizeof wanted);
    memory_free(labels);
}

TEST_GROUP(freesurfer_label)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(vertices_of_the_list_are_labelled),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
