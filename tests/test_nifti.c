/* SPDX-License-Identifier: BSD-3-Clause */
#include "base/memory.h"
#include "loaders/volume_file.h"
#include "test.h"

#include <string.h>

/* Real atlases, their facts by independent readers (docs/spaces.md). */
static void reads_the_mricron_templates(void **state)
{
    (void)state;
    const struct {
        const char *name, *orientation, *transform;
        size_t dim[3], embedded;
        double maximum;
    } wanted[] = {
        {"aal.nii.gz", "RAS", "sform, code 4 (MNI 152)", {181, 217, 181}, 0, 116},
        {"natbrainlab.nii.gz", "LAS", "sform, code 2 (aligned to another)", {157, 189, 136}, 944, 116},
        {"inia19-NeuroMaps.nii.gz", "RAS", "sform, code 1 (scanner)", {168, 206, 128}, 32624, 1605},
    };
    for (size_t i = 0; i < sizeof wanted / sizeof wanted[0]; i++) {
        struct volume_file file;
        struct notes notes = {0};
        uint32_t *labels;
        assert_ok(volume_file_open(&file, test_mricron(wanted[i].name), 0, &notes));
        assert_memory_equal(file.info.dim, wanted[i].dim, sizeof wanted[i].dim);
        assert_string_equal(file.info.orientation, wanted[i].orientation);
        assert_string_equal(file.info.transform, wanted[i].transform);
        assert_int_equal(file.embedded.size, wanted[i].embedded);
        assert_ok(volume_file_labels(&labels, &file));
        assert_near(file.info.minimum, 0, 0);
        assert_near(file.info.maximum, wanted[i].maximum, 0);
        memory_free(labels);
        volume_file_finish(&file);
        notes_finish(&notes);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(reads_the_mricron_templates),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
