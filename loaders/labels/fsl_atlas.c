/* SPDX-License-Identifier: BSD-3-Clause */
/* Parses an atlas XML of FSL, SPM or CAT12. */
#include "loaders/labels/fsl_atlas.h"

#include "base/formats/xml.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "loaders/labels/label_cells.h"

#include <stdio.h>
#include <string.h>

enum { IMAGE_LIMIT = 64 };

struct parsing {
    struct fsl_atlas atlas;
    size_t capacity; /* of atlas.points */
    bool in_label;
    bool indexed; /* `index` belongs to the open label */
    uint32_t index;
    struct fsl_point point;
    struct label label; /* SPM's name and short_name of it */
};

void fsl_atlas_finish(struct fsl_atlas *atlas)
{
    for (size_t i = 0; i < atlas->image_count; i++) {
        memory_free(atlas->images[i].image);
        memory_free(atlas->images[i].summary);
    }
    memory_free(atlas->images);
    memory_free(atlas->type);
    memory_free(atlas->points);
    label_table_finish(&atlas->labels);
    *atlas = (struct fsl_atlas){0};
}

/* Reads x y z of a label. Without three numbers it has no point, and only a check is lost. */
static struct fsl_point read_point(const struct xml_event *event)
{
    static const char *const axes[] = {"x", "y", "z"};
    struct fsl_point point = {.given = true};
    for (int i = 0; i < 3; i++) {
        const char *value = xml_attribute(event, axes[i]);
        point.given = point.given && value && text_to_double(text_from(value), &point.at[i]);
    }
    point.given = point.given && vec3_is_finite(point.at);
    return point;
}

/* FSL's index is an attribute, SPM's an element. */
static conus_status start_label(struct parsing *parsing, const struct xml_event *event)
{
    const char *index = xml_attribute(event, "index");
    struct fsl_atlas *atlas = &parsing->atlas;
    char where[32];
    snprintf(where, sizeof where, "line %zu", event->line);
    if (atlas->labels.count && atlas->is_spm != !index) {
        return fail(CONUS_ERROR_DATA, "%s: a label %s the attribute index, others %s it", where,
                    index ? "with" : "without", index ? "lack" : "have");
    }
    if (parsing->in_label) {
        return fail(CONUS_ERROR_DATA, "%s: a label inside a label", where);
    }
    atlas->is_spm = !index;
    parsing->in_label = true;
    parsing->indexed = index != NULL;
    parsing->point = read_point(event);
    return index ? label_cell_number(&parsing->index, text_from(index), where) : CONUS_OK;
}

static conus_status start_element(void *user, const struct xml_event *event)
{
    struct parsing *parsing = user;
    struct fsl_atlas *atlas = &parsing->atlas;
    if (strcmp(event->name, "label") == 0) {
        return start_label(parsing, event);
    }
    if (strcmp(event->name, "images") != 0) {
        return CONUS_OK;
    }
    if (atlas->image_count == IMAGE_LIMIT) {
        return fail(CONUS_ERROR_DATA, "more than %d <images>", IMAGE_LIMIT);
    }
    struct fsl_image *images = memory_resize(atlas->images, atlas->image_count + 1, sizeof *images);
    if (!images) {
        return CONUS_ERROR_MEMORY;
    }
    atlas->images = images;
    images[atlas->image_count++] = (struct fsl_image){0};
    return CONUS_OK;
}

static conus_status set_type(struct fsl_atlas *atlas, struct text text)
{
    struct text type = text_trim(text);
    if (!text_is_one_of(type, "Label/Probabilistic/Probabalistic/Statistic", false)) {
        return fail(CONUS_ERROR_DATA, "type \"%.*s\", allowed are Label, Probabilistic and Statistic",
                    TEXT_SHOW(type, 60));
    }
    atlas->is_label = text_equal_ignoring_case(type, "Label");
    return label_set_text(&atlas->type, text);
}

/* The elements that SPM writes inside a label. */
static conus_status end_in_label(struct parsing *parsing, const struct xml_event *event)
{
    if (strcmp(event->name, "index") == 0) {
        char where[32];
        snprintf(where, sizeof where, "line %zu", event->line);
        if (parsing->indexed) {
            return fail(CONUS_ERROR_DATA, "%s: a second index of one label", where);
        }
        parsing->indexed = true;
        return label_cell_number(&parsing->index, text_trim(event->text), where);
    }
    char **field = strcmp(event->name, "name") == 0         ? &parsing->label.name
                   : strcmp(event->name, "short_name") == 0 ? &parsing->label.abbreviation
                                                            : NULL;
    return field && !*field ? label_set_text(field, event->text) : CONUS_OK;
}

/* Labels keep their index plus one: 0 stays free. */
static conus_status end_label(struct parsing *parsing, const struct xml_event *event)
{
    struct fsl_atlas *atlas = &parsing->atlas;
    parsing->in_label = false;
    if (!parsing->indexed) {
        return fail(CONUS_ERROR_DATA, "line %zu: a label without an index", event->line);
    }
    if (parsing->index == UINT32_MAX) {
        return fail(CONUS_ERROR_DATA, "line %zu: index 4294967295 is beyond a volume's number", event->line);
    }
    bool fits = memory_reserve(&atlas->points, &parsing->capacity, atlas->labels.count + 1, sizeof *atlas->points);
    struct label *label = fits ? label_table_add(&atlas->labels, parsing->index + 1) : NULL;
    if (!label) {
        return CONUS_ERROR_MEMORY;
    }
    atlas->points[atlas->labels.count - 1] = parsing->point;
    label->name = parsing->label.name;
    label->abbreviation = parsing->label.abbreviation;
    parsing->label = (struct label){0};
    return atlas->is_spm ? CONUS_OK : label_set_text(&label->name, event->text);
}

static conus_status end_element(void *user, const struct xml_event *event)
{
    struct parsing *parsing = user;
    struct fsl_atlas *atlas = &parsing->atlas;
    struct fsl_image *image = atlas->image_count ? &atlas->images[atlas->image_count - 1] : NULL;
    if (parsing->in_label && atlas->is_spm && strcmp(event->name, "label") != 0) {
        return end_in_label(parsing, event);
    }
    if (strcmp(event->name, "type") == 0) {
        return set_type(atlas, event->text);
    }
    if (image && strcmp(event->name, "imagefile") == 0) {
        return label_set_text(&image->image, event->text);
    }
    if (image && strcmp(event->name, "summaryimagefile") == 0) {
        return label_set_text(&image->summary, event->text);
    }
    return strcmp(event->name, "label") == 0 && parsing->in_label ? end_label(parsing, event) : CONUS_OK;
}

/* SPM's labels are the voxels' values; its other types are volumes of another kind. */
static conus_status check_type(struct fsl_atlas *atlas)
{
    if (!atlas->is_spm) {
        return atlas->type ? CONUS_OK
                           : fail(CONUS_ERROR_DATA, "no <type>: Label, Probabilistic or Statistic is needed");
    }
    if (atlas->type && !atlas->is_label) {
        return fail(CONUS_ERROR_DATA, "type \"%s\" of an atlas of SPM, allowed is Label", atlas->type);
    }
    atlas->is_label = true;
    return atlas->type ? CONUS_OK : label_set_text(&atlas->type, text_from("Label"));
}

conus_status fsl_atlas_parse(struct fsl_atlas *out, struct text text)
{
    struct parsing parsing = {0};
    struct xml_handler handler = {.start = start_element, .end = end_element, .user = &parsing};
    conus_status status = xml_parse(&handler, text);
    status = status ? status : check_type(&parsing.atlas);
    label_finish(&parsing.label);
    if (status) {
        fsl_atlas_finish(&parsing.atlas);
        return status;
    }
    *out = parsing.atlas;
    return CONUS_OK;
}
