/* SPDX-License-Identifier: BSD-3-Clause */
/* conus-mpi batch: conus batch on all ranks of an MPI job. Rank 0 leads: it alone reads the command line and the
 * journals, and announces each batch to the others. The first rank of each node loads the atlases for all that run
 * there. Every rank reads the poses' file by itself, and passes over the poses that are others'. */
#include "base/system/system.h"
#include "batch/batch_dispatch.h"
#include "batch/batch_task.h"
#include "mpi/node_atlas.h"
#include "mpi/ordered_file.h"
#include "options/input_file.h"
#include "options/interrupt.h"
#include "options/messages.h"
#include "options/output.h"
#include "options/outputs.h"
#include "pages/pages.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

enum { BLOCKS_PER_PART = 16, DEFAULT_BLOCK = 256 };

struct cluster {
    int rank, node_rank;
    MPI_Comm node;
};

struct run {
    const struct cluster *cluster;
    struct batch_task batch;
    struct node_atlas *shared; /* [batch.atlases.count]; NULL where the batch is not open */
    struct ordered_file file;
    uint64_t first, left; /* poses to answer; left UINT64_MAX = all from there on */
    uint64_t part_poses;  /* in a whole part */

    char *text; /* of the part */
    size_t capacity;
    conus_batch_block part;
};

/* The highest exit code of all ranks. */
static int agree(int code)
{
    int agreed = code;
    MPI_Allreduce(&code, &agreed, 1, MPI_INT, MPI_MAX, MPI_COMM_WORLD);
    return agreed;
}

static bool collect(void *user, const conus_batch_block *block)
{
    struct run *run = user;
    size_t needed = run->part.size + block->size;
    if (needed > run->capacity) {
        size_t capacity = needed > 2 * run->capacity ? needed : 2 * run->capacity;
        char *text = realloc(run->text, capacity);
        if (!text) {
            print_error_line("not enough memory");
            ordered_file_stop(&run->file, EXIT_DATA);
            return false;
        }
        run->text = text;
        run->capacity = capacity;
    }
    memcpy(run->text + run->part.size, block->text, block->size);
    run->part.text = run->text;
    run->part.size = needed;
    run->part.poses += block->poses;
    run->part.errors += block->errors;
    batch_task_keep_error(&run->batch, block);
    bool continues = ordered_file_tend(&run->file);
    if (run->cluster->rank == 0) {
        progress_update(&run->batch.progress, run->batch.file.poses, run->batch.file.errors);
    }
    return continues;
}

/* Takes parts until one is short, or empty, or all are to stop. */
static void answer_parts(struct run *run)
{
    uint64_t passed = 0; /* poses of the file that this rank has behind it */
    uint64_t number;
    for (bool ended = false; !ended && ordered_file_take(&run->file, &number);) {
        uint64_t before = number * run->part_poses;
        uint64_t left = before < run->left ? run->left - before : 0;
        uint64_t poses = left < run->part_poses ? left : run->part_poses;
        int code = batch_task_skip(&run->batch, poses ? run->first + before - passed : 0);
        run->part = (conus_batch_block){.text = ""};
        if (!code && poses) {
            conus_status status = conus_batch_run(run->batch.batch, run->batch.poses, poses, collect, run);
            bool is_said = !status || status == CONUS_ERROR_CANCELLED; /* by collect() */
            code = is_said ? EXIT_DONE : print_status(status);
        }
        if (code) {
            ordered_file_stop(&run->file, code);
        }
        passed = run->first + before + run->part.poses;
        ended = run->part.poses < run->part_poses;
        ordered_file_write(&run->file, number, &run->part, ended);
    }
}

/* All ranks at once, each with as many atlases. */
static int share_atlases(struct run *run)
{
    struct atlases *atlases = &run->batch.atlases;
    run->shared = calloc(atlases->count, sizeof *run->shared);
    if (!run->shared) {
        print_error_line("not enough memory");
    }
    int code = agree(run->shared ? EXIT_DONE : EXIT_DATA);
    for (size_t i = 0; i < atlases->count && !code; i++) {
        node_atlas_share(&run->shared[i], &atlases->items[i].atlas, run->cluster->node);
    }
    return code;
}

/* Loads poses and atlases in three steps, so that what is wrong on all ranks is said once: rank 0 first, then the first
 * rank of each other node, then the ranks that map their node's atlas. */
static int open_batch(struct run *run, const struct batch_settings *settings, const struct arguments *arguments)
{
    const struct cluster *cluster = run->cluster;
    int code = EXIT_DONE;
    int turn = cluster->rank == 0 ? 0 : cluster->node_rank == 0 ? 1 : 2;
    for (int i = 0; i < 3 && !code; i++) {
        if (i == turn) {
            code = batch_task_init(&run->batch, settings, arguments);
        }
        if (i == 2) {
            code = agree(code);
            code = code ? code : share_atlases(run);
        }
        if (i == turn && !code) {
            code = batch_task_open(&run->batch);
        }
        code = agree(code);
    }
    code = code ? code : batch_task_build(&run->batch);
    return agree(code);
}

/* Rank 0 opens the file and tells all where to begin. */
static int open_output(struct run *run)
{
    enum { CODE, FINISHED, POSES, SIZE, COUNT };
    uint64_t found[COUNT] = {0};
    bool leads = run->cluster->rank == 0;
    if (leads) {
        found[CODE] = (uint64_t)batch_task_open_output(&run->batch);
        found[FINISHED] = run->batch.file.is_finished;
        found[POSES] = run->batch.file.poses;
        found[SIZE] = run->batch.file.size;
    }
    MPI_Bcast(found, COUNT, MPI_UINT64_T, 0, MPI_COMM_WORLD);
    run->batch.file.is_finished = found[FINISHED];
    run->first = run->batch.first + found[POSES];
    run->left = run->batch.count == UINT64_MAX ? UINT64_MAX : run->batch.count - found[POSES];
    return found[CODE] || found[FINISHED]
               ? (int)found[CODE]
               : ordered_file_open(&run->file, run->batch.output, found[SIZE], leads ? &run->batch.file : NULL);
}

/* Adds what another rank found; the first pose is the one with the lower number. */
static void add_oddity(conus_oddity *sum, const conus_oddity *more)
{
    uint64_t count = sum->count + more->count;
    if (more->count && (!sum->count || more->first < sum->first)) {
        *sum = *more;
    }
    sum->count = count;
}

static void add_astray(conus_astray *sum, const conus_astray *more)
{
    sum->poses += more->poses;
    add_oddity(&sum->inside, &more->inside);
    add_oddity(&sum->away, &more->away);
    add_oddity(&sum->tiny, &more->tiny);
    sum->points += more->points;
    add_oddity(&sum->far, &more->far);
    add_oddity(&sum->apart, &more->apart);
}

/* Rank 0 prints how many poses have no answer, with the first one that any rank found. */
static void say_errors(struct run *run)
{
    struct first_error *first = &run->batch.first_error;
    int ranks;
    MPI_Comm_size(MPI_COMM_WORLD, &ranks);
    if (run->cluster->rank > 0) {
        MPI_Send(first, sizeof *first, MPI_BYTE, 0, 0, MPI_COMM_WORLD);
        return;
    }
    for (int rank = 1; rank < ranks; rank++) {
        struct first_error other;
        MPI_Recv(&other, sizeof other, MPI_BYTE, rank, 0, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
        if (other.line && (!first->line || other.line < first->line)) {
            *first = other;
        }
    }
    batch_task_say_errors(&run->batch);
}

/* Rank 0 prints what all ranks found about where the poses lie and point. */
static void say_astray(struct run *run)
{
    struct batch_task *batch = &run->batch;
    int ranks;
    batch_task_find_astray(batch);
    MPI_Comm_size(MPI_COMM_WORLD, &ranks);
    for (size_t i = 0; i < batch->atlases.count; i++) {
        if (run->cluster->rank > 0) {
            MPI_Send(&batch->aimed[i].found, sizeof batch->aimed[i].found, MPI_BYTE, 0, 0, MPI_COMM_WORLD);
        }
        for (int rank = 1; rank < ranks && run->cluster->rank == 0; rank++) {
            conus_astray more;
            MPI_Recv(&more, sizeof more, MPI_BYTE, rank, 0, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
            add_astray(&batch->aimed[i].found, &more);
        }
    }
    if (run->cluster->rank == 0) {
        batch_task_say_astray(batch);
    }
}

/* Answers all parts; rank 0 also prints the findings and finishes the file. */
static int answer_all(struct run *run)
{
    bool leads = run->cluster->rank == 0;
    uint32_t block = run->batch.settings->block;
    run->part_poses = (uint64_t)BLOCKS_PER_PART * (block ? block : DEFAULT_BLOCK);
    if (leads) {
        batch_task_start_progress(&run->batch);
    }
    interrupt_catch(NULL); /* nothing waits for poses: they are files */
    answer_parts(run);
    if (leads) {
        ordered_file_wait(&run->file);
        progress_finish(&run->batch.progress, run->batch.file.poses, run->batch.file.errors);
    }
    if (leads && run->file.stop >= 128) { /* first, since the others may be there no more */
        batch_task_interrupted(&run->batch, run->file.stop - 128);
    }
    int code = agree(ordered_file_close(&run->file));
    if (!code) { /* all ranks must have read the file that rank 0 began with */
        MPI_Bcast(run->batch.pose_hash, sizeof run->batch.pose_hash, MPI_CHAR, 0, MPI_COMM_WORLD);
        code = agree(batch_task_check_poses(&run->batch));
        if (code && leads) {
            batch_file_disown(&run->batch.file);
        }
    }
    if (!code) {
        say_errors(run);
        say_astray(run);
    }
    if (leads && !code) {
        if (!run->batch.file.poses && run->batch.shard.count == 1) {
            pose_settings_say_none(run->batch.settings->poses, &run->batch.settings->common);
        }
        code = batch_task_finish_output(&run->batch);
    }
    return code;
}

/* Runs on all ranks. The exit code is rank 0's, unless another rank fails. */
static int answer_batch(const struct cluster *cluster, const struct batch_settings *settings,
                        const struct arguments *arguments)
{
    struct run run = {.cluster = cluster, .batch.file = {.rows = -1, .log = -1}};
    struct batch_settings own = *settings;
    own.threads = settings->threads ? settings->threads : 1; /* ranks are the processors */
    own.common.quiet = settings->common.quiet || cluster->rank > 0;
    own.common.verbose = settings->common.verbose && cluster->rank == 0;
    if (cluster->rank > 0) {
        warnings_mute();
    }
    int code = open_batch(&run, &own, arguments);
    size_t shared = 0;
    for (size_t i = 0; !code && i < run.batch.atlases.count; i++) {
        shared += run.shared[i].memory ? run.shared[i].size : 0;
    }
    if (own.common.verbose && shared) {
        print_error_line("atlas: %zu bytes, in memory once for all processes of a node", shared);
    }
    code = code ? code : open_output(&run);
    if (!code && !run.batch.file.is_finished) {
        code = answer_all(&run);
    } else if (!code && cluster->rank == 0) {
        batch_task_say_errors(&run.batch);
    }
    code = code || !run.batch.file.errors ? code : EXIT_DIFFERENT;
    free(run.text);
    batch_task_finish(&run.batch);
    for (size_t i = 0; run.shared && i < 1 + settings->atlas.more.count; i++) { /* after the batch, which uses them */
        node_atlas_finish(&run.shared[i]);
    }
    free(run.shared);
    return code;
}

/* The words by which rank 0 announces a batch to the others. */
enum { ATLAS, POSES, OUTPUT, SHARD, ROWS, WORD_COUNT };

/* Words without an atlas end the ranks' work. */
static void announce(const char *const words[WORD_COUNT])
{
    for (int i = 0; i < WORD_COUNT; i++) {
        int size = words[i] ? (int)strlen(words[i]) + 1 : 0; /* with the final NUL; 0 = none */
        MPI_Bcast(&size, 1, MPI_INT, 0, MPI_COMM_WORLD);
        MPI_Bcast((void *)words[i], size, MPI_CHAR, 0, MPI_COMM_WORLD);
    }
}

/* Waits for rank 0; false when there is nothing more to answer. The words are the caller's to free. */
static bool receive_words(char *words[WORD_COUNT])
{
    for (int i = 0; i < WORD_COUNT; i++) {
        int size;
        MPI_Bcast(&size, 1, MPI_INT, 0, MPI_COMM_WORLD);
        words[i] = size ? malloc((size_t)size) : NULL;
        if (size && !words[i]) {
            print_error_line("not enough memory");
            MPI_Abort(MPI_COMM_WORLD, EXIT_DATA);
        }
        MPI_Bcast(words[i], size, MPI_CHAR, 0, MPI_COMM_WORLD);
    }
    return words[ATLAS];
}

/* On rank 0: answers with all ranks. */
static int lead(void *user, const struct batch_settings *settings, const struct arguments *arguments)
{
    const struct cluster *cluster = user;
    struct batch_settings own = *settings;
    char text[64];
    struct shard shard;
    if (!settings->output || output_is_stdout(settings->output) || poses_are_no_file(settings->poses)) {
        return print_usage_error("conus-mpi batch needs files for --poses and --%s",
                                 settings->of_axis ? settings->of_axis->option : "output");
    }
    int code = batch_shard(&shard, settings);
    if (code) {
        return code;
    }
    snprintf(text, sizeof text, "%" PRIu64 "/%" PRIu64, shard.index, shard.count);
    own.shard = text;
    const char *const words[WORD_COUNT] = {arguments->operands[0], own.poses, own.output, own.shard,
                                           own.of_axis ? own.of_axis->option : NULL};
    announce(words);
    return answer_batch(cluster, &own, arguments);
}

/* On the others: answers what is announced. */
static void follow(const struct cluster *cluster, const struct batch_settings *settings,
                   const struct arguments *arguments)
{
    char *words[WORD_COUNT];
    while (receive_words(words)) {
        struct batch_settings own = *settings;
        struct arguments aimed = *arguments;
        aimed.operands[0] = words[ATLAS];
        own.poses = words[POSES];
        own.output = words[OUTPUT];
        own.shard = words[SHARD];
        for (size_t i = 0; i < AXIS_FILES && words[ROWS]; i++) {
            bool is_it = strcmp(settings_axis_rows[i].option, words[ROWS]) == 0;
            own.of_axis = is_it ? &settings_axis_rows[i] : own.of_axis;
        }
        answer_batch(cluster, &own, &aimed);
        for (int i = 0; i < WORD_COUNT; i++) {
            free(words[i]);
        }
    }
}

static const struct command batch = {
    .program = "conus-mpi",
    .name = "batch",
    .summary = "answer a file of poses on all ranks of an MPI job",
    .operands = {"ATLAS"},
    .form = "--poses FILE -o FILE",
    .description =
        "As conus batch, whose file it writes byte for byte, started by mpirun or srun. Each rank answers with\n"
        "one thread unless --threads says otherwise; the ranks of a node share one atlas in memory.",
    .examples = "  mpirun -n 16 conus-mpi batch aal.nii.gz --poses poses.tsv -o rows.tsv\n"
                "  mpirun -n 16 conus-mpi batch aal.nii.gz --poses poses.tsv -o rows.tsv --resume\n",
    .groups = batch_groups,
    .settings_size = sizeof(struct batch_settings),
    .more_help = help_scores,
};

enum { CONTINUE = -1 };

static int read_command(struct arguments *arguments, struct batch_settings *settings, int count, char **words)
{
    const char *word = count > 1 ? words[1] : "";
    bool named = strcmp(word, batch.name) == 0;
    if (!named && strcmp(word, "--help") != 0 && strcmp(word, "-h") != 0 && strcmp(word, "--version") != 0) {
        *arguments = (struct arguments){.command = &batch};
        return print_usage_error("the only command is conus-mpi batch; conus-mpi --help explains it");
    }
    return options_parse(arguments, settings, &batch, NULL, count, words, named ? 2 : 1);
}

/* Rank 0 prints what is wrong with the command line; the others wait for it. */
static int answer_command(const struct cluster *cluster, int count, char **words)
{
    struct arguments arguments = {.command = &batch};
    struct batch_settings settings = {0};
    int code = cluster->rank == 0 ? read_command(&arguments, &settings, count, words) : CONTINUE;
    MPI_Bcast(&code, 1, MPI_INT, 0, MPI_COMM_WORLD);
    if (code == CONTINUE && cluster->rank == 0) {
        code = outputs_begin(&arguments);
        code = code ? code : batch_dispatch(&settings, &arguments, lead, (void *)cluster);
        announce((const char *const[WORD_COUNT]){NULL});
    } else if (code == CONTINUE) {
        code = read_command(&arguments, &settings, count, words);
        follow(cluster, &settings, &arguments);
    }
    MPI_Bcast(&code, 1, MPI_INT, 0, MPI_COMM_WORLD);
    options_finish(&settings, &arguments);
    return code;
}

int main(int argc, char **argv)
{
    static const struct command *const commands[] = {&batch, NULL};
    static const struct program program = {.name = "conus-mpi", .commands = commands};
    int provided, code;
    struct cluster cluster;
    system_begin(&argc, &argv, false); /* a file that may not grow is an error of writing */
    if (pages_answer(&code, &program, argc, argv)) {
        return code;
    }
    MPI_Init_thread(&argc, &argv, MPI_THREAD_FUNNELED, &provided);
    MPI_Comm_rank(MPI_COMM_WORLD, &cluster.rank);
    MPI_Comm_split_type(MPI_COMM_WORLD, MPI_COMM_TYPE_SHARED, cluster.rank, MPI_INFO_NULL, &cluster.node);
    MPI_Comm_rank(cluster.node, &cluster.node_rank);
    code = answer_command(&cluster, argc, argv);
    MPI_Comm_free(&cluster.node);
    MPI_Finalize();
    return output_finish(code);
}
