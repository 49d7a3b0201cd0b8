/* SPDX-License-Identifier: BSD-3-Clause */
/* Which surface of a .dlabel.nii another file shows. */
#include "loaders/surfaces/cifti_vertices.h"

#include "base/buffer.h"
#include "base/files/folder.h"
#include "base/memory.h"
#include "loaders/cifti/cifti_file.h"
#include "loaders/surfaces/surface_about.h"

/* "CortexLeft, CortexRight". */
static void list_surfaces(struct buffer *out, const struct cifti_choice *choice)
{
    for (size_t i = 0; i < choice->cifti.model_count; i++) {
        const struct cifti_model *model = &choice->cifti.models[i];
        if (model->is_surface) {
            buffer_format(out, "%s%s", out->size ? ", " : "", model->structure->name);
        }
    }
    buffer_text(out, out->size ? "" : "no surface");
}

/* The only surface of the file, or NULL. */
static const struct cifti_model *only_surface(const struct cifti_choice *choice)
{
    const struct cifti_model *found = NULL;
    for (size_t i = 0; i < choice->cifti.model_count; i++) {
        const struct cifti_model *model = &choice->cifti.models[i];
        if (model->is_surface && found) {
            return NULL;
        }
        found = model->is_surface ? model : found;
    }
    return found;
}

static conus_status fail_structure(const struct cifti_choice *choice, const char *structure, const char *surface)
{
    struct buffer list = {0};
    list_surfaces(&list, choice);
    conus_status status = buffer_status(&list);
    if (!status && structure) {
        status = fail(CONUS_ERROR_DATA, "labels of %s, which %s is, are not there: the file has those of %s", structure,
                      surface ? path_base(surface) : "the surface", list.data);
    } else if (!status) {
        status = fail(CONUS_ERROR_DATA,
                      "%s does not say which structure it is (AnatomicalStructurePrimary), and the file has labels of "
                      "%s: \"hemisphere\" in a manifest says which",
                      surface ? path_base(surface) : "the surface", list.data);
    }
    buffer_finish(&list);
    return status;
}

static conus_status take_model(struct vertex_labels *out, const struct cifti_choice *choice,
                               const struct surface_about *about, const struct mesh_file_options *options)
{
    const char *structure = about->structure             ? about->structure
                            : options->hemisphere == 'L' ? "CortexLeft"
                            : options->hemisphere == 'R' ? "CortexRight"
                                                         : NULL;
    const struct cifti_model *model = structure ? cifti_choice_surface(choice, structure) : only_surface(choice);
    if (!model) {
        return fail_structure(choice, structure, options->surface);
    }
    if (about->vertices && about->vertices != model->vertex_count) {
        return fail(CONUS_ERROR_DATA, "labels of %zu vertices of %s, %s has %zu: they must be as many",
                    model->vertex_count, model->structure->name, path_base(options->surface), about->vertices);
    }
    out->count = model->vertex_count;
    out->hemisphere = model->structure->side;
    return cifti_choice_vertices(&out->labels, &out->table, choice, model);
}

conus_status cifti_vertices_read(struct vertex_labels *out, const struct bytes *bytes, struct text map,
                                 const struct mesh_file_options *options, struct notes *notes)
{
    struct cifti_choice choice = {0};
    struct surface_about about = {0};
    uint64_t limit = options->max_memory ? options->max_memory : UINT64_C(8) << 30;
    conus_status status = cifti_choice_read(&choice, bytes, map, limit, notes);
    if (!status && options->surface) {
        status = surface_about_read(&about, options->surface, limit);
    }
    status = status ? status : take_model(out, &choice, &about, options);
    surface_about_finish(&about);
    cifti_choice_finish(&choice);
    return status;
}
