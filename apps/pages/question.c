/* SPDX-License-Identifier: BSD-3-Clause */
/* What a web page asks beside its two places, as rows of options: conus page, the page's form and links, npm's load. */
#include "conus/own.h"
#include "conus/selection.h"
#include "options/messages.h"
#include "pages/pages.h"

#include <string.h>

#define PAGE_ANGLE 20

static const char *const layer_names[] = {"visible", "all", NULL};

const struct option page_question_options[] = {
    {OPTION_DEGREES("angle", struct page_question, angle), .help = "full opening angle of the cone, 0.001 to 170",
     .standard = OPTION_DIGITS(PAGE_ANGLE), OPTION_FROM_TO(0.001, 170), .needs = "origin", .common = true},
    {OPTION_VALUED("layers", struct page_question, layers, "LAYERS"),
     .help = "first hits, or all in the cone:", .choices = layer_names, .needs = "origin"},
    {OPTION_VALUED("resolution", struct page_question, resolution, "N"),
     .help = "rays along a side of the buffer, 1 to 256", .standard = OPTION_DIGITS(CONUS_RESOLUTION_DEFAULT),
     OPTION_FROM_TO(1, 256), .needs = "origin"},
    {OPTION_VALUED("range", struct page_question, range, "NEAR,FAR"),
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

conus_status page_question_selector(conus_selector_options *out, conus_weight **weight,
                                    const struct page_question *question)
{
    conus_selector_options options = CONUS_SELECTOR_OPTIONS_INIT;
    options.resolution = question->resolution ? question->resolution : CONUS_RESOLUTION_DEFAULT;
    options.layers = (conus_layers)question->layers;
    memcpy(options.range, question->range, sizeof options.range);
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
    for (const struct option *option = page_question_options; option->name; option++) {
        const void *field = (const char *)question + option->offset;
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
        const struct option *option = page_question_options;
        if (value) {
            *value++ = '\0';
        }
        while (option->name && strcmp(option->name, word) != 0) {
            option++;
        }
        if (!value || !option->name) {
            return refuse("%s: a page asks nothing of this name", word);
        }
        if (!option_read(option, (char *)out + option->offset, value)) {
            return false;
        }
    }
    return page_question_check(out);
}
