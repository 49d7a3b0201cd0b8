/* SPDX-License-Identifier: BSD-3-Clause */
/* Cryptomatte: hashes, and pixels that lead to names. */
#include "base/geometry/math3.h"
#include "render/image/image.h"
#include "scene.h"
#include "selection/picture/cryptomatte.h"
#include "test.h"

#include <stdio.h>
#include <string.h>

/* Values of MurmurHash3_x86_32 with seed 0 as others publish them. */
static void hashes_are_murmur3(void **state)
{
    (void)state;
    assert_int_equal(cryptomatte_hash("hello"), 0x248bfa47);
    assert_int_equal(cryptomatte_hash("hello, world"), 0x149bbb7f);
    assert_int_equal(cryptomatte_hash("The quick brown fox jumps over the lazy dog"), 0x2e4ff723);
}

/* The hash of "" is 0, the bits of a denormal: one bit of the exponent is set. */
static void hashes_are_normal_floats(void **state)
{
    (void)state;
    assert_int_equal(cryptomatte_hash(""), 0x00800000);
    for (int i = 0; i < 100000; i++) {
        char name[16];
        snprintf(name, sizeof name, "area %d", i);
        uint32_t exponent = cryptomatte_hash(name) >> 23 & 255;
        assert_true(exponent > 0 && exponent < 255);
    }
}

static const char *attribute(const conus_image *image, const char *end)
{
    for (size_t i = 0; i < image->attribute_count; i++) {
        const char *name = image->attributes[i].name;
        if (strncmp(name, "cryptomatte/", 12) == 0 && strcmp(name + 19, end) == 0) {
            return image->attributes[i].text;
        }
    }
    return NULL;
}

/* Every pixel's hash stands in the manifest with the object's name, and covers it wholly. */
enum { PIXELS = CONUS_RESOLUTION_DEFAULT * CONUS_RESOLUTION_DEFAULT };

static void pixels_lead_to_names(void **state)
{
    (void)state;
    uint64_t seed = 9;
    conus_atlas *atlas = scene_atlas(&seed, 20, 1);
    conus_selector *selector = NULL;
    conus_selection *selection = NULL;
    conus_image *image = NULL;
    conus_pose pose;
    const conus_volume_info *info = conus_atlas_volume(atlas, 0);
    double target[3] = {(double)info->dim[0] / 2, (double)info->dim[1] / 2, (double)info->dim[2] / 2};
    double origin[3] = {-2.0 * (double)info->dim[0], -1, -2};
    mat4_point(target, info->world_from_voxel, target);
    mat4_point(origin, info->world_from_voxel, origin);
    assert_ok(conus_selector_create(&selector, atlas, NULL));
    assert_ok(conus_pose_toward(&pose, origin, target, NULL));
    assert_ok(conus_select(&selection, selector, &pose, radians_from_degrees(35)));
    assert_ok(conus_image_of_selection(&image, selection));
    assert_string_equal(attribute(image, "/name"), "CryptoObject");
    assert_string_equal(attribute(image, "/hash"), "MurmurHash3_32");
    assert_string_equal(attribute(image, "/conversion"), "uint32_to_float32");
    size_t hit = 0;
    for (size_t i = 0; i < PIXELS; i++) {
        uint32_t number = conus_image_uints(image, "object")[i];
        uint32_t hash;
        memcpy(&hash, &conus_image_floats(image, "CryptoObject00.R")[i], sizeof hash);
        assert_near(conus_image_floats(image, "CryptoObject00.G")[i], number ? 1 : 0, 0);
        if (number) {
            char entry[256];
            snprintf(entry, sizeof entry, "\"%s\":\"%08x\"", conus_atlas_object(atlas, number)->name, hash);
            assert_non_null(strstr(attribute(image, "/manifest"), entry));
            hit++;
        } else {
            assert_int_equal(hash, 0);
        }
    }
    assert_true(hit > 0 && hit < PIXELS);
    conus_image_destroy(image);
    conus_selection_destroy(selection);
    conus_selector_destroy(selector);
    conus_atlas_destroy(atlas);
}

TEST_GROUP(cryptomatte)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(hashes_are_murmur3),
        cmocka_unit_test(hashes_are_normal_floats),
        cmocka_unit_test(pixels_lead_to_names),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
