/* SPDX-License-Identifier: BSD-3-Clause */
/* The tables of options that several commands share, and what they mean for the library. */
#include "settings/settings.h"

#include "base/text.h"
#include "conus/own.h"
#include "options/messages.h"
#include "options/options.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char *const apertures[] = {"circle", "square", NULL};
const char *const settings_engines[] = {"auto", "rays", "gl", NULL};
static const char *const samplings[] = {"exact", "slices", NULL};
static const char *const sides[] = {"as-is", "exchanged", NULL};
const char *const settings_hemispheres[] = {"as-is", "split", "merged", NULL};
static const char *const layers[] = {"visible", "all", NULL};

/* The last rows of every command. */
#define HELP_AND_VERSION                                                                                               \
    {OPTION_NAMED("help", struct common_settings, help), .letter = 'h', .help = "this text; -h is the short one",      \
     .role = OPTION_ENDS},                                                                                             \
    {                                                                                                                  \
        OPTION_NAMED("version", struct common_settings, version), .help = "the version", .role = OPTION_ENDS           \
    }

const struct option plain_options[] = {
    HELP_AND_VERSION,
    {0},
};

const struct option quiet_options[] = {
    {OPTION_NAMED("quiet", struct common_settings, quiet), .letter = 'q',
     .help = "print only errors and warnings on stderr, no notes", .role = OPTION_OF_RUN},
    {OPTION_NAMED("verbose", struct common_settings, verbose), .letter = 'v',
     .help = "print the engine's and the GL driver's messages, too, on stderr", .role = OPTION_OF_RUN},
    HELP_AND_VERSION,
    {0},
};

const struct option atlas_options[] = {
    {OPTION_VALUED("labels", struct atlas_settings, labels, "FILE[,label=COLUMN,name=COLUMN]"),
     .help = "label table; replaces the one found beside or inside the atlas; columns of a header row that are not "
             "called as usual are given by their names",
     .words = "lookup table, LUT, names", OPTION_READING(LABELS)},
    {OPTION_NAMED("labels-anyway", struct atlas_settings, labels_anyway),
     .help = "treat every value as a label, even if the volume looks like an image"},
    {OPTION_VALUED("probability", struct atlas_settings, probability, "T"),
     .help = "of an atlas of probabilities: a voxel belongs to an area with a probability of at least T",
     .otherwise = "0.25, or as the manifest says; to give T says that the values are probabilities",
     OPTION_ABOVE_TO(0, 1)},
    {OPTION_VALUED("pathway", struct atlas_settings, pathways, "FILE[,KEY=VALUE]..."),
     .help =
         "add a scalar map as a pathway; keys: threshold=T (voxels with values of at least T belong to it; default a "
         "quarter of the file's scale), name=S, unit=S (what its values are: z, % signal change), volume=K (of a 4-D "
         "file, from 0); "
         "or as several, each a band of values: band=LOW:HIGH:NAME (from LOW to below HIGH; either may be left out), "
         "once for each; may be repeated",
     .words = "tract, probability map", OPTION_READING(VOLUME)},
    {OPTION_VALUED("streamlines", struct atlas_settings, streamlines, "FILE[,KEY=VALUE]..."),
     .help =
         "add a tractogram as a bundle, or as one for each of its groups; keys: radius=R (a ray hits what is nearer "
         "than R mm to a streamline; default 0.5), name=S, space=ras or space=lps (the axes of a file that does not "
         "state them, as DIPY's VTK in LPS), moves (it lies where ATLAS's files do, and --atlas-transform moves it, "
         "too); may be repeated",
     .words = "fibre, fiber, tractography, tractogram", OPTION_READING(TRACTS)},
    {OPTION_VALUED("atlas-transform", struct atlas_settings, transforms, "FILE[,KEY]..."),
     .help =
         "bring the atlas to the poses: an affine (ITK, FreeSurfer, MNI, FSL, 4 x 4), a B-spline (ITK), a "
         "deformation field (ITK, SPM, FSL, MRtrix, NiftyReg, SynthMorph) or a composite of these (ITK, ANTs, X5) "
         "from their space to the atlas's; keys: from=IMAGE and to=IMAGE of FSL's, inverse (an affine from the "
         "atlas), relative or absolute (a field's vectors), space=ras or space=lps (their axes), grid=IMAGE (voxels "
         "for the labels), transform=K (number K, from 0, of a list of ITK's); may be repeated, points go through "
         "the first one first",
     .words = "warp, registration, normalise", OPTION_READING(TRANSFORM)},
    {OPTION_MEMORY(struct atlas_settings, max_memory), .help = "largest file or volume to accept, like 512M or 2G",
     .otherwise = "8G, and 1G for files of poses that are read whole", .words = "RAM"},
    {0},
};

const struct option side_options[] = {
    {OPTION_VALUED("hemispheres", struct atlas_settings, hemispheres, "HOW"),
     .help = "cut areas of both sides in two at the midline (split), or report left and right areas of one name as one "
             "(merged):",
     .choices = settings_hemispheres, .words = "left, right, side"},
    {OPTION_VALUED("sides", struct atlas_settings, sides, "HOW"),
     .help = "mirror ATLAS, whose voxels lie the other way round than its header says, as a warning tells (exchanged):",
     .choices = sides, .words = "left, right, mirror, flip"},
    {0},
};

const struct option shown_options[] = {
    {OPTION_VALUED("only", struct atlas_settings, only, "NAME,..."),
     .help = "keep only these areas, pathways and bundles, by name, abbreviation or label, with all below them in the "
             "area tree; all others are as if never loaded; put a name with a comma in double quotes; @FILE is a file "
             "with one name per line; may be repeated",
     .words = "region, ROI, filter, include", .role = OPTION_READS_NAMES, .holds = HOLDS_NAMES},
    {OPTION_VALUED("hide", struct atlas_settings, hide, "NAME,..."),
     .help = "remove these areas, pathways and bundles, named as for --only: not hit, not drawn, not occluding; may be "
             "repeated",
     .words = "exclude, remove", .role = OPTION_READS_NAMES, .holds = HOLDS_NAMES},
    {0},
};

const struct option more_atlas_options[] = {
    {OPTION_VALUED("atlas", struct atlas_settings, more, "ATLAS"),
     .help = "another atlas in the same space, a file or a name, that gets the same question; --labels, --pathway, "
             "--streamlines (except in conus connect), --only, --hide and --level apply to the first atlas only; may "
             "be repeated",
     .role = OPTION_READS_ATLAS, .holds = HOLDS_ATLAS},
    {0},
};

const struct option context_options[] = {
    {OPTION_VALUED("context", struct context_settings, path, "FILE"),
     .help = "scalar map that blocks rays, such as a skull, or in which --inward finds the head: a file, or the name "
             "of an installed image",
     .role = OPTION_READS_IMAGE, .flags = OPTION_OF_RAYS, .needs = "context-blocks|inward", .holds = HOLDS_VOLUME},
    {OPTION_VALUED("context-blocks", struct context_settings, blocks, "T"),
     .help = "context voxels with values of at least T block rays", OPTION_BETWEEN(0, FLT_MAX), .needs = "context"},
    {0},
};

const struct option context_choice_options[] = {
    {OPTION_VALUED("context", struct context_choice, files, "FILE"),
     .help = "scalar map, such as a T1, or surface, such as a scalp, to draw around the areas, in the place of a "
             "manifest's volume: a file, or the name of an installed image, ch2bet; may be repeated for more surfaces",
     .role = OPTION_READS_IMAGE, .holds = HOLDS_VOLUME},
    {OPTION_VALUED("context-opacity", struct context_choice, opacity, "O"),
     .help = "opacity of the context's surfaces, above 0 to 1",
     .otherwise = "0.25, of a surface with a map 1; to give it keeps the context", OPTION_ABOVE_TO(0, 1),
     .needs = "context"},
    {0},
};

const struct option map_options[] = {
    {OPTION_VALUED("map", struct context_choice, map, "FILE,array=NAME[,range=A:B]"),
     .help = "colour the surface of --context by an array of a GIFTI file (.func.gii, .shape.gii), from A, dark blue, "
             "to B, yellow, else the least and the largest; the surface is opaque unless --context-opacity is given",
     .words = "overlay, colours, func.gii, metric", OPTION_READING(SURFACE)},
    {0},
};

const struct option aim_options[] = {
    {OPTION_VALUED("origin", struct aim_settings, origin, PLACE_VALUE),
     .help = "position of the device, the cone's apex: " PLACE_HELP, .words = "position, apex, tip", .common = true,
     .role = OPTION_ASKS, .flags = OPTION_OF_CONE | OPTION_IS_PLACE, .excludes = "pose,poses"},
    {OPTION_VALUED("toward", struct aim_settings, toward, PLACE_VALUE),
     .help = "place at which the device points (near:AREA is the area's point nearest to the other end)",
     .words = "target", .common = true, .role = OPTION_ASKS, .flags = OPTION_OF_CONE | OPTION_IS_PLACE,
     .needs = "origin", .excludes = "direction"},
    {OPTION_VALUED("direction", struct aim_settings, direction, "X,Y,Z"),
     .help = "or direction of the axis, of any length but 0", .flags = OPTION_OF_CONE, .needs = "origin"},
    {OPTION_NAMED("inward", struct aim_settings, inward),
     .help = "or straight into the head: from a position of a cap like C3 against the scalp's normal there, elsewhere "
             "against that of the context's head within 5 mm, or else to the atlas's nearest",
     .words = "EEG, fNIRS, optode, perpendicular", .flags = OPTION_OF_CONE, .needs = "origin|pose",
     .excludes = "toward,direction"},
    {OPTION_VALUED("up", struct aim_settings, up, "X,Y,Z"), .help = "up direction of the device",
     .otherwise = "superior, or anterior if it points up or down", .flags = OPTION_OF_CONE, .needs = "origin"},
    {OPTION_VALUED("pose", struct aim_settings, pose, "FILE"),
     .help =
         "poses from a file instead, - for standard input: a table with a header, a 4x4 matrix, or what Brainsight, "
         "Localite, 3D Slicer, SimNIBS, InVesalius, Lead-DBS or BIDS write (docs/formats.md)",
     .words = "coil, trajectory, electrode, points", .common = true, .role = OPTION_READS_POSES,
     .flags = OPTION_OF_CONE, .excludes = "poses", .holds = HOLDS_POSES},
    {0},
};

const struct option stance_options[] = {
    {OPTION_MM("out", struct aim_settings, off),
     .help = "with --inward: so far off the scalp, along its normal; below 0 inside", OPTION_FROM_TO(-1000, 1000),
     .words = "distance, spacer", .flags = OPTION_OF_CONE, .needs = "inward", .excludes = "pose"},
    {OPTION_DEGREES("handle", struct aim_settings, handle),
     .help = "with --inward, at a position of a cap: the handle (the device's -y) points backwards, turned by so much "
             "to the position's side, on the midline to the left",
     .otherwise = "up is superior", OPTION_FROM_TO(-360, 360), .words = "coil, TMS, orientation",
     .flags = OPTION_OF_CONE, .needs = "inward", .excludes = "up,pose"},
    {0},
};

const struct option scalp_options[] = {
    {OPTION_VALUED("scalp", struct aim_settings, scalp, "SURFACE,nasion=X:Y:Z,inion=X:Y:Z,lpa=X:Y:Z,rpa=X:Y:Z"),
     .help = "with --inward or a list: positions of a cap are those on this scalp, a closed surface, by the landmarks "
             "on it, which is the head of the atlas; landmarks=FILE has them from a coordsystem.json of BIDS, RAS mm "
             "of the scalp, which seldom has the inion",
     .words = "head, subject, individual, EEG", .needs = "inward|from", .excludes = "pose", OPTION_READING(SURFACE)},
    {0},
};

const struct option beam_options[] = {
    {OPTION_VALUED("focus", struct aim_settings, focus, PLACE_VALUE),
     .help = "instead of a cone from the device, a beam that is wide at the device and narrow at its focus, here: "
             "the cone from the focus to the transducer, with all layers",
     .words = "ultrasound, FUS, beam", .role = OPTION_ASKS, .flags = OPTION_OF_CONE | OPTION_IS_PLACE,
     .needs = "transducer", .excludes = "origin,pose,poses,angle,radius,range,layers"},
    {OPTION_VALUED("transducer", struct aim_settings, transducer, PLACE_VALUE),
     .help = "the middle of the transducer's aperture", .role = OPTION_ASKS, .flags = OPTION_OF_CONE | OPTION_IS_PLACE,
     .needs = "focus"},
    {0},
};

const struct option aperture_options[] = {
    {OPTION_MM("aperture-diameter", struct aim_settings, aperture),
     .help = "diameter of the transducer's aperture; in a file of poses each row is a beam, from focus_x focus_y "
             "focus_z (or target_x ...) to transducer_x transducer_y transducer_z",
     OPTION_BETWEEN(0, 1e6), .flags = OPTION_OF_CONE, .needs = "focus|pose|poses",
     .excludes = "origin,angle,radius,range,layers"},
    {0},
};

const struct option angle_options[] = {
    {OPTION_DEGREES("angle", struct aim_settings, angle),
     .help = "full opening angle of the cone, more than 0 and less than 180", .standard = OPTION_DIGITS(DEFAULT_ANGLE),
     .words = "width, opening", .common = true, .flags = OPTION_OF_CONE},
    {0},
};

const struct option pixel_options[] = {
    {OPTION_VALUED("aperture", struct engine_settings, aperture, "SHAPE"),
     .help = "pixels that count: those in the circle, or all:", .choices = apertures, .flags = OPTION_OF_RAYS},
    {0},
};

const struct option engine_options[] = {
    {OPTION_VALUED("engine", struct engine_settings, engine, "NAME"),
     .help = "rays on the CPU or an OpenGL pass, with the same hits; auto is rays in this program:",
     .choices = settings_engines, .flags = OPTION_OF_RAYS},
    {OPTION_VALUED("sampling", struct engine_settings, sampling, "KIND"),
     .help = "visit every voxel along a ray, or only planes across the view, which can miss thin objects:",
     .choices = samplings, .flags = OPTION_OF_RAYS},
    {OPTION_VALUED("slice-fraction", struct engine_settings, numbers.slice_fraction, "F"),
     .help = "with --sampling slices: part of the picture's slices that the selection takes, more than 0 to 1; the "
             "paper takes a fifth",
     .standard = "0.2", OPTION_ABOVE_TO(0, 1), .flags = OPTION_OF_RAYS, .needs = "sampling=slices"},
    {OPTION_VALUED("level", struct engine_settings, level, "N|AREA,..."),
     .help =
         "report areas rolled up the area tree: to depth N (roots have 1), or to the nearest of these areas, by name, "
         "abbreviation or label; put a name with a comma in double quotes; @FILE is a file with one area per line",
     .words = "hierarchy, ontology", .role = OPTION_READS_NAMES, .holds = HOLDS_NAMES},
    {OPTION_VALUED("score", struct engine_settings, score, "FORMULA"),
     .help = "score that ranks the objects: a name below, or a formula like 0.5*share+0.5*centre", .standard = "share",
     .words = "sort, rank", .role = OPTION_ASKS, .flags = OPTION_OF_RAYS},
    {0},
};

const struct option shape_options[] = {
    {OPTION_VALUED("layers", struct engine_settings, layers, "WHICH"),
     .help = "first hits only, or all hits in the cone with path lengths, volumes and values:", .choices = layers,
     .words = "behind, occluded, depth", .flags = OPTION_OF_RAYS},
    {OPTION_VALUED("range", struct engine_settings, range.ends, "NEAR,FAR|NEAR,target[+MM]"),
     .help = "count only between these two depths along the axis, mm from the apex: a focal spot, the length of a "
             "probe; target is the point of --toward or of each pose's row, or MM behind it",
     OPTION_FROM_TO(0, 1e9), .flags = OPTION_OF_CONE | OPTION_TO_TARGET, .unit = "mm"},
    {OPTION_MM("radius", struct engine_settings, radius),
     .help = "radius of a cylinder that replaces the cone, mm, more than 0: a needle, a probe", OPTION_BETWEEN(0, 1e9),
     .words = "cylinder, needle, sphere, ball, within"},
    {0},
};

const struct option weight_options[] = {
    {OPTION_VALUED("weight", struct engine_settings, weight, "FORM|FILE[,bias=X:Y][,above=LEVEL]"),
     .help =
         "weigh the cone: hard (all alike), gauss=DEGREES (as a hand or tracker is off by so much about each of two "
         "axes, 0.01 to 20, or gauss=vr-controller:W, a published error, of a target W degrees wide; the cone opens to "
         "8 times as much unless --angle says otherwise), coil=D:W (mm; half every D of depth, and W off the axis), "
         "focus=F:L:A (mm; F deep, half its largest L wide and A long), fibre=R:NA[:S:K:N] (mm, and per mm: light in "
         "tissue), or a table with columns weight and angle_deg, offset_mm or distance_mm, and perhaps depth_mm; what "
         "depends on the depth brings --layers all and its own region; bias: the device points X degrees to its right "
         "and Y up of what is meant; above: a weight, P% of the largest in the cone or P%area of the largest in areas, "
         "from which on volume counts as above (50%area)",
     .words = "soft, Gaussian, uncertainty, pointing, VR, dose, field, TMS, ultrasound, optogenetics, light",
     .role = OPTION_READS_NAMES, .holds = HOLDS_TEXT},
    {OPTION_VALUED("prior", struct engine_settings, prior, "equal|size|FILE[,power=G]"),
     .help = "with --weight, how probable it is that each object is meant: each object as often, each direction as "
             "often, or as a table with columns name or index, and prior, says (1 of others); G is the exponent of "
             "likelihoods, 0.01 to 100",
     .otherwise = "equal, where --score needs it", .words = "Bayes, posterior, intention", .role = OPTION_READS_NAMES,
     .flags = OPTION_OF_CONE | OPTION_OF_RAYS, .needs = "weight", .holds = HOLDS_TEXT},
    {0},
};

const struct option slices_options[] = {
    {OPTION_VALUED("slices", struct engine_settings, numbers.slices, "N"),
     .help = "with --sampling slices: slices of the picture; the selection takes --slice-fraction of them",
     .otherwise = "sqrt(2) times the longest edge of the volume", OPTION_FROM_TO(1, 65536), .flags = OPTION_OF_RAYS,
     .needs = "sampling=slices"},
    {0},
};

void settings_point_error(char out[256], const struct engine_settings *engine, const struct arguments *arguments)
{
    static const char *const of_axis[] = {"angle",    "layers",    "range", "aperture-diameter",
                                          "segments", "clearance", "image", "jitter"};
    out[0] = '\0';
    for (size_t i = 0; i < sizeof of_axis / sizeof of_axis[0] && engine->radius == 0 && !out[0]; i++) {
        bool is_known = option_find(arguments->command, of_axis[i]);
        if (is_known && (option_given(arguments, of_axis[i]) || option_restated(arguments, of_axis[i]))) {
            snprintf(out, 256,
                     "a point, without the direction that --%s needs: columns tx, ty, tz (a target) or dx, dy, dz "
                     "state one%s; without --%s conus says what is at the point",
                     of_axis[i], option_find(arguments->command, "inward") ? ", or --inward, into the head" : "",
                     of_axis[i]);
        }
    }
}

double settings_point_radius(const struct engine_settings *engine, const conus_pose_row *row, bool has_no_place)
{
    double radius = row && !isnan(row->radius) ? row->radius : engine->radius;
    return radius == 0 && has_no_place ? CONUS_POINT_RADIUS : radius;
}

int settings_understood(char out[96], struct named_places *places, const struct aim_settings *aim,
                        const struct engine_settings *engine, bool has_points, bool has_radii, const char *space)
{
    const char *where = space[0] || aim->space.name >= CONUS_SPACE_CCF ? "" : " in the atlas's space";
    out[0] = '\0';
    if (aim->aperture > 0) {
        snprintf(out, 96, "asked as a beam: from its focus to the transducer, %g mm wide there", aim->aperture);
    } else if (has_points && has_radii) {
        snprintf(out, 96, "asked as points%s: what is within each row's radius of it", where);
    } else if (has_points && engine->radius > 0) {
        snprintf(out, 96, "asked as points%s: what is within %g mm of each", where, engine->radius);
    } else if (has_points) {
        snprintf(out, 96, "asked as points%s: what is at each, or else nearest to it", where);
    }
    return out[0] ? named_places_add(places, "", out, NULL) : EXIT_DONE;
}

bool settings_check_aim(const struct arguments *arguments, bool aim_needed)
{
    const struct command *command = arguments->command;
    bool has_origin = option_given(arguments, "origin");
    bool is_inward = option_find(command, "inward") && option_given(arguments, "inward");
    if (option_find(command, "focus") && option_given(arguments, "focus")) {
        return option_given(arguments, "aperture-diameter") ||
               refuse("--focus needs --aperture-diameter MM with it: how wide the beam is at the transducer");
    }
    if (has_origin && !option_given(arguments, "toward") && !option_given(arguments, "direction") && !is_inward) {
        return refuse("--origin needs --toward PLACE or --direction X,Y,Z%s with it",
                      option_find(command, "inward") ? ", or --inward," : "");
    }
    if (!has_origin && aim_needed && !option_given(arguments, "pose")) {
        return refuse("no cone given: --origin PLACE with --toward PLACE or --direction X,Y,Z, or --pose FILE%s",
                      option_find(command, "point") ? "; or no point: --point PLACE" : "");
    }
    return true;
}

int settings_pose_toward(conus_pose *out, double *distance, struct named_places *places, const char *const options[2],
                         const char *const texts[2], const double up[3])
{
    double from[3];
    double to[3];
    double above[3];
    int code = named_places_find_ends(from, to, places, options, texts);
    if (code) {
        return code;
    }
    if (up) {
        conus_frame_direction_to_world(above, places->frame, up);
    }
    if (distance) {
        *distance = hypot(hypot(to[0] - from[0], to[1] - from[1]), to[2] - from[2]);
    }
    return print_status(conus_pose_toward(out, from, to, up ? above : NULL));
}

conus_position_options settings_stance(const struct aim_settings *settings, const struct arguments *arguments)
{
    const bool has_handle = option_find(arguments->command, "handle") && option_given(arguments, "handle");
    return (conus_position_options){.off = settings->off, .handle = settings->handle, .has_handle = has_handle};
}

/* Warns of landmarks that lie off the scalp: its nearest points move all positions. */
static conus_status warn_of_landmarks(const conus_scalp *scalp, const double landmarks[4][3])
{
    static const char *const names[] = {"Nz", "Iz", "LPA", "RPA"};
    static const double FAR = 5; /* mm; what a finger or a click in a scan misses by */
    conus_table *on = NULL;
    conus_status status = conus_positions(&on, names, 4, &(conus_position_options){.scalp = scalp});
    for (size_t k = 0; k < 4 && !status; k++) {
        const double *p = landmarks[k];
        const double mm = hypot(hypot(conus_table_numbers(on, "x")[k] - p[0], conus_table_numbers(on, "y")[k] - p[1]),
                                conus_table_numbers(on, "z")[k] - p[2]);
        if (mm > FAR) {
            say_note(CONUS_SEVERITY_WARNING, false,
                     "--scalp: %s lies %.0f mm from the surface, and its nearest point is taken: positions may be as "
                     "far off",
                     names[k], mm);
        }
    }
    conus_table_destroy(on);
    return status;
}

int settings_scalp(conus_scalp **out, char *paths[2], const struct aim_settings *settings, const conus_frame *frame)
{
    static const char *const names[] = {"nasion", "inion", "lpa", "rpa"};
    struct source_keys keys;
    double landmarks[4][3] = {{NAN}, {NAN}, {NAN}, {NAN}};
    conus_status status = CONUS_OK;
    if (!settings->scalp) {
        return EXIT_DONE;
    }
    paths[0] = text_copy(settings->scalp, strlen(settings->scalp));
    if (!option_cut_keys(&keys, "scalp", paths[0], KEYS_SCALP)) {
        return EXIT_USAGE;
    }
    if (keys.given & KEY_BIT(KEY_NAME)) {
        const char *file = keys_string(&keys, KEY_NAME);
        paths[1] = text_copy(file, strlen(file));
        status = paths[1] ? conus_landmarks_load(landmarks, paths[1]) : CONUS_ERROR_MEMORY;
    }
    for (int k = 0; k < 4 && !status; k++) {
        const enum source_key_id id = (enum source_key_id)(KEY_NASION + k);
        if (keys.given & KEY_BIT(id)) {
            memcpy(landmarks[k], keys_value(&keys, id)->numbers, sizeof landmarks[k]);
            status = frame ? conus_frame_to_world(landmarks[k], frame, landmarks[k]) : CONUS_OK;
        } else if (isnan(landmarks[k][0])) {
            return print_usage_error("--scalp: %s is missing%s%s: SURFACE,nasion=X:Y:Z,inion=X:Y:Z,lpa=X:Y:Z,rpa=X:Y:Z",
                                     names[k], paths[1] ? " in " : "", paths[1] ? paths[1] : "");
        }
    }
    status = status ? status : conus_scalp_load(out, paths[0], (const double(*)[3])landmarks);
    return print_status(status ? status : warn_of_landmarks(*out, (const double(*)[3])landmarks));
}

/* The root mean square distance, mm, of the scalp's positions from those of MNI 152. */
static conus_status find_distance(double *out, const conus_scalp *scalp)
{
    static const char *const names[] = {"Cz", "C3", "C4", "Fz", "Pz", "Oz"};
    enum { COUNT = sizeof names / sizeof *names };
    conus_table *tables[2] = {NULL, NULL};
    double sum = 0;
    conus_status status = conus_positions(&tables[0], names, COUNT, &(conus_position_options){.scalp = scalp});
    status = status ? status : conus_positions(&tables[1], names, COUNT, NULL);
    for (size_t i = 0; i < 3 * COUNT && !status; i++) {
        const char *axis = (const char *const[]){"x", "y", "z"}[i / COUNT];
        const double way =
            conus_table_numbers(tables[0], axis)[i % COUNT] - conus_table_numbers(tables[1], axis)[i % COUNT];
        sum += way * way;
    }
    conus_table_destroy(tables[0]);
    conus_table_destroy(tables[1]);
    *out = sqrt(sum / COUNT);
    return status;
}

int settings_scalp_match(const conus_scalp *scalp, const struct atlases *atlases, bool any_space, bool quiet)
{
    /* Twice the 9.9 mm by which electrodes of one person are off in MNI space ("eeg-cap"); Colin 27's scalp: 3.6 mm. */
    static const double BOUND = 20;
    double mm = 0;
    conus_status status = scalp ? find_distance(&mm, scalp) : CONUS_OK;
    for (size_t i = 0; i < atlases->count && scalp && !any_space && !status; i++) {
        char name[ATLAS_PREFIX_SIZE];
        const conus_brain_view brain = conus_atlas_brain(atlases->items[i].atlas);
        const bool is_other = brain.brain == CONUS_BRAIN_TEMPLATE;
        atlases_prefix(name, &atlases->items[i]);
        if (brain.brain > CONUS_BRAIN_OWN && (is_other || mm > BOUND)) {
            return print_data_error(
                "--scalp: %sits positions lie %.0f mm from those of MNI 152 in the mean%s: is it somebody's own head? "
                "The atlas is %s; --atlas-transform FILE brings it to that head, ',template=none' behind ATLAS says "
                "that it is of that head, --any-space that the scalp lies in the atlas's space",
                name, mm, is_other ? "" : ", allowed are 20", brain.words);
        }
        say_note(CONUS_SEVERITY_NOTE, quiet || brain.brain,
                 "--scalp: %snothing says whose head the atlas is of; it is "
                 "taken to be of this one",
                 name);
        say_note(CONUS_SEVERITY_NOTE, quiet || brain.brain <= CONUS_BRAIN_OWN,
                 "--scalp: %sits positions lie %.0f mm from those of MNI 152 in the mean; it is taken to lie in the "
                 "atlas's space (%s)",
                 name, mm, brain.words);
    }
    return print_status(status);
}

void settings_say_handle(const struct arguments *arguments, const struct engine_settings *engine,
                         const struct common_settings *common)
{
    const bool has_side =
        engine->aperture == CONUS_APERTURE_SQUARE || (engine->weight && strstr(engine->weight, "bias="));
    say_note(
        CONUS_SEVERITY_NOTE,
        common->quiet || has_side || !option_find(arguments->command, "handle") || !option_given(arguments, "handle"),
        "--handle turns the device about its axis, which a round cone does not see: numbers differ only as its rays "
        "do; --aperture square and a bias of --weight see it");
}

/* The direction into the head at the place that was found last: that of a position's table, else the head's. */
static int find_inward(double along[3], struct named_places *places, const double from[3])
{
    static const char *const words[] = {"against the normal of the context's surfaces within 5 mm",
                                        "against the normal of the head in the context's image within 5 mm",
                                        "to the nearest point of the atlas's convex hull"};
    const conus_place *place = places->count ? &places->items[places->count - 1].place : NULL;
    const bool is_position = place && place->kind == CONUS_PLACE_POSITION;
    if (!is_position && places->scalp) {
        return print_usage_error("--scalp has no effect without a position of a cap, like C3, in --origin");
    }
    if (!is_position) {
        conus_inward found;
        conus_status status = conus_atlas_inward(along, &found, places->atlas, from);
        if (status) {
            print_error_line("--inward: %s; --toward PLACE or --direction X,Y,Z says where to", conus_message());
            return exit_code_of(status);
        }
        return named_places_add(places, "inward", words[found], NULL);
    }
    for (int a = 0; a < 3; a++) {
        along[a] = 0 - place->outward[a];
    }
    return along[0] != 0 || along[1] != 0 || along[2] != 0
               ? EXIT_DONE
               : print_usage_error(
                     "--inward: the table of positions has no normal for %s; --toward PLACE says where to",
                     place->name);
}

/* The pose of a device with a handle, at the position that was found last. */
static int find_stance(conus_pose *out, const struct named_places *places, const conus_position_options *stance)
{
    const conus_place *place = places->count ? &places->items[places->count - 1].place : NULL;
    return place && place->kind == CONUS_PLACE_POSITION
               ? print_status(conus_position_pose(out, place, stance))
               : print_usage_error("--handle needs a position of a cap, like C3, which has a side");
}

int settings_pose(conus_pose *out, double *target, struct named_places *places, const struct aim_settings *settings,
                  const struct arguments *arguments)
{
    const double *up = option_given(arguments, "up") ? settings->up : NULL;
    const bool is_beam = settings->focus;
    const conus_position_options stance = settings_stance(settings, arguments);
    double from[3];
    double along[3];
    double above[3];
    int code;
    *target = NAN;
    if (is_beam || option_given(arguments, "toward")) {
        code = settings_pose_toward(
            out, target, places, (const char *const[]){is_beam ? "focus" : "origin", is_beam ? "transducer" : "toward"},
            (const char *const[]){is_beam ? settings->focus : settings->origin,
                                  is_beam ? settings->transducer : settings->toward},
            is_beam ? NULL : up);
    } else {
        code = named_places_find(from, places, "origin", settings->origin, NULL);
        conus_frame_direction_to_world(along, places->frame, settings->direction);
        code = code || !settings->inward ? code : find_inward(along, places, from);
        conus_frame_direction_to_world(above, places->frame, settings->up);
        const double length = code ? 1 : hypot(hypot(along[0], along[1]), along[2]);
        for (int a = 0; a < 3 && !code && settings->inward; a++) {
            from[a] -= stance.off * along[a] / length;
        }
        code = code                ? code
               : stance.has_handle ? find_stance(out, places, &stance)
                                   : print_status(conus_pose_along(out, from, along, up ? above : NULL));
    }
    if (!code) {
        conus_frame_turn_pose(out, places->frame, up != NULL || stance.has_handle);
    }
    return code;
}

struct depth_range settings_range(const struct aim_settings *aim, const struct engine_settings *engine)
{
    return aim->aperture > 0 ? (struct depth_range){.to_target = true} : engine->range;
}

int settings_pose_cone(double *angle, double out[2], double target, const struct aim_settings *aim,
                       const struct engine_settings *engine)
{
    const struct depth_range range = settings_range(aim, engine);
    *angle = settings_angle(aim, engine);
    out[0] = out[1] = NAN;
    if (!range.to_target) {
        return EXIT_DONE;
    }
    if (isnan(target)) {
        return print_usage_error("--range NEAR,target needs the target of --toward PLACE");
    }
    out[0] = range.ends[0];
    out[1] = range.beyond + target;
    *angle = aim->aperture > 0 ? 2 * atan(aim->aperture / 2 / target) * (180 / M_PI) : *angle;
    if (!(out[0] < out[1])) {
        return print_usage_error("--range: the target is %.10g mm away, and NEAR is %.10g", target, out[0]);
    }
    return EXIT_DONE;
}

const char *settings_level_file(const struct engine_settings *settings)
{
    const char *level = settings->level;
    return level && level[0] == '@' && !strchr(level, ',') ? level + 1 : NULL;
}

double settings_angle(const struct aim_settings *settings, const struct engine_settings *engine)
{
    return engine->radius > 0 ? 0 : settings->angle != 0 ? settings->angle : DEFAULT_ANGLE;
}

bool settings_check_shape(const struct aim_settings *settings, const struct engine_settings *engine,
                          const struct arguments *arguments)
{
    bool is_given = option_given(arguments, "angle");
    if (engine->radius > 0) {
        option_warn_restated(arguments, "angle", option_given(arguments, "radius") ? "radius" : "weight");
    }
    if (is_given && engine->radius > 0 && settings->angle != 0) {
        return refuse("--radius makes a cylinder, whose --angle is 0");
    }
    if (is_given && engine->radius == 0 && !(settings->angle > 0 && settings->angle < 180)) {
        return refuse("--angle: %.10g is out of range, allowed is more than 0 and less than 180%s", settings->angle,
                      settings->angle == 0 ? "; 0 goes with --radius" : "");
    }
    return true;
}

/* Sets the angle or radius, the depths and the layers of the weight's own region, where no option says so. */
static int settings_weight_region(struct aim_settings *aim, struct engine_settings *settings,
                                  const struct arguments *arguments)
{
    const double angle = conus_weight_angle(settings->made);
    const double radius = conus_weight_radius(settings->made);
    const bool has_depth = conus_weight_needs_layers(settings->made);
    const bool has_angle = option_given(arguments, "angle") && aim->angle != 0;
    double range[2];
    if (!isnan(angle) && settings->radius > 0) {
        return print_usage_error("--weight: an angle needs a cone, and --radius makes a cylinder");
    }
    if (!isnan(radius) && has_angle && !has_depth) {
        return print_usage_error("--weight: an offset needs a cylinder, and --angle makes a cone");
    }
    if (aim->aperture > 0 && (has_depth || !isnan(radius))) {
        return print_usage_error("--weight: its depths and mm are from the device, and a beam is a cone that "
                                 "begins at its focus");
    }
    if ((has_depth || !isnan(radius)) && !option_find(arguments->command, "radius")) {
        return print_usage_error("--weight: conus %s needs one of directions: hard, gauss, or a table by angle_deg",
                                 arguments->command->name);
    }
    if (has_depth && option_restated(arguments, "layers")) { /* visible */
        return print_usage_error("--weight: it depends on the depth, which needs --layers all");
    }
    if (!isnan(angle) && !option_given(arguments, "angle")) {
        option_warn_restated(arguments, "angle", "weight");
        aim->angle = angle;
    }
    if (!isnan(radius) && settings->radius == 0 && !has_angle) {
        settings->radius = radius;
    }
    if (has_depth) {
        settings->layers = CONUS_LAYERS_ALL;
    }
    if (conus_weight_range(range, settings->made) && !option_given(arguments, "range")) {
        memcpy(settings->range.ends, range, sizeof range);
    }
    return EXIT_DONE;
}

/* The largest W at a distance from the axis. */
static double largest_along(const conus_weight *weight, double side, const double range[2])
{
    enum { STEPS = 64 };
    double largest = 0;
    for (int i = 0; i <= STEPS; i++) {
        largest = fmax(largest, conus_weight_at(weight, side, range[0] + (range[1] - range[0]) * i / STEPS));
    }
    return largest;
}

int settings_weight(struct aim_settings *aim, struct engine_settings *settings, const struct arguments *arguments)
{
    const char *const texts[] = {settings->weight, settings->prior};
    for (size_t i = 0; i < 2; i++) {
        const size_t length = texts[i] ? conus_weight_path_length(texts[i]) : 0;
        settings->weight_file[i] = length ? text_copy(texts[i], length) : NULL;
        if (length && !settings->weight_file[i]) {
            return print_no_memory();
        }
    }
    if (!settings->weight) {
        return EXIT_DONE;
    }
    conus_status status = conus_weight_create(&settings->made, settings->weight);
    if (status) {
        return status == CONUS_ERROR_ARGUMENT ? print_usage_error("--weight: %s", conus_message())
                                              : print_status(status);
    }
    return settings_weight_region(aim, settings, arguments);
}

/* The longest edge of voxels of areas, mm; 0 where there are none. */
static double longest_edge(const conus_atlas *atlas)
{
    const conus_volume_info *info;
    double longest = 0;
    for (size_t i = 0; (info = conus_atlas_volume(atlas, i)); i++) {
        for (size_t a = 0; a < 3 && info->role == CONUS_ROLE_PARCELLATION; a++) {
            longest = fmax(longest, info->spacing[a]);
        }
    }
    return longest;
}

void settings_say_weight(const struct aim_settings *aim, const struct engine_settings *settings,
                         const struct common_settings *common, const conus_atlas *atlas)
{
    if (!settings->made) {
        return;
    }
    const double finest = conus_weight_finest(settings->made);
    if (finest < longest_edge(atlas) / 2) {
        say_note(
            CONUS_SEVERITY_NOTE, common->quiet,
            "the weight changes within %.2g mm, and voxels are %.3g mm long: a voxel counts whole, so doses at the "
            "rim are coarse",
            finest, longest_edge(atlas));
    }
    const double sigma = conus_weight_sigma(settings->made);
    const double angle = settings_angle(aim, settings);
    const uint32_t resolution = settings->numbers.resolution ? settings->numbers.resolution : CONUS_RESOLUTION_DEFAULT;
    const double pixels = sigma * resolution / angle;
    const bool is_cone = settings->radius == 0;
    const double own = is_cone ? conus_weight_angle(settings->made) : conus_weight_radius(settings->made);
    const bool is_slanted = is_cone && !isnan(conus_weight_radius(settings->made)); /* mm, whatever the depth */
    const double side = is_slanted ? INFINITY : is_cone ? angle / 2 : settings->radius;
    const double corner = settings->aperture == CONUS_APERTURE_SQUARE ? sqrt(2) * side : side; /* or a bit less */
    const double *range = settings->range.ends;
    const double largest = conus_weight_largest(settings->made, corner, range);
    const double rim = isnan(own) ? 0 : largest_along(settings->made, side, range) / largest;
    const double end =
        range[1] > 0 && conus_weight_needs_layers(settings->made)
            ? conus_weight_largest(settings->made, corner, (const double[]){range[1], range[1]}) / largest
            : 0;
    const char *shape = is_cone                                                    ? "cone"
                        : strcmp(conus_weight_region(settings->made), "ball") == 0 ? "ball"
                                                                                   : "cylinder";
    if (sigma > 0 && pixels < 2) {
        say_note(
            CONUS_SEVERITY_NOTE, common->quiet,
            "the weight is narrow: its standard deviation is %.2g pixels; a smaller --angle or a larger --resolution "
            "has more",
            pixels);
    }
    if (largest == 0) {
        say_note(CONUS_SEVERITY_WARNING, common->quiet,
                 "the weight is 0 everywhere in a %s of %g %s: no object has one", shape, is_cone ? angle : side,
                 is_cone ? "degrees" : "mm");
    } else if (rim > 0.05) {
        char fills[64];
        const bool is_table = settings->weight_file[0];
        snprintf(fills, sizeof fills, is_table ? "its table ends at %g %s" : "it fills %g %s",
                 is_cone && is_table ? own / 2 : own, is_cone ? "degrees" : "mm");
        say_note(CONUS_SEVERITY_NOTE, common->quiet,
                 "at the rim of the %s the weight is %.0f %% of its largest, and beyond nothing counts; %s", shape,
                 100 * rim, fills);
    } else if (end > 0.05) {
        say_note(CONUS_SEVERITY_NOTE, common->quiet,
                 "at the far end of the range, %g mm, the weight is %.0f %% of its largest, and beyond nothing counts",
                 range[1], 100 * end);
    }
    if (largest > 0 && settings->layers == CONUS_LAYERS_ALL && range[1] == 0 && shape[0] != 'b' &&
        !settings->range.to_target) {
        say_note(CONUS_SEVERITY_NOTE, common->quiet,
                 "the region has no far end, so doses have no share; --range NEAR,FAR ends it");
    }
}

void settings_weight_finish(struct engine_settings *settings)
{
    conus_weight_destroy(settings->made);
    free(settings->weight_file[0]);
    free(settings->weight_file[1]);
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
    if (score.needs_weight && !settings->weight) {
        return refuse("--score: %s needs --weight, which conus query and conus batch have", score.name);
    }
    if (score.needs_layers && settings->layers != CONUS_LAYERS_ALL) {
        return refuse("--score: %s needs --layers all", score.name);
    }
    return true;
}

conus_selector_options settings_engine(const struct engine_settings *settings, const struct aim_settings *aim,
                                       const struct common_settings *common)
{
    conus_selector_options options = settings->numbers;
    options.engine = (conus_engine)settings->engine;
    options.aperture = (conus_aperture)settings->aperture;
    options.sampling = (conus_sampling)settings->sampling;
    options.layers = aim && aim->aperture > 0 ? CONUS_LAYERS_ALL : (conus_layers)settings->layers;
    options.range[0] = settings->range.to_target ? 0 : settings->range.ends[0];
    options.range[1] = settings->range.ends[1];
    options.radius = settings->radius;
    options.level = settings->level;
    options.score = settings->score;
    options.weight = settings->made;
    options.prior = settings->prior;
    options.log = common->verbose ? log_line : log_note_quiet;
    return options;
}

void help_scores(FILE *out)
{
    const conus_score_info *score;
    fputs("Scores, the higher the better; a formula joins them with numbers, + - * / and parentheses\n", out);
    for (size_t i = 0; (score = conus_score(i)); i++) {
        fprintf(out, "  %-26s  %s%s%s%s\n", score->name, score->description,
                score->needs_history ? " (conus track)" : "", score->needs_layers ? " (--layers all)" : "",
                score->needs_weight ? " (--weight)" : "");
    }
}

void help_errors(FILE *out)
{
    conus_table *errors = NULL;
    if (conus_list_choices(&errors, "errors")) {
        return;
    }
    const double *tilt = conus_table_numbers(errors, "tilt_deg");
    const double *shift = conus_table_numbers(errors, "shift_mm");
    const double *entry = conus_table_numbers(errors, "entry_mm");
    const double *target = conus_table_numbers(errors, "target_mm");
    fputs("Published errors of --jitter, with standard deviations per axis\n", out);
    for (size_t i = 0; i < conus_table_rows(errors); i++) {
        fprintf(out, "  %-19s ", conus_table_texts(errors, "name")[i]);
        if (entry[i] > 0) {
            fprintf(out, " entry %.2f mm, target %.2f mm (conus plan)", entry[i], target[i]);
        } else if (shift[i] > 0) {
            fprintf(out, " %.2f mm", shift[i]);
        }
        if (tilt[i] > 0) {
            fprintf(out, "%s %.2f degrees", shift[i] > 0 ? "," : "", tilt[i]);
        }
        fputs("\n", out);
    }
    fputs("  vr-controller:W          that of a target W degrees wide; above W is 4\n", out);
    conus_table_destroy(errors);
}

static const char *const orders[] = {"rank", "depth", NULL};

const struct option axis_options[] = {
    {OPTION_VALUED("segments", struct axis_settings, segments, "FILE"),
     .help = "write what the axis passes, in order of depth: a row for each stretch inside an area, pathway or "
             "bundle, or between them; beside the answer, or - in its place",
     .words = "probe, shank, track", .role = OPTION_WRITES_ROWS, .flags = OPTION_OF_CONE, .holds = HOLDS_ROWS},
    {OPTION_VALUED("clearance", struct axis_settings, clearance, "FILE[,within=MM]"),
     .help = "write how far the device stays from each area, pathway and bundle, the nearest first, and where; as a "
             "needle of --radius (a cone has none) from the near to the far end of --range; up to MM away, 0 to 1000 "
             "(default 10)",
     .words = "margin, safety, needle, avoid", .role = OPTION_WRITES_ROWS, .flags = OPTION_OF_CONE,
     .keys = KEYS_CLEARANCE, .holds = HOLDS_ROWS},
    {OPTION_VALUED("order", struct axis_settings, order, "ORDER"),
     .help = "order of the rows of an answer: the best first, or the nearest (with --layers all by entry, else by "
             "distance):",
     .choices = orders, .words = "sort"},
    {OPTION_VALUED("contacts", struct axis_settings, contacts, "COUNT,COLUMNS,PITCH,TIP"),
     .help = "for --format open-ephys of shanks: COUNT contacts, COLUMNS in a row, PITCH mm from row to row, the first "
             "TIP mm from the tip; or an electrode of DIXI Medical or PMT, D08-10AM say (docs/commands.md)",
     .role = OPTION_ASKS},
    {0},
};

/* SEEG electrodes, by the catalogue numbers of DIXI Medical and PMT. A contact is 2 mm long, and the first one begins
 * at the tip: OSS-DBS and threeBrain agree; Brainstorm has the same counts and pitches, and no tip. Ad-Tech's
 * electrodes are left out: these sources differ in where the first contact is. */
static const struct {
    const char *name;
    uint32_t count;
    double pitch; /* mm */
} electrodes[] = {{"d08-05am", 5, 3.5},     {"d08-08am", 8, 3.5},     {"d08-10am", 10, 3.5},
                  {"d08-12am", 12, 3.5},    {"d08-15am", 15, 3.5},    {"d08-18am", 18, 3.5},
                  {"2102-08-091", 8, 3.5},  {"2102-10-091", 10, 3.5}, {"2102-12-091", 12, 3.5},
                  {"2102-14-091", 14, 3.5}, {"2102-16-091", 16, 3.5}, {"2102-16-092", 16, 3.97},
                  {"2102-16-093", 16, 4.43}};

int settings_contacts(conus_contacts *out, const char *text)
{
    *out = (conus_contacts){0};
    if (!text) {
        return EXIT_DONE;
    }
    for (size_t i = 0; i < sizeof electrodes / sizeof electrodes[0]; i++) {
        if (text_equal_ignoring_case(text_from(text), electrodes[i].name)) {
            *out = (conus_contacts){.count = electrodes[i].count, .columns = 1, .pitch = electrodes[i].pitch, .tip = 1};
            return EXIT_DONE;
        }
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
                                   "two lengths in mm, nor an electrode that is known, such as D08-10AM",
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

/* A word, and no numbers. */
static bool is_name(const char *text)
{
    return ((*text | ' ') >= 'a' && (*text | ' ') <= 'z') && !strchr(text, ',') && !strchr(text, '=');
}

bool settings_error(conus_pose_error *out, const char *text, bool has_needles)
{
    if (!text || !is_name(text)) {
        return false;
    }
    if (conus_pose_error_find(out, text)) {
        return refuse("--jitter: %s", conus_message());
    }
    return out->entry == 0 || has_needles ||
           refuse("--jitter: %s is an error of needles, at their entry and target; conus plan has those", out->name);
}

bool settings_jitter(conus_jitter_options *out, const char *text, uint32_t samples, bool has_needles)
{
    double errors[2] = {0};
    conus_pose_error error;
    *out = (conus_jitter_options){.samples = samples};
    if (samples & (samples - 1)) {
        print_error_line("--samples: %u is no power of two", samples);
    } else if (has_needles && strchr(text, '=')) {
        return read_ends(out, text);
    } else if (is_name(text)) {
        if (settings_error(&error, text, has_needles)) {
            *out = (conus_jitter_options){.samples = samples,
                                          .tilt = error.tilt_deg,
                                          .shift = error.shift,
                                          .entry = error.entry,
                                          .target = error.target,
                                          .depth = error.depth};
            return true;
        }
    } else if (numbers_parse(errors, 2, text, ',') != 2) {
        print_error_line("--jitter: \"%s\" is not two numbers DEGREES,MM without spaces", text);
    } else if (!(errors[0] >= 0 && errors[0] <= 90)) {
        print_error_line("--jitter: a tilt of %.10g degrees is out of range, allowed is 0 to 90", errors[0]);
    } else if (!(errors[1] >= 0 && errors[1] <= 1e6)) {
        print_error_line("--jitter: a shift of %.10g mm is out of range, allowed is 0 to 1000000", errors[1]);
    } else {
        out->tilt = errors[0];
        out->shift = errors[1];
        return true;
    }
    return false;
}
