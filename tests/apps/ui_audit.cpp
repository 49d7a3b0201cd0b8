// SPDX-License-Identifier: BSD-3-Clause
// Keeps the texts that are cut, while a test asks for them.
#include "ui_audit.h"

#include "viewer/ui/parts.h"

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

namespace
{

struct heard {
    std::vector<std::string> cut;
    std::vector<std::string> untold; // and the newest widget, until its tip comes
    std::vector<std::string> texts;
    std::vector<ImVec2> places; // of those
    ImVec2 at;                  // of the newest widget
    ImVec2 size;
} heard;

const float told = 1; // pixel: less is rounding

// A text at this place, which does not end where it should.
void note(const char *text, ImVec2 at, bool is_cut)
{
    heard.texts.emplace_back(text);
    heard.places.push_back(at);
    if (is_cut) {
        heard.cut.emplace_back(text);
    }
}

void report(audit_event event, const char *text, float room)
{
    const ImVec2 low = ImGui::GetItemRectMin();
    const ImVec2 high = ImGui::GetItemRectMax();
    if (event == AUDIT_ITEM) {
        const ImDrawList *list = ImGui::GetWindowDrawList();
        const ImVec2 least = list->GetClipRectMin();
        const ImVec2 most = list->GetClipRectMax();
        const bool is_seen = high.y > least.y && low.y < most.y;
        note(text, low, is_seen && (low.x < least.x - told || high.x > most.x + told));
    } else if (event == AUDIT_WITHIN) {
        note(text, ImGui::GetCursorScreenPos(), ImGui::CalcTextSize(text, nullptr, true).x > room + told);
    } else if (event == AUDIT_WIDGET) {
        heard.untold.emplace_back(text);
        heard.at = low;
    } else if (!heard.untold.empty() && low.x == heard.at.x && low.y == heard.at.y) {
        heard.untold.pop_back();
    }
}

} // namespace

extern "C" {

void ui_audit_begin(void)
{
    heard.cut.clear();
    heard.untold.clear();
    heard.texts.clear();
    heard.places.clear();
    ImGui::GetIO().DisplaySize = heard.size;
    ImGui::NewFrame();
}

void ui_audit_end(void)
{
    ImGui::Render();
}

const char *ui_audit_cut(size_t index)
{
    return index < heard.cut.size() ? heard.cut[index].c_str() : nullptr;
}

const char *ui_audit_untold(size_t index)
{
    return index < heard.untold.size() ? heard.untold[index].c_str() : nullptr;
}

size_t ui_audit_count(void)
{
    return heard.texts.size();
}

bool ui_audit_at(float at[2], const char *text)
{
    const size_t index = ui_audit_place(text);
    if (index < heard.places.size()) {
        at[0] = heard.places[index].x;
        at[1] = heard.places[index].y;
    }
    return index < heard.places.size();
}

size_t ui_audit_place(const char *text)
{
    const std::vector<std::string> &texts = heard.texts;
    auto found = std::find(texts.begin(), texts.end(), text);
    return found == texts.end() ? SIZE_MAX : static_cast<size_t>(found - texts.begin());
}

bool ui_audit_colour(ui_colour *out, const char **name, size_t index)
{
    if (index >= ImGuiCol_COUNT) {
        return false;
    }
    ImU32 packed = ImGui::ColorConvertFloat4ToU32(ImGui::GetStyle().Colors[index]);
    *name = ImGui::GetStyleColorName(static_cast<ImGuiCol>(index));
    *out = {static_cast<uint8_t>(packed >> IM_COL32_R_SHIFT), static_cast<uint8_t>(packed >> IM_COL32_G_SHIFT),
            static_cast<uint8_t>(packed >> IM_COL32_B_SHIFT), static_cast<uint8_t>(packed >> IM_COL32_A_SHIFT)};
    return true;
}

bool ui_audit_create(float scale, float width, float height)
{
    ImGui::CreateContext();
    ImGuiIO &io = ImGui::GetIO();
    unsigned char *pixels;
    int wide;
    int high;
    static const audit_listener listener = {report};
    heard.size = ImVec2(width, height);
    io.IniFilename = nullptr;
    io.UserData = const_cast<audit_listener *>(&listener);
    bool fine = ui_style(scale);
    io.Fonts->GetTexDataAsRGBA32(&pixels, &wide, &high);
    return fine;
}

} // extern "C"
