/* SPDX-License-Identifier: BSD-3-Clause */
/* Limits on the lists of a manifest. */
#include "base/memory.h"
#include "loaders/manifest/manifest.h"
#include "test.h"

#include <stdio.h>

/* Each entry is compared with all others. Therefore lists of things that are few have at most 64 entries, those of
 * separate files 4096, and those of areas any number. */
static void long_lists_are_refused(void **state)
{
    (void)state;
    static const struct {
        const char *key;
        size_t most;
        const char *before;
    } lists[] = {{"parcellations", 64, ""}, {"transform", 64, "\"areas\": [\"b\"], "},
                 {"pathways", 4096, ""},    {"probabilities", 4096, ""},
                 {"streamlines", 4096, ""}, {"context", 4096, "\"areas\": [\"b\"], "},
                 {"areas", 5000, ""}};
    for (size_t i = 0; i < sizeof lists / sizeof lists[0]; i++) {
        for (size_t more = 0; more < 2; more++) {
            struct job job = {0};
            struct scene m;
            struct buffer text = {0};
            char message[80];
            buffer_format(&text, "{\"conus_atlas\": 1, %s\"%s\": [", lists[i].before, lists[i].key);
            for (size_t k = 0; k < lists[i].most + more; k++) {
                buffer_text(&text, k ? ", \"a\"" : "\"a\"");
            }
            buffer_text(&text, "]}");
            scene_read(&job, &m, text_from(text.data));
            conus_status status = job_close(&job, NULL, NULL);
            bool fine = !more || lists[i].most == 5000;
            if (fine && status) {
                fail_msg("%s: %s", lists[i].key, conus_message());
            }
            assert_int_equal(status, fine ? CONUS_OK : CONUS_ERROR_DATA);
            if (status) {
                snprintf(message, sizeof message, "%s: %zu entries, allowed are %zu", lists[i].key, lists[i].most + 1,
                         lists[i].most);
                assert_string_equal(conus_message(), message);
            }
            buffer_finish(&text);
        }
    }
}

TEST_GROUP(manifest_lists)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(long_lists_are_refused)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
