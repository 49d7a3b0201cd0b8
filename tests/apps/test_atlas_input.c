/* SPDX-License-Identifier: BSD-3-Clause */
/* Loading as the options say, and its end before all is loaded. */
#include "common/messages.h"
#include "settings/atlas_input.h"
#include "test.h"

#include <stdio.h>
#include <unistd.h>

struct patience {
    size_t calls, allowed;
};

static bool hear(void *user, const char *path, size_t done, size_t total)
{
    struct patience *patience = user;
    assert_true(path[0] && done < total);
    return patience->calls++ < patience->allowed;
}

/* The scene has 11 surfaces, a pathway and a context; --pathway twice makes
 * two more of the callback's calls. Whichever of them cancels is the last, and nothing is said. */
static void whoever_cancels_hears_no_more(void **state)
{
    enum { FILES = 11 + 1 + 1 + 2 };
    const char *folder = test_scratch("brain");
    char path[4096], pathway[4096];
    const char *pathways[] = {pathway, pathway};
    (void)state;
    assert_ok(conus_phantom_write("brain", folder, NULL));
    snprintf(path, sizeof path, "%s/brain.atlas.json", folder);
    snprintf(pathway, sizeof pathway, "%s/brain-pathway.nii.gz,name=another", folder);
    FILE *said = tmpfile(); /* in place of stderr while the atlas is loaded, so that failures of the test are seen */
    int own = dup(STDERR_FILENO);
    assert_non_null(said);
    for (size_t allowed = 0; allowed <= FILES; allowed++) {
        struct patience patience = {.allowed = allowed};
        struct atlas_settings settings = {
            .pathways = {.items = pathways, .count = 2}, .progress = hear, .progress_user = &patience};
        conus_atlas *atlas = NULL;
        dup2(fileno(said), STDERR_FILENO);
        int code = settings_load_atlas(&atlas, path, &settings);
        dup2(own, STDERR_FILENO);
        assert_int_equal(code, allowed < FILES ? EXIT_DATA : EXIT_DONE);
        assert_int_equal(patience.calls, allowed < FILES ? allowed + 1 : FILES);
        assert_int_equal(atlas != NULL, allowed == FILES);
        conus_atlas_destroy(atlas);
    }
    assert_int_equal(lseek(fileno(said), 0, SEEK_END), 0);
    close(own);
    fclose(said);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(whoever_cancels_hears_no_more)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
