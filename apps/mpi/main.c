/* SPDX-License-Identifier: BSD-3-Clause */
/* conus-mpi batch: conus batch on all ranks of an MPI job. Every rank reads the atlas and the poses' file by itself,
 * and passes over the poses that are others'; with a rank per node and --threads, an atlas is in each node's memory
 * once. */
#include "cli/batch_work.h"
#include "cli/messages.h"
#include "cli/output.h"
#include "mpi/ordered_file.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { BLOCKS_PER_PIECE = 16, DEFAULT_BLOCK = 256 };

struct run {
    struct work work;
    struct ordered_file file;
    char *temporary;
    uint64_t piece_poses; /* in a whole piece */
    int rank;

    char *text; /* of the piece */
    size_t capacity;
    conus_batch_block piece;
    bool no_memory;
};

/* An error of one rank ends all of them. */
static void give_up(const struct run *run, int code)
{
    if (run->temporary) {
        unlink(run->temporary);
    }
    MPI_Abort(MPI_COMM_WORLD, code);
}

static void check_mpi(const struct run *run, int error)
{
    char text[MPI_MAX_ERROR_STRING];
    int length;
    if (error) {
        MPI_Error_string(error, text, &length);
        complain("%s: cannot write: %s", run->work.output, text);
        give_up(run, EXIT_DATA);
    }
}

static bool collect(void *user, const conus_batch_block *block)
{
    struct run *run = user;
    size_t needed = run->piece.size + block->size;
    if (needed > run->capacity) {
        size_t capacity = needed > 2 * run->capacity ? needed : 2 * run->capacity;
        char *text = realloc(run->text, capacity);
        run->no_memory = !text;
        if (!text) {
            return false;
        }
        run->text = text;
        run->capacity = capacity;
    }
    memcpy(run->text + run->piece.size, block->text, block->size);
    run->piece.text = run->text;
    run->piece.size = needed;
    run->piece.poses += block->poses;
    run->piece.errors += block->errors;
    return true;
}

/* Takes pieces until one is short, or empty. */
static void answer_pieces(struct run *run)
{
    uint64_t passed = 0; /* poses of the file that this rank has behind it */
    for (bool ended = false; !ended;) {
        uint64_t number = ordered_file_take(&run->file);
        uint64_t first = number * run->piece_poses;
        int code = work_pass_over(&run->work, first - passed);
        run->piece = (conus_batch_block){.text = ""};
        if (!code) {
            conus_status status = conus_batch_run(run->work.batch, run->work.poses, run->piece_poses, collect, run);
            code = status ? complain_status(status) : EXIT_DONE;
        }
        if (run->no_memory) {
            complain("not enough memory");
            code = EXIT_DATA;
        }
        if (code) {
            give_up(run, code);
        }
        passed = first + run->piece_poses;
        ended = run->piece.poses < run->piece_poses;
        check_mpi(run, ordered_file_write(&run->file, number, &run->piece));
    }
}

static int prepare(struct run *run, struct batch_settings *settings, const struct arguments *arguments)
{
    struct work *work = &run->work;
    if (!arguments->operand_count || !settings->poses || !settings->output || output_is_stdout(settings->poses) ||
        output_is_stdout(settings->output) || settings->resume || settings->jobs || settings->shard) {
        return complain_usage(
            "conus-mpi batch needs ATLAS, --poses and --output, all files, and has no --resume, --jobs "
            "and --shard");
    }
    settings->threads = settings->threads ? settings->threads : 1; /* ranks are the processors */
    settings->common.quiet = settings->common.quiet || run->rank > 0;
    unsetenv("SLURM_ARRAY_TASK_ID"); /* this job is no shard */
    int code = work_init(work, settings, arguments);
    code = code ? code : work_check_output(work);
    code = code ? code : work_prepare(work);
    code = code ? code : work_identify(work);
    if (!code && asprintf(&run->temporary, "%s.part", work->output) < 0) {
        run->temporary = NULL;
        code = EXIT_DATA;
    }
    return code;
}

static int finish(struct run *run, const uint64_t totals[SHARED_COUNT])
{
    struct batch_record record = {
        .poses = totals[POSES], .errors = totals[ERRORS], .bytes = totals[BYTES], .crc = (uint32_t)totals[CRC]};
    int code = work_write_sidecar(&run->work, &record);
    if (!code && rename(run->temporary, run->work.output)) {
        complain("%s: cannot give it its name", run->work.output);
        code = EXIT_DATA;
    }
    return code ? code : totals[ERRORS] ? EXIT_DIFFERENT : EXIT_DONE;
}

static int answer(struct run *run)
{
    uint64_t totals[SHARED_COUNT] = {0};
    uint32_t block = run->work.settings->block;
    run->piece_poses = (uint64_t)BLOCKS_PER_PIECE * (block ? block : DEFAULT_BLOCK);
    check_mpi(run, ordered_file_open(&run->file, run->temporary, conus_batch_heading(run->work.batch)));
    answer_pieces(run);
    check_mpi(run, ordered_file_close(&run->file, totals));
    int code = run->rank == 0 ? finish(run, totals) : EXIT_DONE;
    MPI_Bcast(&code, 1, MPI_INT, 0, MPI_COMM_WORLD);
    return code;
}

static const struct command batch = {
    .program = "conus-mpi",
    .name = "batch",
    .summary = "answer a file of poses on all ranks of an MPI job",
    .operands = {"ATLAS"},
    .form = "--poses FILE -o FILE",
    .description =
        "As conus batch, whose file it writes byte for byte, started by mpirun or srun. Each rank answers with\n"
        "one thread unless --threads says otherwise.",
    .examples = "  mpirun -n 16 conus-mpi batch aal.nii.gz --poses poses.tsv -o rows.tsv\n",
    .groups = batch_groups,
    .settings_size = sizeof(struct batch_settings),
    .more_help = help_scores,
};

enum { GO_ON = -1 };

static int read_command(struct arguments *arguments, struct batch_settings *settings, int count, char **words)
{
    if (count < 2 || strcmp(words[1], batch.name) != 0) {
        *arguments = (struct arguments){.command = &batch};
        return complain_usage("the one command is conus-mpi batch; conus-mpi batch --help explains it");
    }
    return options_parse(arguments, settings, &batch, count, words, 2);
}

/* What is wrong on all ranks is said by the first one, which the others wait for. */
static int start(int count, char **words)
{
    struct arguments arguments = {.command = &batch};
    struct batch_settings settings = {0};
    struct run run = {0};
    int code = GO_ON;
    MPI_Comm_rank(MPI_COMM_WORLD, &run.rank);
    for (int turn = 0; turn < 2 && code == GO_ON; turn++) {
        if (turn == (run.rank > 0)) {
            code = read_command(&arguments, &settings, count, words);
            if (code == GO_ON) {
                code = prepare(&run, &settings, &arguments);
                code = code ? code : GO_ON;
            }
        }
        int own = code;
        MPI_Allreduce(&own, &code, 1, MPI_INT, MPI_MAX, MPI_COMM_WORLD);
    }
    code = code == GO_ON ? answer(&run) : code;
    free(run.text);
    free(run.temporary);
    work_finish(&run.work);
    options_finish(&settings, &arguments);
    return code;
}

int main(int argc, char **argv)
{
    int provided;
    MPI_Init_thread(&argc, &argv, MPI_THREAD_FUNNELED, &provided);
    int code = start(argc, argv);
    MPI_Finalize();
    return output_finish(code);
}
