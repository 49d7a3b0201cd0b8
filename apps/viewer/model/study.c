/* SPDX-License-Identifier: BSD-3-Clause */
/* The question of a study and its answer, as conus sweep computes it. Plots and text come from the same selections. */
#include "viewer/model/study.h"

#include "base/order.h"
#include "options/options.h"
#include "viewer/model/viewer.h"
#include "viewer/pictures/pictures.h"

#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const struct study_settings study_defaults = {.angles = {2, 40, 2}, .tilt_deg = 2, .shift_mm = 1.5, .samples = 1024};

const char *study_fault(const struct study_settings *settings)
{
    const double *angles = settings->angles;
    const size_t count = angles_count(angles);
    const bool has_angles = count && angles[0] > 0 && angles_at(angles, count - 1) < 180;
    int exponent;
    bool is_power_of_two =
        settings->samples >= 16 && settings->samples <= 1048576 && frexp(settings->samples, &exponent) == 0.5;
    return !count                ? "angles: from, to and by are needed, \"to\" from \"from\" on and \"by\" above 0"
           : count > ANGLE_LIMIT ? "angles: there are more than 1000"
           : !has_angles         ? "angles: allowed is more than 0 and less than 180 degrees"
           : !(settings->tilt_deg >= 0 && settings->tilt_deg <= 90)  ? "jitter: a tilt of 0 to 90 degrees is needed"
           : !(settings->shift_mm >= 0 && settings->shift_mm <= 1e6) ? "jitter: a shift of 0 to 1000000 mm is needed"
           : !is_power_of_two ? "jitter: samples: a power of two from 16 to 1048576 is needed"
                              : NULL;
}

bool selector_options_are_same(const conus_selector_options *a, const conus_selector_options *b)
{
    _Static_assert(offsetof(conus_selector_options, prior) + sizeof(const char *) == sizeof *a,
                   "a new option is compared here, too");
    return a->engine == b->engine && a->aperture == b->aperture && a->sampling == b->sampling &&
           a->resolution == b->resolution && a->slices == b->slices && a->layers == b->layers &&
           a->range[0] == b->range[0] && a->range[1] == b->range[1] && a->radius == b->radius && a->score == b->score &&
           a->slice_fraction == b->slice_fraction && a->frame == b->frame && a->weight == b->weight &&
           a->prior == b->prior && strcmp(a->level ? a->level : "", b->level ? b->level : "") == 0;
}

bool study_has_same_selectors(const struct study_question *a, const struct study_question *b)
{
    return a->atlas_number == b->atlas_number && strcmp(a->level, b->level) == 0 &&
           selector_options_are_same(&a->options, &b->options);
}

bool study_is_same(const struct study_question *a, const struct study_question *b)
{
    const struct study_settings *x = &a->settings;
    const struct study_settings *y = &b->settings;
    bool same_angles = x->angles[0] == y->angles[0] && x->angles[1] == y->angles[1] && x->angles[2] == y->angles[2];
    bool same_errors = x->tilt_deg == y->tilt_deg && x->shift_mm == y->shift_mm && x->samples == y->samples;
    return pose_is_same(&a->pose, &b->pose) && x->kind == y->kind && study_has_same_selectors(a, b) &&
           (x->kind == STUDY_SWEEP ? same_angles : same_errors && a->angle == b->angle);
}

/* A study under way. */
struct work {
    struct study_answer *answer;
    conus_selector *const *selectors;
    conus_report **reports; /* [atlas_count] That of the first has the answers of all. */
    bool (*stops)(void *user);
    void *user;
    bool stopped;
};

/* Whether it goes on. */
static bool go_on(void *user, size_t done, size_t total)
{
    struct work *work = user;
    (void)done;
    (void)total;
    work->stopped = work->stops(work->user);
    return !work->stopped;
}

/* The object's curve, a new one where there is none yet; NULL without memory. */
static struct study_curve *curve_of(struct study_table *table, uint32_t object, size_t angle_count)
{
    for (size_t i = 0; i < table->curve_count; i++) {
        if (table->curves[i].object == object) {
            return &table->curves[i];
        }
    }
    struct study_curve *curves = realloc(table->curves, (table->curve_count + 1) * sizeof *curves);
    table->curves = curves ? curves : table->curves;
    double *shares = curves ? calloc(angle_count, sizeof *shares) : NULL;
    if (!shares) {
        return NULL;
    }
    curves[table->curve_count] = (struct study_curve){.object = object, .shares = shares};
    return &curves[table->curve_count++];
}

static conus_status note_shares(struct study_table *table, const conus_selection *selection, size_t angle,
                                size_t angle_count)
{
    const conus_result *result;
    for (size_t i = 0; (result = conus_selection_result(selection, i)); i++) {
        struct study_curve *curve = curve_of(table, result->object, angle_count);
        if (!curve) {
            return CONUS_ERROR_MEMORY;
        }
        curve->shares[angle] = result->share;
        curve->most = fmax(curve->most, result->share);
    }
    return CONUS_OK;
}

static int compare_curves(const void *a, const void *b)
{
    const struct study_curve *one = a;
    const struct study_curve *other = b;
    if (!one->object != !other->object) {
        return one->object ? -1 : 1;
    }
    return one->most != other->most ? (one->most < other->most) - (one->most > other->most)
                                    : (one->object > other->object) - (one->object < other->object);
}

static conus_status sweep(struct work *work, size_t atlas)
{
    struct study_answer *answer = work->answer;
    struct study_table *table = &answer->tables[atlas];
    conus_status status = CONUS_OK;
    for (size_t i = 0; i < answer->angle_count && !status && !work->stopped; i++) {
        conus_selection *selection = NULL;
        status = conus_select(&selection, work->selectors[atlas], &answer->question.pose, answer->angles[i]);
        status = status ? status : conus_report_add(work->reports[atlas], "1", selection);
        status = status ? status : note_shares(table, selection, i, answer->angle_count);
        conus_selection_destroy(selection);
        go_on(work, i, answer->angle_count);
    }
    order_sort(table->curves, table->curve_count, sizeof *table->curves, compare_curves);
    return status;
}

static bool list_angles(struct study_answer *answer)
{
    const double *range = answer->question.settings.angles;
    answer->angle_count = angles_count(range);
    answer->angles = calloc(answer->angle_count, sizeof *answer->angles);
    for (size_t i = 0; answer->angles && i < answer->angle_count; i++) {
        answer->angles[i] = angles_at(range, i);
    }
    return answer->angles;
}

static conus_status shake(struct work *work, size_t atlas)
{
    const struct study_question *question = &work->answer->question;
    const conus_jitter_options options = {.tilt = question->settings.tilt_deg,
                                          .shift = question->settings.shift_mm,
                                          .samples = (uint32_t)question->settings.samples,
                                          .progress = go_on,
                                          .progress_user = work};
    conus_table **chances = &work->answer->tables[atlas].chances;
    conus_status status = conus_jitter(chances, work->selectors[atlas], &question->pose, question->angle, &options);
    return status ? status : conus_report_add_table(work->reports[atlas], "1", *chances);
}

static conus_status answer_atlas(struct work *work, const char *name, size_t atlas)
{
    const struct study_question *question = &work->answer->question;
    bool sweeps = question->settings.kind == STUDY_SWEEP;
    const conus_report_options options = {.rows = sweeps ? "shares" : "chances",
                                          .format = "tsv",
                                          .atlas = name[0] ? name : NULL,
                                          .frame = &question->frame,
                                          .no_voxels = true};
    conus_status status = conus_report_create(&work->reports[atlas], work->selectors[atlas], &options);
    if (!status && atlas) {
        status = conus_report_join(work->reports[0], work->reports[atlas]);
    }
    return status ? status : sweeps ? sweep(work, atlas) : shake(work, atlas);
}

static conus_status answer_all(struct work *work, const struct view_atlas *atlases, size_t count)
{
    const char *text;
    size_t size;
    conus_status status = CONUS_OK;
    const struct study_question *question = &work->answer->question;
    if (question->settings.kind == STUDY_PLAN) {
        return plan_list_fill(&work->answer->plan, question->plan, work->selectors[0], atlases->atlas, &question->frame,
                              go_on, work);
    }
    for (size_t i = 0; i < count && !status && !work->stopped; i++) {
        status = answer_atlas(work, atlases[i].name, i);
    }
    if (status || work->stopped) {
        return status;
    }
    status = conus_report_text(&text, &size, work->reports[0]);
    work->answer->text = status ? NULL : strdup(text);
    return status || work->answer->text ? status : CONUS_ERROR_MEMORY;
}

struct study_answer *study_answer_refuse(const struct study_question *question, const char *why)
{
    struct study_answer *answer = calloc(1, sizeof *answer);
    if (answer) {
        answer->question = *question;
        snprintf(answer->error, sizeof answer->error, "%s", why);
    }
    return answer;
}

struct study_answer *study_answer_create(const struct study_question *question, conus_selector *const *selectors,
                                         const struct view_atlas *atlases, size_t count, bool (*stops)(void *user),
                                         void *user)
{
    struct study_answer *answer = study_answer_refuse(question, "");
    struct work work = {.answer = answer, .selectors = selectors, .stops = stops, .user = user};
    work.reports = calloc(count, sizeof(conus_report *));
    bool fine = answer && work.reports && (question->settings.kind != STUDY_SWEEP || list_angles(answer));
    if (fine) {
        answer->tables = calloc(count, sizeof *answer->tables);
        answer->atlas_count = answer->tables ? count : 0;
        conus_status status = answer->tables ? answer_all(&work, atlases, count) : CONUS_ERROR_MEMORY;
        if (status) {
            snprintf(answer->error, sizeof answer->error, "%s",
                     status == CONUS_ERROR_MEMORY ? "not enough memory" : conus_message());
        }
    }
    for (size_t i = 0; work.reports && i < count; i++) {
        conus_report_destroy(work.reports[i]);
    }
    free((void *)work.reports);
    if (!fine || work.stopped) {
        study_answer_destroy(answer);
        return NULL;
    }
    return answer;
}

double chance_number(const conus_table *chances, size_t row, const char *column)
{
    return conus_table_numbers(chances, column)[row];
}

bool chance_is_behind(const conus_table *chances, size_t row)
{
    return conus_table_objects(chances)[row] && chance_number(chances, row, "p_seen") <= 0 &&
           chance_number(chances, row, "p_in_cone") > 0; /* NaN without all layers */
}

bool chance_is_listed(const conus_table *chances, size_t row)
{
    return chance_number(chances, row, "p_hit") > 0 || chance_number(chances, row, "p_seen") > 0 ||
           chance_is_behind(chances, row);
}

void study_answer_destroy(struct study_answer *answer)
{
    for (size_t i = 0; answer && i < answer->atlas_count; i++) {
        struct study_table *table = &answer->tables[i];
        for (size_t c = 0; c < table->curve_count; c++) {
            free(table->curves[c].shares);
        }
        free(table->curves);
        conus_table_destroy(table->chances);
    }
    if (answer) {
        free(answer->plan.rows);
        free(answer->plan.text);
        free(answer->tables);
        free(answer->angles);
        free(answer->text);
        free(answer);
    }
}
