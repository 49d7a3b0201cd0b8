/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The commands, one file each. */
#ifndef CONUS_CLI_COMMANDS_H
#define CONUS_CLI_COMMANDS_H

#include "options/options.h"
#include "pages/pages.h"
#include "settings/settings.h"

extern const struct command cmd_atlases;
extern const struct command cmd_info;
extern const struct command cmd_query;
extern const struct command cmd_batch;
extern const struct command cmd_render;
extern const struct command cmd_sweep;
extern const struct command cmd_track;
extern const struct command cmd_overlap;
extern const struct command cmd_connect;
extern const struct command cmd_plan;
extern const struct command cmd_calibrate;
extern const struct command cmd_positions;
extern const struct command cmd_manifest;
extern const struct command cmd_mcp;
extern const struct command cmd_mesh;
extern const struct command cmd_phantom;
extern const struct command cmd_diff;
extern const struct command cmd_report;
extern const struct command cmd_verify;
extern const struct command cmd_cite;
extern const struct command cmd_pack;
extern const struct command cmd_page;
extern const struct command cmd_view; /**< Another program's. */

/** Writes the paragraph of methods of @p result and its references, or these as BibTeX. Returns the exit code and
 * prints an error unless it is 0. */
int cite_put(FILE *out, const char *result, bool is_bibtex);

/* Writes an atlas, a question and its answer into one HTML file. */

struct page_settings {
    struct common_settings common;
    const char *output;
    const char *origin, *toward; /* places */
    struct page_question question;
    const char *context;
    const char *template;
    bool large, force;
};

/** Of a page whose file the user does not name. */
extern const struct option_group page_view_groups[];

/** Writes the page of the atlas that is the first operand; @p before begins the message where there is no template.
 * Returns the exit code and prints an error unless it is 0. */
int page_write(struct page_settings settings, const struct arguments *arguments, const char *before);

#endif
