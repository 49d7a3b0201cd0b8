/* SPDX-License-Identifier: BSD-3-Clause */
/* Which FSL atlas XML, in a volume's folder or the one above, names the volume. */
#include "base/buffer.h"
#include "base/file.h"
#include "base/memory.h"
#include "base/xml.h"
#include "loaders/folder.h"
#include "loaders/fsl_atlas.h"
#include "loaders/label_parse.h"

#include <limits.h>
#include <stdlib.h>
#include <string.h>

enum { XML_LIMIT = 4 << 20 };

struct finding {
    enum fsl_use use;
    struct fsl_atlas atlas;
    char *path; /* of the XML, once it is found */
    struct notes *notes;
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

/* `relative`: of the volume, to the XML's folder and without ending. */
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

/* Takes the atlas over if it is the one. */
static conus_status consider(struct finding *finding, struct fsl_atlas *atlas, struct notes *notes, const char *path,
                             const char *relative)
{
    if (!names_volume(atlas, finding->use, relative)) {
        return CONUS_OK;
    }
    conus_status status = label_table_sort(&atlas->labels, notes);
    status = status ? status : notes_move(finding->notes, notes);
    finding->path = status ? NULL : memory_text(path, strlen(path));
    if (!finding->path) {
        return CONUS_ERROR_MEMORY;
    }
    finding->atlas = *atlas;
    *atlas = (struct fsl_atlas){0};
    return CONUS_OK;
}

/* XMLs of any kind may lie there: what is no atlas, or damaged, or out of reach speaks of another image. */
static conus_status try_xml(struct finding *finding, const char *path, const char *relative)
{
    struct bytes bytes = {0};
    struct fsl_atlas atlas = {0};
    struct notes notes = {0};
    conus_status status = CONUS_OK;
    if (file_exists(path) && !file_read(&bytes, path, XML_LIMIT)) {
        struct text text = label_text_of(bytes.data, bytes.size);
        status = text_equal(xml_root(text), "atlas") ? fsl_atlas_parse(&atlas, text, &notes) : CONUS_OK;
        status = status == CONUS_ERROR_MEMORY ? status : CONUS_OK;
        status = status ? status : consider(finding, &atlas, &notes, path, relative);
    }
    fsl_atlas_finish(&atlas);
    notes_finish(&notes);
    bytes_finish(&bytes);
    return status;
}

static conus_status search_in(struct finding *finding, const char *folder, const char *relative)
{
    struct names names = {0};
    conus_status status = names_list(&names, folder, ".xml");
    for (size_t i = 0; !status && !finding->path && i < names.count; i++) {
        char *path = file_beside(folder, names.names[i]);
        status = path ? try_xml(finding, path, relative) : CONUS_ERROR_MEMORY;
        memory_free(path);
    }
    names_finish(&names);
    return status;
}

/* In the folder above, where the volume is "folder/name". */
static conus_status search_above(struct finding *finding, const char *folder, const char *relative)
{
    char real[PATH_MAX];
    struct buffer above = {0};
    struct buffer below = {0};
    if (!realpath(folder, real)) {
        return CONUS_OK;
    }
    buffer_format(&above, "%s../", folder);
    buffer_format(&below, "%s/%s", path_base(real), relative);
    conus_status status = buffer_status(&above);
    status = status ? status : buffer_status(&below);
    status = status ? status : search_in(finding, above.data, below.data);
    buffer_finish(&above);
    buffer_finish(&below);
    return status;
}

conus_status fsl_atlas_find(struct fsl_atlas *out, char **path, const char *volume_path, enum fsl_use use,
                            struct notes *notes)
{
    struct finding finding = {.use = use, .notes = notes};
    const char *base = path_base(volume_path);
    char *name = memory_text(base, volume_stem_length(base));
    char *folder = path_folder(volume_path);
    conus_status status = name && folder ? search_in(&finding, folder, name) : CONUS_ERROR_MEMORY;
    if (!status && !finding.path) {
        status = search_above(&finding, folder, name);
    }
    memory_free(name);
    memory_free(folder);
    if (!status) {
        *out = finding.atlas;
        *path = finding.path;
    }
    return status;
}
