/* SPDX-License-Identifier: BSD-3-Clause */
/* Looks for the surface of a structure by what GIFTI files say about themselves. */
#include "loaders/surfaces/surface_find.h"

#include "base/buffer.h"
#include "base/files/file.h"
#include "base/files/folder.h"
#include "base/files/inputs.h"
#include "base/formats/gzip.h"
#include "base/formats/xml.h"
#include "base/memory.h"
#include "base/text.h"
#include "loaders/surfaces/gifti.h"

#include <string.h>

void surface_about_finish(struct surface_about *about)
{
    memory_free(about->structure);
    memory_free(about->layer);
    memory_free(about->geometric_type);
    *about = (struct surface_about){0};
}

conus_status surface_about_read(struct surface_about *out, const char *path, uint64_t max_memory)
{
    const struct gifti_options options = {.max_memory = max_memory, .outline = true};
    struct bytes bytes = {0};
    struct gifti gifti = {0};
    struct notes notes = {0}; /* said again by whoever reads the surface */
    conus_status status = gzip_read(&bytes, path, memory_limit(max_memory), NULL);
    *out = (struct surface_about){0};
    if (!status && text_equal(xml_root(text_from_bytes(bytes.data, bytes.size)), "GIFTI")) {
        status = gifti_parse(&gifti, bytes.data, bytes.size, &options, &notes);
        status = status ? fail_in(status, path) : CONUS_OK;
        *out = (struct surface_about){
            .structure = gifti.structure, .layer = gifti.layer, .geometric_type = gifti.geometric_type};
        gifti.structure = gifti.layer = gifti.geometric_type = NULL;
        for (size_t i = gifti.array_count; i-- > 0;) {
            out->vertices = gifti.arrays[i].intent == GIFTI_POINTSET ? gifti.arrays[i].dim[0] : out->vertices;
        }
    }
    gifti_finish(&gifti);
    notes_finish(&notes);
    bytes_finish(&bytes);
    return status;
}

/* In the order of their ranks: AnatomicalStructureSecondary, the word in a file's name, the words for it. */
static const struct {
    const char *layer, *word, *kind;
} kinds[] = {
    {"MidThickness", "midthickness", "midthickness"},
    {"Pial", "pial", "pial"},
    {"GrayWhite", "white", "white"},
    {NULL, "smoothwm", "smoothwm"},
    {NULL, NULL, "of no known kind"},
    {NULL, NULL, "not anatomical"}, /* never taken */
};
enum { OTHER = 4, UNFIT = 5 };

void surface_list_finish(struct surface_list *list)
{
    for (size_t i = 0; i < list->count; i++) {
        memory_free(list->items[i].name);
        surface_about_finish(&list->items[i].about);
    }
    memory_free(list->items);
    *list = (struct surface_list){0};
}

static bool name_has(const char *name, const char *word)
{
    return text_contains(text_from(name), text_from(word));
}

static unsigned rank_of(const char *name, const struct surface_about *about)
{
    /* vertices of inflated surfaces, spheres and patches lie where no brain is */
    static const char *const words[] = {"inflated", "sphere", "spherical", "flat", "ellipsoid", "hull"};
    const char *type = about->geometric_type;
    bool unfit = type && strcmp(type, "Anatomical") != 0 && strcmp(type, "Reconstruction") != 0;
    for (size_t i = 0; !type && i < sizeof words / sizeof words[0]; i++) {
        unfit = unfit || name_has(name, words[i]);
    }
    if (unfit) {
        return UNFIT;
    }
    for (unsigned i = 0; about->layer && i < OTHER; i++) {
        if (kinds[i].layer && strcmp(about->layer, kinds[i].layer) == 0) {
            return i;
        }
    }
    for (unsigned i = 0; i < OTHER; i++) {
        if (name_has(name, kinds[i].word)) {
            return i;
        }
    }
    return OTHER;
}

/* Adds `name` if it is a surface. */
static conus_status add_surface(struct surface_list *list, const char *folder, const char *name, uint64_t max_memory)
{
    struct surface_item item = {0};
    struct surface_item *items = NULL;
    char *path = file_beside(folder, name);
    conus_status status = path ? surface_about_read(&item.about, path, max_memory) : CONUS_ERROR_MEMORY;
    bool surface = !status && item.about.vertices;
    memory_free(path);
    if (surface) {
        items = memory_resize(list->items, list->count + 1, sizeof *items);
        list->items = items ? items : list->items;
        item.name = items ? memory_text(name, strlen(name)) : NULL;
        status = item.name ? CONUS_OK : CONUS_ERROR_MEMORY;
    }
    if (!surface || status) {
        surface_about_finish(&item.about);
        return status == CONUS_ERROR_MEMORY ? status : CONUS_OK;
    }
    item.rank = rank_of(name, &item.about);
    items[list->count++] = item;
    return CONUS_OK;
}

conus_status surface_list_make(struct surface_list *out, const char *folder, uint64_t max_memory)
{
    static const char *const endings[] = {".surf.gii", ".surf.gii.gz", ".gii", ".gii.gz"};
    struct surface_list list = {0};
    conus_status status = CONUS_OK;
    bool before = inputs_search(true);
    for (size_t i = 0; !status && i < 4 && !(i == 2 && list.count); i++) {
        struct names names = {0};
        status = names_list(&names, folder, endings[i]);
        for (size_t k = 0; !status && k < names.count; k++) {
            status = add_surface(&list, folder, names.names[k], max_memory);
        }
        names_finish(&names);
    }
    inputs_search(before);
    if (status) {
        surface_list_finish(&list);
        return status;
    }
    *out = list;
    return CONUS_OK;
}

static conus_status fail_missing(const struct surface_list *list, const char *structure, size_t vertices)
{
    enum { SHOWN = 4 };
    struct buffer there = {0}; /* "a.surf.gii (CortexLeft, 642 vertices, pial)", of the first */
    for (size_t i = 0; i < list->count && i < SHOWN; i++) {
        const struct surface_item *item = &list->items[i];
        buffer_format(&there, "%s%s (%s, %zu vertices, %s)", i ? ", " : "", item->name,
                      item->about.structure ? item->about.structure : "of no structure", item->about.vertices,
                      kinds[item->rank].kind);
    }
    buffer_text(&there, !list->count ? "no surface" : list->count > SHOWN ? ", ..." : "");
    conus_status status = buffer_status(&there);
    status = status ? status
                    : fail(CONUS_ERROR_DATA,
                           "no surface of %s with %zu vertices beside it: looked for is *.surf.gii or *.gii with "
                           "AnatomicalStructurePrimary %s that is not inflated, a sphere or flat; there is %s",
                           structure, vertices, structure, there.data);
    buffer_finish(&there);
    return status;
}

conus_status surface_list_find(const struct surface_item **out, const char **kind, const struct surface_list *list,
                               const char *structure, size_t vertices)
{
    const struct surface_item *best = NULL;
    const struct surface_item *other = NULL; /* as good */
    for (size_t i = 0; i < list->count; i++) {
        const struct surface_item *item = &list->items[i];
        const struct surface_about *about = &item->about;
        bool fits = about->structure && strcmp(about->structure, structure) == 0 && about->vertices == vertices;
        if (!fits || item->rank == UNFIT || (best && item->rank > best->rank)) {
            continue;
        }
        other = best && item->rank == best->rank ? item : NULL;
        best = other ? best : item;
    }
    if (!best) {
        return fail_missing(list, structure, vertices);
    }
    if (other) {
        return fail(CONUS_ERROR_DATA,
                    "surfaces of %s: %s and %s are both %s and have %zu vertices; a manifest can say which "
                    "(\"file\" with \"vertex_labels\")",
                    structure, best->name, other->name, kinds[best->rank].kind, vertices);
    }
    *out = best;
    *kind = kinds[best->rank].kind;
    return CONUS_OK;
}
