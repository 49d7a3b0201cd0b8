// SPDX-License-Identifier: BSD-3-Clause
// What is looked for in an OBJ file: every face is in an object that has a name of its own, and what the first lines
// say does not depend on those that follow.
#include "mesh/failure.hpp"
#include "mesh/obj_file.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <set>

extern "C" int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static bool parses(Objects &out, std::string_view content)
{
    try {
        out = parse_obj(content);
    } catch (const Failure &) {
        return false;
    }
    return true;
}

template <typename Item> static bool begins_with(const std::vector<Item> &whole, const std::vector<Item> &part)
{
    return part.size() <= whole.size() && std::equal(part.begin(), part.end(), whole.begin());
}

static void check_objects(const Objects &objects)
{
    const std::set<std::string> names(objects.names.begin(), objects.names.end());
    const std::set<uint32_t> used(objects.of_face.begin(), objects.of_face.end());
    if (names.size() != objects.names.size() || used.size() != names.size() ||
        (!used.empty() && *used.rbegin() != names.size() - 1)) {
        std::abort();
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    const std::string_view content(reinterpret_cast<const char *>(data), size);
    Objects whole, part;
    if (!parses(whole, content)) {
        return 0;
    }
    check_objects(whole);
    const size_t middle = content.find('\n', size / 2);
    if (middle != std::string_view::npos &&
        !(parses(part, content.substr(0, middle + 1)) && begins_with(whole.names, part.names) &&
          begins_with(whole.of_face, part.of_face))) {
        std::abort();
    }
    return 0;
}
