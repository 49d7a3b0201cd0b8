// SPDX-License-Identifier: BSD-3-Clause
// Surfaces that a program draws on by itself, by Dear ImGui.
#include "viewer/ui/ui.h"

#include <imgui.h>

extern "C" {

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

} // extern "C"
