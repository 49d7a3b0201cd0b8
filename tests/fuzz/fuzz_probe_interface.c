/* SPDX-License-Identifier: BSD-3-Clause */
/* Contacts of an accepted probe lie above its tip, have different names, and go where a pose puts them. */
#include "base/geometry/math3.h"
#include "conus/own.h"
#include "poses/programs/pose_programs.h"

#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void check(bool fine)
{
    if (!fine) {
        abort();
    }
}

static void read_probe(struct text text, double tip)
{
    const conus_pose pose = {{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}};
    conus_probe *probe = NULL;
    conus_pose_list *list = NULL;
    if (probe_parse(&probe, text, &(conus_probe_options){.tip = tip})) {
        return;
    }
    size_t count = conus_probe_contact_count(probe);
    check(count > 0 && conus_probe_count(probe) > 0);
    for (size_t i = 0; i < count; i++) {
        const conus_probe_contact *contact = conus_probe_at(probe, i);
        check(vec3_is_finite(contact->offset) && contact->offset[2] >= 0 && contact->index < conus_probe_count(probe));
        check(contact->id[0] && contact->channel >= -2);
        check(i == 0 || strcmp(conus_probe_at(probe, i - 1)->id, contact->id) != 0);
    }
    if (conus_probe_count(probe) == 1) {
        check(conus_probe_place(&list, probe, &pose, 1, 0) == CONUS_OK && conus_pose_list_count(list) == count);
    }
    conus_pose_list_destroy(list);
    conus_probe_destroy(probe);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    const struct text text = {(const char *)data, size};
    read_probe(text, 0);
    read_probe(text, 0.2);
    return 0;
}
