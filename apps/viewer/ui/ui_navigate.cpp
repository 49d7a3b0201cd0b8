// SPDX-License-Identifier: BSD-3-Clause
// Turns the keyboard navigation of Dear ImGui on, in one window, and off.
#include "viewer/ui/ui_navigate.h"

#include <imgui.h>
#include <imgui_internal.h>

extern "C" {

void ui_navigate(const char *title)
{
    ImGuiIO &io = ImGui::GetIO();
    ImGuiContext &context = *ImGui::GetCurrentContext();
    ImGuiWindow *window = title ? ImGui::FindWindowByName(title) : nullptr;
    io.ConfigFlags &= ~ImGuiConfigFlags_NavEnableKeyboard;
    if (!window) {
        ImGui::ClearActiveID();
        ImGui::FocusWindow(nullptr);
        return;
    }
    io.ConfigFlags |= ImGuiConfigFlags_NavEnableKeyboard;
    ImGui::FocusWindow(window);
    ImGui::NavInitWindow(window, true); // the first widget, in this frame
    context.NavDisableHighlight = false;
}

bool ui_navigates(void)
{
    return ImGui::GetIO().ConfigFlags & ImGuiConfigFlags_NavEnableKeyboard;
}

void ui_hold_key(int key, bool down)
{
#if IMGUI_VERSION_NUM < 18700 // later ones have a queue
    ImGui::GetIO().KeysDown[key] = down;
#else
    (void)key;
    (void)down;
#endif
}

bool ui_navigates_deep(void)
{
    const ImGuiContext &context = *ImGui::GetCurrentContext();
    bool in_part = context.NavWindow && context.NavWindow->RootWindow != context.NavWindow;
    return ui_navigates() && (context.OpenPopupStack.Size > 0 || context.ActiveId || in_part);
}

} // extern "C"
