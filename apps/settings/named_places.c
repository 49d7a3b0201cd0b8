/* SPDX-License-Identifier: BSD-3-Clause */
/* Finds the points that options of places mean. */
#include "settings/settings.h"

#include "base/system/system.h"
#include "conus/own.h"
#include "options/messages.h"
#include "options/options.h"

#include <stdio.h>
#include <stdlib.h>

void named_places_finish(struct named_places *places)
{
    free(places->items);
    conus_scalp_destroy(places->scalp);
    *places = (struct named_places){0};
}

int named_places_add(struct named_places *places, const char *option, const char *text, const conus_place *place)
{
    conus_named_place *items = realloc(places->items, (places->count + 1) * sizeof *items);
    if (!items) {
        return print_no_memory();
    }
    places->items = items;
    items[places->count] = (conus_named_place){.option = option, .text = text, .is_sentence = !place};
    if (place) {
        items[places->count].place = *place;
    }
    places->count++;
    return EXIT_DONE;
}

int named_places_find(double out[3], struct named_places *places, const char *option, const char *text,
                      const double *other)
{
    const conus_place_options options = {
        .frame = places->frame, .other = other, .has_axis = places->has_axis, .scalp = places->scalp};
    conus_place place;
    conus_status status = conus_place_find(&place, places->atlas, text, &options);
    double plain[3];
    if (status == CONUS_ERROR_ARGUMENT && system_allows(text, 0)) {
        return print_usage_error("--%s: %s is a file; --pose %s asks about its points and poses", option, text, text);
    }
    if (status) {
        print_error_line("--%s: %s", option, conus_message());
        return exit_code_of(status);
    }
    for (int a = 0; a < 3; a++) {
        out[a] = place.point[a];
    }
    if (place.is_doubtful) {
        say_warning("--%s: \"%s\" is in MNI, and it is not known whether the atlas lies there; \',template=mni152\' "
                    "behind ATLAS says that it does",
                    option, text);
    }
    if (!place.is_also_named && numbers_parse(plain, 3, text, ',') == 3) {
        return EXIT_DONE;
    }
    return named_places_add(places, option, text, &place);
}

int named_places_find_ends(double origin[3], double toward[3], struct named_places *places,
                           const char *const options[2], const char *const texts[2])
{
    double ends[2][3];
    int last = conus_place_is_near(texts[0]); /* the one that may need the other */
    if (last == 1 && conus_place_is_near(texts[1])) {
        return print_usage_error("--%s and --%s: near: is nearest to the other end, which is no near: then", options[0],
                                 options[1]);
    }
    last = last == 1 ? 0 : 1;
    places->has_axis = true;
    int code = named_places_find(ends[1 - last], places, options[1 - last], texts[1 - last], NULL);
    code = code ? code : named_places_find(ends[last], places, options[last], texts[last], ends[1 - last]);
    for (int a = 0; a < 3 && !code; a++) {
        origin[a] = ends[0][a];
        toward[a] = ends[1][a];
    }
    return code;
}

void named_places_say(const struct named_places *places)
{
    for (size_t i = 0; i < places->count; i++) {
        const conus_named_place *item = &places->items[i];
        char text[CONUS_PLACE_TEXT] = "";
        if (!item->is_sentence) {
            conus_place_text(text, &item->place, places->frame);
        }
        say_note(CONUS_SEVERITY_NOTE, !*item->option, "%s %s", item->option, item->is_sentence ? item->text : text);
    }
}
