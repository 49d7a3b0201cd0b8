/* SPDX-License-Identifier: BSD-3-Clause */
/* Label tables in a volume's folder that do not bear its name: an inherited BIDS dseg.tsv, an FSL atlas XML that names
 * the volume, and the tables that BrainGlobe and FreeSurfer call by fixed names. */
#include "base/memory.h"
#include "loaders/fsl_atlas.h"
#include "loaders/label_parse.h"
#include "loaders/label_search.h"
#include "loaders/xml.h"

#include <dirent.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>

enum { NAME_LIMIT = 4096, XML_LIMIT = 4 << 20 };

/* File names of a folder with one ending, sorted, so that the answer does not hang on the file system. */
struct names {
    char **names;
    size_t count;
};

static void names_finish(struct names *names)
{
    for (size_t i = 0; i < names->count; i++) {
        memory_free(names->names[i]);
    }
    memory_free(names->names);
}

static int compare_names(const void *a, const void *b)
{
    return strcmp(*(char *const *)a, *(char *const *)b);
}

static bool ends_with(const char *name, const char *ending)
{
    size_t length = strlen(name);
    size_t tail = strlen(ending);
    return length >= tail && strcmp(name + length - tail, ending) == 0;
}

static conus_status add_name(struct names *names, const char *name)
{
    char **grown = memory_resize(names->names, names->count + 1, sizeof *grown);
    if (!grown) {
        return CONUS_ERROR_MEMORY;
    }
    names->names = grown;
    char *copy = memory_text(name, strlen(name));
    if (!copy) {
        return CONUS_ERROR_MEMORY;
    }
    grown[names->count++] = copy;
    return CONUS_OK;
}

static conus_status list_names(struct names *out, const char *folder, const char *ending)
{
    DIR *directory = opendir(folder);
    conus_status status = CONUS_OK;
    for (struct dirent *entry; directory && !status && out->count < NAME_LIMIT && (entry = readdir(directory));) {
        status = ends_with(entry->d_name, ending) ? add_name(out, entry->d_name) : CONUS_OK;
    }
    if (directory) {
        closedir(directory);
    }
    if (!status && out->count) {
        qsort(out->names, out->count, sizeof *out->names, compare_names);
    }
    return status;
}

static char *folder_of(const char *path)
{
    const char *slash = strrchr(path, '/');
    return slash ? memory_text(path, (size_t)(slash - path) + 1) : memory_text("./", 2);
}

/* Whether every entity ("res-01", "dseg") of the table's name is one of the volume's: then BIDS lets it inherit. */
static bool inherits(struct text table, struct text volume, size_t *entities)
{
    struct text entity;
    *entities = 0;
    for (bool more = true; text_field(&table, '_', &more, &entity); ++*entities) {
        struct text rest = volume;
        struct text other;
        bool found = false;
        for (bool left = true; !found && text_field(&rest, '_', &left, &other);) {
            found = other.size == entity.size && memcmp(other.data, entity.data, entity.size) == 0;
        }
        if (!found) {
            return false;
        }
    }
    return true;
}

static conus_status search_inherited(struct label_search *search, const char *folder)
{
    const char *path = path_base(search->volume->path);
    struct text volume = {path, volume_stem_length(path)};
    struct names names = {0};
    const char *best = NULL;
    size_t most = 0;
    conus_status status = list_names(&names, folder, "dseg.tsv");
    for (size_t i = 0; i < names.count; i++) {
        size_t entities;
        struct text table = {names.names[i], strlen(names.names[i]) - strlen(".tsv")};
        if (inherits(table, volume, &entities) && entities > most) {
            most = entities;
            best = names.names[i];
        }
    }
    char *found = !status && best ? file_beside(folder, best) : NULL;
    status = !status && best ? (found ? label_search_file(search, found) : CONUS_ERROR_MEMORY) : status;
    memory_free(found);
    names_finish(&names);
    return status;
}

static bool same_image(const char *written, const char *relative)
{
    if (!written) {
        return false;
    }
    written += strspn(written, "/");
    size_t length = volume_stem_length(written);
    return strlen(relative) == length && strncmp(written, relative, length) == 0;
}

/* Whether a labelled image of the atlas is the volume at `relative` (to the XML's folder, without ending). */
static bool names_volume(const struct fsl_atlas *atlas, const char *relative)
{
    for (size_t i = 0; i < atlas->image_count; i++) {
        const struct fsl_image *image = &atlas->images[i];
        if (same_image(image->summary, relative) || (atlas->is_label && same_image(image->image, relative))) {
            return true;
        }
    }
    return false;
}

/* XMLs of any kind may lie there: what is no atlas, or damaged, speaks of another image. */
static conus_status try_xml(struct label_search *search, const char *path, const char *relative)
{
    struct bytes bytes = {0};
    struct fsl_atlas atlas = {0};
    struct notes ignored = {0};
    if (search->found || !file_exists(path)) {
        return CONUS_OK;
    }
    conus_status status = file_read(&bytes, path, XML_LIMIT);
    struct text text = label_text_of(bytes.data, bytes.size);
    if (!status && text_equal(xml_root(text), "atlas")) {
        status = fsl_atlas_parse(&atlas, text, &ignored);
        if (!status && names_volume(&atlas, relative)) {
            status = label_search_bytes(search, path_base(path), false, text);
        }
    }
    fsl_atlas_finish(&atlas);
    notes_finish(&ignored);
    bytes_finish(&bytes);
    return search->found || (status == CONUS_ERROR_MEMORY && text.size) ? status : CONUS_OK;
}

static conus_status search_xml_in(struct label_search *search, const char *folder, const char *relative)
{
    struct names names = {0};
    conus_status status = list_names(&names, folder, ".xml");
    for (size_t i = 0; !status && i < names.count; i++) {
        char *path = file_beside(folder, names.names[i]);
        status = path ? try_xml(search, path, relative) : CONUS_ERROR_MEMORY;
        memory_free(path);
    }
    names_finish(&names);
    return status;
}

/* In the folder itself, where the volume is "name", and in its parent, where it is "folder/name". */
static conus_status search_fsl(struct label_search *search, const char *folder)
{
    char real[PATH_MAX];
    const char *name = path_base(search->volume->path);
    struct buffer relative = {0};
    buffer_append(&relative, name, volume_stem_length(name));
    conus_status status = buffer_status(&relative);
    status = status ? status : search_xml_in(search, folder, relative.data);
    if (!status && !search->found && realpath(folder, real)) {
        struct buffer parent = {0};
        struct buffer below = {0};
        buffer_format(&parent, "%s../", folder);
        buffer_format(&below, "%s/%s", path_base(real), relative.data);
        status = buffer_status(&parent);
        status = status ? status : buffer_status(&below);
        status = status ? status : search_xml_in(search, parent.data, below.data);
        buffer_finish(&parent);
        buffer_finish(&below);
    }
    buffer_finish(&relative);
    return status;
}

static conus_status search_fixed(struct label_search *search)
{
    static const char *const names[] = {"structures.json", "FreeSurferColorLUT.txt"};
    conus_status status = CONUS_OK;
    for (size_t i = 0; !status && !search->found && i < 2; i++) {
        char *path = file_beside(search->volume->path, names[i]);
        status = path ? label_search_file(search, path) : CONUS_ERROR_MEMORY;
        memory_free(path);
    }
    return status;
}

conus_status label_search_folder(struct label_search *search)
{
    char *folder = folder_of(search->volume->path);
    conus_status status = folder ? CONUS_OK : CONUS_ERROR_MEMORY;
    status = status || search->found ? status : search_inherited(search, folder);
    status = status || search->found ? status : search_fsl(search, folder);
    status = status || search->found ? status : search_fixed(search);
    memory_free(folder);
    return status;
}
