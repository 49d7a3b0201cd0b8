/* SPDX-License-Identifier: BSD-3-Clause */
/* The table of the window's state, and how a row is read from the window, from JSON and from words. */
#include "viewer/session/property.h"

#include "viewer/model/columns.h"

#include <jansson.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char *const second_pointer_names[] = {"mouse", "wand", NULL, "tracker", "spacemouse", "gamepad"};
static const char *const layer_names[] = {"visible", "all"};
static const char *const layers[] = {"first hits", "all depths"};
static const char *const aperture_names[] = {"circle", "square"};
static const char *const sampling_names[] = {"exact", "slices"};
static const char *const engine_names[] = {"auto", "rays", "gl"};
static const char *const pane_names[] = {"none", "axial", "coronal", "sagittal", "3d"};
static const char *const follow_names[] = {"nothing", "tip", "contact"};
static const char *const order_names[] = {"rank", "depth"};
static const char *const study_names[] = {"none", "sweep", "jitter"};
static const char *const fold_names[] = {"as-at-first", "folded", "open"};
static const char *const legend_names[] = {"auto", "right", "below", "none"};

static const char *const start_names[] = {"surface", "before", "eye"};
static const char *const start_says[] = {
    "the mouse's cone begins at the surface: of the context, or of the atlas",
    "the mouse's cone begins before the surface, where its ball is; with an end of "
    "its depths at the surface",
    "the mouse's cone begins at your eye"};
static const char *const ray_says[] = {"all areas in the cone",
                                       "one area: the one that a ray along the axis hits first"};
static const char *const follow_says[] = {"the cuts stay where they are", "the cuts follow the cone's tip",
                                          "the cuts follow the contact of the best hit"};
static const char *const order_says[] = {"the best first", "the nearest first"};
static const char *const starts[] = {"surface", "in front", "eye"};
static const char *const followed[] = {"nothing", "the cone's tip", "the best contact"};
static const char *const bare_says[] = {"panels and cuts are back", "the brain alone; F brings all back"};
static const char *const measure_says[] = {"clicks set the crosshair again",
                                           "click two places: their distance is shown"};
static const char *const studies[] = {"none", "sweep of the angle", "jitter of the pose"};
static const char *const study_says[] = {"no study", "sweep: the shares over the angle",
                                         "jitter: the chances under errors of the pose"};

/* Where a value lies, and what it may be. */
#define OF_VIEWER(member) .offset = offsetof(struct viewer, member), .size = sizeof(((struct viewer *)0)->member)
#define OF_WINDOW(member)                                                                                              \
    .of_window = true, .offset = offsetof(struct window, member), .size = sizeof(((struct window *)0)->member)
#define REALS(how_many, least, most) .type = PROPERTY_REAL, .count = (how_many), .low = (least), .high = (most)
#define TRUTH .type = PROPERTY_TRUTH, .high = 1
#define ENUM(array) .type = PROPERTY_NAME, .names = (array), .high = (int)(sizeof(array) / sizeof(array)[0]) - 1
#define FAR 1e6 /* mm */
#define ANGLE .label = "Opening", .format = "%.1f\u00b0", .slider = {0.1, 179}, .is_logarithmic = true

_Static_assert(offsetof(struct orbit, elevation) == offsetof(struct orbit, centre) + 5 * sizeof(double),
               "centre, distance, azimuth and elevation are six numbers");
_Static_assert(offsetof(struct study_settings, samples) ==
                   offsetof(struct study_settings, tilt_deg) + 2 * sizeof(double),
               "tilt, shift and samples are three numbers");

const struct property properties[PROPERTY_COUNT] = {
    [PROPERTY_POSE] = {NULL, "world_from_device", "the pose of the first tool: a 4 x 4 matrix, column by column, mm",
                       OF_VIEWER(tools[FIRST_TOOL].pose), REALS(16, -FAR, FAR), .undo = UNDO_LEAVES_MOVING},
    [PROPERTY_HAS_POSE] = {NULL, "has_pose", "whether it has one", OF_VIEWER(tools[FIRST_TOOL].has_pose), TRUTH,
                           .undo = UNDO_LEAVES_MOVING},
    [PROPERTY_IS_POINT] = {NULL, "is_point", "whether only its place counts, as that of a contact",
                           OF_VIEWER(tools[FIRST_TOOL].is_point), TRUTH, .presence = PROPERTY_ZERO,
                           .undo = UNDO_LEAVES_MOVING},
    [PROPERTY_CHOSEN_POINT] = {NULL, "chosen_point",
                               "the row of the list of points that it asks about, from 1; 0 = none",
                               OF_VIEWER(chosen_point), .type = PROPERTY_INTEGER, .high = POINT_LIMIT,
                               .presence = PROPERTY_ZERO, .undo = UNDO_LEAVES_MOVING},
    [PROPERTY_FROZEN] = {NULL, "frozen", "whether the cone is held", OF_VIEWER(tools[FIRST_TOOL].held), TRUTH},
    [PROPERTY_POINTER] = {NULL, "pointer", "what moves the first tool", OF_VIEWER(tools[FIRST_TOOL].pointer),
                          ENUM(pointer_names)},
    [PROPERTY_ANGLE] = {NULL, "angle_deg", "full opening angle of the cone, degrees",
                        OF_VIEWER(tools[FIRST_TOOL].angle), REALS(1, 0.01, 179.99), .undo = UNDO_LEAVES_REPLAY,
                        .change = CHANGES_ANSWER, ANGLE},
    [PROPERTY_RADIUS] = {NULL, "radius_mm", "radius of the cylinder, mm; 0 = a cone", OF_VIEWER(cone.options.radius),
                         REALS(1, 0, FAR), .undo = UNDO_LEAVES_REPLAY, .change = CHANGES_ANSWER, .label = "Radius",
                         .format = "%.4g mm", .slider = {0.1, 50}, .is_logarithmic = true,
                         .tip = "radius of the cylinder, mm; Expert makes it a cone again"},
    [PROPERTY_RANGE] = {NULL, "range_mm", "the depths that count, mm from the apex; 0, 0 = all",
                        OF_VIEWER(cone.options.range), REALS(2, 0, FAR)},
    [PROPERTY_RESOLUTION] = {NULL, "resolution", "N, of N x N rays", OF_VIEWER(cone.options.resolution),
                             .type = PROPERTY_WHOLE, .low = 1, .high = 1024, .change = CHANGES_ANSWER,
                             .label = "Pixels", .slider = {1, 64},
                             .tip = "N, of N x N rays, one per pixel of the image that the device sees"},
    [PROPERTY_LAYERS] = {NULL, "layers", "first hits only, or all hits in the cone, occluded ones too",
                         OF_VIEWER(cone.options.layers), ENUM(layer_names), .change = CHANGES_ANSWER, .label = "Show",
                         .choices = layers},
    [PROPERTY_APERTURE] = {NULL, "aperture", "which pixels count: those in the circle, or all of the square",
                           OF_VIEWER(cone.options.aperture), ENUM(aperture_names), .change = CHANGES_ANSWER,
                           .label = "Aperture"},
    [PROPERTY_SAMPLING] = {NULL, "sampling", "every voxel along a ray, or planes across the view only",
                           OF_VIEWER(cone.options.sampling), ENUM(sampling_names), .change = CHANGES_ANSWER,
                           .label = "Sampling",
                           .tip =
                               "every voxel along a ray, or planes across the view only, which can miss thin objects"},
    [PROPERTY_ENGINE] = {NULL, "engine", "what traces the rays", OF_VIEWER(cone.options.engine), ENUM(engine_names),
                         .change = CHANGES_ANSWER, .label = "Engine",
                         .tip = "what traces the rays, the processor or OpenGL: the hits are the same"},
    [PROPERTY_FADE] = {NULL, "fade", "how much the context is thinned in 3-D", OF_VIEWER(display.fade), REALS(1, 0, 1),
                       .label = "Context faded", .format = "%.2f",
                       .tip = "how much the context is thinned in 3-D: 0 as its transfer function says, 1 not at all "
                              "there"},
    [PROPERTY_FILL] = {NULL, "fill", "opacity of the areas in the cuts, 0 to 1", OF_VIEWER(display.fill),
                       REALS(1, 0, 1), .label = "Areas filled", .format = "%.2f"},
    [PROPERTY_OUTLINES] = {NULL, "outlines", "lines around the areas in the cuts", OF_VIEWER(display.no_outlines),
                           TRUTH, .is_negated = true, .label = "Outlines"},
    [PROPERTY_RADIOLOGICAL] = {NULL, "radiological", "the head's left on the right of the cuts",
                               OF_VIEWER(display.radiological), TRUTH, .label = "Radiological (left is right)"},
    [PROPERTY_ORBIT] = {NULL, "orbit",
                        "where 3-D looks: its centre and the eye's distance, mm; azimuth and elevation, radians",
                        OF_VIEWER(orbit.centre), REALS(6, -FAR, FAR), .undo = UNDO_LEAVES},
    [PROPERTY_CROSSHAIR] = {NULL, "crosshair", "where the cuts are, mm", OF_VIEWER(crosshair), REALS(3, -FAR, FAR),
                            .undo = UNDO_LEAVES},
    [PROPERTY_MAGNIFICATION] = {NULL, "magnification", "of the cuts", OF_VIEWER(magnification), REALS(1, 0.2, 50),
                                .undo = UNDO_LEAVES},
    [PROPERTY_ENLARGED] = {NULL, "enlarged", "the pane that fills the middle", OF_WINDOW(screen.enlarged),
                           .type = PROPERTY_NAME, .low = -1, .high = PANE_COUNT - 1, .names = pane_names,
                           .undo = UNDO_LEAVES},
    [PROPERTY_BY_HEAD] = {NULL, "by_head", "whether a tracked head moves the view; only then there are the next three",
                          OF_VIEWER(head.on), TRUTH, .presence = PROPERTY_OF_HEAD, .undo = UNDO_LEAVES,
                          .is_set_apart = true},
    [PROPERTY_EYE] = {NULL, "eye", "where its eye is, mm", OF_VIEWER(head.eye), REALS(3, -FAR, FAR),
                      .presence = PROPERTY_OF_HEAD, .undo = UNDO_LEAVES, .is_set_apart = true},
    [PROPERTY_SCREEN] = {NULL, "world_from_screen", "the pose of the screen's middle, a matrix as above",
                         OF_VIEWER(head.screen), REALS(16, -FAR, FAR), .presence = PROPERTY_OF_HEAD,
                         .undo = UNDO_LEAVES, .is_set_apart = true},
    [PROPERTY_SCREEN_MM] = {NULL, "screen_mm", "width and height of the screen, mm; 0 = not known",
                            OF_VIEWER(head.size), REALS(2, 0, FAR), .presence = PROPERTY_OF_HEAD, .undo = UNDO_LEAVES,
                            .is_set_apart = true},
    [PROPERTY_SLICE_FRACTION] = {NULL, "slice_fraction",
                                 "which part of the picture's slices are sampled; only where it is not 0, the default",
                                 OF_VIEWER(cone.options.slice_fraction), REALS(1, 0, 1), .presence = PROPERTY_ZERO,
                                 .change = CHANGES_ANSWER, .label = "Slices", .format = "%.2f of the picture's",
                                 .slider = {0.01, 1}, .is_logarithmic = true,
                                 .tip = "which part of the picture's slices the cone asks at (--slice-fraction)"},
    [PROPERTY_START] = {NULL, "start", "where the mouse's cone begins", OF_VIEWER(cone.start), ENUM(start_names),
                        .presence = PROPERTY_KEPT, .says = start_says, .label = "Starts", .choices = starts,
                        .tip = "where the mouse's cone has its apex: at the first surface under the mouse, of the "
                               "context or of an\narea, 40 mm before it (a small atlas: half its radius), or at the "
                               "eye that looks at the 3-D pane;\nwith an end of its depths, which count from "
                               "there, at the surface in place of before it"},
    [PROPERTY_ONE_RAY] = {NULL, "one_ray", "whether a single ray is asked in place of the cone",
                          OF_VIEWER(cone.one_ray), TRUTH, .presence = PROPERTY_KEPT, .says = ray_says,
                          .label = "One area only", .change = CHANGES_ANSWER,
                          .tip = "in place of the cone a single ray along its axis, which names the area that it hits "
                                 "first"},
    [PROPERTY_FOLLOW] = {NULL, "follow", "what the cuts go along with", OF_VIEWER(cone.follow), ENUM(follow_names),
                         .presence = PROPERTY_KEPT, .says = follow_says, .label = "Cuts follow", .choices = followed,
                         .change = CHANGES_ANSWER,
                         .tip = "what the crosshair, and with it the three cuts, go along with"},
    [PROPERTY_ORDER] = {NULL, "order", "the order of the lists", OF_VIEWER(cone.order), ENUM(order_names),
                        .presence = PROPERTY_KEPT, .says = order_says, .label = "List", .choices = order_says,
                        .tip = "the order of the lists and their tables (--order): by rank, or by depth, mm from the "
                               "apex: with all\nlayers that of the entry, else that of the nearest hit"},
    [PROPERTY_SLICES] = {NULL, "slices", "how many slices the picture has; 0 = the default",
                         OF_VIEWER(cone.options.slices), .type = PROPERTY_WHOLE, .high = 65536,
                         .presence = PROPERTY_KEPT, .change = CHANGES_ANSWER, .label = "Picture's slices",
                         .slider = {0, 2048},
                         .tip = "how many slices the picture has (--slices); 0 = 1.41 times the longest edge of the "
                                "volume, in voxels"},
    [PROPERTY_STUDY] = {NULL, "study", "the study of the cone", OF_VIEWER(study.settings.kind), ENUM(study_names),
                        .presence = PROPERTY_KEPT, .says = study_says, .label = "Study", .choices = studies,
                        .tip = "sweep: the shares of the cone at several angles; jitter: how probable each area is to\n"
                               "be the one hit where the pose is not exactly known; the numbers of conus sweep, of\n"
                               "the cone as it is now"},
    [PROPERTY_SWEEP] = {NULL, "sweep_deg", "its angles: from, to, by, degrees", OF_VIEWER(study.settings.angles),
                        REALS(3, 0, 180), .presence = PROPERTY_KEPT},
    [PROPERTY_JITTER] = {NULL, "jitter",
                         "its errors: tilt in degrees, shift in mm, and the number of poses, a power of two from 16",
                         OF_VIEWER(study.settings.tilt_deg), REALS(3, 0, 1048576), .presence = PROPERTY_KEPT},
    [PROPERTY_SECOND_ON] = {"second", "on", "whether there is a second tool", OF_VIEWER(tools[SECOND_TOOL].on), TRUTH,
                            .is_set_apart = true},
    [PROPERTY_SECOND_POINTER] = {"second", "pointer", "what moves it", OF_VIEWER(tools[SECOND_TOOL].pointer),
                                 ENUM(second_pointer_names)},
    [PROPERTY_SECOND_HAS_POSE] = {"second", "has_pose", "whether it has a pose", OF_VIEWER(tools[SECOND_TOOL].has_pose),
                                  TRUTH, .undo = UNDO_LEAVES_MOVING},
    [PROPERTY_SECOND_HELD] = {"second", "held", "whether it is held", OF_VIEWER(tools[SECOND_TOOL].held), TRUTH},
    [PROPERTY_SECOND_ANGLE] = {"second", "angle_deg", "full opening of the second cone, degrees",
                               OF_VIEWER(tools[SECOND_TOOL].angle), REALS(1, 0.01, 179.99), .change = CHANGES_SECOND,
                               ANGLE},
    [PROPERTY_SECOND_POSE] = {"second", "world_from_device", "its pose, a matrix as above",
                              OF_VIEWER(tools[SECOND_TOOL].pose), REALS(16, -FAR, FAR), .undo = UNDO_LEAVES_MOVING},
    [PROPERTY_SPEED] = {NULL, "device_speed", "of a SpaceMouse or gamepad at full deflection, mm and degrees a second",
                        OF_WINDOW(inputs.devices.gamepad.source.speed), REALS(1, SOURCE_LEAST_SPEED, SOURCE_MOST_SPEED),
                        .presence = PROPERTY_KEPT, .is_set_apart = true, .change = CHANGES_SPEED, .label = "Speed",
                        .format = "%.0f mm/s", .is_logarithmic = true,
                        .tip =
                            "of a SpaceMouse or gamepad at full deflection: mm a second, and as many degrees a second"},
    [PROPERTY_BACKGROUND] = {NULL, "background", "behind the brain in 3-D and in figures", OF_VIEWER(display.backdrop),
                             .type = PROPERTY_NAME, .high = BACKDROP_COUNT - 1, .names = backdrop_names,
                             .label = "Background", .presence = PROPERTY_KEPT,
                             .tip = "behind the brain in 3-D and in figures; the theme's is light in figures;\n"
                                    "transparent is of figures, the window shows it white"},
    [PROPERTY_SAFE_COLOURS] = {NULL, "safe_colours", "colours for any colour vision in place of the atlas's own",
                               OF_VIEWER(display.safe_colours), TRUTH, .presence = PROPERTY_KEPT,
                               .change = CHANGES_COLOURS, .label = "Colours for any colour vision",
                               .tip = "in place of the atlas's own, where these are shown"},
    [PROPERTY_OWN_COLOURS] = {NULL, "own_colours", "the atlas's own colours, with a cone and without",
                              OF_VIEWER(display.own_colours), TRUTH, .presence = PROPERTY_KEPT,
                              .label = "Colours of the file",
                              .tip = "in place of grey: else only what the cone hits has a colour, by its place in\n"
                                     "the answer"},
    [PROPERTY_FIGURE_IN_MM] = {"figure", "in_mm", "whether the size of figures is that on paper",
                               OF_WINDOW(sheet.in_mm), TRUTH},
    [PROPERTY_FIGURE_PIXELS] = {"figure", "pixels", "their width and height; 0 = the default", OF_WINDOW(sheet.pixels),
                                .type = PROPERTY_INTEGER, .count = 2, .high = SHEET_SIDE_LIMIT},
    [PROPERTY_FIGURE_MM] = {"figure", "mm", "likewise on paper", OF_WINDOW(sheet.mm), REALS(2, 0, SHEET_MM_LIMIT)},
    [PROPERTY_FIGURE_DPI] = {"figure", "dpi", "pixels per inch, from 10; 0 = the default", OF_WINDOW(sheet.dpi),
                             REALS(1, 0, SHEET_DPI_LIMIT)},
    [PROPERTY_FIGURE_LEGEND] = {"figure", "legend", "where the areas that the cone hits are listed",
                                OF_WINDOW(sheet.legend), ENUM(legend_names), .label = "Legend",
                                .tip = "where the areas that the cone hits are listed; right and below make the figure "
                                       "higher where it needs that"},
    [PROPERTY_FIGURE_TEXT] = {"figure", "text", "whether there are letters and a legend", OF_WINDOW(sheet.no_text),
                              TRUTH, .is_negated = true, .label = "letters of directions, scale and legend",
                              .tip = "without them nothing says which side is left"},
    [PROPERTY_PANELS] = {"layout", "panels",
                         "widths of the left and the right panel, pixels at scale 1, from 240 to 4000; 0 = as at first",
                         OF_WINDOW(screen.layout.panels), REALS(2, 0, FAR)},
    [PROPERTY_DIVISION] = {"layout", "division",
                           "parts of the middle's width for the 3-D pane, and of its height for the first cut, 0.1 to "
                           "0.9; 0 = as at first",
                           OF_WINDOW(screen.layout.division), REALS(2, 0, FAR)},
    [PROPERTY_FOLD_LEFT] = {"layout", "left", "whether the panel of areas is folded to its rail",
                            OF_WINDOW(screen.layout.folds[0]), .type = PROPERTY_NAME, .high = FOLD_COUNT - 1,
                            .names = fold_names, .presence = PROPERTY_KEPT},
    [PROPERTY_FOLD_RIGHT] = {"layout", "right", "whether the panel of hits is", OF_WINDOW(screen.layout.folds[1]),
                             .type = PROPERTY_NAME, .high = FOLD_COUNT - 1, .names = fold_names,
                             .presence = PROPERTY_KEPT},
    [PROPERTY_BARE] = {"layout", "brain_alone", "whether the 3-D pane has the whole window", OF_WINDOW(screen.bare),
                       TRUTH, .presence = PROPERTY_KEPT, .undo = UNDO_LEAVES, .says = bare_says},
    [PROPERTY_DEVICE_VIEW] = {"layout", "device_view", "whether the 3-D pane shows what the device sees",
                              OF_VIEWER(display.device_view), TRUTH, .presence = PROPERTY_KEPT,
                              .label = "What the device sees",
                              .tip = "shows the pixels of its buffer in the 3-D pane, in the areas' colours"},
    [PROPERTY_MEASURES] = {"measure", "on", "whether clicks measure", OF_VIEWER(measure.on), TRUTH,
                           .presence = PROPERTY_KEPT, .undo = UNDO_LEAVES, .says = measure_says,
                           .tip = "two clicks, in 3-D or in a cut, give the distance between two places"},
    [PROPERTY_MEASURED] = {"measure", "count", "how many places were set", OF_VIEWER(measure.count),
                           .type = PROPERTY_INTEGER, .high = 2, .presence = PROPERTY_KEPT},
    [PROPERTY_PLACES] = {"measure", "points", "the two places, mm", OF_VIEWER(measure.points), REALS(6, -FAR, FAR),
                         .presence = PROPERTY_KEPT},
    [PROPERTY_RESULT_ORDER] =
        {"results", "order",
         "the column by which the list of hits is ordered, by its name in the tables of conus query",
         OF_VIEWER(list.order), .type = PROPERTY_NAME, .high = RESULT_COLUMNS - 1, .name_of = result_key},
    [PROPERTY_RESULT_REVERSED] = {"results", "reversed", "whether the other way round", OF_VIEWER(list.reversed),
                                  TRUTH},
    [PROPERTY_EXPORT] = {"results", "export", "the format of exported lists", OF_VIEWER(list.format),
                         .type = PROPERTY_NAME, .high = RESULT_FORMATS - 1, .names = result_formats},
};

static const char *name_of(const struct property *property, int value)
{
    size_t index = (size_t)(value - (int)property->low);
    return property->name_of ? property->name_of(index) : property->names[index];
}

/* Its bytes in the window. */
static void *address_of(const struct property *property, const struct window *window)
{
    return (char *)(property->of_window ? (void *)window : (void *)window->viewer) + property->offset;
}

void property_get(double out[PROPERTY_NUMBERS], const struct property *property, const struct window *window)
{
    const void *place = address_of(property, window);
    for (size_t i = 0; i < property_count(property); i++) {
        switch (property->type) {
        case PROPERTY_REAL:
            out[i] = ((const double *)place)[i];
            break;
        case PROPERTY_WHOLE:
        case PROPERTY_INTEGER:
            out[i] = ((const uint32_t *)place)[i];
            break;
        case PROPERTY_TRUTH:
            out[i] = *(const bool *)place != property->is_negated;
            break;
        default: /* a size_t is never negative, an int may be */
            out[i] = property->size == sizeof(size_t) ? (double)*(const size_t *)place : *(const int *)place;
        }
    }
}

void property_put(struct window *window, const struct property *property, const double numbers[PROPERTY_NUMBERS])
{
    void *place = address_of(property, window);
    for (size_t i = 0; i < property_count(property); i++) {
        switch (property->type) {
        case PROPERTY_REAL:
            ((double *)place)[i] = numbers[i];
            break;
        case PROPERTY_WHOLE:
        case PROPERTY_INTEGER:
            ((uint32_t *)place)[i] = (uint32_t)numbers[i];
            break;
        case PROPERTY_TRUTH:
            *(bool *)place = (numbers[i] > 0) != property->is_negated;
            break;
        default:
            if (property->size == sizeof(size_t)) {
                *(size_t *)place = (size_t)numbers[i];
            } else {
                *(int *)place = (int)numbers[i];
            }
        }
    }
}

static json_t *number_json(const struct property *property, double number)
{
    return property->type == PROPERTY_NAME      ? json_string(name_of(property, (int)number))
           : property->type == PROPERTY_TRUTH   ? json_boolean(number > 0)
           : property->type == PROPERTY_INTEGER ? json_integer((json_int_t)number)
                                                : json_real(number);
}

json_t *property_json(const struct property *property, const double numbers[PROPERTY_NUMBERS])
{
    if (property_count(property) == 1) {
        return number_json(property, numbers[0]);
    }
    json_t *array = json_array();
    for (size_t i = 0; i < property->count; i++) {
        json_array_append_new(array, number_json(property, numbers[i]));
    }
    return array;
}

/* False where no value has this name. */
static bool find_name(double *out, const struct property *property, const char *text)
{
    for (int value = (int)property->low; text && value <= (int)property->high; value++) {
        const char *name = name_of(property, value);
        if (name && strcmp(name, text) == 0) {
            *out = value;
            return true;
        }
    }
    return false;
}

static bool read_number(double *out, const struct property *property, const json_t *value)
{
    if (property->type == PROPERTY_TRUTH) {
        *out = json_is_true(value);
        return json_is_boolean(value);
    }
    if (property->type == PROPERTY_NAME) {
        return find_name(out, property, json_string_value(value));
    }
    *out = json_number_value(value);
    bool is_number = property->type == PROPERTY_INTEGER ? json_is_integer(value) : json_is_number(value);
    return is_number && *out >= property->low && *out <= property->high;
}

bool session_refuse(char why[PROPERTY_REASON], const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(why, PROPERTY_REASON, format, arguments);
    va_end(arguments);
    return false;
}

/* "exact or slices", "light, white, black or transparent". */
static void list_names(char *out, size_t size, const struct property *property)
{
    size_t used = 0;
    out[0] = '\0';
    for (int value = (int)property->low; value <= (int)property->high && used < size; value++) {
        const char *name = name_of(property, value);
        const char *before = !used ? "" : value == (int)property->high ? " or " : ", ";
        used += name ? (size_t)snprintf(out + used, size - used, "%s%s", before, name) : 0;
    }
}

/* The values that it may have: "exact or slices", "3 numbers from 0 to 180". */
static void property_allowed(char out[PROPERTY_REASON], const struct property *property)
{
    if (property->name_of) {
        snprintf(out, PROPERTY_REASON, "the name of a column");
    } else if (property->type == PROPERTY_NAME) {
        list_names(out, PROPERTY_REASON, property);
    } else if (property->type == PROPERTY_TRUTH) {
        snprintf(out, PROPERTY_REASON, "true or false");
    } else if (property_count(property) > 1) {
        snprintf(out, PROPERTY_REASON, "%zu numbers from %.7g to %.7g", property->count, property->low, property->high);
    } else {
        snprintf(out, PROPERTY_REASON, "a number from %.7g to %.7g", property->low, property->high);
    }
}

bool property_read(double out[PROPERTY_NUMBERS], const struct property *property, const json_t *value,
                   char why[PROPERTY_REASON])
{
    size_t count = property_count(property);
    bool fine = count == 1 || (json_is_array(value) && json_array_size(value) == count);
    for (size_t i = 0; fine && i < count; i++) {
        fine = read_number(&out[i], property, count == 1 ? value : json_array_get(value, i));
    }
    if (!fine) {
        char allowed[PROPERTY_REASON];
        property_allowed(allowed, property);
        session_refuse(why, "%s%s%s: %s %s needed", property->object ? property->object : "",
                       property->object ? ": " : "", property->name, allowed, count > 1 ? "are" : "is");
    }
    return fine;
}

double property_value(const struct window *window, enum property_id id)
{
    double numbers[PROPERTY_NUMBERS];
    property_get(numbers, &properties[id], window);
    return numbers[0];
}

/* Slices have no depths and only first hits; exact sampling has no slices. */
static void settle(conus_selector_options *options)
{
    static const double fraction = 0.2; /* the default, Eq. 7 */
    if (options->sampling == CONUS_SAMPLING_EXACT) {
        options->slice_fraction = 0;
        options->slices = 0;
    } else {
        options->layers = CONUS_LAYERS_VISIBLE;
        options->range[0] = options->range[1] = 0;
        options->slice_fraction = options->slice_fraction > 0 ? options->slice_fraction : fraction;
    }
}

static void set(struct window *window, const struct property *property, const double numbers[PROPERTY_NUMBERS])
{
    struct viewer *viewer = window->viewer;
    if (property->change == CHANGES_COLOURS) {
        viewer_use_safe_colours(viewer, numbers[0] > 0);
        return;
    }
    property_put(window, property, numbers);
    if (property->says) {
        viewer_say(viewer, "%s", property->says[(int)(numbers[0] - property->low)]);
    }
    switch (property->change) {
    case CHANGES_ANSWER:
        settle(&viewer->cone.options);
        tool_reselect(viewer);
        break;
    case CHANGES_SECOND:
        tool_changed(window->viewer, SECOND_TOOL);
        break;
    case CHANGES_SPEED:
        devices_set_speed(&window->inputs.devices, numbers[0]);
        viewer->version++;
        break;
    default:
        viewer->version++;
    }
}

void property_set(struct window *window, enum property_id id, double value)
{
    double numbers[PROPERTY_NUMBERS] = {value};
    set(window, &properties[id], numbers);
}

void property_next(struct window *window, enum property_id id)
{
    const struct property *property = &properties[id];
    double now = property_value(window, id);
    property_set(window, id, now < property->high ? now + 1 : property->low);
}

static bool read_word(double *out, const struct property *property, const char *word)
{
    char *end;
    if (property->type == PROPERTY_NAME) {
        return find_name(out, property, word);
    }
    if (property->type == PROPERTY_TRUTH) {
        *out = strcmp(word, "on") == 0;
        return *out > 0 || strcmp(word, "off") == 0;
    }
    *out = strtod(word, &end);
    return *word && !*end && *out >= property->low && *out <= property->high;
}

bool property_set_words(struct window *window, enum property_id id, char *const *words, size_t count)
{
    const struct property *property = &properties[id];
    double numbers[PROPERTY_NUMBERS];
    bool fine = count == property_count(property);
    for (size_t i = 0; i < count && fine; i++) {
        fine = read_word(&numbers[i], property, words[i]);
    }
    if (fine) {
        set(window, property, numbers);
    }
    return fine;
}
