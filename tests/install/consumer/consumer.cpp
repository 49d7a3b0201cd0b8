// SPDX-License-Identifier: BSD-3-Clause
// As consumer.c, in C++, with the initialisers of options.
#include "conus/selection.h"
#include "conus/version.h"

#include <iostream>
#include <memory>
#include <stdexcept>

template <typename T, void (*destroy)(T *)> struct Destroyer {
    void operator()(T *object) const
    {
        destroy(object);
    }
};
using Atlas = std::unique_ptr<conus_atlas, Destroyer<conus_atlas, conus_atlas_destroy>>;
using Selector = std::unique_ptr<conus_selector, Destroyer<conus_selector, conus_selector_destroy>>;
using Selection = std::unique_ptr<conus_selection, Destroyer<conus_selection, conus_selection_destroy>>;

static int check(conus_status status)
{
    if (status) {
        throw std::runtime_error(conus_message());
    }
    return 0;
}

int main(int count, char **words)
try {
    conus_atlas *atlas = nullptr;
    conus_selector *selector = nullptr;
    conus_selection *selection = nullptr;
    conus_load_options options = CONUS_LOAD_OPTIONS_INIT;
    conus_pose pose;
    const double origin[3] = {0, 0, 60}, target[3] = {0, 0, 0};
    check(conus_pose_toward(&pose, origin, target, nullptr));
    check(conus_atlas_load(&atlas, count > 1 ? words[1] : "", &options));
    const Atlas atlas_owner(atlas);
    check(conus_selector_create(&selector, atlas, nullptr));
    const Selector selector_owner(selector);
    check(conus_select(&selection, selector, &pose, 40));
    const Selection selection_owner(selection);
    const conus_result *best = conus_selection_result(selection, 0);
    std::cout << conus_version() << ' ' << conus_atlas_object(atlas, best->object)->name << '\n';
    return 0;
} catch (const std::exception &error) {
    std::cerr << error.what() << '\n';
    return 1;
}
