// SPDX-License-Identifier: BSD-3-Clause
// The widgets of ui.h, by Dear ImGui.
#include "viewer/ui/ui.h"

#include "viewer/ui/parts.h"

#include "base/look.h"

#include <GLFW/glfw3.h>
#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_opengl3.h>
#include <epoxy/gl.h>
#include <imgui.h>
#include <imgui_internal.h>

#include <algorithm>
#include <cfloat>
#include <climits>
#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <cstring>
#include <iterator>

static ImU32 packed(ui_colour c)
{
    return IM_COL32(c.r, c.g, c.b, c.a);
}

/* Puts a label before its field, or above it where that needs more width, and gives the field the rest of the line;
 * "##..." is none. */
static void begin_field(const char *label, float needed)
{
    if (label[0] != '#') {
        float room = ui_room();
        float wide = ImGui::CalcTextSize(label).x + ImGui::GetStyle().ItemSpacing.x;
        // a whole pixel: an edge between two of them would be pale
        float column = std::ceil(ImGui::GetCursorPosX() + (wide > 0.36F * room ? wide : 0.36F * room));
        ImGui::AlignTextToFramePadding();
        ImGui::TextUnformatted(label);
        audit(AUDIT_ITEM, label);
        if (column + needed <= ImGui::GetCursorPosX() + room) {
            ImGui::SameLine(column);
        }
        ImGui::SetNextItemWidth(-1);
    }
    ImGui::PushID(label);
}

static void end_field(const char *tip)
{
    ImGui::PopID();
    if (tip) {
        ui_tip(tip);
    }
}

/* Ends a widget that is as wide as its label. */
static bool end_labelled(bool used, const char *label, const char *tip)
{
    audit(AUDIT_ITEM, label);
    audit(AUDIT_WIDGET, label);
    if (tip) {
        ui_tip(tip);
    }
    return used;
}

#if IMGUI_VERSION_NUM < 18700 // later ones have a queue
static void put_mouse(ImVec2 at)
{
    ImGuiIO &io = ImGui::GetIO();
    io.MousePos = at;
    for (int b = 0; b < 3 && at.x > -FLT_MAX; b++) { // also where it comes back before the frame
        ImVec2 apart(at.x - io.MouseClickedPos[b].x, at.y - io.MouseClickedPos[b].y);
        io.MouseDragMaxDistanceSqr[b] =
            std::max(io.MouseDragMaxDistanceSqr[b], io.MouseDown[b] ? apart.x * apart.x + apart.y * apart.y : 0);
    }
}

static void press_button(int button, bool down)
{
    if (button >= 0 && button < IM_ARRAYSIZE(ImGui::GetIO().MouseDown)) {
        ImGui::GetIO().MouseDown[button] = down;
    }
}
#else
static void put_mouse(ImVec2 at)
{
    ImGui::GetIO().AddMousePosEvent(at.x, at.y);
}

static void press_button(int button, bool down)
{
    if (button >= 0 && button < ImGuiMouseButton_COUNT) {
        ImGui::GetIO().AddMouseButtonEvent(button, down);
    }
}
#endif

/* Whether Enter was pressed in the line before. */
static bool is_entered()
{
    return ImGui::IsItemDeactivated() && ImGui::IsKeyPressed(ImGui::GetKeyIndex(ImGuiKey_Enter));
}

static bool has_letters(const ImFont &font, const char *text)
{
    unsigned int letter;
    for (int size = 1; *text && size; text += size) {
        size = ImTextCharFromUtf8(&letter, text, nullptr);
        if (size && !font.FindGlyphNoFallback(static_cast<ImWchar>(letter))) {
            return false;
        }
    }
    return true;
}

float push_heading(const char *text)
{
    const ImVector<ImFont *> &fonts = ImGui::GetIO().Fonts->Fonts;
    const bool is_whole = has_letters(*fonts[1], text);
    const float scale = is_whole ? 1 : static_cast<float>(LOOK_HEADING) / LOOK_TEXT;
    ImGui::PushFont(fonts[is_whole]);
    ImGui::SetWindowFontScale(scale);
    return scale;
}

void pop_heading()
{
    ImGui::SetWindowFontScale(1);
    ImGui::PopFont();
}

extern "C" {

bool ui_create(void *window, float scale)
{
    IMGUI_CHECKVERSION();
    ImGui::CreateContext();
    ImGui::GetIO().IniFilename = nullptr;
    bool fine = ui_style(scale) && ImGui_ImplGlfw_InitForOpenGL(static_cast<GLFWwindow *>(window), false) &&
                ImGui_ImplOpenGL3_Init("#version 450 core");
#if IMGUI_VERSION_NUM >= 18700
    if (fine) { // or else it asks GLFW where the mouse is, and deals out events by rules of its own
        ImGui_ImplGlfw_CursorEnterCallback(static_cast<GLFWwindow *>(window), GLFW_TRUE);
        ImGui::GetIO().ConfigInputTrickleEventQueue = false;
    }
#endif
    return fine;
}

void ui_destroy(void)
{
    if (ImGui::GetCurrentContext()) {
        if (ImGui::GetIO().BackendRendererUserData) {
            ImGui_ImplOpenGL3_Shutdown();
        }
        if (ImGui::GetIO().BackendPlatformUserData) {
            ImGui_ImplGlfw_Shutdown();
        }
        ImGui::DestroyContext();
    }
}

bool ui_set_scale(float scale)
{
    ImGui_ImplOpenGL3_DestroyFontsTexture();
    return ui_style(scale) && ImGui_ImplOpenGL3_CreateFontsTexture();
}

void ui_take(void *window, const struct ui_event *event)
{
    auto *handle = static_cast<GLFWwindow *>(window);
    ImGuiIO &io = ImGui::GetIO();
    bool is_held = io.MouseDown[0] || io.MouseDown[1] || io.MouseDown[2];
    switch (event->kind) {
    case UI_MOVE:
        put_mouse(ImVec2(event->x, event->y));
        break;
    case UI_ENTRY:
        if (!event->action && !is_held) { // nothing is below it any more
            put_mouse(ImVec2(-FLT_MAX, -FLT_MAX));
        }
        break;
    case UI_BUTTON:
        press_button(event->code, event->action != GLFW_RELEASE);
        break;
    case UI_WHEEL:
        ImGui_ImplGlfw_ScrollCallback(handle, static_cast<double>(event->x), static_cast<double>(event->y));
        break;
    case UI_KEY:
        ImGui_ImplGlfw_KeyCallback(handle, event->code, event->scancode, event->action, event->mods);
        break;
    case UI_LETTER:
        ImGui_ImplGlfw_CharCallback(handle, static_cast<unsigned>(event->code));
        break;
    case UI_FOCUS:
        ImGui_ImplGlfw_WindowFocusCallback(handle, event->action);
        break;
    }
}

void ui_begin(double now)
{
    ImGuiIO &io = ImGui::GetIO();
#if IMGUI_VERSION_NUM < 18700 // it asks GLFW for the mouse as it is now, later than the frame's events
    ImVec2 at = io.MousePos;
    bool down[IM_ARRAYSIZE(io.MouseDown)];
    std::copy(std::begin(io.MouseDown), std::end(io.MouseDown), down);
#endif
    ImGui_ImplOpenGL3_NewFrame();
    ImGui_ImplGlfw_NewFrame();
#if IMGUI_VERSION_NUM < 18700
    io.MousePos = at;
    std::copy(std::begin(down), std::end(down), io.MouseDown);
#endif
    io.DeltaTime = static_cast<float>(std::max(now - ImGui::GetTime(), 1e-5)); // two clicks are double by their times
    ImGui::NewFrame();
}

void ui_end(void)
{
    ImGui::Render();
    ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
}

bool ui_lists(void)
{
    return ImGui::GetCurrentContext()->OpenPopupStack.Size > 0;
}

bool ui_wants_keys(void)
{
    return ImGui::GetIO().WantTextInput || ui_lists();
}

float ui_line(void)
{
    return ImGui::GetTextLineHeightWithSpacing();
}

float ui_text_width(const char *text)
{
    return ImGui::CalcTextSize(text).x;
}

float ui_button_width(const char *label)
{
    const ImGuiStyle &style = ImGui::GetStyle();
    return ImGui::CalcTextSize(label).x + 2 * style.FramePadding.x + style.ItemSpacing.x;
}

void ui_panel(const char *title, struct ui_box box, unsigned flags)
{
    ImGuiWindowFlags window = ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoCollapse |
                              ImGuiWindowFlags_NoSavedSettings;
    bool plain = flags & UI_PLAIN;
    window |= flags & UI_UNTITLED ? ImGuiWindowFlags_NoTitleBar : 0;
    window |= flags & UI_IN_FRONT ? 0 : ImGuiWindowFlags_NoBringToFrontOnFocus | ImGuiWindowFlags_NoBackground;
    if (plain) {
        window |= ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoScrollbar | ImGuiWindowFlags_NoScrollWithMouse;
        ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, ImVec2(0, 0));
        ImGui::PushStyleVar(ImGuiStyleVar_WindowMinSize, ImVec2(1, 1));
    }
    const ImVec2 padding = ImGui::GetStyle().WindowPadding;
    ImGui::SetNextWindowPos(ImVec2(box.x, box.y));
    ImGui::SetNextWindowSize(ImVec2(box.width, box.height));
    ImGui::PushStyleVar(ImGuiStyleVar_WindowBorderSize, flags & UI_IN_FRONT ? 1.0F : 0.0F); /* what is below is alike */
    ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, ImVec2(flags & UI_NARROW ? padding.x / 2 : padding.x, padding.y));
    const ImVec2 frame = ImGui::GetStyle().FramePadding; /* the title of a form stands above what is in it */
    ImGui::PushStyleVar(ImGuiStyleVar_FramePadding, ImVec2(flags & UI_IN_FRONT ? padding.x : frame.x, frame.y));
    ImGui::Begin(title, nullptr, window);
    ImGui::PopStyleVar(3);
    if (plain) {
        ImGui::PopStyleVar(2);
    }
}

void ui_panel_end(void)
{
    ImGui::End();
}

void ui_scroll(const char *id, float height)
{
    const bool has_bar = ImGui::GetStateStorage()->GetBool(ImGui::GetID(id)); // else its room is free: nothing moves
    ImGui::BeginChild(id, ImVec2(has_bar ? 0 : -ImGui::GetStyle().ScrollbarSize, height), false,
                      ImGuiWindowFlags_NavFlattened);
}

void ui_scroll_end(void)
{
    const ImGuiWindow *child = ImGui::GetCurrentWindowRead();
    const bool has_bar = child->ScrollbarY;
    const ImGuiID id = child->ChildId;
    ImGui::EndChild();
    ImGui::GetStateStorage()->SetBool(id, has_bar);
}

void ui_column(const char *id, float width, float height)
{
    ImGui::BeginChild(id, ImVec2(width, height));
}

void ui_scroll_here(void)
{
    ImGui::SetScrollHereY(0.4F);
}

void ui_dim(float opacity)
{
    ImGui::PushStyleVar(ImGuiStyleVar_Alpha, opacity);
}

void ui_dim_end(void)
{
    ImGui::PopStyleVar();
}

void ui_disable(bool is)
{
    ImGui::BeginDisabled(is);
}

void ui_disable_end(void)
{
    ImGui::EndDisabled();
}

void ui_tint(enum theme_text colour)
{
    ImGui::PushStyleColor(ImGuiCol_Text, packed(theme_texts[colour]));
}

void ui_tint_end(void)
{
    ImGui::PopStyleColor();
}

void ui_gap(float height)
{
    ImGui::Dummy(ImVec2(0, height));
}

void ui_group(void)
{
    ImGui::BeginGroup();
}

void ui_group_end(void)
{
    ImGui::EndGroup();
}

void ui_same_line(void)
{
    ImGui::SameLine();
}

void ui_same_line_at(float x)
{
    ImGui::SameLine(x);
}

void ui_separator(void)
{
    ImGui::Separator();
}

float ui_room_below(void)
{
    return ImGui::GetContentRegionAvail().y;
}

float ui_room(void)
{
    return ImGui::GetContentRegionAvail().x;
}

void ui_width(float width)
{
    ImGui::SetNextItemWidth(width);
}

void ui_id(uint32_t id)
{
    ImGui::PushID(static_cast<int>(id));
}

void ui_id_end(void)
{
    ImGui::PopID();
}

static void put_text(const char *format, va_list arguments)
{
    char text[3072];
    vsnprintf(text, sizeof text, format, arguments);
    ImGui::TextUnformatted(text);
    audit(AUDIT_ITEM, text);
}

void ui_text(const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    put_text(format, arguments);
    va_end(arguments);
}

void ui_text_coloured(enum theme_text colour, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    ui_tint(colour);
    put_text(format, arguments);
    ui_tint_end();
    va_end(arguments);
}

void ui_text_wrapped(enum theme_text colour, const char *text)
{
    ImGui::PushTextWrapPos(0);
    ui_tint(colour);
    ImGui::TextUnformatted(text);
    ui_tint_end();
    ImGui::PopTextWrapPos();
    audit(AUDIT_ITEM, text);
}

/* A panel's tip stands beside it, where it hides no other widget; over pictures it is at the mouse. */
static void place_tip(const char *text)
{
    const ImGuiWindow *panel = ImGui::GetCurrentWindowRead()->RootWindow;
    const ImVec2 screen = ImGui::GetIO().DisplaySize;
    const float y = ImGui::GetItemRectMin().y;
    const float wide = ImGui::CalcTextSize(text).x + 2 * ImGui::GetStyle().WindowPadding.x;
    const float right = screen.x - panel->Pos.x - panel->Size.x;
    const bool is_at_right = panel->Pos.x > right;
    const bool has_room = wide <= (is_at_right ? panel->Pos.x : right);
    if (has_room && !(panel->Flags & ImGuiWindowFlags_NoScrollWithMouse)) {
        ImGui::SetNextWindowPos(ImVec2(is_at_right ? panel->Pos.x : panel->Pos.x + panel->Size.x, y), ImGuiCond_Always,
                                ImVec2(is_at_right ? 1 : 0, y > screen.y / 2 ? 0.8F : 0));
    }
}

// Whether a form lies before the widget's panel: its tip would lie over that.
static bool is_behind_form()
{
    const int not_a_form = ImGuiWindowFlags_NoBringToFrontOnFocus | ImGuiWindowFlags_ChildWindow |
                           ImGuiWindowFlags_Tooltip | ImGuiWindowFlags_Popup;
    const ImGuiContext *context = ImGui::GetCurrentContext();
    bool found = false;
    for (const ImGuiWindow *window : context->Windows) {
        found = found || (window->WasActive && !(window->Flags & not_a_form));
    }
    return found && ImGui::GetCurrentWindowRead()->RootWindow->Flags & ImGuiWindowFlags_NoBringToFrontOnFocus;
}

void ui_tip(const char *text)
{
    audit(AUDIT_TIP, nullptr);
    if (ImGui::IsItemHovered() && !is_behind_form()) {
        place_tip(text);
        ImGui::BeginTooltip();
        ImGui::TextUnformatted(text);
        ImGui::EndTooltip();
    }
}

int ui_arrow(void)
{
    bool up = ImGui::IsKeyPressed(ImGui::GetKeyIndex(ImGuiKey_UpArrow));
    bool down = ImGui::IsKeyPressed(ImGui::GetKeyIndex(ImGuiKey_DownArrow));
    return (down ? 1 : 0) - (up ? 1 : 0);
}

bool ui_edited(void)
{
    return ImGui::IsItemDeactivatedAfterEdit();
}

bool ui_hovered(void)
{
    return ImGui::IsItemHovered();
}

bool ui_button(const char *label, const char *tip)
{
    return end_labelled(ImGui::Button(label), label, tip);
}

bool ui_main_button(const char *label, const char *tip)
{
    static const struct {
        ImGuiCol of;
        ui_colour colour;
    } colours[] = {{ImGuiCol_Button, {LOOK_RGB(LOOK_MAIN), 255}},
                   {ImGuiCol_ButtonHovered, {LOOK_RGB(LOOK_MAIN_HOVERED), 255}},
                   {ImGuiCol_ButtonActive, {LOOK_RGB(LOOK_MAIN_HELD), 255}},
                   {ImGuiCol_Text, {LOOK_RGB(LOOK_MAIN_TEXT), 255}}};
    for (const auto &one : colours) {
        ImGui::PushStyleColor(one.of, packed(one.colour));
    }
    bool used = ImGui::Button(label);
    ImGui::PopStyleColor(static_cast<int>(std::size(colours)));
    return end_labelled(used, label, tip);
}

/* A button without an edge: of several in a row. */
static bool press(const char *label, ImVec2 size, enum theme_surface surface, enum theme_text text)
{
    ImGui::PushStyleColor(ImGuiCol_Button, packed(theme_surfaces[surface]));
    ImGui::PushStyleColor(ImGuiCol_Text, packed(theme_texts[text]));
    ImGui::PushStyleVar(ImGuiStyleVar_FrameBorderSize, 0);
    const bool used = ImGui::Button(label, size);
    ImGui::PopStyleVar();
    ImGui::PopStyleColor(2);
    return used;
}

bool ui_icon(const char *id, const char *strokes, float width, float height, bool marked, const char *tip)
{
    bool used = press(id, ImVec2(width, height), marked ? THEME_BUTTON_HELD : THEME_PANEL, THEME_PLAIN);
    ImDrawList *list = ImGui::GetWindowDrawList();
    ImVec2 low = ImGui::GetItemRectMin();
    float unit = ImGui::GetTextLineHeight() / 16;
    ImVec2 corner(low.x + width / 2 - 8 * unit, low.y + height / 2 - 8 * unit);
    for (const char *at = strokes; *at; at += *at == ' ') {
        for (; *at && *at != ' '; at += 2) {
            list->PathLineTo(ImVec2(corner.x + unit * static_cast<float>(at[0] - 'a'),
                                    corner.y + unit * static_cast<float>(at[1] - 'a')));
        }
        list->PathStroke(ImGui::GetColorU32(ImGuiCol_Text), 0, 1.5F * unit);
    }
    return end_labelled(used, id, tip);
}

bool ui_small_button(const char *label, const char *tip)
{
    return end_labelled(ImGui::SmallButton(label), label, tip);
}

bool ui_check(const char *label, bool *value, const char *tip)
{
    return end_labelled(ImGui::Checkbox(label, value), label, tip);
}

/* A line along the lower edge of the widget before, which is the chosen one of several. */
static void underline_chosen(ui_colour colour)
{
    const ImVec2 low = ImGui::GetItemRectMin();
    const ImVec2 high = ImGui::GetItemRectMax();
    const float thick = 2 * ImGui::GetTextLineHeight() / LOOK_TEXT;
    ImGui::GetWindowDrawList()->AddRectFilled(ImVec2(low.x, high.y - thick), high, packed(colour));
}

/* Two or three choices side by side, all seen, in an edge. They are one widget. */
static bool switch_between(const char *label, size_t *index, const char *const *choices, size_t count, float wide,
                           const char *tip)
{
    const size_t before = *index;
    const ImVec2 low = ImGui::GetCursorScreenPos();
    const float high = ImGui::GetFrameHeight();
    ImGui::BeginGroup();
    for (size_t i = 0; i < count; i++) {
        const float left = std::floor(static_cast<float>(i) * wide / static_cast<float>(count));
        const float right = std::floor(static_cast<float>(i + 1) * wide / static_cast<float>(count));
        const bool is_on = i == before;
        ImGui::SetCursorScreenPos(ImVec2(low.x + left, low.y));
        if (press(choices[i], ImVec2(right - left, high), is_on ? THEME_BUTTON_HELD : THEME_FIELD,
                  is_on ? THEME_PLAIN : THEME_HINT)) {
            *index = i;
        }
        audit(AUDIT_ITEM, choices[i], 0);
        if (is_on) {
            underline_chosen(theme_marks[THEME_MARK]);
        }
    }
    ImGui::EndGroup();
    audit(AUDIT_WIDGET, label);
    ImGui::GetWindowDrawList()->AddRect(low, ImVec2(low.x + wide, low.y + high), packed(theme_marks[THEME_EDGE]),
                                        ImGui::GetStyle().FrameRounding);
    end_field(tip);
    return *index != before;
}

bool ui_choose(const char *label, size_t *index, const char *const *choices, size_t count, const char *tip)
{
    enum { SWITCHED = 3 };
    bool changed = false;
    const char *shown = *index < count ? choices[*index] : "";
    float widest = 0;
    for (size_t i = 0; i < count; i++) {
        widest = std::max(widest, ImGui::CalcTextSize(choices[i]).x);
    }
    begin_field(label, widest + ImGui::GetFrameHeight() + 2 * ImGui::GetStyle().FramePadding.x);
    const float room = ImGui::CalcItemWidth();
    const float needed = static_cast<float>(count) * (widest + 2 * ImGui::GetStyle().FramePadding.x);
    if (label[0] != '#' && count > 1 && count <= SWITCHED && *index < count && needed <= room) {
        return switch_between(label, index, choices, count, room, tip);
    }
    audit(AUDIT_WITHIN, shown, ImGui::CalcItemWidth() - ImGui::GetFrameHeight() - ImGui::GetStyle().FramePadding.x);
    bool open = ImGui::BeginCombo("##field", shown);
    audit(AUDIT_WIDGET, label);
    if (open) {
        for (size_t i = 0; i < count; i++) {
            if (ImGui::Selectable(choices[i], i == *index)) {
                changed = i != *index;
                *index = i;
            }
            if (i == *index) {
                ImGui::SetItemDefaultFocus(); // where keys go on from
            }
        }
        ImGui::EndCombo();
    }
    end_field(tip);
    return changed;
}

/* A slider with its number at its right, where the grab never is. Together they are the widget before. */
static bool slide(const char *label, ImGuiDataType type, void *value, const void *low, const void *high,
                  const char *format, ImGuiSliderFlags flags, const char *tip)
{
    const auto write = [type, format](char(&out)[64], const void *number) {
        ImGui::DataTypeFormatString(out, sizeof out, type, number, format);
        return ImGui::CalcTextSize(out).x;
    };
    char shown[64];
    float widest = std::max({write(shown, low), write(shown, high), write(shown, value)}); // the last one stays
    begin_field(label, 2 * widest);
    float whole = ImGui::CalcItemWidth();
    float bar = std::max(whole - widest - ImGui::GetStyle().ItemInnerSpacing.x, 1.0F);
    bool types = ImGui::TempInputIsActive(ImGui::GetID("##field"));
    ImGui::BeginGroup();
    ImGui::SetNextItemWidth(bar);
    ImGui::PushStyleColor(ImGuiCol_Text, types ? ImGui::GetColorU32(ImGuiCol_Text) : IM_COL32_BLACK_TRANS);
    bool changed = ImGui::SliderScalar("##field", type, value, low, high, format, flags | ImGuiSliderFlags_AlwaysClamp);
    ImGui::PopStyleColor();
    audit(AUDIT_WIDGET, label);
    write(shown, value);
    ImGui::SameLine(0, 0);
    ImGui::SetCursorPosX(ImGui::GetCursorPosX() + whole - bar - ImGui::CalcTextSize(shown).x);
    ImGui::AlignTextToFramePadding();
    ImGui::TextUnformatted(shown);
    audit(AUDIT_ITEM, shown);
    ImGui::EndGroup();
    end_field(tip);
    return changed;
}

bool ui_slider(const char *label, double *value, double low, double high, const char *format, bool logarithmic,
               const char *tip)
{
    return slide(label, ImGuiDataType_Double, value, &low, &high, format,
                 logarithmic ? ImGuiSliderFlags_Logarithmic : ImGuiSliderFlags_None, tip);
}

bool ui_count(const char *label, uint32_t *value, uint32_t low, uint32_t high, const char *tip)
{
    return slide(label, ImGuiDataType_U32, value, &low, &high, "%u", ImGuiSliderFlags_None, tip);
}

bool ui_numbers(const char *label, double value[3], const char *format, const char *tip)
{
    const ImGuiStyle &style = ImGui::GetStyle();
    char usual[64];
    snprintf(usual, sizeof usual, format, -123.4);
    float number = ImGui::CalcTextSize(usual).x + 2 * style.FramePadding.x;
    begin_field(label, 3 * number + 2 * style.ItemInnerSpacing.x);
    float wide = (ImGui::CalcItemWidth() - 2 * style.ItemInnerSpacing.x) / 3 - 2 * style.FramePadding.x;
    for (int i = 0; i < 3; i++) {
        char shown[64];
        snprintf(shown, sizeof shown, format, value[i]);
        audit(AUDIT_WITHIN, shown, wide);
    }
    bool changed = ImGui::InputScalarN("##field", ImGuiDataType_Double, value, 3, nullptr, nullptr, format,
                                       ImGuiInputTextFlags_EnterReturnsTrue);
    audit(AUDIT_WIDGET, label);
    end_field(tip);
    return changed;
}

void ui_take_keys(bool *is_asked)
{
    if (*is_asked) {
        ImGui::SetKeyboardFocusHere();
    }
    *is_asked = false;
}

bool ui_type(const char *label, char *text, size_t size, const char *hint, const char *tip)
{
    begin_field(label, 0);
    audit(AUDIT_WITHIN, hint, ImGui::CalcItemWidth() - 2 * ImGui::GetStyle().FramePadding.x);
    ImGui::InputTextWithHint("##field", hint, text, size, ImGuiInputTextFlags_AutoSelectAll);
    audit(AUDIT_WIDGET, label);
    const bool entered = is_entered();
    end_field(tip);
    return entered;
}

struct path_line {
    const char *text;
    const char *folder;
    size_t selected;
    bool *is_set;
};

// A whole path that is pasted behind the folder that the line had by itself takes its place.
static void mind_folder(ImGuiInputTextCallbackData *data, const char *folder)
{
    int length = static_cast<int>(std::strlen(folder));
    const char *rest = data->Buf + length;
    bool is_behind = length && std::strncmp(data->Buf, folder, static_cast<size_t>(length)) == 0;
    if (is_behind && (rest[0] == '/' || (rest[0] == '~' && rest[1] == '/'))) {
        data->DeleteChars(0, length);
    }
}

static int take_text(ImGuiInputTextCallbackData *data)
{
    auto *line = static_cast<path_line *>(data->UserData);
    if (*line->is_set) {
        data->DeleteChars(0, data->BufTextLen);
        data->InsertChars(0, line->text);
        data->CursorPos = data->BufTextLen;
        data->SelectionEnd = data->BufTextLen;
        data->SelectionStart = std::min(static_cast<int>(std::min<size_t>(line->selected, INT_MAX)), data->BufTextLen);
        *line->is_set = false;
    } else {
        mind_folder(data, line->folder);
    }
    return 0;
}

bool ui_type_path(const char *label, char *text, size_t size, const char *hint, const char *folder, size_t selected,
                  bool *is_set)
{
    char wanted[4096]; // the line may write to text before it asks
    std::strncpy(wanted, text, sizeof wanted - 1);
    wanted[sizeof wanted - 1] = 0;
    path_line line = {wanted, folder, selected, is_set};
    audit(AUDIT_WITHIN, hint, ImGui::CalcItemWidth() - 2 * ImGui::GetStyle().FramePadding.x);
    int selects = folder[0] ? 0 : ImGuiInputTextFlags_AutoSelectAll; // else what is typed goes behind the folder
    ImGui::InputTextWithHint(label, hint, text, size, ImGuiInputTextFlags_CallbackAlways | selects, take_text, &line);
    return is_entered();
}

bool ui_escaped(void)
{
    return ImGui::IsKeyPressed(ImGui::GetKeyIndex(ImGuiKey_Escape));
}

void ui_chip(ui_colour colour)
{
    const float line = ImGui::GetTextLineHeight();
    const ImVec2 at = ImGui::GetCursorScreenPos();
    const float edge = 0.8F * line;
    ImGui::GetWindowDrawList()->AddRectFilled(ImVec2(at.x, at.y + 0.1F * line), ImVec2(at.x + edge, at.y + 0.9F * line),
                                              ImGui::GetColorU32(packed(colour)), ImGui::GetStyle().FrameRounding / 2);
    ImGui::Dummy(ImVec2(edge, line));
}

bool ui_can_write(const char *text)
{
    return has_letters(*ImGui::GetFont(), text);
}

bool ui_row(const char *label, bool selected, float height)
{
    audit(AUDIT_WITHIN, label, ui_room());
    return ImGui::Selectable(label, selected, 0, ImVec2(0, height));
}

bool ui_section(const char *label, bool open)
{
    if (audit_runs()) {
        ImGui::SetNextItemOpen(true);
    }
    ImGui::Separator();
    ImGui::PushStyleColor(ImGuiCol_Header, packed(theme_surfaces[THEME_PANEL]));
    ImGui::PushStyleVar(ImGuiStyleVar_FrameBorderSize, 0);
    bool is_open = ImGui::CollapsingHeader(label, open ? ImGuiTreeNodeFlags_DefaultOpen : 0);
    ImGui::PopStyleVar();
    ImGui::PopStyleColor();
    return is_open;
}

bool ui_tab(const char *label, bool shown, const char *tip)
{
    const bool used = press(label, ImVec2(0, 0), THEME_PANEL, shown ? THEME_PLAIN : THEME_HINT);
    if (shown) {
        underline_chosen({LOOK_RGB(LOOK_MAIN), 255});
    }
    return end_labelled(used, label, tip);
}

bool ui_shows_tab(bool shown)
{
    return shown || audit_runs();
}

bool ui_tree(const char *label, enum ui_opening opening)
{
    if (opening != UI_AS_IT_WAS) {
        ImGui::SetNextItemOpen(true, opening == UI_OPEN_NOW ? ImGuiCond_Always : ImGuiCond_Once);
    }
    return ImGui::TreeNodeEx(label, ImGuiTreeNodeFlags_OpenOnArrow);
}

void ui_tree_end(void)
{
    ImGui::TreePop();
}

void ui_cell(void)
{
    ImGui::TableNextColumn();
}

/* Pictures are opaque, and blending costs a software renderer more than the picture. */
static void stop_blending(const ImDrawList *, const ImDrawCmd *)
{
    glDisable(GL_BLEND);
}

static void blend_again(const ImDrawList *, const ImDrawCmd *)
{
    glEnable(GL_BLEND);
}

void ui_picture(uint32_t texture, float width, float height)
{
    ImVec2 at = ImGui::GetCursorScreenPos();
    if (texture) {
        ui_draw_overlay(texture, {at.x, at.y, width, height});
    }
    ImGui::Dummy(ImVec2(width, height));
}

void ui_draw_image(uint32_t texture, struct ui_box box)
{
    ImDrawList *list = ImGui::GetWindowDrawList();
    list->AddCallback(stop_blending, nullptr);
    ui_draw_overlay(texture, box);
    list->AddCallback(blend_again, nullptr);
}

void ui_draw_overlay(uint32_t texture, struct ui_box box)
{
    ImGui::GetWindowDrawList()->AddImage(reinterpret_cast<ImTextureID>(static_cast<uintptr_t>(texture)),
                                         ImVec2(box.x, box.y), ImVec2(box.x + box.width, box.y + box.height));
}

void ui_clip(struct ui_box box)
{
    ImGui::GetWindowDrawList()->PushClipRect(ImVec2(box.x, box.y), ImVec2(box.x + box.width, box.y + box.height), true);
}

void ui_clip_end(void)
{
    ImGui::GetWindowDrawList()->PopClipRect();
}

void ui_draw_line(const float from[2], const float to[2], ui_colour colour, float width)
{
    ImGui::GetWindowDrawList()->AddLine(ImVec2(from[0], from[1]), ImVec2(to[0], to[1]), packed(colour), width);
}

void ui_draw_circle(const float centre[2], float radius, ui_colour colour, float width)
{
    ImDrawList *list = ImGui::GetWindowDrawList();
    if (width > 0) {
        list->AddCircle(ImVec2(centre[0], centre[1]), radius, packed(colour), 0, width);
    } else {
        list->AddCircleFilled(ImVec2(centre[0], centre[1]), radius, packed(colour));
    }
}

void ui_draw_fill(float (*corners)[2], size_t count, ui_colour colour)
{
    ImVector<ImVec2> points;
    for (size_t i = 0; i < count; i++) {
        points.push_back(ImVec2(corners[i][0], corners[i][1]));
    }
    ImGui::GetWindowDrawList()->AddConvexPolyFilled(points.Data, points.Size, packed(colour));
}

void ui_draw_box(struct ui_box box, ui_colour colour, float width)
{
    ImVec2 low(box.x, box.y);
    ImVec2 high(box.x + box.width, box.y + box.height);
    if (width > 0) {
        ImGui::GetWindowDrawList()->AddRect(low, high, packed(colour), 0, 0, width);
    } else {
        ImGui::GetWindowDrawList()->AddRectFilled(low, high, packed(colour));
    }
}

void ui_draw_text(const float at[2], ui_colour colour, const char *text)
{
    ImDrawList *list = ImGui::GetWindowDrawList();
    ImVec2 size = ImGui::CalcTextSize(text);
    list->AddRectFilled(ImVec2(at[0] - 3, at[1] - 1), ImVec2(at[0] + size.x + 3, at[1] + size.y + 1),
                        packed(theme_surfaces[THEME_SHADE]), 3);
    list->AddText(ImVec2(at[0], at[1]), packed(colour), text);
}

void ui_draw_label(const float at[2], ui_colour colour, const char *text)
{
    ImGui::GetWindowDrawList()->AddText(ImVec2(at[0], at[1]), packed(colour), text);
}

void ui_draw_heading(const float at[2], ui_colour colour, const char *text)
{
    push_heading(text);
    ui_draw_text(at, colour, text);
    pop_heading();
}

/* The large letters, but where they lack one. */
static ImFont *font_of(const char *text)
{
    const ImVector<ImFont *> &fonts = ImGui::GetIO().Fonts->Fonts;
    return fonts[has_letters(*fonts[1], text)];
}

void ui_push_letters(const char *text, float height)
{
    ImFont *font = font_of(text);
    ImGui::PushFont(font);
    ImGui::SetWindowFontScale(height / font->FontSize);
}

void ui_pop_letters(void)
{
    pop_heading();
}

float ui_large_width(const char *text, float height)
{
    return font_of(text)->CalcTextSizeA(height, FLT_MAX, 0, text).x;
}

void ui_draw_large(const float at[2], ui_colour colour, const char *text, float height)
{
    ImGui::GetWindowDrawList()->AddText(font_of(text), height, ImVec2(at[0], at[1]), packed(colour), text);
}

struct ui_mouse ui_mouse_now(void)
{
    const ImGuiIO &io = ImGui::GetIO();
    struct ui_mouse mouse = {};
    mouse.x = io.MousePos.x;
    mouse.y = io.MousePos.y;
    mouse.moved_x = io.MouseDelta.x;
    mouse.moved_y = io.MouseDelta.y;
    mouse.wheel = io.MouseWheel;
    for (int b = 0; b < 3; b++) {
        mouse.down[b] = io.MouseDown[b];
        mouse.pressed[b] = ImGui::IsMouseClicked(b);
        mouse.released[b] = ImGui::IsMouseReleased(b);
    }
    mouse.doubled = ImGui::IsMouseDoubleClicked(0);
    mouse.strayed = std::sqrt(io.MouseDragMaxDistanceSqr[0]);
    mouse.doubled_middle = ImGui::IsMouseDoubleClicked(2);
    mouse.shift = io.KeyShift;
    mouse.control = io.KeyCtrl;
    return mouse;
}

bool ui_surface(const char *id, struct ui_box box)
{
    if (box.width < 1 || box.height < 1) {
        return false;
    }
    ImGui::SetCursorScreenPos(ImVec2(box.x, box.y));
    ImGui::InvisibleButton(id, ImVec2(box.width, box.height),
                           ImGuiButtonFlags_MouseButtonLeft | ImGuiButtonFlags_MouseButtonRight |
                               ImGuiButtonFlags_MouseButtonMiddle);
    return ImGui::IsItemHovered() || ImGui::IsItemActive();
}

struct ui_box ui_area(const char *id, float height)
{
    ImVec2 at = ImGui::GetCursorScreenPos();
    float width = ui_room();
    struct ui_box box = {at.x, at.y, width > 1 ? width : 1, height};
    ImGui::InvisibleButton(id, ImVec2(box.width, box.height));
    return box;
}

void ui_resize_pointer(bool down)
{
    ImGui::SetMouseCursor(down ? ImGuiMouseCursor_ResizeNS : ImGuiMouseCursor_ResizeEW);
}

bool ui_surface_held(void)
{
    return ImGui::IsItemActive();
}

bool ui_navigate(const char *title)
{
    ImGuiIO &io = ImGui::GetIO();
    ImGuiContext &context = *ImGui::GetCurrentContext();
    ImGuiWindow *window = title ? ImGui::FindWindowByName(title) : nullptr;
    io.ConfigFlags &= ~ImGuiConfigFlags_NavEnableKeyboard;
    if (!window) {
        ImGui::ClearActiveID();
        ImGui::FocusWindow(nullptr);
        return !title;
    }
    io.ConfigFlags |= ImGuiConfigFlags_NavEnableKeyboard;
    ImGui::FocusWindow(window);
    ImGui::NavInitWindow(window, true); // the first widget, in this frame
    context.NavDisableHighlight = false;
    return true;
}

void ui_navigate_lists(bool also_panels)
{
    ImGuiIO &io = ImGui::GetIO();
    io.ConfigFlags = (io.ConfigFlags & ~ImGuiConfigFlags_NavEnableKeyboard) |
                     (also_panels || ui_lists() ? ImGuiConfigFlags_NavEnableKeyboard : 0);
}

bool ui_navigates(void)
{
    return ImGui::GetIO().ConfigFlags & ImGuiConfigFlags_NavEnableKeyboard;
}

bool ui_navigates_deep(void)
{
    const ImGuiContext &context = *ImGui::GetCurrentContext();
    bool in_part = context.NavWindow && context.NavWindow->RootWindow != context.NavWindow;
    return ui_navigates() && (context.OpenPopupStack.Size > 0 || context.ActiveId || in_part);
}

} // extern "C"
