/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Writes an atlas, a question and its answer into one HTML file. */
#ifndef CONUS_CLI_CMD_PAGE_H
#define CONUS_CLI_CMD_PAGE_H

#include "options/options.h"
#include "settings/settings.h"

struct page_settings {
    struct common_settings common;
    const char *output;
    const char *origin, *toward; /* places */
    double angle;
    size_t layers; /* conus_layers */
    uint32_t resolution;
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
