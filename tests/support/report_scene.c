/* SPDX-License-Identifier: BSD-3-Clause */
/* An atlas and its answers, for reports. */
#include "report_scene.h"

#include "base/geometry/math3.h"
#include "scene.h"
#include "test.h"

struct report_scene report_scene_create(void)
{
    return report_scene_create_from(8);
}

struct report_scene report_scene_create_from(uint64_t seed)
{
    struct report_scene scene = {.atlas = scene_atlas(&seed, 14, 1)};
    const conus_pose pose = scene_generic_pose(&seed, scene.atlas);
    const conus_jitter_options errors = {.tilt = 0.1 * 180 / MATH3_PI, .shift = 2, .samples = 16};
    assert_ok(conus_selector_create(&scene.selector, scene.atlas, NULL));
    assert_ok(conus_select(&scene.cone, scene.selector, &pose, degrees_from_radians(1)));
    assert_ok(conus_sweep(&scene.sweep, scene.selector, &pose, degrees_from_radians(1)));
    assert_ok(conus_jitter(&scene.jitter, scene.selector, &pose, degrees_from_radians(1), &errors));
    for (int i = 0; i < 2; i++) {
        const double *at = pose.world_from_device + 12;
        const double centre[3] = {at[0], at[1], at[2] + i};
        assert_ok(conus_select_ball(&scene.contacts[i], scene.selector, centre, 9));
    }
    return scene;
}

void report_scene_destroy(struct report_scene *scene)
{
    conus_table_destroy(scene->jitter);
    conus_table_destroy(scene->sweep);
    conus_selection_destroy(scene->contacts[0]);
    conus_selection_destroy(scene->contacts[1]);
    conus_selection_destroy(scene->cone);
    conus_selector_destroy(scene->selector);
    conus_atlas_destroy(scene->atlas);
}

static conus_status select_and_report(void *data)
{
    const struct report_attempt *attempt = data;
    conus_selector *selector = NULL;
    conus_selection *selection = NULL;
    conus_report *report = NULL;
    conus_status status = conus_selector_create(&selector, attempt->atlas, &attempt->options);
    if (!status) {
        status = attempt->radius > 0 ? conus_select_ball(&selection, selector, attempt->centre, attempt->radius)
                                     : conus_select(&selection, selector, &attempt->pose, attempt->angle);
    }
    status = status ? status : conus_report_create(&report, selector, &attempt->report);
    status = status ? status : conus_report_add(report, "1", selection);
    conus_report_destroy(report);
    conus_selection_destroy(selection);
    conus_selector_destroy(selector);
    return status;
}

void report_every_allocation(const struct report_attempt *attempt)
{
    struct report_attempt copy = *attempt;
    test_every_allocation(select_and_report, &copy);
}
