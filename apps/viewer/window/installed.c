/* SPDX-License-Identifier: BSD-3-Clause */
/* Searches the catalogue by what is typed. */
#include "viewer/window/installed.h"

#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>

static const char gaps[] = "-_.+ :";

static bool is_gap(char c)
{
    return c && strchr(gaps, c);
}

static bool has_word(const char *name, const char *word, size_t length)
{
    for (; *name; name++) {
        if (strncasecmp(name, word, length) == 0) {
            return true;
        }
    }
    return false;
}

bool installed_fits(const conus_installed *atlas, const char *text)
{
    bool fits = true;
    for (const char *word = text; *word && fits;) {
        size_t length = strcspn(word, gaps);
        fits = has_word(atlas->name, word, length) || strncasecmp(atlas->source, word, length) == 0;
        word += length;
        while (is_gap(*word)) {
            word++;
        }
    }
    return fits;
}

static const char *name_of(const char *path)
{
    const char *slash = strrchr(path, '/');
    return slash ? slash + 1 : path;
}

bool installed_is_same_file(const char *a, const char *b)
{
    struct stat infos[2];
    return strcmp(a, b) == 0 || (strcmp(name_of(a), name_of(b)) == 0 && stat(a, &infos[0]) == 0 &&
                                 stat(b, &infos[1]) == 0 && infos[0].st_size == infos[1].st_size);
}

bool installed_is_twin(const conus_catalogue *catalogue, size_t index)
{
    const conus_installed *atlas = conus_catalogue_atlas(catalogue, index);
    bool is = false;
    for (size_t i = 0; i < index && !is; i++) {
        const conus_installed *other = conus_catalogue_atlas(catalogue, i);
        is = strcmp(other->name, atlas->name) == 0 && strcmp(other->kind, atlas->kind) == 0 &&
             installed_is_same_file(other->path, atlas->path);
    }
    return is;
}

/* Whether `words` means this one and no other. */
static bool means(const conus_catalogue *catalogue, const char *words, const conus_installed *atlas)
{
    const conus_installed *found = NULL;
    return !conus_atlas_is_path(words) && !conus_catalogue_find(&found, catalogue, words) && found == atlas;
}

size_t installed_best(const conus_catalogue *catalogue, const char *text)
{
    size_t count = conus_catalogue_count(catalogue);
    const conus_installed *named = NULL;
    size_t best = count;
    if (text[0] && conus_catalogue_find(&named, catalogue, text)) {
        named = NULL;
    }
    for (size_t i = count; i-- > 0;) {
        const conus_installed *atlas = conus_catalogue_atlas(catalogue, i);
        if (named ? atlas == named : installed_fits(atlas, text)) {
            best = i;
        }
    }
    return best;
}

size_t installed_next(const conus_catalogue *catalogue, const char *text, size_t index, int by)
{
    size_t count = conus_catalogue_count(catalogue);
    const size_t step = by > 0 ? 1 : SIZE_MAX; /* which is one back; before 0 is SIZE_MAX, too */
    for (size_t i = index + step; i < count; i += step) {
        if (installed_fits(conus_catalogue_atlas(catalogue, i), text) && !installed_is_twin(catalogue, i)) {
            return i;
        }
    }
    return index;
}

bool installed_words(char out[PATH_MAX], const conus_catalogue *catalogue, const conus_installed *atlas)
{
    int size = snprintf(out, PATH_MAX, "%s", atlas->name);
    if (!means(catalogue, out, atlas)) {
        size = snprintf(out, PATH_MAX, "%s:%s", atlas->source, atlas->name);
    }
    if (size >= PATH_MAX || !means(catalogue, out, atlas)) {
        size = snprintf(out, PATH_MAX, "%s", atlas->path);
    }
    return size < PATH_MAX;
}
