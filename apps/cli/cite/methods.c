/* SPDX-License-Identifier: BSD-3-Clause */
/* Writes a methods paragraph from a sidecar. Each sentence states something that was asked. */
#include "cli/cite/citation.h"

#include "conus/selection.h"
#include "options/output.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { LISTED = 10 };

static const json_t *setting(const struct citation *citation, const char *name)
{
    return json_object_get(json_object_get(citation->sidecar, "Settings"), name);
}

static const char *setting_text(const struct citation *citation, const char *name)
{
    const char *text = json_string_value(setting(citation, name));
    return text ? text : "";
}

static const json_t *question(const struct citation *citation)
{
    return json_object_get(citation->sidecar, "Question");
}

/* The text of an option that is a part of the question; NULL if it was not given. */
static const char *option_value(const struct citation *citation, const char *name)
{
    const json_t *value = json_object_get(json_object_get(question(citation), "options"), name);
    return json_is_true(value) ? "" : json_string_value(value);
}

static bool question_is(const struct citation *citation, const char *key, const char *name)
{
    const char *text = json_string_value(json_object_get(question(citation), key));
    return text && strcmp(text, name) == 0;
}

static bool is_of(const struct citation *citation, const char *name)
{
    return question_is(citation, "command", name);
}

static bool is_ball(const struct citation *citation)
{
    return question_is(citation, "region", "ball");
}

static const json_t *queries(const struct citation *citation)
{
    return json_object_get(citation->sidecar, "Queries");
}

/* How many queries have this key. */
static size_t count_with(const struct citation *citation, const char *key)
{
    size_t count = 0;
    size_t index;
    const json_t *query;
    json_array_foreach(queries(citation), index, query)
    {
        count += json_object_get(query, key) != NULL;
    }
    return count;
}

static bool has_pathways(const json_t *atlas)
{
    size_t index;
    const json_t *volume;
    json_array_foreach(json_object_get(atlas, "volumes"), index, volume)
    {
        const char *role = json_string_value(json_object_get(volume, "role"));
        if (role && strcmp(role, "pathway") == 0) {
            return true;
        }
    }
    return false;
}

enum number { ONE, MANY };

/* The kinds of objects in the atlases; bundles only where these are asked about, too. */
static const char *objects_of(const struct citation *citation, enum number number, bool bundles)
{
    static const char *const words[2][2][2] = {
        [ONE] = {{"area", "area and bundle"}, {"area and pathway", "area, pathway and bundle"}},
        [MANY] = {{"areas", "areas and bundles"}, {"areas and pathways", "areas, pathways and bundles"}}};
    const json_t *several = json_object_get(citation->sidecar, "Atlases");
    bool has[2] = {false, false};
    for (size_t i = 0; i < citation->atlas_count; i++) {
        const json_t *atlas = several ? json_array_get(several, i) : json_object_get(citation->sidecar, "Atlas");
        has[0] = has[0] || has_pathways(atlas);
        has[1] = has[1] || (bundles && json_array_size(json_object_get(atlas, "tractograms")) > 0);
    }
    return words[number][has[0]][has[1]];
}

/* A sweep over angles has a query for each angle of a pose. */
static size_t count_poses(const struct citation *citation)
{
    const char *last = NULL;
    json_int_t last_row = 0;
    size_t count = 0;
    size_t index;
    const json_t *query;
    json_array_foreach(queries(citation), index, query)
    {
        const char *id = json_string_value(json_object_get(query, "query"));
        json_int_t row = json_integer_value(json_object_get(query, "row"));
        count += !last || !id || strcmp(id, last) != 0 || row != last_row;
        last = id;
        last_row = row;
    }
    return count;
}

static void put_poses(FILE *out, const struct citation *citation)
{
    const json_t *batch = json_object_get(citation->sidecar, "Batch");
    long long poses = batch ? json_integer_value(json_object_get(batch, "poses")) : (long long)count_poses(citation);
    long long errors =
        batch ? json_integer_value(json_object_get(batch, "errors")) : (long long)count_with(citation, "error");
    json_int_t contacts = json_integer_value(json_object_get(batch, "contacts"));
    bool is_point = is_ball(citation) && !contacts;
    const char *noun = is_point ? "point" : "pose";
    if (contacts) {
        fprintf(out, "each of the %lld contacts of a probe at ", (long long)contacts);
    }
    if (is_of(citation, "track")) {
        fputs("each step of a moving device", out);
    } else if (poses == 1) {
        fprintf(out, "one %s%s", noun, is_point ? "" : " of the device");
    } else {
        fprintf(out, "each of %lld %ss%s", poses, noun, is_point ? "" : " of the device");
    }
    if (errors) {
        fprintf(out, " (%lld of them had no answer)", errors);
    }
}

/* The distinct angles of the queries, up to LISTED + 1 of them; least and largest of all. */
static size_t find_angles(double angles[LISTED + 1], double *least, double *most, const struct citation *citation)
{
    size_t count = 0;
    size_t index;
    const json_t *query;
    *least = INFINITY;
    *most = 0;
    json_array_foreach(queries(citation), index, query)
    {
        const json_t *value = json_object_get(query, "angle_deg");
        double angle = json_number_value(value);
        size_t i = 0;
        while (i < count && angles[i] != angle) {
            i++;
        }
        if (value && i == count && count <= LISTED) {
            angles[count++] = angle;
        }
        *least = value ? fmin(*least, angle) : *least;
        *most = value ? fmax(*most, angle) : *most;
    }
    return count;
}

/* Whether poses of a file that are not listed one by one may have angles of their own: older sidecars do not say. */
static bool may_have_own_angles(const struct citation *citation)
{
    const json_t *batch = json_object_get(citation->sidecar, "Batch");
    const json_t *own = batch ? json_object_get(batch, "own_angles") : setting(citation, "own_angles");
    return own ? !json_is_false(own) : batch || json_is_true(json_object_get(question(citation), "reads_poses"));
}

/* The angle of poses without their own, of a file whose poses are not listed. */
static double common_angle(const struct citation *citation)
{
    const json_t *batch = json_object_get(citation->sidecar, "Batch");
    const char *given = option_value(citation, "angle");
    return batch ? json_number_value(json_object_get(batch, "angle_deg")) : given ? strtod(given, NULL) : 10;
}

static void put_angles(FILE *out, const struct citation *citation)
{
    double angles[LISTED + 1];
    double least;
    double most;
    size_t count = find_angles(angles, &least, &most, citation);
    bool is_track = is_of(citation, "track");
    if (is_track || json_object_get(citation->sidecar, "Batch")) {
        fprintf(out, "%.9g°", common_angle(citation));
        if (may_have_own_angles(citation)) {
            fprintf(out, ", or the %s's own where the file gives one", is_track ? "step" : "pose");
        }
    } else if (count > LISTED || (count > 1 && !option_value(citation, "angles"))) {
        fprintf(out, "%.9g° to %.9g°%s", least, most,
                option_value(citation, "angles") ? "" : ", depending on the pose");
    } else {
        for (size_t i = 0; i < count; i++) {
            fprintf(out, "%s%.9g°", !i ? "" : i + 1 < count ? ", " : " and ", angles[i]);
        }
    }
}

/* The largest radius of the question's balls, mm. */
static double largest_ball(const struct citation *citation)
{
    double radius = 0;
    size_t index;
    const json_t *query;
    json_array_foreach(queries(citation), index, query)
    {
        radius = fmax(radius, json_number_value(json_object_get(query, "radius_mm")));
    }
    return radius;
}

/* "a cone ... angle of 20°,", or what stands in its place. */
static void put_shape(FILE *out, const struct citation *citation)
{
    double radius = json_number_value(setting(citation, "radius_mm"));
    bool is_square = strcmp(setting_text(citation, "aperture"), "square") == 0;
    if (is_ball(citation)) {
        fprintf(out, "a ball with a radius of %.9g mm", largest_ball(citation));
    } else if (radius > 0) {
        fprintf(out, "%s of %.9g mm about the device's axis",
                is_square ? "a square prism with half an edge" : "a cylinder with a radius", radius);
        const json_t *batch = json_object_get(citation->sidecar, "Batch");
        if ((batch && !json_is_false(json_object_get(batch, "points"))) || count_with(citation, "point_ras")) {
            fputs(" (a ball of that radius where the file gives a point without a direction)", out);
        }
    } else {
        fprintf(out, "%s about the device's axis, with its apex at the device's position and %s of ",
                is_square ? "a square pyramid" : "a cone",
                option_value(citation, "angles") ? "the full opening angles" : "a full opening angle");
        put_angles(out, citation);
        fputs(",", out);
    }
}

static const char *shape_of(const struct citation *citation)
{
    bool is_tube = json_number_value(setting(citation, "radius_mm")) > 0;
    bool is_square = strcmp(setting_text(citation, "aperture"), "square") == 0;
    if (question_is(citation, "region", "axis")) {
        return "The axis";
    }
    return is_tube ? (is_square ? "The prism" : "The cylinder") : is_square ? "The pyramid" : "The cone";
}

static void put_range(FILE *out, const struct citation *citation)
{
    const json_t *batch = json_object_get(citation->sidecar, "Batch");
    const json_t *range = setting(citation, "range_mm");
    const char *given = option_value(citation, "range");
    bool has_own = json_is_true(batch ? json_object_get(batch, "own_ranges") : setting(citation, "own_ranges"));
    const char *own =
        has_own || count_with(citation, "range_mm") ? ", or the pose's own where the file gives them" : "";
    if (range || given || *own) {
        fprintf(out, " Only what lies between two depths along the axis counted: ");
        if (range) {
            fprintf(out, "%.9g mm and %.9g mm from the apex%s.", json_number_value(json_array_get(range, 0)),
                    json_number_value(json_array_get(range, 1)), own);
        } else if (given) {
            fprintf(out, "%s mm from the apex%s.", given, own);
        } else {
            fprintf(out, "the pose's own, where the file gives them.");
        }
    }
}

static void put_sampling(FILE *out, const struct citation *citation)
{
    const json_t *slices = setting(citation, "slices");
    double fraction = json_number_value(setting(citation, "slice_fraction"));
    bool all = strcmp(setting_text(citation, "layers"), "all") == 0;
    if (strcmp(setting_text(citation, "sampling"), "slices") != 0) {
        fprintf(out, " Each ray was followed exactly, %s: no voxel and no triangle on its way was left out.",
                all ? "through all objects" : "to the first object that it hits");
        return;
    }
    fputs(" Volumes were sampled only where a ray meets one of a set of planes across the view: ", out);
    if (json_is_integer(slices)) { /* Eq. 7 */
        double count = (double)json_integer_value(slices);
        fprintf(out, "%.9g of %.9g", fmax(1, floor(fraction * count * (1 + 1e-12))), count);
    } else {
        fprintf(out, "%.9g of √2 times as many as the longest edge of the volume has voxels", fraction);
    }
    fputs("; thinner objects can be missed.", out);
}

static void put_grid(FILE *out, const struct citation *citation)
{
    long long n = json_integer_value(setting(citation, "resolution"));
    long long pixels = 0;
    size_t index;
    const json_t *query;
    json_array_foreach(queries(citation), index, query)
    {
        long long own = json_integer_value(json_object_get(query, "cone_pixels"));
        pixels = own > pixels ? own : pixels;
    }
    bool is_tube = json_number_value(setting(citation, "radius_mm")) > 0;
    bool is_square = strcmp(setting_text(citation, "aperture"), "square") == 0;
    double angles[LISTED + 1];
    double least;
    double most;
    find_angles(angles, &least, &most, citation);
    bool is_listed = queries(citation) && !is_of(citation, "track");
    bool may_be_wide =
        !is_tube && (is_listed ? most > 120 : common_angle(citation) > 120 || may_have_own_angles(citation));
    fprintf(out, " %s was filled with ", shape_of(citation));
    if (pixels) {
        fprintf(out, "%lld ", pixels);
    }
    fprintf(out, "%srays%s, one through the centre of each pixel ", is_tube ? "parallel " : "",
            may_be_wide ? " (evenly spread in angle where it opens beyond 120°)" : "");
    fprintf(out, is_square ? "of %lld × %lld." : "in the round aperture of %lld × %lld pixels.", n, n);
}

static void put_rays(FILE *out, const struct citation *citation)
{
    bool is_tube = json_number_value(setting(citation, "radius_mm")) > 0;
    put_grid(out, citation);
    put_sampling(out, citation);
    fprintf(out, " An object's share is the part of the %s whose rays hit this object before any other.",
            is_tube ? "cross-section" : "solid angle");
    if (strcmp(setting_text(citation, "layers"), "all") == 0) {
        fputs(" Occluded objects counted, too: path lengths are of all rays through an object; volumes and fractions "
              "are of the voxels with their centre inside, or, of surfaces, estimated from the rays.",
              out);
    }
}

static void put_score(FILE *out, const struct citation *citation)
{
    const char *score = setting_text(citation, "score");
    const json_t *track = setting(citation, "track");
    if (strcmp(score, "share") == 0) {
        fputs(" Objects were ranked by their share.", out);
    } else {
        fprintf(out, " Objects were ranked by the score %s (Eq. 12 of conus's documentation)", score);
        fputs(track ? "" : ".", out);
    }
    if (track && strcmp(score, "share") != 0) {
        fprintf(
            out,
            ", with a window of %.9g s, stickiness %.9g and snappiness %.9g at %.9g Hz, growth %.9g/s, decay %.9g/s "
            "and exponent %.9g.",
            json_number_value(json_object_get(track, "window_s")),
            json_number_value(json_object_get(track, "stickiness")),
            json_number_value(json_object_get(track, "snappiness")),
            json_number_value(json_object_get(track, "rate_hz")),
            json_number_value(json_object_get(track, "growth_per_s")),
            json_number_value(json_object_get(track, "decay_per_s")),
            json_number_value(json_object_get(track, "exponent")));
    }
    if (track) {
        fprintf(out, " A press of the trigger confirmed what was selected %.9g s before.",
                json_number_value(json_object_get(track, "delay_s")));
    }
}

static void put_space(FILE *out, const struct citation *citation)
{
    const char *space = json_string_value(json_object_get(json_object_get(citation->sidecar, "Space"), "orientation"));
    const char *bregma = option_value(citation, "bregma");
    if (space && strcmp(space, "CCF") == 0) {
        fputs(" Positions were those of the Allen CCF, AP, DV and ML in µm from its corner.", out);
    } else if (space && strcmp(space, "bregma") == 0) {
        fputs(" Positions were AP, ML and DV in mm from bregma, which was taken to be at ", out);
        fprintf(out, bregma ? "AP,DV,ML %s µm of the Allen CCF." : "%s.",
                bregma ? bregma : "the landmark of the International Brain Laboratory in the Allen CCF");
    }
}

static void put_jitter(FILE *out, const struct citation *citation)
{
    const char *jitter = option_value(citation, "jitter");
    const char *samples = option_value(citation, "samples");
    const char *comma = jitter ? strchr(jitter, ',') : NULL;
    if (!jitter) {
        return;
    }
    fprintf(out,
            " The probability of each object to rank first was estimated from %s poses about each given one, drawn "
            "from a Sobol sequence with independent normal errors; their standard deviations were ",
            samples ? samples : "1024");
    if (comma) {
        fprintf(out, "%.*s° of tilt about each of two axes and %s mm of position along each of three.",
                (int)(comma - jitter), jitter, comma + 1);
    } else {
        fputs("those that the file gives for each pose.", out);
    }
}

static void put_program(FILE *out, const struct citation *citation)
{
    fprintf(out, " with conus, version %s", citation->version);
    fputs(citation_has_rays(citation) ? ", which selects by conic volumes after Rick et al. (2010)." : ".", out);
}

static void put_determined(FILE *out, const struct citation *citation)
{
    fprintf(out, "The %s in ", objects_of(citation, MANY, true));
    put_shape(out, citation);
    fputs(" were determined for ", out);
    put_poses(out, citation);
    put_program(out, citation);
    put_range(out, citation);
}

static void put_ball(FILE *out, const struct citation *citation)
{
    double radius = largest_ball(citation);
    if (radius <= CONUS_POINT_RADIUS) { /* a point, or contacts of a probe, without a radius */
        fprintf(out, "The %s that contain a point%s were determined for ", objects_of(citation, MANY, true),
                radius > 0 ? "" : ", or lie nearest to it where none does,");
        put_poses(out, citation);
        put_program(out, citation);
        return;
    }
    put_determined(out, citation);
    fputs(
        " Distances are to the nearest point of an object's voxels (whole cells) or surface; volumes and fractions are "
        "of the voxels with their centre in the ball.",
        out);
}

static void put_cone(FILE *out, const struct citation *citation)
{
    put_determined(out, citation);
    put_rays(out, citation);
    put_score(out, citation);
    put_jitter(out, citation);
    if (option_value(citation, "summary")) {
        fputs(" Reported are the object that ranks first, the runner-up and the difference of their scores.", out);
    }
}

static void put_axis(FILE *out, const struct citation *citation)
{
    fprintf(out,
            "The %s that the device's axis passes, a straight line from the device's position on, were determined "
            "in order of depth for ",
            objects_of(citation, MANY, true));
    put_poses(out, citation);
    put_program(out, citation);
    put_range(out, citation);
    fputs(" Borders are where the axis crosses faces of voxels, or a surface.", out);
}

static void put_clearance(FILE *out, const struct citation *citation)
{
    double radius = json_number_value(setting(citation, "radius_mm"));
    const json_t *within = setting(citation, "within_mm");
    fprintf(out, "The distance of the device's axis, a straight line from the device's position on, from each %s",
            objects_of(citation, ONE, true));
    if (radius > 0) {
        fprintf(out, ", less the needle's radius of %.9g mm (the clearance),", radius);
    }
    fputs(" was determined for ", out);
    put_poses(out, citation);
    put_program(out, citation);
    put_range(out, citation);
    fprintf(out, " Distances are to the nearest point of an object's voxels (whole cells), %s",
            "surface or streamlines, 0 where the axis is in it (Eq. 21 of conus's documentation).");
    if (json_is_number(within)) {
        fprintf(out, " Objects that are farther than %.9g mm away are not reported.", json_number_value(within));
    }
}

static void put_admission(FILE *out, const struct citation *citation)
{
    const char *angle = option_value(citation, "angle");
    double angles[LISTED + 1];
    double least;
    double most;
    size_t count = find_angles(angles, &least, &most, citation);
    fprintf(out,
            "The least full opening angle at which a cone about the device's axis, with its apex at the device's "
            "position, contains a point of each %s was determined, up to %.9g°%s, for ",
            objects_of(citation, ONE, true),
            count   ? most
            : angle ? strtod(angle, NULL)
                    : 10,
            count > 1 ? " (depending on the pose)" : "");
    put_poses(out, citation);
    put_program(out, citation);
    fputs(" Points are the centres of voxels, or all points of a surface; occluded objects count.", out);
    put_range(out, citation);
}

static void put_connections(FILE *out, const struct citation *citation)
{
    const json_t *query = json_array_get(queries(citation), 0);
    double radius = json_number_value(json_object_get(query, "endpoint_radius_mm"));
    double tube = json_number_value(setting(citation, "radius_mm"));
    fputs("The areas at both ends were determined of all streamlines", out);
    if (!question_is(citation, "region", "all")) {
        if (is_ball(citation)) {
            fprintf(out, " that come into a ball of %g mm", json_number_value(json_object_get(query, "radius_mm")));
        } else if (tube > 0) {
            fprintf(out, " that come into a cylinder of %g mm about the device's axis", tube);
        } else {
            fprintf(out, " that come into a cone of %g degrees about the device's axis",
                    json_number_value(json_object_get(query, "angle_deg")));
        }
        fputs(", for ", out);
        put_poses(out, citation);
    }
    put_program(out, citation);
    put_range(out, citation);
    fputs(" An end had the area that it lies in", out);
    if (radius > 0) {
        fprintf(out, ", else the nearest one within %g mm", radius);
    }
    fputs(". Streamlines are a model: their number is not that of axons.", out);
}

static void put_overlap(FILE *out, const struct citation *citation)
{
    size_t count = json_array_size(queries(citation));
    const char *threshold = option_value(citation, "threshold");
    bool is_mesh = json_object_get(json_array_get(queries(citation), 0), "tetrahedra");
    fprintf(out, "The volume that %s of interest has in common with each %s was determined",
            count == 1 ? "a region" : "each of several regions", objects_of(citation, ONE, false));
    put_program(out, citation);
    if (threshold) {
        fprintf(out, " A region was the %s with values of at %s %s.", is_mesh ? "tetrahedra" : "voxels",
                *threshold == '-' ? "most" : "least", threshold);
    } else {
        fputs(" A region was the voxels of a mask that are not 0.", out);
    }
    fputs(is_mesh ? " Volumes are exact for the tetrahedra and voxels as they are; surfaces were measured round lines "
                    "0.5 mm from each other."
                  : " Volumes are exact for the voxels and closed surfaces as they are; what is in no surface, or in "
                    "several that are one area, was measured round 4 × 4 lines through each voxel of the region.",
          out);
}

static void put_clusters(FILE *out, const struct citation *citation)
{
    put_overlap(out, citation);
    fputs(" Voxels with a face, an edge or a corner in common were one cluster", out);
    fputs(option_value(citation, "threshold") ? "; its local maxima were at least 8 mm apart." : ".", out);
}

static void put_plan(FILE *out, const struct citation *citation)
{
    const json_t *plan = json_object_get(citation->sidecar, "Plan");
    const json_t *funnel = json_object_get(plan, "funnel");
    double radius = json_number_value(setting(citation, "radius_mm"));
    const char *rank = option_value(citation, "rank");
    size_t index;
    const json_t *constraint;
    fprintf(out, "A needle%s was tried at %" JSON_INTEGER_FORMAT " candidate poses", radius > 0 ? "" : ", its axis,",
            json_integer_value(json_object_get(plan, "candidates")));
    put_program(out, citation);
    if (radius > 0) {
        fprintf(out, " Its radius was %.9g mm.", radius);
    }
    fputs(" Constraints were ", out);
    json_array_foreach(json_object_get(plan, "constraints"), index, constraint)
    {
        const char *asked = json_string_value(json_object_get(constraint, "asked"));
        fprintf(out, "%s%s", index ? "; " : "", asked ? asked : "another one");
    }
    fprintf(
        out,
        ". %" JSON_INTEGER_FORMAT " poses hold all of them (Eq. 21 and 22 of conus's documentation), and were ranked "
        "by %s. The leeway of a pose is a distance for which is proven that no pose whose axis is off by less breaks "
        "a constraint.",
        json_integer_value(json_array_get(funnel, json_array_size(funnel) - 1)), rank ? rank : "leeway,-depth");
}

/* The first row that fits a question writes its sentences. A row without a region fits any. */
static const struct {
    const char *rows, *region;
    void (*put)(FILE *out, const struct citation *citation);
    bool has_rays;
} sentences[] = {
    {"coverages", NULL, put_overlap, false},
    {"clusters", NULL, put_clusters, false},
    {"connections", NULL, put_connections, false},
    {"admissions", NULL, put_admission, false},
    {"segments", NULL, put_axis, false},
    {"clearances", NULL, put_clearance, false},
    {"answers", "ball", put_ball, false},
    {"answers", NULL, put_cone, true},
    {"summaries", NULL, put_cone, true},
    {"shares", NULL, put_cone, true},
    {"chances", NULL, put_cone, true},
    {"steps", NULL, put_cone, true},
    {"plan", NULL, put_plan, false},
    {"constraints", NULL, put_plan, false},
    {"profile", NULL, put_plan, false},
    {"tolerance", NULL, put_plan, false},
};

/* The index of that row; the number of rows where none fits. */
static size_t find_sentences(const struct citation *citation)
{
    size_t count = sizeof sentences / sizeof sentences[0];
    size_t i = 0;
    while (i < count && !(question_is(citation, "rows", sentences[i].rows) &&
                          (!sentences[i].region || question_is(citation, "region", sentences[i].region)))) {
        i++;
    }
    return i;
}

bool citation_is_known(const struct citation *citation)
{
    return find_sentences(citation) < sizeof sentences / sizeof sentences[0];
}

bool citation_has_rays(const struct citation *citation)
{
    return citation_is_known(citation) && sentences[find_sentences(citation)].has_rays;
}

static void put_bands(FILE *out, const json_t *bands)
{
    size_t index;
    const json_t *band;
    json_array_foreach(bands, index, band)
    {
        const json_t *low = json_object_get(band, "low");
        const json_t *high = json_object_get(band, "high");
        fprintf(out, "%s%s (", index ? ", " : "", json_string_value(json_object_get(band, "name")));
        if (json_is_number(low)) {
            fprintf(out, "from %.9g", json_number_value(low));
        }
        fputs(json_is_number(low) && json_is_number(high) ? " " : "", out);
        if (json_is_number(high)) {
            fprintf(out, "to below %.9g", json_number_value(high));
        }
        fputs(json_is_number(low) || json_is_number(high) ? ")" : "all values)", out);
    }
}

static const char *name_of(const char *path)
{
    return path ? path_name(path) : "a volume";
}

/* The meaning of a volume that has no labels. */
static void put_volume(FILE *out, const json_t *volume, bool is_overlap)
{
    const char *role = json_string_value(json_object_get(volume, "role"));
    const char *file = name_of(json_string_value(json_object_get(volume, "path")));
    const json_t *bands = json_object_get(volume, "bands");
    double threshold = json_number_value(json_object_get(volume, "threshold"));
    if (role && strcmp(role, "pathway") == 0 && bands) {
        fprintf(out, " Values of %s made up ", file);
        put_bands(out, bands);
        fputs(".", out);
    } else if (role && strcmp(role, "pathway") == 0) {
        fprintf(out, " Voxels of %s with values of at least %.9g counted as a pathway.", file, threshold);
    } else if (role && strcmp(role, "probability") == 0) {
        fprintf(out, " Voxels of %s with values of at least %.9g counted as an area.", file, threshold);
    } else if (role && strcmp(role, "context") == 0 && threshold != 0 && !is_overlap) {
        fprintf(out, " Voxels of %s with values of at least %.9g blocked the rays.", file, threshold);
    }
}

/* Equal sentences of many volumes are one. */
static void put_volumes(FILE *out, const json_t *volumes, bool is_overlap)
{
    size_t size = json_array_size(volumes);
    size_t index;
    const json_t *volume;
    size_t listed = 0;
    json_array_foreach(volumes, index, volume)
    {
        const char *role = json_string_value(json_object_get(volume, "role"));
        bool is_labels = role && strcmp(role, "parcellation") == 0;
        if (!is_labels && listed++ < LISTED) {
            put_volume(out, volume, is_overlap);
        }
    }
    if (listed > LISTED) {
        fprintf(out, " So did those of %zu more of the %zu volumes, each from its own threshold on.", listed - LISTED,
                size);
    }
}

static void put_tractograms(FILE *out, const json_t *tractograms, bool has_rays)
{
    size_t size = json_array_size(tractograms);
    for (size_t i = 0; i < size && i < LISTED; i++) {
        const json_t *entry = json_array_get(tractograms, i);
        fprintf(out, " The %" JSON_INTEGER_FORMAT " streamlines of %s counted as lines",
                json_integer_value(json_object_get(entry, "streamlines")),
                name_of(json_string_value(json_object_get(entry, "path"))));
        if (has_rays) {
            fprintf(out, "; rays hit them as tubes of radius %.9g mm",
                    json_number_value(json_object_get(entry, "radius_mm")));
        }
        fputc('.', out);
    }
    if (size > LISTED) {
        fprintf(out, " So did those of %zu more tractograms%s.", size - LISTED,
                has_rays ? ", each of its own radius" : "");
    }
}

/* How the atlas came to where it was asked. */
static void put_way(FILE *out, const json_t *atlas)
{
    size_t fields = 0;
    size_t affines = 0;
    size_t index;
    const json_t *step;
    json_array_foreach(json_object_get(atlas, "way_to_atlas"), index, step)
    {
        const json_t *matrix = json_object_get(step, "matrix");
        fields += json_object_get(step, "field") != NULL;
        bool is_identity = true;
        for (size_t i = 0; i < 16; i++) {
            double number = json_number_value(json_array_get(json_array_get(matrix, i / 4), i % 4));
            is_identity = is_identity && number == (i % 5 == 0);
        }
        affines += matrix && !is_identity;
    }
    if (fields) {
        fprintf(out, " It was brought into the space of the positions by %s%s.",
                fields == 1 ? "a deformation field" : "several deformation fields",
                affines ? " and affine transforms" : "");
        fputs(json_array_size(json_object_get(atlas, "volumes"))
                  ? " Its voxels were resampled by the nearest neighbour."
                  : "",
              out);
    } else if (json_object_get(atlas, "atlas_from_world")) {
        fputs(" It was brought into the space of the positions by an affine transform, without resampling.", out);
    }
}

static void put_treatment(FILE *out, const struct citation *citation, const json_t *atlas)
{
    const char *hemispheres = json_string_value(json_object_get(atlas, "hemispheres"));
    const char *hidden = json_string_value(json_object_get(atlas, "hidden"));
    const char *level = json_string_value(json_object_get(atlas, "level"));
    level = level ? level : json_string_value(setting(citation, "level"));
    put_volumes(out, json_object_get(atlas, "volumes"), is_of(citation, "overlap"));
    put_tractograms(out, json_object_get(atlas, "tractograms"), citation_has_rays(citation));
    if (level) {
        fprintf(out, " Areas were joined along the area tree to the level \"%s\".", level);
    }
    if (hidden) {
        fputs(" Some of its objects were left out, as if they were not there", out);
        fprintf(out, "%s%s.", strlen(hidden) < 200 ? ", by label: " : "; the sidecar lists them",
                strlen(hidden) < 200 ? hidden : "");
    }
    if (hemispheres && strcmp(hemispheres, "split") == 0) {
        fputs(" Areas on both sides were cut in two at x = 0 of the atlas.", out);
    } else if (hemispheres && strcmp(hemispheres, "merged") == 0) {
        fputs(" Left and right areas of one name were joined.", out);
    }
    put_way(out, atlas);
}

/* The sentences of an atlas, each after a space. */
static void put_atlas(FILE *out, const struct citation *citation, size_t index)
{
    const struct cited_atlas *atlas = &citation->atlases[index];
    const json_t *several = json_object_get(citation->sidecar, "Atlases");
    const json_t *own = several ? json_array_get(several, index) : json_object_get(citation->sidecar, "Atlas");
    const json_t *volume = json_array_get(json_object_get(own, "volumes"), 0);
    const char *transform = json_string_value(json_object_get(volume, "transform"));
    fprintf(out, " %s %s (file %s", index ? "Another atlas, asked by itself, was" : "The atlas was", atlas->name,
            atlas->file);
    if (atlas->sha256) {
        fprintf(out, ", SHA-256 %.8s…", atlas->sha256);
    }
    if (transform && *transform) {
        /* "sform, code 1 (scanner)", "the Allen CCF's grid", "none: voxel sizes only, ..." */
        static const char none[] = "none: ";
        bool is_none = strncmp(transform, none, sizeof none - 1) == 0;
        bool is_its = !is_none && strncmp(transform, "the ", 4) != 0;
        fprintf(out, ", placed by %s%s", is_its ? "its " : "", transform + (is_none ? sizeof none - 1 : 0));
    }
    fputs(atlas->references.count ? "; see the references)." : ").", out);
    put_treatment(out, citation, own);
}

void citation_methods(FILE *out, const struct citation *citation)
{
    static const char *const no_device[] = {"volume", "all", "ball"};
    bool has_device = true;
    if (!citation->sidecar) {
        const struct cited_atlas *atlas = &citation->atlases[0];
        fprintf(out, "Areas are those of the atlas %s (file %s", atlas->name, atlas->file);
        if (atlas->sha256) {
            fprintf(out, ", SHA-256 %.8s…", atlas->sha256);
        }
        fprintf(out, "), as read by conus, version %s.", citation->version);
        return;
    }
    sentences[find_sentences(citation)].put(out, citation);
    put_space(out, citation);
    for (size_t i = 0; i < citation->atlas_count; i++) {
        put_atlas(out, citation, i);
    }
    for (size_t i = 0; i < sizeof no_device / sizeof no_device[0]; i++) {
        has_device = has_device && !question_is(citation, "region", no_device[i]);
    }
    if (has_device) {
        fprintf(out, " %s is a geometric model: no field, heat or sound was computed.", shape_of(citation));
    }
}
