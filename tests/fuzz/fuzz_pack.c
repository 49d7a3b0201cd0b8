/* SPDX-License-Identifier: BSD-3-Clause */
/* A damaged pack, or one made to deceive: opening it fails, or gives an atlas that answers. The input is the damage, so
 * that it fits every layout: how much is cut off the end (two bytes), whether the sums are made right (one), then
 * places (two bytes each) and their new values (one). */
#include "atlas/atlas.h"
#include "base/system/system.h"
#include "conus/own.h"
#include "pack/pack.h"
#include "tests/support/packed_atlas.h"

#include <libdeflate.h>
#include <unistd.h>
#include <zlib.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

enum { PIECE = 3, BLOCK_CRC = 24, BLOCK_LAYOUT = 32, BLOCK_SMALL_END = 40, BLOCK_HEAD = 56, RIGHT_SUMS = 1 };

/* The pack, from a file that is gone. */
static struct bytes make_pack(void)
{
    char path[] = "/tmp/fuzz-XXXXXX.conus";
    struct bytes bytes = {0};
    conus_atlas *atlas = make_atlas();
    atlas->path = memory_text("v.nii", 5);
    int file = system_open_temporary(path, strlen(CONUS_PACK_ENDING), true);
    must(file >= 0 && atlas->path ? CONUS_OK : CONUS_ERROR_IO);
    close(file);
    must(conus_atlas_save(path, atlas, &(const conus_save_options){.words = "conus pack v.nii -o v.conus"}));
    must(file_read(&bytes, path, UINT32_MAX));
    system_remove(path);
    conus_atlas_destroy(atlas);
    return bytes;
}

/* As someone who wants to be believed. */
static void make_sums_right(uint8_t *pack, size_t size)
{
    struct pack_head head;
    uint64_t end;
    if (size < sizeof head) {
        return;
    }
    memcpy(&head, pack, sizeof head);
    if (head.atlas.at <= size && size - head.atlas.at >= BLOCK_HEAD) {
        uint8_t *block = pack + head.atlas.at;
        memcpy(&end, block + BLOCK_SMALL_END, sizeof end);
        if (end >= BLOCK_HEAD && end <= size - head.atlas.at) {
            uint64_t crc = crc32_z(0, block + BLOCK_LAYOUT, end - BLOCK_LAYOUT);
            memcpy(block + BLOCK_CRC, &crc, sizeof crc);
        }
    }
    head.size = size;
    if (head.sums.at >= PACK_PAGE && head.sums.at < size && head.sums.at - PACK_PAGE <= PACK_CHUNK &&
        size - head.sums.at >= sizeof head.sums_crc) {
        uint32_t sum = libdeflate_crc32(0, pack + PACK_PAGE, head.sums.at - PACK_PAGE);
        memcpy(pack + head.sums.at, &sum, sizeof sum);
        head.sums_crc = libdeflate_crc32(0, pack + head.sums.at, size - head.sums.at);
    }
    head.crc = libdeflate_crc32(0, &head, offsetof(struct pack_head, crc));
    memcpy(pack, &head, sizeof head);
}

static void ask(const conus_atlas *atlas)
{
    static const double from[2][3] = {{-20, 1, 1}, {3, 2, 20}};
    conus_selector *selector = NULL;
    for (int i = 0; i < 2; i++) {
        conus_selection *selection = NULL;
        conus_report *report = NULL;
        conus_pose pose;
        const char *text;
        size_t size;
        const conus_selector_options options = {
            .resolution = 16, .engine = CONUS_ENGINE_RAYS, .layers = i ? CONUS_LAYERS_ALL : (conus_layers)0};
        const conus_report_options rows = {.format = "json"};
        if (!conus_selector_create(&selector, atlas, &options)) {
            if (!conus_pose_toward(&pose, from[i], (double[]){1, 1, 0.5}, NULL) &&
                !conus_select(&selection, selector, &pose, 17) && !conus_report_create(&report, selector, &rows) &&
                !conus_report_add(report, "1", selection) && !conus_report_text(&text, &size, report) && !size) {
                abort();
            }
            conus_report_destroy(report);
            conus_selection_destroy(selection);
            conus_selector_destroy(selector);
            selector = NULL;
        }
    }
    conus_atlas_context_depth(atlas, from[0], (double[]){1, 0, 0});
}

static size_t number_at(const uint8_t *data)
{
    return data[0] | (size_t)data[1] << 8;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static struct bytes whole;
    char path[64];
    conus_atlas *atlas = NULL;
    if (size < PIECE) {
        return 0;
    }
    if (!whole.data) {
        whole = make_pack();
    }
    uint8_t *pack = memory_copy(whole.data, whole.size, 1);
    must(pack ? CONUS_OK : CONUS_ERROR_MEMORY);
    for (const uint8_t *at = data + PIECE; at + PIECE <= data + size; at += PIECE) {
        pack[number_at(at) % whole.size] = at[2];
    }
    size_t left = whole.size - number_at(data) % whole.size;
    if (data[2] & RIGHT_SUMS) {
        make_sums_right(pack, left);
    }
    int file = system_open_scratch("pack");
    must(file >= 0 && system_write(file, pack, left) ? CONUS_OK : CONUS_ERROR_IO);
    snprintf(path, sizeof path, "/proc/self/fd/%d", file);
    if (!pack_load(&atlas, path, &(const conus_load_options){0})) {
        ask(atlas);
        conus_atlas_destroy(atlas);
    } else if (!*conus_message()) {
        abort();
    }
    close(file);
    memory_free(pack);
    return 0;
}
