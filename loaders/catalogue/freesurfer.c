/* SPDX-License-Identifier: BSD-3-Clause */
/* Subjects of FreeSurfer: mri/aparc+aseg.mgz, label/lh.aparc.annot with surf/lh.pial. */
#include "loaders/catalogue/catalogue.h"

#include "base/buffer.h"
#include "base/files/file.h"
#include "base/memory.h"

#include <stdlib.h>
#include <string.h>

/** A subject, and FreeSurfer's label table. */
struct subject {
    conus_catalogue *catalogue;
    const char *name;
    char *folder;
    const char *table; /* NULL = there is none */
};

/* Whether `path` is a file that is not empty; *id identifies it. */
static bool is_file(struct catalogue_id *id, const char *path)
{
    struct stat info;
    bool is = path && stat(path, &info) == 0 && S_ISREG(info.st_mode) && info.st_size > 0;
    *id = is ? catalogue_id_of(&info) : (struct catalogue_id){0};
    return is;
}

/* Adds the file `path` as "subject.stem". */
static conus_status add_file(const struct subject *subject, const char *stem, size_t length,
                             struct catalogue_found *found)
{
    struct buffer name = {0};
    buffer_format(&name, "%s.%.*s", subject->name, (int)length, stem);
    found->name = name.data;
    conus_status status = buffer_status(&name);
    status = status ? status : catalogue_add(subject->catalogue, found);
    buffer_finish(&name);
    return status;
}

static conus_status look_at_volumes(const struct subject *subject)
{
    static const char *const stems[] = {"aparc+aseg", "aparc.a2009s+aseg", "aparc.DKTatlas+aseg", "aseg", "wmparc"};
    conus_status status = CONUS_OK;
    for (size_t i = 0; !status && i < sizeof stems / sizeof stems[0]; i++) {
        struct buffer path = {0};
        buffer_format(&path, "%s/mri/%s.mgz", subject->folder, stems[i]);
        status = buffer_status(&path);
        struct catalogue_found found = {.kind = "volume", .path = path.data, .labels = subject->table};
        if (!status && is_file(&found.id, path.data)) {
            status = add_file(subject, stems[i], strlen(stems[i]), &found);
        }
        buffer_finish(&path);
    }
    return status;
}

/* surf/lh.pial, or surf/lh.white; NULL in *out where neither is there. */
static conus_status find_surface(char **out, struct catalogue_id *id, const struct subject *subject, const char *side)
{
    static const char *const surfaces[] = {"pial", "white"};
    *out = NULL;
    for (size_t i = 0; !*out && i < 2; i++) {
        struct buffer path = {0};
        buffer_format(&path, "%s/surf/%.2s.%s", subject->folder, side, surfaces[i]);
        if (buffer_status(&path)) {
            buffer_finish(&path);
            return CONUS_ERROR_MEMORY;
        }
        *out = is_file(id, path.data) ? path.data : NULL;
        if (!*out) {
            buffer_finish(&path);
        }
    }
    return CONUS_OK;
}

/* Takes "lh.aparc.annot" and others in label/ that have a surface. */
static conus_status look_at_annotations(const struct subject *subject)
{
    static const char ending[] = ".annot";
    struct names names = {0};
    char *labels = catalogue_join(subject->folder, "label");
    conus_status status = labels ? catalogue_list(&names, subject->catalogue, labels) : CONUS_ERROR_MEMORY;
    for (size_t i = 0; !status && i < names.count; i++) {
        const char *name = names.names[i];
        bool sided = strncmp(name, "lh.", 3) == 0 || strncmp(name, "rh.", 3) == 0;
        if (!sided || !path_ends_in(name + 3, ending)) {
            continue;
        }
        struct catalogue_id own;
        struct catalogue_found found = {.kind = "surface"};
        char *surface = NULL;
        char *annotation = catalogue_join(labels, name);
        status = annotation ? find_surface(&surface, &found.id, subject, name) : CONUS_ERROR_MEMORY;
        found.path = surface;
        found.labels = annotation;
        if (!status && surface && is_file(&own, annotation)) {
            status = add_file(subject, name, strlen(name) - strlen(ending), &found);
        }
        memory_free(surface);
        memory_free(annotation);
    }
    names_finish(&names);
    memory_free(labels);
    return status;
}

conus_status freesurfer_look(conus_catalogue *catalogue, const char *folder)
{
    struct names names = {0};
    struct catalogue_id id;
    const char *home = getenv("FREESURFER_HOME");
    bool has_home = home && *home;
    char *table = has_home ? catalogue_join(home, "FreeSurferColorLUT.txt") : NULL;
    if (has_home && !table) {
        return CONUS_ERROR_MEMORY;
    }
    if (!is_file(&id, table)) {
        memory_free(table);
        table = NULL;
    }
    conus_status status = catalogue_list(&names, catalogue, folder);
    for (size_t i = 0; !status && i < names.count; i++) {
        struct subject subject = {.catalogue = catalogue, .name = names.names[i], .table = table};
        subject.folder = catalogue_join(folder, subject.name);
        status = subject.folder ? CONUS_OK : CONUS_ERROR_MEMORY;
        if (!status && file_is_folder(subject.folder)) {
            status = look_at_volumes(&subject);
            status = status ? status : look_at_annotations(&subject);
        }
        memory_free(subject.folder);
    }
    names_finish(&names);
    memory_free(table);
    return status;
}
