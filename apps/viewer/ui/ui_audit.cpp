// SPDX-License-Identifier: BSD-3-Clause
// Keeps the texts that are cut, while a test asks for them.
#include "viewer/ui/ui_audit.h"

#include <imgui.h>

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

namespace
{

struct audit {
    std::vector<std::string> cut;
    std::vector<std::string> untold; // and the newest widget, until its tip comes
    std::vector<std::string> texts;
    std::vector<ImVec2> places; // of those
    ImVec2 at;                  // of the newest widget
    ImVec2 size;
};

const float told = 1; // pixel: less is rounding

audit *current()
{
    return static_cast<audit *>(ImGui::GetIO().UserData);
}

} // namespace

bool audit_runs(void)
{
    return current();
}

void audit_item(const char *text)
{
    audit *audit = current();
    if (!audit) {
        return;
    }
    const ImDrawList *list = ImGui::GetWindowDrawList();
    ImVec2 low = list->GetClipRectMin();
    ImVec2 high = list->GetClipRectMax();
    bool is_seen = ImGui::GetItemRectMax().y > low.y && ImGui::GetItemRectMin().y < high.y;
    audit->texts.emplace_back(text);
    audit->places.push_back(ImGui::GetItemRectMin());
    if (is_seen && (ImGui::GetItemRectMin().x < low.x - told || ImGui::GetItemRectMax().x > high.x + told)) {
        audit->cut.emplace_back(text);
    }
}

void audit_widget(const char *label)
{
    if (audit *audit = current()) {
        audit->untold.emplace_back(label);
        audit->at = ImGui::GetItemRectMin();
    }
}

void audit_tip(void)
{
    audit *audit = current();
    ImVec2 at = ImGui::GetItemRectMin();
    if (audit && !audit->untold.empty() && at.x == audit->at.x && at.y == audit->at.y) {
        audit->untold.pop_back();
    }
}

void audit_within(const char *text, float room)
{
    audit *audit = current();
    if (!audit) {
        return;
    }
    audit->texts.emplace_back(text);
    audit->places.push_back(ImGui::GetCursorScreenPos());
    if (ImGui::CalcTextSize(text, nullptr, true).x > room + told) {
        audit->cut.emplace_back(text);
    }
}

extern "C" {

void ui_audit_begin(void)
{
    audit *audit = current();
    audit->cut.clear();
    audit->untold.clear();
    audit->texts.clear();
    audit->places.clear();
    ImGui::GetIO().DisplaySize = audit->size;
    ImGui::NewFrame();
}

void ui_audit_end(void)
{
    ImGui::Render();
}

const char *ui_audit_cut(size_t index)
{
    const audit *audit = current();
    return index < audit->cut.size() ? audit->cut[index].c_str() : nullptr;
}

const char *ui_audit_untold(size_t index)
{
    const audit *audit = current();
    return index < audit->untold.size() ? audit->untold[index].c_str() : nullptr;
}

size_t ui_audit_count(void)
{
    return current()->texts.size();
}

bool ui_audit_at(float at[2], const char *text)
{
    const size_t index = ui_audit_place(text);
    if (index < current()->places.size()) {
        at[0] = current()->places[index].x;
        at[1] = current()->places[index].y;
    }
    return index < current()->places.size();
}

size_t ui_audit_place(const char *text)
{
    const std::vector<std::string> &texts = current()->texts;
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
    static audit audit;
    audit.size = ImVec2(width, height);
    io.IniFilename = nullptr;
    io.UserData = &audit;
    bool fine = ui_style(scale);
    io.Fonts->GetTexDataAsRGBA32(&pixels, &wide, &high);
    return fine;
}

} // extern "C"
