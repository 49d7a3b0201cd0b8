/* SPDX-License-Identifier: BSD-3-Clause */
/* What a web page asks beside its two places, as rows of options: conus page, the page's form and links, npm's load. */
#include "conus/own.h"
#include "conus/selection.h"
#include "options/messages.h"
#include "options/options.h"
#include "pages/pages.h"

#include <string.h>

#define PAGE_ANGLE 20

static const char *const layer_names[] = {"visible", "all", NULL};

const struct option page_question_options[] = {
    {OPTION_DEGREES("angle", struct page_question, angle), .help = "full opening angle of the cone, 0.001 to 170",
     .standard = OPTION_DIGITS(PAGE_ANGLE), OPTION_FROM_TO(0.001, 170), .needs = "origin", .common = true},
    {OPTION_VALUED("layers", struct page_question, layers, "LAYERS"),
     .help = "first hits, or all in the cone:", .choices = layer_names, .needs = "origin"},
    {OPTION_VALUED("range", struct page_question, selector.range, "NEAR,FAR"),
     .help = "count only between these two depths along the axis, mm from the apex", OPTION_FROM_TO(0, 1e9),
     .needs = "origin", .unit = "mm"},
    {OPTION_VALUED("weight", struct page_question, weight, "gauss=DEGREES"),
     .help =
         "weigh the cone as a hand or tracker is off by so much about each of two axes, 0.01 to 20, and rank by the "
         "probability that an object is meant, if each is meant as often; the cone opens to 8 times as much unless "
         "--angle says otherwise",
     .words = "posterior, soft, Gaussian, uncertainty, pointing, VR", .role = OPTION_ASKS, .needs = "origin"},
    {0},
};

static const struct option_group groups[] = {
    {"", page_question_options, 0}, {"", ray_options, offsetof(struct page_question, selector)}, {0}};
const struct command page_question_form = {.name = "page", .groups = groups};

conus_status page_question_selector(conus_selector_options *out, conus_weight **weight,
                                    const struct page_question *question)
{
    conus_selector_options options = question->selector;
    options.layers = (conus_layers)question->layers;
    if (question->weight) {
        conus_status status = conus_weight_create(weight, question->weight);
        if (status) {
            return status;
        }
        options.weight = *weight;
        options.score = "posterior";
    }
    *out = options;
    return CONUS_OK;
}

double page_question_angle(const struct page_question *question, const conus_weight *weight)
{
    return question->angle > 0 ? question->angle : weight ? conus_weight_angle(weight) : PAGE_ANGLE;
}

bool page_question_check(const struct page_question *question)
{
    const char *text = question->weight;
    conus_weight *weight = NULL;
    if (text && (strncmp(text, "gauss=", 6) != 0 || text[6 + strspn(text + 6, "0123456789.")])) {
        return refuse("--weight: \"%s\", a page takes gauss=DEGREES alone", text);
    }
    if (text && conus_weight_create(&weight, text)) {
        return refuse("--weight: %s", conus_message());
    }
    conus_weight_destroy(weight);
    return true;
}

void page_question_put(FILE *out, const struct page_question *question)
{
    const struct option *option;
    for (size_t i = 0; (option = option_at(&page_question_form, i)); i++) {
        const void *field = option_field(&page_question_form, (void *)question, i);
        const double *range = option->type == OPTION_RANGE ? field : (const double[2]){0};
        const double number = option->type == OPTION_NUMBER  ? *(const double *)field
                              : option->type == OPTION_COUNT ? *(const uint32_t *)field
                                                             : 0;
        const char *word = option->type == OPTION_CHOICE ? option_choice(option, *(const size_t *)field)
                           : option->type == OPTION_FLAG ? (*(const bool *)field ? "1" : NULL)
                           : option->type == OPTION_TEXT ? *(const char *const *)field
                                                         : option_standard(option);
        if (number != 0) {
            fprintf(out, "&%s=%.17g", option->name, number);
        } else if (range[1] > 0) {
            fprintf(out, "&%s=%.17g,%.17g", option->name, range[0], range[1]);
        } else if (word) {
            fprintf(out, "&%s=%s", option->name, word);
        }
    }
}

bool page_question_read(struct page_question *out, char *text)
{
    for (char *rest, *word = strtok_r(text, "&", &rest); word; word = strtok_r(NULL, "&", &rest)) {
        char *value = strchr(word, '=');
        const struct option *option;
        size_t i = 0;
        if (value) {
            *value++ = '\0';
        }
        while ((option = option_at(&page_question_form, i)) && strcmp(option->name, word) != 0) {
            i++;
        }
        if (!value || !option) {
            return refuse("%s: a page asks nothing of this name", word);
        }
        if (!option_read(option, option_field(&page_question_form, out, i), value)) {
            return false;
        }
    }
    return page_question_check(out);
}
