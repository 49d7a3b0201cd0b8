/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Options that several commands share, and what they ask the library for. */
#ifndef CONUS_SETTINGS_SETTINGS_H
#define CONUS_SETTINGS_SETTINGS_H

#include "options/options.h"

#include "conus/report.h"
#include "conus/streamlines.h"

struct atlases;
struct named_places;
struct tract_shelf;

struct space_settings {
    size_t name;      /* conus_space */
    double bregma[3]; /* AP, DV, ML in CCF, micrometres; 0, 0, 0 = the default */
};

struct common_settings {
    bool help, version, quiet, verbose;
};

struct atlas_settings {
    const char *labels;
    bool labels_anyway;
    double probability; /* 0 = not given */
    struct option_list pathways, streamlines;
    struct tract_shelf *shelf; /* no option: keeps what --streamlines reads; NULL = it is the atlas's alone */
    bool asks_bundles;         /* no option: bundles are asked about: --only without one keeps them all */
    size_t hemispheres;        /* conus_hemispheres */
    size_t sides;              /* 1: the first atlas is mirrored */
    struct option_list only, hide;
    struct option_list transforms;
    uint64_t max_memory;
    bool answers;                 /* no option: the context of a manifest is left out where no answer needs it */
    bool image_is_fine;           /* no option: where ATLAS is an image, nobody is told, and error_line() has why */
    struct option_list more;      /* of --atlas: atlases besides ATLAS (atlases.h) */
    conus_load_progress progress; /* no option: of programs that show it */
    void *progress_user;
};

struct aim_settings {
    const char *origin, *toward; /* places */
    double direction[3], up[3];
    const char *pose;
    const char *focus, *transducer; /* places, of a beam */
    bool inward;
    double aperture; /* mm; 0 = it is none */
    double angle;    /* degrees */
    struct space_settings space;
};

struct engine_settings {
    uint32_t resolution, slices;
    size_t aperture, engine, sampling; /* conus_aperture, conus_engine, conus_sampling */
    const char *score;                 /* a name or formula; NULL = the default */
    size_t layers;                     /* conus_layers */
    const char *level;
    struct depth_range range;
    double radius;         /* mm */
    double slice_fraction; /* 0 = not given */
    const char *weight, *prior;
    conus_weight *made;   /* of `weight`, by settings_weight(); NULL = none */
    char *weight_file[2]; /* paths in both texts, likewise; NULL = it names none */
};

/** A volume that blocks the view. */
struct context_settings {
    const char *path; /* NULL = none */
    double blocks;
};

extern const struct option context_options[]; /**< context_settings: --context, --context-blocks */

/** Volumes and surfaces that are drawn around the areas. */
struct context_choice {
    struct option_list files;
    double opacity;  /**< The surfaces'; 0 = the default. */
    const char *map; /**< FILE,array=NAME[,range=A:B]: colours of a surface; NULL = its own. */
};

extern const struct option context_choice_options[]; /**< context_choice: --context, --context-opacity */
extern const struct option map_options[];            /**< context_choice: --map */
extern const struct option quiet_options[];          /**< common_settings: --help, --version, --quiet, --verbose */
extern const struct option plain_options[];          /**< common_settings: --help, --version */
/** The words of --hemispheres, in the order of conus_hemispheres; NULL ends it. */
extern const char *const settings_hemispheres[];
/** Likewise of --engine, of conus_engine. */
extern const char *const settings_engines[];
extern const struct option atlas_options[];      /**< atlas_settings: what is read */
extern const struct option side_options[];       /**< atlas_settings: --hemispheres, --sides */
extern const struct option shown_options[];      /**< atlas_settings: --only, --hide */
extern const struct option more_atlas_options[]; /**< atlas_settings: --atlas; of commands that answer for several */
extern const struct option aim_options[];        /**< aim_settings: where from and where to */
extern const struct option beam_options[];       /**< aim_settings: --focus, --transducer */
extern const struct option aperture_options[];   /**< aim_settings: --aperture-diameter, also of files */
extern const struct option angle_options[];      /**< aim_settings: --angle */
extern const struct option pixel_options[];      /**< engine_settings: --resolution, --aperture */
extern const struct option engine_options[];     /**< engine_settings, without --slices and those */
extern const struct option shape_options[];      /**< engine_settings: --layers, --range, --radius */
extern const struct option weight_options[];     /**< engine_settings: --weight, --prior */
extern const struct option slices_options[];     /**< engine_settings: --slices of the ID pass */

/** What options are where they are not given: degrees, and poses of --jitter. */
#define DEFAULT_ANGLE 10
#define JITTER_SAMPLES 1024

/** Message for a pose that is only a point where a cone is wanted. */
#define POINT_HAS_NO_DIRECTION "a point, without the direction that a cone needs"

/** Why points, rows of a file without a direction, are not asked what is at them: the first option given that asks
 * along an axis, with what to state. "" where there is none, and with a radius. */
void settings_point_error(char out[256], const struct engine_settings *engine, const struct arguments *arguments);

/** Radius of the ball around a point, mm: the row's own (NULL: it has none), or that of --radius, or that of a point
 * where @p has_no_place for what is only near: contacts of probes, formats of other programs. 0 = there is one. */
double settings_point_radius(const struct engine_settings *engine, const conus_pose_row *row, bool has_no_place);

/** Adds how poses are asked that are no plain cones: beams, or points. *out is that; "" = they are. @p space is the one
 * that the file of points states, "" where it states none. Returns the exit code and prints an error unless it is 0. */
int settings_understood(char out[96], struct named_places *places, const struct aim_settings *aim,
                        const struct engine_settings *engine, bool has_points, bool has_radii, const char *space);

/** Whether the options that aim a cone go together; prints an error if not. @p aim_needed: there must be a cone. */
bool settings_check_aim(const struct arguments *arguments, bool aim_needed);

/** The pose at the first of two places, the values of @p options, that points at the second, which is *distance mm
 * away; @p up and @p distance may be NULL. Returns the exit code and prints an error unless it is 0. */
int settings_pose_toward(conus_pose *out, double *distance, struct named_places *places, const char *const options[2],
                         const char *const texts[2], const double up[3]);

/** The pose of --origin with --toward or --direction, or of --focus; *target is NaN where it has none. Likewise. */
int settings_pose(conus_pose *out, double *target, struct named_places *places, const struct aim_settings *settings,
                  const struct arguments *arguments);

/** What stands for a place in a help, and what a place is, behind what it is for. */
#define PLACE_VALUE "PLACE"
#define PLACE_HELP "X,Y,Z in mm, an area by name (its inner point), or a position of a cap like C3"

/** The file of areas that --level names; NULL if it names none. */
const char *settings_level_file(const struct engine_settings *settings);

/** Angle, degrees, and range of the pose of the options, whose target is so far away: of a beam those from the focus to
 * the transducer; the range ends at --toward where --range says so, and else is NaN, for that of the selector. Returns
 * the exit code and prints an error unless it is 0. */
int settings_pose_cone(double *angle, double range[2], double target, const struct aim_settings *aim,
                       const struct engine_settings *engine);

/** How the ranges of the poses of a file end: as --range says, or at the transducers of beams. */
struct depth_range settings_range(const struct aim_settings *aim, const struct engine_settings *engine);

/** --angle in degrees, or its default; of a cylinder 0. */
double settings_angle(const struct aim_settings *settings, const struct engine_settings *engine);

/** Whether angle and radius go together; prints an error if not. */
bool settings_check_shape(const struct aim_settings *settings, const struct engine_settings *engine,
                          const struct arguments *arguments);

/** Makes the weight of --weight and, where no option says so, sets the angle or radius of its own region. Returns the
 * exit code and prints an error unless it is 0; settings_weight_finish() ends both in any case. */
int settings_weight(struct aim_settings *aim, struct engine_settings *settings, const struct arguments *arguments);
void settings_weight_finish(struct engine_settings *settings);

/** Prints notes about a weight that the cone cuts off, or that few rays share, unless --quiet. */
void settings_say_weight(const struct aim_settings *aim, const struct engine_settings *settings,
                         const struct common_settings *common);

/** Whether there is such a score, and what it needs; prints an error if not. */
bool settings_check_score(const struct engine_settings *settings, bool has_history);

/** The options of the library for the engine; a beam of @p aim, NULL = none, has all layers. @p common chooses whether
 * it logs. */
conus_selector_options settings_engine(const struct engine_settings *settings, const struct aim_settings *aim,
                                       const struct common_settings *common);

/** Lists the scores and what they mean, and the published errors, for --help. */
void help_scores(FILE *out);
void help_errors(FILE *out);

struct axis_settings {
    const char *segments, *clearance; /* NULL = not asked for */
    size_t order;                     /* conus_order */
    const char *contacts;
};

extern const struct option axis_options[]; /**< axis_settings */

/** Message for a pose that is only a point where an axis is wanted. */
#define POINT_HAS_NO_AXIS "a point, without the direction that an axis needs"

/** mm of --clearance where its key does not say others. */
enum { CLEARANCE_WITHIN = 10 };

/** Reads --contacts; the count is 0 if it was not given (NULL). Returns the exit code and prints an error unless it is
 * 0. */
int settings_contacts(conus_contacts *out, const char *text);

/** Finds the published error that --jitter names. False where it names none: then it prints an error, unless @p text is
 * no name. @p has_needles: errors of needles are known, too. */
bool settings_error(conus_pose_error *out, const char *text, bool has_needles);

/** Reads --jitter (DEGREES,MM or, with @p has_needles, the errors of both ends) and checks --samples; prints an error
 * where one is wrong. */
bool settings_jitter(conus_jitter_options *out, const char *text, uint32_t samples, bool has_needles);

extern const struct option space_options[]; /**< space_settings */

/** Whether the options go together; prints an error if not. */
bool space_settings_check(const struct arguments *arguments, const struct space_settings *settings);

/** Whether positions are found only once the atlas is loaded. */
bool space_settings_needs_atlas(const struct space_settings *settings);

/** Finds where the space lies in all of the @p atlases, which must be one place. Returns the exit code and prints an
 * error unless it is 0; unless @p quiet, says where the atlas calls the right side left. */
int space_settings_frame(conus_frame *out, const struct atlases *atlases, const struct space_settings *settings,
                         bool quiet);

#endif
