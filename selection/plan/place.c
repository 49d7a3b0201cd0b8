/* SPDX-License-Identifier: BSD-3-Clause */
/* Finds the point that words mean: numbers, an area's inner point, a position of a cap. */
#include "conus/own.h"

#include "atlas/areas/areas.h"
#include "base/geometry/math3.h"
#include "base/options.h"
#include "poses/rows/pose_row.h"
#include "selection/plan/plan.h"
#include "selection/study/study.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { SHOWN = 80 };

/** A place that is being found. */
struct finding {
    const conus_atlas *atlas;
    const conus_place_options *options;
    struct place_words words;
    conus_place place;
};

enum brain { BRAIN_UNKNOWN, BRAIN_MNI152, BRAIN_OTHER };

/* Whether positions and words that say MNI fit the atlas: they do MNI 152 and Colin 27. */
static enum brain brain_of(const conus_atlas *atlas)
{
    const conus_brain brain = atlas->has_ccf ? CONUS_BRAIN_TEMPLATE : conus_atlas_brain(atlas).brain;
    return brain == CONUS_BRAIN_UNKNOWN                                  ? BRAIN_UNKNOWN
           : brain == CONUS_BRAIN_MNI152 || brain == CONUS_BRAIN_COLIN27 ? BRAIN_MNI152
                                                                         : BRAIN_OTHER;
}

/* Numbers in the space of the frame, unless words beside them say that they are in another. */
static conus_status take_numbers(struct finding *finding)
{
    const struct numbers *numbers = &finding->words.numbers;
    const conus_frame *frame = finding->options->frame;
    conus_space space = frame ? frame->space : CONUS_SPACE_RAS;
    uint32_t named = 0;
    if ((numbers->has_letters || numbers->says_ras) && space != CONUS_SPACE_RAS) {
        return fail(CONUS_ERROR_ARGUMENT, "\"%.*s\": %s RAS, but numbers are %s here (--space)",
                    TEXT_SHOW(finding->words.name, SHOWN),
                    numbers->says_ras ? "the words say" : "letters L R A P S I are", conus_space_name(space));
    }
    if (numbers->says_mm && space == CONUS_SPACE_CCF) {
        return fail(CONUS_ERROR_ARGUMENT, "\"%.*s\": it says mm, but numbers of --space ccf are micrometres",
                    TEXT_SHOW(finding->words.name, SHOWN));
    }
    if (numbers->says_mni && (space >= CONUS_SPACE_CCF || brain_of(finding->atlas) == BRAIN_OTHER)) {
        return fail(CONUS_ERROR_ARGUMENT, "\"%.*s\": it says MNI, but the atlas is another brain",
                    TEXT_SHOW(finding->words.name, SHOWN));
    }
    finding->place.is_doubtful = numbers->says_mni && brain_of(finding->atlas) == BRAIN_UNKNOWN;
    finding->place.is_also_named = !object_find(&named, finding->atlas, finding->words.name);
    if (frame) {
        return conus_frame_to_world(finding->place.point, frame, numbers->value) ? CONUS_ERROR_DATA : CONUS_OK;
    }
    memcpy(finding->place.point, numbers->value, sizeof finding->place.point);
    return CONUS_OK;
}

static void take_position(struct finding *finding, const struct position *position)
{
    finding->place.kind = CONUS_PLACE_POSITION;
    finding->place.name = position->name;
    memcpy(finding->place.point, position->point, sizeof finding->place.point);
    memcpy(finding->place.outward, position->outward, sizeof finding->place.outward);
}

/* A position on a scalp. */
static conus_status take_scalp_position(struct finding *finding, const struct position *position)
{
    struct position own;
    conus_status status = position_on_scalp(&own, finding->options->scalp, position);
    if (!status) {
        take_position(finding, &own);
        finding->place.is_on_scalp = true;
    }
    return status;
}

/* The end of a way from position to position, where the words are one. */
static conus_status take_way(bool *is_way, struct finding *finding)
{
    struct position_way way;
    struct position end;
    conus_status status = position_way_find(&end, &way, finding->options->scalp, finding->words.name);
    *is_way = !status && way.from;
    if (*is_way) {
        take_position(finding, &end);
        finding->place.is_on_scalp = true;
        finding->place.toward = way.to->name;
        finding->place.way_mm = way.mm;
    }
    return status;
}

/* Puts what is wrong with a name behind the message about it. */
static conus_status fail_with(conus_status status, const char *more)
{
    char message[1024];
    snprintf(message, sizeof message, "%s", conus_message());
    return fail(status, "%s%s", message, more);
}

/* A name that is also that of a position: an area that has it as a word comes first. Of several, none. */
static conus_status choose_position(struct finding *finding, const struct position *position)
{
    char more[64];
    conus_place *place = &finding->place;
    conus_status status = object_find(&place->object, finding->atlas, finding->words.name);
    if (status == CONUS_ERROR_ARGUMENT) {
        status = object_find_word(&place->object, finding->atlas, finding->words.name);
    }
    if (status == CONUS_ERROR_ARGUMENT) {
        snprintf(more, sizeof more, "; 1020:%s is the position of a cap", position->name);
        return fail_with(status, more);
    }
    if (status || place->object) {
        place->is_also_named = place->object;
        return status;
    }
    if (brain_of(finding->atlas) != BRAIN_MNI152) {
        return brain_of(finding->atlas) == BRAIN_OTHER
                   ? fail(CONUS_ERROR_ARGUMENT,
                          "%s is a position on the head of MNI 152, but the atlas is another brain", position->name)
                   : fail(CONUS_ERROR_ARGUMENT,
                          "%s is a position on the head of MNI 152, and it is not known whether the atlas lies there; "
                          "1020:%s says that it does",
                          position->name, position->name);
    }
    take_position(finding, position);
    return CONUS_OK;
}

static conus_status take_cap_position(struct finding *finding)
{
    const struct position *position = position_find(finding->words.name);
    if (!position) {
        return fail(CONUS_ERROR_ARGUMENT, "1020:%.*s: there is no such position of the 10-10 system, as C3 or Fp1",
                    TEXT_SHOW(finding->words.name, SHOWN));
    }
    if (finding->options->scalp) {
        return take_scalp_position(finding, position);
    }
    if (brain_of(finding->atlas) == BRAIN_OTHER) {
        return fail(CONUS_ERROR_ARGUMENT,
                    "1020:%s is a position on the head of MNI 152, but the atlas is another brain", position->name);
    }
    take_position(finding, position);
    return CONUS_OK;
}

static conus_status find_label(struct finding *finding)
{
    uint32_t found = 0;
    size_t count = 0;
    for (uint32_t number = 1; number <= finding->atlas->area_count; number++) {
        const conus_object *area = &finding->atlas->objects[number - 1];
        if (area->label == finding->words.label && !atlas_is_paired(finding->atlas, number)) {
            found = number;
            count++;
        }
    }
    finding->place.object = found;
    return count == 1 ? CONUS_OK
           : count    ? fail(CONUS_ERROR_ARGUMENT, "index:%u: %zu areas have this label; a name is needed",
                             (unsigned)finding->words.label, count)
                      : fail(CONUS_ERROR_ARGUMENT, "index:%u: no area has this label", (unsigned)finding->words.label);
}

/* Finds the object, or a position in its place. */
static conus_status find_object(struct finding *finding)
{
    const struct place_words *words = &finding->words;
    const struct position *position = words->form == PLACE_NAME ? position_find(words->name) : NULL;
    if (words->form == PLACE_LABEL) {
        return find_label(finding);
    }
    if (position) {
        return finding->options->scalp ? take_scalp_position(finding, position) : choose_position(finding, position);
    }
    conus_status status = object_find(&finding->place.object, finding->atlas, words->name);
    if (status == CONUS_ERROR_ARGUMENT && words->form == PLACE_NAME) {
        bool is_way;
        conus_status of_way = take_way(&is_way, finding);
        if (of_way || is_way) {
            return of_way;
        }
    }
    if (status == CONUS_ERROR_ARGUMENT && words->numbers.why) {
        return place_fail_numbers(words);
    }
    if (status != CONUS_ERROR_ARGUMENT || words->form != PLACE_NAME || strncmp(conus_message(), "no ", 3) != 0) {
        return status;
    }
    return words->numbers.count == 1   ? fail_with(status, "; it has one number, a point has three")
           : words->numbers.count == 2 ? fail_with(status, "; it has two numbers, a point has three")
           : brain_of(finding->atlas) == BRAIN_MNI152
               ? fail_with(status, strstr(conus_message(), "quotes") ? ". Or a 10-20 position, as C3"
                                   : strchr(conus_message(), '?')
                                       ? " Or a 10-20 position, as C3"
                                       : "; 'conus info' lists areas; or a 10-20 position, as C3")
               : status;
}

/* Advises near:, where there is an axis, and the centroid that lies in the area, as in one on the midline. */
static conus_status advise(conus_status status, const struct finding *finding, const struct plan_constraint *structure,
                           const double centroid[3])
{
    char more[SHOWN + 64];
    if (finding->options->has_axis) {
        snprintf(more, sizeof more, "; near:%.*s is its point nearest to the other end", SHOWN, finding->place.name);
        status = fail_with(status, more);
    }
    if (plan_is_inside(structure, centroid)) {
        snprintf(more, sizeof more, "; centroid:%.*s is one point of it, in the middle of all", SHOWN,
                 finding->place.name);
        status = fail_with(status, more);
    }
    return status;
}

static conus_status take_inner_point(struct finding *finding, const struct plan_constraint *structure,
                                     const double centroid[3])
{
    struct inner_point inner;
    conus_status status = plan_deepest(&inner, structure, centroid);
    if (!status && inner.depth == 0) {
        status = fail(CONUS_ERROR_ARGUMENT, "%s has no voxels and no closed surface, and so no inner point",
                      structure->name);
    }
    status = status ? status : plan_check_sides(structure, &inner, finding->atlas, finding->place.object);
    status = status == CONUS_ERROR_ARGUMENT ? advise(status, finding, structure, centroid) : status;
    finding->place.kind = CONUS_PLACE_INNER;
    finding->place.depth = inner.depth;
    memcpy(finding->place.point, inner.at, sizeof finding->place.point);
    return status;
}

static conus_status take_centroid(struct finding *finding, const struct plan_constraint *structure,
                                  const double centroid[4])
{
    finding->place.kind = CONUS_PLACE_CENTROID;
    memcpy(finding->place.point, centroid, sizeof finding->place.point);
    if (centroid[3] > 0 && plan_is_inside(structure, centroid)) {
        return CONUS_OK;
    }
    if (!(centroid[3] > 0)) {
        return fail(CONUS_ERROR_ARGUMENT, "%s has no voxels and no closed surface, and so no centroid",
                    structure->name);
    }
    const double *inner = finding->place.point;
    conus_status status = take_inner_point(finding, structure, centroid);
    return status ? status
                  : fail(CONUS_ERROR_ARGUMENT,
                         "the centroid of %s, (%.1f, %.1f, %.1f), is not in it; \"%s\" alone is its inner point, "
                         "(%.1f, %.1f, %.1f), RAS mm",
                         structure->name, centroid[0], centroid[1], centroid[2], structure->name, inner[0], inner[1],
                         inner[2]);
}

static conus_status take_nearest(struct finding *finding, const struct plan_constraint *structure)
{
    finding->place.kind = CONUS_PLACE_NEAR;
    if (!finding->options->other) {
        return fail(
            CONUS_ERROR_ARGUMENT,
            "near:%s is the point nearest to the other end of an axis, which is a place of its own; there is none",
            structure->name);
    }
    return plan_nearest_point(finding->place.point, structure, finding->options->other)
               ? CONUS_OK
               : fail(CONUS_ERROR_ARGUMENT, "near:%s: it has neither voxels nor a surface", structure->name);
}

static conus_status take_object(struct finding *finding)
{
    struct plan_constraint structure = {0};
    conus_status status = plan_structure_of(&structure, finding->atlas, finding->place.object);
    finding->place.name = finding->atlas->objects[finding->place.object - 1].name;
    if (!status && finding->words.form == PLACE_NEAR) {
        status = take_nearest(finding, &structure);
    } else if (!status) {
        double centroid[4];
        plan_centroid(centroid, &structure);
        status = finding->words.form == PLACE_CENTROID ? take_centroid(finding, &structure, centroid)
                                                       : take_inner_point(finding, &structure, centroid);
    }
    plan_constraint_finish(&structure);
    return status;
}

conus_status conus_place_find(conus_place *out, const conus_atlas *atlas, const char *text,
                              const conus_place_options *options)
{
    options = options_of(conus_place_options, options);
    struct finding finding = {.atlas = atlas, .options = options, .place = {.depth = NAN, .name = ""}};
    conus_status status = place_read(&finding.words, text_from(text));
    if (!status && finding.words.form == PLACE_NUMBERS) {
        status = take_numbers(&finding);
    } else if (!status && finding.words.form == PLACE_CAP) {
        status = take_cap_position(&finding);
    } else if (!status) {
        status = find_object(&finding);
        status = status || !finding.place.object ? status : take_object(&finding);
    }
    if (!status) {
        *out = finding.place;
    }
    return status;
}

bool conus_place_is_near(const char *text)
{
    struct place_words words;
    return !place_read(&words, text_from(text)) && words.form == PLACE_NEAR;
}
