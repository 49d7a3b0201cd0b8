/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Options that several commands and the window share, and what they ask the library for: atlases, places,
 * poses, constraints, stations. */
#ifndef CONUS_SETTINGS_SETTINGS_H
#define CONUS_SETTINGS_SETTINGS_H

#include "conus/atlas.h"
#include "conus/own.h"
#include "conus/plan.h"
#include "conus/report.h"
#include "conus/selection.h"
#include "conus/space.h"
#include "conus/streamlines.h"
#include "link/station.h"
#include "options/options.h"

#include <stdbool.h>
#include <stddef.h>

/* Options that several commands share, and what they ask the library for. A function that returns an int gives the exit
 * code, and prints an error unless that is 0; one that returns a bool and checks prints an error where it is false. */

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
    bool image_is_fine;           /* no option: where ATLAS is an image, nothing is printed, and error_line() has why */
    struct option_list more;      /* of --atlas: atlases besides ATLAS (atlases.c) */
    conus_load_progress progress; /* no option: of programs that show it */
    void *progress_user;
};

struct aim_settings {
    const char *origin, *toward; /* places */
    double direction[3], up[3];
    const char *pose;
    const char *focus, *transducer; /* places, of a beam */
    bool inward;
    double off, handle; /* of inward: mm off the scalp, degrees */
    const char *scalp;  /* with its landmarks */
    double aperture;    /* mm; 0 = it is none */
    double angle;       /* degrees */
    struct space_settings space;
};

struct engine_settings {
    conus_selector_options numbers;    /* no program looks at more than these: resolution, slices, slice_fraction */
    size_t aperture, engine, sampling; /* conus_aperture, conus_engine, conus_sampling */
    const char *score;                 /* a name or formula; NULL = the default */
    size_t layers;                     /* conus_layers */
    const char *level;
    struct depth_range range;
    double radius; /* mm */
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
extern const struct option pixel_options[];      /**< engine_settings: --aperture */
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
 * that the file of points states, "" where it states none. */
int settings_understood(char out[96], struct named_places *places, const struct aim_settings *aim,
                        const struct engine_settings *engine, bool has_points, bool has_radii, const char *space);

/** Whether the options that aim a cone go together. @p aim_needed: there must be a cone. */
bool settings_check_aim(const struct arguments *arguments, bool aim_needed);

/** The pose at the first of two places, the values of @p options, that points at the second, which is *distance mm
 * away; @p up and @p distance may be NULL. */
int settings_pose_toward(conus_pose *out, double *distance, struct named_places *places, const char *const options[2],
                         const char *const texts[2], const double up[3]);

/** The pose of --origin with --toward or --direction, or of --focus; *target is NaN where it has none. */
int settings_pose(conus_pose *out, double *target, struct named_places *places, const struct aim_settings *settings,
                  const struct arguments *arguments);

/** --out and --handle: how a device stands at a position, straight into the head. */
extern const struct option stance_options[];
extern const struct option scalp_options[];
conus_position_options settings_stance(const struct aim_settings *settings, const struct arguments *arguments);

/** Loads --scalp, whose landmarks are in the space of @p frame, NULL = the world; @p paths, its file and that of its
 * landmarks, are the caller's to free(). None where it is not given. */
int settings_scalp(conus_scalp **out, char *paths[2], const struct aim_settings *settings, const conus_frame *frame);

/** Refuses a scalp (NULL = none) that cannot be the head of an atlas: of a person's template where its positions are
 * far from those of MNI 152, of another always, unless @p any_space. Says, unless @p quiet, what else it is taken for.
 */
int settings_scalp_match(const conus_scalp *scalp, const struct atlases *atlases, bool any_space, bool quiet);

/** Says that a round cone does not see the handle, where nothing else does. */
void settings_say_handle(const struct arguments *arguments, const struct engine_settings *engine,
                         const struct common_settings *common);

/** What stands for a place in a help, and what a place is, behind what it is for. */
#define PLACE_VALUE "PLACE"
#define PLACE_HELP "X,Y,Z in mm, an area by name (its inner point), or a position of a cap like C3"

/** The file of areas that --level names; NULL if it names none. */
const char *settings_level_file(const struct engine_settings *settings);

/** Angle, degrees, and range of the pose of the options, whose target is so far away: of a beam those from the focus to
 * the transducer; the range ends at --toward where --range says so, and else is NaN, for that of the selector. */
int settings_pose_cone(double *angle, double range[2], double target, const struct aim_settings *aim,
                       const struct engine_settings *engine);

/** How the ranges of the poses of a file end: as --range says, or at the transducers of beams. */
struct depth_range settings_range(const struct aim_settings *aim, const struct engine_settings *engine);

/** --angle in degrees, or its default; of a cylinder 0. */
double settings_angle(const struct aim_settings *settings, const struct engine_settings *engine);

/** Whether angle and radius go together. */
bool settings_check_shape(const struct aim_settings *settings, const struct engine_settings *engine,
                          const struct arguments *arguments);

/** Makes the weight of --weight and, where no option says so, sets the angle or radius of its own region.
 * The caller ends both with settings_weight_finish(), in any case. */
int settings_weight(struct aim_settings *aim, struct engine_settings *settings, const struct arguments *arguments);
void settings_weight_finish(struct engine_settings *settings);

/** Prints notes about a weight that the cone cuts off, that few rays share, or that is finer than the voxels of @p
 * atlas, unless --quiet. */
void settings_say_weight(const struct aim_settings *aim, const struct engine_settings *settings,
                         const struct common_settings *common, const conus_atlas *atlas);

/** Whether there is such a score, and what it needs. */
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

/** Reads --contacts; the count is 0 if it was not given (NULL). */
int settings_contacts(conus_contacts *out, const char *text);

/** Finds the published error that --jitter names. False where it names none: then it prints an error, unless @p text is
 * no name. @p has_needles: errors of needles are known, too. */
bool settings_error(conus_pose_error *out, const char *text, bool has_needles);

/** Reads --jitter (DEGREES,MM or, with @p has_needles, the errors of both ends) and checks --samples; prints an error
 * where one is wrong. */
bool settings_jitter(conus_jitter_options *out, const char *text, uint32_t samples, bool has_needles);

extern const struct option space_options[]; /**< space_settings */

/** Whether the options go together. */
bool space_settings_check(const struct arguments *arguments, const struct space_settings *settings);

/** Whether positions are found only once the atlas is loaded. */
bool space_settings_needs_atlas(const struct space_settings *settings);

/** Finds where the space lies in all of the @p atlases, which must be one place. Unless @p quiet, says where the atlas
 * calls the right side left. */
int space_settings_frame(conus_frame *out, const struct atlases *atlases, const struct space_settings *settings,
                         bool quiet);

/* Tractograms that were read, to open the same files again: another atlas, or the same one with other
 * options. */

/** A zeroed one is empty. */
struct tract_shelf {
    struct shelved *items; /**< [count] */
    size_t count;
};

/** Whether @p path was read, in these axes. */
bool tract_shelf_has(const struct tract_shelf *shelf, const char *path, conus_file_space space);
/** The tractogram @p path, which is read where it was not. It stays the shelf's, and what it is added to must end
 * before it. */
conus_status tract_shelf_find(const conus_tractogram **out, struct tract_shelf *shelf, const char *path,
                              const conus_streamlines_options *options);
/** Begins a load. Unless the same files are opened @p again, what was read before it is not found by it. */
void tract_shelf_begin(struct tract_shelf *shelf, bool again);
/** Ends what the last load did not find. */
void tract_shelf_drop(struct tract_shelf *shelf);
void tract_shelf_finish(struct tract_shelf *shelf);

/* Loads the atlas, its pathways, streamlines and context as the options say. */

/** An atlas, or an image, as it was given. */
struct atlas_name {
    conus_catalogue *catalogue;   /**< It is one of its entries; NULL if there was no need to look. */
    const conus_installed *atlas; /**< NULL: what was given is a path. */
    const char *path;             /**< For conus_atlas_load(). */
    char *owned;                  /**< That path with a ",template=" behind it; NULL without one. */
};

/** Finds out what @p text means: a file or folder of that path, or else the installed atlas of that name. @p text must
 * outlive @p out. @p out is the caller's to finish in every case. */
int atlas_name_find(struct atlas_name *out, const char *text);
/** The same of a context: a surface is always a path. */
int context_name_find(struct atlas_name *out, const char *text);
void atlas_name_finish(struct atlas_name *name);

/** The labels to load it with: those of --labels, @p given, or else those of the installed atlas; NULL = none. */
const char *atlas_name_labels(const struct atlas_name *name, const char *given);

/** Loads the atlas, a path or the name of an installed one, and adds its pathways and streamlines. The exit
 * code is not 0, without a message, where the settings' progress cancelled. */
int atlas_input_load(conus_atlas **out, const char *path, const struct atlas_settings *settings);

/** Whether @p why is the library's message about an image that is no atlas but may be drawn around one. */
bool atlas_input_is_image(const char *why);

/** Sets the context, unless @p path is NULL; @p blocks 0 = it does not block. */
int atlas_input_load_context(conus_atlas *atlas, const char *path, double blocks,
                             const struct atlas_settings *settings);

/** Sets each file as a context: a volume replaces the one before, surfaces add up. */
int context_choice_load(conus_atlas *atlas, const struct context_choice *choice, const struct atlas_settings *settings);

/** Whether one of the files is no surface. */
bool context_choice_has_volume(const struct context_choice *choice);

/* ATLAS and those of --atlas: several atlases that are asked the same, each with a name for its answers. */

struct named_atlas {
    conus_atlas *atlas;
    const char *given; /**< The path or name on the command line: borrowed. */
    char *name; /**< Its name in the column `atlas`: the catalogue's name, or the file's without folder and ending. No
                   two are equal. UTF-8, one line. NULL where there is one atlas only. */
};

struct atlases {
    struct named_atlas *items; /**< [count] ATLAS, then those of --atlas. */
    size_t count;
    double opening_ms;        /**< How long loading took. */
    bool shares_streamlines;  /**< Every atlas has the bundles of --streamlines; they are in memory once. */
    struct tract_shelf shelf; /**< If so: these. */
};

enum { ATLAS_PREFIX_SIZE = 256 };

/** Writes to @p out the beginning of a message about one of several atlases, "NAME: "; "" if there is only one. */
const char *atlases_prefix(char out[ATLAS_PREFIX_SIZE], const struct named_atlas *atlas);

/** Loads @p path and those of --atlas, each with its @p context (NULL = none). @p out, which the caller zeroes but for
 * shares_streamlines, is the caller's to atlases_finish() in any case. */
int atlases_load(struct atlases *out, const char *path, const struct atlas_settings *settings,
                 const struct context_settings *context);
/** Only finds their names; each atlas is then to be loaded, or put there. */
int atlases_name(struct atlases *out, const char *path, const struct atlas_settings *settings);
/** Loads those that are not there yet, each with its @p context (NULL = none). --labels, --pathway, --only and --hide
 * apply to the first atlas only; so does --streamlines, unless shared. */
int atlases_load_all(struct atlases *atlases, const struct atlas_settings *settings,
                     const struct context_settings *context);
void atlases_finish(struct atlases *atlases);

/** Whether a sidecar can hold the names of all files that were read. */
int atlases_check_names(const struct atlases *atlases);

/** Whether the headers of two volumes, NULL = none, name different spaces. */
bool spaces_differ(const conus_volume_info *a, const conus_volume_info *b);

/** Says on stderr, unless --quiet, which atlas is hardly in the space of the first: where both name their spaces, and
 * these differ, or where no voxel and no triangle of one is in the box around the other. */
void atlases_say_spaces(const struct atlases *atlases, const struct common_settings *settings);

/* Notes about atlases, and about where cones lie and point. */

/** How poses aim at an atlas. */
struct aimed {
    conus_pose_findings found;
    conus_selector *selector;
    const conus_atlas *atlas;
    const char *name;         /**< NULL where there is one only. */
    const conus_frame *frame; /**< The space of the positions as they were given. */
    bool is_of_probes;        /**< `found.away` are probes that pass nothing. */
    double radius;            /**< Of the balls around points, mm; 0 = they have none. */
};

/** Prints notes about odd poses on stderr, a line for each kind, unless --quiet; and what one such pose would hit in
 * another space or unit, if it would hit anything. A note about all @p count atlases is printed once; any other one
 * ends with the names of its atlases. @p file has the poses, NULL = there is one pose. */
void aim_notes_say(const struct aimed *aimed, size_t count, const char *file, const struct common_settings *settings);

/** Says the atlas's notes on stderr, unless --quiet. */
void atlas_notes_say(const conus_atlas *atlas, const struct common_settings *settings);
/** The same of several; each note begins with the atlas's name. On a terminal also, if opening them took more than a
 * second, that there are packs. */
void atlases_say_notes(const struct atlases *atlases, const struct common_settings *settings);

/** Says on stderr, unless --quiet, where all layers are asked for, how many surfaces are not closed and what that means
 * for them. */
void atlases_say_open(const struct atlases *atlases, const struct engine_settings *engine,
                      const struct common_settings *settings);

/* Options that take a place: numbers, an area, a position of a cap (conus/pose.h). */

/** The places of one run. Those that are more than three plain numbers are kept, for the head of the answer. */
struct named_places {
    const conus_atlas *atlas; /* in which they are */
    const conus_frame *frame; /* space and unit of their numbers */
    conus_named_place *items; /* [count] */
    size_t count;
    bool has_axis;      /* one has two ends */
    conus_scalp *scalp; /* Of positions; owned. NULL = the head of MNI 152. */
};

void named_places_finish(struct named_places *places);

/** Finds the point that @p text, the value of the option @p option, means, world mm; @p other as of
 * conus_place_options. */
int named_places_find(double out[3], struct named_places *places, const char *option, const char *text,
                      const double *other);

/** Finds both ends of an axis, one of which may be near:AREA. */
int named_places_find_ends(double origin[3], double toward[3], struct named_places *places,
                           const char *const options[2], const char *const texts[2]);

/** Keeps how @p text, of the option @p option, was understood: as @p place, or else a sentence. */
int named_places_add(struct named_places *places, const char *option, const char *text, const conus_place *place);

/** Says each of those that are kept, a note a line, but what is about the whole question. */
void named_places_say(const struct named_places *places);

/* Options of commands that read a file of poses. */

struct pose_file_settings {
    size_t axis;   /* conus_axis */
    size_t format; /* of conus_pose_format_name() */
    bool along_shafts;
    bool any_space;
};

enum { KEPT_COLUMNS = 64, KEPT_SIZE = 4096 };

/** Columns of the file whose texts the answer has. */
struct keep_settings {
    const char *columns; /* "group,site"; NULL = none */
};

extern const struct option keep_options[]; /**< keep_settings */

/** Their names. */
struct kept_names {
    const char *at[KEPT_COLUMNS];
    size_t count;
    char text[KEPT_SIZE];
};

/** Splits --keep. */
int keep_settings_names(struct kept_names *out, const struct keep_settings *settings);

extern const struct option pose_file_options[]; /**< pose_file_settings */

/** A probe whose contacts are asked instead of a cone. */
struct probe_settings {
    const char *path; /* NULL = none */
    double tip, roll; /* mm, degrees */
};

extern const struct option probe_settings_options[]; /**< probe_settings */

/** The options of the library for the file; @p frame must live until the file is opened, @p atlas NULL is not loaded
 * yet, @p max_memory 0 is the default. @p aim NULL: no range ends at a target, and no row is a beam. */
conus_pose_options pose_settings_options(const struct pose_file_settings *settings, const struct aim_settings *aim,
                                         const struct engine_settings *engine, const conus_frame *frame,
                                         const conus_atlas *atlas, uint64_t max_memory);

/** Writes what of the settings the answers depend on: two runs with the same text read the same poses from one file. */
void pose_settings_text(char out[128], const struct pose_file_settings *settings, const struct aim_settings *aim,
                        const struct engine_settings *engine);

/** Name of the file of poses @p path for messages: itself, or "standard input". */
const char *pose_settings_file_name(const char *path);

/** Before the atlas is loaded: refuses an atlas in the place of the file of poses of option @p option. Prints an error
 * unless the exit code is 0. */
int pose_settings_check_file(const char *path, const char *option, const struct arguments *arguments);

/** Prints why no poses were read from the file @p path of option @p option ("pose"): of an atlas or a tractogram that
 * stands there, what to type instead. Gives the exit code that goes with @p status. */
int pose_settings_print_error(conus_status status, const char *path, const char *option,
                              const struct arguments *arguments);

/** Whether @p electrodes, the table that the poses came from (NULL = another format), is there for a @p format that
 * adds columns to it. */
int pose_settings_check_electrodes(const char *format, const char *electrodes, const char *path);

/** Loads the probe; *out is NULL where there is none. */
int probe_settings_load(conus_probe **out, const struct probe_settings *settings, uint64_t max_memory);

/** What marks the rows of answers to a list of poses: their numbers where ids repeat or there are times, which then are
 * marked, too. */
int pose_settings_mark_list(conus_row_marks *out, const conus_pose_list *poses);

/** The same of a stream, just opened. The table @p path is read once more where it names its rows; where it is no file
 * (@p piped), and where it has more than 2^20 names, these count as repeated. */
int pose_settings_mark_stream(conus_row_marks *out, const conus_pose_stream *poses, const char *path, bool piped,
                              const conus_pose_options *options);

/** Why a row has no cone; NULL if it is a pose. */
const char *pose_settings_row_error(const conus_pose_row *row);

/** Says, unless --quiet, that there is no pose in the file. */
void pose_settings_say_none(const char *path, const struct common_settings *common);

/** Whether the poses' space can be that of each atlas, and says the notes about them, *said of them. */
int pose_settings_match_stream(size_t *said, conus_pose_stream *poses, const char *path, const struct atlases *atlases,
                               const struct pose_file_settings *settings, const struct common_settings *common);
/** Warns of points that lie far from the areas, or positions of a cap, that they are called as, in any of the atlases.
 */
void pose_settings_warn_of_names(const conus_pose_list *poses, const char *path, const struct atlases *atlases);
/** Says those that came behind the first @p said, when all poses had been read. */
void pose_settings_say_late(conus_pose_stream *poses, const char *path, size_t said,
                            const struct common_settings *common);
/** The same for a list; @p settings may be NULL, of a command without these options. */
int pose_settings_match_list(conus_pose_list *poses, const char *path, const struct atlases *atlases,
                             const struct pose_file_settings *settings, const struct common_settings *common);

/* Options that constrain a plan, in their order on the command line. */

struct constraints {
    conus_constraint *items; /**< [count] */
    char **texts;            /**< [count] Their options' values, cut at their commas. */
    double **needles;        /**< [count] Of --apart; else NULL. */
    size_t count;
    double *shanks; /**< [shank_count][2] Of --shanks, along the device's x and y, mm; NULL = not given. */
    size_t shank_count;
};

extern const struct option constraint_options[]; /**< struct constraint_settings */
extern const struct option entry_options[];      /**< Likewise, of conus plan alone. */
extern const struct option shank_options[];      /**< Likewise: --shanks. */

/** Only so that the parser keeps what it reads: constraints_parse() takes the uses, in their order. */
struct constraint_settings {
    struct option_list reach, avoid, lean, apart, first;
    double length[2];
    double entry_angle;
    const char *arc_window, *shanks;
};

/** Reads the options about constraints, if there are any. @p out is the caller's to constraints_finish() in any case.
 */
int constraints_parse(struct constraints *out, const struct arguments *arguments);
/** Whether names of areas do not end in a number, which looks like @p key=NUMBER and @p means so; else prints so. */
bool constraint_ends_in_name(const char *option, const char *names, const char *key, const char *means);
/** Gives the contacts of --contacts, NULL = not given, to the constraints that count them; @p are_used: others do. */
int constraints_take_contacts(struct constraints *constraints, const char *text, bool are_used);
/** Whether there are any; @p arguments may be NULL. */
bool constraints_are_given(const struct arguments *arguments);
/** The last measure of any of them, in the order of conus_measure: whether rays are needed, and all layers. */
conus_measure constraints_last_measure(const struct constraints *constraints);
void constraints_finish(struct constraints *constraints);

/** Where positions are, and the atlases in which they are to be. */
struct pose_places {
    const conus_frame *frame;
    const struct pose_file_settings *settings; /**< NULL = the command has none. */
    const struct atlases *atlases;
    const struct common_settings *common;
};

/** Turns directions into the world, and loads the needles of --apart, whose poses are in the space of the frame, too.
 * Poses without a far end of their own have @p far, mm; 0 = none. */
int constraints_place(struct constraints *constraints, const struct pose_places *places, double far);

/* Options of programs that receive poses from a tracker by OpenIGTLink. */

struct station_settings {
    const char *listen, *connect, *tool, *reference, *world_from_tracker;
    size_t axis; /* conus_axis */
    bool lps;
    double enlarged;
    const char *head, *screen_pose;
    double eye[3];
    uint32_t screen_mm[2];
    const char *second_tool, *second_listen, *second_connect, *second_world_from_tracker;
};

extern const struct option station_options_table[]; /**< station_settings */
extern const struct option screen_options_table[];  /**< station_settings, too: who looks at which screen */

extern const struct option second_options_table[]; /**< station_settings, too: a second tool that points */

/** Whether the options go together, and name addresses. */
bool station_settings_check(const struct station_settings *settings, const struct arguments *arguments);

/** The same for a command with the screen's options, */
bool station_settings_check_screen(const struct station_settings *settings, const struct arguments *arguments);

/** and for one with the options of a second tool as well. */
bool station_settings_check_second(const struct station_settings *settings, const struct arguments *arguments);

/** Starts a station where --listen or --connect was given, else leaves *out NULL. */
int station_settings_start(struct station **out, const struct station_settings *settings);

/** Starts one that connects to @p address, HOST[:PORT], in place of that of --listen or --connect. */
int station_settings_connect(struct station **out, const struct station_settings *settings, const char *address);

/** The same for --second-listen or --second-connect: the second tool's own station; without them both tools share the
 * first one. */
int station_settings_start_second(struct station **out, const struct station_settings *settings);

/** "waiting for a connection on port 18944", "Pointer is lost", ... */
void station_settings_text(char *out, size_t size, struct station *station, const struct station_update *update);

#endif
