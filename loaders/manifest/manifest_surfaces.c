/* SPDX-License-Identifier: BSD-3-Clause */
/* Entries of a manifest for the surfaces in a folder. */
#include "loaders/manifest/manifest_surfaces.h"

#include "base/file.h"
#include "base/memory.h"
#include "loaders/manifest/manifest_scan.h"

#include <string.h>

static conus_status take_single(bool *taken, struct manifest_draft *draft, const char *folder, const char *name,
                                uint32_t label)
{
    struct buffer file = {0};
    buffer_format(&file, "%s%s", folder, name);
    conus_status status = buffer_status(&file);
    status = status
                 ? status
                 : manifest_draft_append_loading(taken, draft, draft->areas, "areas",
                                                 json_pack("{s:s,s:I}", "file", file.data, "label", (json_int_t)label));
    status = status || *taken ? status : manifest_draft_leave_out(draft, file.data);
    buffer_finish(&file);
    return status;
}

static conus_status take_pattern(bool *taken, struct manifest_draft *draft, const char *folder, const char *ending)
{
    struct buffer pattern = {0};
    buffer_format(&pattern, "%s*%s", folder, ending);
    conus_status status = buffer_status(&pattern);
    status = status ? status
                    : manifest_draft_append_loading(taken, draft, draft->areas, "areas",
                                                    json_pack("{s:s,s:I}", "files", pattern.data, "label_offset",
                                                              (json_int_t)draft->label_offset));
    buffer_finish(&pattern);
    return status;
}

/* Takes the surfaces of one ending in a folder as a pattern if their names give labels, else one by one. */
static conus_status take_surfaces(struct manifest_draft *draft, const char *folder, const char *ending,
                                  const struct names *names)
{
    bool all = false;
    size_t count = names->count;
    conus_status status = surface_names_give_labels(names) ? take_pattern(&all, draft, folder, ending) : CONUS_OK;
    if (!all) {
        count = 0;
        for (size_t i = 0; !status && i < names->count; i++) {
            bool taken = false;
            status = take_single(&taken, draft, folder, names->names[i], draft->label_offset + (uint32_t)i + 1);
            count += taken;
        }
    }
    if (status || !count) {
        return status;
    }
    draft->label_offset += MANIFEST_LABEL_STEP;
    return manifest_draft_log(draft, "%s*%s: %zu surfaces, labels above %u", folder, ending, count,
                              draft->label_offset - MANIFEST_LABEL_STEP);
}

/* `folder` is "" or a name with '/' at its end. */
static conus_status look_for_surfaces(struct manifest_draft *draft, const char *folder)
{
    static const char *const endings[] = {".surf.gii", ".gii", ".obj", ".ply", ".stl", ".vtk", ".vtp"};
    char *path = manifest_draft_path(draft, folder);
    conus_status status = path ? CONUS_OK : CONUS_ERROR_MEMORY;
    bool surf = false;
    for (size_t i = 0; !status && i < sizeof endings / sizeof endings[0]; i++) {
        struct names names = {0};
        bool skip = i == 1 && surf; /* what else is GIFTI there, is no surface */
        status = skip ? CONUS_OK : names_list(&names, path, endings[i]);
        if (!status && names.count) {
            surf = surf || i == 0;
            status = take_surfaces(draft, folder, endings[i], &names);
        }
        names_finish(&names);
    }
    memory_free(path);
    return status;
}

conus_status manifest_surfaces_add(struct manifest_draft *draft, const char *name)
{
    struct buffer folder = {0};
    struct buffer table = {0};
    struct buffer meshes = {0};
    buffer_format(&folder, "%s%s", name, name[0] ? "/" : "");
    buffer_format(&table, "%s%s%sstructures.json", draft->folder, name, name[0] ? "/" : "");
    buffer_format(&meshes, "%s%s%smeshes", draft->folder, name, name[0] ? "/" : "");
    conus_status status = buffer_status(&folder);
    status = status ? status : buffer_status(&table);
    status = status ? status : buffer_status(&meshes);
    if (!status && file_exists(table.data) && file_is_folder(meshes.data)) {
        status = manifest_draft_append(draft->areas, json_pack("{s:s}", "brainglobe", name[0] ? name : "."));
        status = status ? status : manifest_draft_log(draft, "%s: BrainGlobe folder", name[0] ? name : ".");
    } else if (!status) {
        status = look_for_surfaces(draft, folder.data ? folder.data : "");
    }
    buffer_finish(&meshes);
    buffer_finish(&table);
    buffer_finish(&folder);
    return status;
}

conus_status manifest_of_surfaces(struct buffer *out, const char *folder)
{
    static const conus_manifest_options silent;
    struct manifest_draft draft = {
        .folder = folder, .options = &silent, .areas = json_array(), .pathways = json_array()};
    conus_status status = draft.areas && draft.pathways ? manifest_surfaces_add(&draft, "") : CONUS_ERROR_MEMORY;
    if (!status && !json_array_size(draft.areas)) {
        status = fail(CONUS_ERROR_DATA,
                      "%.*s: no surfaces in this folder (or structures.json and meshes/, as BrainGlobe has them); for "
                      "volumes: conus manifest",
                      (int)strlen(folder) - 1, folder);
    }
    status = status ? status : manifest_draft_format(out, &draft);
    manifest_draft_finish(&draft);
    return status;
}
