/* SPDX-License-Identifier: BSD-3-Clause */
#include "base/math3.h"
#include "selection/report.h"

#include <jansson.h>

static const size_t NUMBERS = JSON_REAL_PRECISION(9);

static json_t *json_from_cell(struct cell cell)
{
    switch (cell.type) {
    case CELL_TEXT:
        return json_string(cell.text);
    case CELL_INTEGER:
        return json_integer((json_int_t)cell.integer);
    case CELL_NUMBER:
        return json_real(cell.number);
    case CELL_NONE:
        break;
    }
    return json_null();
}

static json_t *json_from_row(const conus_report *report, const struct report_row *row)
{
    json_t *object = json_object();
    for (const struct report_column *column = report_columns; column->name; column++) {
        if (json_object_set_new(object, column->name, json_from_cell(column->get(report, row)))) {
            json_decref(object);
            return NULL;
        }
    }
    return object;
}

static int append(const char *text, size_t size, void *out)
{
    buffer_append(out, text, size);
    return 0;
}

/* Appends the text of `root`, which is taken over. */
static conus_status dump(struct buffer *out, json_t *root, size_t flags)
{
    int failed = root ? json_dump_callback(root, append, out, flags | NUMBERS) : -1;
    json_decref(root);
    if (failed) {
        return fail(CONUS_ERROR_MEMORY, "no memory for the JSON report");
    }
    buffer_text(out, "\n");
    return CONUS_OK;
}

conus_status report_write_ndjson(struct buffer *out, const conus_report *report)
{
    conus_status status = CONUS_OK;
    for (size_t i = 0; !status && i < report->row_count; i++) {
        status = dump(out, json_from_row(report, &report->rows[i]), JSON_COMPACT);
    }
    return status;
}

static json_t *json_from_matrix(const double m[16])
{
    json_t *rows = json_array();
    for (int row = 0; row < 4; row++) {
        json_array_append_new(rows, json_pack("[f, f, f, f]", m[row], m[4 + row], m[8 + row], m[12 + row]));
    }
    return rows;
}

static json_t *json_from_query(const struct report_query *query)
{
    return json_pack("{s: s, s: f, s: i, s: o}", "query", query->id, "angle_deg",
                     degrees_from_radians(query->cone.angle), "cone_pixels", (int)query->cone_pixels,
                     "world_from_device_ras", json_from_matrix(query->cone.pose.world_from_device));
}

static json_t *json_from_queries(const conus_report *report)
{
    json_t *queries = json_array();
    for (size_t i = 0; i < report->query_count; i++) {
        json_array_append_new(queries, json_from_query(&report->queries[i]));
    }
    return queries;
}

static json_t *json_from_volume(const conus_volume_info *info)
{
    static const char *const roles[] = {"", "parcellation", "pathway", "context"};
    json_t *volume = json_pack("{s: s, s: s, s: s, s: s, s: I, s: s, s: s, s: o}", "role", roles[info->role], "path",
                               info->path, "sha256", info->sha256, "format", info->format, "volume",
                               (json_int_t)info->volume, "orientation", info->orientation, "transform", info->transform,
                               "world_from_voxel", json_from_matrix(info->world_from_voxel));
    if (info->role == CONUS_SCALAR) {
        json_object_set_new(volume, "threshold", json_real(info->threshold));
    }
    return volume;
}

static json_t *json_from_atlas(const conus_atlas *atlas)
{
    json_t *volumes = json_array();
    json_t *notes = json_array();
    for (size_t i = 0; i < conus_atlas_volume_count(atlas); i++) {
        json_array_append_new(volumes, json_from_volume(conus_atlas_volume(atlas, i)));
    }
    for (size_t i = 0; i < conus_atlas_note_count(atlas); i++) {
        json_array_append_new(notes, json_string(conus_atlas_note(atlas, i)));
    }
    return json_pack("{s: s, s: o, s: o}", "labels", conus_atlas_label_source(atlas), "volumes", volumes, "notes",
                     notes);
}

static json_t *json_from_settings(const conus_report *report)
{
    const conus_selector_options *options = &report->selector;
    json_t *settings =
        json_pack("{s: s, s: s, s: i, s: s, s: s}", "engine", report->engine, "sampling",
                  options->sampling == CONUS_SLICES ? "slices" : "exact", "resolution", (int)options->resolution,
                  "aperture", options->aperture == CONUS_SQUARE ? "square" : "circle", "score", report->score);
    if (options->sampling == CONUS_SLICES) {
        json_object_set_new(settings, "slices", options->slices ? json_integer(options->slices) : json_string("auto"));
    }
    return settings;
}

static json_t *json_from_program(const conus_report *report)
{
    json_t *program = json_pack("{s: s, s: s}", "Name", "conus", "Version", CONUS_VERSION);
    if (report->options.command) {
        json_object_set_new(program, "CommandLine", json_string(report->options.command));
    }
    return program;
}

/* What both the report and the sidecar say about where the rows come from. Queries are always in RAS. */
static void add_provenance(json_t *root, const conus_report *report)
{
    bool lps = report->options.space == CONUS_LPS;
    json_object_set_new(root, "GeneratedBy", json_pack("[o]", json_from_program(report)));
    json_object_set_new(root, "Space", json_pack("{s: s, s: s}", "orientation", lps ? "LPS" : "RAS", "units", "mm"));
    json_object_set_new(root, "Atlas", json_from_atlas(report->atlas));
    json_object_set_new(root, "Settings", json_from_settings(report));
    json_object_set_new(root, "Queries", json_from_queries(report));
}

conus_status report_write_json(struct buffer *out, const conus_report *report)
{
    json_t *root = json_object();
    json_t *rows = json_array();
    for (size_t i = 0; i < report->row_count; i++) {
        json_array_append_new(rows, json_from_row(report, &report->rows[i]));
    }
    add_provenance(root, report);
    json_object_set_new(root, "Rows", rows);
    return dump(out, root, JSON_INDENT(1));
}

conus_status report_write_sidecar(struct buffer *out, const conus_report *report)
{
    json_t *root = json_object();
    for (const struct report_column *column = report_columns; column->name; column++) {
        json_t *entry = json_pack("{s: s}", "Description", column->description);
        if (column->units) {
            json_object_set_new(entry, "Units", json_string(column->units));
        }
        json_object_set_new(root, column->name, entry);
    }
    add_provenance(root, report);
    return dump(out, root, JSON_INDENT(1));
}
