/* SPDX-License-Identifier: BSD-3-Clause */
/* Subjects of FreeSurfer: mri/aparc+aseg.mgz, label/lh.aparc.annot with surf/lh.pial. */
#include "loaders/catalogue/catalogue.h"

#include "base/files/file.h"
#include "base/system/system.h"
#include "conus/own.h"

#include <stdlib.h>
#include <string.h>

/** A subject, and FreeSurfer's label table. */
struct subject {
    conus_catalogue *catalogue;
    const char *name, *folder;
    const char *table; /* NULL = there is none */
};

/* Adds the file, if it is there, as "subject.stem". */
static void add_file(struct job *job, const struct subject *subject, const char *stem, size_t length,
                     struct catalogue_item *found)
{
    found->atlas.name = job_format(job, "%s.%.*s", subject->name, (int)length, stem);
    catalogue_add(job, subject->catalogue, found);
}

static void look_at_volumes(struct job *job, const struct subject *subject)
{
    static const char *const stems[] = {"aparc+aseg", "aparc.a2009s+aseg", "aparc.DKTatlas+aseg", "aseg", "wmparc"};
    for (size_t i = 0; i < sizeof stems / sizeof stems[0]; i++) {
        const char *path = job_format(job, "%s/mri/%s.mgz", subject->folder, stems[i]);
        struct catalogue_item found = {.atlas = {.kind = "volume", .path = path, .labels = subject->table}};
        add_file(job, subject, stems[i], strlen(stems[i]), &found);
    }
}

static bool find_surface(struct job *job, struct catalogue_item *found, const struct subject *subject, const char *side)
{
    static const char *const surfaces[] = {"pial", "white"};
    bool there = false;
    for (size_t i = 0; !there && i < 2; i++) {
        found->atlas.path = job_format(job, "%s/surf/%.2s.%s", subject->folder, side, surfaces[i]);
        there = catalogue_at(found->atlas.path) == CATALOGUE_FILE;
    }
    return there;
}

static void look_at_annotations(struct job *job, const struct subject *subject)
{
    static const char ending[] = ".annot";
    const char *labels = catalogue_join(job, subject->folder, "label");
    struct names names = catalogue_list(job, subject->catalogue, labels);
    for (size_t i = 0; i < names.count; i++) {
        const char *name = names.names[i];
        const char *annotation = catalogue_join(job, labels, name);
        struct catalogue_item found = {.atlas = {.kind = "surface", .labels = annotation}};
        bool sided = strncmp(name, "lh.", 3) == 0 || strncmp(name, "rh.", 3) == 0;
        if (sided && path_ends_in(name + 3, ending) && find_surface(job, &found, subject, name) &&
            catalogue_at(annotation) == CATALOGUE_FILE) {
            add_file(job, subject, name, strlen(name) - strlen(ending), &found);
        }
    }
}

void freesurfer_look(struct job *job, conus_catalogue *catalogue, const char *folder)
{
    const char *home = system_variable("FREESURFER_HOME");
    const char *table = home && *home ? catalogue_join(job, home, "FreeSurferColorLUT.txt") : "";
    bool has_table = catalogue_at(table) == CATALOGUE_FILE;
    struct names names = catalogue_list(job, catalogue, folder);
    for (size_t i = 0; i < names.count; i++) {
        const struct subject subject = {.catalogue = catalogue,
                                        .name = names.names[i],
                                        .folder = catalogue_join(job, folder, names.names[i]),
                                        .table = has_table ? table : NULL};
        if (file_is_folder(subject.folder)) {
            look_at_volumes(job, &subject);
            look_at_annotations(job, &subject);
        }
    }
}
