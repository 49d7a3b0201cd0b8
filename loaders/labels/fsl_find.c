/* SPDX-License-Identifier: BSD-3-Clause */
/* Which atlas XML, in a volume's folder or the one above, names the volume. */
#include "loaders/labels/fsl_find.h"

#include "base/buffer.h"
#include "base/files/file.h"
#include "base/files/file_trace.h"
#include "base/files/folder.h"
#include "base/formats/xml.h"
#include "base/memory.h"

#include <limits.h>
#include <stdlib.h>
#include <string.h>

struct search {
    enum fsl_use use;
    fsl_visit visit;
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
static conus_status is_beside(bool *out, const struct fsl_atlas *atlas, const char *path, const char *relative)
{
    const char *name = path_base(path);
    size_t length = strlen(name) - strlen(".xml");
    conus_status status = CONUS_OK;
    *out = atlas->is_spm && strlen(relative) == length && strncmp(name, relative, length) == 0;
    for (size_t i = 0; !status && *out && i < atlas->image_count; i++) {
        char *found = NULL;
        const char *image = atlas->images[i].image;
        status = image ? fsl_image_find(&found, path, image) : CONUS_OK;
        *out = !found;
        memory_free(found);
    }
    return status;
}

/* Visits the XML if it names the volume. XMLs of any kind may lie there: one that is no atlas, damaged or out of reach
 * is passed over. */
static conus_status try_xml(const struct search *search, const char *path, const char *relative)
{
    struct bytes bytes = {0};
    struct fsl_atlas atlas = {0};
    conus_status status = CONUS_OK;
    if (file_exists(path) && !file_read(&bytes, path, FSL_ATLAS_LIMIT)) {
        struct text text = text_from_bytes(bytes.data, bytes.size);
        status = text_equal(xml_root(text), "atlas") ? fsl_atlas_parse(&atlas, text) : CONUS_OK;
        status = status == CONUS_ERROR_MEMORY ? status : CONUS_OK;
        bool named = !status && names_volume(&atlas, search->use, relative);
        bool beside = false;
        if (!status && !named && search->use == FSL_LABELS) {
            status = is_beside(&beside, &atlas, path, relative);
        }
        if (!status && (named || beside)) {
            status = search->visit(search->user, &atlas, path, &bytes);
        }
    }
    fsl_atlas_finish(&atlas);
    bytes_finish(&bytes);
    return status;
}

/* Whether the volume's name begins with that of the XML: X.xml of X-2mm. */
static bool begins_with_name(const char *xml, const char *relative)
{
    return strncmp(xml, path_base(relative), strlen(xml) - strlen(".xml")) == 0;
}

/* Tries the XMLs in the folder, those first that are called as the volume. */
static conus_status search_in(const struct search *search, const char *folder, const char *relative)
{
    struct names names = {0};
    conus_status status = names_list(&names, folder, ".xml");
    for (size_t i = 0; !status && i < 2 * names.count; i++) {
        const char *name = names.names[i % names.count];
        bool now = begins_with_name(name, relative) == (i < names.count);
        char *path = file_beside(folder, name);
        status = !path ? CONUS_ERROR_MEMORY : now ? try_xml(search, path, relative) : CONUS_OK;
        memory_free(path);
    }
    names_finish(&names);
    return status;
}

/* Tries those in the folder above, where the volume is "folder/name". */
static conus_status search_above(const struct search *search, const char *folder, const char *relative)
{
    char real[PATH_MAX];
    struct buffer above = {0};
    struct buffer below = {0};
    if (!file_trace_real_path(real, folder)) {
        return CONUS_OK;
    }
    buffer_format(&above, "%s../", folder);
    buffer_format(&below, "%s/%s", path_base(real), relative);
    conus_status status = buffer_status(&above);
    status = status ? status : buffer_status(&below);
    status = status ? status : search_in(search, above.data, below.data);
    buffer_finish(&above);
    buffer_finish(&below);
    return status;
}

conus_status fsl_atlas_each(const char *volume_path, enum fsl_use use, fsl_visit visit, void *user)
{
    const struct search search = {use, visit, user};
    const char *base = path_base(volume_path);
    char *name = memory_text(base, volume_stem_length(base));
    char *folder = path_folder(volume_path);
    bool before = file_trace_search(true);
    conus_status status = name && folder ? search_in(&search, folder, name) : CONUS_ERROR_MEMORY;
    status = status ? status : search_above(&search, folder, name);
    file_trace_search(before);
    memory_free(name);
    memory_free(folder);
    return status;
}

conus_status fsl_image_find(char **out, const char *xml_path, const char *image)
{
    static const char *const endings[] = {"", ".nii.gz", ".nii", ".hdr", ".hdr.gz", ".mgz"};
    char *path = file_beside(xml_path, image + strspn(image, "/"));
    conus_status status = path ? CONUS_OK : CONUS_ERROR_MEMORY;
    for (size_t i = 0; !status && i < sizeof endings / sizeof endings[0]; i++) {
        struct buffer candidate = {0};
        buffer_format(&candidate, "%s%s", path, endings[i]);
        status = buffer_status(&candidate);
        if (!status && file_exists(candidate.data)) {
            *out = candidate.data;
            break;
        }
        buffer_finish(&candidate);
    }
    memory_free(path);
    return status;
}
