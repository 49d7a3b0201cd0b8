/* SPDX-License-Identifier: BSD-3-Clause */
/* Parses an atlas XML of FSL, SPM or CAT12. */
#include "loaders/labels/labels.h"

#include "base/formats/xml.h"
#include "base/geometry/math3.h"
#include "loaders/labels/label_format.h"

#include <string.h>

enum { IMAGE_LIMIT = 64 };

struct parsing {
    struct job *job;
    struct fsl_atlas *atlas;
    bool in_label;
    bool indexed; /* `index` belongs to the open label */
    uint32_t index;
    struct fsl_point point;
    const char *name, *abbreviation; /* of SPM's label; NULL if it is not given yet */
};

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
static void start_label(struct parsing *parsing, const struct xml_event *event)
{
    const char *index = xml_attribute(event, "index");
    struct fsl_atlas *atlas = parsing->atlas;
    if (atlas->labels.count && atlas->is_spm != !index) {
        job_bad(parsing->job, "a label %s the attribute index, others %s it", index ? "with" : "without",
                index ? "lack" : "have");
    } else if (parsing->in_label) {
        job_bad(parsing->job, "a label inside a label");
    }
    atlas->is_spm = !index;
    parsing->in_label = true;
    parsing->indexed = index != NULL;
    parsing->point = read_point(event);
    parsing->index = index ? label_cell_number(parsing->job, text_from(index)) : 0;
}

static conus_status start_element(void *user, const struct xml_event *event)
{
    struct parsing *parsing = user;
    struct job *job = parsing->job;
    struct fsl_atlas *atlas = parsing->atlas;
    size_t place = job_in(job, "line ", event->line);
    if (strcmp(event->name, "label") == 0) {
        start_label(parsing, event);
    }
    job_out(job, place);
    if (strcmp(event->name, "images") == 0) {
        if (atlas->image_count == IMAGE_LIMIT) {
            job_bad(job, "more than %d <images>", IMAGE_LIMIT);
        }
        list_add(job, &atlas->images, &atlas->image_count, &atlas->image_capacity, sizeof *atlas->images);
    }
    return job->status;
}

/* The last text counts, but an empty one changes nothing. */
static void set_last(struct job *job, const char **field, struct text text)
{
    const char *name = job_name(job, text);
    *field = name ? name : *field;
}

static void set_type(struct job *job, struct fsl_atlas *atlas, struct text text)
{
    struct text type = text_trim(text);
    if (!text_is_one_of(type, "Label/Probabilistic/Probabalistic/Statistic", false)) {
        job_bad(job, "type \"%.*s\", allowed are Label, Probabilistic and Statistic", TEXT_SHOW(type, 60));
    }
    atlas->is_label = text_equal_ignoring_case(type, "Label");
    set_last(job, &atlas->type, text);
}

/* The first text stays: an empty one is none. */
static void set_first(struct job *job, const char **field, struct text text)
{
    *field = *field ? *field : job_name(job, text);
}

/* The elements that SPM writes inside a label. */
static void end_in_label(struct parsing *parsing, const struct xml_event *event)
{
    struct job *job = parsing->job;
    if (strcmp(event->name, "index") == 0) {
        if (parsing->indexed) {
            job_bad(job, "a second index of one label");
        }
        parsing->indexed = true;
        parsing->index = label_cell_number(job, text_trim(event->text));
    } else if (strcmp(event->name, "name") == 0) {
        set_first(job, &parsing->name, event->text);
    } else if (strcmp(event->name, "short_name") == 0) {
        set_first(job, &parsing->abbreviation, event->text);
    }
}

/* Labels keep their index plus one: 0 stays free. */
static void end_label(struct parsing *parsing)
{
    parsing->in_label = false;
    if (!parsing->indexed) {
        job_bad(parsing->job, "a label without an index");
    } else if (parsing->index == UINT32_MAX) {
        job_bad(parsing->job, "index 4294967295 is beyond a volume's number");
    }
}

static void keep_label(struct parsing *parsing, struct text text)
{
    struct job *job = parsing->job;
    struct fsl_atlas *atlas = parsing->atlas;
    struct fsl_point *point =
        list_add(job, &atlas->points, &atlas->point_count, &atlas->point_capacity, sizeof *atlas->points);
    *point = parsing->point;
    struct label *label = labels_add(job, &atlas->labels, parsing->index + 1);
    labels_set(job, &label->name, atlas->is_spm ? text_from(parsing->name ? parsing->name : "") : text);
    labels_set(job, &label->abbreviation, text_from(parsing->abbreviation ? parsing->abbreviation : ""));
    parsing->name = parsing->abbreviation = NULL;
}

static conus_status end_element(void *user, const struct xml_event *event)
{
    struct parsing *parsing = user;
    struct job *job = parsing->job;
    struct fsl_atlas *atlas = parsing->atlas;
    struct fsl_image *image = atlas->image_count ? &atlas->images[atlas->image_count - 1] : NULL;
    bool is_label = strcmp(event->name, "label") == 0;
    if (parsing->in_label && (is_label || atlas->is_spm)) {
        size_t place = job_in(job, "line ", event->line);
        if (is_label) {
            end_label(parsing);
        } else {
            end_in_label(parsing, event);
        }
        job_out(job, place);
        if (is_label) {
            keep_label(parsing, event->text);
        }
    } else if (strcmp(event->name, "type") == 0) {
        set_type(job, atlas, event->text);
    } else if (image && strcmp(event->name, "imagefile") == 0) {
        set_last(job, &image->image, event->text);
    } else if (image && strcmp(event->name, "summaryimagefile") == 0) {
        set_last(job, &image->summary, event->text);
    }
    return job->status;
}

/* SPM's labels are the voxels' values; its other types are volumes of another kind. */
static void check_type(struct job *job, struct fsl_atlas *atlas)
{
    if (atlas->is_spm && atlas->type && !atlas->is_label) {
        job_bad(job, "type \"%s\" of an atlas of SPM, allowed is Label", atlas->type);
    } else if (!atlas->is_spm && !atlas->type) {
        job_bad(job, "no <type>: Label, Probabilistic or Statistic is needed");
    }
    atlas->is_label = atlas->is_label || atlas->is_spm;
    atlas->type = atlas->type ? atlas->type : "Label";
}

struct fsl_atlas *fsl_atlas_parse(struct job *job, struct text text)
{
    struct fsl_atlas *atlas = job_new(job, struct fsl_atlas);
    if (!atlas) {
        return job_spare(job, sizeof *atlas);
    }
    labels_own(job, &atlas->labels);
    struct parsing parsing = {.job = job, .atlas = atlas};
    static const char known[] = /* of SPM's and CAT12's, too */
        "atlas/header/name/shortname/type/images/imagefile/summaryimagefile/statistic/units/precision/upper/lower/data/"
        "label/version/description/url/licence/license/email/coordinate_system/index/short_name/RGBA/XYZmm";
    const struct xml_handler handler = {
        .start = start_element, .end = end_element, .user = &parsing, .known = known, .strange = &job->notes};
    (void)JOB_CALL(job, xml_parse(&handler, text));
    check_type(job, atlas);
    return atlas;
}
