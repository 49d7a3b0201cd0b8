/* SPDX-License-Identifier: BSD-3-Clause */
/* Sessions of the window: a refused one changes nothing; an accepted one, saved and opened again, is saved the same.
 * Each of two atlases has an area, a pathway and a context of 16 voxels each way; nothing is selected or drawn. */
#include "conus/own.h"
#include "tests/support/session_words.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

struct painter {
    int unused;
};

bool painter_create(struct painter **out, const conus_atlas *atlas, const char *transfer,
                    const struct appearance *appearance, conus_log log, void (*wake)(void))
{
    static struct painter none;
    (void)atlas;
    (void)transfer;
    (void)appearance;
    (void)log;
    (void)wake;
    *out = &none;
    return true;
}

void painter_destroy(struct painter *painter)
{
    (void)painter;
}

void painter_hold(struct painter *painter)
{
    (void)painter;
}

void painter_resume(struct painter *painter)
{
    (void)painter;
}

bool painter_finds_cover(struct painter *painter)
{
    return !painter;
}

bool painter_set_opacity(struct painter *painter, const struct appearance *appearance)
{
    (void)painter;
    return appearance->opacity;
}

bool painter_set_transfer(struct painter *painter, const conus_transfer_point *points, size_t count)
{
    (void)painter;
    return points && count;
}

size_t painter_transfer(struct painter *painter, conus_transfer_point *points, size_t capacity)
{
    (void)painter;
    (void)points;
    (void)capacity;
    return 0;
}

conus_status __wrap_conus_selector_create(conus_selector **out, const conus_atlas *atlas,
                                          const conus_selector_options *options);

conus_status __wrap_conus_selector_create(conus_selector **out, const conus_atlas *atlas,
                                          const conus_selector_options *options)
{
    (void)atlas;
    (void)options;
    *out = NULL;
    return CONUS_ERROR_MEMORY;
}

static void check(bool fine)
{
    if (!fine) {
        abort();
    }
}

static conus_atlas *make_atlas(void)
{
    const conus_phantom_options small = {.size = 16};
    const conus_pathway_options pathway = {.name = "Tract", .threshold = 0.5};
    char folder[] = "/tmp/conus-fuzz-XXXXXX";
    static const char *const names[] = {"sphere.nii.gz", "sphere.tsv", "sphere.json"};
    char path[64];
    conus_atlas *atlas = NULL;
    check(mkdtemp(folder) && !conus_phantom_write("sphere", folder, &small));
    snprintf(path, sizeof path, "%s/%s", folder, names[0]);
    check(!conus_atlas_load(&atlas, path, NULL) && !conus_atlas_add_pathway(atlas, path, &pathway) &&
          !conus_atlas_set_context(atlas, path, NULL));
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
        snprintf(path, sizeof path, "%s/%s", folder, names[i]);
        unlink(path);
    }
    rmdir(folder);
    return atlas;
}

static void check_again(struct window *window, const char *text)
{
    char why[PROPERTY_REASON];
    check(session_parse(window, text, strlen(text), why));
    char *again = session_text(window);
    check(again && strcmp(text, again) == 0);
    free(again);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static struct viewer viewer;
    static struct window window = {.screen.enlarged = -1, .viewer = &viewer};
    char why[PROPERTY_REASON];
    if (!viewer.atlases) {
        const struct view_source sources[] = {{make_atlas(), "sphere.nii.gz", "sphere"},
                                              {make_atlas(), "again.nii.gz", "again"}};
        check(!viewer_create(&viewer, sources, 2, NULL, NULL, NULL));
    }
    char *before = session_text(&window);
    bool fine = session_parse(&window, (const char *)data, size, why);
    char *after = session_text(&window);
    check(before && after && (fine || strcmp(before, after) == 0));
    check(fine || (why[0] && !strchr(why, '\n')));
    if (fine) {
        check_again(&window, after);
    }
    free(before);
    free(after);
    return 0;
}
