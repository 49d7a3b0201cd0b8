// SPDX-License-Identifier: BSD-3-Clause
// Checks an OBJ file's statements before VTK reads them.
#include "obj_file.hpp"

#include "failure.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>

namespace
{

constexpr std::string_view SPACES = " \t\r\v\f";

/* Takes the first word off `text`; "" where there is none. */
std::string_view take_word(std::string_view &text)
{
    text.remove_prefix(std::min(text.find_first_not_of(SPACES), text.size()));
    const std::string_view word = text.substr(0, text.find_first_of(SPACES));
    text.remove_prefix(word.size());
    return word;
}

/* One that is too large for a double is left to VTK and conus, which refuses what is not finite. */
bool is_number(std::string_view word)
{
    if (word.size() > 1 && word[0] == '+' && word[1] != '-') {
        word.remove_prefix(1);
    }
    double value = 0;
    const char *end = word.data() + word.size();
    const std::from_chars_result found = std::from_chars(word.data(), end, value);
    return found.ec != std::errc::invalid_argument && found.ptr == end && std::isfinite(value);
}

bool is_vertex(std::string_view numbers)
{
    int found = 0;
    while (found < 3 && is_number(take_word(numbers))) {
        found++;
    }
    return found == 3;
}

std::string_view trim(std::string_view text)
{
    text.remove_prefix(std::min(text.find_first_not_of(SPACES), text.size()));
    return text.substr(0, text.find_last_not_of(SPACES) + 1);
}

} // namespace

Objects parse_obj(std::string_view content)
{
    Objects objects;
    std::map<std::string_view, uint32_t> numbers;
    std::string_view name;
    if (content.find('\0') != std::string_view::npos) {
        throw Failure("content: binary data, an OBJ file is text");
    }
    for (size_t n = 1; !content.empty(); n++) {
        const std::string_view line = content.substr(0, content.find('\n'));
        content.remove_prefix(std::min(line.size() + 1, content.size()));
        std::string_view rest = line;
        const std::string_view word = take_word(rest);
        if (word == "v" && !is_vertex(rest)) {
            throw Failure("line " + std::to_string(n) + ": \"" + std::string(line.substr(0, 60)) +
                          "\", a vertex is three numbers");
        }
        if (word == "o") {
            name = trim(rest);
        } else if (word == "f" && !rest.empty()) {
            const auto number = numbers.emplace(name, static_cast<uint32_t>(objects.names.size()));
            if (number.second) {
                objects.names.emplace_back(name);
            }
            objects.of_face.push_back(number.first->second);
        }
    }
    return objects;
}
