/* SPDX-License-Identifier: BSD-3-Clause */
/* Packs open as what was packed, or not at all; and they say when their sources have changed. */
#include "pack/pack.h"

#include "base/files/file.h"
#include "base/geometry/math3.h"
#include "conus/own.h"
#include "packed_atlas.h"
#include "test.h"

#include <fcntl.h>
#include <libdeflate.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

/* A change of a packed structure changes this number. Then PACK_FORMAT is raised, and so is this. */
enum { FORMAT = 1 };
#define LAYOUT UINT64_C(0x11c1096addeb033d)

static void a_change_of_layout_is_a_change_of_format(void **state)
{
    (void)state;
    assert_int_equal(PACK_FORMAT, FORMAT);
    if (sizeof(void *) == 8) {
        assert_int_equal(pack_layout(), LAYOUT);
    }
}

static char pack_path[400];

static void keep_path(const char *name)
{
    snprintf(pack_path, sizeof pack_path, "%s", test_scratch(name));
}

static struct bytes make_pack(void)
{
    struct bytes bytes = {0};
    conus_atlas *atlas = make_atlas();
    atlas->path = memory_text("v.nii", 5);
    keep_path("made.conus");
    assert_ok(conus_atlas_save(pack_path, atlas, &(const conus_save_options){.words = "conus pack v.nii"}));
    assert_ok(file_read(&bytes, pack_path, UINT32_MAX));
    conus_atlas_destroy(atlas);
    return bytes;
}

static conus_status open_bytes(const struct bytes *bytes)
{
    conus_atlas *atlas = NULL;
    assert_ok(file_write_soon(pack_path, bytes->data, bytes->size));
    conus_status status = conus_atlas_load(&atlas, pack_path, NULL);
    conus_atlas_destroy(atlas);
    return status;
}

static void what_is_opened_is_what_was_packed(void **state)
{
    (void)state;
    struct bytes bytes = make_pack();
    conus_atlas *first = make_atlas();
    conus_atlas *opened = NULL;
    assert_ok(conus_atlas_load(&opened, pack_path, NULL));
    const conus_pack_info *info = conus_atlas_pack_info(opened);
    assert_string_equal(info->path, pack_path);
    assert_string_equal(info->words, "conus pack v.nii");
    assert_int_equal(info->size, bytes.size);
    assert_int_equal(info->source_count, 0); /* there are no such files */
    char sum[65];
    file_sha256(sum, &(const struct bytes){bytes.data + PACK_PAGE, bytes.size - PACK_PAGE});
    assert_string_equal(info->sha256, sum);
    assert_int_equal(conus_atlas_object_count(opened), conus_atlas_object_count(first));
    for (size_t i = 1; i <= conus_atlas_object_count(first); i++) {
        assert_string_equal(conus_atlas_object(first, i)->name, conus_atlas_object(opened, i)->name);
    }
    for (size_t i = 0; i < first->volume_count; i++) {
        for (size_t v = 0; v < first->volumes[i].voxel_count && volume_can_be_hit(&first->volumes[i]); v++) {
            assert_int_equal(volume_object(&first->volumes[i], v), volume_object(&opened->volumes[i], v));
        }
    }
    assert_int_equal(conus_atlas_context_surface_count(opened), 1);
    assert_int_equal(conus_atlas_note_count(opened), conus_atlas_note_count(first)); /* it is not called old */
    assert_int_equal(opened->tractograms[0].point_count, first->tractograms[0].point_count);
    assert_fails(conus_atlas_save(pack_path, opened, NULL), CONUS_ERROR_ARGUMENT);
    assert_fails(conus_atlas_save("x.nii", first, NULL), CONUS_ERROR_ARGUMENT);
    assert_null(conus_atlas_pack_info(first));
    conus_atlas_destroy(opened);
    conus_atlas_destroy(first);
    struct bytes again = make_pack(); /* nothing of this process's memory is in it */
    assert_int_equal(again.size, bytes.size);
    assert_memory_equal(again.data, bytes.data, bytes.size);
    bytes_finish(&again);
    bytes_finish(&bytes);
}

static void every_cut_is_refused(void **state)
{
    (void)state;
    struct bytes bytes = make_pack();
    for (size_t size = 0; size < bytes.size; size += size < 64 || size + 64 > bytes.size ? 1 : 61) {
        assert_fails(open_bytes(&(const struct bytes){bytes.data, size}), CONUS_ERROR_DATA);
    }
    bytes_finish(&bytes);
}

/* Packs of unlike kinds: voxels, streamlines, and something of everything. */
static const char *const kinds[][2] = {{"nested", "nested.nii.gz"}, {"bundle", "bundle.atlas.json"}, {NULL, NULL}};
enum { KINDS = 3, FLIPS = 100000 };

/* What is asked of a pack, and its answer. */
struct attacked {
    struct bytes bytes;
    int file; /* the pack on the disk, which is changed in place */
    char *answer;
};

/* All that a question and the list of objects say; NULL without memory. */
static char *answer_of(const conus_atlas *atlas)
{
    conus_selector *selector = NULL;
    conus_selection *selection = NULL;
    conus_report *report = NULL;
    conus_pose pose;
    const char *text;
    size_t size;
    struct buffer out = {0};
    const conus_selector_options options = {.resolution = 8, .engine = CONUS_ENGINE_RAYS, .layers = CONUS_LAYERS_ALL};
    assert_ok(conus_selector_create(&selector, atlas, &options));
    assert_ok(conus_pose_toward(&pose, (double[]){3, -30, 2}, (double[]){0, 0, 0}, NULL));
    assert_ok(conus_select(&selection, selector, &pose, degrees_from_radians(0.5)));
    assert_ok(conus_report_create(&report, selector, &(const conus_report_options){.format = "tsv"}));
    assert_ok(conus_report_add(report, "1", selection));
    assert_ok(conus_report_text(&text, &size, report));
    buffer_append(&out, text, size + 1);
    conus_report_destroy(report);
    conus_selection_destroy(selection);
    conus_selector_destroy(selector);
    assert_ok(buffer_status(&out));
    return out.data;
}

static void begin_attack(struct attacked *out, size_t kind)
{
    char path[500];
    conus_atlas *atlas = NULL;
    if (kinds[kind][0]) {
        keep_path(kinds[kind][0]);
        assert_ok(
            conus_phantom_write(kinds[kind][0], pack_path, &(const conus_phantom_options){.size = kind ? 0 : 16}));
        snprintf(path, sizeof path, "%s/%s", pack_path, kinds[kind][1]);
        assert_ok(conus_atlas_load(&atlas, path, NULL));
        keep_path("attacked.conus");
        assert_ok(conus_atlas_save(pack_path, atlas, &(const conus_save_options){.words = "conus pack it"}));
        conus_atlas_destroy(atlas);
    } else {
        struct bytes bytes = make_pack();
        bytes_finish(&bytes);
    }
    *out = (struct attacked){.file = open(pack_path, O_RDWR)};
    assert_ok(file_read(&out->bytes, pack_path, UINT32_MAX));
    assert_ok(conus_atlas_load(&atlas, pack_path, NULL));
    out->answer = answer_of(atlas);
    assert_non_null(strchr(strchr(out->answer, '\n') + 1, '\n')); /* a row */
    conus_atlas_destroy(atlas);
}

static void end_attack(struct attacked *attacked)
{
    assert_int_equal(close(attacked->file), 0);
    memory_free(attacked->answer);
    bytes_finish(&attacked->bytes);
}

static void put_at(const struct attacked *attacked, const void *data, size_t size, size_t at)
{
    assert_int_equal(pwrite(attacked->file, data, size, (off_t)at), (ssize_t)size);
}

/* An error that names the file and says what it is about, or the right answer; gives whether it is an error. */
static bool is_refused_or_right(const struct attacked *attacked)
{
    conus_atlas *atlas = NULL;
    conus_status status = conus_atlas_load(&atlas, pack_path, NULL);
    if (status) {
        assert_int_equal(status, CONUS_ERROR_DATA);
        assert_memory_equal(conus_message(), pack_path, strlen(pack_path));
        return true;
    }
    char *answer = answer_of(atlas);
    assert_string_equal(answer, attacked->answer);
    memory_free(answer);
    conus_atlas_destroy(atlas);
    return false;
}

static void every_flipped_bit_is_refused(void **state)
{
    (void)state;
    uint64_t random = 1;
    for (size_t kind = 0; kind < KINDS; kind++) {
        struct attacked attacked;
        begin_attack(&attacked, kind);
        size_t every = test_cases(FLIPS) / KINDS + 1;
        for (size_t i = 0; i < every; i++) {
            random = random * UINT64_C(6364136223846793005) + 1442695040888963407;
            size_t bit = (size_t)(random >> 20) % (8 * (i % 8 ? attacked.bytes.size : PACK_PAGE));
            uint8_t flipped = attacked.bytes.data[bit / 8] ^ (uint8_t)(1 << bit % 8);
            put_at(&attacked, &flipped, 1, bit / 8);
            assert_true(is_refused_or_right(&attacked));
            put_at(&attacked, attacked.bytes.data + bit / 8, 1, bit / 8);
        }
        assert_false(is_refused_or_right(&attacked));
        end_attack(&attacked);
    }
}

/* Writes a head whose sum is right. */
static void set_head(struct bytes *bytes, struct pack_head head)
{
    head.crc = libdeflate_crc32(0, &head, offsetof(struct pack_head, crc));
    memcpy(bytes->data, &head, sizeof head);
}

#define FIELD(member, decides)                                                                                         \
    {                                                                                                                  \
        offsetof(struct pack_head, member), sizeof(((struct pack_head *)0)->member), decides                           \
    }

static void each_field_of_the_head_is_refused_or_means_nothing(void **state)
{
    (void)state;
    static const struct {
        size_t at, size;
        bool decides; /* another value is always refused */
    } fields[] = {FIELD(magic, true),         FIELD(format, true),    FIELD(byte_order, true),  FIELD(layout, true),
                  FIELD(size, true),          FIELD(words.at, false), FIELD(words.size, false), FIELD(sources.at, true),
                  FIELD(sources.size, false), FIELD(atlas.at, true),  FIELD(atlas.size, false), FIELD(sums.at, true),
                  FIELD(sums.size, true),     FIELD(sha256, false),   FIELD(sums_crc, true),    FIELD(readers, false),
                  FIELD(version, false),      FIELD(rest, false)};
    for (size_t kind = 0; kind < KINDS; kind++) {
        struct attacked attacked;
        begin_attack(&attacked, kind);
        struct bytes head = {.data = memory_copy(attacked.bytes.data, PACK_PAGE, 1), .size = PACK_PAGE};
        for (size_t f = 0; f < sizeof fields / sizeof *fields; f++) {
            uint8_t *field = head.data + fields[f].at;
            for (int how = 0; how < 5; how++) { /* nothing, all, a byte more, a page less, far away */
                memset(field, how == 1 ? 0xff : 0, how < 2 ? fields[f].size : 0);
                field[0] = (uint8_t)(field[0] + (how == 2));
                field[1] = (uint8_t)(field[1] - (how == 3 ? PACK_PAGE / 256 : 0));
                field[fields[f].size - 1] ^= how == 4 ? 0x40 : 0;
                struct pack_head changed;
                memcpy(&changed, head.data, sizeof changed);
                set_head(&head, changed);
                put_at(&attacked, head.data, PACK_PAGE, 0);
                bool is_other = memcmp(head.data, attacked.bytes.data, offsetof(struct pack_head, crc)) != 0;
                bool is_refused = is_refused_or_right(&attacked);
                assert_true(is_refused || !is_other || !fields[f].decides);
                memcpy(head.data, attacked.bytes.data, PACK_PAGE);
            }
        }
        put_at(&attacked, head.data, PACK_PAGE, 0);
        for (size_t k = 40; k-- > 0;) { /* cuts */
            assert_int_equal(ftruncate(attacked.file, (off_t)(attacked.bytes.size * k / 40)), 0);
            assert_true(is_refused_or_right(&attacked));
        }
        bytes_finish(&head);
        end_attack(&attacked);
    }
}

static void other_heads_are_refused_by_what_they_say(void **state)
{
    (void)state;
    struct bytes bytes = make_pack();
    struct pack_head head;
    memcpy(&head, bytes.data, sizeof head);
    struct pack_head other = head;
    other.format = 2;
    set_head(&bytes, other);
    assert_fails(open_bytes(&bytes), CONUS_ERROR_DATA);
    assert_non_null(strstr(conus_message(), "found format 2, this conus reads format 1"));
    other = head;
    other.byte_order = __builtin_bswap32(head.byte_order);
    other.format = __builtin_bswap32(head.format);
    set_head(&bytes, other);
    assert_fails(open_bytes(&bytes), CONUS_ERROR_DATA);
    assert_non_null(strstr(conus_message(), "another byte order"));
    other = head;
    other.layout++;
    set_head(&bytes, other);
    assert_fails(open_bytes(&bytes), CONUS_ERROR_DATA);
    assert_non_null(strstr(conus_message(), "another build of conus; pack it again: conus pack v.nii"));
    other = head;
    other.sources.size = 1;
    set_head(&bytes, other);
    assert_fails(open_bytes(&bytes), CONUS_ERROR_DATA);
    const char *once = strstr(conus_message(), ".conus: is damaged in its list of sources; pack it again");
    assert_non_null(once);
    assert_ptr_equal(once, strstr(conus_message(), ".conus: "));
    struct pack_part *parts[] = {&other.words, &other.sources, &other.atlas, &other.sums};
    for (size_t i = 0; i < 4; i++) {
        for (int far = 0; far < 4; far++) {
            other = head;
            *(far % 2 ? &parts[i]->at : &parts[i]->size) = far < 2 ? bytes.size : UINT64_MAX - 4095;
            set_head(&bytes, other);
            assert_fails(open_bytes(&bytes), CONUS_ERROR_DATA);
        }
    }
    set_head(&bytes, head);
    bytes.data[head.atlas.at] ^= 1;
    assert_fails(open_bytes(&bytes), CONUS_ERROR_DATA);
    assert_non_null(strstr(conus_message(), "damaged between the bytes 4096 and "));
    bytes_finish(&bytes);
}

/* As someone who wants to be believed. */
static void make_sums_right(struct bytes *bytes)
{
    enum { CRC = 24, LAYOUT_AT = 32, SMALL_END = 40 }; /* of the atlas's head */
    struct pack_head head;
    uint64_t end;
    memcpy(&head, bytes->data, sizeof head);
    uint8_t *atlas = bytes->data + head.atlas.at;
    memcpy(&end, atlas + SMALL_END, sizeof end);
    const uint64_t crc = libdeflate_crc32(0, atlas + LAYOUT_AT, end - LAYOUT_AT);
    memcpy(atlas + CRC, &crc, sizeof crc);
    const uint32_t sum = libdeflate_crc32(0, bytes->data + PACK_PAGE, head.sums.at - PACK_PAGE);
    memcpy(bytes->data + head.sums.at, &sum, sizeof sum);
    head.sums_crc = libdeflate_crc32(0, &sum, sizeof sum);
    set_head(bytes, head);
}

/* The pack with the byte at `at` changed, and with right sums. */
static void assert_seen(struct bytes *bytes, size_t at, uint8_t value, const char *place)
{
    uint8_t was = bytes->data[at];
    for (int turn = 0; turn < 2; turn++) {
        bytes->data[at] = turn ? was : value;
        make_sums_right(bytes);
        assert_int_equal(open_bytes(bytes), turn ? CONUS_OK : CONUS_ERROR_DATA);
        assert_true(turn || strstr(conus_message(), place));
    }
}

static void a_text_that_is_not_there_or_does_not_end_is_refused(void **state)
{
    (void)state;
    static const char sum[] = "ba7816bf"; /* SHA-256 of "abc", the file of make_atlas() */
    static const char note[] = "a note";
    struct bytes bytes = make_pack();
    const uint8_t *file = memmem(bytes.data, bytes.size, sum, sizeof sum - 1);
    const uint8_t *line = memmem(bytes.data, bytes.size, note, sizeof note);
    assert_true(file && line);
    assert_seen(&bytes, (size_t)(file - bytes.data) + 64, 'x', "holds no atlas");
    assert_seen(&bytes, (size_t)(line - bytes.data) - sizeof(size_t), 0, "holds no atlas"); /* its size */
    bytes_finish(&bytes);
}

static void no_number_leads_out_of_a_pack_with_right_sums(void **state)
{
    (void)state;
    struct bytes bytes = make_pack();
    conus_atlas *atlas = NULL;
    char copy[420];
    snprintf(copy, sizeof copy, "%s.conus", pack_path);
    assert_ok(file_write(copy, bytes.data, bytes.size));
    assert_ok(conus_atlas_load(&atlas, copy, NULL));
    const uint8_t *begin = atlas->mapped;
    const struct volume *volume = &atlas->volumes[0];
    const struct tractogram *tractogram = &atlas->tractograms[0];
    enum { DISTANCES_HEAD = 192 };
#define AT(array) ((size_t)((const uint8_t *)(array)-begin))
    assert_seen(&bytes, AT(volume->objects16), 4, "volume 0 (from 0): a voxel has an object");
    assert_seen(&bytes, AT(volume->objects16) + 1, 1, "volume 0 (from 0): a voxel has an object");
    assert_seen(&bytes, AT(volume->distances) + DISTANCES_HEAD, 0, "volume 0 (from 0): a distance");
    assert_seen(&bytes, AT(volume->distances) + DISTANCES_HEAD + 63, 0, "volume 0 (from 0): a distance"); /* a line */
    assert_seen(&bytes, AT(volume->distances) + 1, 9, "volume 0 (from 0): a distance");
    assert_seen(&bytes, AT(atlas->volumes[1].steps) + 8, 1, "volume 1 (from 0): a step");
    assert_seen(&bytes, AT(atlas->meshes[0].triangles), 4, "surface 0 (from 0)");
    assert_seen(&bytes, AT(atlas->context_surfaces[0].mesh.triangles), 4, "surface around the areas 0 (from 0)");
    assert_seen(&bytes, AT(tractogram->first), 1, "streamlines");
    assert_seen(&bytes, AT(tractogram->tree.marks), 1, "streamlines");
    assert_seen(&bytes, AT(tractogram->groups[0].members), 2, "group 'one'");
    assert_seen(&bytes, AT(tractogram->points) + 3, 0x7f, "tractogram 0 (from 0)");
#undef AT
    conus_atlas_destroy(atlas);
    bytes_finish(&bytes);
}

/* A number of an opened pack that says where something lies; grids are made between such numbers. `by`: by so much off
 * it is seen, too. */
static void assert_place_is_checked(const conus_atlas *atlas, double *number, double by, const char *said)
{
    const double was = *number;
    const double tried[] = {-1e300, 1e300, -INFINITY, INFINITY, NAN, was + by, was - by};
    for (size_t i = 0; i < (by > 0 ? 7 : 5); i++) {
        *number = tried[i];
        assert_fails(pack_check_atlas(atlas), CONUS_ERROR_DATA);
        assert_non_null(strstr(conus_message(), said));
    }
    *number = was;
}

static void boxes_are_those_of_what_is_in_them(void **state)
{
    (void)state;
    struct bytes bytes = make_pack();
    conus_atlas *atlas = NULL;
    assert_ok(conus_atlas_load(&atlas, pack_path, NULL));
    for (int a = 0; a < 3; a++) {
        assert_place_is_checked(atlas, &atlas->meshes[0].shape.low[a], 0.01, "surface 0 (from 0): its box");
        assert_place_is_checked(atlas, &atlas->meshes[0].shape.high[a], 0.01, "surface 0 (from 0): its box");
        assert_place_is_checked(atlas, &atlas->context_surfaces[0].mesh.shape.low[a], 0.01,
                                "surface around the areas 0");
        assert_place_is_checked(atlas, &atlas->tractograms[0].low[a], 0, "tractogram 0 (from 0): its box");
        assert_place_is_checked(atlas, &atlas->tractograms[0].high[a], 0, "tractogram 0 (from 0): its box");
        assert_place_is_checked(atlas, &atlas->volumes[0].centres.low[a], 0.01, "volume 0 (from 0): its box");
        assert_place_is_checked(atlas, &atlas->volumes[0].centres.high[a], 0.01, "volume 0 (from 0): its box");
        assert_place_is_checked(atlas, &atlas->volumes[2].info.spacing[a], 0.01, "volume 2 (from 0): its matrices");
    }
    assert_ok(pack_check_atlas(atlas));
    conus_atlas_destroy(atlas);
    bytes_finish(&bytes);
}

/* Each number is put into the first, an inner and the last voxel, which sound numbers hold. */
static void assert_taken(const conus_atlas *atlas, uint16_t *numbers, const bool taken[4])
{
    static const uint16_t tried[] = {0, 1, 2, 3, 4, 255, 256, 32767, 32768, 65533, 65534, 65535};
    const size_t count = atlas->volumes[0].voxel_count;
    const size_t places[] = {0, count / 2 + 3, count - 1};
    for (size_t i = 0; i < sizeof tried / sizeof tried[0]; i++) {
        for (size_t k = 0; k < 3; k++) {
            const uint16_t was = numbers[places[k]];
            numbers[places[k]] = tried[i];
            const bool is_sound = pack_check_atlas(atlas) == CONUS_OK || strstr(conus_message(), "its box");
            assert_true(is_sound == (tried[i] < 4 && taken[tried[i]]));
            numbers[places[k]] = was;
        }
    }
}

/* The second object is made one of a surface, so the volume's numbers have a gap. */
static void a_volume_has_numbers_of_its_own_objects_only(void **state)
{
    (void)state;
    struct bytes bytes = make_pack();
    conus_atlas *atlas = NULL;
    assert_ok(conus_atlas_load(&atlas, pack_path, NULL));
    struct volume *volume = &atlas->volumes[0];
    uint16_t *numbers = memory_copy(volume->objects16, volume->voxel_count, sizeof *numbers);
    const uint16_t *packed = volume->objects16;
    assert_non_null(numbers);
    assert_ok(pack_check_atlas(atlas));
    atlas->places[1].is_mesh = true;
    assert_fails(pack_check_atlas(atlas), CONUS_ERROR_DATA);
    assert_non_null(strstr(conus_message(), "volume 0 (from 0): a voxel has an object that is not in it"));
    for (size_t v = 0; v < volume->voxel_count; v++) {
        numbers[v] = numbers[v] == 2 ? 0 : numbers[v];
    }
    volume->objects16 = numbers;
    assert_ok(pack_check_atlas(atlas));
    assert_taken(atlas, numbers, (const bool[4]){true, true, false, true});
    atlas->places[1].is_mesh = false;
    assert_taken(atlas, numbers, (const bool[4]){true, true, true, true});
    for (size_t v = 0; v < volume->voxel_count; v++) {
        numbers[v] = numbers[v] == 3 ? 3 : 0;
    }
    atlas->places[0].is_mesh = atlas->places[1].is_mesh = true;
    assert_taken(atlas, numbers, (const bool[4]){true, false, false, true});
    memset(numbers, 0, volume->voxel_count * sizeof *numbers);
    atlas->places[2].is_mesh = true;
    assert_taken(atlas, numbers, (const bool[4]){true});
    volume->objects16 = (uint16_t *)packed;
    memory_free(numbers);
    conus_atlas_destroy(atlas);
    bytes_finish(&bytes);
}

/* Behind the first PACK_CHUNK, too, with its place. */
static void damage_far_behind_is_found(void **state)
{
    (void)state;
    char path[400];
    uint8_t byte;
    conus_atlas *atlas = NULL;
    snprintf(path, sizeof path, "%s", test_scratch("large"));
    assert_ok(conus_phantom_write("sphere", path, &(const conus_phantom_options){.size = 192}));
    snprintf(path, sizeof path, "%s/sphere.nii.gz", test_scratch("large"));
    assert_ok(conus_atlas_load(&atlas, path, NULL));
    keep_path("large.conus");
    assert_ok(conus_atlas_save(pack_path, atlas, NULL));
    conus_atlas_destroy(atlas);
    assert_ok(conus_atlas_load(&atlas, pack_path, NULL));
    conus_atlas_destroy(atlas);
    int file = open(pack_path, O_RDWR);
    const off_t at = PACK_PAGE + PACK_CHUNK + 5;
    assert_int_equal(pread(file, &byte, 1, at), 1);
    byte ^= 4;
    assert_int_equal(pwrite(file, &byte, 1, at), 1);
    close(file);
    assert_fails(conus_atlas_load(&atlas, pack_path, NULL), CONUS_ERROR_DATA);
    assert_non_null(strstr(conus_message(), "is damaged between the bytes 16781312 and "));
    unlink(pack_path);
}

static conus_status load_atlas(void *data)
{
    conus_atlas *atlas = NULL;
    conus_status status = conus_atlas_load(&atlas, data, NULL);
    conus_atlas_destroy(atlas);
    return status;
}

static conus_status save_atlas(void *data)
{
    return conus_atlas_save(pack_path, data, NULL);
}

static void every_failing_allocation_is_an_error(void **state)
{
    (void)state;
    struct bytes bytes = make_pack();
    conus_atlas *atlas = make_atlas();
    test_every_allocation(load_atlas, pack_path);
    test_every_allocation(save_atlas, atlas);
    conus_atlas_destroy(atlas);
    bytes_finish(&bytes);
}

/* The states of all sources, "same same changed", and whether a warning says so. */
static void assert_states(const char *path, const char *wanted)
{
    static const char *const words[] = {"same", "changed", "gone"};
    char found[200] = "";
    conus_atlas *atlas = NULL;
    conus_source_state one;
    bool warns = false;
    assert_ok(conus_atlas_load(&atlas, path, NULL));
    for (size_t i = 0; conus_atlas_pack_source(&one, atlas, i); i++) {
        size_t size = strlen(found);
        snprintf(found + size, sizeof found - size, "%s%s", i ? " " : "", words[one]);
    }
    assert_string_equal(found, wanted);
    for (size_t i = 0; i < conus_atlas_note_count(atlas); i++) {
        warns = warns || (strstr(conus_atlas_note(atlas, i), "changed since; pack it again: words") &&
                          conus_atlas_note_severity(atlas, i) == CONUS_SEVERITY_WARNING);
    }
    assert_int_equal(warns, strstr(wanted, "changed") != NULL);
    conus_atlas_destroy(atlas);
}

static void sources_are_looked_for_and_compared(void **state)
{
    (void)state;
    char folder[256];
    char moved[300];
    char path[320];
    char names[320];
    struct bytes bytes = {0};
    conus_atlas *atlas = NULL;
    snprintf(folder, sizeof folder, "%s", test_scratch("sources"));
    snprintf(moved, sizeof moved, "%s-moved", folder);
    assert_ok(conus_phantom_write("sphere", folder, NULL));
    snprintf(path, sizeof path, "%s/sphere.nii.gz", folder);
    assert_ok(conus_atlas_load(&atlas, path, NULL));
    snprintf(pack_path, sizeof pack_path, "%s/s.conus", folder);
    assert_ok(conus_atlas_save(pack_path, atlas, &(const conus_save_options){.words = "words"}));
    assert_states(pack_path, "same same");
    char far[320];
    char below[320];
    snprintf(far, sizeof far, "%s", test_scratch("far.conus"));
    snprintf(below, sizeof below, "%s/below", folder);
    assert_int_equal(mkdir(below, 0700), 0);
    snprintf(below, sizeof below, "%s/below/s.conus", folder);
    assert_ok(conus_atlas_save(below, atlas, &(const conus_save_options){.words = "words"}));
    assert_int_equal(rename(below, far), 0); /* the pack alone: by their whole paths */
    assert_states(far, "same same");
    assert_int_equal(rename(far, below), 0);
    assert_int_equal(rename(folder, moved), 0); /* together */
    snprintf(below, sizeof below, "%s/below/s.conus", moved);
    assert_states(below, "same same");
    snprintf(pack_path, sizeof pack_path, "%s/s.conus", moved);
    assert_states(pack_path, "same same");
    snprintf(names, sizeof names, "%s/sphere.tsv", moved);
    assert_ok(file_read(&bytes, names, 10000));
    const struct timespec times[2] = {{1000000000, 0}, {1000000000, 0}};
    assert_int_equal(utimensat(AT_FDCWD, names, times, 0), 0); /* the same bytes at another time */
    assert_states(pack_path, "same same");
    bytes.data[bytes.size - 2] ^= 1;
    assert_ok(file_write(names, bytes.data, bytes.size));
    assert_states(pack_path, "changed same");
    assert_int_equal(unlink(names), 0);
    assert_states(pack_path, "gone same");
    bytes_finish(&bytes);
    conus_atlas_destroy(atlas);
}

static void a_source_that_changed_before_it_was_packed_is_an_error(void **state)
{
    (void)state;
    char folder[256];
    char path[320];
    conus_atlas *atlas = NULL;
    snprintf(folder, sizeof folder, "%s", test_scratch("changing"));
    assert_ok(conus_phantom_write("sphere", folder, NULL));
    snprintf(path, sizeof path, "%s/sphere.nii.gz", folder);
    assert_ok(conus_atlas_load(&atlas, path, NULL));
    assert_ok(conus_phantom_write("torus", folder, NULL));
    snprintf(pack_path, sizeof pack_path, "%s/torus.nii.gz", folder);
    assert_int_equal(rename(pack_path, path), 0);
    snprintf(pack_path, sizeof pack_path, "%s/s.conus", folder);
    assert_fails(conus_atlas_save(pack_path, atlas, NULL), CONUS_ERROR_IO);
    assert_int_equal(access(pack_path, F_OK), -1);
    conus_atlas_destroy(atlas);
}

static void what_is_read_is_given_when_packing(void **state)
{
    (void)state;
    struct bytes bytes = make_pack();
    conus_atlas *atlas = NULL;
    conus_tractogram *tractogram = NULL;
    assert_fails(conus_atlas_load(&atlas, pack_path, &(const conus_load_options){.labels = "x.txt"}),
                 CONUS_ERROR_ARGUMENT);
    assert_fails(conus_atlas_load(&atlas, pack_path, &(const conus_load_options){.probability = 0.5}),
                 CONUS_ERROR_ARGUMENT);
    assert_fails(conus_tractogram_load(&tractogram, pack_path, NULL), CONUS_ERROR_DATA);
    assert_non_null(strstr(conus_message(), "conus pack"));
    bytes_finish(&bytes);
}

static void older_readers_are_a_warning(void **state)
{
    (void)state;
    struct bytes bytes = make_pack();
    struct pack_head head;
    conus_atlas *atlas = NULL;
    memcpy(&head, bytes.data, sizeof head);
    head.readers = PACK_READERS - 1;
    set_head(&bytes, head);
    assert_ok(file_write(pack_path, bytes.data, bytes.size));
    assert_ok(conus_atlas_load(&atlas, pack_path, NULL));
    size_t last = conus_atlas_note_count(atlas) - 1;
    assert_non_null(
        strstr(conus_atlas_note(atlas, last), "readers were mended since; pack it again: conus pack v.nii"));
    assert_int_equal(conus_atlas_note_severity(atlas, last), CONUS_SEVERITY_WARNING);
    conus_atlas_destroy(atlas);
    bytes_finish(&bytes);
}

TEST_GROUP(pack_file)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_change_of_layout_is_a_change_of_format),
        cmocka_unit_test(what_is_opened_is_what_was_packed),
        cmocka_unit_test(every_cut_is_refused),
        cmocka_unit_test(every_flipped_bit_is_refused),
        cmocka_unit_test(each_field_of_the_head_is_refused_or_means_nothing),
        cmocka_unit_test(other_heads_are_refused_by_what_they_say),
        cmocka_unit_test(no_number_leads_out_of_a_pack_with_right_sums),
        cmocka_unit_test(a_text_that_is_not_there_or_does_not_end_is_refused),
        cmocka_unit_test(boxes_are_those_of_what_is_in_them),
        cmocka_unit_test(a_volume_has_numbers_of_its_own_objects_only),
        cmocka_unit_test(damage_far_behind_is_found),
        cmocka_unit_test(every_failing_allocation_is_an_error),
        cmocka_unit_test(sources_are_looked_for_and_compared),
        cmocka_unit_test(a_source_that_changed_before_it_was_packed_is_an_error),
        cmocka_unit_test(what_is_read_is_given_when_packing),
        cmocka_unit_test(older_readers_are_a_warning),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
