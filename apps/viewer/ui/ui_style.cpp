// SPDX-License-Identifier: BSD-3-Clause
// The font, sizes and colours of Dear ImGui's widgets.
#include "viewer/ui/parts.h"

#include "base/look.h"
#include "viewer/ui/ui.h"

#include <imgui.h>

#include <initializer_list>

static ImVec4 from_theme(ui_colour c)
{
    return ImGui::ColorConvertU32ToFloat4(IM_COL32(c.r, c.g, c.b, c.a));
}

/* Letters and figures, the latter all equally wide; those of texts have signs that the font lacks, too. Headings take
 * these and old Cyrillic letters from texts (push_heading()): as many large ones would hold up the first frame. So
 * would large ones that are drawn three times as wide as they are shown, which small ones need to be sharp. */
static bool load_fonts(float scale)
{
    static const ImWchar letters[] = {0x20, 0x24f, 0x370, 0x52f, 0x2010, 0x2044, 0};
    static const ImWchar large[] = {0x20, 0x24f, 0x370, 0x45f, 0x2010, 0x2044, 0};
    static const ImWchar signs[] = {0x20, 0x24f, 0x370, 0x52f, 0x2010, 0x2044, 0x2190, 0x22ff, 0};
    ImFontConfig once, more;
    once.OversampleH = more.OversampleH = scale < 2 ? 3 : 2;
    more.MergeMode = true;
    ImFontAtlas &fonts = *ImGui::GetIO().Fonts;
    return fonts.AddFontFromFileTTF(CONUS_VIEWER_FONT, LOOK_TEXT * scale, &once, letters) &&
           fonts.AddFontFromFileTTF(CONUS_VIEWER_SIGNS_FONT, LOOK_TEXT * scale, &more, signs) &&
           fonts.AddFontFromFileTTF(CONUS_VIEWER_BOLD_FONT, LOOK_HEADING * scale, &once, large);
}

/* Surfaces under texts have the theme's colours, and are opaque. */
static void set_colours(ImGuiStyle &style)
{
    static const struct {
        ImGuiCol of;
        enum theme_surface surface;
    } surfaces[] = {
        {ImGuiCol_WindowBg, THEME_PANEL},
        {ImGuiCol_PopupBg, THEME_POPUP},
        {ImGuiCol_TitleBg, THEME_PANEL},
        {ImGuiCol_TitleBgActive, THEME_PANEL},
        {ImGuiCol_FrameBg, THEME_FIELD},
        {ImGuiCol_FrameBgHovered, THEME_FIELD_HOVERED},
        {ImGuiCol_FrameBgActive, THEME_FIELD_HELD},
        {ImGuiCol_Button, THEME_BUTTON},
        {ImGuiCol_ButtonHovered, THEME_BUTTON_HOVERED},
        {ImGuiCol_ButtonActive, THEME_BUTTON_HELD},
        {ImGuiCol_Header, THEME_ROW},
        {ImGuiCol_HeaderHovered, THEME_ROW_HOVERED},
        {ImGuiCol_HeaderActive, THEME_ROW_HELD},
        {ImGuiCol_TableHeaderBg, THEME_PANEL},
        {ImGuiCol_TextSelectedBg, THEME_MARKED},
    };
    for (const auto &one : surfaces) {
        style.Colors[one.of] = from_theme(theme_surfaces[one.surface]);
    }
    style.Colors[ImGuiCol_Text] = from_theme(theme_texts[THEME_PLAIN]);
    style.Colors[ImGuiCol_TextDisabled] = from_theme(theme_texts[THEME_HINT]);
    static const struct {
        ImGuiCol of;
        enum theme_mark mark;
    } marks[] = {
        {ImGuiCol_Separator, THEME_LINE},         {ImGuiCol_TableBorderLight, THEME_LINE},
        {ImGuiCol_TableBorderStrong, THEME_LINE}, {ImGuiCol_Border, THEME_EDGE},
        {ImGuiCol_SliderGrab, THEME_KNOB},        {ImGuiCol_SliderGrabActive, THEME_KNOB_HELD},
        {ImGuiCol_CheckMark, THEME_MARK},         {ImGuiCol_NavHighlight, THEME_MARK},
        {ImGuiCol_ScrollbarGrab, THEME_EDGE},     {ImGuiCol_ScrollbarGrabHovered, THEME_KNOB},
    };
    for (const auto &one : marks) {
        style.Colors[one.of] = from_theme(theme_marks[one.mark]);
    }
}

bool ui_style(float scale)
{
    ImGuiStyle style;
    if (theme_used() == THEME_LIGHT) {
        ImGui::StyleColorsLight(&style);
    } else {
        ImGui::StyleColorsDark(&style);
    }
    style.WindowRounding = style.WindowBorderSize = 0;
    style.FrameRounding = LOOK_ROUNDING;
    style.FrameBorderSize = 1; /* a control is seen by its edge */
    style.WindowPadding = ImVec2(LOOK_PADDING_X, LOOK_PADDING_Y);
    style.ItemSpacing = ImVec2(LOOK_GAP_X, LOOK_GAP_Y);
    style.CellPadding = ImVec2(LOOK_CELL, LOOK_CELL_Y);
    set_colours(style);
    style.ScrollbarSize = LOOK_BAR;
    style.ScaleAllSizes(scale);
    ImGui::GetStyle() = style;
    ImGui::GetIO().Fonts->Clear();
    return load_fonts(scale);
}
