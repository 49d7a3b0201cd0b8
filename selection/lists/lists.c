/* SPDX-License-Identifier: BSD-3-Clause */
/* Lists what options may name, the atlases that are installed, and the contacts of a probe. */
#include "selection/table/table.h"

#include "base/geometry/math3.h"
#include "base/memory.h"
#include "base/status.h"
#include "conus/own.h"

#include <string.h>

struct choice_row {
    struct table_object object;
    const char *name, *help;
};

static const struct table_field choice_fields[] = {
    {"name", NULL, "what an option takes", TABLE_OF(TEXT, struct choice_row, name)},
    {"help", NULL, "one line; n/a of most", TABLE_OF(TEXT, struct choice_row, help)},
};
static const struct table_fields choice_columns = TABLE_FIELDS(choice_fields);

static struct choice_row plain_choice(const char *name)
{
    return (struct choice_row){.name = name};
}

static struct choice_row format_choice(size_t index)
{
    const conus_format_info *info = conus_format_at(index);
    return plain_choice(info ? info->name : NULL);
}

static struct choice_row rows_choice(size_t index)
{
    return plain_choice(conus_rows_name(index));
}

static struct choice_row pose_format_choice(size_t index)
{
    return plain_choice(conus_pose_format_name(index));
}

static struct choice_row score_choice(size_t index)
{
    const conus_score_info *score = conus_score(index);
    return (struct choice_row){.name = score ? score->name : NULL, .help = score ? score->description : NULL};
}

static struct choice_row space_choice(size_t index)
{
    return plain_choice(conus_space_name(index));
}

static struct choice_row transfer_choice(size_t index)
{
    return plain_choice(conus_transfer_preset(index));
}

static const struct {
    const char *name;
    struct choice_row (*at)(size_t index);
} choices[] = {
    {"formats", format_choice}, {"pose formats", pose_format_choice}, {"rows", rows_choice}, {"scores", score_choice},
    {"spaces", space_choice},   {"transfers", transfer_choice},
};

struct error_row {
    struct table_object object;
    conus_pose_error error;
};

static const struct table_field error_fields[] = {
    {"name", NULL, "what an option takes", TABLE_OF(TEXT, struct error_row, error.name)},
    {"tilt_deg", "degree", "of the axis, about two axes", TABLE_OF(NUMBER, struct error_row, error.tilt_deg)},
    {"shift_mm", "mm", "of the position, along three axes", TABLE_OF(NUMBER, struct error_row, error.shift)},
    {"entry_mm", "mm", "of the entry, along two axes", TABLE_OF(NUMBER, struct error_row, error.entry)},
    {"target_mm", "mm", "of the far end, along two axes", TABLE_OF(NUMBER, struct error_row, error.target)},
    {"depth_mm", "mm", "of the depth", TABLE_OF(NUMBER, struct error_row, error.depth)},
    {"measured", NULL, "what was measured", TABLE_OF(TEXT, struct error_row, error.measured)},
    {"source", NULL, "where it is published", TABLE_OF(TEXT, struct error_row, error.source)},
};
static const struct table_fields error_columns = TABLE_FIELDS(error_fields);

static conus_status list_errors(conus_table **out)
{
    size_t count = 0;
    while (conus_pose_error_at(count)) {
        count++;
    }
    struct error_row *rows = memory_zeroed(count, sizeof *rows);
    for (size_t i = 0; rows && i < count; i++) {
        rows[i].error = *conus_pose_error_at(i);
    }
    return table_of_rows(out, NULL, &error_columns, rows, sizeof *rows, count);
}

conus_status conus_list_choices(conus_table **out, const char *what)
{
    if (!what) {
        return fail(CONUS_ERROR_ARGUMENT, "what: none");
    }
    if (strcmp(what, "errors") == 0) {
        return list_errors(out);
    }
    size_t at = 0;
    while (at < sizeof choices / sizeof *choices && strcmp(choices[at].name, what) != 0) {
        at++;
    }
    if (at == sizeof choices / sizeof *choices) {
        return fail(CONUS_ERROR_ARGUMENT,
                    "what: %s, allowed are errors, formats, pose formats, rows, scores, spaces and transfers", what);
    }
    size_t count = 0;
    while (choices[at].at(count).name) {
        count++;
    }
    struct choice_row *rows = memory_zeroed(count, sizeof *rows);
    for (size_t i = 0; rows && i < count; i++) {
        rows[i] = choices[at].at(i);
    }
    return table_of_rows(out, NULL, &choice_columns, rows, sizeof *rows, count);
}

struct installed_row {
    struct table_object object;
    conus_installed atlas;
};

static const struct table_field installed_fields[] = {
    {"name", NULL, "for conus_atlas_load(), of several of one name as source:name",
     TABLE_OF(TEXT, struct installed_row, atlas.name)},
    {"source", NULL, "whose folder it is in: mricron, fsl; own for $CONUS_ATLAS_PATH",
     TABLE_OF(TEXT, struct installed_row, atlas.source)},
    {"kind", NULL, "volume, probabilities, surface, surfaces, scene or pack",
     TABLE_OF(TEXT, struct installed_row, atlas.kind)},
    {"spacing_x", "mm", "edge of a voxel; n/a where it is not known",
     TABLE_OF(NUMBER, struct installed_row, atlas.spacing[0])},
    {"spacing_y", "mm", "edge of a voxel", TABLE_OF(NUMBER, struct installed_row, atlas.spacing[1])},
    {"spacing_z", "mm", "edge of a voxel", TABLE_OF(NUMBER, struct installed_row, atlas.spacing[2])},
    {"path", NULL, "for conus_atlas_load(): bytes, not always UTF-8", TABLE_OF(TEXT, struct installed_row, atlas.path)},
    {"labels", NULL, "for conus_load_options.labels; n/a where it finds them",
     TABLE_OF(TEXT, struct installed_row, atlas.labels)},
};
static const struct table_fields installed_columns = TABLE_FIELDS(installed_fields);

struct place_row {
    struct table_object object;
    const char *source, *rule, *path;
    uint64_t is_there;
};

static const struct table_field place_fields[] = {
    {"source", NULL, "whose folder it is", TABLE_OF(TEXT, struct place_row, source)},
    {"rule", NULL, "how it is named: $FSLDIR/data/atlases", TABLE_OF(TEXT, struct place_row, rule)},
    {"path", NULL, "the folder; n/a where the environment does not say which", TABLE_OF(TEXT, struct place_row, path)},
    {"there", NULL, "1 where there is such a folder, else 0", TABLE_OF(LARGE_COUNT, struct place_row, is_there)},
};
static const struct table_fields place_columns = TABLE_FIELDS(place_fields);

static conus_status list_places(conus_table **out, const conus_catalogue *catalogue)
{
    const size_t count = conus_catalogue_place_count(catalogue);
    struct place_row *rows = memory_zeroed(count, sizeof *rows);
    for (size_t i = 0; rows && i < count; i++) {
        const conus_catalogue_place *place = conus_catalogue_place_at(catalogue, i);
        rows[i] = (struct place_row){{0}, place->source, place->rule, place->path, place->there};
    }
    return table_of_rows(out, NULL, &place_columns, rows, sizeof *rows, count);
}

static conus_status list_catalogue(conus_table **out, const conus_catalogue *catalogue)
{
    const size_t count = conus_catalogue_count(catalogue);
    struct installed_row *rows = memory_zeroed(count, sizeof *rows);
    for (size_t i = 0; rows && i < count; i++) {
        rows[i].atlas = *conus_catalogue_atlas(catalogue, i);
        for (int a = 0; a < 3; a++) {
            const double spacing = rows[i].atlas.spacing[a];
            rows[i].atlas.spacing[a] = spacing > 0 ? spacing : NAN; /* n/a */
        }
    }
    return table_of_rows(out, NULL, &installed_columns, rows, sizeof *rows, count);
}

conus_status conus_list_installed(conus_table **out, conus_log log, void *log_user)
{
    conus_catalogue_options options = CONUS_CATALOGUE_OPTIONS_INIT;
    conus_catalogue *catalogue = NULL;
    conus_table *atlases = NULL;
    conus_table *places = NULL;
    options.log = log;
    options.log_user = log_user;
    conus_status status = conus_catalogue_create(&catalogue, &options);
    status = status ? status : list_catalogue(&atlases, catalogue);
    status = status ? status : list_places(&places, catalogue);
    conus_catalogue_destroy(catalogue);
    if (status) {
        conus_table_destroy(atlases);
        return status;
    }
    table_add_part(atlases, "places", places);
    *out = atlases;
    return CONUS_OK;
}

struct contact_row {
    struct table_object object;
    const char *id, *probe, *shank;
    uint64_t number; /* of the probe, from 1 */
    int64_t channel;
    double position[3], offset[3];
};

static struct cell contact_channel(const struct table_source *source, const void *row, size_t index)
{
    const int64_t channel = ((const struct contact_row *)row)->channel;
    (void)source;
    (void)index;
    return channel < -1 ? no_cell() : integer_cell((uint64_t)channel);
}

static const struct table_field contact_fields[] = {
    {"id", NULL, "contact_id: that of no other; of several probes probe2:e7", TABLE_OF(TEXT, struct contact_row, id)},
    {"probe", NULL, "probe1, probe2, in the order of the file", TABLE_OF(TEXT, struct contact_row, probe)},
    {"number", NULL, "number of the probe, from 1", TABLE_OF(LARGE_COUNT, struct contact_row, number)},
    {"shank_id", NULL, "n/a where the file has none", TABLE_OF(TEXT, struct contact_row, shank)},
    {"channel", NULL, "the trace that it is recorded on, from 0; -1 = it is not wired; n/a: the file does not say",
     TABLE_COUNT_BY(contact_channel)},
    {"x_um", "um", "as in the file", TABLE_OF(NUMBER, struct contact_row, position[0])},
    {"y_um", "um", "as in the file", TABLE_OF(NUMBER, struct contact_row, position[1])},
    {"z_um", "um", "as in the file; n/a of a probe in two dimensions",
     TABLE_OF(NUMBER, struct contact_row, position[2])},
    {"offset_x", "mm", "from the probe's tip in the device's frame (Eq. 2): along the probe's x axis",
     TABLE_OF(NUMBER, struct contact_row, offset[0])},
    {"offset_y", "mm", "across both", TABLE_OF(NUMBER, struct contact_row, offset[1])},
    {"offset_z", "mm", "along the shank, away from the tip", TABLE_OF(NUMBER, struct contact_row, offset[2])},
};
static const struct table_fields contact_columns = TABLE_FIELDS(contact_fields);

struct tip_row {
    struct table_object object;
    double tip[3];
};

static const struct table_field tip_fields[] = {
    {"x_um", "um", "the lowest point of its contour, as in the file", TABLE_OF(NUMBER, struct tip_row, tip[0])},
    {"y_um", "um", "of the tip", TABLE_OF(NUMBER, struct tip_row, tip[1])},
    {"z_um", "um", "of the tip; n/a of a probe in two dimensions", TABLE_OF(NUMBER, struct tip_row, tip[2])},
};
static const struct table_fields tip_columns = TABLE_FIELDS(tip_fields);

static conus_status list_contacts(conus_table **out, const conus_probe *probe)
{
    const size_t count = conus_probe_contact_count(probe);
    struct contact_row *rows = memory_zeroed(count, sizeof *rows);
    for (size_t i = 0; rows && i < count; i++) {
        const conus_probe_contact *contact = conus_probe_at(probe, i);
        rows[i] = (struct contact_row){.id = contact->id, .probe = contact->probe, .shank = contact->shank};
        rows[i].number = contact->index + 1;
        rows[i].channel = contact->channel;
        memcpy(rows[i].position, contact->position, sizeof rows[i].position);
        memcpy(rows[i].offset, contact->offset, sizeof rows[i].offset);
    }
    return table_of_rows(out, NULL, &contact_columns, rows, sizeof *rows, count);
}

static conus_status list_tips(conus_table **out, const conus_probe *probe)
{
    const size_t count = conus_probe_count(probe);
    struct tip_row *rows = memory_zeroed(count, sizeof *rows);
    for (size_t i = 0; rows && i < count; i++) {
        conus_probe_tip(rows[i].tip, probe, i);
    }
    return table_of_rows(out, NULL, &tip_columns, rows, sizeof *rows, count);
}

conus_status conus_probe_table(conus_table **out, const conus_probe *probe)
{
    conus_table *contacts = NULL;
    conus_table *tips = NULL;
    conus_status status = list_contacts(&contacts, probe);
    status = status ? status : list_tips(&tips, probe);
    if (status) {
        conus_table_destroy(contacts);
        return status;
    }
    table_add_part(contacts, "tips", tips);
    *out = contacts;
    return CONUS_OK;
}
