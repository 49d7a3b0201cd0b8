/* SPDX-License-Identifier: BSD-3-Clause */
/* Opacities by the names of areas, and transfer functions by those of pathways. */
#include "cli/pictures/translucent.h"

#include "options/messages.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define FIELD(member) offsetof(struct translucent_settings, member)

const struct option translucent_options[] = {
    {.name = "opacity",
     .type = OPTION_LIST,
     .offset = FIELD(opacity),
     .value = "[AREA=]A",
     .help =
         "opacity, 0 to 1, of the surface of an area, by name, abbreviation or label, with all below it in the area "
         "tree; without AREA of all that the cone does not hit; may be repeated"},
    {.name = "pathway-transfer",
     .type = OPTION_LIST,
     .offset = FIELD(pathways),
     .value = "[PATHWAY=]NAME|FILE",
     .help =
         "draw pathways, or this one, as haze, by colours and opacities of their values: own (their colour), a preset "
         "of --transfer or a file; may be repeated"},
    {0},
};

static int print_no_memory(void)
{
    print_error_line("not enough memory");
    return EXIT_DATA;
}

/* Splits `text` behind its last "=": the name is allocated, NULL where there is none. False without memory. */
static bool split(char **name, const char **value, const char *text)
{
    const char *equals = strrchr(text, '=');
    *value = equals ? equals + 1 : text;
    *name = equals ? strndup(text, (size_t)(equals - text)) : NULL;
    return !equals || *name;
}

static bool parse_opacity(double *out, const char *text)
{
    char *end = NULL;
    *out = strtod(text, &end);
    return end != text && *end == '\0' && *out >= 0 && *out <= 1;
}

bool translucent_check(const struct translucent_settings *settings)
{
    for (size_t i = 0; i < settings->opacity.count; i++) {
        const char *text = settings->opacity.items[i];
        const char *equals = strrchr(text, '=');
        double opacity;
        if (!parse_opacity(&opacity, equals ? equals + 1 : text)) {
            print_error_line("--opacity: \"%s\"; wanted is AREA=A or A, A from 0 to 1", text);
            return false;
        }
        if (!equals && opacity == 0) {
            print_error_line(
                "--opacity: 0 of all that the cone does not hit, allowed is more than 0; --only names what "
                "is drawn");
            return false;
        }
    }
    return true;
}

static bool is_below(const conus_atlas *atlas, uint32_t number, uint32_t ancestor)
{
    while (number && number != ancestor) {
        number = conus_atlas_object(atlas, number)->parent;
    }
    return number == ancestor;
}

static int set_opacity(struct translucent *out, const conus_atlas *atlas, const char *name, double opacity)
{
    uint32_t found = 0;
    if (conus_atlas_find(&found, atlas, name)) {
        return print_usage_error("--opacity: %s", conus_message());
    }
    for (uint32_t number = 1; number <= conus_atlas_object_count(atlas); number++) {
        if (is_below(atlas, number, found)) {
            out->opacity[number] = opacity;
        }
    }
    return EXIT_DONE;
}

static int find_opacities(struct translucent *out, const conus_atlas *atlas, const struct option_list *texts)
{
    size_t count = conus_atlas_object_count(atlas) + 1;
    int code = EXIT_DONE;
    out->opacity = texts->count ? malloc(count * sizeof *out->opacity) : NULL;
    for (size_t n = 0; out->opacity && n < count; n++) {
        out->opacity[n] = NAN;
    }
    for (size_t i = 0; i < texts->count && !code; i++) {
        char *name = NULL;
        const char *value = NULL;
        double opacity = 0;
        bool done = out->opacity && split(&name, &value, texts->items[i]) && parse_opacity(&opacity, value);
        code = !done ? print_no_memory() : name ? set_opacity(out, atlas, name, opacity) : EXIT_DONE;
        out->pale = name ? out->pale : opacity;
        free(name);
    }
    return code;
}

static int find_pathway(conus_pathway_transfer *out, const conus_atlas *atlas, const char *text)
{
    char *name = NULL;
    const char *value = NULL;
    if (!split(&name, &value, text)) {
        return print_no_memory();
    }
    int code = EXIT_DONE;
    if (name && conus_atlas_find(&out->pathway, atlas, name)) {
        code = print_usage_error("--pathway-transfer: %s", conus_message());
    } else if (name && conus_atlas_object(atlas, out->pathway)->kind != CONUS_KIND_PATHWAY) {
        code = print_usage_error("--pathway-transfer: %s is no pathway", name);
    }
    out->transfer = value;
    free(name);
    return code;
}

/* An opacity of what has no surface would have no effect. */
static int check_both(const struct translucent *translucent)
{
    for (size_t i = 0; i < translucent->pathway_count; i++) {
        uint32_t pathway = translucent->pathways[i].pathway;
        if (pathway && translucent->opacity && !isnan(translucent->opacity[pathway])) {
            return print_usage_error("--opacity has no effect on a pathway that --pathway-transfer draws as haze");
        }
    }
    return EXIT_DONE;
}

int translucent_find(struct translucent *out, const conus_atlas *atlas, const struct translucent_settings *settings)
{
    const struct option_list *texts = &settings->pathways;
    *out = (struct translucent){0};
    int code = find_opacities(out, atlas, &settings->opacity);
    out->pathways = code ? NULL : calloc(texts->count + 1, sizeof *out->pathways);
    if (!code && !out->pathways) {
        return print_no_memory();
    }
    for (size_t i = 0; i < texts->count && !code; i++) {
        code = find_pathway(&out->pathways[i], atlas, texts->items[i]);
        out->pathway_count++;
    }
    return code ? code : check_both(out);
}

void translucent_finish(struct translucent *translucent)
{
    free(translucent->opacity);
    free(translucent->pathways);
    *translucent = (struct translucent){0};
}
