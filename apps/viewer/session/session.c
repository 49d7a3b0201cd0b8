/* SPDX-License-Identifier: BSD-3-Clause */
/* A session: the rows of properties[], then what no row can say: the score, the level, columns, confirmed results, the
 * context's colours, and what each atlas shows. */
#include "viewer/session/session.h"

#include "conus/own.h"
#include "options/messages.h"
#include "options/output.h"
#include "viewer/model/columns.h"

#include <float.h>
#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SESSION_VERSION = 1, SESSION_LIMIT = 64 << 20 /* bytes of a file */ };

/* A session that was read; all of it is checked before any of it is used. */
struct session {
    double values[PROPERTY_COUNT][PROPERTY_NUMBERS];
    uint32_t columns;
    const char *score, *level; /* the level is the session's */
    struct atlas_edits edits;
    struct session_atlases atlases;
};

/* The window's values; one that was never set is its default. */
static void take_values(double values[PROPERTY_COUNT][PROPERTY_NUMBERS], const struct window *window)
{
    const struct viewer *viewer = window->viewer;
    for (size_t i = 0; i < PROPERTY_COUNT; i++) {
        property_get(values[i], &properties[i], window);
    }
    values[PROPERTY_BY_HEAD][0] = viewer->head.on && viewer->head.known;
    values[PROPERTY_SPEED][0] = devices_speed(&window->inputs.devices);
}

static void add_values(json_t *root, const struct window *window)
{
    double values[PROPERTY_COUNT][PROPERTY_NUMBERS];
    take_values(values, window);
    for (size_t i = 0; i < PROPERTY_COUNT; i++) {
        const struct property *property = &properties[i];
        bool is_left_out = (property->presence == PROPERTY_OF_HEAD && values[PROPERTY_BY_HEAD][0] == 0) ||
                           (property->presence == PROPERTY_ZERO && values[i][0] == 0);
        if (is_left_out) {
            continue;
        }
        if (property->object && !json_object_get(root, property->object)) {
            json_object_set_new(root, property->object, json_object());
        }
        json_object_set_new(property->object ? json_object_get(root, property->object) : root, property->name,
                            property_json(property, values[i]));
    }
}

/* The names of the chosen columns, in their order; null where none were chosen. */
static json_t *columns_of(const struct result_list *list)
{
    json_t *names = list->columns ? json_array() : json_null();
    for (size_t i = 0; list->columns && i < RESULT_COLUMNS; i++) {
        if (list->columns >> i & 1) {
            json_array_append_new(names, json_string(result_key(i)));
        }
    }
    return names;
}

/* A confirmed result that is occluded has no contact and no distance; in a session the share may be missing, too. */
static json_t *number_or_null(double value)
{
    return isfinite(value) ? json_real(value) : json_null();
}

static json_t *place_of(const double at[3])
{
    return json_pack("[o, o, o]", number_or_null(at[0]), number_or_null(at[1]), number_or_null(at[2]));
}

static json_t *pins_of(const struct viewer *viewer)
{
    json_t *pins = json_array();
    for (size_t i = 0; i < viewer->pin_count; i++) {
        const struct pin *pin = &viewer->pins[i];
        json_t *entry =
            json_pack("{s: i, s: o, s: o, s: o}", "object", (int)pin->object, "share", number_or_null(pin->share),
                      "distance_mm", number_or_null(pin->distance), "contact", place_of(pin->contact));
        if (isfinite(pin->entry[0])) {
            json_object_set_new(entry, "entry", place_of(pin->entry));
        }
        json_object_set_new(entry, "name", json_string(pin->name)); /* left out where it was cut within a letter */
        if (viewer->atlas_count > 1) {
            json_object_set_new(entry, "atlas", json_integer((json_int_t)pin->atlas + 1));
        }
        json_array_append_new(pins, entry);
    }
    return pins;
}

/* The points of an edited transfer function; null where the context is drawn as it came. */
static json_t *transfer_of(const struct transfer_editor *editor)
{
    json_t *list = editor->edited ? json_array() : json_null();
    for (size_t i = 0; editor->edited && i < editor->count; i++) {
        const conus_transfer_point *point = &editor->points[i];
        json_array_append_new(list, json_pack("[f, f, f, f, f]", point->value, point->rgba[0], point->rgba[1],
                                              point->rgba[2], point->rgba[3]));
    }
    return list;
}

json_t *session_json(const struct window *window)
{
    const struct viewer *viewer = window->viewer;
    const struct view_atlas *first = viewer->atlases;
    json_t *root =
        json_pack("{s: i, s: s, s: i, s: s}", "conus_session", SESSION_VERSION, "atlas", first->path, "objects",
                  (int)first->object_count, "score", viewer->cone.options.score ? viewer->cone.options.score : "share");
    if (!root) {
        return NULL;
    }
    add_values(root, window);
    json_object_set_new(json_object_get(root, "results"), "columns", columns_of(&viewer->list));
    if (window->files.opened) {
        json_object_set_new(root, "opened", json_deep_copy(window->files.opened)); /* session_fit() changes it */
    }
    json_object_set_new(root, "level", json_string(viewer->cone.level));
    json_object_set_new(root, "place", session_place(first));
    json_object_set_new(root, "hidden", session_hidden(first));
    json_object_set_new(root, "chosen", json_integer(first->shown.chosen));
    json_object_set_new(root, "confirmed", pins_of(viewer));
    json_object_set_new(root, "thresholds", session_thresholds(first));
    json_object_set_new(root, "transfer", transfer_of(&viewer->transfer_editor));
    json_object_set_new(root, "preset", viewer->preset ? json_string(viewer->preset) : json_null());
    json_object_set_new(root, "look", session_look(first));
    json_object_set_new(root, "named", session_named(viewer, 0));
    if (viewer->atlas_count > 1) {
        json_object_set_new(root, "drawn", json_integer(viewer->drawn - viewer->atlases + 1));
        if (json_object_set_new(root, "further_atlases", session_further(viewer))) {
            json_decref(root);
            root = NULL;
        }
    }
    return root;
}

/* The checks that need more than one row. */
static bool check_values(double values[PROPERTY_COUNT][PROPERTY_NUMBERS], char why[PROPERTY_REASON])
{
    const double *sweep = values[PROPERTY_SWEEP];
    const double *jitter = values[PROPERTY_JITTER];
    const struct study_settings study = {.kind = (enum study_kind)values[PROPERTY_STUDY][0],
                                         .angles = {sweep[0], sweep[1], sweep[2]},
                                         .tilt_deg = jitter[0],
                                         .shift_mm = jitter[1],
                                         .samples = jitter[2]};
    const double *panels = values[PROPERTY_PANELS];
    const double *division = values[PROPERTY_DIVISION];
    const struct layout layout = {.panels = {panels[0], panels[1]}, .division = {division[0], division[1]}};
    double dpi = values[PROPERTY_FIGURE_DPI][0];
    const char *fault = study_fault(&study);
    if (fault) {
        return session_refuse(why, "%s", fault);
    }
    if (!layout_is_fine(&layout)) {
        return session_refuse(why, "layout: panels, 0 or two widths in pixels, and division, two parts from "
                                   "0.1 to 0.9 or 0, are needed");
    }
    return dpi == 0 || dpi >= SHEET_DPI_LEAST ||
           session_refuse(why, "figure: dpi: 0 or a number from %d to %d is needed", SHEET_DPI_LEAST, SHEET_DPI_LIMIT);
}

/* @p values are the window's, and stay so where the session says nothing. */
static bool read_values(double values[PROPERTY_COUNT][PROPERTY_NUMBERS], const json_t *root, char why[PROPERTY_REASON])
{
    bool has_head = json_object_get(root, "by_head");
    values[PROPERTY_BY_HEAD][0] = values[PROPERTY_SLICE_FRACTION][0] = 0;
    for (size_t i = 0; i < PROPERTY_COUNT; i++) {
        const struct property *property = &properties[i];
        const json_t *of = property->object ? json_object_get(root, property->object) : root;
        const json_t *value = json_object_get(of, property->name);
        bool is_said =
            property->presence == PROPERTY_OF_HEAD ? has_head : value || (property->presence == PROPERTY_NEEDED && of);
        if (is_said && !property_read(values[i], property, value, why)) {
            return false;
        }
    }
    values[PROPERTY_ORBIT][3] = fmax(values[PROPERTY_ORBIT][3], 1);
    if (values[PROPERTY_SAMPLING][0] != CONUS_SAMPLING_SLICES) {
        values[PROPERTY_SLICE_FRACTION][0] = values[PROPERTY_SLICES][0] = 0;
    }
    return check_values(values, why);
}

static double number_or_nan(const json_t *value)
{
    return json_is_number(value) ? json_number_value(value) : NAN;
}

static void read_pins(struct viewer *viewer, const json_t *root)
{
    const json_t *list = json_object_get(root, "confirmed");
    viewer->pin_count = 0;
    for (size_t i = 0; i < json_array_size(list) && viewer->pin_count < PIN_LIMIT; i++) {
        const json_t *entry = json_array_get(list, i);
        json_int_t object = json_integer_value(json_object_get(entry, "object"));
        json_int_t atlas = json_integer_value(json_object_get(entry, "atlas"));
        size_t of = atlas > 0 ? (size_t)atlas - 1 : 0; /* a session of one atlas does not say of which */
        struct pin pin = {.atlas = of,
                          .object = (uint32_t)object,
                          .share = number_or_nan(json_object_get(entry, "share")),
                          .distance = number_or_nan(json_object_get(entry, "distance_mm"))};
        for (size_t a = 0; a < 3; a++) {
            pin.contact[a] = number_or_nan(json_array_get(json_object_get(entry, "contact"), a));
            pin.entry[a] = number_or_nan(json_array_get(json_object_get(entry, "entry"), a));
        }
        const char *name = json_string_value(json_object_get(entry, "name"));
        const conus_object *is = of < viewer->atlas_count && object > 0
                                     ? conus_atlas_object(viewer->atlases[of].atlas, (size_t)object)
                                     : NULL;
        const bool is_other = is && name && strncmp(is->name, name, sizeof pin.name - 1) != 0;
        pin.object = is && !is_other ? pin.object : 0;
        if (pin.object || (name && of < viewer->atlas_count && (is || !object))) {
            snprintf(pin.name, sizeof pin.name, "%s", name ? name : "");
            viewer_pin(viewer, pin);
        }
    }
}

static bool read_columns(uint32_t *out, const json_t *results, char why[PROPERTY_REASON])
{
    const json_t *names = json_object_get(results, "columns");
    bool fine = !results || json_is_null(names) || json_array_size(names) > 0;
    *out = results ? 0 : *out;
    for (size_t i = 0; fine && i < json_array_size(names); i++) {
        const char *key = json_string_value(json_array_get(names, i));
        size_t column = key ? result_find(key) : RESULT_COLUMNS;
        fine = column < RESULT_COLUMNS;
        *out |= fine ? UINT32_C(1) << column : 0;
    }
    return fine || session_refuse(why, "results: columns: names of columns are needed, or null");
}

/* Reads five numbers: a grey value not below @p least, red, green, blue and opacity. */
static bool read_point(conus_transfer_point *out, const json_t *entry, double least)
{
    double *rgba = out->rgba;
    bool fine = !json_unpack((json_t *)entry, "[FFFFF!]", &out->value, &rgba[0], &rgba[1], &rgba[2], &rgba[3]) &&
                out->value >= least && out->value <= FLT_MAX;
    for (size_t i = 0; i < 4; i++) {
        fine = fine && rgba[i] >= 0 && rgba[i] <= 1;
    }
    return fine;
}

static bool read_transfer(struct atlas_edits *out, const struct view_atlas *view, const json_t *list,
                          char why[PROPERTY_REASON])
{
    size_t count = json_array_size(list);
    out->sets_transfer = true;
    if (json_is_null(list)) {
        return true;
    }
    if (view_atlas_context(view) == conus_atlas_volume_count(view->atlas)) {
        return session_refuse(why, "transfer: there is no context here, open it with --context");
    }
    bool fine = json_is_array(list) && count >= 1 && count <= EDITOR_POINTS;
    for (size_t i = 0; fine && i < count; i++) {
        fine = read_point(&out->points[i], json_array_get(list, i), i ? out->points[i - 1].value : -FLT_MAX);
    }
    out->point_count = count;
    return fine || session_refuse(why,
                                  "transfer: 1 to %d points are needed, each a grey value not less than the one "
                                  "before, red, green, blue and opacity from 0 to 1",
                                  EDITOR_POINTS);
}

static bool read_preset(const char **preset, const struct view_atlas *view, const json_t *name,
                        char why[PROPERTY_REASON])
{
    const char *text = json_string_value(name);
    const char *found = NULL;
    *preset = NULL;
    if (!name || json_is_null(name)) {
        return true;
    }
    if (view_atlas_context(view) == conus_atlas_volume_count(view->atlas)) {
        return session_refuse(why, "preset: there is no context here, open it with --context");
    }
    for (size_t i = 0; text && !*preset && (found = conus_transfer_preset(i)); i++) {
        *preset = strcmp(found, text) == 0 ? found : NULL;
    }
    return *preset || session_refuse(why, "preset: the name of a transfer function is needed, or null");
}

/* Reads colours and thresholds; what the session does not say stays as it is. */
static bool read_edits(struct session *out, const struct viewer *viewer, const json_t *root, char why[PROPERTY_REASON])
{
    const json_t *transfer = json_object_get(root, "transfer");
    if (!session_atlases_read(&out->atlases, viewer, root, why)) {
        return false;
    }
    out->edits = (struct atlas_edits){.thresholds = out->atlases.thresholds,
                                      .safe_colours = out->values[PROPERTY_SAFE_COLOURS][0] > 0};
    const struct view_atlas *drawn = &viewer->atlases[out->atlases.drawn];
    return !transfer || (read_transfer(&out->edits, drawn, transfer, why) &&
                         read_preset(&out->edits.preset, drawn, json_object_get(root, "preset"), why));
}

/* Reads the level of the first atlas, as for --level. */
static bool read_level(const char **out, const struct viewer *viewer, const json_t *root, char why[PROPERTY_REASON])
{
    *out = json_string_value(json_object_get(root, "level"));
    if (!*out || strlen(*out) >= LEVEL_LIMIT) {
        return session_refuse(why, "level: a text of up to %d bytes is needed", LEVEL_LIMIT - 1);
    }
    conus_selector *selector = NULL;
    const conus_selector_options options = {.level = *out};
    conus_status status = !(*out)[0] || strcmp(*out, viewer->cone.level) == 0
                              ? CONUS_OK
                              : conus_selector_create(&selector, viewer->atlases->atlas, &options);
    conus_selector_destroy(selector);
    return !status || session_refuse(why, "%s", conus_message());
}

/* Changes the atlases before all else, since this may fail. */
static bool set_up(struct viewer *viewer, size_t drawn, const struct atlas_edits *settings, char why[PROPERTY_REASON])
{
    size_t before = (size_t)(viewer->drawn - viewer->atlases);
    viewer_draw(viewer, drawn);
    if (viewer_set_up(viewer, settings)) {
        viewer_draw(viewer, before);
        return session_refuse(why, "not enough memory");
    }
    return true;
}

static void put_head(struct head *head, double values[PROPERTY_COUNT][PROPERTY_NUMBERS])
{
    const double *size = values[PROPERTY_SCREEN_MM];
    bool by_head = values[PROPERTY_BY_HEAD][0] > 0;
    conus_pose screen;
    memcpy(screen.world_from_device, values[PROPERTY_SCREEN], sizeof screen.world_from_device);
    head->on = by_head || head->named; /* a view that the mouse turns is no reason to leave a head that is tracked */
    if (by_head && size[0] > 0 && size[1] > 0) {
        memcpy(head->size, size, sizeof head->size);
        head->known = false;
        head_move(head, values[PROPERTY_EYE], &screen);
    }
}

static void put_session(struct window *window, struct session *session, const json_t *root)
{
    struct viewer *viewer = window->viewer;
    struct tool *second = &viewer->tools[SECOND_TOOL];
    for (size_t i = 0; i < PROPERTY_COUNT; i++) {
        if (!properties[i].is_set_apart) {
            property_put(window, &properties[i], session->values[i]);
        }
    }
    points_check(viewer);
    put_head(&viewer->head, session->values);
    devices_set_speed(&window->inputs.devices, session->values[PROPERTY_SPEED][0]);
    viewer->list.columns = session->columns;
    viewer->cone.options.score = session->score;
    memmove(viewer->cone.level, session->level, strlen(session->level) + 1); /* maybe itself */
    session_atlases_show(&session->atlases, viewer);
    read_pins(viewer, root);
    tool_reselect(viewer);
    if (json_object_get(root, "crosshair")) { /* a click may have left it elsewhere than what the cuts follow */
        memcpy(viewer->crosshair, session->values[PROPERTY_CROSSHAIR], sizeof viewer->crosshair);
    }
    enum pointer pointer = second->pointer;
    tool_use_second(viewer, session->values[PROPERTY_SECOND_ON][0] > 0);
    second->pointer = pointer; /* whatever moves the first */
}

static bool read_session(struct window *window, json_t *root, char why[PROPERTY_REASON])
{
    struct viewer *viewer = window->viewer;
    struct session session = {.columns = viewer->list.columns,
                              .score = viewer_find_score(json_string_value(json_object_get(root, "score")))};
    session_fit(root, window);
    const json_t *says = json_object_get(root, "conus_session");
    json_int_t version = json_integer_value(says);
    if (!says) {
        return session_refuse(why, "no session of conus view");
    }
    if (version != SESSION_VERSION) {
        return session_refuse(
            why, "\"conus_session\" is %" JSON_INTEGER_FORMAT ", and this conus reads %d: another version wrote it",
            version, SESSION_VERSION);
    }
    take_values(session.values, window);
    bool fine = read_values(session.values, root, why) &&
                read_columns(&session.columns, json_object_get(root, "results"), why) &&
                (session.score || session_refuse(why, "score: unknown")) &&
                read_level(&session.level, viewer, root, why) && read_edits(&session, viewer, root, why) &&
                set_up(viewer, session.atlases.drawn, &session.edits, why);
    if (fine) {
        put_session(window, &session, root);
    }
    session_atlases_finish(&session.atlases);
    return fine;
}

bool session_read(struct window *window, json_t *root, const char *name, char why[PROPERTY_REASON])
{
    char fault[PROPERTY_REASON];
    return read_session(window, root, fault) || session_refuse(why, "%.120s: %s", name, fault);
}

static json_t *read_file(const char *path, char why[PROPERTY_REASON])
{
    char *text = NULL;
    size_t size = 0;
    messages_hold(true);
    int code = input_file_read(&text, &size, path, INPUT_FILE_OR_PIPE, SESSION_LIMIT);
    messages_hold(false);
    json_error_t error;
    json_t *root = code ? NULL : json_loadb(text, size, JSON_REJECT_DUPLICATES, &error);
    if (code) {
        session_refuse(why, "%s", error_line());
    } else if (!root) {
        session_refuse(why, "%s: line %d: %s", path, error.line, error.text);
    }
    free(text);
    return root;
}

bool session_check(const char *path, char why[PROPERTY_REASON])
{
    json_t *root = read_file(path, why);
    json_decref(root);
    return root;
}

/* What only a session keeps: the pins without the numbers of their atlases and objects, which change as files come and
 * go, and the transfer function that was drawn. */
static json_t *work_of(const struct viewer *viewer)
{
    json_t *pins = pins_of(viewer);
    for (size_t i = 0; i < json_array_size(pins); i++) {
        json_object_del(json_array_get(pins, i), "atlas");
        json_object_del(json_array_get(pins, i), "object");
    }
    return json_pack("{s: o, s: o}", "confirmed", pins, "transfer", transfer_of(&viewer->transfer_editor));
}

static bool lacks(const json_t *kept, const json_t *work, const char *part)
{
    const json_t *now = json_object_get(work, part);
    return json_array_size(now) && !json_equal(now, json_object_get(kept, part));
}

const char *session_lacks(const struct window *window)
{
    static const char *const parts[] = {NULL, "what was kept", "the transfer function that was drawn",
                                        "what was kept, nor the transfer function that was drawn"};
    json_t *work = window->viewer ? work_of(window->viewer) : NULL;
    const json_t *kept = window->history.kept;
    const char *lacking = parts[lacks(kept, work, "confirmed") + 2 * lacks(kept, work, "transfer")];
    json_decref(work);
    return lacking;
}

/* Notes where Ctrl+S saves from now on, and what is kept there, in `root`. */
static void note_session(struct window *window, const char *path, const json_t *root)
{
    char *copy = strdup(path);
    json_decref(window->history.kept);
    window->history.kept = work_of(window->viewer);
    if (!json_object_get(root, "transfer")) { /* that of before stayed */
        json_object_del(window->history.kept, "transfer");
    }
    if (copy) {
        free(window->history.session_path);
        window->history.session_path = copy;
    }
}

bool session_save(struct window *window, const char *path, char why[PROPERTY_REASON])
{
    json_t *root = session_json(window);
    char *text = root && session_keep_lost(root, window) ? json_dumps(root, JSON_INDENT(1)) : NULL;
    conus_status status = text ? conus_write_file(path, text, strlen(text)) : CONUS_ERROR_MEMORY;
    free(text);
    if (!status) {
        note_session(window, path, root);
    }
    json_decref(root);
    return !status ||
           session_refuse(why, "%s",
                          text ? conus_message() : "session: not enough memory, or a name that is not UTF-8");
}

bool session_load(struct window *window, const char *path, char why[PROPERTY_REASON])
{
    json_t *root = read_file(path, why);
    bool fine = root && session_read(window, root, path, why);
    if (fine) {
        note_session(window, path, root);
        viewer_say(window->viewer, "opened: %s", path_name(path)); /* what was said before is of another state */
    }
    json_decref(root);
    return fine;
}
