/* SPDX-License-Identifier: BSD-3-Clause */
/* Writes the state of the window as JSON, and reads and checks it. */
#include "viewer/session/session.h"

#include "viewer/session/session_atlases.h"
#include "viewer/session/session_fit.h"
#include "viewer/session/session_list.h"
#include "viewer/session/session_look.h"
#include "viewer/session/session_second.h"

#include <errno.h>
#include <float.h>
#include <jansson.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SESSION_VERSION = 1, SESSION_LIMIT = 64 << 20 /* bytes of a file */ };

/* A number of the session and where it lives, with what is allowed. */
struct field {
    const char *key;
    double *value;
    size_t count;
    double low, high;
};

/* What a session holds, apart from the viewer; scores are names, not pointers. */
struct state {
    double pose[16], angle, radius, range[2], resolution, layers, aperture, sampling, engine, pointer, has_pose, frozen;
    double slice_fraction; /* only with slices; 0 = default */
    double apex_at_eye, one_ray, follow, order, slices;
    double study, sweep[3], jitter[3]; /* kind; degrees; degrees, mm and samples */
    double fade, fill, outlines, radiological;
    double orbit[6]; /* centre, distance, azimuth, elevation */
    double crosshair[3], magnification, enlarged;
    double by_head, eye[3], screen[16], screen_mm[2];
};

enum { FIELD_LIMIT = 28, HEAD_FIELDS = 4 /* the last ones: only where a head moves the view */ };

static size_t list_fields(struct field fields[FIELD_LIMIT], struct state *state)
{
    const struct field all[] = {
        {"world_from_device", state->pose, 16, -1e6, 1e6},
        {"has_pose", &state->has_pose, 1, 0, 1},
        {"frozen", &state->frozen, 1, 0, 1},
        {"pointer", &state->pointer, 1, 0, POINTER_COUNT - 1},
        {"angle_deg", &state->angle, 1, 0.01, 179.99},
        {"radius_mm", &state->radius, 1, 0, 1e6},
        {"range_mm", state->range, 2, 0, 1e6},
        {"resolution", &state->resolution, 1, 1, 1024},
        {"layers", &state->layers, 1, 0, 1},
        {"aperture", &state->aperture, 1, 0, 1},
        {"sampling", &state->sampling, 1, 0, 1},
        {"engine", &state->engine, 1, 0, 2},
        {"fade", &state->fade, 1, 0, 1},
        {"fill", &state->fill, 1, 0, 1},
        {"outlines", &state->outlines, 1, 0, 1},
        {"radiological", &state->radiological, 1, 0, 1},
        {"orbit", state->orbit, 6, -1e6, 1e6},
        {"crosshair", state->crosshair, 3, -1e6, 1e6},
        {"magnification", &state->magnification, 1, 0.2, 50},
        {"enlarged", &state->enlarged, 1, -1, PANE_COUNT - 1},
        {"by_head", &state->by_head, 1, 0, 1},
        {"eye", state->eye, 3, -1e6, 1e6},
        {"world_from_screen", state->screen, 16, -1e6, 1e6},
        {"screen_mm", state->screen_mm, 2, 0, 1e6},
    };
    memcpy(fields, all, sizeof all);
    return sizeof all / sizeof all[0];
}

enum { OPTIONAL_FIELDS = 9 };

/* Those that a session may lack; then they stay as they are. */
static void list_optional(struct field fields[OPTIONAL_FIELDS], struct state *state)
{
    fields[0] = (struct field){"slice_fraction", &state->slice_fraction, 1, 0, 1};
    fields[1] = (struct field){"apex_at_eye", &state->apex_at_eye, 1, 0, 1};
    fields[2] = (struct field){"one_ray", &state->one_ray, 1, 0, 1};
    fields[3] = (struct field){"follow", &state->follow, 1, 0, FOLLOW_COUNT - 1};
    fields[4] = (struct field){"order", &state->order, 1, 0, CONUS_ORDER_DEPTH};
    fields[5] = (struct field){"slices", &state->slices, 1, 0, 65536};
    fields[6] = (struct field){"study", &state->study, 1, 0, STUDY_COUNT - 1};
    fields[7] = (struct field){"sweep_deg", state->sweep, 3, 0, 180};
    fields[8] = (struct field){"jitter", state->jitter, 3, 0, 1048576};
}

bool session_refuse(char why[SESSION_REASON], const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(why, SESSION_REASON, format, arguments);
    va_end(arguments);
    return false;
}

static void take_study(struct state *out, const struct study_settings *study)
{
    out->study = (double)study->kind;
    memcpy(out->sweep, study->angles, sizeof out->sweep);
    out->jitter[0] = study->tilt_deg;
    out->jitter[1] = study->shift_mm;
    out->jitter[2] = study->samples;
}

static struct study_settings study_of(const struct state *state)
{
    return (struct study_settings){.kind = (enum study_kind)state->study,
                                   .angles = {state->sweep[0], state->sweep[1], state->sweep[2]},
                                   .tilt_deg = state->jitter[0],
                                   .shift_mm = state->jitter[1],
                                   .samples = state->jitter[2]};
}

static void take_state(struct state *out, const struct window *window)
{
    const struct viewer *viewer = window->viewer;
    const conus_selector_options *options = &viewer->cone.options;
    *out = (struct state){.angle = viewer->cone.angle,
                          .radius = options->radius,
                          .range = {options->range[0], options->range[1]},
                          .resolution = options->resolution ? options->resolution : 16,
                          .layers = (double)options->layers,
                          .aperture = (double)options->aperture,
                          .sampling = (double)options->sampling,
                          .slice_fraction = options->slice_fraction,
                          .engine = (double)options->engine,
                          .pointer = (double)viewer->cone.pointer,
                          .has_pose = viewer->cone.has_pose,
                          .frozen = viewer->cone.frozen,
                          .apex_at_eye = viewer->cone.apex_at_eye,
                          .one_ray = viewer->cone.one_ray,
                          .follow = (double)viewer->cone.follow,
                          .order = (double)viewer->cone.order,
                          .slices = options->slices,
                          .fade = viewer->display.fade,
                          .fill = viewer->display.fill,
                          .outlines = !viewer->display.no_outlines,
                          .radiological = viewer->display.radiological,
                          .magnification = viewer->magnification,
                          .enlarged = window->screen.enlarged};
    take_study(out, &viewer->study.settings);
    memcpy(out->pose, viewer->cone.pose.world_from_device, sizeof out->pose);
    memcpy(out->orbit, viewer->orbit.centre, sizeof viewer->orbit.centre);
    out->orbit[3] = viewer->orbit.distance;
    out->orbit[4] = viewer->orbit.azimuth;
    out->orbit[5] = viewer->orbit.elevation;
    memcpy(out->crosshair, viewer->crosshair, sizeof out->crosshair);
    out->by_head = viewer->head.on && viewer->head.known;
    memcpy(out->eye, viewer->head.eye, sizeof out->eye);
    memcpy(out->screen, viewer->head.screen.world_from_device, sizeof out->screen);
    memcpy(out->screen_mm, viewer->head.size, sizeof out->screen_mm);
}

/* A view that the mouse turns is no reason to leave a head that is tracked now. */
static void put_head(struct head *head, const struct state *state)
{
    conus_pose screen;
    memcpy(screen.world_from_device, state->screen, sizeof state->screen);
    head->on = state->by_head > 0 || head->named;
    if (state->by_head > 0 && state->screen_mm[0] > 0 && state->screen_mm[1] > 0) {
        memcpy(head->size, state->screen_mm, sizeof head->size);
        head->known = false;
        head_move(head, state->eye, &screen);
    }
}

static void put_state(struct window *window, const struct state *state)
{
    struct viewer *viewer = window->viewer;
    conus_selector_options *options = &viewer->cone.options;
    memcpy(viewer->cone.pose.world_from_device, state->pose, sizeof state->pose);
    viewer->cone.has_pose = state->has_pose > 0;
    viewer->cone.frozen = state->frozen > 0;
    viewer->cone.apex_at_eye = state->apex_at_eye > 0;
    viewer->cone.one_ray = state->one_ray > 0;
    viewer->cone.follow = (enum follow)state->follow;
    viewer->cone.order = (conus_order)state->order;
    viewer->study.settings = study_of(state);
    viewer->cone.pointer = (enum pointer)state->pointer;
    viewer->cone.angle = state->angle;
    options->radius = state->radius;
    memcpy(options->range, state->range, sizeof state->range);
    options->resolution = (uint32_t)state->resolution;
    options->layers = (conus_layers)state->layers;
    options->aperture = (conus_aperture)state->aperture;
    options->sampling = (conus_sampling)state->sampling;
    options->slice_fraction = options->sampling == CONUS_SAMPLING_SLICES ? state->slice_fraction : 0;
    options->slices = options->sampling == CONUS_SAMPLING_SLICES ? (uint32_t)state->slices : 0;
    options->engine = (conus_engine)state->engine;
    viewer->display.fade = state->fade;
    viewer->display.fill = state->fill;
    viewer->display.no_outlines = !(state->outlines > 0);
    viewer->display.radiological = state->radiological > 0;
    memcpy(viewer->orbit.centre, state->orbit, sizeof viewer->orbit.centre);
    viewer->orbit.distance = fmax(state->orbit[3], 1);
    viewer->orbit.azimuth = state->orbit[4];
    viewer->orbit.elevation = state->orbit[5];
    memcpy(viewer->crosshair, state->crosshair, sizeof viewer->crosshair);
    viewer->magnification = state->magnification;
    window->screen.enlarged = (int)state->enlarged;
    put_head(&viewer->head, state);
}

static json_t *numbers(const struct field *field)
{
    if (field->count == 1) {
        return json_real(*field->value);
    }
    json_t *array = json_array();
    for (size_t i = 0; i < field->count; i++) {
        json_array_append_new(array, json_real(field->value[i]));
    }
    return array;
}

/* A hidden result that was confirmed has no contact and no distance; one of a session may have no share either. */
static json_t *number_or_null(double value)
{
    return isfinite(value) ? json_real(value) : json_null();
}

static json_t *pins_of(const struct viewer *viewer)
{
    json_t *pins = json_array();
    for (size_t i = 0; i < viewer->pin_count; i++) {
        const struct pin *pin = &viewer->pins[i];
        json_t *entry = json_pack("{s: i, s: o, s: o, s: [o, o, o]}", "object", (int)pin->object, "share",
                                  number_or_null(pin->share), "distance_mm", number_or_null(pin->distance), "contact",
                                  number_or_null(pin->contact[0]), number_or_null(pin->contact[1]),
                                  number_or_null(pin->contact[2]));
        json_object_set_new(entry, "name", json_string(pin->name)); /* left out where it was cut within a letter */
        if (viewer->atlas_count > 1) {
            json_object_set_new(entry, "atlas", json_integer((json_int_t)pin->atlas + 1));
        }
        json_array_append_new(pins, entry);
    }
    return pins;
}

/* Null where the context is drawn as it came. */
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

char *session_text(const struct window *window)
{
    const struct viewer *viewer = window->viewer;
    struct field fields[FIELD_LIMIT];
    struct state state;
    take_state(&state, window);
    size_t count = list_fields(fields, &state) - (state.by_head > 0 ? 0 : HEAD_FIELDS);
    json_t *root = json_pack("{s: i, s: s, s: i, s: s}", "conus_session", SESSION_VERSION, "atlas",
                             viewer->atlases->path, "objects", (int)viewer->atlases->object_count, "score",
                             viewer->cone.options.score ? viewer->cone.options.score : "share");
    for (size_t i = 0; root && i < count; i++) {
        json_object_set_new(root, fields[i].key, numbers(&fields[i]));
    }
    list_optional(fields, &state);
    for (size_t i = state.slice_fraction > 0 ? 0 : 1; root && i < OPTIONAL_FIELDS; i++) {
        json_object_set_new(root, fields[i].key, numbers(&fields[i]));
    }
    if (window->files.opened) {
        json_object_set(root, "opened", window->files.opened);
    }
    json_object_set_new(root, "level", json_string(viewer->cone.level));
    json_object_set_new(root, "place", session_place(viewer->atlases));
    json_object_set_new(root, "hidden", session_hidden(viewer->atlases));
    json_object_set_new(root, "confirmed", pins_of(viewer));
    json_object_set_new(root, "thresholds", session_thresholds(viewer->atlases));
    json_object_set_new(root, "transfer", transfer_of(&viewer->transfer_editor));
    session_second_add(root, window);
    json_object_set_new(root, "preset", viewer->preset ? json_string(viewer->preset) : json_null());
    json_object_set_new(root, "look", session_look(viewer->atlases));
    json_object_set_new(root, "background", json_string(backdrop_names[viewer->display.backdrop]));
    json_object_set_new(root, "figure", session_sheet(&window->sheet));
    json_object_set_new(root, "layout", session_layout(&window->screen.layout));
    json_object_set_new(root, "safe_colours", json_boolean(viewer->display.safe_colours));
    json_object_set_new(root, "results", session_list(&viewer->list));
    if (root && viewer->atlas_count > 1) {
        json_object_set_new(root, "drawn", json_integer(viewer->drawn - viewer->atlases + 1));
        if (json_object_set_new(root, "further_atlases", session_further(viewer))) {
            json_decref(root);
            root = NULL;
        }
    }
    char *text = root ? json_dumps(root, JSON_INDENT(1)) : NULL;
    json_decref(root);
    return text;
}

/* Where Ctrl+S saves. */
static void note_path(struct window *window, const char *path)
{
    char *copy = strdup(path);
    if (copy) {
        free(window->history.session_path);
        window->history.session_path = copy;
    }
}

bool session_save(struct window *window, const char *path, char why[SESSION_REASON])
{
    char *text = session_text(window);
    conus_status status = text ? conus_write_file(path, text, strlen(text)) : CONUS_ERROR_MEMORY;
    free(text);
    if (!status) {
        note_path(window, path);
    }
    return !status ||
           session_refuse(why, "%s",
                          text ? conus_message() : "session: not enough memory, or a name that is not UTF-8");
}

static bool read_number(double *out, const json_t *value, const struct field *field)
{
    *out = json_number_value(value);
    return json_is_number(value) && *out >= field->low && *out <= field->high;
}

static bool read_field(const json_t *root, const struct field *field, char why[SESSION_REASON])
{
    const json_t *value = json_object_get(root, field->key);
    bool fine = field->count == 1 || (json_is_array(value) && json_array_size(value) == field->count);
    for (size_t i = 0; fine && i < field->count; i++) {
        fine = read_number(&field->value[i], field->count == 1 ? value : json_array_get(value, i), field);
    }
    return fine || session_refuse(why, "session: %s: %zu numbers from %g to %g are needed", field->key, field->count,
                                  field->low, field->high);
}

static const char *known_score(const char *name)
{
    const conus_score_info *info;
    for (size_t i = 0; name && (info = conus_score(i)); i++) {
        if (strcmp(info->name, name) == 0) {
            return info->name;
        }
    }
    return NULL;
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
        double contact[3];
        for (size_t a = 0; a < 3; a++) {
            contact[a] = number_or_nan(json_array_get(json_object_get(entry, "contact"), a));
        }
        const char *name = object ? NULL : json_string_value(json_object_get(entry, "name"));
        if (of < viewer->atlas_count &&
            (name || (object > 0 && conus_atlas_object(viewer->atlases[of].atlas, (size_t)object)))) {
            viewer_pin(viewer, of, (uint32_t)object, name, number_or_nan(json_object_get(entry, "share")),
                       number_or_nan(json_object_get(entry, "distance_mm")), contact);
        }
    }
}

static bool read_point(conus_transfer_point *out, const json_t *entry, double least)
{
    bool fine = json_is_array(entry) && json_array_size(entry) == 5;
    const struct field value = {.low = least, .high = FLT_MAX};
    const struct field part = {.low = 0, .high = 1};
    fine = fine && read_number(&out->value, json_array_get(entry, 0), &value);
    for (size_t i = 0; fine && i < 4; i++) {
        fine = read_number(&out->rgba[i], json_array_get(entry, i + 1), &part);
    }
    return fine;
}

static bool read_transfer(struct atlas_edits *out, const struct view_atlas *on, const json_t *list,
                          char why[SESSION_REASON])
{
    size_t count = json_array_size(list);
    out->sets_transfer = true;
    if (json_is_null(list)) {
        return true;
    }
    if (view_atlas_context(on) == conus_atlas_volume_count(on->atlas)) {
        return session_refuse(why, "session: transfer: there is no context here, open it with --context");
    }
    bool fine = json_is_array(list) && count >= 1 && count <= EDITOR_POINTS;
    for (size_t i = 0; fine && i < count; i++) {
        fine = read_point(&out->points[i], json_array_get(list, i), i ? out->points[i - 1].value : -FLT_MAX);
    }
    out->point_count = count;
    return fine ||
           session_refuse(why,
                          "session: transfer: 1 to %d points are needed, each a grey value not less than the one "
                          "before, red, green, blue and opacity from 0 to 1",
                          EDITOR_POINTS);
}

/* What the session does not say stays as it is. */
static bool read_atlas_edits(struct atlas_edits *out, struct session_atlases *atlases, const struct viewer *viewer,
                             const json_t *root, char why[SESSION_REASON])
{
    const json_t *transfer = json_object_get(root, "transfer");
    const json_t *safe = json_object_get(root, "safe_colours");
    if (!session_atlases_read(atlases, viewer, root, why)) {
        return false;
    }
    *out = (struct atlas_edits){.thresholds = atlases->thresholds,
                                .safe_colours = safe ? json_is_true(safe) : viewer->display.safe_colours};
    if (safe && !json_is_boolean(safe)) {
        return session_refuse(why, "session: safe_colours: true or false is needed");
    }
    const struct view_atlas *drawn = &viewer->atlases[atlases->drawn];
    return !transfer || (read_transfer(out, drawn, transfer, why) &&
                         session_preset_read(&out->preset, drawn, json_object_get(root, "preset"), why));
}

static bool read_state(struct state *out, const json_t *root, char why[SESSION_REASON])
{
    struct field fields[FIELD_LIMIT];
    size_t count = list_fields(fields, out) - (json_object_get(root, "by_head") ? 0 : HEAD_FIELDS);
    if (json_integer_value(json_object_get(root, "conus_session")) != SESSION_VERSION) {
        return session_refuse(why, "no session of this version of conus view");
    }
    for (size_t i = 0; i < count; i++) {
        if (!read_field(root, &fields[i], why)) {
            return false;
        }
    }
    bool fine = true;
    list_optional(fields, out);
    for (size_t i = 0; i < OPTIONAL_FIELDS && fine; i++) {
        fine = !json_object_get(root, fields[i].key) || read_field(root, &fields[i], why);
    }
    const struct study_settings study = study_of(out);
    const char *fault = fine ? study_fault(&study) : NULL;
    return fine && (!fault || session_refuse(why, "session: %s", fault));
}

/* What --level would say, of the first atlas. Sessions of before there were levels do not say. */
static bool read_level(const char **out, const struct viewer *viewer, const json_t *root, char why[SESSION_REASON])
{
    const json_t *level = json_object_get(root, "level");
    *out = level ? json_string_value(level) : viewer->cone.level;
    if (!*out || strlen(*out) >= LEVEL_LIMIT) {
        return session_refuse(why, "session: level: a text of up to %d bytes is needed", LEVEL_LIMIT - 1);
    }
    conus_selector *selector = NULL;
    const conus_selector_options options = {.level = *out};
    conus_status status = !(*out)[0] || strcmp(*out, viewer->cone.level) == 0
                              ? CONUS_OK
                              : conus_selector_create(&selector, viewer->atlases->atlas, &options);
    conus_selector_destroy(selector);
    return !status || session_refuse(why, "session: %s", conus_message());
}

/* The atlases first, since that may fail. */
static bool set_up(struct viewer *viewer, size_t drawn, const struct atlas_edits *settings, char why[SESSION_REASON])
{
    size_t before = (size_t)(viewer->drawn - viewer->atlases);
    viewer_draw(viewer, drawn);
    if (viewer_set_up(viewer, settings)) {
        viewer_draw(viewer, before);
        return session_refuse(why, "session: not enough memory");
    }
    return true;
}

static bool read_session(struct window *window, const json_t *root, char why[SESSION_REASON])
{
    struct viewer *viewer = window->viewer;
    struct state state = {.apex_at_eye = viewer->cone.apex_at_eye,
                          .one_ray = viewer->cone.one_ray,
                          .follow = (double)viewer->cone.follow,
                          .order = (double)viewer->cone.order,
                          .slices = viewer->cone.options.slices};
    take_study(&state, &viewer->study.settings);
    struct atlas_edits settings;
    struct session_atlases atlases = {0};
    struct session_tools tools;
    struct result_list list = viewer->list;
    enum backdrop backdrop = viewer->display.backdrop;
    struct sheet sheet = window->sheet;
    struct layout layout = window->screen.layout;
    const char *score = known_score(json_string_value(json_object_get(root, "score")));
    const char *level = NULL;
    bool fine = read_state(&state, root, why) && session_list_read(&list, root, why) &&
                (score || session_refuse(why, "session: score: unknown")) &&
                session_second_read(&tools, window, root, why) && read_level(&level, viewer, root, why) &&
                read_atlas_edits(&settings, &atlases, viewer, root, why) &&
                session_backdrop_read(&backdrop, json_object_get(root, "background"), why) &&
                session_sheet_read(&sheet, json_object_get(root, "figure"), why) &&
                session_layout_read(&layout, json_object_get(root, "layout"), why) &&
                set_up(viewer, atlases.drawn, &settings, why);
    if (fine) {
        put_state(window, &state);
        viewer->cone.options.score = score;
        viewer->list = list;
        viewer->display.backdrop = backdrop;
        window->sheet = sheet;
        window->screen.layout = layout;
        memmove(viewer->cone.level, level, strlen(level) + 1); /* of itself, where the session says nothing */
        session_atlases_show(&atlases, viewer);
        read_pins(viewer, root);
        viewer_reselect(viewer);
        session_second_put(window, &tools);
    }
    session_atlases_finish(&atlases);
    return fine;
}

static bool use_session(struct window *window, json_t *root, const char *path, const json_error_t *error,
                        char why[SESSION_REASON])
{
    session_fit(root, window);
    bool fine =
        root ? read_session(window, root, why) : session_refuse(why, "%s: line %d: %s", path, error->line, error->text);
    json_decref(root);
    return fine;
}

bool session_parse(struct window *window, const char *text, size_t size, char why[SESSION_REASON])
{
    json_error_t error;
    json_t *root = json_loadb(text, size, JSON_REJECT_DUPLICATES, &error);
    return use_session(window, root, "session", &error, why);
}

/* A file that is read up to a limit. */
struct capped {
    FILE *file;
    size_t left;
    bool is_larger;
};

/* For jansson: the bytes read, 0 at the end, (size_t)-1 ends it with an error. */
static size_t read_capped(void *buffer, size_t size, void *user)
{
    struct capped *from = user;
    size_t got = fread(buffer, 1, size, from->file);
    from->is_larger = got > from->left;
    from->left -= from->is_larger ? 0 : got;
    return from->is_larger || ferror(from->file) ? (size_t)-1 : got;
}

bool session_load(struct window *window, const char *path, char why[SESSION_REASON])
{
    struct capped from = {.file = fopen(path, "re"), .left = SESSION_LIMIT};
    json_error_t error;
    if (!from.file) {
        return session_refuse(why, "%s: cannot open: %s", path, strerror(errno));
    }
    json_t *root = json_load_callback(read_capped, &from, JSON_REJECT_DUPLICATES, &error);
    fclose(from.file);
    if (from.is_larger) {
        json_decref(root);
        return session_refuse(why, "%s: more than the %d bytes that are read", path, SESSION_LIMIT);
    }
    bool fine = use_session(window, root, path, &error, why);
    if (fine) {
        note_path(window, path);
    }
    return fine;
}
