/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * The tables of a program's options, which its parser and --help use, as JSON. scripts/pages makes man pages and
 * completions of it, scripts/descriptors forms, scripts/option-lists lists of the documents. And what a web page asks,
 * of which its form is made. */
#ifndef CONUS_PAGES_PAGES_H
#define CONUS_PAGES_PAGES_H

#include "conus/selection.h"
#include "options/options.h"

#include <jansson.h>

/** A program and its commands. */
struct program {
    const char *name;    /**< "conus" */
    const char *summary; /**< One line, no final period. */
    const char *description;
    const struct command *const *commands; /**< Ends with NULL. One alone is not named on the command line. */
};

/** Whether the command line is PROGRAM help --json. Then writes the tables (docs/commands.md), prints an error for what
 * fails, and sets @p code. */
bool pages_answer(int *code, const struct program *program, int count, char **words);

/** One command with its options, in their order: a new reference, NULL without memory. */
json_t *pages_command(const struct command *command);
/** Its options alone. */
json_t *pages_options(const struct command *command);

/** What a page asks beside its two places; zero = the defaults. A row is an option of `conus page`, a field of the
 * page's form, a word of its links and of its command, and a setting of npm's load(). */
struct page_question {
    conus_selector_options selector; /**< Its range, and numbers of ray_options. */
    double angle;                    /**< Full opening angle, degrees. */
    size_t layers;                   /**< conus_layers */
    const char *weight; /**< "gauss=DEGREES": by which each object has a posterior, and ranks; NULL = none. */
};

/** page_question: numbers, counts, ranges, choices, flags and texts; a choice's default is its first. */
extern const struct option page_question_options[];
/** These and ray_options. */
extern const struct command page_question_form;

/** The selector's options of it, and the weight in these, the caller's to destroy after the selector; NULL = none. */
conus_status page_question_selector(conus_selector_options *out, conus_weight **weight,
                                    const struct page_question *question);
/** The angle that is asked, else that of the weight, else 20 degrees. */
double page_question_angle(const struct page_question *question, const conus_weight *weight);
/** Prints an error and returns false where a page does not take the weight. */
bool page_question_check(const struct page_question *question);

/** Writes "&angle=20&layers=visible&resolution=64", as links have it. */
void page_question_put(FILE *out, const struct page_question *question);
/** Reads such a text, in which texts of @p out then lie, into @p out, which is zeroed. Prints an error and returns
 * false where it says anything else. */
bool page_question_read(struct page_question *out, char *text);

#endif
