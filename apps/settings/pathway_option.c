/* SPDX-License-Identifier: BSD-3-Clause */
/* Takes the option --pathway apart: FILE and keys behind commas. */
#include "settings/pathway_option.h"

#include "options/messages.h"
#include "options/options.h"

#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static bool read_threshold(struct pathway_option *pathway, const char *value)
{
    if (!number_parse(value, &pathway->threshold) || pathway->threshold <= 0) {
        print_error_line("--pathway: threshold=%s is not a number above 0", value);
        return false;
    }
    return true;
}

static bool read_volume(struct pathway_option *pathway, char *key, const char *value)
{
    uint64_t index;
    if (!count_parse(value, UINT32_MAX, &index)) {
        print_error_line("--pathway: volume=%s is not a whole number from 0", value);
        return false;
    }
    pathway->volume = key;
    return true;
}

static bool add_bands(struct pathway_option *pathway, const conus_band *bands, size_t count)
{
    conus_band *all = realloc(pathway->bands, (pathway->band_count + count) * sizeof *all);
    if (!all) {
        print_error_line("--pathway: not enough memory");
        return false;
    }
    memcpy(all + pathway->band_count, bands, count * sizeof *bands);
    pathway->bands = all;
    pathway->band_count += count;
    return true;
}

/* A number, or nothing for `open`. */
static bool read_end(double *out, const char *text, double open)
{
    *out = open;
    return !*text || number_parse(text, out);
}

/* "LOW:HIGH:NAME"; the name may have colons. */
static bool read_band(struct pathway_option *pathway, char *value)
{
    conus_band band = {0};
    char *high = strchr(value, ':');
    char *name = high ? strchr(high + 1, ':') : NULL;
    if (!name || !name[1]) {
        print_error_line("--pathway: band=%s is not LOW:HIGH:NAME", value);
        return false;
    }
    *high++ = '\0';
    *name++ = '\0';
    band.name = name;
    if (!read_end(&band.low, value, -INFINITY) || !read_end(&band.high, high, INFINITY)) {
        print_error_line("--pathway: band=%s:%s:%s: LOW and HIGH are numbers, or nothing", value, high, name);
        return false;
    }
    return add_bands(pathway, &band, 1);
}

/* Reads "key=value", the text after a comma. */
static bool read_key(struct pathway_option *pathway, char *key)
{
    char *value = strchr(key, '=') + 1;
    if (strncmp(key, "threshold=", 10) == 0 && pathway->threshold == 0) {
        return read_threshold(pathway, value);
    }
    if (strncmp(key, "name=", 5) == 0 && !pathway->name) {
        pathway->name = value;
        return *value || (print_error_line("--pathway: name= is empty"), false);
    }
    if (strncmp(key, "volume=", 7) == 0 && !pathway->volume) {
        return read_volume(pathway, key, value);
    }
    if (strncmp(key, "band=", 5) == 0) {
        return read_band(pathway, value);
    }
    print_error_line("--pathway: \"%s\" is none of threshold=T, name=S and volume=K, each at most once, and "
                     "band=LOW:HIGH:NAME",
                     key);
    return false;
}

static bool check_keys(const struct pathway_option *pathway)
{
    const char *other = pathway->threshold > 0 ? "threshold" : pathway->name ? "name" : NULL;
    if (pathway->band_count && other) {
        print_error_line("--pathway: band= and %s= exclude each other: a band has its own", other);
        return false;
    }
    return true;
}

/* Keys were read from the last to the first. */
static void turn_bands(struct pathway_option *pathway)
{
    for (size_t i = 0, count = pathway->band_count; i < count / 2; i++) {
        conus_band first = pathway->bands[i];
        pathway->bands[i] = pathway->bands[count - 1 - i];
        pathway->bands[count - 1 - i] = first;
    }
}

/* Cuts keys off the end as long as there are some, since a file's name may have commas as well. */
bool pathway_option_parse(struct pathway_option *out, const char *text)
{
    static const char *const names[] = {",threshold=", ",name=", ",volume=", ",band=", NULL};
    size_t size = strlen(text) + 1;
    *out = (struct pathway_option){.text = calloc(2, size), .given = text};
    if (!out->text) {
        print_error_line("--pathway: not enough memory");
        return false;
    }
    char *keys = memcpy(out->text, text, size);
    for (char *comma; (comma = strrchr(keys, ',')) && strchr(comma, '=');) {
        *comma = '\0';
        if (!read_key(out, comma + 1)) {
            return false;
        }
    }
    if (!*keys) {
        print_error_line("--pathway: \"%s\" names no file", text);
        return false;
    }
    if (key_left_in_file("--pathway", keys, names)) {
        return false;
    }
    out->path = out->text + size;
    snprintf(out->path, size, "%s%s%s", keys, out->volume ? "," : "", out->volume ? out->volume : "");
    turn_bands(out);
    return check_keys(out);
}

int pathway_option_join(struct pathway_option *option, const struct pathway_option *more)
{
    if (!option->band_count || !more->band_count || strcmp(option->path, more->path) != 0) {
        return 0;
    }
    return add_bands(option, more->bands, more->band_count) ? 1 : -1;
}

void pathway_option_finish(struct pathway_option *option)
{
    free(option->bands);
    free(option->text);
}
