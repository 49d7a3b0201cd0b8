/* SPDX-License-Identifier: BSD-3-Clause */
/* A pose that is read without an error is rigid, whatever the format, the axis and the space, and left-handed only
 * where the world is a mirror image of the space; skipping rows counts as many as reading them. */
#include "base/child/hdf5.h"
#include "base/geometry/math3.h"
#include "conus/own.h"
#include "poses/pose_stream.h"
#include "tests/support/builders/place_atlas.h"

#include <stdlib.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void check(bool fine)
{
    if (!fine) {
        abort();
    }
}

static size_t read_rows(struct text text, const conus_pose_options *options, bool mirrors)
{
    conus_pose_list *list = NULL;
    if (pose_list_parse(&list, text, options)) {
        return 0;
    }
    size_t count = conus_pose_list_count(list);
    for (size_t i = 0; i < count; i++) {
        const conus_pose_row *row = conus_pose_list_row(list, i);
        double handed = mat4_determinant3(row->pose.world_from_device); /* matrices, points stay as they are */
        check(row->error || fabs((mirrors ? fabs(handed) : handed) - 1) < 1e-6);
        check(row->error || vec3_is_finite(row->pose.world_from_device + 12));
    }
    conus_pose_list_destroy(list);
    return count;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    const struct text text = {(const char *)data, size};
    if (hdf5_is(data, size) || text_starts(text, "MATLAB 7")) {
        return 0; /* a process of conus-hdf5 each; see fuzz_matlab.c, fuzz_nwb.c */
    }
    const conus_pose_options axes = {.space = CONUS_SPACE_LPS, .axis = (conus_axis)(size % 7)};
    const conus_pose_options shafts = {.format = "electrodes", .along_shafts = true};
    const conus_pose_options coils = {.format = "simnibs", .max_memory = 1 << 20};
    const conus_pose_options leads = {.format = "lead-dbs-native", .max_memory = 1 << 20};
    /* CCF's AP, DV, ML grow backward, downward and to the right; bregma's AP, ML, DV forward, to the right and upward.
     * Their worlds are RAS, or have left for right. */
    const double right = size % 4 < 2 ? 1 : -1;
    const conus_frame ccf = {.space = CONUS_SPACE_CCF,
                             .world_from_space = {0, -1e-3, 0, 0, 0, 0, -1e-3, 0, right * 1e-3, 0, 0, 0, 0, 0, 0, 1}};
    const conus_frame bregma = {.space = CONUS_SPACE_BREGMA,
                                .world_from_space = {0, 1, 0, 0, right, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1},
                                .bregma = {5400, 332, 5739}};
    const conus_pose_options rodent = {.frame = size % 2 ? &ccf : &bregma};
    size_t count = read_rows(text, NULL, false);
    (void)read_rows(text, &rodent, right < 0);
    (void)read_rows(text, &axes, false);
    (void)read_rows(text, &shafts, false);
    (void)read_rows(text, &coils, false);
    (void)read_rows(text, &leads, false);
    static conus_atlas *atlas; /* one for all */
    atlas = atlas ? atlas : place_atlas();
    const conus_pose_options places = {.atlas = atlas, .find_place = conus_place_find, .inward = size % 3 == 0};
    (void)read_rows(text, &places, false);
    conus_pose_stream *stream = NULL;
    uint64_t passed = 0;
    if (count && pose_stream_parse(&stream, text, NULL) == CONUS_OK) {
        check(conus_pose_stream_count(&passed, stream) == CONUS_OK && passed == count);
    }
    conus_pose_stream_destroy(stream);
    return 0;
}
