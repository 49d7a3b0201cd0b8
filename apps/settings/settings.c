/* SPDX-License-Identifier: BSD-3-Clause */
/* The tables of options that several commands share, and what they mean for the library. */
#include "settings/settings.h"

#include "conus/score.h"
#include "options/messages.h"
#include "options/options.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define FIELD(type, member) OPTION_AT(struct type, member)

static const char *const apertures[] = {"circle", "square", NULL};
const char *const settings_engines[] = {"auto", "rays", "gl", NULL};
static const char *const samplings[] = {"exact", "slices", NULL};
static const char *const sides[] = {"as-is", "exchanged", NULL};
const char *const settings_hemispheres[] = {"as-is", "split", "merged", NULL};
static const char *const layers[] = {"visible", "all", NULL};

/* The last rows of every command. */
#define HELP_AND_VERSION                                                                                               \
    {.name = "help",                                                                                                   \
     .letter = 'h',                                                                                                    \
     OPTION_AT(struct common_settings, help),                                                                          \
     .help = "this text; -h is the short one",                                                                         \
     .role = OPTION_ENDS},                                                                                             \
    {                                                                                                                  \
        .name = "version", OPTION_AT(struct common_settings, version), .help = "the version", .role = OPTION_ENDS      \
    }

const struct option plain_options[] = {
    HELP_AND_VERSION,
    {0},
};

const struct option quiet_options[] = {
    {.name = "quiet",
     .letter = 'q',
     FIELD(common_settings, quiet),
     .help = "print only errors and warnings on stderr, no notes",
     .role = OPTION_OF_RUN},
    {.name = "verbose",
     .letter = 'v',
     FIELD(common_settings, verbose),
     .help = "print the engine's and the GL driver's messages, too, on stderr",
     .role = OPTION_OF_RUN},
    HELP_AND_VERSION,
    {0},
};

const struct option atlas_options[] = {
    {.name = "labels",
     FIELD(atlas_settings, labels),
     .value = "FILE[,label=COLUMN,name=COLUMN]",
     .help = "label table; replaces the one found beside or inside the atlas; columns of a header row that are not "
             "called as usual are given by their names",
     .words = "lookup table, LUT, names",
     .role = OPTION_READS},
    {.name = "labels-anyway",
     FIELD(atlas_settings, labels_anyway),
     .help = "treat every value as a label, even if the volume looks like an image"},
    {.name = "probability",
     FIELD(atlas_settings, probability),
     .value = "T",
     .help = "of an atlas of probabilities: a voxel belongs to an area with a probability of at least T (default 0.25, "
             "or as the manifest says)",
     OPTION_ABOVE_TO(0, 1)},
    {.name = "pathway",
     FIELD(atlas_settings, pathways),
     .value = "FILE[,KEY=VALUE]...",
     .help =
         "add a scalar map as a pathway; keys: threshold=T (voxels with values of at least T belong to it; default a "
         "quarter of the file's scale), name=S, volume=K (of a 4-D file, from 0); or as several, each a band of "
         "values: band=LOW:HIGH:NAME (from LOW to below HIGH; either may be left out), once for each; may be repeated",
     .words = "tract, probability map",
     .role = OPTION_READS},
    {.name = "streamlines",
     FIELD(atlas_settings, streamlines),
     .value = "FILE[,KEY=VALUE]...",
     .help =
         "add a tractogram as a bundle, or as one for each of its groups; keys: radius=R (a ray hits what is nearer "
         "than R mm to a streamline; default 0.5), name=S, space=ras or space=lps (the axes of a file that does not "
         "state them, as DIPY's VTK in LPS), moves (it lies where ATLAS's files do, and --atlas-transform moves it, "
         "too); may be repeated",
     .words = "fibre, fiber, tractography, tractogram",
     .role = OPTION_READS},
    {.name = "hemispheres",
     FIELD(atlas_settings, hemispheres),
     .value = "HOW",
     .help =
         "cut areas of both sides in two at x = 0 (split), or report left and right areas of one name as one (merged):",
     .choices = settings_hemispheres,
     .words = "left, right, side"},
    {.name = "sides",
     FIELD(atlas_settings, sides),
     .value = "HOW",
     .help = "mirror ATLAS, whose voxels lie the other way round than its header says, as a warning tells (exchanged):",
     .choices = sides,
     .words = "left, right, mirror, flip"},
    {.name = "atlas-transform",
     FIELD(atlas_settings, transforms),
     .value = "FILE[,KEY]...",
     .help =
         "bring the atlas to the poses: an affine (ITK, FreeSurfer, MNI, FSL, 4 x 4), a B-spline (ITK), a "
         "deformation field (ITK, SPM, FSL, MRtrix, NiftyReg, SynthMorph) or a composite of these (ITK, ANTs, X5) "
         "from their space to the atlas's; keys: from=IMAGE and to=IMAGE of FSL's, inverse (an affine from the "
         "atlas), relative or absolute (a field's vectors), space=ras or space=lps (their axes), grid=IMAGE (voxels "
         "for the labels), transform=K (number K, from 0, of a list of ITK's); may be repeated, points go through "
         "the first one first",
     .words = "warp, registration, normalise",
     .role = OPTION_READS},
    {.name = "max-memory",
     .type = OPTION_BYTES,
     .offset = offsetof(struct atlas_settings, max_memory),
     .value = "SIZE",
     .help =
         "largest file or volume to accept, like 512M or 2G (default 8G; 1G for files of poses that are read whole)",
     .words = "RAM",
     .role = OPTION_KEPT},
    {.name = "no-cache",
     FIELD(atlas_settings, no_cache),
     .help = "read the atlas's files anew, and keep nothing for the next time (conus cache)",
     .role = OPTION_OF_RUN},
    {0},
};

const struct option shown_options[] = {
    {.name = "only",
     FIELD(atlas_settings, only),
     .value = "NAME,...",
     .help = "keep only these areas, pathways and bundles, by name, abbreviation or label, with all below them in the "
             "area tree; all others are as if never loaded; put a name with a comma in double quotes; @FILE is a file "
             "with one name per line; may be repeated",
     .words = "region, ROI, filter, include",
     .role = OPTION_READS},
    {.name = "hide",
     FIELD(atlas_settings, hide),
     .value = "NAME,...",
     .help = "remove these areas, pathways and bundles, named as for --only: not hit, not drawn, not occluding; may be "
             "repeated",
     .words = "exclude, remove",
     .role = OPTION_READS},
    {0},
};

const struct option more_atlas_options[] = {
    {.name = "atlas",
     FIELD(atlas_settings, more),
     .value = "ATLAS",
     .help = "another atlas in the same space, a file or a name, that gets the same question; --labels, --pathway, "
             "--streamlines (except in conus connect), --only, --hide and --level apply to the first atlas only; may "
             "be repeated",
     .role = OPTION_READS_ATLAS},
    {0},
};

const struct option context_options[] = {
    {.name = "context",
     FIELD(context_settings, path),
     .value = "FILE",
     .help = "scalar map that blocks rays, such as a skull",
     .role = OPTION_READS,
     .flags = OPTION_OF_RAYS,
     .needs = "context-blocks"},
    {.name = "context-blocks",
     FIELD(context_settings, blocks),
     .value = "T",
     .help = "context voxels with values of at least T block rays",
     OPTION_BETWEEN(0, FLT_MAX),
     .needs = "context"},
    {0},
};

const struct option context_choice_options[] = {
    {.name = "context",
     FIELD(context_choice, files),
     .value = "FILE",
     .help = "scalar map, such as a T1, or surface, such as a scalp, to draw around the areas, in the place of a "
             "manifest's volume; may be repeated for more surfaces",
     .role = OPTION_READS},
    {.name = "context-opacity",
     FIELD(context_choice, opacity),
     .value = "O",
     .help = "opacity of the context's surfaces, above 0 to 1 (default 0.25)",
     OPTION_ABOVE_TO(0, 1),
     .needs = "context"},
    {0},
};

const struct option map_options[] = {
    {.name = "map",
     FIELD(context_choice, map),
     .value = "FILE,array=NAME[,range=A:B]",
     .help =
         "colour the surface of --context by an array of a GIFTI file (.func.gii, .shape.gii), from A, dark blue, to "
         "B, yellow (default: the least and the largest); the surface is opaque unless --context-opacity is given",
     .words = "overlay, colours, func.gii, metric",
     .role = OPTION_READS},
    {0},
};

const struct option aim_options[] = {
    {.name = "origin",
     FIELD(aim_settings, origin),
     .value = "X,Y,Z",
     .help = "position of the device: the cone's apex, mm",
     .words = "position, apex, tip",
     .common = true,
     .flags = OPTION_OF_CONE,
     .excludes = "pose,poses"},
    {.name = "toward",
     FIELD(aim_settings, toward),
     .value = "X,Y,Z",
     .help = "point at which the device points, mm",
     .words = "target",
     .common = true,
     .flags = OPTION_OF_CONE,
     .needs = "origin",
     .excludes = "direction"},
    {.name = "direction",
     FIELD(aim_settings, direction),
     .value = "X,Y,Z",
     .help = "or direction of the axis, of any length but 0",
     .flags = OPTION_OF_CONE,
     .needs = "origin"},
    {.name = "up",
     FIELD(aim_settings, up),
     .value = "X,Y,Z",
     .help = "up direction of the device (default superior; anterior if it points up or down)",
     .flags = OPTION_OF_CONE,
     .needs = "origin"},
    {.name = "pose",
     FIELD(aim_settings, pose),
     .value = "FILE",
     .help =
         "poses from a file instead, - for standard input: a table with a header, a 4x4 matrix, or what Brainsight, "
         "Localite, 3D Slicer, SimNIBS, InVesalius, Lead-DBS or BIDS write (docs/formats.md)",
     .words = "coil, trajectory, electrode",
     .common = true,
     .role = OPTION_READS_POSES,
     .flags = OPTION_OF_CONE,
     .excludes = "poses"},
    {0},
};

const struct option angle_options[] = {
    {.name = "angle",
     FIELD(aim_settings, angle),
     .value = "DEGREES",
     .help = "full opening angle of the cone, more than 0 and less than 180 (default 10)",
     .words = "width, opening",
     .common = true,
     .flags = OPTION_OF_CONE},
    {0},
};

const struct option pixel_options[] = {
    {.name = "resolution",
     FIELD(engine_settings, resolution),
     .value = "N",
     .help = "trace N x N rays, one per pixel, N from 1 to 1024 (default 16)",
     OPTION_FROM_TO(1, 1024),
     .words = "rays",
     .flags = OPTION_OF_RAYS},
    {.name = "aperture",
     FIELD(engine_settings, aperture),
     .value = "SHAPE",
     .help = "pixels that count: those in the circle, or all:",
     .choices = apertures,
     .flags = OPTION_OF_RAYS},
    {0},
};

const struct option engine_options[] = {
    {.name = "engine",
     FIELD(engine_settings, engine),
     .value = "NAME",
     .help = "rays on the CPU or an OpenGL pass, with the same hits; auto is rays in this program:",
     .choices = settings_engines,
     .flags = OPTION_OF_RAYS},
    {.name = "sampling",
     FIELD(engine_settings, sampling),
     .value = "KIND",
     .help = "visit every voxel along a ray, or only planes across the view, which can miss thin objects:",
     .choices = samplings,
     .flags = OPTION_OF_RAYS},
    {.name = "slice-fraction",
     FIELD(engine_settings, slice_fraction),
     .value = "F",
     .help = "with --sampling slices: part of the picture's slices that the selection takes, more than 0 to 1 "
             "(default 0.2, the paper's fifth)",
     OPTION_ABOVE_TO(0, 1),
     .flags = OPTION_OF_RAYS,
     .needs = "sampling=slices"},
    {.name = "level",
     FIELD(engine_settings, level),
     .value = "N|AREA,...",
     .help =
         "report areas rolled up the area tree: to depth N (roots have 1), or to the nearest of these areas, by name, "
         "abbreviation or label; put a name with a comma in double quotes; @FILE is a file with one area per line",
     .words = "hierarchy, ontology",
     .role = OPTION_READS},
    {.name = "score",
     FIELD(engine_settings, score),
     .value = "FORMULA",
     .help = "score that ranks the objects: a name below (default share), or a formula like 0.5*share+0.5*centre",
     .words = "sort, rank",
     .role = OPTION_ASKS,
     .flags = OPTION_OF_RAYS},
    {0},
};

const struct option shape_options[] = {
    {.name = "layers",
     FIELD(engine_settings, layers),
     .value = "WHICH",
     .help = "first hits only, or all hits in the cone with path lengths, volumes and values:",
     .choices = layers,
     .words = "behind, occluded, depth",
     .flags = OPTION_OF_RAYS},
    {.name = "range",
     FIELD(engine_settings, range),
     .value = "NEAR,FAR",
     .help =
         "count only between these two depths along the axis, mm from the apex: a focal spot, the length of a probe",
     OPTION_FROM_TO(0, 1e9),
     .flags = OPTION_OF_CONE},
    {.name = "radius",
     FIELD(engine_settings, radius),
     .value = "MM",
     .help = "radius of a cylinder that replaces the cone, mm, more than 0: a needle, a probe",
     OPTION_BETWEEN(0, 1e9),
     .words = "cylinder, needle, sphere, ball"},
    {0},
};

const struct option slices_options[] = {
    {.name = "slices",
     FIELD(engine_settings, slices),
     .value = "N",
     .help = "with --sampling slices: slices of the picture; the selection takes --slice-fraction of them (default "
             "sqrt(2) times the longest edge of the volume)",
     OPTION_FROM_TO(1, 65536),
     .flags = OPTION_OF_RAYS,
     .needs = "sampling=slices"},
    {0},
};

bool settings_check_aim(const struct arguments *arguments, bool aim_needed)
{
    bool has_origin = option_given(arguments, "origin");
    if (has_origin && !option_given(arguments, "toward") && !option_given(arguments, "direction")) {
        return refuse("--origin needs --toward X,Y,Z or --direction X,Y,Z with it");
    }
    if (!has_origin && aim_needed && !option_given(arguments, "pose")) {
        return refuse("no cone given: --origin X,Y,Z with --toward X,Y,Z or --direction X,Y,Z, or --pose FILE");
    }
    return true;
}

int settings_pose_toward(conus_pose *out, const double origin[3], const double toward[3], const double up[3],
                         const conus_frame *frame, const char *prefix)
{
    double from[3];
    double to[3];
    double above[3];
    char option[32];
    snprintf(option, sizeof option, "%sorigin", prefix);
    int code = space_settings_point(from, origin, frame, option);
    snprintf(option, sizeof option, "%stoward", prefix);
    code = code ? code : space_settings_point(to, toward, frame, option);
    if (code) {
        return code;
    }
    if (up) {
        conus_frame_direction_to_world(above, frame, up);
    }
    conus_status status = conus_pose_toward(out, from, to, up ? above : NULL);
    return print_status(status);
}

int settings_pose(conus_pose *out, const struct aim_settings *settings, const conus_frame *frame,
                  const struct arguments *arguments)
{
    const double *given_up = option_given(arguments, "up") ? settings->up : NULL;
    double from[3];
    double along[3];
    double above[3];
    int code = EXIT_DONE;
    if (option_given(arguments, "toward")) {
        code = settings_pose_toward(out, settings->origin, settings->toward, given_up, frame, "");
    } else {
        code = space_settings_point(from, settings->origin, frame, "origin");
        conus_frame_direction_to_world(along, frame, settings->direction);
        conus_frame_direction_to_world(above, frame, settings->up);
        code = code ? code : print_status(conus_pose_along(out, from, along, given_up ? above : NULL));
    }
    if (!code) {
        conus_frame_turn_pose(out, frame, given_up != NULL);
    }
    return code;
}

const char *settings_level_file(const struct engine_settings *settings)
{
    const char *level = settings->level;
    return level && level[0] == '@' && !strchr(level, ',') ? level + 1 : NULL;
}

double radians(double degrees)
{
    return degrees * (M_PI / 180);
}

double settings_angle(const struct aim_settings *settings, const struct engine_settings *engine)
{
    return engine->radius > 0 ? 0 : radians(settings->angle != 0 ? settings->angle : DEFAULT_ANGLE);
}

bool settings_check_shape(const struct aim_settings *settings, const struct engine_settings *engine,
                          const struct arguments *arguments)
{
    if (!option_given(arguments, "angle")) {
        return true;
    }
    if (engine->radius > 0 && settings->angle != 0) {
        return refuse("--radius makes a cylinder, whose --angle is 0");
    }
    if (engine->radius == 0 && !(settings->angle > 0 && settings->angle < 180)) {
        return refuse("--angle: %.10g is out of range, allowed is more than 0 and less than 180%s", settings->angle,
                      settings->angle == 0 ? "; 0 goes with --radius" : "");
    }
    return true;
}

bool settings_check_score(const struct engine_settings *settings, bool has_history)
{
    conus_score_info score;
    if (conus_score_parse(&score, settings->score)) {
        return refuse("--%s", conus_message());
    }
    if (score.needs_history && !has_history) {
        return refuse("--score: %s needs a history, which single poses do not have; conus track has one", score.name);
    }
    if (score.needs_layers && settings->layers != CONUS_LAYERS_ALL) {
        return refuse("--score: %s needs --layers all", score.name);
    }
    return true;
}

conus_selector_options settings_engine(const struct engine_settings *settings, const struct common_settings *common)
{
    return (conus_selector_options){
        .engine = (conus_engine)settings->engine,
        .aperture = (conus_aperture)settings->aperture,
        .sampling = (conus_sampling)settings->sampling,
        .resolution = settings->resolution,
        .slices = settings->slices,
        .slice_fraction = settings->slice_fraction,
        .layers = (conus_layers)settings->layers,
        .range = {settings->range[0], settings->range[1]},
        .radius = settings->radius,
        .level = settings->level,
        .score = settings->score,
        .log = common->verbose ? log_line
               : common->quiet ? NULL
                               : log_warning,
    };
}

void help_scores(FILE *out)
{
    const conus_score_info *score;
    fputs("Scores, the higher the better; a formula joins them with numbers, + - * / and parentheses\n", out);
    for (size_t i = 0; (score = conus_score(i)); i++) {
        fprintf(out, "  %-26s  %s%s%s\n", score->name, score->description, score->needs_history ? " (conus track)" : "",
                score->needs_layers ? " (--layers all)" : "");
    }
}

static const char *const orders[] = {"rank", "depth", NULL};

const struct rows_kind settings_axis_rows[AXIS_FILES] = {{"segments", CONUS_ROWS_SEGMENTS, "segments"},
                                                         {"clearance", CONUS_ROWS_CLEARANCES, "clearances"}};

const struct option axis_options[] = {
    {.name = "segments",
     OPTION_AT(struct axis_settings, files[0]),
     .value = "FILE",
     .help = "write what the axis passes, in order of depth: a row for each stretch inside an area, pathway or "
             "bundle, or between them",
     .words = "probe, shank, track",
     .role = OPTION_WRITES_ROWS,
     .flags = OPTION_OF_CONE},
    {.name = "clearance",
     OPTION_AT(struct axis_settings, files[1]),
     .value = "FILE[,within=MM]",
     .help = "write how far the device stays from each area, pathway and bundle, the nearest first, and where; as a "
             "needle of --radius (a cone has none) from the near to the far end of --range; up to MM away, 0 to 1000 "
             "(default 10)",
     .words = "margin, safety, needle, avoid",
     .role = OPTION_WRITES_ROWS,
     .flags = OPTION_OF_CONE,
     .key = "within"},
    {.name = "order",
     OPTION_AT(struct axis_settings, order),
     .value = "ORDER",
     .help = "order of the rows of an answer: the best first, or the nearest (with --layers all by entry, else by "
             "distance):",
     .choices = orders,
     .words = "sort"},
    {.name = "contacts",
     OPTION_AT(struct axis_settings, contacts),
     .value = "COUNT,COLUMNS,PITCH,TIP",
     .help = "for --format open-ephys of shanks: COUNT contacts, COLUMNS in a row, PITCH mm from row to row, the first "
             "TIP mm from the tip",
     .role = OPTION_ASKS},
    {0},
};

int settings_within(double *out, const struct arguments *arguments)
{
    static const char *const keys[] = {",within=", NULL};
    const char *path = option_text(arguments, "clearance");
    const char *text = option_key(arguments, "clearance");
    *out = 10;
    if (path && key_left_in_file("clearance", path, keys)) {
        return EXIT_USAGE;
    }
    return !text || (number_parse(text, out) && *out >= 0 && *out <= 1000)
               ? EXIT_DONE
               : print_usage_error("--clearance: within=%s is no number of mm from 0 to 1000", text);
}

int settings_contacts(conus_contacts *out, const char *text)
{
    *out = (conus_contacts){0};
    if (!text) {
        return EXIT_DONE;
    }
    double numbers[4];
    bool whole = numbers_parse(numbers, 4, text, ',') == 4 && numbers[0] >= 1 && numbers[0] <= UINT32_MAX &&
                 numbers[1] >= 1 && numbers[1] <= UINT32_MAX;
    if (whole) {
        *out = (conus_contacts){
            .count = (uint32_t)numbers[0], .columns = (uint32_t)numbers[1], .pitch = numbers[2], .tip = numbers[3]};
        whole = out->count == numbers[0] && out->columns == numbers[1];
    }
    return whole
               ? EXIT_DONE
               : print_usage_error("--contacts: \"%s\" is not COUNT,COLUMNS,PITCH,TIP: two whole numbers from 1 on and "
                                   "two lengths in mm",
                                   text);
}

/* entry=MM,target=MM[,depth=MM] */
static bool read_ends(conus_jitter_options *out, const char *text)
{
    static const struct {
        const char *key;
        size_t offset;
    } ends[] = {{"entry=", offsetof(conus_jitter_options, entry)},
                {"target=", offsetof(conus_jitter_options, target)},
                {"depth=", offsetof(conus_jitter_options, depth)}};
    unsigned given = 0;
    bool is_fine = true;
    for (const char *rest = text; rest && is_fine; rest = strchr(rest, ',') ? strchr(rest, ',') + 1 : NULL) {
        char word[64];
        size_t end = 0;
        double value;
        snprintf(word, sizeof word, "%.*s", (int)strcspn(rest, ","), rest);
        while (end < 3 && strncmp(word, ends[end].key, strlen(ends[end].key)) != 0) {
            end++;
        }
        is_fine = end < 3 && strlen(word) + 1 < sizeof word && !(given >> end & 1) &&
                  number_parse(word + strlen(ends[end].key), &value) && value >= 0 && value <= 1e6;
        if (is_fine) {
            given |= 1U << end;
            memcpy((char *)out + ends[end].offset, &value, sizeof value);
        }
    }
    return (is_fine && (given & 3) == 3) ||
           refuse("--jitter: \"%s\" is not entry=MM,target=MM[,depth=MM] with numbers from 0 to 1000000", text);
}

bool settings_jitter(conus_jitter_options *out, const char *text, uint32_t samples, bool has_needles)
{
    double errors[2] = {0};
    *out = (conus_jitter_options){.samples = samples};
    if (samples & (samples - 1)) {
        print_error_line("--samples: %u is no power of two", samples);
    } else if (has_needles && strchr(text, '=')) {
        return read_ends(out, text);
    } else if (numbers_parse(errors, 2, text, ',') != 2) {
        print_error_line("--jitter: \"%s\" is not two numbers DEGREES,MM without spaces", text);
    } else if (!(errors[0] >= 0 && errors[0] <= 90)) {
        print_error_line("--jitter: a tilt of %.10g degrees is out of range, allowed is 0 to 90", errors[0]);
    } else if (!(errors[1] >= 0 && errors[1] <= 1e6)) {
        print_error_line("--jitter: a shift of %.10g mm is out of range, allowed is 0 to 1000000", errors[1]);
    } else {
        out->tilt = radians(errors[0]);
        out->shift = errors[1];
        return true;
    }
    return false;
}
