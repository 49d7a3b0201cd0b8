/* SPDX-License-Identifier: BSD-3-Clause */
/* How the atlas has left and right areas, and which of them are shown. */
#include "viewer/panes/panels.h"

#include "viewer/model/hemisphere_side.h"

#include <math.h>

/* That of the line above, where there is room. */
static void use_width(const struct window *window)
{
    ui_width(fminf(window->screen.left.width - 20, ui_room()));
}

static void choose_hemispheres(struct window *window)
{
    size_t how = (size_t)window->files.hemispheres;
    use_width(window);
    if (ui_choose("##hemispheres", &how, hemispheres_meanings, HEMISPHERES_COUNT)) {
        window_want_hemispheres(window, (conus_hemispheres)how, 0);
    }
    ui_tip("hemispheres: areas as the file has them; those that lie on both sides cut in two at x = 0 mm; or left and\n"
           "right ones of one name reported as one (--hemispheres). The atlas is opened again for it; F8: the next");
}

static void choose_side(struct window *window)
{
    static const char *const sides[SIDE_COUNT] = {"both sides", "left only", "right only"};
    struct viewer *viewer = window->viewer;
    size_t side = side_shown(viewer);
    if (!side_is_known(viewer)) {
        ui_text("its areas have no sides");
        ui_tip("no areas are known to be left and right ones, by the label table, by their names, or by a split");
        return;
    }
    use_width(window);
    if (ui_choose("##side", &side, sides, SIDE_COUNT)) {
        side_show(viewer, (enum side)side);
    }
    ui_tip("hides all areas of the other side, so that they are not hit either; those without a side stay.\n"
           "F9: the next");
}

void panel_sides(struct window *window)
{
    ui_text_coloured(theme_texts[THEME_HINT], "left and right");
    choose_hemispheres(window);
    choose_side(window);
}
