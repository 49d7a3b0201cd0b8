/* SPDX-License-Identifier: BSD-3-Clause */
/* Reads a surface, or labels of vertices, with the reader of its format. */
#include "loaders/surfaces/surfaces.h"

#include "base/geometry/math3.h"
#include "base/memory.h"
#include "base/path.h"
#include "loaders/cifti/cifti.h"
#include "loaders/labels/labels.h"
#include "loaders/refuse.h"
#include "loaders/surfaces/foreign/foreign.h"
#include "loaders/surfaces/parts.h"
#include "sources/source.h"

#include <stdio.h>
#include <string.h>

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
    return memory_text(file, stem_length(file, strlen(file), ROLE_SURFACE));
}

/* The side of a file of a surface: stated ('L', 'R') or else that of its name: "lh." or "rh.", "hemi-L", ".L.". 0 =
 * neither says. */
static char mesh_file_side(char stated, const char *path)
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

void mesh_file_match_sides(struct job *job, char surface_side, const char *surface, char labels_side,
                           const char *labels)
{
    static const char *const names[] = {"left", "right"};
    char of_surface = mesh_file_side(surface_side, surface);
    char of_labels = mesh_file_side(labels_side, labels);
    if (of_surface && of_labels && of_surface != of_labels) {
        job_bad(job, "%s: labels of the %s side, the surface %s is of the %s one", labels, names[of_labels == 'R'],
                surface, names[of_surface == 'R']);
    }
}

/* A file that is read. Its parser does not know the path: notes of before, and their sink, wait until the end. */
struct reading {
    struct job *job;
    const char *path;
    const struct mesh_file_options *options;
    struct job_mark mark;
    struct notes before;
    const struct note_sink *sink;
    struct bytes bytes;
};

static struct reading begin_reading(struct job *job, const char *path, const struct mesh_file_options *options)
{
    struct reading reading = {.job = job, .path = path, .options = options, .mark = job_mark(job), .sink = job->sink};
    reading.before = label_notes_swap(job, (struct notes){0});
    job->sink = NULL;
    struct source *source = source_open(job, path);
    reading.bytes = source_whole(job, source);
    if (options->is_made_of) {
        source_made_of(job, source);
    }
    return reading;
}

/* The parser is done: lets go of the file and what was made of it, and tells the notes, also where it was refused. */
static void end_reading(struct reading *reading)
{
    struct job *job = reading->job;
    struct notes said = label_notes_swap(job, reading->before);
    job->sink = reading->sink;
    job_release(job, reading->mark);
    conus_status status = notes_move_in(&job->notes, &said, reading->path);
    notes_finish(&said);
    (void)JOB_CALL(job, status);
}

static struct text text_of(const struct reading *reading)
{
    return (struct text){(const char *)reading->bytes.data, reading->bytes.size};
}

static struct gifti *parse_gifti(struct reading *reading)
{
    const struct text document = text_from_bytes(reading->bytes.data, reading->bytes.size);
    return gifti_read(reading->job, document, reading->options->external ? reading->path : NULL);
}

static void read_gifti(struct reading *reading, struct mesh *out, struct label *said, bool as_stored)
{
    struct job *job = reading->job;
    struct gifti *gifti = parse_gifti(reading);
    gifti_surface(job, out, gifti, as_stored);
    if (job_ok(job)) {
        said->name = job_give(job, gifti->name, gifti->name ? strlen(gifti->name) + 1 : 0);
        said->hemisphere = gifti->hemisphere;
    }
}

static void read_own(struct job *job, struct mesh *out, struct label *said, const char *path,
                     const struct mesh_file_options *options)
{
    static const double ras_from_lps[16] = {-1, 0, 0, 0, 0, -1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
    struct reading reading = begin_reading(job, path, options);
    const struct bytes *bytes = &reading.bytes;
    bool as_stored = options->space != MESH_SPACE_UNSTATED;
    const enum format_id id = job_ok(job) ? format_id_of(bytes, ROLE_SURFACE) : FORMAT_OTHER;
    if (id == FORMAT_GIFTI) {
        read_gifti(&reading, out, said, as_stored);
    } else if (id == FORMAT_FREESURFER) {
        struct reader r = reader_of(job, text_of(&reading));
        freesurfer_surface_read(&r, out, as_stored);
    } else {
        file_refuse(job, path, bytes, "a surface (GIFTI, FreeSurfer, or named as VTK, VTP, PLY, STL, OBJ, OFF or MZ3)");
    }
    end_reading(&reading);
    if (!job_ok(job)) {
        return;
    }
    if (options->space == MESH_SPACE_LPS) {
        mesh_transform(out, ras_from_lps);
    }
    out->path = memory_text(path, strlen(path));
    if (job_need(job, out->path)) {
        (void)JOB_CALL(job, mesh_check(out, &job->notes));
    }
}

void surface_read(struct job *job, struct mesh *out, struct label *about, const char *path,
                  const struct mesh_file_options *options)
{
    struct mesh mesh = {0};
    struct label said = {0};
    if (mesh_format_is_foreign(source_format(job, path, ROLE_SURFACE))) {
        mesh_foreign_files(job, out, &path, 1, options->space);
        return;
    }
    const size_t place = job_in(job, path, JOB_ALONE);
    read_own(job, &mesh, &said, path, options);
    job_out(job, place);
    if (!job_ok(job) || !about) {
        label_finish(&said);
    } else {
        *about = said;
    }
    if (job_ok(job)) {
        *out = mesh;
    } else {
        mesh_finish(&mesh);
    }
}

void vertex_labels_finish(struct vertex_labels *labels)
{
    memory_free(labels->labels);
    label_table_finish(&labels->table);
    *labels = (struct vertex_labels){0};
}

void vertex_labels_extend(struct job *job, struct vertex_labels *labels, size_t count)
{
    if (!labels->is_list || labels->count >= count || !job_step(job)) {
        return;
    }
    uint32_t *longer = memory_zeroed(count, sizeof *longer);
    if (job_need(job, longer)) {
        memcpy(longer, labels->labels, labels->count * sizeof *longer);
        memory_free(labels->labels);
        labels->labels = longer;
        labels->count = count;
    }
}

static void take_vertices(struct job *job, struct vertex_labels *out, uint32_t *made)
{
    out->labels = job_give(job, made, out->count * sizeof *made);
}

static void take_gifti(struct reading *reading, struct vertex_labels *out, struct text map)
{
    struct job *job = reading->job;
    struct gifti *gifti = parse_gifti(reading);
    gifti_settle_labels(job, gifti);
    const size_t index = gifti_map(job, gifti, map);
    take_vertices(job, out, gifti_vertices(job, &out->count, gifti, index));
    if (job_ok(job)) {
        labels_move(job, &out->table, &gifti->labels);
        out->hemisphere = gifti->hemisphere;
    }
}

/* One area, called as the file is: "V1_exvivo" of lh.V1_exvivo.label, with the side that this says. */
static void take_freesurfer_label(struct reading *reading, struct vertex_labels *out)
{
    struct job *job = reading->job;
    const char *path = reading->path;
    const char *name = path_base(path);
    bool has_side = strncmp(name, "lh.", 3) == 0 || strncmp(name, "rh.", 3) == 0;
    name += has_side ? 3 : 0;
    const struct text stem = {name, strlen(name) - path_ending_length(name, ".label/.label.gz")};
    take_vertices(job, out, freesurfer_label_read(job, text_of(reading), &out->count));
    struct label *label = job_step(job) ? label_table_add(&out->table, 1) : NULL;
    if (job_need(job, label)) {
        (void)JOB_CALL(job, label_set_text(&label->name, stem));
    }
    out->hemisphere = has_side ? mesh_file_side('\0', path) : '\0';
    out->is_list = true;
}

/* An annotation has no mark of its own. */
static void take_annotation(struct reading *reading, struct vertex_labels *out)
{
    struct job *job = reading->job;
    const struct bytes *bytes = &reading->bytes;
    const struct attempt attempt = job_try(job);
    struct reader r = reader_of(job, text_of(reading));
    take_vertices(job, out, freesurfer_annot_read(&r, &out->table, &out->count));
    if (job->status != CONUS_ERROR_DATA) {
        (void)attempt_end(job, &attempt, ATTEMPT_KEEP);
        return;
    }
    const struct notes said = label_notes_swap(job, (struct notes){0}); /* they stay */
    const char *why = attempt_end(job, &attempt, ATTEMPT_DROP);
    (void)label_notes_swap(job, said);
    const struct file_head nameless = head_of(NULL, bytes);
    if (format_nearest(&nameless)) {
        file_refuse(job, NULL, bytes,
                    "labels of vertices (GIFTI or CIFTI labels, or a FreeSurfer annotation or label)");
    }
    job_bad(job, "not GIFTI, and as a FreeSurfer annotation: %s", why);
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

static void fail_structure(struct job *job, const struct cifti_choice *choice, const char *structure,
                           const char *surface)
{
    const char *list = ""; /* "CortexLeft, CortexRight" */
    for (size_t i = 0; i < choice->cifti.model_count; i++) {
        const struct cifti_model *model = &choice->cifti.models[i];
        if (model->is_surface) {
            list = job_format(job, "%s%s%s", list, *list ? ", " : "", model->structure->name);
        }
    }
    list = *list ? list : "no surface";
    surface = surface ? path_base(surface) : "the surface";
    if (structure) {
        job_bad(job, "labels of %s, which %s is, are not there: the file has those of %s", structure, surface, list);
    } else {
        job_bad(job,
                "%s does not say which structure it is (AnatomicalStructurePrimary), and the file has labels of %s: "
                "\"hemisphere\" in a manifest says which",
                surface, list);
    }
}

static void take_model(struct reading *reading, struct vertex_labels *out, const struct cifti_choice *choice,
                       const struct surface_about *about)
{
    struct job *job = reading->job;
    const struct mesh_file_options *options = reading->options;
    const char *structure = about->structure             ? about->structure
                            : options->hemisphere == 'L' ? "CortexLeft"
                            : options->hemisphere == 'R' ? "CortexRight"
                                                         : NULL;
    const struct cifti_model *model = structure ? cifti_choice_surface(choice, structure) : only_surface(choice);
    if (!model) {
        fail_structure(job, choice, structure, options->surface);
        return;
    }
    if (about->vertices && about->vertices != model->vertex_count) {
        job_bad(job, "labels of %zu vertices of %s, %s has %zu: they must be as many", model->vertex_count,
                model->structure->name, path_base(options->surface), about->vertices);
    }
    out->count = model->vertex_count;
    out->hemisphere = model->structure->side;
    take_vertices(job, out, cifti_vertices(job, &out->table, choice, model));
}

/* Of a .dlabel.nii the labels of options->surface: those of the structure that it says it is, else of the cortex on the
 * side options->hemisphere, else of the only surface of the file. They must be of as many vertices as a GIFTI surface
 * has. */
static void take_cifti(struct reading *reading, struct vertex_labels *out, struct text map)
{
    struct job *job = reading->job;
    const char *surface = reading->options->surface;
    const struct cifti_choice *choice = cifti_choose(job, &reading->bytes, map);
    const struct surface_about about = surface ? surface_about_of(job, surface) : (struct surface_about){0};
    if (job_ok(job)) {
        take_model(reading, out, choice, &about);
    }
}

static void take_labels(struct reading *reading, struct vertex_labels *out, struct text map)
{
    const struct file_head head = head_of(reading->path, &reading->bytes);
    const struct format *format = format_find(&head, ROLE_VERTEX_LABELS);
    const enum format_id id = format ? format->id : FORMAT_OTHER;
    if (id == FORMAT_GIFTI) {
        take_gifti(reading, out, map);
    } else if (id == FORMAT_CIFTI) {
        take_cifti(reading, out, map);
    } else if (map.size) {
        job_fail(reading->job, CONUS_ERROR_ARGUMENT, "map: found \"%.*s\", only GIFTI and CIFTI labels have several",
                 TEXT_SHOW(map, 60));
    } else if (id == FORMAT_FREESURFER_LABEL) {
        take_freesurfer_label(reading, out);
    } else if (!format) { /* else a surface */
        take_annotation(reading, out);
    }
}

void surface_labels_read(struct job *job, struct vertex_labels *out, const char *path,
                         const struct mesh_file_options *options)
{
    struct source_keys keys;
    struct vertex_labels labels = {0};
    source_keys_read(job, &keys, path, KEYS_VERTICES);
    const size_t place = job_in(job, keys.path, JOB_ALONE);
    struct reading reading = begin_reading(job, keys.path, options);
    if (job_ok(job)) {
        take_labels(&reading, &labels, keys_value(&keys, KEY_MAP)->text);
    }
    end_reading(&reading);
    job_out(job, place);
    if (job_ok(job)) {
        *out = labels;
    } else {
        vertex_labels_finish(&labels);
    }
}
