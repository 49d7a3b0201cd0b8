/* SPDX-License-Identifier: BSD-3-Clause */
/* Answers in the two blocks of AFNI's whereami -tab. */
#include "atlas/atlas.h"
#include "base/path.h"
#include "selection/report/parts.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { FOCUS_SIZE = 96 };

/* NIfTI's codes of spaces by AFNI's names. */
static const char *space_of(const conus_atlas *atlas)
{
    const conus_volume_info *info = conus_atlas_volume(atlas, 0);
    int code = info ? info->space_code : 0;
    return code == 4 ? "{MNI}" : code == 3 ? "{TLRC}" : "{Unknown}";
}

/* The file's name without its folder and endings, as AFNI calls an atlas; of several files the manifest's. */
static struct text atlas_name(const conus_report *report, const conus_object *object)
{
    const conus_atlas *atlas = report->atlas;
    const bool several = atlas_parcellation_count(atlas) > 1 || (atlas->volume_count && atlas->volumes[0].is_joined);
    const char *path = several ? atlas_path(atlas) : atlas->volume_count ? atlas->volumes[0].info.path : NULL;
    if (object->kind == CONUS_KIND_PATHWAY || !path) {
        return text_from(object->kind == CONUS_KIND_PATHWAY ? "pathway" : "atlas");
    }
    struct text name = text_from(path_base(path));
    const char *dot = memchr(name.data, '.', name.size);
    name.size = dot && dot > name.data ? (size_t)(dot - name.data) : name.size;
    return name;
}

/* Where a row belongs: nearest first, what has no distance last. */
static double key_of(const struct report_row *row)
{
    return isfinite(row->result.distance) ? row->result.distance : HUGE_VAL;
}

/* The row behind @p last in that order, of equals the one with the better rank; NULL past the last. */
static const struct report_row *next_row(const struct report_row *rows, size_t count, const struct report_row *last)
{
    const struct report_row *best = NULL;
    for (const struct report_row *row = rows; row < rows + count; row++) {
        bool behind = !last || key_of(row) > key_of(last) || (key_of(row) == key_of(last) && row > last);
        if (row->result.object && behind && (!best || key_of(row) < key_of(best))) {
            best = row;
        }
    }
    return best;
}

static void write_query(struct buffer *out, const conus_report *report, size_t index)
{
    const struct report_query *query = &report->queries[index];
    size_t end = report_row_end(report, index);
    const struct report_row *rows = report->rows + query->first_row;
    const struct report_row *row = NULL;
    buffer_text(out, "+++++++ nearby Atlas structures +++++++\n\n");
    if (query->error) {
        buffer_format(out, "***** %s: %s *****\n\n", query->id, query->error);
        return;
    }
    const double *m = query->asked.cone.pose.world_from_device;
    char focus[FOCUS_SIZE];
    snprintf(focus, sizeof focus, "%4.0f mm [%c],%4.0f mm [%c],%4.0f mm [%c]", m[12], m[12] >= 0 ? 'R' : 'L', m[13],
             m[13] >= 0 ? 'A' : 'P', m[14], m[14] < 0 ? 'I' : 'S');
    buffer_format(out, "%-36s\t%-12s\n%-36s\t%-12s\n", "Focus point (LPI)", "Coord.Space", focus,
                  space_of(report->atlas));
    buffer_format(out, "%-15s\t%-3s\t%-32s\t%-3s\t%-3s\n", "Atlas", "Within", "Label", "Prob.", "Code");
    size_t found = 0;
    for (; (row = next_row(rows, end - query->first_row, row)); found++) {
        const conus_object *object = conus_atlas_object(report->atlas, row->result.object);
        const struct text name = atlas_name(report, object);
        char within[32] = "---";
        if (isfinite(row->result.distance)) {
            snprintf(within, sizeof within, "%.1f", row->result.distance);
        }
        buffer_format(out, "%-15.*s\t%-3s\t%-32s\t%-3s\t%-3u\n", (int)name.size, name.data, within, object->name, "---",
                      object->label);
    }
    buffer_text(out, found ? "\n" : "***** Not near any region stored in databases *****\n\n");
}

static conus_status write_queries(struct buffer *out, const conus_report *report)
{
    for (size_t i = 0; i < report->query_count; i++) {
        write_query(out, report, i);
    }
    return CONUS_OK;
}

const struct report_format report_format_afni = {.part = write_queries};
