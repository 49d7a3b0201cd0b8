// SPDX-License-Identifier: BSD-3-Clause
// The widgets of ui.h, by Dear ImGui.
#include "viewer/ui/ui.h"

#include "viewer/ui/parts.h"

#include "base/look.h"

#include <imgui.h>
#include <imgui_internal.h>

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <string>
#include <vector>

/* The text, or its beginning with "...", whole characters of UTF-8. */
static std::string cut_to(const char *text, float room)
{
    std::string shown(text);
    if (ImGui::CalcTextSize(text).x <= room) {
        return shown;
    }
    while (!shown.empty() && ImGui::CalcTextSize((shown + "\u2026").c_str()).x > room) {
        while ((shown.back() & 0xc0) == 0x80) {
            shown.pop_back();
        }
        shown.pop_back();
    }
    return shown + "\u2026";
}

/* The name, or its beginning and its end with "..." between them: the end tells left from right. */
static std::string cut_name(const char *name, float room)
{
    std::vector<size_t> starts; // of characters of UTF-8
    for (size_t i = 0; i < std::strlen(name); i++) {
        if ((name[i] & 0xc0) != 0x80) {
            starts.push_back(i);
        }
    }
    std::string shown(name);
    for (size_t kept = starts.size(); ImGui::CalcTextSize(shown.c_str()).x > room && kept > 0; kept--) {
        size_t end = (kept - 1) / 3; // characters of its end
        size_t begun = kept - 1 - end;
        shown = std::string(name, starts[begun]) + "\u2026" + (end ? name + starts[starts.size() - end] : "");
    }
    return shown;
}

static float width_of(const float *widths, size_t count)
{
    float wanted = ImGui::GetStyle().ScrollbarSize;
    for (size_t i = 0; i < count; i++) {
        wanted += widths[i] + 2 * ImGui::GetStyle().CellPadding.x + 1;
    }
    return wanted;
}

static bool fits(const float *widths, size_t count)
{
    return width_of(widths, count) <= ImGui::GetContentRegionAvail().x;
}

extern "C" {

float ui_list_line(void)
{
    return ImGui::GetTextLineHeight() + 2 * ImGui::GetStyle().CellPadding.y;
}

size_t ui_list_fit(float *widths, size_t count, size_t least)
{
    float name = widths[0];
    widths[0] = fits(widths, count) ? name : name * 2 / 3;
    while (count > least && !fits(widths, count)) {
        count--;
    }
    float narrow = widths[0];
    widths[0] = fits(widths, count) ? narrow : 2 * ui_line(); // it gets all that the others leave
    widths[0] = fits(widths, count) ? widths[0] : narrow;
    return count;
}

bool ui_list(const char *id, const float *widths, size_t count, float height)
{
    bool whole = fits(widths, count);
    ImGuiTableFlags flags = ImGuiTableFlags_ScrollY | ImGuiTableFlags_SizingFixedFit | ImGuiTableFlags_BordersInnerH |
                            ImGuiTableFlags_NoSavedSettings | (whole ? 0 : ImGuiTableFlags_ScrollX);
    ImGui::PushID(whole ? "fits" : "scrolls"); // a table keeps the flags of its columns
    ImGui::PushID(static_cast<int>(count));
    const ImGuiTable *before = ImGui::TableFindByID(ImGui::GetID(id)); // without a bar its room is free: nothing moves
    const bool has_bar = before && before->InnerWindow && before->InnerWindow->ScrollbarY;
    const float width = has_bar ? 0 : -ImGui::GetStyle().ScrollbarSize;
    if (!ImGui::BeginTable(id, static_cast<int>(count), flags, ImVec2(width, height))) {
        ImGui::PopID();
        ImGui::PopID();
        return false;
    }
    ImGui::TableSetupScrollFreeze(whole ? 0 : 1, 1);
    for (size_t i = 0; i < count; i++) {
        bool takes_rest = i == 0 && whole;
        ImGui::TableSetupColumn("", takes_rest ? ImGuiTableColumnFlags_WidthStretch : ImGuiTableColumnFlags_WidthFixed,
                                takes_rest ? 1 : widths[i]);
    }
    return true;
}

void ui_list_end(void)
{
    ImGui::EndTable();
    ImGui::PopID();
    ImGui::PopID();
}

void ui_list_top(void)
{
    ImGui::TableNextRow(ImGuiTableRowFlags_Headers);
}

bool ui_list_heading(const char *text, bool right)
{
    ImGui::TableNextColumn();
    audit(AUDIT_WITHIN, text, ui_room());
    ImGui::PushStyleVar(ImGuiStyleVar_SelectableTextAlign, ImVec2(right ? 1.0F : 0.0F, 0));
    bool pressed = ImGui::Selectable(text);
    ImGui::PopStyleVar();
    return pressed;
}

bool ui_table(const char *id, const char *const *headings, const float *widths, size_t count, float height)
{
    if (width_of(widths, count) > ImGui::GetContentRegionAvail().x) {
        audit(AUDIT_WITHIN, id, 0); // its last columns are out of sight
    }
    if (!ui_list(id, widths, count, height)) {
        return false;
    }
    ui_list_top();
    for (size_t i = 0; i < count; i++) {
        ImGui::TableNextColumn();
        audit(AUDIT_WITHIN, headings[i], ui_room());
        ImGui::TextUnformatted(headings[i]);
    }
    return true;
}

bool ui_list_row(void)
{
    float line = ui_list_line();
    ImGui::TableNextRow();
    ImGui::TableNextColumn();
    ImVec2 at = ImGui::GetCursorScreenPos();
    bool seen = ImGui::IsRectVisible(ImVec2(at.x, at.y - 2 * line), ImVec2(at.x + 1, at.y + 3 * line));
    if (!seen) {
        ImGui::Dummy(ImVec2(1, ImGui::GetTextLineHeight()));
    }
    return seen;
}

void ui_text_right(const char *text)
{
    audit(AUDIT_WITHIN, text, ui_room());
    float blank = ImGui::GetContentRegionAvail().x - ImGui::CalcTextSize(text).x;
    ImGui::SetCursorPosX(ImGui::GetCursorPosX() + (blank > 0 ? blank : 0));
    ImGui::TextUnformatted(cut_to(text, ui_room()).c_str()); // no digit is missing without a sign of it
}

void ui_underline(double part, ui_colour colour)
{
    ImVec2 at = ImGui::GetCursorScreenPos();
    float room = ImGui::GetContentRegionAvail().x;
    float top = at.y + ImGui::GetTextLineHeight();
    ImGui::GetWindowDrawList()->AddRectFilled(ImVec2(at.x, top),
                                              ImVec2(at.x + room * static_cast<float>(part), top + 3),
                                              ImGui::GetColorU32(IM_COL32(colour.r, colour.g, colour.b, colour.a)));
}

bool ui_row_cut(const char *label, bool selected, const char *tip)
{
    if (selected && ImGui::GetCurrentTable()) { // all of the row
        ImGui::TableSetBgColor(ImGuiTableBgTarget_RowBg1, ImGui::GetColorU32(ImGuiCol_Header));
    }
    std::string shown = cut_name(label, ImGui::GetContentRegionAvail().x);
    bool is_cut = shown != label;
    bool pressed = ImGui::Selectable(shown.c_str(), selected);
    ui_tip((is_cut ? std::string(label) + "\n" + tip : std::string(tip)).c_str());
    return pressed;
}

void ui_shorten(char *out, size_t size, const char *text, float width)
{
    std::snprintf(out, size, "%s", cut_to(text, width).c_str());
}

void ui_shorten_name(char *out, size_t size, const char *name, float width)
{
    std::snprintf(out, size, "%s", cut_name(name, width).c_str());
}

static void show_cut(const std::string &shown, const char *text)
{
    ImGui::TextUnformatted(shown.c_str());
    audit(AUDIT_ITEM, text);
    if (shown != text) {
        ui_tip(text);
    }
}

void ui_text_cut(const char *text, float width)
{
    show_cut(cut_to(text, width), text);
}

void ui_name_cut(const char *name, float width)
{
    show_cut(cut_name(name, width), name);
}

void ui_heading(const char *text)
{
    const float whole = push_heading(text);
    const float smallest = static_cast<float>(LOOK_TEXT) / LOOK_HEADING;
    const float part = ui_room() / ImGui::CalcTextSize(text).x;
    ImGui::SetWindowFontScale(whole * std::min(std::max(part, smallest), 1.0F));
    ui_name_cut(text, ui_room());
    pop_heading();
}

void ui_columns(size_t count)
{
    ImGui::Columns(static_cast<int>(count), nullptr, false);
}

void ui_next_column(void)
{
    ImGui::NextColumn();
}

bool ui_popup(const char *label)
{
    bool pressed = ImGui::Button(label);
    audit(AUDIT_ITEM, label);
    audit(AUDIT_WIDGET, label);
    if (pressed) {
        ImGui::OpenPopup(label);
    }
    return ImGui::BeginPopup(label);
}

void ui_popup_end(void)
{
    ImGui::EndPopup();
}

void ui_popup_close(void)
{
    ImGui::CloseCurrentPopup();
}

void ui_flow(const char *label)
{
    const ImGuiStyle &style = ImGui::GetStyle();
    float end =
        ImGui::GetItemRectMax().x + style.ItemSpacing.x + ImGui::CalcTextSize(label).x + 2 * style.FramePadding.x;
    if (end <= ImGui::GetWindowPos().x + ImGui::GetWindowContentRegionMax().x) {
        ImGui::SameLine();
    }
}

} // extern "C"
