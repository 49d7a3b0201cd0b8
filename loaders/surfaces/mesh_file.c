/* SPDX-License-Identifier: BSD-3-Clause */
/* Reads a surface, or labels of vertices, with the reader of its format. */
#include "loaders/surfaces/mesh_file.h"

#include "base/buffer.h"
#include "base/files/file.h"
#include "base/files/folder.h"
#include "base/formats/gzip.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "base/system/system.h"
#include "base/text.h"
#include "loaders/cifti/cifti.h"
#include "loaders/cifti/cifti_file.h"
#include "loaders/refuse.h"
#include "loaders/surfaces/foreign/mesh_foreign.h"
#include "loaders/surfaces/freesurfer_labels.h"
#include "loaders/surfaces/freesurfer_surface.h"
#include "loaders/surfaces/gifti.h"
#include "loaders/surfaces/surface_find.h"
#include "sources/map_choice.h"
#include "sources/source.h"

#include <stdio.h>
#include <string.h>
#include <strings.h>

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
    struct buffer list = {0}; /* "CortexLeft, CortexRight" */
    for (size_t i = 0; i < choice->cifti.model_count; i++) {
        const struct cifti_model *model = &choice->cifti.models[i];
        if (model->is_surface) {
            buffer_format(&list, "%s%s", list.size ? ", " : "", model->structure->name);
        }
    }
    buffer_text(&list, list.size ? "" : "no surface");
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

/* Takes from the .dlabel.nii `bytes` the labels of options->surface: those of the structure that it says it is, else
 * of the cortex on the side options->hemisphere, else of the only surface of the file. They must be of as many vertices
 * as a GIFTI surface has. `map` chooses a map. Errors do not name the file. */
static conus_status cifti_vertices_read(struct vertex_labels *out, const struct bytes *bytes, struct text map,
                                        const struct mesh_file_options *options, struct notes *notes)
{
    struct cifti_choice choice = {0};
    struct surface_about about = {0};
    uint64_t limit = memory_limit(options->max_memory);
    conus_status status = cifti_choice_read(&choice, bytes, map, limit, notes);
    if (!status && options->surface) {
        status = surface_about_read(&about, options->surface, limit);
    }
    status = status ? status : take_model(out, &choice, &about, options);
    surface_about_finish(&about);
    cifti_choice_finish(&choice);
    return status;
}

static const struct mesh_file_options defaults;

static bool is_own(enum format_id id)
{
    return id == FORMAT_GIFTI || id == FORMAT_FREESURFER;
}

bool mesh_format_is_foreign(const struct format *format)
{
    return format && !is_own(format->id);
}

bool mesh_format_keeps_vertices(const struct format *format)
{
    return format && format->id != FORMAT_STL && format->id != FORMAT_OTHER;
}

char *mesh_file_name(const char *path)
{
    const char *file = path_base(path);
    size_t length = format_stem_length(file, strlen(file), ROLE_SURFACE);
    length -= length > 5 && strncasecmp(file + length - 5, ".surf", 5) == 0 ? 5 : 0;
    return memory_text(file, length);
}

static conus_status parse_gifti(struct gifti *out, const struct bytes *bytes, const char *path,
                                const struct mesh_file_options *options, struct notes *notes)
{
    const struct gifti_options gifti_options = {
        .path = path, .external = options->external, .max_memory = options->max_memory};
    return gifti_parse(out, bytes->data, bytes->size, &gifti_options, notes);
}

static conus_status take_gifti(struct mesh *out, struct label *about, const struct bytes *bytes, const char *path,
                               const struct mesh_file_options *options, struct notes *notes)
{
    struct gifti gifti = {0};
    conus_status status = parse_gifti(&gifti, bytes, path, options, notes);
    status = status ? status : gifti_mesh(out, &gifti, options->space != MESH_SPACE_UNSTATED, notes);
    if (!status && about) {
        about->name = gifti.name;
        about->hemisphere = gifti.hemisphere;
        gifti.name = NULL;
    }
    gifti_finish(&gifti);
    return status;
}

/* A surface of ours, in `bytes`. */
static conus_status read_own(struct mesh *out, struct label *about, const struct bytes *bytes, const char *path,
                             const struct mesh_file_options *options, struct notes *notes)
{
    static const double ras_from_lps[16] = {-1, 0, 0, 0, 0, -1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
    struct mesh mesh = {0};
    struct label said = {0};
    struct notes own = {0};
    bool as_stored = options->space != MESH_SPACE_UNSTATED;
    const enum format_id id = format_id_of(bytes, ROLE_SURFACE);
    conus_status status =
        id == FORMAT_GIFTI ? take_gifti(&mesh, &said, bytes, path, options, &own)
        : id == FORMAT_FREESURFER
            ? freesurfer_surface_parse(&mesh, bytes->data, bytes->size, as_stored, &own)
            : file_refuse(path, bytes,
                          "a surface (GIFTI, FreeSurfer, or named as VTK, VTP, PLY, STL, OBJ, OFF or MZ3)");
    conus_status moved = notes_move_in(notes, &own, path); /* also where it failed; parsers do not know the path */
    status = status ? fail_in(status, path) : moved;
    if (!status && options->space == MESH_SPACE_LPS) {
        mesh_transform(&mesh, ras_from_lps);
    }
    if (!status) {
        mesh.path = memory_text(path, strlen(path));
        status = mesh.path ? mesh_check(&mesh, notes) : CONUS_ERROR_MEMORY;
        status = status ? fail_in(status, path) : CONUS_OK;
    }
    if (status || !about) {
        label_finish(&said);
    } else {
        *about = said;
    }
    if (status) {
        mesh_finish(&mesh);
        return status;
    }
    *out = mesh;
    return CONUS_OK;
}

conus_status mesh_file_read(struct mesh *out, struct label *about, const char *path,
                            const struct mesh_file_options *options, struct notes *notes)
{
    struct bytes bytes = {0};
    options = options ? options : &defaults;
    const struct format *format = NULL;
    conus_status status = source_find(&format, path, ROLE_SURFACE);
    if (mesh_format_is_foreign(format)) {
        const struct mesh_foreign_options foreign = {options->space, options->max_memory};
        return mesh_foreign_read(out, &path, 1, &foreign, notes);
    }
    status = status ? status : gzip_read(&bytes, path, memory_limit(options->max_memory), options->read);
    status = status ? status : read_own(out, about, &bytes, path, options, notes);
    bytes_finish(&bytes);
    return status;
}

void vertex_labels_finish(struct vertex_labels *labels)
{
    memory_free(labels->labels);
    label_table_finish(&labels->table);
    *labels = (struct vertex_labels){0};
}

static conus_status take_gifti_labels(struct vertex_labels *out, const struct bytes *bytes, const char *path,
                                      struct text wanted, const struct mesh_file_options *options, struct notes *notes)
{
    struct gifti gifti = {0};
    size_t map = 0;
    conus_status status = parse_gifti(&gifti, bytes, path, options, notes);
    status = status ? status : gifti_find_labels(&gifti, notes);
    status = status ? status : gifti_map_find(&map, &gifti, wanted, notes);
    status = status ? status : gifti_labels(&out->labels, &out->count, &gifti, map, notes);
    if (!status) {
        out->table = gifti.labels;
        out->hemisphere = gifti.hemisphere;
        gifti.labels = (struct label_table){0};
    }
    gifti_finish(&gifti);
    return status;
}

char mesh_file_side(char stated, const char *path)
{
    static const struct {
        const char *word; /* in a name, behind a dot that stands before it */
        char side;
    } words[] = {{".lh.", 'L'}, {".rh.", 'R'}, {".L.", 'L'}, {".R.", 'R'}, {"hemi-L", 'L'}, {"hemi-R", 'R'}};
    char name[256];
    snprintf(name, sizeof name, ".%s", path_base(path));
    char side = stated == 'B' ? '\0' : stated;
    for (size_t i = 0; i < sizeof words / sizeof words[0] && !side; i++) {
        side = (char)(strstr(name, words[i].word) ? words[i].side : '\0');
    }
    return side;
}

conus_status mesh_file_sides_match(char surface_side, const char *surface, char labels_side, const char *labels)
{
    static const char *const names[] = {"left", "right"};
    char of_surface = mesh_file_side(surface_side, surface);
    char of_labels = mesh_file_side(labels_side, labels);
    return !of_surface || !of_labels || of_surface == of_labels
               ? CONUS_OK
               : fail(CONUS_ERROR_DATA, "%s: labels of the %s side, the surface %s is of the %s one", labels,
                      names[of_labels == 'R'], surface, names[of_surface == 'R']);
}

/* One area, called as the file is: "V1_exvivo" of lh.V1_exvivo.label, with the side that this says. */
static conus_status take_freesurfer_label(struct vertex_labels *out, struct text text, const char *path)
{
    const char *name = path_base(path);
    bool has_side = strncmp(name, "lh.", 3) == 0 || strncmp(name, "rh.", 3) == 0;
    name += has_side ? 3 : 0;
    size_t ending = path_ending_length(name, ".label/.label.gz");
    conus_status status = freesurfer_label_parse(&out->labels, &out->count, text);
    struct label *label = status ? NULL : label_table_add(&out->table, 1);
    status = status || label ? status : CONUS_ERROR_MEMORY;
    status = status ? status : label_set_text(&label->name, (struct text){name, strlen(name) - ending});
    out->hemisphere = has_side ? mesh_file_side('\0', path) : '\0';
    out->is_list = true;
    return status;
}

conus_status vertex_labels_extend(struct vertex_labels *labels, size_t count)
{
    if (!labels->is_list || labels->count >= count) {
        return CONUS_OK;
    }
    uint32_t *longer = memory_zeroed(count, sizeof *longer);
    if (!longer) {
        return CONUS_ERROR_MEMORY;
    }
    memcpy(longer, labels->labels, labels->count * sizeof *longer);
    memory_free(labels->labels);
    labels->labels = longer;
    labels->count = count;
    return CONUS_OK;
}

static conus_status take_labels(struct vertex_labels *out, const struct bytes *bytes, const char *path, struct text map,
                                const struct mesh_file_options *options, struct notes *notes)
{
    const struct file_head head = head_of(path, bytes);
    const struct format *format = format_find(&head, ROLE_VERTEX_LABELS);
    const enum format_id id = format ? format->id : FORMAT_OTHER;
    if (id == FORMAT_GIFTI) {
        return take_gifti_labels(out, bytes, path, map, options, notes);
    }
    if (id == FORMAT_CIFTI) {
        return cifti_vertices_read(out, bytes, map, options, notes);
    }
    if (map.size) {
        return fail(CONUS_ERROR_ARGUMENT, "map: found \"%.*s\", only GIFTI and CIFTI labels have several",
                    TEXT_SHOW(map, 60));
    }
    if (id == FORMAT_FREESURFER_LABEL) {
        return take_freesurfer_label(out, (struct text){(const char *)bytes->data, bytes->size}, path);
    }
    if (format) { /* a surface */
        return CONUS_OK;
    }
    conus_status status =
        freesurfer_annot_parse(&out->labels, &out->count, &out->table, bytes->data, bytes->size, notes);
    const struct file_head nameless = head_of(NULL, bytes);
    if (status == CONUS_ERROR_DATA && format_nearest(&nameless)) { /* an annotation has no mark of its own */
        return file_refuse(NULL, bytes,
                           "labels of vertices (GIFTI or CIFTI labels, or a FreeSurfer annotation or label)");
    }
    return status == CONUS_ERROR_DATA ? fail_in(status, "not GIFTI, and as a FreeSurfer annotation") : status;
}

static conus_status read_labels(struct vertex_labels *out, const char *path, struct text map,
                                const struct mesh_file_options *options, struct notes *notes)
{
    struct bytes bytes = {0};
    struct vertex_labels labels = {0};
    struct notes own = {0};
    conus_status status = gzip_read(&bytes, path, memory_limit(options->max_memory), options->read);
    if (status) {
        return status;
    }
    status = take_labels(&labels, &bytes, path, map, options, &own);
    bytes_finish(&bytes);
    conus_status moved = notes_move_in(notes, &own, path);
    status = status ? fail_in(status, path) : moved;
    if (status) {
        vertex_labels_finish(&labels);
        return status;
    }
    *out = labels;
    return CONUS_OK;
}

conus_status vertex_labels_read(struct vertex_labels *out, const char *path, const struct mesh_file_options *options,
                                struct notes *notes)
{
    char *file = NULL;
    struct text map;
    conus_status status = map_choice_split(&file, &map, path);
    status = status ? status : read_labels(out, file, map, options ? options : &defaults, notes);
    memory_free(file);
    return status;
}
