/* SPDX-License-Identifier: BSD-3-Clause */
/* What a web page asks beside its two places, as rows of options: conus page, the page's form and links, npm's load. */
#include "conus/own.h"
#include "conus/selection.h"
#include "options/messages.h"
#include "pages/pages.h"
#include "settings/settings.h"

#include <string.h>

#define PAGE_ANGLE 20
enum { WORD_LIMIT = 64 };

static const char *const layer_names[] = {"visible", "all", NULL};

const struct option page_question_options[] = {
    {OPTION_DEGREES("angle", struct page_question, angle), .help = "full opening angle of the cone, 0.001 to 170",
     .standard = OPTION_DIGITS(PAGE_ANGLE), OPTION_FROM_TO(0.001, 170), .needs = "origin", .common = true},
    {OPTION_VALUED("layers", struct page_question, layers, "LAYERS"),
     .help = "first hits, or all in the cone:", .choices = layer_names, .needs = "origin"},
    {OPTION_VALUED("range", struct page_question, selector.range, "NEAR,FAR"),
     .help = "count only between these two depths along the axis, mm from the apex", OPTION_FROM_TO(0, 1e9),
     .needs = "origin", .unit = "mm"},
    {0},
};

static const struct option_group groups[] = {
    {"", page_question_options, 0}, {"", ray_options, offsetof(struct page_question, selector)}, {0}};
const struct command page_question_form = {.name = "page", .groups = groups};

conus_selector_options page_question_selector(const struct page_question *question)
{
    conus_selector_options options = question->selector;
    options.layers = (conus_layers)question->layers;
    return options;
}

double page_question_angle(const struct page_question *question)
{
    return question->angle > 0 ? question->angle : PAGE_ANGLE;
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

bool page_question_read(struct page_question *out, const char *text)
{
    for (const char *rest = text + strspn(text, "&"); *rest; rest += strspn(rest, "&")) {
        char word[WORD_LIMIT];
        const size_t size = strcspn(rest, "&");
        snprintf(word, sizeof word, "%.*s", (int)(size < sizeof word ? size : sizeof word), rest);
        char *value = strchr(word, '=');
        const struct option *option;
        size_t i = 0;
        if (value) {
            *value++ = '\0';
        }
        while ((option = option_at(&page_question_form, i)) && strcmp(option->name, word) != 0) {
            i++;
        }
        if (size >= sizeof word || !value || !option) {
            return refuse("%s: a page asks nothing of this name", word);
        }
        if (!option_read(option, option_field(&page_question_form, out, i), value)) {
            return false;
        }
        rest += size;
    }
    return true;
}
