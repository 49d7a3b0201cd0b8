/* SPDX-License-Identifier: BSD-3-Clause */
/* The electrodes.tsv, probes.tsv and coordsystem.json of the draft BEP032 of BIDS (docs/formats.md): where each contact
 * of a probe is, and the smallest area that contains all of them. */
#include "selection/report/parts.h"

#include "atlas/atlas.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "base/path.h"
#include "conus/own.h"

#include <stdio.h>
#include <string.h>

enum { ID_SIZE = 16 };

/* The known sides and ids of an atlas. */
struct report_bep032 {
    char *sides;          /* [object_count + 1] Of an area: 'L', 'R', or 0 */
    char (*ids)[ID_SIZE]; /* [object_count + 1]; NULL = the atlas has none that are known */
    char *method;
    conus_frame ccf;
    bool has_ccf, has_midline; /* CCF says where the middle is; else x = 0 is it */
};

/* Whether labels are ids of the Allen Mouse Brain Atlas: BrainGlobe calls it so, the root is where it has it, and no
 * hemispheres were split or merged, which have labels of their own. */
static bool has_allen_ids(const conus_atlas *atlas)
{
    bool is_named = strstr(atlas_path(atlas), "allen_mouse") && atlas->hemispheres == CONUS_HEMISPHERES_AS_IS;
    for (uint32_t i = 1; i <= atlas->area_count && is_named; i++) {
        const conus_object *object = conus_atlas_object(atlas, i);
        if (object->label == 997) {
            return strcmp(object->name, "root") == 0;
        }
    }
    return false;
}

/* Whether the atlas lies on both sides of x = 0, a quarter or more of it on each. */
static bool is_centred(const conus_atlas *atlas)
{
    double low[3];
    double high[3];
    bool is_known = !atlas->is_moved && !conus_atlas_bounds(low, high, atlas);
    return is_known && fmin(-low[0], high[0]) >= (high[0] - low[0]) / 4;
}

static char *make_method(const conus_atlas *atlas)
{
    const char *path = atlas_path(atlas);
    const char *name = path_base(path);
    const conus_volume_info *volume = conus_atlas_volume(atlas, 0);
    struct buffer text = {0};
    buffer_format(&text, "conus %s: the area that holds the centre of the contact, in %s", CONUS_VERSION,
                  name[0] ? name : path);
    if (volume && volume->sha256[0]) {
        buffer_format(&text, " with sha256 %s", volume->sha256);
    }
    char *method = buffer_status(&text) ? NULL : text_to_utf8(text_from(text.data));
    buffer_finish(&text);
    return method;
}

conus_status report_bep032_create(struct report_bep032 **out, const conus_atlas *atlas)
{
    struct report_bep032 *made = memory_zeroed(1, sizeof *made);
    size_t count = atlas->object_count + 1;
    if (!made) {
        return CONUS_ERROR_MEMORY;
    }
    made->has_ccf = conus_frame_find(&made->ccf, atlas, CONUS_SPACE_CCF, NULL) == CONUS_OK;
    made->has_midline = is_centred(atlas);
    made->sides = memory_zeroed(count, 1);
    made->ids = has_allen_ids(atlas) ? memory_zeroed(count, ID_SIZE) : NULL;
    made->method = make_method(atlas);
    bool whole = made->sides && made->method && (made->ids || !has_allen_ids(atlas));
    for (uint32_t i = 1; i < count && whole && made->ids; i++) {
        snprintf(made->ids[i], ID_SIZE, "MBA:%u", conus_atlas_object(atlas, i)->label);
    }
    conus_status status = whole ? conus_atlas_sides(made->sides, atlas) : CONUS_ERROR_MEMORY;
    if (status) {
        report_bep032_destroy(made);
        return status;
    }
    *out = made;
    return CONUS_OK;
}

void report_bep032_destroy(struct report_bep032 *made)
{
    if (made) {
        memory_free(made->sides);
        memory_free(made->ids);
        memory_free(made->method);
        memory_free(made);
    }
}

uint32_t report_area(const conus_report *report, size_t query)
{
    for (size_t i = report->queries[query].first_row; i < report_row_end(report, query); i++) {
        const conus_result *result = &report->rows[i].result;
        if (!report->queries[query].error && result->kind == CONUS_KIND_AREA && result->distance == 0) {
            return result->object;
        }
    }
    return 0;
}

const char *report_side(const conus_report *report, size_t query)
{
    const struct report_bep032 *known = report->bep032;
    if (conus_atlas_exchanged(report->atlas)) {
        return NULL;
    }
    double at[3];
    memcpy(at, report->queries[query].asked.cone.pose.world_from_device + 12, sizeof at);
    char side = known->sides[report_area(report, query)];
    double right = at[0];
    if (known->has_ccf) {
        conus_frame_from_world(at, &known->ccf, at);
        bool is_turned = report->frame.space < CONUS_SPACE_CCF && known->ccf.world_from_space[8] < 0;
        right = at[2] - frame_ccf_size[2] / 2;
        right = is_turned ? -right : right; /* x says, where it runs against ML (docs/spaces.md) */
    }
    bool is_known = (known->has_ccf || known->has_midline) && right != 0 && !report->queries[query].error;
    side = side ? side : !is_known ? 0 : right < 0 ? 'L' : 'R';
    return side == 'L' ? "L" : side == 'R' ? "R" : NULL;
}

const char *report_location(const conus_report *report, uint32_t area)
{
    return area ? conus_atlas_object(report->atlas, area)->name : NULL;
}

const char *report_location_id(const conus_report *report, uint32_t area)
{
    return area && report->bep032->ids ? report->bep032->ids[area] : NULL;
}

const char *report_localization(const conus_report *report)
{
    return report->bep032->method;
}

/* The smallest area of the area tree that contains both; 0 = none does. */
static uint32_t common_area(const conus_atlas *atlas, uint32_t a, uint32_t b)
{
    while (a && (!b || !atlas_is_below(atlas, b, a))) {
        a = b ? conus_atlas_object(atlas, a)->parent : 0;
    }
    return a;
}

/* Writes a probe's row, of the contacts from *query on, and sets *query behind them. What type it is no file says. */
static void write_probe(struct buffer *out, const conus_report *report, size_t *query)
{
    const conus_probe_contact *first = report->queries[*query].contact;
    uint32_t area = report_area(report, *query);
    const char *side = report_side(report, *query);
    size_t i = *query + 1;
    for (; i < report->query_count && report->queries[i].contact->index == first->index; i++) {
        area = common_area(report->atlas, area, report_area(report, i));
        side = report_side(report, i) == side ? side : NULL; /* one of two texts */
    }
    const char *name = report_location(report, area);
    const char *id = report_location_id(report, area);
    buffer_format(out, "%s\tn/a\t%s\t%s\t%s\n", first->probe, side ? side : "n/a", name ? name : "n/a",
                  id ? id : "n/a");
    *query = i;
}

conus_status report_write_probes(struct buffer *out, const conus_report *report)
{
    if (report->as != REPORT_BEP032) {
        return fail(CONUS_ERROR_ARGUMENT, "report: probes are of the format bep032");
    }
    if (report->query_count != conus_probe_contact_count(report->options.probe)) {
        return fail(CONUS_ERROR_ARGUMENT, "report: answers to %zu contacts, wanted are all %zu", report->query_count,
                    conus_probe_contact_count(report->options.probe));
    }
    buffer_text(out, "probe_name\ttype\themisphere\tanatomical_location\tanatomical_location_id\n");
    for (size_t query = 0; query < report->query_count;) {
        write_probe(out, report, &query);
    }
    return CONUS_OK;
}

/* The draft's own example of AllenCCFv3 has an origin and axes that are not the CCF's: the words here are those of
 * docs/spaces.md. */
conus_status report_write_coordsystem(struct buffer *out, const conus_report *report)
{
    static const char *const words[] = {
        [CONUS_SPACE_RAS] = "x grows to the right, y to anterior, z to superior, in the space of the poses",
        [CONUS_SPACE_LPS] = "x grows to the left, y to posterior, z to superior, in the space of the poses",
        [CONUS_SPACE_CCF] = "from the corner of the grid, x (AP) grows to posterior, y (DV) to inferior, z (ML) to the "
                            "right",
        [CONUS_SPACE_BREGMA] =
            "from bregma in AllenCCFv3, not turned or stretched, x (AP) grows to anterior, y (ML) to "
            "the right, z (DV) to superior"};
    const conus_frame *frame = &report->frame;
    if (!report->options.placed) {
        return fail(CONUS_ERROR_ARGUMENT, "report: positions on a probe have no coordinate system of a brain");
    }
    buffer_format(out, "{\n \"MicroephysCoordinateSystem\": \"%s\",\n",
                  frame->space == CONUS_SPACE_CCF ? "AllenCCFv3" : "Other");
    buffer_format(out, " \"MicroephysCoordinateSystemDescription\": \"%s", words[frame->space]);
    if (frame->space == CONUS_SPACE_BREGMA) {
        buffer_format(out, "; bregma is at AP %.9g, DV %.9g, ML %.9g um", frame->bregma[0], frame->bregma[1],
                      frame->bregma[2]);
    }
    buffer_format(out, "\",\n \"MicroephysCoordinateUnits\": \"%s\"\n}\n", conus_space_unit(frame->space));
    return CONUS_OK;
}
