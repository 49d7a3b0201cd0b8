/* SPDX-License-Identifier: BSD-3-Clause */
/* Writes how an atlas looks as JSON, and reads and checks it. */
#include "viewer/session/session_look.h"

#include <math.h>
#include <string.h>

/* Grey values are floats; a window of them that a mouse makes is some times wider. */
static const double grey_limit = 1e30;

static json_t *grey_of(const struct look *look)
{
    bool set = look->grey[0] != 0 || look->grey[1] != 0;
    return set ? json_pack("[f, f]", look->grey[0], look->grey[1]) : json_null();
}

static json_t *opacities_of(const struct look *look)
{
    json_t *list = json_array();
    for (size_t number = 1; number <= look->object_count; number++) {
        if (!isnan(look->opacity[number])) {
            json_array_append_new(list, json_pack("[i, f]", (int)number, look->opacity[number]));
        }
    }
    return list;
}

static json_t *haze_of(const struct view_atlas *on)
{
    json_t *list = json_array();
    for (size_t number = 1; number <= on->look.object_count; number++) {
        if (on->look.haze[number] != HAZE_NONE) {
            json_array_append_new(list, json_pack("[i, s]", (int)number, haze_name(on->look.haze[number])));
        }
    }
    return list;
}

json_t *session_look(const struct view_atlas *on)
{
    const char *streamlines = tract_colour_name(on->atlas, on->look.streamlines);
    json_t *look =
        json_pack("{s: o, s: o, s: f, s: o}", "grey", grey_of(&on->look), "opacities", opacities_of(&on->look),
                  "opacity_of_the_rest", on->look.opacity[0], "pathways", haze_of(on));
    if (look && streamlines) {
        json_object_set_new(look, "streamline_colour", json_string(streamlines));
    }
    return look;
}

static bool read_grey(struct look *out, const json_t *value, char why[SESSION_REASON])
{
    if (!value || json_is_null(value)) {
        return true;
    }
    for (size_t i = 0; i < 2; i++) {
        out->grey[i] = json_number_value(json_array_get(value, i));
    }
    bool fine = json_is_array(value) && json_array_size(value) == 2 && json_is_number(json_array_get(value, 0)) &&
                json_is_number(json_array_get(value, 1)) && out->grey[0] >= -grey_limit && out->grey[1] <= grey_limit &&
                out->grey[0] < out->grey[1];
    return fine || session_refuse(why, "session: grey: two numbers are needed, black less than white, or null");
}

/* An object's number in an entry of a list; 0 = none that is allowed. */
static size_t number_of(const json_t *entry, const struct look *look)
{
    json_int_t number = json_integer_value(json_array_get(entry, 0));
    bool fine = json_array_size(entry) == 2 && number >= 1 && (uint64_t)number <= look->object_count;
    return fine ? (size_t)number : 0;
}

static bool read_opacities(struct look *out, const json_t *list, char why[SESSION_REASON])
{
    bool fine = !list || json_is_array(list);
    for (size_t i = 0; fine && i < json_array_size(list); i++) {
        const json_t *entry = json_array_get(list, i);
        const json_t *opacity = json_array_get(entry, 1);
        size_t number = number_of(entry, out);
        fine = number && json_is_number(opacity) && json_number_value(opacity) >= 0 && json_number_value(opacity) <= 1;
        out->opacity[fine ? number : 0] = json_number_value(opacity);
    }
    return fine || session_refuse(why,
                                  "session: opacities: a list of pairs is needed, each a number from 1 to %zu and an "
                                  "opacity from 0 to 1",
                                  out->object_count);
}

static bool read_rest(struct look *out, const json_t *value, char why[SESSION_REASON])
{
    out->opacity[0] = value ? json_number_value(value) : 1;
    return (out->opacity[0] > 0 && out->opacity[0] <= 1) ||
           session_refuse(why, "session: opacity_of_the_rest: a number above 0 and up to 1 is needed");
}

static bool read_haze(struct look *out, const struct view_atlas *on, const json_t *list, char why[SESSION_REASON])
{
    bool fine = !list || json_is_array(list);
    for (size_t i = 0; fine && i < json_array_size(list); i++) {
        const json_t *entry = json_array_get(list, i);
        const char *name = json_string_value(json_array_get(entry, 1));
        size_t number = number_of(entry, out);
        size_t haze = name ? haze_find(name) : HAZE_LIMIT;
        fine = number && haze < HAZE_LIMIT && conus_atlas_object(on->atlas, number)->kind == CONUS_KIND_PATHWAY;
        out->haze[fine ? number : 0] = (uint8_t)(fine ? haze : HAZE_NONE);
    }
    return fine || session_refuse(why, "session: pathways: a list of pairs is needed, each a pathway's number and "
                                       "\"solid\", \"own\" or the name of a preset");
}

static bool read_streamlines(struct look *out, const struct view_atlas *on, const json_t *value,
                             char why[SESSION_REASON])
{
    const char *name = json_string_value(value);
    size_t colour = name ? tract_colour_find(on->atlas, name) : TRACT_COLOUR_LIMIT;
    if (!value) {
        return true;
    }
    if (colour == TRACT_COLOUR_LIMIT) {
        return session_refuse(why,
                              "session: streamline_colour: \"bundle\", \"direction\" or the name of a number that the "
                              "streamlines have is needed");
    }
    look_colour_streamlines(out, on->atlas, colour);
    return true;
}

bool session_look_read(struct look *out, const struct view_atlas *on, const json_t *entry, char why[SESSION_REASON])
{
    struct look look;
    if (!look_init(&look, on->object_count)) {
        return session_refuse(why, "session: not enough memory");
    }
    bool fine = (json_is_object(entry) || session_refuse(why, "session: look: an object is needed")) &&
                read_grey(&look, json_object_get(entry, "grey"), why) &&
                read_opacities(&look, json_object_get(entry, "opacities"), why) &&
                read_rest(&look, json_object_get(entry, "opacity_of_the_rest"), why) &&
                read_haze(&look, on, json_object_get(entry, "pathways"), why) &&
                read_streamlines(&look, on, json_object_get(entry, "streamline_colour"), why);
    if (fine) {
        *out = look;
    } else {
        look_finish(&look);
    }
    return fine;
}

bool session_backdrop_read(enum backdrop *backdrop, const json_t *name, char why[SESSION_REASON])
{
    const char *text = json_string_value(name);
    if (!name) {
        return true;
    }
    for (int i = 0; text && i < BACKDROP_COUNT; i++) {
        if (strcmp(backdrop_names[i], text) == 0) {
            *backdrop = (enum backdrop)i;
            return true;
        }
    }
    return session_refuse(why, "session: background: light, white, black or transparent is needed");
}

json_t *session_sheet(const struct sheet *sheet)
{
    return json_pack("{s: b, s: [i, i], s: [f, f], s: f, s: i, s: b}", "in_mm", sheet->in_mm, "pixels",
                     (int)sheet->pixels[0], (int)sheet->pixels[1], "mm", sheet->mm[0], sheet->mm[1], "dpi", sheet->dpi,
                     "legend", (int)sheet->legend, "text", !sheet->no_text);
}

bool session_sheet_read(struct sheet *sheet, const json_t *entry, char why[SESSION_REASON])
{
    int in_mm, text;
    json_int_t pixels[2], legend;
    double mm[2], dpi;
    if (!entry) {
        return true;
    }
    bool fine =
        !json_unpack((json_t *)entry, "{s: b, s: [I, I!], s: [F, F!], s: F, s: I, s: b}", "in_mm", &in_mm, "pixels",
                     &pixels[0], &pixels[1], "mm", &mm[0], &mm[1], "dpi", &dpi, "legend", &legend, "text", &text) &&
        (dpi == 0 || (dpi >= SHEET_DPI_LEAST && dpi <= SHEET_DPI_LIMIT)) && legend >= 0 && legend <= CONUS_LEGEND_NONE;
    for (int i = 0; i < 2 && fine; i++) {
        fine = pixels[i] >= 0 && pixels[i] <= SHEET_SIDE_LIMIT && mm[i] >= 0 && mm[i] <= SHEET_MM_LIMIT;
    }
    if (!fine) {
        return session_refuse(why,
                              "session: figure: in_mm, pixels from 0 to %d, mm from 0 to %d, dpi of 0 or %d to %d, "
                              "legend from 0 to %d and text are needed",
                              SHEET_SIDE_LIMIT, SHEET_MM_LIMIT, SHEET_DPI_LEAST, SHEET_DPI_LIMIT, CONUS_LEGEND_NONE);
    }
    *sheet = (struct sheet){.in_mm = in_mm,
                            .pixels = {(uint32_t)pixels[0], (uint32_t)pixels[1]},
                            .mm = {mm[0], mm[1]},
                            .dpi = dpi,
                            .legend = (conus_legend)legend,
                            .no_text = !text};
    return true;
}

json_t *session_layout(const struct layout *layout)
{
    return json_pack("{s: [f, f], s: [f, f]}", "panels", layout->panels[0], layout->panels[1], "division",
                     layout->division[0], layout->division[1]);
}

bool session_layout_read(struct layout *layout, const json_t *entry, char why[SESSION_REASON])
{
    struct layout read;
    if (!entry) {
        return true;
    }
    bool fine = !json_unpack((json_t *)entry, "{s: [F, F!], s: [F, F!]}", "panels", &read.panels[0], &read.panels[1],
                             "division", &read.division[0], &read.division[1]) &&
                layout_is_fine(&read);
    *layout = fine ? read : *layout;
    return fine || session_refuse(why, "session: layout: panels, 0 or two widths in pixels, and division, two parts "
                                       "from 0.1 to 0.9 or 0, are needed");
}

bool session_preset_read(const char **preset, const struct view_atlas *on, const json_t *name, char why[SESSION_REASON])
{
    const char *text = json_string_value(name);
    const char *found = NULL;
    *preset = NULL;
    if (!name || json_is_null(name)) {
        return true;
    }
    if (view_atlas_context(on) == conus_atlas_volume_count(on->atlas)) {
        return session_refuse(why, "session: preset: there is no context here, open it with --context");
    }
    for (size_t i = 0; text && !*preset && (found = conus_transfer_preset(i)); i++) {
        *preset = strcmp(found, text) == 0 ? found : NULL;
    }
    return *preset || session_refuse(why, "session: preset: the name of a transfer function is needed, or null");
}
