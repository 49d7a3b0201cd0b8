/* SPDX-License-Identifier: BSD-3-Clause */
/* The table of options of conus batch, and what --format means. */
#include "cli/batch/batch.h"

#include "conus/own.h"
#include "options/messages.h"
#include "options/options.h"
#include "options/output.h"
#include "options/progress.h"

#include <stdlib.h>
#include <string.h>

/* The place of format `index` of batches among all; behind these where there are fewer. */
static size_t find_format(size_t index)
{
    size_t place = 0;
    const conus_format_info *info;
    while ((info = conus_format_at(place)) && (index > 0 || !info->of_batch)) {
        index -= info->of_batch;
        place++;
    }
    return place;
}

static const char *name_of_format(size_t index)
{
    const conus_format_info *info = conus_format_at(find_format(index));
    return info ? info->name : NULL;
}

static const struct option pose_options[] = {
    {OPTION_VALUED("poses", struct batch_settings, poses, "FILE"),
     .help = "poses to answer (docs/formats.md); - is standard input", .words = "input, coil, trajectory",
     .common = true, .required = true, .role = OPTION_READS_POSES, .holds = HOLDS_POSES},
    {OPTION_DEGREES("angle", struct batch_settings, aim.angle),
     .help = "full opening angle of the cones without one of their own, more than 0 and less than 180",
     .standard = OPTION_DIGITS(DEFAULT_ANGLE), OPTION_FROM_TO(0, 180), .words = "width, opening", .common = true},
    {OPTION_NAMED("inward", struct batch_settings, aim.inward),
     .help = "points of the file look straight into the head: positions of a cap that are called by their names (C3) "
             "against the scalp's normal there, others against that of the context's head within 5 mm, or else to the "
             "atlas's nearest",
     .words = "EEG, fNIRS, optode, perpendicular", .excludes = "probe"},
    {OPTION_VALUED("shard", struct batch_settings, shard, "I/N|all/N|auto"),
     .help = "answer part I (from 0) of N equal parts of the file, into FILE.I-of-N; or every part that is not there, "
             "and join them; or the part that srun, mpirun or an array of jobs gives this process",
     .words = "split, cluster, array, part, merge, join, resume, continue, mpi", .role = OPTION_OF_RUN},
    {0},
};

static const struct option output_options[] = {
    {OPTION_VALUED("output", struct batch_settings, output, "FILE"), .letter = 'o',
     .help = "write the rows to FILE, and a .json beside it that describes them; else they go to standard output",
     .words = "save, export, Excel", .common = true, .role = OPTION_WRITES_ANSWER, .format = "tsv",
     .holds = HOLDS_ROWS},
    {OPTION_VALUED("format", struct batch_settings, format, "FORMAT"),
     .help = "format of the rows; those behind ndjson are for other programs (docs/formats.md):",
     .otherwise = "by the ending of -o, else tsv", .choice_at = name_of_format, .role = OPTION_KEPT},
    {OPTION_NAMED("summary", struct batch_settings, summary),
     .help = "one row per pose: the best area, pathway or bundle, the runner-up, and by how much", .words = "best",
     .common = true},
    {OPTION_NAMED("force", struct batch_settings, force), .help = "replace FILE, and parts of it", .words = "overwrite",
     .role = OPTION_OF_RUN},
    {0},
};

static const struct option run_options[] = {
    {OPTION_VALUED("threads", struct batch_settings, threads, "N"),
     .help = "number of threads, 1 to 1024; the rows do not depend on it", .otherwise = "one per available processor",
     OPTION_FROM_TO(1, 1024), .words = "parallel, cores, jobs", .common = true, .role = OPTION_KEPT},
    {OPTION_VALUED("block", struct batch_settings, block, "N"),
     .help = "poses per block, 1 to 65536; the rows do not depend on it", .standard = "256", OPTION_FROM_TO(1, 65536),
     .role = OPTION_KEPT},
    {OPTION_VALUED("progress", struct batch_settings, progress, "KIND"),
     .help = "on standard error: a line on a terminal, JSON for programs, or nothing:", .choices = progress_kinds,
     .role = OPTION_OF_RUN},
    {0},
};

const struct option_group batch_groups[] = {
    {"Where the cones are", pose_options, 0},
    {"", scalp_options, offsetof(struct batch_settings, aim)},
    {"", aperture_options, offsetof(struct batch_settings, aim)},
    {"", space_options, offsetof(struct batch_settings, aim.space)},
    {"", pose_file_options, offsetof(struct batch_settings, file)},
    {"", probe_settings_options, offsetof(struct batch_settings, probe)},
    {"How rays are traced", ray_options, offsetof(struct batch_settings, engine.numbers)},
    {"", pixel_options, offsetof(struct batch_settings, engine)},
    {"", engine_options, offsetof(struct batch_settings, engine)},
    {"", shape_options, offsetof(struct batch_settings, engine)},
    {"", slices_options, offsetof(struct batch_settings, engine)},
    {"", weight_options, offsetof(struct batch_settings, engine)},
    {"What can be hit", atlas_options, offsetof(struct batch_settings, atlas)},
    {"", side_options, offsetof(struct batch_settings, atlas)},
    {"", shown_options, offsetof(struct batch_settings, atlas)},
    {"", context_options, offsetof(struct batch_settings, context)},
    {"", more_atlas_options, offsetof(struct batch_settings, atlas)},
    {"What is written", output_options, 0},
    {"", keep_options, offsetof(struct batch_settings, keep)},
    {"", axis_options, offsetof(struct batch_settings, axis)},
    {"How it runs", run_options, 0},
    {"", quiet_options, offsetof(struct batch_settings, common)},
    {0},
};

bool batch_format(const char **out, const struct batch_settings *settings, const struct arguments *arguments)
{
    bool is_besides = settings->of_axis && option_given(arguments, "output"); /* --format is of the other file */
    *out = is_besides ? "tsv" : name_of_format(settings->format);
    if ((option_given(arguments, "format") && !is_besides) || output_is_no_file(settings->output)) {
        return true;
    }
    bool known = output_format(out, settings->output) && !format_is(*out, "table") && !format_is(*out, "json");
    return known || refuse("%s: --%s ends in none of .tsv, .csv, .ndjson and .jsonl; --format says what else is "
                           "written",
                           settings->output, settings->of_axis ? settings->of_axis->option : "output");
}
