/* SPDX-License-Identifier: BSD-3-Clause */
/* JSON: the whole report with its provenance, and the sidecars of tables and grids. */
#include "atlas/space.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "base/text.h"
#include "conus/own.h"
#include "selection/report/parts.h"
#include "selection/study/study.h"

#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

/* Digits of numbers; jansson allows one value for a whole text. */
static size_t digits(const conus_report *report)
{
    return report->options.tracker ? JSON_REAL_PRECISION(TEXT_TIME_DIGITS) : JSON_REAL_PRECISION(9);
}

/* Takes any bytes: paths and command lines need not be UTF-8. */
static json_t *json_from_text(const char *text)
{
    char *copy = text_to_utf8(text_from(text));
    json_t *string = copy ? json_string(copy) : NULL;
    memory_free(copy);
    return string;
}

static bool put_value(json_t *object, const char *key, json_t *value)
{
    return json_object_set_new(object, key, value) == 0;
}

/* The value if it is whole, else NULL. */
static json_t *whole_or_null(json_t *value, bool whole)
{
    if (!whole) {
        json_decref(value);
    }
    return whole ? value : NULL;
}

static json_t *json_from_cell(struct cell cell)
{
    switch (cell.type) {
    case CELL_TEXT:
        return json_from_text(cell.text);
    case CELL_INTEGER:
        return json_integer((json_int_t)cell.integer);
    case CELL_NUMBER:
    case CELL_TIME:
        return json_real(cell.number);
    case CELL_NONE:
        break;
    }
    return json_null();
}

/* Whether JSON holds the text as it is. */
static bool text_is_plain(const char *text)
{
    while (*text >= ' ' && *text <= '~' && *text != '"' && *text != '\\') {
        text++;
    }
    return !*text;
}

static int append(const char *text, size_t size, void *out)
{
    buffer_append(out, text, size);
    return 0;
}

/* Appends the text of `root`, which is taken over. */
static conus_status dump(struct buffer *out, json_t *root, size_t flags)
{
    int failed = root ? json_dump_callback(root, append, out, flags) : -1;
    json_decref(root);
    if (failed) {
        return fail(CONUS_ERROR_MEMORY, "no memory for the JSON report");
    }
    buffer_text(out, "\n");
    return CONUS_OK;
}

static json_t *json_from_matrix(const double m[16])
{
    json_t *rows = json_array();
    bool whole = true;
    for (int row = 0; row < 4; row++) {
        json_t *numbers = json_pack("[f, f, f, f]", m[row], m[4 + row], m[8 + row], m[12 + row]);
        whole = json_array_append_new(rows, numbers) == 0 && whole;
    }
    return whole_or_null(rows, whole);
}

static json_t *json_from_shape(const struct report_query *query)
{
    if (query->asked.region.path) {
        const struct table_region *roi = &query->asked.region;
        json_t *entry = json_pack("{s: o, s: o, s: s, s: I, s: f}", "query", json_from_text(query->id), "path",
                                  json_from_text(roi->path), "sha256", roi->sha256, "volume", (json_int_t)roi->volume,
                                  "volume_mm3", roi->volume_mm3);
        bool whole = roi->threshold == 0 || put_value(entry, "threshold", json_real(roi->threshold));
        whole =
            whole && (!roi->tetrahedra || put_value(entry, "tetrahedra", json_integer((json_int_t)roi->tetrahedra)));
        return whole_or_null(entry, whole);
    }
    if (query->error) {
        return json_pack("{s: o, s: o}", "query", json_from_text(query->id), "error", json_from_text(query->error));
    }
    if (query->asked.ball > 0) {
        const double *m = query->asked.cone.pose.world_from_device;
        return json_pack("{s: o, s: [f, f, f], s: f}", "query", json_from_text(query->id), "point_ras", m[12], m[13],
                         m[14], "radius_mm", query->is_point ? 0 : query->asked.ball);
    }
    if (query->asked.is_whole) {
        return json_pack("{s: o}", "query", json_from_text(query->id));
    }
    if (query->asked.is_axis) {
        return json_pack("{s: o, s: o}", "query", json_from_text(query->id), "world_from_device_ras",
                         json_from_matrix(query->asked.cone.pose.world_from_device));
    }
    json_t *cone = json_pack("{s: o, s: f, s: i, s: o}", "query", json_from_text(query->id), "angle_deg",
                             query->asked.cone.degrees, "cone_pixels", (int)query->cone_pixels, "world_from_device_ras",
                             json_from_matrix(query->asked.cone.pose.world_from_device));
    return whole_or_null(cone, !cone_is_wide(&query->asked.cone) || put_value(cone, "spread", json_string("even")));
}

/* Which pose of its file it is, and when. */
static bool add_marks(json_t *entry, const conus_report *report, const struct report_query *query)
{
    const conus_row_marks *marks = report_marks(report);
    bool has_time = marks && marks->has_time && isfinite(query->time_s);
    return (!marks || !marks->has_number || put_value(entry, "row", json_integer((json_int_t)query->number))) &&
           (!has_time || put_value(entry, "time_s", json_real(query->time_s)));
}

static json_t *json_from_queries(const conus_report *report)
{
    json_t *queries = json_array();
    bool whole = true;
    for (size_t i = 0; i < report->query_count; i++) {
        const struct report_query *query = &report->queries[i];
        json_t *entry = json_from_shape(query);
        const double *range = query->asked.cone.range;
        bool has_range =
            !query->error && (range[0] != report->selector.range[0] || range[1] != report->selector.range[1]);
        whole = (!has_range || put_value(entry, "range_mm", json_pack("[f, f]", range[0], range[1]))) && whole;
        whole = add_marks(entry, report, query) && whole;
        bool has_radius = !query->error && report->options.rows == CONUS_ROWS_CONNECTIONS;
        whole = (!has_radius || put_value(entry, "endpoint_radius_mm", json_real(query->asked.end_radius))) && whole;
        whole = json_array_append_new(queries, entry) == 0 && whole;
    }
    return whole_or_null(queries, whole);
}

/* null where a band has no end, and where there is no length. */
static json_t *json_from_end(double end)
{
    return isfinite(end) ? json_real(end) : json_null();
}

static json_t *json_from_volume(const conus_atlas *atlas, size_t index)
{
    const conus_volume_info *info = conus_atlas_volume(atlas, index);
    json_t *bands = json_array();
    bool whole = bands;
    for (size_t i = atlas->area_count; i < atlas->object_count; i++) {
        const conus_object *band = &atlas->objects[i];
        if (band->is_band && band->volume == index) {
            whole = json_array_append_new(bands, json_pack("{s: o, s: o, s: o}", "name", json_from_text(band->name),
                                                           "low", json_from_end(band->low), "high",
                                                           json_from_end(band->high))) == 0 &&
                    whole;
        }
    }
    static const char *const roles[] = {"", "parcellation", "pathway", "context", "probability"};
    json_t *volume = json_pack("{s: s, s: o, s: s, s: s, s: I, s: s, s: s, s: o}", "role", roles[info->role], "path",
                               json_from_text(info->path), "sha256", info->sha256, "format", info->format, "volume",
                               (json_int_t)info->volume, "orientation", info->orientation, "transform", info->transform,
                               "world_from_voxel", json_from_matrix(info->world_from_voxel));
    bool has_bands = json_array_size(bands) > 0;
    bool has_none = has_bands || (info->role != CONUS_ROLE_SCALAR && info->threshold == 0);
    whole = whole && (has_none || put_value(volume, "threshold", json_real(info->threshold)));
    whole = whole && (!has_bands || json_object_set(volume, "bands", bands) == 0);
    json_decref(bands);
    return whole_or_null(volume, whole);
}

/* A folder has no sum: its files are among those of the atlas, with theirs. */
static bool add_tractograms(json_t *root, const conus_atlas *atlas)
{
    json_t *list = json_array();
    bool whole = list;
    for (size_t i = 0; i < atlas->tractogram_count; i++) {
        const struct tractogram *tractogram = &atlas->tractograms[i];
        const char *sum = tractogram->sha256;
        json_t *entry = json_pack("{s: o, s: s, s: I, s: I, s: f}", "path", json_from_text(tractogram->path), "format",
                                  tractogram->format, "streamlines", (json_int_t)tractogram->streamline_count, "points",
                                  (json_int_t)tractogram->point_count, "radius_mm", tractogram->radius);
        whole = (!*sum || put_value(entry, "sha256", json_string(sum))) && whole;
        whole = json_array_append_new(list, entry) == 0 && whole;
    }
    whole = whole && (!atlas->tractogram_count || json_object_set(root, "tractograms", list) == 0);
    json_decref(list);
    return whole;
}

/* The hidden objects, if there are any. */
static bool add_hidden(json_t *root, const conus_atlas *atlas)
{
    struct buffer text = {0};
    atlas_list_hidden(&text, atlas);
    bool whole = !buffer_status(&text) && (!text.size || put_value(root, "hidden", json_string(text.data)));
    buffer_finish(&text);
    return whole;
}

/* The transforms from the world to the atlas's own space, in this order: matrices and fields in turn. In a field a node
 * at q goes to base q + linear v; in a spline v is the coefficients' sum. */
static json_t *json_from_way(const conus_atlas *atlas)
{
    json_t *way = json_array();
    bool whole =
        json_array_append_new(way, json_pack("{s: o}", "matrix", json_from_matrix(atlas->own_from_world))) == 0;
    for (size_t i = atlas->warp_count; i > 0; i--) {
        const struct warp *warp = &atlas->warps[i - 1];
        const struct deformation *field = &warp->field;
        json_t *dim =
            json_pack("[I, I, I]", (json_int_t)field->dim[0], (json_int_t)field->dim[1], (json_int_t)field->dim[2]);
        const char *kind = field->coefficients ? "spline" : "field";
        json_t *entry = json_pack("{s: {s: o, s: o, s: o, s: o}}", kind, "dim", dim, "world_from_voxel",
                                  json_from_matrix(field->world_from_voxel), "base", json_from_matrix(field->base),
                                  "linear", json_from_matrix(field->linear));
        whole = json_array_append_new(way, entry) == 0 &&
                json_array_append_new(way, json_pack("{s: o}", "matrix", json_from_matrix(warp->after))) == 0 && whole;
    }
    return whole_or_null(way, whole);
}

static json_t *json_from_atlas(const conus_atlas *atlas)
{
    json_t *volumes = json_array();
    json_t *files = json_array(); /* the manifest and the surfaces, if there are any */
    json_t *notes = json_array();
    bool whole = true;
    for (size_t i = 0; i < conus_atlas_volume_count(atlas); i++) {
        whole = json_array_append_new(volumes, json_from_volume(atlas, i)) == 0 && whole;
    }
    for (size_t i = 0; i < atlas->files.count; i++) {
        const struct file_sum *file = &atlas->files.items[i];
        json_t *entry = json_pack("{s: o, s: s}", "path", json_from_text(file->path), "sha256", file->sha256);
        whole = json_array_append_new(files, entry) == 0 && whole;
    }
    for (size_t i = 0; i < conus_atlas_note_count(atlas); i++) {
        whole = json_array_append_new(notes, json_from_text(conus_atlas_note(atlas, i))) == 0 && whole;
    }
    static const char *const hemispheres[] = {"as-is", "split", "merged"};
    json_t *labels = json_from_text(conus_atlas_label_source(atlas));
    json_t *root = json_pack("{s: o, s: o, s: s, s: s*, s: o, s: o, s: o}", "path", json_from_text(atlas_path(atlas)),
                             "labels", labels, "hemispheres", hemispheres[atlas->hemispheres], "template",
                             space_brain_word(atlas->brain), "volumes", volumes, "files", files, "notes", notes);
    bool affine = atlas->is_moved && !atlas->warp_count;
    if (atlas->pack) {
        whole = put_value(root, "pack",
                          json_pack("{s: o, s: s}", "path", json_from_text(atlas->pack->info.path), "sha256",
                                    atlas->pack->sha256)) &&
                whole;
    }
    whole = (!affine || put_value(root, "atlas_from_world", json_from_matrix(atlas->own_from_world))) && whole;
    whole = (!atlas->warp_count || put_value(root, "way_to_atlas", json_from_way(atlas))) && whole;
    return whole_or_null(root, add_tractograms(root, atlas) && add_hidden(root, atlas) && whole);
}

/* The constants of a track (Eq. 12), if it is one. */
static bool add_track(json_t *settings, const conus_tracker *tracker)
{
    if (!tracker) {
        return true;
    }
    const conus_tracker_options *options = tracker_options(tracker);
    return put_value(settings, "track",
                     json_pack("{s: f, s: f, s: f, s: f, s: f, s: f, s: f, s: f}", "window_s", options->window,
                               "stickiness", options->stickiness, "snappiness", options->snappiness, "rate_hz",
                               options->rate, "growth_per_s", options->growth, "decay_per_s", options->decay,
                               "exponent", options->exponent, "delay_s", options->delay));
}

/* The weight of rays (Eq. 30) and the prior (Eq. 32), if there is one; the files of both are among the inputs. */
static bool add_weight(json_t *settings, const conus_report *report)
{
    const struct weight_facts *weight = &report->weight;
    const struct prior *prior = &report->prior;
    if (!weight->form) {
        return true;
    }
    static const char *const levels[] = {
        [ABOVE_AREAS] = "largest_in_areas", [ABOVE_LARGEST] = "largest", [ABOVE_LEVEL] = "weight"};
    static const char *const owns[] = {[WEIGHT_BY_ANGLE] = "own_angle_deg",
                                       [WEIGHT_BY_OFFSET] = "own_radius_mm",
                                       [WEIGHT_BY_DISTANCE] = "own_ball_mm"};
    json_t *entry = json_pack("{s: s}", "form", weight->form);
    json_t *numbers = json_array();
    for (size_t i = 0; i < weight->number_count; i++) {
        (void)json_array_append_new(numbers, json_real(weight->numbers[i]));
    }
    const bool is_angle = weight->by == WEIGHT_BY_ANGLE;
    const bool has_doses = report->selector.layers || report->options.points;
    bool whole =
        entry && json_array_size(numbers) == weight->number_count && put_value(entry, "numbers", numbers) &&
        (weight->sigma == 0 || put_value(entry, "sigma_deg", json_real(weight->sigma))) &&
        (weight->rows == 0 || put_value(entry, "rows", json_integer((json_int_t)weight->rows))) &&
        (!weight->unit[0] || put_value(entry, "unit", json_string(weight->unit))) &&
        (weight->own == 0 || put_value(entry, owns[weight->by], json_real(weight->own))) &&
        (weight->depth[1] == 0 ||
         put_value(entry, "own_range_mm", json_pack("[f, f]", weight->depth[0], weight->depth[1]))) &&
        (!has_doses ||
         put_value(entry, "above", json_pack("{s: s, s: f}", "of", levels[weight->above], "level", weight->level))) &&
        (!is_angle || put_value(entry, "bias_deg", json_pack("[f, f]", weight->bias[0], weight->bias[1]))) &&
        (!weight->error.name || put_value(entry, "error",
                                          json_pack("{s: s, s: s, s: s}", "name", weight->error.name, "measured",
                                                    weight->error.measured, "source", weight->error.source)));
    whole = put_value(settings, "weight", entry) && whole;
    const char *of = prior->of_file ? "file" : prior->by_size ? "size" : "equal";
    return whole && (prior->power == 0 ||
                     put_value(settings, "prior", json_pack("{s: s, s: f}", "of", of, "power", prior->power)));
}

/* Labels of a list: it may have come from a file that changes. */
static json_t *json_from_level_areas(const conus_report *report)
{
    json_t *labels = json_array();
    bool whole = true;
    for (size_t i = 0; i < report->level_area_count; i++) {
        json_t *label = json_integer(report->atlas->objects[report->level_areas[i] - 1].label);
        whole = json_array_append_new(labels, label) == 0 && whole;
    }
    return whole_or_null(labels, whole);
}

/* The areas that are reported, if there is a level. */
static bool add_level(json_t *object, const conus_report *report)
{
    return (!report->level || put_value(object, "level", json_from_text(report->level))) &&
           (!report->level_area_count || put_value(object, "level_areas", json_from_level_areas(report)));
}

/* Reports that are joined differ in no setting but the level, which therefore is the atlas's. */
static json_t *json_from_atlases(const conus_report *report)
{
    json_t *atlases = json_array();
    bool whole = true;
    for (; report; report = report->next) {
        json_t *named = json_pack("{s: o}", "name", json_from_text(report->name));
        json_t *atlas = json_from_atlas(report->atlas);
        whole = json_object_update(named, atlas) == 0 && add_level(named, report) && whole;
        whole = json_array_append_new(atlases, named) == 0 && whole;
        json_decref(atlas);
    }
    return whole_or_null(atlases, whole);
}

static bool add_range(json_t *settings, const conus_selector_options *options)
{
    return options->range[1] == 0 ||
           put_value(settings, "range_mm", json_pack("[f, f]", options->range[0], options->range[1]));
}

/* The shape that streamlines are to come into, where it is not a query's own cone; the needle of a plan. */
static bool add_shape(json_t *settings, const conus_report *report)
{
    const conus_selector_options *options = &report->selector;
    bool of_connections = report->options.rows == CONUS_ROWS_CONNECTIONS;
    bool has_radius = options->radius > 0 && (of_connections || report->plan.count > 0);
    return (!of_connections ||
            put_value(settings, "aperture",
                      json_string(options->aperture == CONUS_APERTURE_SQUARE ? "square" : "circle"))) &&
           (!has_radius || put_value(settings, "radius_mm", json_real(options->radius)));
}

/* Its radius, and how far it looks; null = as far as there are objects. */
static bool add_needle(json_t *settings, const conus_report *report)
{
    return report->options.rows != CONUS_ROWS_CLEARANCES ||
           (put_value(settings, "radius_mm", json_real(report->selector.radius)) &&
            put_value(settings, "within_mm", json_from_end(report->options.within)));
}

static json_t *json_from_contacts(const conus_contacts *contacts)
{
    return json_pack("{s: I, s: I, s: f, s: f}", "count", (json_int_t)contacts->count, "columns",
                     (json_int_t)contacts->columns, "pitch_mm", contacts->pitch, "tip_mm", contacts->tip);
}

/* How many trials the first row is of. */
static bool add_trials(json_t *settings, const conus_report *report)
{
    const int64_t *trials = report->query_count ? conus_table_counts(report->queries[0].table, "n") : NULL;
    return !trials || put_value(settings, "trials", json_integer(trials[0]));
}

static json_t *json_from_settings(const conus_report *report)
{
    const conus_selector_options *options = &report->selector;
    conus_rows rows = report->options.rows;
    bool has_axes = report_is_of_axes(rows) || rows == CONUS_ROWS_CONNECTIONS || report->plan.count > 0;
    if (rows == CONUS_ROWS_NEEDLES || rows == CONUS_ROWS_PAIRS || !report_has_atlas(report)) { /* each has its own */
        json_t *few = json_object();
        const bool has_head = rows == CONUS_ROWS_POSITIONS && report->query_count;
        const char *head = has_head && report_is_of_scalp(report->queries[0].table) ? "own" : "MNI 152";
        return whole_or_null(few, add_trials(few, report) && (!has_head || put_value(few, "head", json_string(head))));
    }
    if (has_axes || rows == CONUS_ROWS_COVERAGES || rows == CONUS_ROWS_CLUSTERS) { /* which have no rays of pixels */
        json_t *few = json_object();
        bool level_is_there = has_axes && report->name; /* in that of each atlas */
        return whole_or_null(few, (!has_axes || add_range(few, options)) && add_shape(few, report) &&
                                      add_needle(few, report) && (level_is_there || add_level(few, report)));
    }
    json_t *settings = json_pack(
        "{s: s, s: s, s: i, s: s, s: s}", "engine", report->engine, "sampling",
        options->sampling == CONUS_SAMPLING_SLICES ? "slices" : "exact", "resolution", (int)options->resolution,
        "aperture", options->aperture == CONUS_APERTURE_SQUARE ? "square" : "circle", "score", report->score);
    bool whole =
        options->sampling != CONUS_SAMPLING_SLICES ||
        (put_value(settings, "slices", options->slices ? json_integer(options->slices) : json_string("auto")) &&
         put_value(settings, "slice_fraction", json_real(options->slice_fraction)));
    whole = whole && put_value(settings, "layers", json_string(options->layers ? "all" : "visible")) &&
            (options->radius == 0 || put_value(settings, "radius_mm", json_real(options->radius))) &&
            add_range(settings, options);
    whole = (!report->options.order || put_value(settings, "order", json_string("depth"))) && whole;
    const conus_contacts *contacts = &report->options.contacts;
    if (contacts->count) {
        whole = put_value(settings, "contacts", json_from_contacts(contacts)) && whole;
    }
    bool tells = options->radius == 0 && (report->is_begun || !report->query_count); /* no query tells it (Eq. 15) */
    whole = (!tells || put_value(settings, "spread", json_string("even beyond 120 degrees"))) && whole;
    whole = (report->name || add_level(settings, report)) && whole;
    return whole_or_null(settings, whole && add_weight(settings, report) && add_trials(settings, report) &&
                                       add_track(settings, report->options.tracker));
}

static json_t *json_from_constraint(const struct report_constraint *constraint)
{
    json_t *entry =
        json_pack("{s: s, s: I, s: f, s: o}", "kind", constraint->kind, "index", (json_int_t)constraint->index, "limit",
                  constraint->asked->limit, "asked", json_from_text(constraint->words));
    bool whole = (!constraint->name || put_value(entry, "name", json_from_text(constraint->name))) &&
                 (!constraint->measure || put_value(entry, "measure", json_string(constraint->measure))) &&
                 (!constraint->asked->contacts.count ||
                  put_value(entry, "contacts", json_from_contacts(&constraint->asked->contacts)));
    return whole_or_null(entry, whole);
}

/* The pose that breaks only this constraint, null where there is none. */
static json_t *json_from_miss(const struct report_constraint *constraint, size_t index)
{
    const conus_planned *pose = constraint->miss;
    if (!pose) {
        return json_null();
    }
    return json_pack("{s: o, s: f, s: f}", "query", json_from_text(pose->id), "value", pose->verdicts[index].value,
                     "slack", pose->verdicts[index].slack);
}

/* The errors of all poses: of tilt and position, or of both ends and the depth. */
static bool add_errors(json_t *plan, const conus_jitter_options *jitter)
{
    bool of_ends = jitter && (jitter->entry > 0 || jitter->target > 0 || jitter->depth > 0);
    return !jitter ||
           put_value(plan, "jitter",
                     of_ends ? json_pack("{s: I, s: f, s: f, s: f}", "samples", (json_int_t)jitter->samples, "entry_mm",
                                         jitter->entry, "target_mm", jitter->target, "depth_mm", jitter->depth)
                             : json_pack("{s: I, s: f, s: f}", "samples", (json_int_t)jitter->samples, "error_deg",
                                         jitter->tilt, "error_mm", jitter->shift));
}

static bool add_plan(json_t *root, const struct report_plan *plan)
{
    json_t *constraints = json_array();
    json_t *funnel = json_array();
    json_t *misses = json_array();
    bool whole = true;
    for (size_t i = 0; i < plan->count; i++) {
        const struct report_constraint *constraint = &plan->constraints[i];
        whole = json_array_append_new(constraints, json_from_constraint(constraint)) == 0 && whole;
        whole = json_array_append_new(funnel, json_integer((json_int_t)constraint->left)) == 0 && whole;
        whole = json_array_append_new(misses, json_from_miss(constraint, i)) == 0 && whole;
    }
    json_t *object =
        json_pack("{s: I, s: I, s: o, s: o, s: o}", "candidates", (json_int_t)plan->candidates, "no_candidates",
                  (json_int_t)plan->rejected, "constraints", constraints, "funnel", funnel, "nearest_misses", misses);
    return put_value(root, "Plan", whole_or_null(object, whole && add_errors(object, plan->jitter)));
}

static json_t *json_from_part(const conus_part *part)
{
    return json_pack("{s: f, s: s, s: [[f, f, f], [f, f, f]]}", "radius_mm", part->radius, "from",
                     part->from_tip ? "tip" : "position", "points", part->x, part->y, part->low, part->x, part->y,
                     part->high);
}

/* A question, and how many candidates answer it. */
static json_t *json_from_question(const struct report_needles *needles, size_t index)
{
    const struct report_question *question = &needles->questions[index];
    const conus_answered *answered = question->answered;
    json_t *names = json_array();
    json_t *shanks = json_array();
    json_t *parts = json_array();
    json_t *constraints = json_array();
    json_t *funnel = json_array();
    bool whole = true;
    for (size_t i = 0; i < answered->needle_count; i++) {
        json_t *name = json_from_text(needles->at[answered->needles[i]]->name);
        whole = json_array_append_new(names, name) == 0 && whole;
    }
    for (size_t i = 0; i < answered->shank_count; i++) {
        json_t *shank = json_pack("[f, f]", answered->shanks[2 * i], answered->shanks[2 * i + 1]);
        whole = json_array_append_new(shanks, shank) == 0 && whole;
    }
    for (size_t i = 0; i < answered->part_count; i++) {
        whole = json_array_append_new(parts, json_from_part(&answered->parts[i])) == 0 && whole;
    }
    for (size_t i = 0; i < question->plan.count; i++) {
        const struct report_constraint *constraint = &question->plan.constraints[i];
        whole = json_array_append_new(constraints, json_from_constraint(constraint)) == 0 && whole;
        whole = json_array_append_new(funnel, json_integer((json_int_t)constraint->left)) == 0 && whole;
    }
    json_t *object = json_pack("{s: o, s: b, s: f, s: o, s: o, s: I, s: I, s: o, s: o, s: I}", "needles", names, "once",
                               answered->once, "radius_mm", answered->radius, "shanks", shanks, "parts", parts,
                               "candidates", (json_int_t)question->plan.candidates, "no_candidates",
                               (json_int_t)question->plan.rejected, "constraints", constraints, "funnel", funnel,
                               "feasible", (json_int_t)question->plan.constraints[question->plan.count - 1].left);
    return whole_or_null(object, whole);
}

/* null where there is none */
static json_t *json_from_conflict(const struct report_needles *needles)
{
    const conus_conflict *conflict = needles->conflict;
    json_t *names = conflict ? json_array() : NULL;
    bool whole = true;
    for (size_t i = 0; conflict && i < conflict->count; i++) {
        const conus_placed *placed = needles->at[conflict->needles[i]];
        whole = json_array_append_new(names, json_from_text(placed->name)) == 0 && whole;
    }
    return !conflict ? json_null()
                     : whole_or_null(json_pack("{s: o, s: o, s: o}", "needles", names, "between_mm",
                                               json_from_end(conflict->between), "entry_distance_mm",
                                               json_from_end(conflict->entry_distance)),
                                     whole);
}

/* The combinations that hold. *nodes: of the search. */
static json_t *json_from_combinations(uint64_t *nodes, const struct report_needles *needles)
{
    json_t *list = json_array();
    bool whole = true;
    for (size_t n = 0; n < needles->combination_count; n++) {
        const conus_combination *combination = needles->combinations[n];
        *nodes = combination->nodes;
        if (combination->feasible) {
            json_t *entry = json_pack("{s: b, s: o, s: b}", "proven", combination->proven, "bound_mm",
                                      json_from_end(combination->bound), "last", combination->last);
            whole = json_array_append_new(list, entry) == 0 && whole;
        }
    }
    return whole_or_null(list, whole);
}

static bool add_needles(json_t *root, const struct report_needles *needles)
{
    json_t *rows = json_array();
    json_t *list = json_array();
    const conus_together_options *asked = needles->asked;
    uint64_t nodes = 0;
    json_t *combinations = json_from_combinations(&nodes, needles);
    bool whole = true;
    for (size_t i = 0; i < needles->count; i++) {
        const conus_placed *placed = needles->at[i];
        json_t *needle =
            json_pack("{s: o, s: b, s: o, s: o}", "name", json_from_text(placed->name), "given", placed->given != NULL,
                      "largest_leeway_mm", json_from_end(placed->largest), "cut_mm", json_from_end(placed->cut));
        whole = json_array_append_new(list, needle) == 0 && whole;
    }
    for (size_t i = 0; i < needles->question_count; i++) {
        whole = json_array_append_new(rows, json_from_question(needles, i)) == 0 && whole;
    }
    json_t *diverse = asked->top == 1
                          ? json_null()
                          : json_pack("{s: f, s: I}", "apart_mm", asked->diverse, "needles", (json_int_t)asked->differ);
    json_t *object = json_pack("{s: s, s: {s: f, s: f}, s: f, s: I, s: o, s: I, s: o, s: o, s: o, s: o}", "rank",
                               "leeway,sum,-depth", "between", "shafts_mm", asked->between, "parts_mm", asked->parts,
                               "entry_distance_mm", asked->entry_distance, "top", (json_int_t)asked->top, "diverse",
                               diverse, "nodes", (json_int_t)nodes, "rows", rows, "needles", list, "combinations",
                               combinations, "conflict", json_from_conflict(needles));
    return put_value(root, "Plan", whole_or_null(object, whole));
}

/* The sources; queries are always in RAS. */
static bool add_sources(json_t *root, const conus_report *report)
{
    json_t *program = json_pack("{s: s, s: s}", "Name", "conus", "Version", CONUS_VERSION);
    const char *command = report->options.command;
    bool whole = !command || put_value(program, "CommandLine", json_from_text(command));
    return put_value(root, "GeneratedBy", json_pack("[o]", program)) && whole &&
           (!report_has_atlas(report) || (report->name ? put_value(root, "Atlases", json_from_atlases(report))
                                                       : put_value(root, "Atlas", json_from_atlas(report->atlas)))) &&
           put_value(root, "Settings", json_from_settings(report)) &&
           (!report->plan.count || add_plan(root, &report->plan)) &&
           (!report->needles.count || add_needles(root, &report->needles)) &&
           (report->is_begun || report_has_no_queries(report) ||
            put_value(root, "Queries", json_from_queries(report))); /* else they are forgotten */
}

/* The space of positions in rows: x, y and z are the axes in their order. */
static json_t *json_from_space(const conus_frame *frame)
{
    static const char *const names[] = {"RAS", "LPS", "CCF", "bregma"};
    json_t *space =
        json_pack("{s: s, s: s}", "orientation", names[frame->space], "units", conus_space_unit(frame->space));
    bool plain = frame->space < CONUS_SPACE_CCF;
    bool whole = plain || put_value(space, "axes",
                                    json_pack("[s, s, s]", conus_space_axis(frame->space, 0),
                                              conus_space_axis(frame->space, 1), conus_space_axis(frame->space, 2)));
    whole = whole && (plain || put_value(space, "world_from_space", json_from_matrix(frame->world_from_space)));
    return whole_or_null(space, whole);
}

/* How words were understood; their points are in the space of the rows. */
static json_t *json_from_places(const conus_report *report)
{
    static const char *const kinds[] = {"numbers", "inner point", "centroid", "nearest point", "position"};
    json_t *list = json_array();
    bool whole = list;
    for (size_t i = 0; i < report->options.place_count && whole; i++) {
        const conus_named_place *named = &report->options.places[i];
        if (named->is_sentence) {
            continue;
        }
        const conus_place *place = &named->place;
        const conus_object *object = conus_atlas_object(report->atlas, place->object);
        double at[3];
        conus_frame_from_world(at, &report->frame, place->point);
        json_t *item = json_pack("{s: s, s: o, s: s, s: [f, f, f]}", "option", named->option, "words",
                                 json_from_text(named->text), "is", kinds[place->kind], "at", at[0], at[1], at[2]);
        whole = item && (!*place->name || put_value(item, "name", json_from_text(place->name)));
        whole = whole && (!object || object->kind != CONUS_KIND_AREA ||
                          put_value(item, "index", json_integer((json_int_t)object->label)));
        whole = whole && (place->kind != CONUS_PLACE_INNER || put_value(item, "inside_mm", json_real(place->depth)));
        whole = whole && (!place->is_on_scalp || put_value(item, "head", json_string("own")));
        whole = json_array_append_new(list, item) == 0 && whole;
    }
    return whole_or_null(list, whole);
}

/* The sentences, one behind the other. */
static json_t *json_from_sentences(const conus_report *report)
{
    struct buffer text = {0};
    for (size_t i = 0; i < report->options.place_count; i++) {
        const conus_named_place *named = &report->options.places[i];
        if (named->is_sentence) {
            buffer_format(&text, "%s%s%s%s", text.size ? "; " : "", named->option, *named->option ? " " : "",
                          named->text);
        }
    }
    json_t *sentences = buffer_status(&text) ? NULL : json_from_text(text.data ? text.data : "");
    buffer_finish(&text);
    return sentences;
}

/* The provenance of the rows, for the report and the sidecar. */
static bool add_provenance(json_t *root, const conus_report *report)
{
    size_t sentences = 0;
    for (size_t i = 0; i < report->options.place_count; i++) {
        sentences += report->options.places[i].is_sentence;
    }
    return (report->options.place_count == sentences || put_value(root, "Places", json_from_places(report))) &&
           put_value(root, "Space", json_from_space(&report->frame)) &&
           (!sentences || put_value(root, "Understood", json_from_sentences(report))) && add_sources(root, report);
}

struct writing {
    struct buffer *out;
    struct report_columns columns;
    size_t flags;
    size_t rows;
    bool whole;
};

/* Appends the cell as jansson dumps it. What needs neither its care for quotation marks nor an exponent is written
 * here: the rows of a probe's 5,000 sites as objects of jansson took most of the time. */
static bool write_cell(struct buffer *out, struct cell cell, size_t flags)
{
    double size = fabs(cell.number);
    size_t start = out->size;
    if (cell.type == CELL_NONE) {
        buffer_append(out, "null", 4);
        return true;
    }
    if (cell.type == CELL_INTEGER && cell.integer <= INT64_MAX) {
        buffer_whole(out, cell.integer);
        return true;
    }
    if (cell.type == CELL_TEXT && text_is_plain(cell.text)) {
        buffer_append(out, "\"", 1);
        buffer_text(out, cell.text);
        buffer_append(out, "\"", 1);
        return true;
    }
    if (cell.type == CELL_NUMBER && flags == JSON_REAL_PRECISION(9) &&
        ((size == 0 && !signbit(cell.number)) || (size >= 1e-4 && size < 1e8))) {
        buffer_number(out, cell.number);
        bool has_point = buffer_status(out) || memchr(out->data + start, '.', out->size - start);
        buffer_text(out, has_point ? "" : ".0");
        return true;
    }
    json_t *value = json_from_cell(cell);
    bool whole = value && json_dump_callback(value, append, out, flags | JSON_ENCODE_ANY) == 0;
    json_decref(value);
    return whole;
}

static void write_row(void *user, const conus_report *of, const struct report_row *row)
{
    struct writing *writing = user;
    buffer_text(writing->out, writing->rows++ ? ",\n  {" : "\n  {");
    for (size_t i = 0; i < writing->columns.count; i++) {
        const struct report_column *column = writing->columns.at[i];
        buffer_text(writing->out, i ? ",\n   " : "\n   ");
        writing->whole =
            write_cell(writing->out, (struct cell){.type = CELL_TEXT, .text = column->name}, writing->flags) &&
            writing->whole;
        buffer_append(writing->out, ": ", 2);
        writing->whole = write_cell(writing->out, report_cell(of, column, row), writing->flags) && writing->whole;
    }
    buffer_text(writing->out, "\n  }");
}

conus_status report_write_json(struct buffer *out, const conus_report *report)
{
    static const char empty_end[] = "]\n}\n"; /* of the list of rows, the last in the object */
    json_t *root = json_object();
    bool whole = add_provenance(root, report) && put_value(root, "Rows", json_array());
    conus_status status = dump(out, whole_or_null(root, whole), JSON_INDENT(1) | digits(report));
    status = status ? status : buffer_status(out);
    if (status) {
        return status;
    }
    struct writing writing = {.out = out, .flags = digits(report), .whole = true};
    out->size -= sizeof empty_end - 1;
    report_list_columns(&writing.columns, report);
    report_each_row(report, write_row, &writing);
    buffer_text(out, writing.rows ? "\n " : "");
    buffer_text(out, empty_end);
    return writing.whole ? buffer_status(out) : fail(CONUS_ERROR_MEMORY, "no memory for the JSON report");
}

/* Line `row` of a table: counts, or lengths where there are any. */
static json_t *json_from_line(const struct report_matrix *matrix, size_t row, bool lengths)
{
    const int64_t *streamlines = conus_table_counts(matrix->pairs, "streamlines");
    const double *length = conus_table_numbers(matrix->pairs, "mean_length_mm");
    json_t *line = json_array();
    bool whole = true;
    for (size_t i = row * matrix->count; i < (row + 1) * matrix->count; i++) {
        size_t pair = matrix->pair[i];
        json_t *cell =
            lengths ? json_from_end(pair ? length[pair - 1] : NAN) : json_integer(pair ? streamlines[pair - 1] : 0);
        whole = json_array_append_new(line, cell) == 0 && whole;
    }
    return whole_or_null(line, whole);
}

conus_status report_write_json_matrix(struct buffer *out, const conus_report *report,
                                      const struct report_matrix *matrix)
{
    json_t *root = json_object();
    json_t *rows = json_array();
    bool whole = add_provenance(root, report);
    for (size_t i = 0; i < matrix->count; i++) {
        const char *name = conus_table_texts(matrix->areas, "name")[i];
        json_t *label = conus_table_objects(matrix->areas)[i]
                            ? json_integer(conus_table_counts(matrix->areas, "index")[i])
                            : json_null();
        json_t *row = json_pack("{s: o, s: o, s: o, s: o}", "area", json_from_text(name ? name : ""), "index", label,
                                "streamlines", json_from_line(matrix, i, false), "mean_length_mm",
                                json_from_line(matrix, i, true));
        whole = json_array_append_new(rows, row) == 0 && whole;
    }
    whole = put_value(root, "Rows", rows) && whole;
    return dump(out, whole_or_null(root, whole), JSON_INDENT(1) | digits(report));
}

conus_status report_write_sidecar(struct buffer *out, const conus_report *report)
{
    json_t *root = json_object();
    bool whole = true;
    conus_format format = report->options.format;
    bool is_draft = format == CONUS_FORMAT_BEP032;
    bool has_columns = !report_is_foreign(format) || format == CONUS_FORMAT_BIDS || is_draft;
    json_t *kept = json_object(); /* whose names are the user's, and may be those of the keys here */
    struct report_columns columns;
    report_list_columns(&columns, report);
    for (size_t i = 0; has_columns && i < columns.count; i++) {
        const struct report_column *column = columns.at[i];
        json_t *entry = json_pack("{s: s}", "Description", column->description);
        const char *units = report_units(report, column);
        whole = (!units || put_value(entry, "Units", json_string(units))) && whole;
        whole = put_value(column->home == HOME_KEPT ? kept : root, column->name, entry) && whole;
    }
    whole = (!json_object_size(kept) || json_object_set(root, "Kept", kept) == 0) && whole;
    json_decref(kept);
    whole = (!is_draft || put_value(root, "BIDSExtension", json_string(BEP032_DRAFT))) && whole;
    whole = add_provenance(root, report) && whole;
    return dump(out, whole_or_null(root, whole), JSON_INDENT(1) | digits(report));
}

/* Names of the labels in a map of them. */
static json_t *json_from_labels(const conus_atlas *atlas)
{
    json_t *labels = json_object();
    bool whole = true;
    for (size_t i = 0; i < atlas->area_count; i++) {
        char label[16];
        snprintf(label, sizeof label, "%u", atlas->objects[i].label);
        whole = (atlas->places[i].is_mesh || put_value(labels, label, json_from_text(atlas->objects[i].name))) && whole;
    }
    return whole_or_null(labels, whole);
}

/* Where volumes are joined, that of one is among the other files. */
static json_t *json_from_paths(const conus_atlas *atlas)
{
    json_t *paths = json_array();
    bool whole = true;
    bool joined = false;
    for (size_t i = 0; i < conus_atlas_volume_count(atlas); i++) {
        whole = json_array_append_new(paths, json_from_text(conus_atlas_volume(atlas, i)->path)) == 0 && whole;
        joined = joined || atlas->volumes[i].is_joined;
    }
    for (size_t i = 0; joined && i < atlas->files.count; i++) {
        whole = json_array_append_new(paths, json_from_text(atlas->files.items[i].path)) == 0 && whole;
    }
    return whole_or_null(paths, whole);
}

conus_status report_write_grid_sidecar(struct buffer *out, const conus_report *report, const conus_grid *grid)
{
    json_t *root = json_object();
    static const uint8_t zero[8] = {0};
    json_int_t voxels = 0;
    for (size_t i = 0; i < grid->view.count; i++) {
        voxels += memcmp((const uint8_t *)grid->data + i * grid->size, zero, grid->size) != 0;
    }
    bool mask = !grid->labels && grid->view.number != CONUS_NUMBER_FLOAT32;
    bool whole =
        put_value(root, "Description", json_string(grid->view.description)) &&
        (!mask || put_value(root, "Type", json_string("ROI"))) && put_value(root, "Manual", json_false()) &&
        put_value(root, "Sources", json_from_paths(report->atlas)) && put_value(root, "Voxels", json_integer(voxels)) &&
        (!grid->labels || put_value(root, "Labels", json_from_labels(report->atlas))) && add_sources(root, report);
    return dump(out, whole_or_null(root, whole), JSON_INDENT(1));
}
