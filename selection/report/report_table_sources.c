/* SPDX-License-Identifier: BSD-3-Clause */
/* The lines below a table for people: which atlas, pathways and bundles its answers rest on. */
#include "atlas/atlas.h"
#include "base/memory.h"
#include "base/path.h"
#include "selection/report/parts.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { NAMED_LIMIT = 3 };

/* The last part of a path; a folder's may end in '/'. One of digits is a version, so the part before it stands with it.
 * A file's name may hold anything. */
static void write_file_of(struct buffer *out, const char *path)
{
    size_t end = path_plain_length(path, strlen(path));
    size_t start = path_length_above(path, end);
    bool is_version = strspn(path + start, "0123456789_") == end - start;
    start = path_length_above(path, start - (is_version && start > 1));
    char *name = text_to_utf8((struct text){path + start, end - start});
    buffer_text(out, name ? name : "");
    out->failed = out->failed || !name;
    memory_free(name);
}

/* The first pathway from object `number` on that is not hidden, and is a band or is none; 0 = there is none. */
static size_t next_of(const conus_atlas *atlas, size_t number, bool is_band)
{
    number = number > atlas->area_count ? number : atlas->area_count + 1;
    while (number <= atlas->object_count &&
           (atlas->objects[number - 1].kind != CONUS_KIND_PATHWAY || atlas->places[number - 1].is_hidden ||
            atlas->objects[number - 1].is_band != is_band)) {
        number++;
    }
    return number <= atlas->object_count ? number : 0;
}

static size_t next_pathway(const conus_atlas *atlas, size_t number)
{
    return next_of(atlas, number, false);
}

static const conus_volume_info *pathway_info(const conus_atlas *atlas, size_t number)
{
    return &atlas_object_volume(atlas, (uint32_t)number)->info;
}

static bool has_same_threshold(const conus_volume_info *a, const conus_volume_info *b)
{
    return a->threshold == b->threshold;
}

static bool has_same_file(const conus_volume_info *a, const conus_volume_info *b)
{
    return strcmp(a->path, b->path) == 0;
}

/* The first of the pathways that are like this one. */
static size_t first_alike(const conus_atlas *atlas, size_t number,
                          bool (*is_alike)(const conus_volume_info *a, const conus_volume_info *b))
{
    size_t first = next_pathway(atlas, 0);
    while (first != number && !is_alike(pathway_info(atlas, first), pathway_info(atlas, number))) {
        first = next_pathway(atlas, first + 1);
    }
    return first;
}

/* One line for all of them, and names only where thresholds differ. */
static void write_pathways(struct buffer *out, const conus_atlas *atlas)
{
    size_t first = next_pathway(atlas, 0);
    size_t count = 0;
    size_t files = 0;
    size_t thresholds = 0;
    for (size_t n = first; n; n = next_pathway(atlas, n + 1)) {
        count++;
        files += first_alike(atlas, n, has_same_file) == n;
        thresholds += first_alike(atlas, n, has_same_threshold) == n;
    }
    if (!count) {
        return;
    }
    if (count > 1) {
        buffer_format(out, "%zu pathways: values", count);
    } else {
        buffer_format(out, "pathway %s: values", conus_atlas_object(atlas, first)->name);
    }
    bool with_names = thresholds > 1;
    for (size_t n = first, written = 0; n; n = next_pathway(atlas, n + 1)) {
        if (first_alike(atlas, n, has_same_threshold) != n) {
            continue;
        }
        buffer_text(out, written++ ? "," : "");
        /* "from T on (A, B, C and 2 more)" of all pathways with the threshold of this one. */
        size_t alike = 0;
        buffer_text(out, " from ");
        buffer_number(out, pathway_info(atlas, n)->threshold);
        buffer_text(out, with_names ? " on (" : " on");
        for (size_t k = n; k && with_names; k = next_pathway(atlas, k + 1)) {
            if (has_same_threshold(pathway_info(atlas, k), pathway_info(atlas, n)) && ++alike <= NAMED_LIMIT) {
                buffer_format(out, "%s%s", alike > 1 ? ", " : "", conus_atlas_object(atlas, k)->name);
            }
        }
        if (alike > NAMED_LIMIT) {
            buffer_format(out, " and %zu more", alike - NAMED_LIMIT);
        }
        buffer_text(out, with_names ? ")" : "");
    }
    buffer_text(out, " in ");
    if (files > 1) {
        buffer_format(out, "%zu files", files);
    } else {
        write_file_of(out, pathway_info(atlas, first)->path);
    }
    buffer_text(out, "\n");
}

/* Writes all bands of the volume of band `first` in one line. */
static void write_bands(struct buffer *out, const conus_atlas *atlas, size_t first)
{
    size_t volume = conus_atlas_object(atlas, first)->volume;
    size_t count = 0;
    buffer_text(out, "bands of ");
    write_file_of(out, atlas->volumes[volume].info.path);
    for (size_t n = first; n; n = next_of(atlas, n + 1, true)) {
        const conus_object *band = conus_atlas_object(atlas, n);
        count += band->volume == volume;
        if (band->volume == volume && count <= NAMED_LIMIT) {
            buffer_format(out, "%s %s ", count > 1 ? "," : ":", band->name);
            /* "from 30 to below 60" */
            if (band->low == -INFINITY && band->high == INFINITY) {
                buffer_text(out, "all values");
            }
            if (band->low > -INFINITY) {
                buffer_text(out, "from ");
                buffer_number(out, band->low);
                buffer_text(out, band->high < INFINITY ? " to " : " on");
            }
            if (band->high < INFINITY) {
                buffer_text(out, "below ");
                buffer_number(out, band->high);
            }
        }
    }
    if (count > NAMED_LIMIT) {
        buffer_format(out, " and %zu more", count - NAMED_LIMIT);
    }
    buffer_text(out, "\n");
}

/* In one line how many of them there are that are not hidden, or the one's name, and their files. */
static void write_bundles(struct buffer *out, const conus_atlas *atlas)
{
    size_t count = 0;
    size_t first = 0;
    uint64_t streamlines = 0;
    for (size_t n = atlas->object_count; n > atlas->area_count; n--) {
        bool shown = atlas->places[n - 1].is_bundle && !atlas->places[n - 1].is_hidden;
        count += shown;
        first = shown ? n : first;
        streamlines += shown ? atlas->objects[n - 1].streamlines : 0;
    }
    if (!count) {
        return;
    }
    if (count > 1) {
        buffer_format(out, "%zu bundles", count);
    } else {
        buffer_format(out, "bundle %s", atlas->objects[first - 1].name);
    }
    buffer_text(out, ": ");
    buffer_whole(out, streamlines);
    buffer_text(out, streamlines == 1 ? " streamline of radius " : " streamlines of radius ");
    /* The least and the greatest radius. */
    double low = atlas->tractograms[0].radius;
    double high = low;
    for (size_t i = 1; i < atlas->tractogram_count; i++) {
        low = fmin(low, atlas->tractograms[i].radius);
        high = fmax(high, atlas->tractograms[i].radius);
    }
    buffer_number(out, low);
    if (high > low) {
        buffer_text(out, " to ");
        buffer_number(out, high);
    }
    buffer_text(out, " mm in ");
    if (atlas->tractogram_count > 1) {
        buffer_format(out, "%zu files", atlas->tractogram_count);
    } else {
        write_file_of(out, atlas->tractograms[0].path);
    }
    buffer_text(out, "\n");
}

/* Which transform placed the atlas, and from which value on a pathway is one. */
static void write_sources(struct buffer *out, const conus_report *report)
{
    const conus_atlas *atlas = report->atlas;
    if (report->level) {
        buffer_format(out, "areas at level %s\n", report->level);
    }
    if (atlas_parcellation_count(atlas) || atlas->mesh_count) {
        buffer_format(out, "atlas %s%s", report->name ? report->name : "", report->name ? ": " : "");
        write_file_of(out, atlas_path(atlas));
        buffer_text(out, ", placed by ");
        /* Where the atlas's place comes from: each way once. */
        size_t count = atlas_parcellation_count(atlas);
        buffer_text(out, count ? "" : "the coordinates in its mesh files");
        for (size_t i = 0; i < count; i++) {
            size_t first = 0;
            while (strcmp(atlas->volumes[first].info.transform, atlas->volumes[i].info.transform) != 0) {
                first++;
            }
            buffer_format(out, "%s%s", i && first == i ? " and by " : "",
                          first == i ? atlas->volumes[i].info.transform : "");
        }
        buffer_text(out, "\n");
    }
    if (atlas_has_hidden(atlas)) {
        buffer_text(out, "shown: ");
        atlas_describe_shown(out, atlas);
        buffer_text(out, "\n");
    }
    write_pathways(out, atlas);
    size_t before = SIZE_MAX; /* the volume that was written last: bands of one follow each other */
    for (size_t n = next_of(atlas, 0, true); n; n = next_of(atlas, n + 1, true)) {
        size_t volume = conus_atlas_object(atlas, n)->volume;
        if (volume != before) {
            write_bands(out, atlas, n);
        }
        before = volume;
    }
    write_bundles(out, atlas);
}

void table_write_sources(struct buffer *out, const conus_report *report)
{
    for (; report; report = report->next) {
        write_sources(out, report);
    }
}
