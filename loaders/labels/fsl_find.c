/* SPDX-License-Identifier: BSD-3-Clause */
/* Which atlas XML, in a volume's folder or the one above, names the volume. */
#include "loaders/labels/labels.h"

#include "base/files/file.h"
#include "base/formats/xml.h"
#include "base/path.h"
#include "base/system/system.h"
#include "sources/names.h"

#include <string.h>

struct search {
    enum fsl_use use;
    fsl_visit *visit;
    void *user;
};

static bool same_image(const char *written, const char *relative)
{
    if (!written) {
        return false;
    }
    written += strspn(written, "/");
    size_t length = volume_stem_length(written);
    return strlen(relative) == length && strncmp(written, relative, length) == 0;
}

/* Whether the atlas names the volume; `relative` is its path from the XML's folder, without ending. */
static bool names_volume(const struct fsl_atlas *atlas, enum fsl_use use, const char *relative)
{
    for (size_t i = 0; i < atlas->image_count; i++) {
        const struct fsl_image *image = &atlas->images[i];
        bool labels = same_image(image->summary, relative) || (atlas->is_label && same_image(image->image, relative));
        bool volumes = !atlas->is_label && same_image(image->image, relative);
        if (use == FSL_LABELS ? labels : volumes) {
            return true;
        }
    }
    return false;
}

/* Whether SPM's XML is called as the volume is, and names no image that is there: it would be that image's. */
static bool is_beside(struct job *job, const struct fsl_atlas *atlas, const char *path, const char *relative)
{
    const char *name = path_base(path);
    size_t length = strlen(name) - strlen(".xml");
    bool beside = atlas->is_spm && strlen(relative) == length && strncmp(name, relative, length) == 0;
    for (size_t i = 0; beside && i < atlas->image_count; i++) {
        const char *image = atlas->images[i].image;
        beside = !image || !fsl_image_find(job, path, image);
    }
    return beside;
}

/* Visits the XML if it names the volume. XMLs of any kind may lie there: one that is no atlas, damaged or out of reach
 * is passed over. */
static void try_xml(struct job *job, const struct search *search, const char *path, const char *relative)
{
    if (!job_has_file(job, path)) {
        return;
    }
    struct notes outside = label_notes_swap(job, (struct notes){0}); /* those of another volume's are dropped */
    struct attempt attempt = job_try(job);
    struct bytes bytes = job_read(job, path, FSL_ATLAS_LIMIT, "");
    struct text text = text_from_bytes(bytes.data, bytes.size);
    struct fsl_atlas *atlas = text_equal(xml_root(text), "atlas") ? fsl_atlas_parse(job, text) : NULL;
    bool is_atlas = !attempt_end(job, &attempt, ATTEMPT_TRY) && atlas;
    struct notes found = label_notes_swap(job, outside);
    if (is_atlas && (names_volume(atlas, search->use, relative) ||
                     (search->use == FSL_LABELS && is_beside(job, atlas, path, relative)))) {
        (void)JOB_CALL(job, notes_move_in(&job->notes, &found, path_base(path)));
        search->visit(job, search->user, atlas, path, &bytes);
    }
    notes_finish(&found);
}

/* Whether the volume's name begins with that of the XML: X.xml of X-2mm. */
static bool begins_with_name(const char *xml, const char *relative)
{
    return strncmp(xml, path_base(relative), strlen(xml) - strlen(".xml")) == 0;
}

/* Tries the XMLs in the folder, those first that are called as the volume. */
static void search_in(struct job *job, const struct search *search, const char *folder, const char *relative)
{
    const struct names names = job_names(job, folder, ".xml");
    for (int pass = 0; pass < 2; pass++) {
        for (size_t i = 0; i < names.count; i++) {
            if (begins_with_name(names.names[i], relative) == (pass == 0)) {
                try_xml(job, search, job_beside(job, folder, names.names[i]), relative);
            }
        }
    }
}

void fsl_atlas_each(struct job *job, const char *volume_path, enum fsl_use use, fsl_visit *visit, void *user)
{
    char real[SYSTEM_PATH];
    const struct search search = {use, visit, user};
    const char *base = path_base(volume_path);
    const char *name = job_copy(job, (struct text){base, volume_stem_length(base)});
    const char *folder = !path_is_name(volume_path) ? job_beside(job, volume_path, "") : "./";
    bool before = inputs_search(true);
    search_in(job, &search, folder, name);
    if (job_ok(job) && system_real_path(real, folder)) { /* in the folder above the volume is "folder/name" */
        search_in(job, &search, job_format(job, "%s../", folder), job_format(job, "%s/%s", path_base(real), name));
    }
    inputs_search(before);
}

char *fsl_image_find(struct job *job, const char *xml_path, const char *image)
{
    char *path = job_beside(job, xml_path, image + strspn(image, "/"));
    if (job_has_file(job, path)) {
        return path;
    }
    for (const char *ending = NULL; (ending = ending_next(ending, ROLE_VOLUME));) {
        char *packed = job_format(job, "%s%s.gz", path, ending);
        char *plain = job_format(job, "%s%s", path, ending);
        if (job_has_file(job, packed) || job_has_file(job, plain)) {
            return job_has_file(job, packed) ? packed : plain;
        }
    }
    return NULL;
}
