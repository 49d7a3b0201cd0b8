/* SPDX-License-Identifier: BSD-3-Clause */
/* The viewer: creation, the cone, confirmed results, crosshair. */
#include "viewer/model/viewer.h"
#include "base/geometry/math3.h"
#include "base/look.h"
#include "base/system/system.h"
#include "conus/own.h"
#include "figures/figure.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double default_angle = 5; /* degrees, of the window; from the scalp that is about one area */
static const double ray_angle = 0.1;   /* degrees: drawn as a line; one pixel's ray is the axis, whatever it is */

void viewer_say(struct viewer *viewer, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(viewer->message, sizeof viewer->message, format, arguments);
    va_end(arguments);
    viewer->said++;
}

void viewer_find_ball(struct viewer *viewer)
{
    struct box3 box = box3_empty();
    double longest = 0;
    for (size_t i = 0; i < viewer->atlas_count; i++) {
        const struct view_atlas *view = &viewer->atlases[i];
        if (view->box[0][0] <= view->box[1][0]) {
            box3_join(&box, view->box[0], view->box[1]);
        }
    }
    for (int a = 0; a < 3 && box.low[0] <= box.high[0]; a++) {
        viewer->centre[a] = (box.low[a] + box.high[a]) / 2;
        viewer->half[a] = (box.high[a] - box.low[a]) / 2;
        longest = fmax(longest, box.high[a] - box.low[a]);
    }
    /* Brains are round: corners of their boxes are empty. But both ends of a long one are to be seen. */
    viewer->radius = fmax(fmax(longest > 0 ? 0.72 * vec3_length(viewer->half) : 0, 0.54 * longest), 1);
}

static void finish_atlases(struct viewer *viewer, bool with_them)
{
    for (size_t i = 0; i < viewer->atlas_count; i++) {
        view_atlas_finish(&viewer->atlases[i]);
        conus_atlas_destroy(with_them ? viewer->atlases[i].atlas : NULL);
    }
    free(viewer->atlases);
    free((void *)viewer->names);
}

conus_status viewer_create(struct viewer *out, const struct view_source *sources, size_t count, const char *transfer,
                           conus_log log, void (*wake)(void))
{
    struct viewer viewer = {.transfer = transfer ? strdup(transfer) : NULL,
                            .tools = {{.on = true, .angle = default_angle}, {.angle = default_angle}},
                            .wake = wake};
    viewer.display.fill = 0.45;
    viewer.study.settings = study_defaults;
    viewer.cone.options.log = log;
    viewer.cone.options.resolution = CONUS_RESOLUTION_DEFAULT;
    viewer.cone.start = START_BEFORE;
    viewer.magnification = 1;
    viewer.atlases = viewer.drawn = calloc(count, sizeof *viewer.atlases);
    viewer.names = calloc(count, sizeof *viewer.names);
    bool fine = (viewer.transfer || !transfer) && viewer.atlases && viewer.names;
    for (size_t i = 0; i < count && fine; i++) {
        fine = view_atlas_init(&viewer.atlases[i], &sources[i]);
        viewer.names[i] = fine ? viewer.atlases[i].name : NULL;
        viewer.atlas_count += fine;
    }
    if (!fine ||
        !painter_create(&viewer.painter, viewer.drawn->atlas, transfer, &viewer.drawn->appearance, log, wake)) {
        finish_atlases(&viewer, false);
        free(viewer.transfer);
        return CONUS_ERROR_MEMORY;
    }
    viewer_find_ball(&viewer);
    memcpy(viewer.crosshair, viewer.centre, sizeof viewer.crosshair);
    orbit_look_at(&viewer.orbit, viewer.centre, viewer.radius);
    *out = viewer;
    return CONUS_OK;
}

void points_finish(struct point_list *list)
{
    if (list->has_electrodes) {
        contacts_ungroup(list->points, list->count);
    }
    free(list->points);
    free(list->rows);
    conus_pose_list_destroy(list->poses);
    *list = (struct point_list){.number = list->number + 1};
}

void viewer_finish(struct viewer *viewer)
{
    painter_destroy(viewer->painter);
    studier_destroy(viewer->study.studier);
    study_answer_destroy(viewer->study.answer);
    plan_state_finish(&viewer->plan);
    points_finish(&viewer->points);
    finish_atlases(viewer, true);
    free(viewer->transfer);
    *viewer = (struct viewer){0};
}

const conus_selection *viewer_selection(const struct viewer *viewer)
{
    return view_atlas_selection(viewer->drawn, FIRST_TOOL);
}

double viewer_query(conus_selector_options *options, const struct viewer *viewer, enum tool_number tool, size_t index)
{
    const struct cone_state *cone = &viewer->cone;
    *options = cone->options;
    options->level = cone->level[0] && !index ? cone->level : NULL;
    if (viewer->tools[tool].is_point) { /* which has no depths */
        options->range[0] = options->range[1] = 0;
    }
    if (cone->one_ray) {
        options->resolution = 1;
        options->radius = 0;
        options->layers = CONUS_LAYERS_VISIBLE;
    }
    double angle = cone->one_ray ? ray_angle : viewer->tools[tool].angle;
    return options->radius > 0 ? 0 : angle;
}

const char *viewer_shape(const struct viewer *viewer)
{
    return viewer->tools[FIRST_TOOL].is_point ? (viewer->cone.options.radius > 0 ? "ball" : "point")
           : viewer->cone.one_ray             ? "axis"
           : viewer->cone.options.radius > 0  ? "cylinder"
                                              : "cone";
}

bool viewer_to_world(double world[3], struct viewer *viewer, const double given[3])
{
    bool fine = conus_frame_to_world(world, &viewer->frame, given) == CONUS_OK;
    if (!fine) {
        viewer_say(viewer, "%s", conus_message());
    }
    return fine;
}

const char *viewer_place_format(const struct viewer *viewer)
{
    static const char *const formats[] = {"%.1f", "%.1f", "%.0f", "%.3f"}; /* by space: people, people, um, a mouse */
    return formats[viewer->frame.space];
}

size_t viewer_put_coordinate(char *out, size_t size, const struct viewer *viewer, double value)
{
    static const double least[] = {0.05, 0.05, 0.5, 0.0005}; /* what is printed as 0 */
    bool is_zero = fabs(value) < least[viewer->frame.space];
    return (size_t)snprintf(out, size, viewer_place_format(viewer), is_zero ? 0 : value);
}

const char *viewer_place_text(char out[VIEWER_PLACE_TEXT], const struct viewer *viewer, const double world[3])
{
    double at[3];
    char number[16];
    size_t used = 0;
    conus_space space = viewer->frame.space;
    bool named = space >= CONUS_SPACE_CCF;
    conus_frame_from_world(at, &viewer->frame, world);
    for (size_t a = 0; a < 3; a++) {
        viewer_put_coordinate(number, sizeof number, viewer, at[a]);
        used += (size_t)snprintf(out + used, VIEWER_PLACE_TEXT - used, "%s%s%s%s", a ? ", " : "",
                                 named ? conus_space_axis(space, a) : "", named ? " " : "", number);
    }
    const char *name = space == CONUS_SPACE_RAS ? " RAS" : space == CONUS_SPACE_LPS ? " LPS" : "";
    snprintf(out + used, VIEWER_PLACE_TEXT - used, " %s%s", conus_space_unit(space), name);
    return out;
}

void viewer_pin(struct viewer *viewer, struct pin pin)
{
    if (viewer->pin_count == PIN_LIMIT) {
        memmove(viewer->pins, viewer->pins + 1, (PIN_LIMIT - 1) * sizeof *viewer->pins);
        viewer->pin_count--;
    }
    const struct pin *last = viewer->pin_count ? &viewer->pins[viewer->pin_count - 1] : NULL;
    if (pin.object) {
        snprintf(pin.name, sizeof pin.name, "%s",
                 conus_atlas_object(viewer->atlases[pin.atlas].atlas, pin.object)->name);
        pin.entry[0] = pin.entry[1] = pin.entry[2] = NAN;
    }
    double offset[3];
    vec3_sub(offset, pin.contact, last ? last->contact : pin.contact);
    pin.apart = last ? vec3_length(offset) : NAN;
    viewer->pins[viewer->pin_count++] = pin;
}

const char *viewer_pin_title(char out[VIEW_ATLAS_TITLE], const struct viewer *viewer, const struct pin *pin)
{
    return view_atlas_title_of(out, &viewer->atlases[pin->atlas], pin->object, pin->name);
}

char *viewer_pins_text(const struct viewer *viewer)
{
    struct system_text text;
    FILE *out = system_text_open(&text);
    if (!out) {
        return NULL;
    }
    bool several = viewer->atlas_count > 1;
    fprintf(out, "%sname\tshare\tdistance_mm\tcontact_x\tcontact_y\tcontact_z\tapart_mm\tentry_x\tentry_y\tentry_z\n",
            several ? "atlas\t" : "");
    for (size_t i = 0; i < viewer->pin_count; i++) {
        enum { NUMBERS = 9 };
        const struct pin *pin = &viewer->pins[i];
        double numbers[NUMBERS] = {pin->share, pin->distance, [5] = pin->apart};
        char title[VIEW_ATLAS_TITLE];
        conus_frame_from_world(numbers + 2, &viewer->frame, pin->contact);
        conus_frame_from_world(numbers + 6, &viewer->frame, pin->entry);
        fprintf(out, "%s%s%s", several ? viewer->names[pin->atlas] : "", several ? "\t" : "",
                viewer_pin_title(title, viewer, pin));
        for (size_t n = 0; n < NUMBERS; n++) {
            fprintf(out, isnan(numbers[n]) ? "\tn/a" : "\t%.9g", numbers[n]);
        }
        fputc('\n', out);
    }
    return system_text_close(&text);
}

conus_status viewer_report(conus_report **reports, struct viewer *viewer, enum tool_number tool, const char *format)
{
    conus_status status = CONUS_OK;
    bool was_asked = false;
    for (size_t i = 0; i < viewer->atlas_count; i++) {
        was_asked = was_asked || view_atlas_selection(&viewer->atlases[i], tool);
    }
    for (size_t i = 0; i < viewer->atlas_count && !status; i++) {
        struct view_atlas *view = &viewer->atlases[i];
        const conus_report_options options = {.format = format,
                                              .atlas = view->name[0] ? view->name : NULL,
                                              .frame = &viewer->frame,
                                              .order = viewer->cone.order,
                                              .no_voxels = true};
        const conus_selection *selection = view_atlas_selection(view, tool);
        conus_selector_options asked;
        viewer_query(&asked, viewer, tool, i);
        status = view_atlas_prepare(view, &asked);
        status = status ? status : conus_report_create(&reports[i], view->selector, &options);
        if (!status && selection) {
            status = conus_report_add(reports[i], "1", selection);
        } else if (!status && was_asked) {
            status = conus_report_add_error(reports[i], "1", 0, "there is no answer");
        }
        status = status || !i ? status : conus_report_join(reports[0], reports[i]);
    }
    return status;
}

/* The answers of a tool in all atlases, as a table; to be freed. */
static conus_status tabulate(char **out, struct viewer *viewer, enum tool_number tool)
{
    conus_report **reports = calloc(viewer->atlas_count, sizeof(conus_report *));
    conus_status status = reports ? CONUS_OK : CONUS_ERROR_MEMORY;
    const char *text;
    size_t size;
    status = status ? status : viewer_report(reports, viewer, tool, "tsv");
    status = status ? status : conus_report_text(&text, &size, reports[0]);
    *out = status ? NULL : strdup(text);
    for (size_t i = 0; reports && i < viewer->atlas_count; i++) {
        conus_report_destroy(reports[i]);
    }
    free((void *)reports);
    return status || *out ? status : CONUS_ERROR_MEMORY;
}

char *viewer_results_text(struct viewer *viewer)
{
    char *text;
    return tabulate(&text, viewer, FIRST_TOOL) ? NULL : text;
}

conus_status viewer_write_results(struct viewer *viewer, enum tool_number tool, const char *path)
{
    char *text = NULL;
    conus_status status = tabulate(&text, viewer, tool);
    status = status ? status : conus_write_file(path, text, strlen(text));
    free(text);
    return status;
}

void viewer_measure(struct viewer *viewer, const double at[3])
{
    struct measure *measure = &viewer->measure;
    measure->count = measure->count < 2 ? measure->count : 0;
    memcpy(measure->points + (size_t)3 * measure->count++, at, 3 * sizeof *at);
    viewer->version++;
    if (measure->count == 2) {
        viewer_say(viewer, "distance: %.2f mm", viewer_distance(viewer));
    } else {
        viewer_say(viewer, "click the second place");
    }
}

double viewer_distance(const struct viewer *viewer)
{
    double offset[3];
    vec3_sub(offset, viewer->measure.points + 3, viewer->measure.points);
    return viewer->measure.count == 2 ? vec3_length(offset) : NAN;
}

void viewer_cross(struct viewer *viewer, const double at[3])
{
    static const double farthest = 1.5; /* radii from the middle, along each axis */
    for (int a = 0; a < 3; a++) {
        double most = farthest * viewer->radius;
        viewer->crosshair[a] = viewer->centre[a] + fmin(fmax(at[a] - viewer->centre[a], -most), most);
    }
    viewer->version++;
}

bool viewer_voxel(long voxel[3], const struct viewer *viewer, const double at[3])
{
    double voxel_from_world[16];
    double exact[3];
    const conus_volume_info *info = conus_atlas_volume(viewer->drawn->atlas, 0); /* the parcellation is the first */
    bool inside = info && mat4_invert_affine(voxel_from_world, info->world_from_voxel);
    if (inside) {
        mat4_point(exact, voxel_from_world, at);
    }
    for (int a = 0; a < 3 && inside; a++) {
        double cell = floor(exact[a] + 0.5);
        inside = cell >= 0 && cell < (double)info->dim[a];
        voxel[a] = inside ? (long)cell : 0;
    }
    return inside;
}

void viewer_choose(struct viewer *viewer, uint32_t object)
{
    double middle[3];
    viewer->drawn->shown.chosen = object;
    viewer->version++;
    if (object && !conus_atlas_centre(middle, viewer->drawn->atlas, object)) {
        viewer_cross(viewer, middle);
    }
}

/* Whether areas have colours before there is a cone: those that somebody chose, or that tell glass apart. */
static bool shows_colours(const struct viewer *viewer)
{
    return viewer->display.own_colours || viewer->display.safe_colours ||
           (view_atlas_shows_tracts(viewer->drawn) && viewer->drawn->appearance.opacity[0] < 1);
}

/* Whether only what is hit has a colour: before there is a cone nothing has one, unless it was chosen, or pathways and
 * bundles are to be told apart; with a plan these neither, beside what its needle is to reach. */
static bool is_neutral(const struct viewer *viewer)
{
    return viewer_selection(viewer) || viewer->plan.task.constraints.count ||
           !(shows_colours(viewer) || view_atlas_shows_tracts(viewer->drawn));
}

uint32_t viewer_full(const struct viewer *viewer)
{
    return is_neutral(viewer) ? 0 : viewer->drawn->shown.chosen;
}

bool viewer_leaves_context(const struct viewer *viewer)
{
    const struct view_atlas *view = viewer->drawn;
    bool leaves = !view_atlas_shows_tracts(view);
    for (size_t number = 0; number <= view->object_count && leaves; number++) {
        leaves = !(view->appearance.opacity[number] < 1); /* NaN: as the first says */
    }
    return leaves;
}

double viewer_fade(const struct viewer *viewer)
{
    const bool is_gone = viewer->painter && viewer_leaves_context(viewer) && painter_finds_cover(viewer->painter);
    return is_gone ? 1 : viewer->display.fade;
}

struct answer *viewer_pictured(const struct viewer *viewer)
{
    struct view_atlas *view = viewer->drawn;
    conus_selector_options options;
    conus_pose away;
    const double beside[3] = {viewer->centre[0] + 2 * viewer->radius, viewer->centre[1], viewer->centre[2]};
    if (view->answers[FIRST_TOOL] || !is_neutral(viewer) ||
        conus_pose_along(&away, beside, (double[]){1, 0, 0}, NULL)) {
        return view->answers[FIRST_TOOL];
    }
    viewer_query(&options, viewer, FIRST_TOOL, (size_t)(view - viewer->atlases));
    return view_atlas_nothing(view, &options, &away);
}

bool viewer_colours_by_rank(const struct viewer *viewer, uint32_t object)
{
    const conus_object *info = conus_atlas_object(viewer->drawn->atlas, object);
    const bool is_beside = !shows_colours(viewer) && info && info->kind == CONUS_KIND_AREA; /* fibres */
    return (is_neutral(viewer) || is_beside) && !viewer->display.own_colours &&
           viewer->drawn->appearance.haze[object] == HAZE_NONE;
}

size_t viewer_rank(const struct viewer *viewer, uint32_t object)
{
    return object && viewer_colours_by_rank(viewer, object) ? conus_selection_rank(viewer_selection(viewer), object)
                                                            : 0;
}

unsigned viewer_cut_version(const struct viewer *viewer)
{
    return viewer->version - viewer->moves;
}

const char *viewer_find_score(const char *name)
{
    const conus_score_info *info;
    for (size_t i = 0; name && (info = conus_score(i)); i++) {
        if (!info->needs_weight && strcmp(info->name, name) == 0) {
            return info->name;
        }
    }
    return NULL;
}

/* mm per pixel at which the box of what shows fills a picture to 92 %, in width or height. */
static double fit_cut(const double half[3], const conus_cut_view *view, const double size[2])
{
    double wide = 0;
    double high = 0;
    for (int a = 0; a < 3; a++) {
        wide += 2 * half[a] * fabs(view->right[a]);
        high += 2 * half[a] * fabs(view->up[a]);
    }
    return fmax(fmax(wide, 2) / fmax(size[0], 1), fmax(high, 2) / fmax(size[1], 1)) / 0.92; /* of an empty one, too */
}

/* The camera looks at the atlas's middle, at the depth of the crosshair. */
void cut_view(conus_cut_view *out, const struct viewer *viewer, enum plane plane, const double size[2])
{
    static const double axes[PLANE_COUNT][2][3] = {
        {{1, 0, 0}, {0, 1, 0}}, {{1, 0, 0}, {0, 0, 1}}, {{0, 1, 0}, {0, 0, 1}}}; /* to the right and up */
    const double *grey = view_atlas_grey(viewer->drawn);
    *out =
        (conus_cut_view){.width = (uint32_t)fmax(size[0], 1),
                         .height = (uint32_t)fmax(size[1], 1),
                         .fill = viewer->display.fill,
                         .no_outlines = viewer->display.no_outlines,
                         .window = {grey[0], grey[1]},
                         .selection = answer_selection(viewer_pictured(viewer)),
                         .no_cone = !viewer_selection(viewer) || viewer->tools[FIRST_TOOL].is_point,
                         .chosen = viewer_full(viewer),
                         .own_colours = viewer->display.own_colours || (!is_neutral(viewer) && shows_colours(viewer))};
    memcpy(out->centre, viewer->centre, sizeof out->centre);
    out->centre[2 - (int)plane] = viewer->crosshair[2 - (int)plane];
    memcpy(out->right, axes[plane][0], sizeof out->right);
    memcpy(out->up, axes[plane][1], sizeof out->up);
    if (viewer->display.radiological && plane != SAGITTAL) {
        out->right[0] = -out->right[0];
    }
    out->mm_per_pixel = fit_cut(viewer->half, out, size) / viewer->magnification;
}
