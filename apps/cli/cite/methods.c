/* SPDX-License-Identifier: BSD-3-Clause */
/* Fills the sentences of a methods paragraph with what a sidecar records. */
#include "cli/cite/citation.h"

#include "base/system/system.h"
#include "conus/selection.h"
#include "options/output.h"

#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

enum { LISTED = 10, NAME = 64 };

/* A sentence, if its condition holds: names of facts that are there, "!" before those that are not, "=value" behind
 * those whose text is that; all of them, separated by spaces. In {braces} stands the name of a fact, whose value fills
 * it; behind a "?" words that stand in its place where it is there, with @ for the value; behind a "|" those where it
 * is not. */
struct sentence {
    const char *condition, *text;
};

#define CONUS "with conus, version {version}{rays?, which selects by conic volumes after Rick et al. (2010)}."
#define DEPTHS " Only what lies between two depths along the axis counted: "
#define APEX "{tube?device's position|{rays?apex|device's position}}"
#define OWN "{own?, or the pose's own where the file gives them}."
#define EXACT                                                                                                          \
    "{tetrahedra? Volumes are exact for the tetrahedra and voxels as they are; surfaces were measured along lines "    \
    "0.5 mm from each other.| Volumes are exact for the voxels and closed surfaces as they are; what is in no "        \
    "surface, or in several that are one area, was measured along 4 × 4 lines through each voxel of the region.}"
#define VOLUME "The volume that {regions} has in common with each {object} was determined " CONUS " {region}" EXACT
#define FROM_SAMPLES                                                                                                   \
    " from {Question.options.samples|1024} poses about each given one, drawn from a Sobol sequence with independent "  \
    "normal errors"
#define SAMPLED " The probability of each object to rank first was estimated" FROM_SAMPLES
#define CONNECTED                                                                                                      \
    CONUS " An end was assigned to the area that it lies in{Queries.0.endpoint_radius_mm?, else to the nearest one "   \
          "within @ mm}. Streamlines are a model: their number is not that of axons."

/* What was asked: by what the rows are of, and where. A sidecar of which none holds is not known. */
static const struct sentence of_rows[] = {
    {"rays", "The {objects} in {shape} were determined for {poses} " CONUS},
    {"of=answers point",
     "The {objects} at {poses}{nearest?, or nearest to it where there is none,} were determined " CONUS},
    {"of=answers ball", "The {objects} in {shape} were determined for {poses} " CONUS
                        " Distances are to the nearest point of an object's voxels (whole cells) or surface; volumes "
                        "and fractions are of the voxels with their centre in the ball."},
    {"of=segments", "The {objects} along the device's axis, a straight line from the device's position on, were "
                    "determined in order of depth for {poses} " CONUS
                    " Borders are where the axis crosses faces of voxels, or a surface."},
    {"of=clearances",
     "The distance of the device's axis, a straight line from the device's position on, from each "
     "{object}{Settings.radius_mm?, less the needle's radius of @ mm (the clearance),} was determined for "
     "{poses} " CONUS
     " Distances are to the nearest point of an object's voxels (whole cells), surface or streamlines, 0 where the "
     "axis is in it (Eq. 21 of conus's documentation).{Settings.within_mm? Objects that are farther than @ mm away are "
     "not reported.}"},
    {"of=admissions",
     "The least full opening angle at which a cone about the device's axis, with its apex at the "
     "device's position, contains a point of each {object} was determined, up to {widest}, for "
     "{poses} " CONUS " Points are the centres of voxels, or all points of a surface; occluded objects count."},
    {"of=connections Question.region=all", "The areas at both ends of all streamlines were determined " CONNECTED},
    {"of=connections !Question.region=all",
     "The areas at both ends of all streamlines that come into {shape} were determined for {poses} " CONNECTED},
    {"of=calibration",
     "The deviation of the device's axis from a known point that was aimed at was determined from {Settings.trials} "
     "trials " CONUS
     " Intervals are those of 95 % of Student's t (bias) and chi squared (standard deviations); whether "
     "errors are normal was tested by Mardia's kurtosis, and whether they are alike in all directions by a likelihood "
     "ratio (Eq. 34 of conus's documentation)."},
    {"of=positions Settings.head=own",
     "Positions of the 10-10 system were found on a scalp by sections through its landmarks, at fractions of their "
     "lengths (Eq. 35 of conus's documentation), " CONUS},
    {"of=positions !Settings.head=own",
     "Positions of the 10-10 system are those of the rule of Jurcak, Tsuzuki and Dan (2007, "
     "doi:10.1016/j.neuroimage.2006.09.024), as SimNIBS computed them on the head of MNI 152, with normals of a "
     "quadric through the nearest of them (Eq. 35 of conus's documentation); they were listed " CONUS},
    {"of=reliability",
     "From {Settings.trials} trials it was determined how often the {object} with the largest posterior was the one "
     "that was meant, " CONUS " Intervals are Wilson's of 95 % (Eq. 34 of conus's documentation)."},
    {"of=reliability Settings.weight.own_angle_deg",
     " A trial's cone had a full opening angle of {Question.options.angle|{Settings.weight.own_angle_deg}}°, or its "
     "own where the file gives one."},
    {"of=coverages", VOLUME},
    {"of=clusters", VOLUME " Voxels with a face, an edge or a corner in common were one cluster"
                           "{Question.options.threshold?; its local maxima were at least 8 mm apart}."},
    {"Plan.needles",
     "Needles were planned together " CONUS
     " Candidate poses of each had to hold its constraints: {Plan.rows}. Any two "
     "needles had to be farther apart than {Plan.between.shafts_mm} mm{Plan.between.parts_mm?, their parts than @ mm}"
     "{Plan.entry_distance_mm?, and their positions @ mm or more}. The leeway of a combination is a distance for which "
     "it is proven that nothing breaks while no point of any needle is off by more; sought was the largest one, and "
     "with that the largest sum of the needles' own ones (Eq. 25 to 28 of conus's documentation)."},
    {"Plan.arcs", " A rig was to carry them on arcs {Plan.arcs.spacing_deg} degrees or more apart"
                  "{Plan.arcs.most?, @ at most}, needles on one arc {Plan.arcs.slider_deg} degrees or more apart"
                  "{Plan.arcs.each?, @ at most}."},
    {"Plan.cover.0", " Contacts of all needles together were counted in {Plan.cover}."},
    {"Plan.diverse", " Each further combination is the best of those that differ from all before it in "
                     "{Plan.diverse.needles} or more needles, by {Plan.diverse.apart_mm} mm or more at the position or "
                     "the far end."},
    {"Plan.combinations.last.proven",
     " It was proven that none is better{Plan.diverse?, for each one that is listed}."},
    {"Plan !Plan.needles",
     "A needle{Settings.radius_mm? with a radius of @ mm|, taken as its axis,} was tried at {Plan.candidates} "
     "candidate poses " CONUS
     " The constraints were: {Plan.constraints}. Of these poses {Plan.funnel.last} held all of them (Eq. "
     "21 and 22 of conus's documentation). Their order is by {Question.options.rank?the keys @ (--rank of conus plan)|"
     "leeway, the largest first, then by depth, the smallest first}. The leeway of a pose is a distance for which it "
     "is proven that no pose whose axis is off by less breaks a constraint."},
    {"Plan", " The candidates were those of the command \"{GeneratedBy.0.CommandLine}\"."},
    {0},
};

/* What else. apps/web/page/state.js has these sentences, too, of a page. */
static const struct sentence of_settings[] = {
    {"Settings.range_mm", DEPTHS "{Settings.range_mm.0} mm and {Settings.range_mm.1} mm from the " APEX OWN},
    {"!Settings.range_mm Question.options.range", DEPTHS "{Question.options.range} mm from the " APEX OWN},
    {"!Settings.range_mm !Question.options.range own !Plan",
     DEPTHS "{single?{Queries.0.range_mm.0} mm and {Queries.0.range_mm.1} mm from the " APEX
            "|the pose's own, where the file gives them}."},
    {"rays", " {Shape} was filled with {rays}."},
    {"rays !slices", " Each ray was followed exactly, {all?through all objects|to the first object that it hits}: no "
                     "voxel and no triangle on its way was left out."},
    {"rays slices", " Volumes were sampled only where a ray meets one of a set of planes across the view: {slices}; "
                    "thinner objects can be missed."},
    {"rays", " An object's share is the part of the {tube?cross-section|solid angle} whose rays hit this object before "
             "any other."},
    {"rays all", " Occluded objects counted, too. Path lengths are of all rays through an object; volumes and "
                 "fractions are of the voxels with their centre inside, or, of surfaces, estimated from the rays."},
    {"rays Settings.score=share", " Objects were ranked by their share."},
    {"rays !Settings.score=share",
     " Objects were ranked by the score {Settings.score} (Eq. 12 of conus's documentation)"
     "{Settings.track.window_s?, with a window of @ s}{Settings.track.stickiness?, stickiness @}"
     "{Settings.track.snappiness? and snappiness @}{Settings.track.rate_hz? at @ Hz}{Settings.track.growth_per_s?, "
     "growth @/s}{Settings.track.decay_per_s?, decay @/s}{Settings.track.exponent? and exponent @}."},
    {"Settings.weight.form=gauss",
     " Rays were weighted by a normal error of the axis's tilt, with a standard deviation "
     "of {Settings.weight.sigma_deg}° about each of two axes: an object's weight is the "
     "probability that the axis, if it lies in the cone, meets it before any other (Eq. 30 and 31 of conus's "
     "documentation)."},
    {"Settings.weight.error", " This error is a published one ({Settings.weight.error.measured}; see the references)."},
    {"Settings.weight.form=table", " Places and rays were weighted by a table of {Settings.weight.rows} rows"
                                   "{Settings.weight.unit?, in @} (Eq. 30 and 31 of conus's documentation)."},
    {"Settings.weight.form=coil", " Places were weighted by a model of a coil's field, which falls by half every "
                                  "{Settings.weight.numbers.0} mm of depth and {Settings.weight.numbers.1} mm off the "
                                  "axis (Eq. 30 of conus's documentation); no field was simulated."},
    {"Settings.weight.form=focus", " Places were weighted by a model of a focus {Settings.weight.numbers.0} mm deep, "
                                   "which falls to half at a width of {Settings.weight.numbers.1} mm and a length of "
                                   "{Settings.weight.numbers.2} mm (Eq. 30 of conus's documentation); no field was "
                                   "simulated."},
    {"Settings.weight.form=fibre",
     " Places were weighted by a model of light from a fibre with a radius of {Settings.weight.numbers.0} mm and a "
     "numerical aperture of {Settings.weight.numbers.1}, in tissue with a scattering of "
     "{Settings.weight.numbers.2}/mm, "
     "an absorption of {Settings.weight.numbers.3}/mm and a refractive index of {Settings.weight.numbers.4} (Foutz "
     "2012 "
     "as in cleo; Eq. 30 of conus's documentation); no light was simulated."},
    {"Settings.weight.above",
     " An object's dose is the integral of the weight over its part in the {tube?cylinder|cone "
     "or ball} (Eq. 33)."},
    {"Settings.weight.bias_deg.0", "{biased? The device was taken to point {Settings.weight.bias_deg.0}° to its right "
                                   "and {Settings.weight.bias_deg.1}° up of what was meant.}"},
    {"Settings.prior", " The posterior of an object is the probability that it is meant, if "
                       "{meant}{power?; likelihoods were raised to the power @} (Eq. 32)."},
    {"rays Settings.track", " A press of the trigger confirmed what was selected {Settings.track.delay_s} s before."},
    {"Question.options.jitter !Plan !Settings.error",
     SAMPLED "; their standard deviations were {tilt?@° of tilt about each of two axes and|those that the file gives "
             "for each pose}{offset? @ mm of position along each of three}."},
    {"Settings.error !Plan",
     SAMPLED "; their standard deviations were {Settings.error.tilt_deg?@° of tilt about each of two "
             "axes{Settings.error.shift_mm? and }}{Settings.error.shift_mm?@ mm of position along each of three}."},
    {"Question.options.jitter Plan", " Probabilities to break nothing were estimated" FROM_SAMPLES
                                     ": {Question.options.jitter} (options of conus plan)."},
    {"Settings.error", " These errors are published ones ({Settings.error.measured}; see the references)."},
    {"Places.0", " Places that were named: {Places}."},
    {"Places.0.head=own", " The position {Places.0.name} was found on a scalp by sections through its landmarks, at "
                          "fractions of their lengths (Eq. 35 of conus's documentation)."},
    {"Batch.head=own", " Positions of a cap were found on a scalp by sections through its landmarks, at fractions of "
                       "their lengths (Eq. 35 of conus's documentation)."},
    {"scalp !Places.0.head", " Positions of a cap were found on the scalp of its --scalp, by sections through the "
                             "landmarks there, at fractions of their lengths (Eq. 35 of conus's documentation)."},
    {"Places.0.toward",
     " The place is {Places.0.way_mm} mm from it towards {Places.0.toward}, along the section of the "
     "scalp through both and their normals."},
    {"Question.options.out", " The device stood {Question.options.out} mm off the scalp, along its normal."},
    {"Question.options.handle",
     " The device's handle (its -y) pointed backwards, turned by {Question.options.handle}° to the "
     "side of the position, on the midline to the left."},
    {"Question.options.any-space",
     " What poses, a scalp or regions say of their space was not used (--any-space): they were taken as they are."},
    {"Question.options.summary",
     " Reported are the object that ranks first, the runner-up and the difference of their scores."},
    {"Space.orientation=CCF", " Positions were those of the Allen CCF, AP, DV and ML in µm from its corner."},
    {"Space.orientation=bregma",
     " Positions were AP, ML and DV in mm from bregma, which was taken to be at {Question.options.bregma?AP,DV,ML @ µm "
     "of the Allen CCF|the landmark of the International Brain Laboratory in the Allen CCF}."},
    {0},
};

static const struct sentence of_atlas[] = {
    {"", " {another?Another atlas, asked by itself, was|The atlas was} {name} (file {file}{sum?, SHA-256 @…}{packed?, "
         "read from the pack @}{placed?, placed by @}{references?; see the references})."},
    {"template", " Whose brain it is was stated (template={template}), not taken from its files."},
    {"", "{meaning}"},
    {"level", " Areas were joined along the area tree to the level \"{level}\"."},
    {"hidden",
     " Some of its objects were left out, as if they were not there{many?; the sidecar lists them|, by label: "
     "{hidden}}."},
    {"hemispheres=split",
     " Areas on both sides were cut in two at {ccf?ML 5700 µm of the Allen CCF|x = 0 of the atlas}."},
    {"hemispheres=merged", " Left and right areas of one name were joined."},
    {"mirrored", " Left and right of its places were exchanged, about x = 0."},
    {"field", " It was brought into the space of the positions by {fields?several deformation fields|a deformation "
              "field}{affine? and affine transforms}.{volumes.0.path? Its voxels were resampled by the nearest "
              "neighbour.}"},
    {"!field moved", " It was brought into the space of the positions by an affine transform, without resampling."},
    {0},
};

/* What is in an atlas beside labels; of its lists each item. */
static const struct sentence of_part[] = {
    {"role=pathway !bands", " Voxels of {file} with values of at least {threshold} counted as a pathway."},
    {"role=pathway bands", " Values of {file} made up {bands}."},
    {"role=probability", " Voxels of {file} with values of at least {threshold} counted as an area."},
    {"role=context blocks", " Voxels of {file} with values of at least {threshold} blocked the rays."},
    {"streamlines", " The {streamlines} streamlines of {file} counted as lines{rays?; rays hit them as tubes of radius "
                    "{radius_mm} mm}."},
    {0},
};
static const struct sentence of_item[] = {
    {"asked", "{asked}"},
    {"names contacts", "{names} (at least {contacts})"},
    {"names !contacts", "{names}"},
    {"!asked low high", "{name} (from {low} to below {high})"},
    {"!asked low !high", "{name} (from {low})"},
    {"!asked !low high", "{name} (to below {high})"},
    {"!asked !low !high !needles !is !names", "{name} (all values)"},
    {"is=numbers", "{option}, {words}"},
    {"is=position !head=own", "{option}, the position {name} of the 10-10 system on the head of MNI 152 (the rule of "
                              "Jurcak, Tsuzuki and Dan 2007, doi:10.1016/j.neuroimage.2006.09.024)"},
    {"is=position head=own", "{option}, the position {name} of the scalp"},
    {"is !is=position !is=numbers", "{option}, the {is} of {name}"},
    {"needles", "{needles}{radius_mm? (radius @ mm)}{once?, for one needle only}: {constraints}{candidates? "
                "({feasible} of @ hold)}"},
    {0},
};

/* The fact that `size` bytes of a path name, "Plan.funnel.last"; NULL where there is none. */
static const json_t *find_fact(const json_t *facts, const char *path, size_t size)
{
    for (size_t length; facts && size; path += length, size -= length) {
        char name[NAME] = "";
        length = strcspn(path, ".");
        length = length < size ? length : size;
        snprintf(name, sizeof name, "%.*s", (int)length, path);
        length += length < size;
        size_t last = json_array_size(facts) - 1;
        facts = json_is_object(facts) ? json_object_get(facts, name)
                                      : json_array_get(facts, strcmp(name, "last") ? strtoul(name, NULL, 10) : last);
    }
    return facts;
}

static const json_t *fact(const json_t *facts, const char *path)
{
    return find_fact(facts, path, strlen(path));
}

static double number(const json_t *facts, const char *path)
{
    return json_number_value(fact(facts, path));
}

static const char *text_of(const json_t *facts, const char *path)
{
    const char *text = json_string_value(fact(facts, path));
    return text ? text : "";
}

/* false, null, 0, "" and an empty list are as if they were not there. */
static bool is_there(const json_t *value)
{
    return json_is_true(value) || json_is_object(value) || json_array_size(value) || json_string_length(value) ||
           json_number_value(value) != 0;
}

static bool holds(const json_t *facts, const char *condition)
{
    bool all = true;
    for (const char *at = condition; *at && all; at += strspn(at, " ")) {
        bool is_not = *at == '!';
        at += is_not;
        size_t size = strcspn(at, " ");
        size_t name = strcspn(at, "= ");
        const json_t *value = find_fact(facts, at, name);
        const char *text = json_string_value(value);
        bool is = name == size
                      ? value && !json_is_false(value) && !json_is_null(value)
                      : text && strlen(text) == size - name - 1 && memcmp(text, at + name + 1, size - name - 1) == 0;
        all = is != is_not;
        at += size;
    }
    return all;
}

static void put_sentences(FILE *out, const json_t *facts, const struct sentence *sentences);

static void put_fact(FILE *out, const json_t *value)
{
    size_t index;
    const json_t *item;
    if (json_is_integer(value)) {
        fprintf(out, "%" JSON_INTEGER_FORMAT, json_integer_value(value));
    } else if (json_is_number(value)) {
        fprintf(out, "%.9g", json_number_value(value));
    } else if (json_is_string(value)) {
        fputs(json_string_value(value), out);
    }
    json_array_foreach(value, index, item)
    {
        fputs(!index ? "" : json_is_string(item) ? ", " : "; ", out);
        if (json_is_string(item)) {
            put_fact(out, item);
        } else {
            put_sentences(out, item, of_item);
        }
    }
}

/* The end of a text in braces, behind its first one. */
static const char *closing(const char *at)
{
    for (size_t open = 1; *at && open; at++) {
        open += *at == '{';
        open -= *at == '}';
    }
    return at;
}

/* Fills `text` up to `end`; @ is the value of `here`. */
static void put_filled(FILE *out, const json_t *facts, const char *text, const char *end, const json_t *here)
{
    while (text < end) {
        if (*text == '@') {
            put_fact(out, here);
            text++;
        } else if (*text != '{') {
            fputc(*text++, out);
        } else {
            const char *stop = closing(++text) - 1;
            const char *name = text;
            text += strcspn(text, "?|}");
            const json_t *value = find_fact(facts, name, (size_t)(text - name));
            const char *other = text;
            while (other < stop && *other != '|') {
                other = *other == '{' ? closing(other + 1) : other + 1;
            }
            if (*text == '?' && is_there(value)) {
                put_filled(out, facts, text + 1, other, value);
            } else if (*text == '}' || (*text == '|' && is_there(value))) {
                put_fact(out, value);
            } else if (other < stop) {
                put_filled(out, facts, other + 1, stop, NULL);
            }
            text = stop + 1;
        }
    }
}

static void put_sentences(FILE *out, const json_t *facts, const struct sentence *sentences)
{
    for (; sentences->text; sentences++) {
        if (holds(facts, sentences->condition)) {
            put_filled(out, facts, sentences->text, sentences->text + strlen(sentences->text), NULL);
        }
    }
}

static void set(json_t *facts, const char *name, const char *format, ...) __attribute__((format(printf, 3, 4)));

static void set(json_t *facts, const char *name, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    char *text = NULL;
    if (vasprintf(&text, format, args) >= 0) {
        json_object_set_new(facts, name, json_string(text));
        free(text);
    }
    va_end(args);
}

static void set_if(json_t *facts, const char *name, bool is)
{
    if (is) {
        json_object_set_new(facts, name, json_true());
    }
}

/* What all queries are like. */
struct asked {
    double angles[LISTED + 1]; /* the distinct ones, of which LISTED + 1 are kept */
    size_t count, with_point, with_range, with_error, poses;
    double least, most, ball, pixels;
};

static struct asked look_at_queries(const json_t *queries)
{
    struct asked asked = {.least = INFINITY};
    size_t index;
    const json_t *query;
    const json_t *before = NULL;
    json_array_foreach(queries, index, query)
    {
        const json_t *angle = json_object_get(query, "angle_deg");
        double degrees = json_number_value(angle);
        size_t i = 0;
        while (i < asked.count && asked.angles[i] != degrees) {
            i++;
        }
        if (angle && i == asked.count && i <= LISTED) {
            asked.angles[asked.count++] = degrees;
        }
        asked.least = angle ? fmin(asked.least, degrees) : asked.least;
        asked.most = fmax(asked.most, degrees);
        asked.ball = fmax(asked.ball, number(query, "radius_mm"));
        asked.pixels = fmax(asked.pixels, number(query, "cone_pixels"));
        asked.with_point += json_object_get(query, "point_ras") != NULL;
        asked.with_range += json_object_get(query, "range_mm") != NULL;
        asked.with_error += json_object_get(query, "error") != NULL;
        /* a sweep over angles has a query for each angle of a pose */
        asked.poses += !before || strcmp(text_of(before, "query"), text_of(query, "query")) != 0 ||
                       number(before, "row") != number(query, "row");
        before = query;
    }
    return asked;
}

static void put_angles(FILE *out, const json_t *facts, const struct asked *asked, bool is_track)
{
    bool is_listed = !json_object_get(facts, "Batch") && !is_track;
    bool is_swept = holds(facts, "Question.options.angles");
    bool has_own = holds(facts, is_track ? "Settings.own_angles" : "Batch.own_angles");
    if (!is_listed) {
        const char *given = text_of(facts, "Question.options.angle");
        fprintf(out, "%.9g°", !is_track ? number(facts, "Batch.angle_deg") : *given ? strtod(given, NULL) : 10);
        fprintf(out, has_own ? ", or the %s's own where the file gives one" : "", is_track ? "step" : "pose");
    } else if (asked->count > LISTED || (asked->count > 1 && !is_swept)) {
        fprintf(out, "%.9g° to %.9g°%s", asked->least, asked->most, is_swept ? "" : ", depending on the pose");
    }
    for (size_t i = 0; is_listed && i < asked->count && asked->count <= LISTED && (is_swept || asked->count == 1);
         i++) {
        fprintf(out, "%s%.9g°", !i ? "" : i + 1 < asked->count ? ", " : " and ", asked->angles[i]);
    }
}

/* {shape}, {Shape}, {rays}, {widest}: the region, and how it is filled. */
static void set_shape(json_t *facts, const struct asked *asked)
{
    double radius = number(facts, "Settings.radius_mm");
    bool is_square = holds(facts, "Settings.aperture=square");
    bool is_track = holds(facts, "Question.command=track");
    bool has_own = holds(facts, "Batch.own_angles") || holds(facts, "Settings.own_angles");
    long long n = (long long)number(facts, "Settings.resolution");
    const char *given = text_of(facts, "Question.options.angle");
    char pixels[32] = "";
    struct system_text text;
    FILE *angles = system_text_open(&text);
    if (angles) {
        put_angles(angles, facts, asked, is_track);
    }
    const char *degrees = system_text_close(&text) ? text.data : "";
    double most = asked->poses && !is_track ? asked->most : has_own ? 180 : strtod(degrees, NULL);
    bool is_wide = radius == 0 && most > 120;
    if (holds(facts, "Question.region=ball")) {
        set(facts, "shape", "a ball with a radius of %.9g mm", asked->ball);
    } else if (radius > 0) {
        set(facts, "shape", "%s of %.9g mm about the device's axis%s",
            is_square ? "a square prism with half an edge" : "a cylinder with a radius", radius,
            holds(facts, "Batch.points") || asked->with_point
                ? " (a ball of that radius where the file gives a point without a direction)"
                : "");
    } else {
        set(facts, "shape", "%s about the device's axis, with its apex at the device's position and %s of %s,",
            is_square ? "a square pyramid" : "a cone",
            holds(facts, "Question.options.angles") ? "the full opening angles" : "a full opening angle", degrees);
    }
    set(facts, "Shape",
        holds(facts, "Question.region=axis") ? "The axis"
        : radius > 0                         ? (is_square ? "The prism" : "The cylinder")
        : is_square                          ? "The pyramid"
                                             : "The cone");
    set(facts, "widest", "%.9g°%s",
        asked->count ? asked->most
        : *given     ? strtod(given, NULL)
                     : 10,
        asked->count > 1 ? " (depending on the pose)" : "");
    snprintf(pixels, sizeof pixels, asked->pixels > 0 ? "%.0f " : "", asked->pixels);
    set(facts, "rays",
        is_square ? "%s%srays%s, one through the centre of each pixel of %lld × %lld"
                  : "%s%srays%s, one through the centre of each pixel in the round aperture of %lld × %lld pixels",
        pixels, radius > 0 ? "parallel " : "", is_wide ? " (evenly spread in angle where it opens beyond 120°)" : "", n,
        n);
    set_if(facts, "tube", radius > 0);
    free(text.data);
}

/* {poses}: "each of 3 poses of the device (1 of them had no answer)". */
static void set_poses(json_t *facts, const struct asked *asked)
{
    bool is_batch = json_object_get(facts, "Batch");
    long long poses = is_batch ? (long long)number(facts, "Batch.poses") : (long long)asked->poses;
    long long errors = is_batch ? (long long)number(facts, "Batch.errors") : (long long)asked->with_error;
    long long contacts = (long long)number(facts, "Batch.contacts");
    bool is_point = holds(facts, "Question.region=ball") && !contacts;
    char probe[LISTED * NAME] = "";
    char none[LISTED * NAME] = "";
    snprintf(probe, sizeof probe, contacts ? "each of the %lld contacts of a probe at " : "", contacts);
    snprintf(none, sizeof none, errors ? " (%lld of them had no answer)" : "", errors);
    if (holds(facts, "Question.command=track")) {
        set(facts, "poses", "each step of a moving device%s", none);
    } else if (poses == 1) {
        set(facts, "poses", "%sone %s%s", probe, is_point ? "point" : "pose of the device", none);
    } else {
        set(facts, "poses", "%seach of %lld %s%s", probe, poses, is_point ? "points" : "poses of the device", none);
    }
}

/* {objects}, {object}: kinds of objects in the atlases; bundles only where these are asked about, too. */
static void set_objects(json_t *facts, const json_t *atlases)
{
    static const char *const words[2][2][2] = {
        {{"areas", "areas and bundles"}, {"areas and pathways", "areas, pathways and bundles"}},
        {{"area", "area and bundle"}, {"area and pathway", "area, pathway and bundle"}}};
    bool has[2] = {false, false};
    size_t i;
    size_t k;
    const json_t *atlas;
    const json_t *volume;
    json_array_foreach(atlases, i, atlas)
    {
        json_array_foreach(json_object_get(atlas, "volumes"), k, volume)
        {
            has[0] = has[0] || holds(volume, "role=pathway");
        }
        has[1] = has[1] || (!holds(facts, "Question.command=overlap") && json_object_get(atlas, "tractograms"));
    }
    set(facts, "objects", "%s", words[0][has[0]][has[1]]);
    set(facts, "object", "%s", words[1][has[0]][has[1]]);
}

/* Of errors of the pose, planes, and a region of interest. */
static void set_numbers(json_t *facts)
{
    const char *jitter = text_of(facts, "Question.options.jitter");
    const char *comma = strchr(jitter, ',');
    const char *threshold = text_of(facts, "Question.options.threshold");
    double fraction = number(facts, "Settings.slice_fraction");
    double slices = number(facts, "Settings.slices");
    if (comma) {
        set(facts, "tilt", "%.*s", (int)(comma - jitter), jitter);
        set(facts, "offset", "%s", comma + 1);
    }
    if (holds(facts, "Settings.sampling=slices") && slices > 0) {
        set(facts, "slices", "%.9g of %.9g", fmax(1, floor(fraction * slices * (1 + 1e-12))), slices); /* Eq. 7 */
    } else if (holds(facts, "Settings.sampling=slices")) {
        set(facts, "slices", "%.9g of √2 times as many as the longest edge of the volume has voxels", fraction);
    }
    const double power = number(facts, "Settings.prior.power");
    set_if(facts, "biased",
           number(facts, "Settings.weight.bias_deg.0") != 0 || number(facts, "Settings.weight.bias_deg.1") != 0);
    json_object_set_new(facts, "power", json_real(power != 1 ? power : 0));
    set(facts, "meant", "%s",
        holds(facts, "Settings.prior.of=size")   ? "each direction is meant as often"
        : holds(facts, "Settings.prior.of=file") ? "each object is meant as often as a table says"
                                                 : "each object is meant as often");
    set_if(facts, "tetrahedra", holds(facts, "Queries.0.tetrahedra"));
    set(facts, "regions",
        json_array_size(fact(facts, "Queries")) == 1 ? "a region of interest" : "each of several regions of interest");
    set(facts, "region",
        *threshold ? "A region consisted of the %s with values of at %s %s."
                   : "A region consisted of the voxels of a mask that are not 0.",
        holds(facts, "tetrahedra") ? "tetrahedra" : "voxels", *threshold == '-' ? "most" : "least", threshold);
}

/* All facts of the sidecar, and what follows from them. */
static json_t *facts_of(const struct citation *citation, const json_t *atlases)
{
    static const char *const of_rays[] = {"answers", "summaries", "shares", "chances", "steps"};
    json_t *facts = json_object();
    const char *key;
    json_t *value;
    json_object_foreach((json_t *)citation->sidecar, key, value)
    {
        if (provenance_is_sealed(key)) { /* others are names of columns */
            json_object_set(facts, key, value);
        }
    }
    const struct asked asked = look_at_queries(fact(facts, "Queries"));
    const char *rows = text_of(facts, "Question.rows");
    bool is_ball = holds(facts, "Question.region=ball");
    bool has_rays = false;
    for (size_t i = 0; i < sizeof of_rays / sizeof of_rays[0]; i++) {
        has_rays = has_rays || (!(is_ball && i == 0) && strcmp(rows, of_rays[i]) == 0);
    }
    set(facts, "of", "%s", rows);
    set(facts, "version", "%s", citation->version);
    set_if(facts, "ball", is_ball && asked.ball > CONUS_POINT_RADIUS);
    set_if(facts, "point", is_ball && asked.ball <= CONUS_POINT_RADIUS);
    set_if(facts, "nearest", asked.ball == 0);
    set_if(facts, "own", holds(facts, "Batch.own_ranges") || holds(facts, "Settings.own_ranges") || asked.with_range);
    set_if(facts, "single", asked.with_range && asked.poses == 1);
    set_if(facts, "all", holds(facts, "Settings.layers=all"));
    set_if(facts, "scalp", holds(facts, "Plan") && strstr(text_of(facts, "GeneratedBy.0.CommandLine"), " --scalp"));
    set_shape(facts, &asked);
    set_poses(facts, &asked);
    set_objects(facts, atlases);
    set_numbers(facts);
    if (!has_rays) {
        json_object_del(facts, "rays");
    }
    return facts;
}

static json_t *list_atlases(const json_t *sidecar)
{
    json_t *several = json_object_get(sidecar, "Atlases");
    return several ? json_incref(several) : json_pack("[O]", json_object_get(sidecar, "Atlas"));
}

bool citation_is_known(struct citation *citation)
{
    const struct sentence *sentence = of_rows;
    citation->atlases_asked = list_atlases(citation->sidecar);
    citation->facts = facts_of(citation, citation->atlases_asked);
    while (sentence->text && !holds(citation->facts, sentence->condition)) {
        sentence++;
    }
    return sentence->text;
}

const char *citation_error(const struct citation *citation, const char *key)
{
    const json_t *of_weight = fact(citation->facts, "Settings.weight.error");
    const json_t *error = of_weight ? of_weight : fact(citation->facts, "Settings.error");
    const bool is_whole =
        json_is_string(json_object_get(error, "name")) && json_is_string(json_object_get(error, "source"));
    return is_whole ? json_string_value(json_object_get(error, key)) : NULL;
}

bool citation_has_no_atlas(const struct citation *citation)
{
    return holds(citation->facts, "of=calibration") || holds(citation->facts, "of=positions");
}

bool citation_has_rays(const struct citation *citation)
{
    return holds(citation->facts, "rays");
}

/* The sentences of LISTED of an atlas's volumes without labels or of its tractograms. */
static void put_parts(FILE *out, const json_t *facts, const json_t *parts, const char *more)
{
    size_t index;
    size_t listed = 0;
    json_t *part;
    json_array_foreach(parts, index, part)
    {
        if (!holds(part, "role=parcellation") && listed++ < LISTED) {
            json_t *own = json_copy(part);
            set(own, "file", "%s", path_name(text_of(own, "path")));
            set_if(own, "rays", holds(facts, "rays"));
            set_if(own, "blocks", number(own, "threshold") != 0 && !holds(facts, "Question.command=overlap"));
            put_sentences(out, own, of_part);
            json_decref(own);
        }
    }
    if (listed > LISTED) {
        fprintf(out, more, listed - LISTED);
    }
}

/* Whether only the main diagonal of a matrix is not 0, and is 1 but for its first number. */
static bool is_diagonal(const json_t *matrix, double first)
{
    bool is = matrix;
    for (size_t i = 0; i < 16; i++) {
        double wanted = i == 0 ? first : i % 5 == 0;
        is = is && json_number_value(json_array_get(json_array_get(matrix, i / 4), i % 4)) == wanted;
    }
    return is;
}

static void put_atlas(FILE *out, const struct citation *citation, size_t index)
{
    const struct cited_atlas *atlas = &citation->atlases[index];
    json_t *own = json_copy(json_array_get(citation->atlases_asked, index));
    const char *transform = text_of(own, "volumes.0.transform");
    const json_t *moved = fact(own, "atlas_from_world");
    size_t fields = 0;
    size_t i;
    const json_t *step;
    const json_t *note;
    struct system_text text;
    FILE *parts = system_text_open(&text);
    if (parts) {
        put_parts(parts, citation->facts, fact(own, "volumes"),
                  " So did those of %zu more volumes, each from its own threshold on.");
        put_parts(parts, citation->facts, fact(own, "tractograms"), " So did those of %zu more tractograms.");
    }
    set(own, "meaning", "%s", system_text_close(&text) ? text.data : "");
    free(text.data);
    json_array_foreach(fact(own, "way_to_atlas"), i, step)
    {
        const json_t *matrix = json_object_get(step, "matrix");
        fields += json_object_get(step, "field") != NULL;
        set_if(own, "affine", matrix && !is_diagonal(matrix, 1));
    }
    bool is_ccf = false;
    json_array_foreach(fact(own, "notes"), i, note)
    {
        const char *words = json_string_value(note); /* of the cut (atlas/areas/hemispheres.c) */
        is_ccf = is_ccf || (words && strstr(words, "the midline of the Allen CCF"));
    }
    set_if(own, "ccf", is_ccf);
    set_if(own, "field", fields > 0);
    set_if(own, "fields", fields > 1);
    set_if(own, "moved", moved && !is_diagonal(moved, -1));
    set_if(own, "mirrored", !index && holds(citation->facts, "Question.options.sides=exchanged"));
    set_if(own, "another", index > 0);
    set_if(own, "many", strlen(text_of(own, "hidden")) >= 200);
    set_if(own, "references", atlas->references.count);
    set(own, "name", "%s", atlas->name);
    set(own, "file", "%s", atlas->file);
    set(own, "packed", "%s", path_name(text_of(own, "pack.path")));
    set(own, "sum", "%.8s", atlas->sha256 ? atlas->sha256 : "");
    /* "sform, code 1 (scanner)", "the Allen CCF's grid", "none: voxel sizes only, ..." */
    bool is_none = strncmp(transform, "none: ", strlen("none: ")) == 0;
    set(own, "placed", "%s%s", is_none || !*transform || strncmp(transform, "the ", 4) == 0 ? "" : "its ",
        transform + (is_none ? strlen("none: ") : 0));
    if (!fact(own, "level") && fact(citation->facts, "Settings.level")) {
        set(own, "level", "%s", text_of(citation->facts, "Settings.level"));
    }
    put_sentences(out, own, of_atlas);
    json_decref(own);
}

void citation_methods(FILE *out, const struct citation *citation)
{
    static const struct sentence last[] = {{"!Question.region=volume !Question.region=all !Question.region=ball",
                                            " {Shape} is a geometric model: no field, heat or sound was computed."},
                                           {0}};
    size_t index;
    const json_t *line;
    if (!citation->sidecar) {
        const struct cited_atlas *atlas = &citation->atlases[0];
        fprintf(out, "Areas are those of the atlas %s (file %s", atlas->name, atlas->file);
        fprintf(out, atlas->sha256 ? ", SHA-256 %.8s…" : "", atlas->sha256);
        fprintf(out, "), as read by conus, version %s.", citation->version);
        return;
    }
    put_sentences(out, citation->facts, of_rows);
    put_sentences(out, citation->facts, of_settings);
    for (size_t i = 0; i < citation->atlas_count; i++) {
        put_atlas(out, citation, i);
    }
    json_array_foreach(fact(citation->facts, "Warnings"), index, line)
    {
        fprintf(out, " conus warned: \"%s\".", json_is_string(line) ? json_string_value(line) : "");
    }
    put_sentences(out, citation->facts, last);
}
