/* SPDX-License-Identifier: BSD-3-Clause */
/* The table of the options about what an axis passes, and what --contacts means. */
#include "settings/axis_options.h"

#include "options/messages.h"
#include "options/options.h"

#include <stdlib.h>
#include <string.h>

static const char *const orders[] = {"rank", "depth", NULL};

const struct option axis_options[] = {
    {.name = "segments",
     .type = OPTION_TEXT,
     .offset = offsetof(struct axis_settings, segments),
     .value = "FILE",
     .help = "write what the axis passes, in order of depth: a row for each stretch inside an area, pathway or "
             "bundle, or between them",
     .words = "probe, shank, track",
     .role = OPTION_WRITES_ROWS,
     .flags = OPTION_OF_CONE},
    {.name = "order",
     .type = OPTION_CHOICE,
     .offset = offsetof(struct axis_settings, order),
     .value = "ORDER",
     .help = "order of the rows of an answer: the best first, or the nearest (with --layers all by entry, else by "
             "distance):",
     .choices = orders,
     .words = "sort"},
    {.name = "contacts",
     .type = OPTION_TEXT,
     .offset = offsetof(struct axis_settings, contacts),
     .value = "COUNT,COLUMNS,PITCH,TIP",
     .help = "for --format open-ephys of shanks: COUNT contacts, COLUMNS in a row, PITCH mm from row to row, the first "
             "TIP mm from the tip",
     .role = OPTION_ASKS},
    {0},
};

/* Cuts the next of the numbers off; false where there is none. */
static bool take_number(double *out, char **rest)
{
    const char *word = strsep(rest, ",");
    return word && number_parse(word, out);
}

static bool parse(conus_contacts *out, char *text)
{
    double count, columns;
    bool whole = take_number(&count, &text) && take_number(&columns, &text) && take_number(&out->pitch, &text) &&
                 take_number(&out->tip, &text) && !text;
    whole = whole && count >= 1 && count <= UINT32_MAX && columns >= 1 && columns <= UINT32_MAX;
    out->count = whole ? (uint32_t)count : 0;
    out->columns = whole ? (uint32_t)columns : 0;
    return whole && out->count == count && out->columns == columns;
}

int settings_contacts(conus_contacts *out, const struct axis_settings *settings)
{
    *out = (conus_contacts){0};
    if (!settings->contacts) {
        return EXIT_DONE;
    }
    char *text = strdup(settings->contacts);
    if (!text) {
        print_error_line("not enough memory");
        return EXIT_DATA;
    }
    bool whole = parse(out, text);
    free(text);
    return whole
               ? EXIT_DONE
               : print_usage_error("--contacts: \"%s\" is not COUNT,COLUMNS,PITCH,TIP: two whole numbers from 1 on and "
                                   "two lengths in mm",
                                   settings->contacts);
}
