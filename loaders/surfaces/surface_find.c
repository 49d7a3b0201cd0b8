/* SPDX-License-Identifier: BSD-3-Clause */
/* Looks for the surface of a structure by what GIFTI files say about themselves. */
#include "loaders/surfaces/surfaces.h"

#include "base/files/file.h"
#include "base/formats/xml.h"
#include "loaders/surfaces/parts.h"
#include "sources/source.h"

#include <string.h>

/* Reading the surface gives the notes again. */
static const struct gifti *read_outline(struct job *job, struct text document)
{
    struct attempt silent = job_try(job);
    const struct gifti *gifti = gifti_outline(job, document);
    (void)attempt_end(job, &silent, ATTEMPT_SILENT);
    return gifti;
}

struct surface_about surface_about_of(struct job *job, const char *path)
{
    struct surface_about about = {0};
    const size_t place = job_in(job, path, JOB_ALONE);
    struct source *source = source_open(job, path);
    const bool may_be = source && (text_equal(source->head.root, "GIFTI") || !source->head.bytes.size);
    const struct bytes bytes = may_be ? source_whole(job, source) : (struct bytes){0};
    const struct text document = text_from_bytes(bytes.data, bytes.size);
    const struct gifti *gifti = text_equal(xml_root(document), "GIFTI") ? read_outline(job, document) : NULL;
    if (gifti) {
        about = (struct surface_about){
            .structure = gifti->structure, .layer = gifti->layer, .geometric_type = gifti->geometric_type};
        for (size_t i = gifti->arrays.count; i-- > 0;) {
            const struct gifti_array *array = &gifti->arrays.at[i];
            about.vertices = array->intent == GIFTI_POINTSET ? array->dim[0] : about.vertices;
        }
    }
    source_close(source); /* the document is large */
    job_out(job, place);
    return about;
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

static void add_surface(struct job *job, struct surface_list *list, const char *folder, const char *name)
{
    struct attempt attempt = job_try(job);
    const struct surface_about about = surface_about_of(job, job_beside(job, folder, name));
    (void)attempt_end(job, &attempt, ATTEMPT_DROP);
    if (about.vertices) {
        *LIST_ADD(job, &list->items) = (struct surface_item){
            .name = job_copy(job, text_from(name)), .about = about, .rank = rank_of(name, &about)};
    }
}

struct surface_list surface_list_make(struct job *job, const char *folder)
{
    static const char *const endings[] = {".surf.gii", ".surf.gii.gz", ".gii", ".gii.gz"};
    struct surface_list list = {0};
    bool before = inputs_search(true);
    for (size_t i = 0; i < 4 && !(i == 2 && list.items.count); i++) {
        const struct names names = job_names(job, folder, endings[i]);
        for (size_t k = 0; k < names.count && job_ok(job); k++) {
            add_surface(job, &list, folder, names.names[k]);
        }
    }
    inputs_search(before);
    return list;
}

static void fail_missing(struct job *job, const struct surface_list *list, const char *structure, size_t vertices)
{
    enum { SHOWN = 4 };
    const char *there = ""; /* "a.surf.gii (CortexLeft, 642 vertices, pial)", of the first */
    for (size_t i = 0; i < list->items.count && i < SHOWN; i++) {
        const struct surface_item *item = &list->items.at[i];
        there = job_format(job, "%s%s%s (%s, %zu vertices, %s)", there, i ? ", " : "", item->name,
                           item->about.structure ? item->about.structure : "of no structure", item->about.vertices,
                           kinds[item->rank].kind);
    }
    job_bad(job,
            "no surface of %s with %zu vertices beside it: looked for is *.surf.gii or *.gii with "
            "AnatomicalStructurePrimary %s that is not inflated, a sphere or flat; there is %s%s",
            structure, vertices, structure, there,
            !list->items.count          ? "no surface"
            : list->items.count > SHOWN ? ", ..."
                                        : "");
}

const struct surface_item *surface_list_find(struct job *job, const char **kind, const struct surface_list *list,
                                             const char *structure, size_t vertices)
{
    const struct surface_item *best = NULL;
    const struct surface_item *other = NULL; /* as good */
    *kind = "";
    for (size_t i = 0; i < list->items.count; i++) {
        const struct surface_item *item = &list->items.at[i];
        const struct surface_about *about = &item->about;
        bool fits = about->structure && strcmp(about->structure, structure) == 0 && about->vertices == vertices;
        if (!fits || item->rank == UNFIT || (best && item->rank > best->rank)) {
            continue;
        }
        other = best && item->rank == best->rank ? item : NULL;
        best = other ? best : item;
    }
    if (!best) {
        fail_missing(job, list, structure, vertices);
        return NULL;
    }
    *kind = kinds[best->rank].kind;
    if (other) {
        job_bad(job,
                "surfaces of %s: %s and %s are both %s and have %zu vertices; a manifest can say which (\"file\" with "
                "\"vertex_labels\")",
                structure, best->name, other->name, *kind, vertices);
    }
    return job_ok(job) ? best : NULL;
}
