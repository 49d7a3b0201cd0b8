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

/* These add to an object or array that they give back, and end it where there was no memory: NULL goes through all of
 * them, and what is to be added is taken over in any case. */

static json_t *with(json_t *object, const char *key, json_t *value)
{
    bool failed = json_object_set_new(object, key, value);
    json_decref(failed ? object : NULL);
    return failed ? NULL : object;
}

static json_t *with_item(json_t *array, json_t *item)
{
    bool failed = json_array_append_new(array, item);
    json_decref(failed ? array : NULL);
    return failed ? NULL : array;
}

/* Only where there are any. */
static json_t *with_items(json_t *object, const char *key, json_t *array)
{
    bool is_empty = array && !json_array_size(array);
    json_decref(is_empty ? array : NULL);
    return is_empty ? object : with(object, key, array);
}

static json_t *with_integer(json_t *object, const char *key, uint64_t value)
{
    return with(object, key, json_integer((json_int_t)value));
}

static json_t *with_real(json_t *object, const char *key, double value)
{
    return with(object, key, json_real(value));
}

static json_t *with_string(json_t *object, const char *key, const char *value)
{
    return with(object, key, json_string(value));
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
    for (int row = 0; row < 4; row++) {
        rows = with_item(rows, json_pack("[f, f, f, f]", m[row], m[4 + row], m[8 + row], m[12 + row]));
    }
    return rows;
}

static json_t *json_from_shape(const struct report_query *query)
{
    const double *m = query->asked.cone.pose.world_from_device;
    json_t *entry = json_pack("{s: o}", "query", json_from_text(query->id));
    if (query->asked.region.path) {
        const struct table_region *roi = &query->asked.region;
        entry = with(entry, "path", json_from_text(roi->path));
        entry = with_string(entry, "sha256", roi->sha256);
        entry = with_integer(entry, "volume", roi->volume);
        entry = with_real(entry, "volume_mm3", roi->volume_mm3);
        entry = roi->threshold == 0 ? entry : with_real(entry, "threshold", roi->threshold);
        return roi->tetrahedra ? with_integer(entry, "tetrahedra", roi->tetrahedra) : entry;
    }
    if (query->error) {
        return with(entry, "error", json_from_text(query->error));
    }
    if (query->asked.ball > 0) {
        entry = with(entry, "point_ras", json_pack("[f, f, f]", m[12], m[13], m[14]));
        return with_real(entry, "radius_mm", query->is_point ? 0 : query->asked.ball);
    }
    if (query->asked.is_whole) {
        return entry;
    }
    if (!query->asked.is_axis) {
        entry = with_real(entry, "angle_deg", query->asked.cone.degrees);
        entry = with_integer(entry, "cone_pixels", query->cone_pixels);
    }
    entry = with(entry, "world_from_device_ras", json_from_matrix(m));
    bool is_wide = !query->asked.is_axis && cone_is_wide(&query->asked.cone);
    return is_wide ? with_string(entry, "spread", "even") : entry;
}

/* Which pose of its file it is, and when. */
static json_t *with_marks(json_t *entry, const conus_report *report, const struct report_query *query)
{
    const conus_row_marks *marks = report_marks(report);
    bool has_time = marks && marks->has_time && isfinite(query->time_s);
    entry = marks && marks->has_number ? with_integer(entry, "row", query->number) : entry;
    return has_time ? with_real(entry, "time_s", query->time_s) : entry;
}

static json_t *json_from_queries(const conus_report *report)
{
    json_t *queries = json_array();
    for (size_t i = 0; i < report->query_count; i++) {
        const struct report_query *query = &report->queries[i];
        json_t *entry = json_from_shape(query);
        const double *range = query->asked.cone.range;
        bool has_range =
            !query->error && (range[0] != report->selector.range[0] || range[1] != report->selector.range[1]);
        entry = has_range ? with(entry, "range_mm", json_pack("[f, f]", range[0], range[1])) : entry;
        entry = with_marks(entry, report, query);
        bool has_radius = !query->error && report->kind == ROWS_CONNECTIONS;
        entry = has_radius ? with_real(entry, "endpoint_radius_mm", query->asked.end_radius) : entry;
        queries = with_item(queries, entry);
    }
    return queries;
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
    for (size_t i = atlas->area_count; i < atlas->object_count; i++) {
        const conus_object *band = &atlas->objects[i];
        if (band->is_band && band->volume == index) {
            bands = with_item(bands, json_pack("{s: o, s: o, s: o}", "name", json_from_text(band->name), "low",
                                               json_from_end(band->low), "high", json_from_end(band->high)));
        }
    }
    static const char *const roles[] = {"", "parcellation", "pathway", "context", "probability"};
    json_t *volume = json_pack("{s: s, s: o, s: s, s: s, s: I, s: s, s: s, s: o}", "role", roles[info->role], "path",
                               json_from_text(info->path), "sha256", info->sha256, "format", info->format, "volume",
                               (json_int_t)info->volume, "orientation", info->orientation, "transform", info->transform,
                               "world_from_voxel", json_from_matrix(info->world_from_voxel));
    bool has_none = json_array_size(bands) > 0 || (info->role != CONUS_ROLE_SCALAR && info->threshold == 0);
    volume = has_none ? volume : with_real(volume, "threshold", info->threshold);
    return with_items(volume, "bands", bands);
}

/* A folder has no sum: its files are among those of the atlas, with theirs. */
static json_t *json_from_tractograms(const conus_atlas *atlas)
{
    json_t *list = json_array();
    for (size_t i = 0; i < atlas->tractogram_count; i++) {
        const struct tractogram *tractogram = &atlas->tractograms[i];
        const char *sum = tractogram->sha256;
        json_t *entry = json_pack("{s: o, s: s, s: I, s: I, s: f}", "path", json_from_text(tractogram->path), "format",
                                  tractogram->format, "streamlines", (json_int_t)tractogram->streamline_count, "points",
                                  (json_int_t)tractogram->point_count, "radius_mm", tractogram->radius);
        list = with_item(list, *sum ? with_string(entry, "sha256", sum) : entry);
    }
    return list;
}

/* The hidden objects, if there are any. */
static json_t *with_hidden(json_t *root, const conus_atlas *atlas)
{
    struct buffer text = {0};
    atlas_list_hidden(&text, atlas);
    root = buffer_status(&text) ? with(root, "hidden", NULL)
           : text.size          ? with_string(root, "hidden", text.data)
                                : root;
    buffer_finish(&text);
    return root;
}

/* The transforms from the world to the atlas's own space, in this order: matrices and fields in turn. In a field a node
 * at q goes to base q + linear v; in a spline v is the coefficients' sum. */
static json_t *json_from_way(const conus_atlas *atlas)
{
    json_t *way = with_item(json_array(), json_pack("{s: o}", "matrix", json_from_matrix(atlas->own_from_world)));
    for (size_t i = atlas->warp_count; i > 0; i--) {
        const struct warp *warp = &atlas->warps[i - 1];
        const struct deformation *field = &warp->field;
        json_t *dim =
            json_pack("[I, I, I]", (json_int_t)field->dim[0], (json_int_t)field->dim[1], (json_int_t)field->dim[2]);
        const char *kind = field->coefficients ? "spline" : "field";
        way = with_item(way, json_pack("{s: {s: o, s: o, s: o, s: o}}", kind, "dim", dim, "world_from_voxel",
                                       json_from_matrix(field->world_from_voxel), "base", json_from_matrix(field->base),
                                       "linear", json_from_matrix(field->linear)));
        way = with_item(way, json_pack("{s: o}", "matrix", json_from_matrix(warp->after)));
    }
    return way;
}

static json_t *json_from_atlas(const conus_atlas *atlas)
{
    json_t *volumes = json_array();
    json_t *files = json_array(); /* the manifest and the surfaces, if there are any */
    json_t *notes = json_array();
    for (size_t i = 0; i < conus_atlas_volume_count(atlas); i++) {
        volumes = with_item(volumes, json_from_volume(atlas, i));
    }
    for (size_t i = 0; i < atlas->files.count; i++) {
        const struct file_sum *file = &atlas->files.items[i];
        files = with_item(files, json_pack("{s: o, s: s}", "path", json_from_text(file->path), "sha256", file->sha256));
    }
    for (size_t i = 0; i < conus_atlas_note_count(atlas); i++) {
        notes = with_item(notes, json_from_text(conus_atlas_note(atlas, i)));
    }
    static const char *const hemispheres[] = {"as-is", "split", "merged"};
    json_t *labels = json_from_text(conus_atlas_label_source(atlas));
    json_t *root = json_pack("{s: o, s: o, s: s, s: s*, s: o, s: o, s: o}", "path", json_from_text(atlas_path(atlas)),
                             "labels", labels, "hemispheres", hemispheres[atlas->hemispheres], "template",
                             space_brain_word(atlas->brain), "volumes", volumes, "files", files, "notes", notes);
    if (atlas->pack) {
        root = with(
            root, "pack",
            json_pack("{s: o, s: s}", "path", json_from_text(atlas->pack->info.path), "sha256", atlas->pack->sha256));
    }
    bool affine = atlas->is_moved && !atlas->warp_count;
    root = affine ? with(root, "atlas_from_world", json_from_matrix(atlas->own_from_world)) : root;
    root = atlas->warp_count ? with(root, "way_to_atlas", json_from_way(atlas)) : root;
    return with_hidden(with_items(root, "tractograms", json_from_tractograms(atlas)), atlas);
}

/* The constants of a track (Eq. 12), if it is one. */
static json_t *with_track(json_t *settings, const conus_tracker *tracker)
{
    if (!tracker) {
        return settings;
    }
    const conus_tracker_options *options = tracker_options(tracker);
    return with(settings, "track",
                json_pack("{s: f, s: f, s: f, s: f, s: f, s: f, s: f, s: f}", "window_s", options->window, "stickiness",
                          options->stickiness, "snappiness", options->snappiness, "rate_hz", options->rate,
                          "growth_per_s", options->growth, "decay_per_s", options->decay, "exponent", options->exponent,
                          "delay_s", options->delay));
}

/* The weight of rays (Eq. 30) and the prior (Eq. 32), if there is one; the files of both are among the inputs. */
static json_t *with_weight(json_t *settings, const conus_report *report)
{
    const struct weight_facts *weight = &report->weight;
    const struct prior *prior = &report->prior;
    if (!weight->form) {
        return settings;
    }
    static const char *const levels[] = {
        [ABOVE_AREAS] = "largest_in_areas", [ABOVE_LARGEST] = "largest", [ABOVE_LEVEL] = "weight"};
    static const char *const owns[] = {[WEIGHT_BY_ANGLE] = "own_angle_deg",
                                       [WEIGHT_BY_OFFSET] = "own_radius_mm",
                                       [WEIGHT_BY_DISTANCE] = "own_ball_mm"};
    json_t *numbers = json_array();
    for (size_t i = 0; i < weight->number_count; i++) {
        numbers = with_item(numbers, json_real(weight->numbers[i]));
    }
    json_t *entry = json_pack("{s: s, s: o}", "form", weight->form, "numbers", numbers);
    entry = weight->sigma == 0 ? entry : with_real(entry, "sigma_deg", weight->sigma);
    entry = weight->rows == 0 ? entry : with_integer(entry, "rows", weight->rows);
    entry = weight->unit[0] ? with_string(entry, "unit", weight->unit) : entry;
    entry = weight->own == 0 ? entry : with_real(entry, owns[weight->by], weight->own);
    if (weight->depth[1] != 0) {
        entry = with(entry, "own_range_mm", json_pack("[f, f]", weight->depth[0], weight->depth[1]));
    }
    if (report->selector.layers || report->options.points) { /* there are doses */
        entry = with(entry, "above", json_pack("{s: s, s: f}", "of", levels[weight->above], "level", weight->level));
    }
    if (weight->by == WEIGHT_BY_ANGLE) {
        entry = with(entry, "bias_deg", json_pack("[f, f]", weight->bias[0], weight->bias[1]));
    }
    if (weight->error.name) {
        entry = with(entry, "error",
                     json_pack("{s: s, s: s, s: s}", "name", weight->error.name, "measured", weight->error.measured,
                               "source", weight->error.source));
    }
    settings = with(settings, "weight", entry);
    const char *of = prior->of_file ? "file" : prior->by_size ? "size" : "equal";
    return prior->power == 0 ? settings
                             : with(settings, "prior", json_pack("{s: s, s: f}", "of", of, "power", prior->power));
}

/* Labels of a list: it may have come from a file that changes. */
static json_t *json_from_level_areas(const conus_report *report)
{
    json_t *labels = json_array();
    for (size_t i = 0; i < report->level_area_count; i++) {
        labels = with_item(labels, json_integer(report->atlas->objects[report->level_areas[i] - 1].label));
    }
    return labels;
}

/* The areas that are reported, if there is a level. */
static json_t *with_level(json_t *object, const conus_report *report)
{
    object = report->level ? with(object, "level", json_from_text(report->level)) : object;
    return with_items(object, "level_areas", json_from_level_areas(report));
}

/* Reports that are joined differ in no setting but the level, which therefore is the atlas's. */
static json_t *json_from_atlases(const conus_report *report)
{
    json_t *atlases = json_array();
    for (; report; report = report->next) {
        json_t *named = json_pack("{s: o}", "name", json_from_text(report->name));
        json_t *atlas = json_from_atlas(report->atlas);
        bool failed = json_object_update(named, atlas);
        json_decref(atlas);
        atlases = with_item(atlases, with_level(named, report));
        atlases = failed ? with_item(atlases, NULL) : atlases;
    }
    return atlases;
}

static json_t *with_range(json_t *settings, const conus_selector_options *options)
{
    return options->range[1] == 0
               ? settings
               : with(settings, "range_mm", json_pack("[f, f]", options->range[0], options->range[1]));
}

static const char *aperture_word(const conus_selector_options *options)
{
    return options->aperture == CONUS_APERTURE_SQUARE ? "square" : "circle";
}

/* The shape that streamlines are to come into, where it is not a query's own cone; the needle of a plan. */
static json_t *with_shape(json_t *settings, const conus_report *report)
{
    const conus_selector_options *options = &report->selector;
    bool of_connections = report->kind == ROWS_CONNECTIONS;
    bool has_radius = options->radius > 0 && (of_connections || report->plan.count > 0);
    settings = of_connections ? with_string(settings, "aperture", aperture_word(options)) : settings;
    return has_radius ? with_real(settings, "radius_mm", options->radius) : settings;
}

/* Its radius, and how far it looks; null = as far as there are objects. */
static json_t *with_needle(json_t *settings, const conus_report *report)
{
    bool has_needle = report->kind == ROWS_CLEARANCES;
    settings = has_needle ? with_real(settings, "radius_mm", report->selector.radius) : settings;
    return has_needle ? with(settings, "within_mm", json_from_end(report->options.within)) : settings;
}

static json_t *json_from_contacts(const conus_contacts *contacts)
{
    return json_pack("{s: I, s: I, s: f, s: f}", "count", (json_int_t)contacts->count, "columns",
                     (json_int_t)contacts->columns, "pitch_mm", contacts->pitch, "tip_mm", contacts->tip);
}

/* How many trials the first row is of. */
static json_t *with_trials(json_t *settings, const conus_report *report)
{
    const int64_t *trials = report->query_count ? conus_table_counts(report->queries[0].table, "n") : NULL;
    return trials ? with(settings, "trials", json_integer(trials[0])) : settings;
}

static json_t *json_from_settings(const conus_report *report)
{
    const conus_selector_options *options = &report->selector;
    enum report_rows rows = report->kind;
    bool has_axes = report_is_of_axes(rows) || rows == ROWS_CONNECTIONS || report->plan.count > 0;
    if (rows == ROWS_NEEDLES || rows == ROWS_PAIRS || !report_has_atlas(report)) { /* each has its own */
        json_t *few = with_trials(json_object(), report);
        const bool has_head = rows == ROWS_POSITIONS && report->query_count;
        const char *head = has_head && report_is_of_scalp(report->queries[0].table) ? "own" : "MNI 152";
        return has_head ? with_string(few, "head", head) : few;
    }
    if (has_axes || rows == ROWS_COVERAGES || rows == ROWS_CLUSTERS) { /* which have no rays of pixels */
        json_t *few = has_axes ? with_range(json_object(), options) : json_object();
        bool level_is_there = has_axes && report->name; /* in that of each atlas */
        few = with_needle(with_shape(few, report), report);
        return level_is_there ? few : with_level(few, report);
    }
    bool has_slices = options->sampling == CONUS_SAMPLING_SLICES;
    json_t *settings = json_pack("{s: s, s: s, s: i, s: s, s: s}", "engine", report->engine, "sampling",
                                 has_slices ? "slices" : "exact", "resolution", (int)options->resolution, "aperture",
                                 aperture_word(options), "score", report->score);
    if (has_slices) {
        settings = options->slices ? with_integer(settings, "slices", options->slices)
                                   : with_string(settings, "slices", "auto");
        settings = with_real(settings, "slice_fraction", options->slice_fraction);
    }
    settings = with_string(settings, "layers", options->layers ? "all" : "visible");
    settings = options->radius == 0 ? settings : with_real(settings, "radius_mm", options->radius);
    settings = with_range(settings, options);
    settings = report->options.order ? with_string(settings, "order", "depth") : settings;
    const conus_contacts *contacts = &report->options.contacts;
    settings = contacts->count ? with(settings, "contacts", json_from_contacts(contacts)) : settings;
    bool tells = options->radius == 0 && (report->is_begun || !report->query_count); /* no query tells it (Eq. 15) */
    settings = tells ? with_string(settings, "spread", "even beyond 120 degrees") : settings;
    settings = report->name ? settings : with_level(settings, report);
    return with_track(with_trials(with_weight(settings, report), report), report->options.tracker);
}

static json_t *json_from_constraint(const struct report_constraint *constraint)
{
    const conus_contacts *contacts = &constraint->asked->contacts;
    json_t *entry =
        json_pack("{s: s, s: I, s: f, s: o}", "kind", constraint->kind, "index", (json_int_t)constraint->index, "limit",
                  constraint->asked->limit, "asked", json_from_text(constraint->words));
    entry = constraint->name ? with(entry, "name", json_from_text(constraint->name)) : entry;
    entry = constraint->measure ? with_string(entry, "measure", constraint->measure) : entry;
    if (constraint->asked->kind >= CONUS_CONSTRAINT_ARC) {
        entry = with(with(entry, "most", json_real(constraint->asked->most)), "pitch_deg",
                     json_real(constraint->asked->pitch));
    }
    return contacts->count ? with(entry, "contacts", json_from_contacts(contacts)) : entry;
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
static json_t *with_errors(json_t *plan, const conus_jitter_options *jitter)
{
    bool of_ends = jitter && (jitter->entry > 0 || jitter->target > 0 || jitter->depth > 0);
    if (!jitter) {
        return plan;
    }
    return with(plan, "jitter",
                of_ends ? json_pack("{s: I, s: f, s: f, s: f}", "samples", (json_int_t)jitter->samples, "entry_mm",
                                    jitter->entry, "target_mm", jitter->target, "depth_mm", jitter->depth)
                        : json_pack("{s: I, s: f, s: f}", "samples", (json_int_t)jitter->samples, "error_deg",
                                    jitter->tilt, "error_mm", jitter->shift));
}

/* Its candidates, its constraints, and how many candidates hold each of them and those before it. */
static json_t *with_funnel(json_t *object, const struct report_plan *plan)
{
    json_t *constraints = json_array();
    json_t *funnel = json_array();
    for (size_t i = 0; i < plan->count; i++) {
        constraints = with_item(constraints, json_from_constraint(&plan->constraints[i]));
        funnel = with_item(funnel, json_integer((json_int_t)plan->constraints[i].left));
    }
    object = with_integer(object, "candidates", plan->candidates);
    object = with_integer(object, "no_candidates", plan->rejected);
    return with(with(object, "constraints", constraints), "funnel", funnel);
}

static json_t *json_from_plan(const struct report_plan *plan)
{
    json_t *misses = json_array();
    for (size_t i = 0; i < plan->count; i++) {
        misses = with_item(misses, json_from_miss(&plan->constraints[i], i));
    }
    return with_errors(with(with_funnel(json_object(), plan), "nearest_misses", misses), plan->jitter);
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
    for (size_t i = 0; i < answered->needle_count; i++) {
        names = with_item(names, json_from_text(needles->at[answered->needles[i]]->name));
    }
    for (size_t i = 0; i < answered->shank_count; i++) {
        shanks = with_item(shanks, json_pack("[f, f]", answered->shanks[2 * i], answered->shanks[2 * i + 1]));
    }
    for (size_t i = 0; i < answered->part_count; i++) {
        parts = with_item(parts, json_from_part(&answered->parts[i]));
    }
    json_t *arc = answered->arc ? json_from_text(answered->arc) : json_null();
    json_t *object = json_pack("{s: o, s: b, s: o, s: f, s: o, s: o}", "needles", names, "once", answered->once, "arc",
                               arc, "radius_mm", answered->radius, "shanks", shanks, "parts", parts);
    return with_integer(with_funnel(object, &question->plan), "feasible",
                        question->plan.constraints[question->plan.count - 1].left);
}

/* null of 0 */
static json_t *json_from_limit(uint64_t limit)
{
    return limit ? json_integer((json_int_t)limit) : json_null();
}

/* null where there is none */
static json_t *json_from_arcs(const conus_together_options *asked)
{
    return asked->arcs > 0
               ? json_pack("{s: f, s: f, s: f, s: o, s: o, s: f}", "spacing_deg", asked->arcs, "slider_deg",
                           asked->slider, "same_deg", asked->same, "most", json_from_limit(asked->arcs_most), "each",
                           json_from_limit(asked->arcs_each), "pitch_deg", asked->pitch)
               : json_null();
}

/* null where there is none */
static json_t *json_from_conflict(const struct report_needles *needles)
{
    const conus_conflict *conflict = needles->conflict;
    if (!conflict) {
        return json_null();
    }
    json_t *names = json_array();
    for (size_t i = 0; i < conflict->count; i++) {
        names = with_item(names, json_from_text(needles->at[conflict->needles[i]]->name));
    }
    json_t *object = json_pack("{s: o, s: o, s: o}", "needles", names, "between_mm", json_from_end(conflict->between),
                               "entry_distance_mm", json_from_end(conflict->entry_distance));
    if (conflict->by_limits && needles->asked->arcs > 0) {
        object = with(object, "arcs",
                      json_pack("{s: o, s: o}", "most", json_from_limit(conflict->arcs_most), "each",
                                json_from_limit(conflict->arcs_each)));
    }
    if (conflict->by_limits && needles->asked->cover_count) {
        json_t *contacts = json_array();
        for (size_t k = 0; k < needles->asked->cover_count; k++) {
            contacts = with_item(contacts, json_from_end(conflict->contacts[k]));
        }
        object = with(object, "contacts", contacts);
    }
    return object;
}

/* What is to be covered. */
static json_t *json_from_covers(const conus_together_options *asked)
{
    json_t *list = json_array();
    for (size_t k = 0; k < asked->cover_count; k++) {
        list = with_item(list, json_pack("{s: o, s: o}", "names", json_from_text(asked->covers[k].names), "contacts",
                                         json_from_limit(asked->covers[k].contacts)));
    }
    return list;
}

/* The combinations that hold. *nodes: of the search. */
static json_t *json_from_combinations(uint64_t *nodes, const struct report_needles *needles)
{
    json_t *list = json_array();
    for (size_t n = 0; n < needles->combination_count; n++) {
        const conus_combination *combination = needles->combinations[n];
        *nodes = combination->nodes;
        if (combination->feasible) {
            json_t *covered = json_array();
            for (size_t k = 0; k < needles->asked->cover_count; k++) {
                covered = with_item(covered, json_integer((json_int_t)combination->covered[k]));
            }
            list = with_item(list, json_pack("{s: b, s: o, s: b, s: o}", "proven", combination->proven, "bound_mm",
                                             json_from_end(combination->bound), "last", combination->last, "covered",
                                             covered));
        }
    }
    return list;
}

static json_t *json_from_needles(const struct report_needles *needles)
{
    json_t *rows = json_array();
    json_t *list = json_array();
    const conus_together_options *asked = needles->asked;
    uint64_t nodes = 0;
    json_t *combinations = json_from_combinations(&nodes, needles);
    for (size_t i = 0; i < needles->count; i++) {
        const conus_placed *placed = needles->at[i];
        list =
            with_item(list, json_pack("{s: o, s: b, s: o, s: o, s: I}", "name", json_from_text(placed->name), "given",
                                      placed->given != NULL, "largest_leeway_mm", json_from_end(placed->largest),
                                      "cut_mm", json_from_end(placed->cut), "candidates", (json_int_t)placed->above));
    }
    for (size_t i = 0; i < needles->question_count; i++) {
        rows = with_item(rows, json_from_question(needles, i));
    }
    json_t *diverse = asked->top == 1
                          ? json_null()
                          : json_pack("{s: f, s: I}", "apart_mm", asked->diverse, "needles", (json_int_t)asked->differ);
    return json_pack("{s: s, s: {s: f, s: f}, s: f, s: o, s: o, s: I, s: o, s: I, s: o, s: o, s: o, s: o}", "rank",
                     "leeway,sum,-depth", "between", "shafts_mm", asked->between, "parts_mm", asked->parts,
                     "entry_distance_mm", asked->entry_distance, "arcs", json_from_arcs(asked), "cover",
                     json_from_covers(asked), "top", (json_int_t)asked->top, "diverse", diverse, "nodes",
                     (json_int_t)nodes, "rows", rows, "needles", list, "combinations", combinations, "conflict",
                     json_from_conflict(needles));
}

/* The sources; queries are always in RAS. */
static json_t *with_sources(json_t *root, const conus_report *report)
{
    const char *command = report->options.command;
    json_t *program = json_pack("{s: s, s: s}", "Name", "conus", "Version", CONUS_VERSION);
    program = command ? with(program, "CommandLine", json_from_text(command)) : program;
    root = with(root, "GeneratedBy", json_pack("[o]", program));
    if (report_has_atlas(report)) {
        root = report->name ? with(root, "Atlases", json_from_atlases(report))
                            : with(root, "Atlas", json_from_atlas(report->atlas));
    }
    root = with(root, "Settings", json_from_settings(report));
    root = report->plan.count ? with(root, "Plan", json_from_plan(&report->plan)) : root;
    root = report->needles.count ? with(root, "Plan", json_from_needles(&report->needles)) : root;
    bool has_queries = !report->is_begun && !report_has_no_queries(report); /* else they are forgotten */
    return has_queries ? with(root, "Queries", json_from_queries(report)) : root;
}

/* The space of positions in rows: x, y and z are the axes in their order. */
static json_t *json_from_space(const conus_frame *frame)
{
    static const char *const names[] = {"RAS", "LPS", "CCF", "bregma"};
    json_t *space =
        json_pack("{s: s, s: s}", "orientation", names[frame->space], "units", conus_space_unit(frame->space));
    if (frame->space >= CONUS_SPACE_CCF) {
        space = with(space, "axes",
                     json_pack("[s, s, s]", conus_space_axis(frame->space, 0), conus_space_axis(frame->space, 1),
                               conus_space_axis(frame->space, 2)));
        space = with(space, "world_from_space", json_from_matrix(frame->world_from_space));
    }
    return space;
}

/* How words were understood; their points are in the space of the rows. */
static json_t *json_from_places(const conus_report *report)
{
    static const char *const kinds[] = {"numbers", "inner point", "centroid", "nearest point", "position"};
    json_t *list = json_array();
    for (size_t i = 0; i < report->options.place_count; i++) {
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
        item = *place->name ? with(item, "name", json_from_text(place->name)) : item;
        item = object && object->kind == CONUS_KIND_AREA ? with_integer(item, "index", object->label) : item;
        item = place->kind == CONUS_PLACE_INNER ? with_real(item, "inside_mm", place->depth) : item;
        item = place->is_on_scalp ? with_string(item, "head", "own") : item;
        item = place->toward ? with_real(with_string(item, "toward", place->toward), "way_mm", place->way_mm) : item;
        list = with_item(list, item);
    }
    return list;
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
static json_t *with_provenance(json_t *root, const conus_report *report)
{
    size_t sentences = 0;
    for (size_t i = 0; i < report->options.place_count; i++) {
        sentences += report->options.places[i].is_sentence;
    }
    root = with_items(root, "Places", json_from_places(report));
    root = with(root, "Space", json_from_space(&report->frame));
    root = sentences ? with(root, "Understood", json_from_sentences(report)) : root;
    return with_sources(root, report);
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

static conus_status write_json(struct buffer *out, const conus_report *report)
{
    static const char empty_end[] = "]\n}\n"; /* of the list of rows, the last in the object */
    json_t *root = with(with_provenance(json_object(), report), "Rows", json_array());
    conus_status status = dump(out, root, JSON_INDENT(1) | digits(report));
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

const struct report_format report_format_json = {.whole = write_json};

/* Line `row` of a table: counts, or lengths where there are any. */
static json_t *json_from_line(const struct report_matrix *matrix, size_t row, bool lengths)
{
    const int64_t *streamlines = conus_table_counts(matrix->pairs, "streamlines");
    const double *length = conus_table_numbers(matrix->pairs, "mean_length_mm");
    json_t *line = json_array();
    for (size_t i = row * matrix->count; i < (row + 1) * matrix->count; i++) {
        size_t pair = matrix->pair[i];
        line = with_item(line, lengths ? json_from_end(pair ? length[pair - 1] : NAN)
                                       : json_integer(pair ? streamlines[pair - 1] : 0));
    }
    return line;
}

conus_status report_write_json_matrix(struct buffer *out, const conus_report *report,
                                      const struct report_matrix *matrix)
{
    json_t *rows = json_array();
    for (size_t i = 0; i < matrix->count; i++) {
        const char *name = conus_table_texts(matrix->areas, "name")[i];
        json_t *label = conus_table_objects(matrix->areas)[i]
                            ? json_integer(conus_table_counts(matrix->areas, "index")[i])
                            : json_null();
        json_t *row = json_pack("{s: o, s: o, s: o, s: o}", "area", json_from_text(name ? name : ""), "index", label,
                                "streamlines", json_from_line(matrix, i, false), "mean_length_mm",
                                json_from_line(matrix, i, true));
        rows = with_item(rows, row);
    }
    json_t *root = with(with_provenance(json_object(), report), "Rows", rows);
    return dump(out, root, JSON_INDENT(1) | digits(report));
}

conus_status report_write_sidecar(struct buffer *out, const conus_report *report)
{
    json_t *root = json_object();
    bool is_draft = report->as == REPORT_BEP032;
    bool has_columns = report_in_columns(report->as);
    json_t *kept = json_object(); /* whose names are the user's, and may be those of the keys here */
    struct report_columns columns;
    report_list_columns(&columns, report);
    for (size_t i = 0; has_columns && i < columns.count; i++) {
        const struct report_column *column = columns.at[i];
        json_t **to = column->home == HOME_KEPT ? &kept : &root;
        json_t *entry = json_pack("{s: s}", "Description", column->description);
        const char *units = report_units(report, column);
        *to = with(*to, column->name, units ? with_string(entry, "Units", units) : entry);
    }
    if (!kept || json_object_size(kept)) {
        root = with(root, "Kept", kept);
    } else {
        json_decref(kept);
    }
    root = is_draft ? with_string(root, "BIDSExtension", BEP032_DRAFT) : root;
    return dump(out, with_provenance(root, report), JSON_INDENT(1) | digits(report));
}

/* Names of the labels in a map of them. */
static json_t *json_from_labels(const conus_atlas *atlas)
{
    json_t *labels = json_object();
    for (size_t i = 0; i < atlas->area_count; i++) {
        char label[16];
        snprintf(label, sizeof label, "%u", atlas->objects[i].label);
        labels = atlas->places[i].is_mesh ? labels : with(labels, label, json_from_text(atlas->objects[i].name));
    }
    return labels;
}

/* Where volumes are joined, that of one is among the other files. */
static json_t *json_from_paths(const conus_atlas *atlas)
{
    json_t *paths = json_array();
    bool joined = false;
    for (size_t i = 0; i < conus_atlas_volume_count(atlas); i++) {
        paths = with_item(paths, json_from_text(conus_atlas_volume(atlas, i)->path));
        joined = joined || atlas->volumes[i].is_joined;
    }
    for (size_t i = 0; joined && i < atlas->files.count; i++) {
        paths = with_item(paths, json_from_text(atlas->files.items[i].path));
    }
    return paths;
}

conus_status report_write_grid_sidecar(struct buffer *out, const conus_report *report, const conus_grid *grid)
{
    static const uint8_t zero[8] = {0};
    size_t voxels = 0;
    for (size_t i = 0; i < grid->view.count; i++) {
        voxels += memcmp((const uint8_t *)grid->data + i * grid->size, zero, grid->size) != 0;
    }
    bool mask = !grid->labels && grid->view.number != CONUS_NUMBER_FLOAT32;
    json_t *root = with_string(json_object(), "Description", grid->view.description);
    root = mask ? with_string(root, "Type", "ROI") : root;
    root = with(root, "Manual", json_false());
    root = with(root, "Sources", json_from_paths(report->atlas));
    root = with_integer(root, "Voxels", voxels);
    root = grid->labels ? with(root, "Labels", json_from_labels(report->atlas)) : root;
    return dump(out, with_sources(root, report), JSON_INDENT(1));
}
