/* SPDX-License-Identifier: BSD-3-Clause */
/* Finds the atlas, or the image, that a name means, and the names that were perhaps meant. */
#include "base/memory.h"
#include "base/path.h"
#include "base/system/system.h"
#include "conus/own.h"
#include "loaders/catalogue/catalogue.h"
#include "sources/names.h"

#include <errno.h>
#include <string.h>
#include <strings.h>

enum { CANDIDATES = 6, NEAR = 3 };

static bool is_there(const char *path)
{
    struct system_stat info;
    return system_stat(&info, path) || (errno != ENOENT && errno != ENOTDIR);
}

bool conus_atlas_is_path(const char *text)
{
    char *path = memory_text(text, keys_file_length(text, KEYS_ATLAS));
    const bool is = !path_is_name(text) || is_there(text) || (path && is_there(path));
    memory_free(path);
    return is;
}

/* Takes the next character that counts: folded, upper and lower case are the same, and what separates words does not;
 * a colon does. */
static char next_character(const char **at, bool folded)
{
    while (folded && **at && strchr("-_.+ ", **at)) {
        ++*at;
    }
    char c = **at;
    *at += c != '\0';
    return folded && c >= 'A' && c <= 'Z' ? (char)(c - 'A' + 'a') : c;
}

static bool same_text(const char *a, const char *b, bool folded)
{
    char c;
    do {
        c = next_character(&a, folded);
        if (c != next_character(&b, folded)) {
            return false;
        }
    } while (c);
    return true;
}

static bool is_called(const struct catalogue_item *item, const char *name, bool folded)
{
    size_t source = strlen(item->atlas.source);
    bool prefixed = strncasecmp(name, item->atlas.source, source) == 0 && name[source] == ':';
    for (int i = 0; i < 2; i++) {
        const char *own = i ? item->alias : item->atlas.name;
        if (own && (same_text(own, name, folded) || (prefixed && same_text(own, name + source + 1, folded)))) {
            return true;
        }
    }
    return false;
}

/* Whether both are one file with one table of labels, perhaps from two sources. */
static bool is_same_name(const struct catalogue_item *a, const struct catalogue_item *b)
{
    const char *one = a->atlas.labels ? a->atlas.labels : "";
    const char *other = b->atlas.labels ? b->atlas.labels : "";
    return a->id.device == b->id.device && a->id.inode == b->id.inode && strcmp(one, other) == 0;
}

/** Where a name is looked for, and the word for what is there: "atlas", "image". */
struct searched {
    const catalogue_items *items;
    const char *what, *plural;
    const char *hint;     /* how they are listed */
    const char *function; /* that looks */
};

/** The atlases that a name may mean. */
struct candidates {
    const struct catalogue_item *items[CANDIDATES];
    size_t count; /* may be more than there is room for */
};

static void find_candidates(struct candidates *out, const catalogue_items *items, const char *name, bool folded)
{
    for (size_t i = 0; i < items->count; i++) {
        const struct catalogue_item *item = &items->at[i];
        bool is = is_called(item, name, folded);
        for (size_t j = 0; is && j < out->count && j < CANDIDATES; j++) {
            is = !is_same_name(item, out->items[j]);
        }
        if (is && out->count < CANDIDATES) {
            out->items[out->count] = item;
        }
        out->count += is;
    }
}

static void refuse_ambiguous(struct job *job, const struct searched *searched, const char *name,
                             const struct candidates *candidates)
{
    const char *list = "";
    bool one_source = true;
    for (size_t i = 0; i < candidates->count && i < CANDIDATES; i++) {
        const conus_installed *atlas = &candidates->items[i]->atlas;
        one_source = one_source && strcmp(atlas->source, candidates->items[0]->atlas.source) == 0;
        list = job_format(job, "%s%s%s:%s (%s)", list, i ? ", " : "", atlas->source, atlas->name, atlas->path);
    }
    job_fail(job, CONUS_ERROR_ARGUMENT, "%s: %zu %s have that name: %s%s; give %s", name, candidates->count,
             searched->plural, list, candidates->count > CANDIDATES ? ", ..." : "",
             one_source ? "the path of one" : "one with its source, or a path");
}

/** Names that are near, the nearest first. */
struct near {
    const conus_installed *atlas;
    size_t distance;
};

/* Puts the atlas among the nearest; of equal names the first is kept. */
static void rank(struct near nearest[NEAR], const conus_installed *atlas, size_t far)
{
    for (size_t i = 0; i < NEAR; i++) {
        if (nearest[i].atlas && strcmp(nearest[i].atlas->name, atlas->name) == 0) {
            return;
        }
        if (!nearest[i].atlas || far < nearest[i].distance) {
            memmove(nearest + i + 1, nearest + i, (NEAR - 1 - i) * sizeof nearest[0]);
            nearest[i] = (struct near){atlas, far};
            return;
        }
    }
}

static void refuse_unknown(struct job *job, const struct searched *searched, const char *name)
{
    struct near nearest[NEAR] = {0};
    const char *list = "";
    size_t most = (strlen(name) + 2) / 3;
    const char *colon = strchr(name, ':');
    const struct text wanted = text_from(colon ? colon + 1 : name);
    struct text rest = wanted;
    struct text part;
    const char *joined = ""; /* "harvard-oxford" as one word */
    for (bool more = true; text_field(&rest, '-', &more, &part);) {
        joined = job_format(job, "%s%.*s", joined, (int)part.size, part.data);
    }
    for (size_t i = 0; i < searched->items->count; i++) {
        const conus_installed *atlas = &searched->items->at[i].atlas;
        struct text own = text_from(atlas->name);
        bool contains = (wanted.size >= 3 && text_contains(own, text_from(joined))) || /* then it is near */
                        (own.size >= 3 && text_contains(wanted, own));
        size_t far = contains ? 1 : text_distance(wanted, own);
        if (far <= most) {
            rank(nearest, atlas, far);
        }
    }
    for (size_t i = 0; i < NEAR && nearest[i].atlas; i++) {
        list = job_format(job, "%s%s%s", list, i ? " or " : "; did you mean ", nearest[i].atlas->name);
    }
    job_fail(job, CONUS_ERROR_IO, "%s: cannot open: No such file or directory, and no installed %s has that name%s%s%s",
             name, searched->what, searched->hint, list, nearest[0].atlas ? "?" : "");
}

static conus_status find_item(const conus_installed **out, const struct searched *searched, const char *name)
{
    struct candidates candidates = {0};
    struct job job = {0};
    if (!out || !searched->items || !name) {
        return fail(CONUS_ERROR_ARGUMENT, "%s: a result, a catalogue and a name are needed", searched->function);
    }
    find_candidates(&candidates, searched->items, name, false);
    if (!candidates.count) {
        find_candidates(&candidates, searched->items, name, true);
    }
    if (candidates.count == 1) {
        *out = &candidates.items[0]->atlas;
    } else if (candidates.count) {
        refuse_ambiguous(&job, searched, name, &candidates);
    } else {
        refuse_unknown(&job, searched, name);
    }
    return job_close(&job, NULL, NULL);
}

conus_status conus_catalogue_find(const conus_installed **out, const conus_catalogue *catalogue, const char *name)
{
    const struct searched atlases = {catalogue ? &catalogue->items : NULL, "atlas", "atlases",
                                     " ('conus atlases' lists them)", "conus_catalogue_find"};
    return find_item(out, &atlases, name);
}

conus_status conus_catalogue_find_image(const conus_installed **out, const conus_catalogue *catalogue, const char *name)
{
    const struct searched images = {catalogue ? &catalogue->images : NULL, "image", "images", "",
                                    "conus_catalogue_find_image"};
    return find_item(out, &images, name);
}
