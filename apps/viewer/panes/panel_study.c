/* SPDX-License-Identifier: BSD-3-Clause */
/* The study of the cone: shares over the angle as curves, or probabilities of jitter as bars, with their numbers. */
#include "viewer/panes/panes.h"

#include "base/look.h"
#include "viewer/model/viewer.h"
#include "viewer/ui/ui.h"

#include <math.h>
#include <stdio.h>

enum { PLOT_HEIGHT = 120, LINES = 6, TIP_ROWS = 10, SAMPLE_CHOICES = 17 };

static void choose_errors(struct viewer *viewer)
{
    static const char *const samples[SAMPLE_CHOICES] = {
        "16",   "32",    "64",    "128",   "256",    "512",    "1024",   "2048",   "4096",
        "8192", "16384", "32768", "65536", "131072", "262144", "524288", "1048576"}; /* from 2^4 on */
    struct study_settings study = viewer->study.settings;
    size_t choice = (size_t)lround(log2(study.samples)) - 4;
    bool changed = ui_slider("Tilt", &study.tilt_deg, 0, 20, "%.2f\u00b0", false,
                             "standard deviation of the axis about two axes, degrees (--jitter)");
    changed = ui_slider("Shift", &study.shift_mm, 0, 20, "%.2f mm", false,
                        "standard deviation of the position along three axes, mm (--jitter)") ||
              changed;
    if (ui_choose("Poses", &choice, samples, SAMPLE_CHOICES, "how many poses are traced (--samples)")) {
        study.samples = ldexp(1, (int)choice + 4);
        changed = true;
    }
    if (changed) {
        studies_use(viewer, &study);
    }
}

/* The place of an area among colours: that in the answer, or behind all of these, in the order of the study. */
static size_t rank_of(const struct viewer *viewer, const struct study_table *table, uint32_t object)
{
    size_t rank = viewer_rank(viewer, object);
    bool is_found = rank;
    for (size_t i = 0; i < conus_selection_count(viewer_selection(viewer)) && !is_found; i++) {
        rank += conus_selection_result(viewer_selection(viewer), i)->object > 0;
    }
    for (size_t i = 0; i < table->curve_count + conus_table_rows(table->chances) && !is_found; i++) {
        uint32_t other = table->curve_count ? table->curves[i].object : conus_table_objects(table->chances)[i];
        rank += other && !viewer_rank(viewer, other);
        is_found = other == object;
    }
    return rank;
}

/* Curves are of more than the cone hits as it is now. */
static ui_colour colour_of(const struct viewer *viewer, const struct study_table *table, uint32_t object)
{
    uint8_t rgb[3];
    if (!object) {
        return theme_texts[THEME_HINT];
    }
    viewer_rank_colour(rgb, viewer, object, rank_of(viewer, table, object));
    return (ui_colour){rgb[0], rgb[1], rgb[2], 255};
}

static const char *name_of(const struct viewer *viewer, uint32_t object)
{
    const conus_object *info = conus_atlas_object(viewer->drawn->atlas, object);
    return info ? info->name : "(nothing hit)";
}

/* The place of an angle across the box, 0 to 1. */
static float across(const struct study_answer *answer, size_t angle)
{
    double low = answer->angles[0];
    double high = answer->angles[answer->angle_count - 1];
    return high > low ? (float)((answer->angles[angle] - low) / (high - low)) : 0.5F;
}

/* Dots show where shares are known, unless there are so many that they touch. */
static void draw_line(const struct study_answer *answer, const struct study_curve *curve, struct ui_box box,
                      ui_colour colour, float width)
{
    float before[2] = {0};
    for (size_t i = 0; i < answer->angle_count; i++) {
        const float at[2] = {box.x + box.width * across(answer, i), box.y + box.height * (float)(1 - curve->shares[i])};
        if (i) {
            ui_draw_line(before, at, colour, width);
        }
        if (8 * (float)answer->angle_count < box.width) {
            ui_draw_circle(at, width, colour, 0);
        }
        before[0] = at[0];
        before[1] = at[1];
    }
}

/* The angle of the sweep that is nearest to @p angle, degrees. */
static size_t nearest_angle(const struct study_answer *answer, double angle)
{
    size_t nearest = 0;
    for (size_t i = 1; i < answer->angle_count; i++) {
        nearest = fabs(answer->angles[i] - angle) < fabs(answer->angles[nearest] - angle) ? i : nearest;
    }
    return nearest;
}

static void draw_numbers(const struct study_answer *answer, struct ui_box box)
{
    char low[32];
    char high[32];
    snprintf(low, sizeof low, "%.4g\u00b0", answer->angles[0]);
    snprintf(high, sizeof high, "%.4g\u00b0", answer->angles[answer->angle_count - 1]);
    float below = box.y + box.height + 3;
    ui_draw_label((float[]){box.x - ui_text_width("100 %") - 7, box.y - ui_line() / 2}, theme_texts[THEME_HINT],
                  "100 %");
    ui_draw_label((float[]){box.x - ui_text_width("0 %") - 7, box.y + box.height - ui_line() / 2},
                  theme_texts[THEME_HINT], "0 %");
    ui_draw_label((float[]){box.x, below}, theme_texts[THEME_HINT], low);
    ui_draw_label((float[]){box.x + box.width / 2 - ui_text_width("full opening") / 2, below}, theme_texts[THEME_HINT],
                  "full opening");
    ui_draw_label((float[]){box.x + box.width - ui_text_width(high), below}, theme_texts[THEME_HINT], high);
}

/* Lists the areas at an angle, in the order of the list below. */
static void tip_of_angle(const struct viewer *viewer, const struct study_answer *answer,
                         const struct study_table *table, size_t angle)
{
    char tip[1024];
    size_t used = (size_t)snprintf(tip, sizeof tip, "at %.4g\u00b0", answer->angles[angle]);
    size_t rows = 0;
    for (size_t i = 0; i < table->curve_count && rows < TIP_ROWS && used < sizeof tip; i++) {
        const struct study_curve *curve = &table->curves[i];
        if (curve->shares[angle] > 0) {
            used += (size_t)snprintf(tip + used, sizeof tip - used, "\n%6.2f %%  %s", 100 * curve->shares[angle],
                                     name_of(viewer, curve->object));
            rows++;
        }
    }
    ui_tip(tip);
}

/* Gives the angle that the list below is about: the one under the mouse, or else that of the cone. */
static size_t draw_plot(const struct window *window, const struct study_answer *answer, const struct study_table *table,
                        bool is_old)
{
    const struct viewer *viewer = window->viewer;
    struct ui_box area = ui_area("plot", PLOT_HEIGHT * window->screen.scale + 1.5F * ui_line());
    float left = ui_text_width("100 %") + 12;
    struct ui_box box = {area.x + left, area.y + ui_line() / 2, fmaxf(area.width - left - 8, 1),
                         fmaxf(area.height - 2 * ui_line(), 1)};
    bool hovered = ui_hovered();
    double low = answer->angles[0];
    double high = answer->angles[answer->angle_count - 1];
    double under = low + (double)((ui_mouse_now().x - box.x) / box.width) * (high - low);
    size_t angle = nearest_angle(answer, hovered ? under : viewer->tools[FIRST_TOOL].angle);
    if (hovered) {
        tip_of_angle(viewer, answer, table, angle);
    }
    ui_draw_box(box, theme_surfaces[THEME_POPUP], 0);
    for (int quarter = 0; quarter <= 4; quarter++) {
        float y = box.y + box.height * (float)quarter / 4;
        ui_draw_line((float[]){box.x, y}, (float[]){box.x + box.width, y}, theme_marks[THEME_LINE], 1);
    }
    float x = box.x + box.width * across(answer, angle);
    ui_draw_line((float[]){x, box.y}, (float[]){x, box.y + box.height}, theme_texts[THEME_HINT], 1);
    for (size_t i = table->curve_count; i > 0; i--) { /* the largest in front */
        const struct study_curve *curve = &table->curves[i - 1];
        bool chosen = curve->object && curve->object == viewer->drawn->shown.chosen;
        ui_colour colour = colour_of(viewer, table, curve->object);
        colour.a = is_old ? 80 : 255;
        float width = chosen ? 3.5F : 1.5F; /* and a light edge, since areas may be as dark as the ground */
        draw_line(answer, curve, box, (ui_colour){LOOK_RGB(LOOK_WHITE), (uint8_t)(colour.a / 2)}, width + 1.5F);
        draw_line(answer, curve, box, colour, width);
    }
    draw_numbers(answer, box);
    return angle;
}

static void draw_name(struct viewer *viewer, const struct study_table *table, uint32_t object, const char *tip)
{
    ui_cell();
    ui_chip(colour_of(viewer, table, object));
    ui_same_line();
    if (!object) {
        ui_name_cut("(nothing hit)", ui_room());
    } else if (ui_row_cut(name_of(viewer, object), viewer->drawn->shown.chosen == object, tip)) {
        viewer_choose(viewer, object);
    }
}

static void draw_shares(struct window *window, const struct study_answer *answer, const struct study_table *table,
                        size_t angle)
{
    char at[48];
    struct viewer *viewer = window->viewer;
    snprintf(at, sizeof at, "share at %.4g\u00b0", answer->angles[angle]);
    const char *columns[3] = {"area", at, "most"};
    static const char *const widest[] = {"", "100.00 %", "100.00 %"};
    float widths[3];
    panel_widths(widths, window, columns, widest, 3);
    size_t shown = ui_list_fit(widths, 3, 2);
    if (ui_table("shares", columns, widths, shown, LINES * ui_list_line())) {
        for (size_t i = 0; i < table->curve_count; i++) {
            const struct study_curve *curve = &table->curves[i];
            ui_id(curve->object);
            draw_name(viewer, table, curve->object, "click: choose it");
            ui_cell();
            ui_underline(curve->shares[angle], colour_of(viewer, table, curve->object));
            panel_number("%.2f %%", 100 * curve->shares[angle]);
            if (shown == 3) {
                ui_cell();
                panel_number("%.2f %%", 100 * curve->most);
            }
            ui_id_end();
        }
        ui_list_end();
    }
}

enum { CHANCE_TIP = 320 };

static void tip_of_chance(char tip[CHANCE_TIP], const conus_table *chances, size_t row)
{
    double in_cone = chance_number(chances, row, "p_in_cone");
    size_t used = (size_t)snprintf(
        tip, CHANCE_TIP,
        "is the one hit: %.2f %%, standard error %.2f %%\nsome pixel hits it first: %.2f %%\nshare: %.2f %% on "
        "average, varies by %.2f %%",
        100 * chance_number(chances, row, "p_hit"), 100 * chance_number(chances, row, "p_hit_error"),
        100 * chance_number(chances, row, "p_seen"), 100 * chance_number(chances, row, "mean_share"),
        100 * chance_number(chances, row, "sd_share"));
    if (isfinite(in_cone) && used < CHANCE_TIP) {
        snprintf(tip + used, CHANCE_TIP - used, "\nis in the cone at all: %.2f %%", 100 * in_cone);
    }
}

static void draw_chances(struct window *window, const struct study_table *table)
{
    static const char *const columns[] = {"area", "hit %", "\u00b1 %", "seen %"};
    struct viewer *viewer = window->viewer;
    float widths[4];
    panel_widths(widths, window, columns, (const char *const[]){"", "behind", "100.00", "100.00"}, 4);
    size_t shown = ui_list_fit(widths, 4, 2); /* the tip has all */
    if (ui_table("chances", columns, widths, shown, (LINES + 2) * ui_list_line())) {
        for (size_t i = 0; i < conus_table_rows(table->chances); i++) {
            static const char *const shown_as[] = {NULL, "p_hit", "p_hit_error", "p_seen"};
            uint32_t object = conus_table_objects(table->chances)[i];
            char tip[CHANCE_TIP];
            if (!chance_is_listed(table->chances, i)) {
                continue;
            }
            bool is_behind = chance_is_behind(table->chances, i);
            tip_of_chance(tip, table->chances, i);
            ui_id(object);
            draw_name(viewer, table, object, tip);
            for (size_t c = 1; c < shown; c++) {
                double chance = chance_number(table->chances, i, shown_as[c]);
                ui_cell();
                if (c == 1 && is_behind) {
                    ui_text_right("behind");
                } else if (!is_behind) {
                    if (c == 1) {
                        ui_underline(chance, colour_of(viewer, table, object));
                    }
                    panel_number("%.2f", 100 * chance);
                }
            }
            ui_id_end();
        }
        ui_list_end();
    }
}

static void draw_study(struct window *window, bool cone_is_old)
{
    const struct viewer *viewer = window->viewer;
    const struct study_answer *answer = viewer->study.answer;
    bool is_behind = studies_is_old(viewer);
    bool is_old = is_behind || cone_is_old;
    bool fits = answer && answer->question.settings.kind == viewer->study.settings.kind;
    ui_text_coloured(is_old ? THEME_ORANGE : THEME_HINT, "%s", /* always a line, so that nothing jumps */
                     !is_old     ? "of the cone as it is now"
                     : !fits     ? "computing"
                     : is_behind ? "OLD: computing the new one"
                                 : "OLD ANSWER");
    ui_dim(is_old ? theme_pale : 1);
    size_t drawn = (size_t)(viewer->drawn - viewer->atlases);
    const struct study_table *table = fits && drawn < answer->atlas_count ? &answer->tables[drawn] : NULL;
    if (fits && (!answer->text || !table)) {
        ui_text_wrapped(THEME_PLAIN, answer->error);
    } else if (fits && answer->question.settings.kind == STUDY_SWEEP) {
        draw_shares(window, answer, table, draw_plot(window, answer, table, is_old));
    } else if (fits) {
        draw_chances(window, table);
    }
    ui_dim_end();
    if (ui_button("Copy study", "copies the table that conus sweep prints")) {
        window_copy(window, COPY_STUDY);
    }
    ui_same_line();
    panel_key_button(window, "Save study", "ctrl+j", "saves that table (Ctrl+J)");
}

void panel_study(struct window *window, bool is_old)
{
    struct viewer *viewer = window->viewer;
    if (viewer->study.settings.kind == STUDY_SWEEP) {
        struct study_settings study = viewer->study.settings;
        if (ui_numbers("From, to, by \u00b0", study.angles, "%.4g",
                       "full opening angles in degrees: the first, the last, and the step between them (--angles); "
                       "Enter takes "
                       "them")) {
            studies_use(viewer, &study);
        }
    } else if (viewer->study.settings.kind == STUDY_JITTER) {
        choose_errors(viewer);
    }
    if (studies_is_on(viewer)) {
        draw_study(window, is_old);
    } else if (viewer->study.settings.kind) {
        ui_text("no cone to study yet");
    }
}
