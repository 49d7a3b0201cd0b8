/* SPDX-License-Identifier: BSD-3-Clause */
/* conus_pose_stream: detects the format, then reads rows line by line or, of some formats, all at once. A list is all
 * rows of a stream. */
#include "poses/pose_stream.h"

#include "base/child/hdf5.h"
#include "base/formats/encoding.h"
#include "base/formats/matlab.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "base/options.h"
#include "base/path.h"
#include "base/system/system.h"
#include "base/text.h"
#include "conus/own.h"
#include "poses/programs/pose_programs.h"
#include "poses/rows/columns.h"
#include "poses/rows/pose_row.h"
#include "sources/source.h"

#include <errno.h>
#include <math.h>
#include <string.h>

void pose_matrix_parse(struct pose_reading *to, struct text text)
{
    conus_pose_row row = pose_row_at(1);
    conus_status bad = CONUS_OK;
    if (!columns_plain_matrix(&row, &bad, text, to->options)) {
        job_bad(to->job, "numbers, but neither the 16 of a matrix nor lines of x y z and a name");
    }
    pose_add(to, &row, text_from(""), bad ? conus_message() : NULL);
}

#define READ_BY_LINES(id, word) {word, NULL},
#define READ_WHOLE(id, word, parse) {word, parse},
static const struct {
    const char *name;
    void (*parse)(struct pose_reading *to, struct text text);
} formats[] = {POSE_FORMAT_ROWS(READ_BY_LINES, READ_WHOLE)};

enum { FORMATS = sizeof formats / sizeof formats[0] };

const char *conus_pose_format_name(size_t index)
{
    return index < FORMATS ? formats[index].name : NULL;
}

struct extent {
    size_t count;
    double low[3], high[3]; /* mm. */
    double farthest;        /* Largest distance from the origin, mm. */
};

static const double HEAD_LENGTH = 180;                      /* mm, where the atlas's longest edge is not known */
static const double NEAR_ORIGIN = 1, NEAR_EACH_OTHER = 0.2; /* mm */
enum { LEAST = 3 };                                         /* positions that say something by lying near each other */

static void extent_add(struct extent *extent, const conus_pose_row *row)
{
    const double *p = row->pose.world_from_device + 12;
    if (row->error) {
        return;
    }
    for (int a = 0; a < 3; a++) {
        extent->low[a] = extent->count ? fmin(extent->low[a], p[a]) : p[a];
        extent->high[a] = extent->count ? fmax(extent->high[a], p[a]) : p[a];
    }
    extent->farthest = fmax(extent->farthest, vec3_length(p));
    extent->count++;
}

enum { NAMES_COMPARED = 1 << 18 }; /* rows; their names are held until the stream ends */
enum { HEAD_ROWS = 64 };

struct row_names {
    struct buffer text; /* each with a zero behind it */
    size_t count;
};

/* Of rows with the name of an earlier one the first, and how many there are. Forgets the names. */
static conus_status note_equal_names(struct notes *notes, struct row_names *names)
{
    conus_status status = buffer_status(&names->text);
    struct name_set known = {0};
    const char *at = names->text.data;
    const char *first = NULL; /* the first name that is there again, in these rows */
    size_t rows[2] = {0};
    size_t repeated = 0;
    for (size_t i = 0; i < names->count && !status; at += strlen(at) + 1, i++) {
        const struct known_name *earlier = name_set_find(&known, at);
        if (earlier && !repeated++) {
            first = at;
            rows[0] = earlier->value + 1;
            rows[1] = i + 1;
        }
        status = earlier ? CONUS_OK : name_set_add(&known, at, i);
    }
    if (first && !status) {
        status =
            notes_add(notes, "poses %zu and %zu are both called \"%.60s\"; %zu of %zu have the name of an earlier one",
                      rows[0], rows[1], first, repeated, names->count);
    }
    name_set_finish(&known);
    buffer_finish(&names->text);
    *names = (struct row_names){0};
    return status;
}

/* Lines that were read and are no rows. */
struct passed {
    size_t count, first; /* the first one's number */
};

enum { INWARD_POSITION = CONUS_INWARD_ATLAS + 1 };

struct conus_pose_stream {
    conus_pose_options options; /* with a frame, this: */
    conus_frame frame;
    enum pose_format format, asked; /* what it is, and what the options say */
    char *name;                     /* for messages; NULL for a text */
    char *typed;                    /* with its words; NULL for a text */
    const char *path;               /* while it is opened; NULL for a text and stdin */
    int descriptor;                 /* -1 for a text */
    bool owned;                     /* it is ours to close */
    struct system_wake stop;        /* of a pipe: once the stream is stopped; of others none */
    uint64_t start;                 /* of the text in the file */
    struct text text;
    struct pose_lines lines;
    struct columns columns;
    struct columns_words words; /* of options.columns */
    char *decoded;              /* a line that is no UTF-8, as UTF-8 */
    bool is_windows;            /* there was one */
    struct passed passed[LINE_KINDS];
    conus_pose_list block; /* rows of the last block that were read line by line or made */
    struct pose_candidates candidates;
    conus_pose_list list; /* rows of a format that is read whole, and all notes */
    uint64_t taken;       /* rows read or passed over */
    struct extent extent; /* of the rows read, */
    bool is_partial;      /* some of which were passed over */
    struct {
        bool has_times, has_angles, has_ranges, has_points;
    } whole; /* some of the rows, of a format that is read whole */
    struct row_names names;
    struct named_rows places;
    size_t inward[INWARD_POSITION + 1]; /* rows that point into the head, by what */
    conus_pose_list head;               /* the first rows that were read line by line */
};

/* The first bytes that are there. */
static struct text at_hand(const struct pose_lines *lines)
{
    return (struct text){lines->data, lines->size < POSE_LINE_LIMIT ? lines->size : POSE_LINE_LIMIT};
}

static conus_status fail_of(const conus_pose_stream *stream, conus_status status)
{
    return status && stream->name ? fail_in(status, stream->name) : status;
}

/* A text that is no UTF-8 is one of Windows-1252, as spreadsheets write it; of other bytes it stays as it is. */
static conus_status decode(struct text *text, conus_pose_stream *stream, struct notes *notes)
{
    if (text_is_utf8(*text) || memchr(text->data, '\0', text->size)) {
        return CONUS_OK;
    }
    memory_free(stream->decoded);
    stream->decoded = NULL;
    conus_status status = encoding_decode(&stream->decoded, text, NULL);
    if (stream->decoded && !stream->is_windows) {
        stream->is_windows = true;
        status = notes_add(notes, "the text is not UTF-8: it is read as Windows-1252");
    }
    return status == CONUS_ERROR_DATA ? CONUS_OK : status;
}

/* The lines that are there, without one that is not whole. */
static struct text whole_lines(const struct pose_lines *lines)
{
    struct text head = at_hand(lines);
    bool is_all = lines->ended && head.size == lines->size;
    while (!is_all && head.size && !strchr("\r\n", head.data[head.size - 1])) {
        head.size--;
    }
    return head.size ? head : at_hand(lines);
}

/* Whether all numbers of a text are the sixteen of a matrix, in one line or in four. */
static bool is_matrix(struct text text)
{
    conus_pose_row row = pose_row_at(1);
    conus_status bad;
    const conus_frame ras = {.space = CONUS_SPACE_RAS};
    return columns_plain_matrix(&row, &bad, text, &(conus_pose_options){.frame = &ras});
}

/* The first line that is no comment; empty where there is none, or, unless that is @p all there is, no whole one. Up to
 * it there are so many bytes. */
static struct text first_row(size_t *size, struct text head, bool all)
{
    struct text rest = head;
    struct text line = {"", 0};
    bool is_comment = true;
    while (is_comment && text_line(&rest, &line)) {
        struct text trimmed = text_trim(line);
        is_comment = !trimmed.size || trimmed.data[0] == '#';
    }
    *size = line.size ? (size_t)(line.data + line.size - head.data) : 0;
    bool is_whole = !is_comment && (all || *size < head.size);
    return is_whole ? text_trim(line) : (struct text){"", 0};
}

/* Of the head, whose first row that is. */
static enum pose_format format_of(const struct format *known, struct text row)
{
    enum pose_format format = POSE_FORMAT_AUTO;
    while (known && known->poses && strcmp(formats[format].name, known->poses) != 0) { /* a row's is one of these */
        format++;
    }
    return format                                           ? format
           : row.size && pose_electrodes_header(row, false) ? POSE_FORMAT_ELECTRODES
           : row.size && pose_nibs_header(row)              ? POSE_FORMAT_NIBS
                                                            : POSE_FORMAT_TABLE;
}

static void find_format(struct job *job, conus_pose_stream *stream)
{
    struct pose_lines *lines = &stream->lines;
    const struct format *known = NULL;
    struct text row = {"", 0};
    size_t used = 0;
    (void)JOB_CALL(job, columns_words_parse(&stream->words, stream->options.columns));
    (void)JOB_CALL(job, pose_lines_fill(lines, POSE_LINE_LIMIT, true));
    for (bool all = false; job_ok(job) && !all && !row.size && !(known && known->poses);) {
        const struct text head = at_hand(lines);
        const struct file_head of_file = head_of(NULL, &(struct bytes){(uint8_t *)head.data, head.size});
        all = lines->ended || lines->size >= POSE_LINE_LIMIT;
        row = first_row(&used, head, all);
        known = format_find(&of_file, ROLE_POSES);
        if (!all && !row.size && !(known && known->poses)) {
            (void)JOB_CALL(job, pose_lines_fill(lines, lines->size + 1, false));
        }
    }
    if (!job_ok(job)) {
        return;
    }
    const struct text head = at_hand(lines);
    bool is_binary = known && (known->id == FORMAT_MATLAB || known->id == FORMAT_HDF5);
    struct text rest = head;
    struct text first = {"", 0};
    (void)text_line(&rest, &first);
    used = is_binary ? 0 : known ? first.size : used;
    enum pose_format found = format_of(known, row);
    if (found == POSE_FORMAT_ELECTRODES &&
        pose_electrodes_header(row, true)) { /* is it BIDS that says what they are? */
        pose_coordsystem_find(job, &stream->list, stream->path ? stream->path : "", false, false);
        found = stream->list.coordsystem ? found : POSE_FORMAT_TABLE;
    }
    bool is_own_word = stream->words.at[0].size && !pose_brackets_are_rows(head); /* the user knows the columns */
    if (!is_own_word && pose_lists_know(head, stream->path)) {
        found = POSE_FORMAT_LIST;
    } else if (known && !known->poses) {
        job_bad(job, "%s", known->words);
    } else if (used && memchr(head.data, '\0', used)) {
        job_bad(job, "a zero byte: not a text of poses");
    }
    bool is_short = lines->ended && lines->size < POSE_LINE_LIMIT;
    found = found == POSE_FORMAT_TABLE && is_short && is_matrix(head) ? POSE_FORMAT_MATRIX : found;
    stream->format = stream->asked ? stream->asked : found;
}

/* A table that is called as those of BIDS is in the space and unit of the *_coordsystem.json beside it. */
static void begin_coordsystem(struct job *job, conus_pose_stream *stream)
{
    conus_pose_list *list = &stream->list;
    if (stream->path) {
        pose_coordsystem_find(job, list, stream->path, false, false);
    }
    bool is_ras = list->space.brain != POSE_BRAIN_UNKNOWN && list->space.brain != POSE_BRAIN_OTHER;
    if (!list->coordsystem) {
        return;
    }
    stream->columns.beside_mm = list->space.scale;
    if (is_ras && stream->options.space == CONUS_SPACE_LPS) {
        pose_note_space(job, &stream->options, false);
        stream->frame = (conus_frame){.space = CONUS_SPACE_RAS};
        stream->options.space = CONUS_SPACE_RAS;
    }
}

/* What it says and what the table says are one. */
static void end_coordsystem(struct job *job, conus_pose_stream *stream)
{
    conus_pose_list *list = &stream->list;
    struct columns *columns = &stream->columns;
    const struct pose_space *said = &columns->said.space;
    bool is_other = said->brain && said->brain != list->space.brain;
    bool is_turned = columns->space == CONUS_SPACE_LPS && stream->options.space == CONUS_SPACE_RAS;
    if (!stream->options.any_space && (is_other || is_turned)) {
        job_bad(job, "\"%s\" is said in it, and \"%s\" by %s: in which space are the positions?",
                is_other ? said->name : "LPS", list->space.name, path_base(list->coordsystem));
    }
    if (space_moves(&list->space, &stream->options) && !columns->moves) {
        columns->moves = true;
        space_note_move(job, &list->space);
    }
    list->space.brain = columns->moves ? POSE_BRAIN_MNI152 : list->space.brain;
}

/* By as much as tells what the columns are: of a pipe that is silent behind its header perhaps the header alone. */
static void plan_table(struct job *job, conus_pose_stream *stream)
{
    struct pose_lines *lines = &stream->lines;
    struct columns *columns = &stream->columns;
    (void)JOB_CALL(job, pose_lines_fill(lines, POSE_LINE_LIMIT, true));
    begin_coordsystem(job, stream);
    bool is_short = true;
    bool is_decided = false;
    columns->side = sides_of_file(stream->path);
    while (job_ok(job) && !is_decided) {
        struct text head = whole_lines(lines);
        struct text rest = head;
        bool is_full = lines->size >= POSE_LINE_LIMIT;
        bool all = lines->ended || is_full;
        bool is_empty = all && !table_next_line(&rest, &(struct text){0}, NULL);
        bool is_one_line =
            head.size >= POSE_LINE_LIMIT && !memchr(head.data, '\n', head.size) && !memchr(head.data, '\r', head.size);
        if ((is_empty || is_one_line) && is_full) {
            job_bad(job, "header: a line of more than %d bytes", POSE_LINE_LIMIT);
        } else if (is_empty || is_one_line) {
            job_bad(job, "no poses: " POSE_FORMATS " is needed");
        }
        (void)JOB_CALL(job, decode(&head, stream, &job->notes));
        const struct attempt attempt = job_try(job);
        columns_plan(job, columns, &is_short, head, &stream->options);
        bool is_planned = job_ok(job) && !columns->place;
        is_decided = all || !is_short || is_planned;
        (void)attempt_end(job, &attempt, is_decided ? ATTEMPT_KEEP : ATTEMPT_DROP);
        if (!is_decided) {
            (void)JOB_CALL(job, pose_lines_fill(lines, lines->size + 1, false));
        }
    }
    columns_check_name(job, columns, stream->path, whole_lines(lines), &stream->options, stream->list.coordsystem);
    if (stream->list.coordsystem) {
        end_coordsystem(job, stream);
    } else if (!stream->list.space.name[0]) {
        stream->list.space = columns_space(columns);
    }
    bool is_silent = !stream->list.coordsystem && !stream->list.space.name[0] && !columns->place;
    if (is_silent && stream->path && stream->options.space < CONUS_SPACE_CCF && !stream->options.any_space) {
        pose_coordsystem_hear_name(job, &stream->list, stream->path);
        (void)(!stream->list.space.name[0] &&
               pose_coordsystem_hear(job, &stream->list, stream->path, columns->has_unit));
    }
    stream->format = !columns->has_header ? POSE_FORMAT_POINTS : columns->pairs ? POSE_FORMAT_LIST : stream->format;
}

static bool is_read_whole(const conus_pose_stream *stream)
{
    return formats[stream->format].parse != NULL;
}

/* How many rows there are, where that is known at once: UINT64_MAX of lines. */
static uint64_t count_known(const conus_pose_stream *stream)
{
    return is_read_whole(stream)      ? stream->list.count
           : stream->candidates.count ? stream->candidates.count
                                      : UINT64_MAX;
}

static bool is_of_rodents(enum pose_format format)
{
    return format == POSE_FORMAT_IBL || format == POSE_FORMAT_NWB || format == POSE_FORMAT_LIST;
}

/* Points whose names say a side on which they do not lie, of an atlas whose size is known. Of tables columns.c asks; of
 * somebody's own scan the middle is not known. */
static void check_sides(struct job *job, conus_pose_stream *stream)
{
    const conus_pose_list *list = &stream->list;
    const conus_pose_options *options = &stream->options;
    struct sides sides = {0};
    bool is_own = list->space.brain == POSE_BRAIN_SUBJECT || list->space.brain >= POSE_BRAIN_FRAME;
    if (is_own || !(options->longest > 0) || options->space >= CONUS_SPACE_CCF || stream->words.any_sides) {
        return;
    }
    for (size_t i = 0; i < list->count; i++) {
        const conus_pose_row *row = &list->rows[i];
        const struct text name = text_from(row->id);
        if (row->is_point && !row->error) {
            sides_count(&sides, sides_of_name(name), name, row->pose.world_from_device[12], options->longest / 36);
        }
    }
    sides_check(job, &sides, "are x and y in another space than the file says, or --space?", stream->columns.file);
    sides_warn(job, &sides, sides_of_file(stream->path));
}

/* Warns where a head in metres would be as small: all positions lie within 1 mm of the origin, but not at it, or three
 * and more within 0.2 mm of each other. In the CCF, from bregma and in IBL's files the positions of a probe are as near
 * to each other. */
static conus_status note_extent(conus_pose_stream *stream, struct notes *notes)
{
    const struct extent extent = stream->extent;
    stream->extent = (struct extent){0};
    bool is_list = stream->format == POSE_FORMAT_LIST; /* of people or of rodents, as the caller says */
    bool of_people = stream->options.space < CONUS_SPACE_CCF && (is_list || !is_of_rodents(stream->format));
    const double longest = fmax(stream->options.longest, HEAD_LENGTH);
    bool is_stated = !is_read_whole(stream) && stream->columns.has_unit; /* columns.c asks the others */
    if (!of_people || stream->is_partial || is_stated) {
        return CONUS_OK;
    }
    double side = 0;
    for (int a = 0; a < 3; a++) {
        side = fmax(side, extent.high[a] - extent.low[a]);
    }
    bool near_origin = extent.farthest > 0 && extent.farthest <= NEAR_ORIGIN;
    bool near_each_other = extent.count >= LEAST && side > 0 && side <= NEAR_EACH_OTHER;
    bool is_far = is_list && extent.farthest > 10 * longest;
    if (is_far || (is_list && near_origin && extent.count >= LEAST)) {
        return fail(CONUS_ERROR_DATA,
                    "positions lie up to %.3g mm from the origin, as if they were in %s: save them in mm",
                    extent.farthest, is_far ? "micrometres" : "metres");
    }
    if (!near_origin && !near_each_other) {
        return CONUS_OK;
    }
    /* Says that they are in mm; "" if none does. */
    const char *source = path_base(conus_pose_list_facts(&stream->list).coordsystem);
    return notes_warn(notes, "all positions lie within %s, as if they were in metres; they are taken as mm%s%s%s",
                      near_origin ? "1 mm of the origin" : "0.2 mm of each other", source[0] ? ", as " : "", source,
                      source[0] ? " says" : "");
}

static void move_from_mni305(struct job *job, conus_pose_stream *stream)
{
    conus_pose_list *list = &stream->list;
    if (!space_moves(&list->space, &stream->options)) {
        return;
    }
    for (size_t i = 0; i < list->count; i++) {
        space_move_from_mni305(list->rows[i].pose.world_from_device + 12);
    }
    list->space.brain = POSE_BRAIN_MNI152;
    space_note_move(job, &list->space);
}

/* Lets a point look into the head. */
static conus_status turn_inward(conus_pose_row *row, conus_pose_stream *stream)
{
    const double *at = row->pose.world_from_device + 12;
    const double from[3] = {at[0], at[1], at[2]};
    double along[3] = {0 - row->normal[0], 0 - row->normal[1], 0 - row->normal[2]};
    conus_inward found = CONUS_INWARD_SURFACE;
    const bool is_position = !isnan(along[0]);
    conus_status status =
        !is_position ? conus_atlas_inward(along, &found, stream->options.atlas, from)
        : along[0] != 0 || along[1] != 0 || along[2] != 0
            ? CONUS_OK
            : fail(CONUS_ERROR_DATA, "the table of positions has no normal for it, which points into the head");
    status = status ? status : conus_pose_along(&row->pose, from, along, NULL);
    if (!status) {
        conus_frame_turn_pose(&row->pose, &stream->frame, false);
        row->is_point = false;
        stream->inward[is_position ? INWARD_POSITION : (size_t)found]++;
    }
    return status;
}

static conus_status note_inward(conus_pose_stream *stream)
{
    static const char *const words[] = {"the context's surfaces within 5 mm",
                                        "the head in the context's image within 5 mm",
                                        "the atlas's convex hull, to whose nearest point they look",
                                        "positions of a cap", "positions of a cap on the scalp"};
    conus_status status = CONUS_OK;
    for (size_t i = 0; i <= INWARD_POSITION && !status; i++) {
        status = !stream->inward[i] ? CONUS_OK
                                    : notes_add(&stream->list.notes, "%zu %s into the head, by %s", stream->inward[i],
                                                stream->inward[i] == 1 ? "row points" : "rows point",
                                                words[i == INWARD_POSITION && stream->options.scalp ? i + 1 : i]);
        stream->inward[i] = 0;
    }
    return status;
}

static void finish_buffer(void *buffer)
{
    buffer_finish(buffer);
}

/* Which program's binary file or JSON it is, which only the whole of it says. */
static void find_program(struct pose_reading *to, conus_pose_stream *stream, struct text text)
{
    const struct text json = pose_brackets_behind_comments(text);
    if (stream->asked || !job_ok(to->job)) {
        return;
    }
    if (matlab_is(text)) {
        stream->format = pose_lead_dbs_is(to, text) ? POSE_FORMAT_LEAD_DBS : stream->format;
    } else if (stream->format == POSE_FORMAT_MARKUPS && json.size && json.data[0] == '{') { /* no .fcsv */
        stream->format = pose_json_find(to, json);
    }
}

static void parse_whole(struct job *job, conus_pose_stream *stream, struct text text)
{
    conus_pose_list *list = &stream->list;
    const conus_space space = stream->options.space;
    struct pose_reading to = {.job = job, .list = list, .options = &stream->options, .path = stream->path};
    find_program(&to, stream, text);
    /* Positions in the CCF or from bregma are of tables, points, IBL and NWB; other programs' files are of people. */
    if (space >= CONUS_SPACE_CCF && !is_of_rodents(stream->format)) {
        job_bad(job, "positions of format %s are not in space %s, which tables, points, ibl and nwb may be",
                conus_pose_format_name(stream->format), conus_space_name((size_t)space));
    }
    if (job_ok(job)) {
        formats[stream->format].parse(&to, text);
    }
    move_from_mni305(job, stream);
    if (list->is_cap) {
        list->space.scale = stream->words.unit > 0 ? stream->words.unit : list->space.scale;
        (void)JOB_CALL(job, cap_check(list, stream->columns.file, &job->notes));
    }
    if (stream->format == POSE_FORMAT_ELECTRODES && job_ok(job)) {
        /* The table as it is, for an answer that adds columns to it. */
        if (text.size && memchr(text.data, '\0', text.size)) {
            job_bad(job, "a zero byte: not a table of electrodes");
            return;
        }
        list->electrodes = memory_text(text.data, text.size);
        (void)job_need(job, list->electrodes);
    }
}

static void read_whole(struct job *job, conus_pose_stream *stream)
{
    conus_pose_list *list = &stream->list;
    const enum pose_format format = stream->format;
    const bool pairs = stream->columns.pairs;
    bool is_bids = format == POSE_FORMAT_ELECTRODES || format == POSE_FORMAT_NIBS;
    if (stream->path && !pairs && (is_bids || format == POSE_FORMAT_LIST)) {
        pose_coordsystem_find(job, list, stream->path, is_bids, stream->words.unit > 0 || stream->options.unit > 0);
    }
    if (is_bids && !list->coordsystem) {
        columns_check_name(job, &stream->columns, stream->path, whole_lines(&stream->lines), &stream->options, false);
    }
    if (format == POSE_FORMAT_LIST && !pairs && list->coordsystem) {
        job_bad(job, "%s beside it is of a table with the columns x, y and z, which this is not",
                path_base(list->coordsystem));
    }
    struct buffer *bytes = job_new(job, struct buffer);
    if (!bytes) {
        return;
    }
    job_own(job, finish_buffer, bytes);
    (void)JOB_CALL(job, pose_lines_rest(bytes, &stream->lines, pose_memory(&stream->options)));
    struct text text = {bytes->data, bytes->size};
    if (!text_starts(text_trim(text), "<")) { /* XML says itself what its letters are */
        (void)JOB_CALL(job, decode(&text, stream, &job->notes));
    }
    if (pairs) {
        pairs_parse(&(struct pose_reading){.job = job, .list = list, .options = &stream->options}, &stream->columns,
                    text);
        return;
    }
    parse_whole(job, stream, text);
    for (size_t i = 0; i < list->count; i++) {
        extent_add(&stream->extent, &list->rows[i]);
    }
    check_sides(job, stream);
    (void)JOB_CALL(job, note_extent(stream, &job->notes));
    for (size_t i = 0; stream->options.inward && job_ok(job) && i < list->count; i++) {
        conus_pose_row *row = &list->rows[i];
        conus_status bad = row->error || !row->is_point ? CONUS_OK : turn_inward(row, stream);
        row->error = bad ? memory_text(conus_message(), strlen(conus_message())) : row->error;
        (void)job_need(job, bad == CONUS_ERROR_MEMORY || (bad && !row->error) ? NULL : list);
    }
}

static void open_text(struct job *job, conus_pose_stream *stream)
{
    (void)JOB_CALL(job, pose_lines_begin(&stream->lines, pose_memory(&stream->options)));
    find_format(job, stream);
    if (job_ok(job) && !is_read_whole(stream)) {
        plan_table(job, stream);
    }
    const bool is_whole = is_read_whole(stream);
    const char *format = conus_pose_format_name(stream->format);
    if (stream->options.along_shafts && stream->format != POSE_FORMAT_ELECTRODES) {
        job_bad(job,
                "shafts are for electrodes (BIDS: name, x, y, z, size, with tabs, in *_electrodes.tsv), not for %s%s",
                format,
                pose_electrodes_header(first_row(&(size_t){0}, at_hand(&stream->lines), true), true)
                    ? "; --poses-format electrodes reads it as these"
                    : "");
    }
    if (stream->options.keep_count && (is_whole || !stream->columns.has_header)) {
        job_bad(job, "only a table with a header has columns to be kept, and not %s", format);
    }
    const struct columns_words *words = &stream->words;
    bool of_columns = words->at[0].size || words->name.size || columns_word_of_axes(words).size;
    bool has_columns = !is_whole || stream->columns.pairs || stream->format == POSE_FORMAT_ELECTRODES ||
                       (stream->format == POSE_FORMAT_LIST &&
                        pose_brackets_are_rows((struct text){stream->lines.data, stream->lines.size}));
    if (words->place.size && !stream->columns.place) {
        job_bad(job, "\"%.60s\": names of places are read from tables and lists where an atlas is",
                stream->options.columns);
    }
    if (stream->options.scalp && !stream->columns.place) {
        job_bad(job, "--scalp is for names of a cap, like C3, and these are positions: take --scalp out");
    }
    if (job_ok(job) && is_whole) {
        read_whole(job, stream);
    }
    if ((of_columns || (words->unit > 0 && !stream->list.is_cap)) && !has_columns) {
        job_bad(job, "\"%.60s\" is for tables, points and electrodes (BIDS), and not for %s", stream->options.columns,
                format);
    }
    for (size_t i = 0; i < stream->list.count; i++) {
        const conus_pose_row *row = &stream->list.rows[i];
        stream->whole.has_times |= !isnan(row->time_s);
        stream->whole.has_angles |= row->angle != 0;
        stream->whole.has_ranges |= isfinite(row->range[1]);
        stream->whole.has_points |= row->is_point;
    }
    if (!stream->options.any_space) {
        pose_coordsystem_hear_name(job, &stream->list, stream->path);
    }
}

static conus_status begin_text(conus_pose_stream *stream)
{
    struct job job = {0};
    open_text(&job, stream);
    return job_close(&job, &stream->list.notes, NULL);
}

static conus_status fail_errno(const char *action)
{
    return fail(CONUS_ERROR_IO, "cannot %s: %s", action, text_error(errno));
}

static conus_status begin_file(conus_pose_stream *stream)
{
    struct system_stat info;
    if (!system_stat_open(&info, stream->descriptor)) {
        return fail_errno("read");
    }
    if (info.kind == SYSTEM_FOLDER) {
        return fail(CONUS_ERROR_IO, "cannot read: is a folder, a file is needed");
    }
    off_t at = info.kind == SYSTEM_FILE ? lseek(stream->descriptor, 0, SEEK_CUR) : -1;
    stream->start = at > 0 ? (uint64_t)at : 0;
    if (at < 0 && !system_wake_begin(&stream->stop)) {
        return fail_errno("read");
    }
    conus_status status = pose_lines_init(&stream->lines, stream->descriptor, at >= 0, stream->start);
    stream->lines.stop = stream->stop;
    return status ? status : begin_text(stream);
}

static bool is_stdin(const char *path)
{
    return !path || strcmp(path, "-") == 0;
}

static const char *pose_path_name(const char *path)
{
    return is_stdin(path) ? "standard input" : path;
}

static conus_status open_path(conus_pose_stream *stream, const char *path)
{
    size_t length = is_stdin(path) ? 0 : conus_pose_path_length(path);
    bool has_words = length && path[length];
    stream->name =
        has_words ? memory_text(path, length) : memory_text(pose_path_name(path), strlen(pose_path_name(path)));
    stream->typed = memory_text(path ? path : "-", strlen(path ? path : "-"));
    if (!stream->name || !stream->typed) {
        return CONUS_ERROR_MEMORY;
    }
    stream->columns.file = stream->typed;
    stream->options.columns = has_words ? path + length + 1 : stream->options.columns;
    stream->list.sink.path = stream->name;
    stream->path = is_stdin(has_words ? stream->name : path) ? NULL : stream->name;
    stream->descriptor = stream->path ? system_open(stream->path, SYSTEM_READ) : STDIN_FILENO;
    stream->owned = stream->path && stream->descriptor >= 0;
    conus_inputs_add(stream->path ? stream->path : "/dev/stdin");
    return fail_of(stream, stream->descriptor < 0 ? fail_errno("open") : begin_file(stream));
}

static conus_status create_stream(conus_pose_stream **out, const conus_pose_options *options)
{
    options = options_of(conus_pose_options, options);
    if (options->keep_count > POSE_KEPT_LIMIT) {
        return fail(CONUS_ERROR_ARGUMENT, "keep: %zu columns, allowed are up to %d", options->keep_count,
                    POSE_KEPT_LIMIT);
    }
    if ((unsigned)options->space > CONUS_SPACE_BREGMA || (unsigned)options->axis > CONUS_AXIS_MINUS_Z) {
        return fail(CONUS_ERROR_ARGUMENT, "options of poses: space or axis is none of its names");
    }
    size_t asked = 0;
    while (asked < FORMATS && strcmp(formats[asked].name, options->format ? options->format : "auto") != 0) {
        asked++;
    }
    if (asked == FORMATS) {
        return fail(CONUS_ERROR_ARGUMENT, "format: of poses there is no %s", options->format);
    }
    if (options->inward && !options->atlas) {
        return fail(CONUS_ERROR_ARGUMENT, "inward: no atlas, to which a head belongs");
    }
    if (options->frame && !conus_space_name((size_t)options->frame->space)) {
        return fail(CONUS_ERROR_ARGUMENT, "frame: its space is none");
    }
    conus_frame frame = options->frame ? *options->frame : (conus_frame){0};
    conus_status status = options->frame ? CONUS_OK : conus_frame_find(&frame, NULL, options->space, NULL);
    if (status) { /* the space needs an atlas */
        return status;
    }
    conus_pose_stream *stream = memory_zeroed(1, sizeof *stream);
    if (!stream) {
        return CONUS_ERROR_MEMORY;
    }
    stream->options = *options;
    stream->options.format = formats[asked].name; /* the caller's may end */
    stream->asked = (enum pose_format)asked;
    stream->frame = frame;
    stream->options.frame = &stream->frame;
    stream->options.space = frame.space;
    stream->columns.file = "FILE";
    stream->descriptor = -1;
    stream->stop.file = SYSTEM_NO_FILE;
    stream->lines.descriptor = -1;
    stream->list.sink = (struct note_sink){options->log, options->log_user, NULL};
    stream->list.notes.sink = &stream->list.sink;
    stream->list.is_counted = true;
    stream->list.max_memory = options->max_memory;
    *out = stream;
    return CONUS_OK;
}

static conus_status hand_over_stream(conus_pose_stream **out, conus_pose_stream *stream, conus_status status)
{
    if (status) {
        conus_pose_stream_destroy(stream);
    } else {
        *out = stream;
    }
    return status;
}

conus_status conus_pose_stream_open(conus_pose_stream **out, const char *path, const conus_pose_options *options)
{
    conus_pose_stream *stream = NULL;
    conus_status status = create_stream(&stream, options);
    return hand_over_stream(out, stream, status ? status : open_path(stream, path));
}

conus_status pose_stream_parse(conus_pose_stream **out, struct text text, const conus_pose_options *options)
{
    conus_pose_stream *stream = NULL;
    conus_status status = create_stream(&stream, options);
    if (!status) {
        stream->text = text;
        pose_lines_init_text(&stream->lines, text);
        status = begin_text(stream);
    }
    return hand_over_stream(out, stream, status);
}

conus_status conus_candidates_open(conus_pose_stream **out, const conus_candidates *candidates)
{
    conus_pose_stream *stream = NULL;
    conus_status status = create_stream(&stream, NULL);
    if (!status) {
        stream->format = POSE_FORMAT_TABLE;
        status = pose_candidates_init(&stream->candidates, candidates);
    }
    return hand_over_stream(out, stream, status);
}

void conus_pose_stream_destroy(conus_pose_stream *stream)
{
    if (!stream) {
        return;
    }
    if (stream->owned) {
        close(stream->descriptor);
    }
    if (stream->stop.file >= 0) {
        system_wake_end(&stream->stop);
    }
    pose_lines_finish(&stream->lines);
    pose_list_finish(&stream->block);
    pose_candidates_finish(&stream->candidates);
    pose_list_finish(&stream->list);
    pose_list_finish(&stream->head);
    buffer_finish(&stream->names.text);
    named_rows_finish(&stream->places);
    memory_free(stream->decoded);
    memory_free(stream->name);
    memory_free(stream->typed);
    memory_free(stream);
}

/* The strings live until the next block. */
static conus_status name_row(conus_pose_row *row, conus_pose_stream *stream, struct text id, const char *error)
{
    conus_status status = pose_list_add(&stream->block, row, id, error);
    *row = status ? *row : stream->block.rows[stream->block.count - 1];
    return status;
}

static conus_status make_row(conus_pose_row *out, conus_pose_stream *stream)
{
    char id[POSE_CANDIDATE_ID];
    conus_status bad = pose_candidates_row(out, id, &stream->candidates, stream->taken);
    return name_row(out, stream, text_from(id), bad ? conus_message() : NULL);
}

/* The next line that is a row, and that row where it is asked for, with *bad set to what is wrong with it. */
static conus_status next_row(conus_pose_row *row, struct pose_name *name, conus_status *bad, struct passed *passed,
                             conus_pose_stream *stream, struct pose_lines *lines, bool *found)
{
    for (;;) {
        struct pose_line line;
        conus_status status = pose_lines_next(lines, &line, found);
        status = status || !*found ? status : decode(&line.text, stream, &stream->list.notes);
        if (status || !*found) {
            return status;
        }
        if (row) {
            *row = pose_row_at(line.number);
            name->text = (struct text){"", 0};
            memset(name->kept, 0, stream->columns.kept_count * sizeof *name->kept);
        }
        if (line.too_long && !line.blank) {
            if (row) {
                *bad = fail(CONUS_ERROR_DATA, "a line of more than %d bytes", POSE_LINE_LIMIT);
            }
            return CONUS_OK;
        }
        enum columns_line kind =
            line.too_long ? LINE_NOTHING
                          : columns_read(row, name, bad, &stream->columns, line.text, line.number, &stream->options);
        if (passed && !line.too_long && (kind != LINE_ROW || *bad)) {
            status = columns_hear_late(&stream->columns, line.text, line.number, &stream->options);
        }
        if (status || kind == LINE_ROW) {
            return status;
        }
        if (passed && kind == LINE_OTHER) {
            return fail(CONUS_ERROR_DATA,
                        "line %zu: \"%.*s\": words again, as above a second table; one table is read, split the file",
                        line.number, POSE_QUOTE(line.text));
        }
        if (passed) {
            passed[kind].first = passed[kind].count++ ? passed[kind].first : line.number;
        }
    }
}

static conus_status read_row(conus_pose_row *out, conus_pose_stream *stream, bool *found)
{
    conus_pose_row row = {0};
    struct pose_name name;
    memset(name.kept, 0, stream->columns.kept_count * sizeof *name.kept);
    conus_status bad = CONUS_OK;
    conus_status status = next_row(&row, &name, &bad, stream->passed, stream, &stream->lines, found);
    if (!status && *found && !bad && stream->columns.place) {
        bad = named_rows_find(&row, &stream->places, &name, &stream->options, &stream->list.notes);
    }
    if (!status && *found && !bad && stream->options.inward && row.is_point) {
        bad = turn_inward(&row, stream);
    }
    status = bad == CONUS_ERROR_MEMORY ? bad : status;
    if (status || !*found) {
        return status;
    }
    char ordinal[POSE_ORDINAL_SIZE];
    const char *bad_id = pose_check_id(&name.text, ordinal, stream->taken + 1);
    status = name_row(&row, stream, name.text, bad ? conus_message() : bad_id);
    if (!status && stream->columns.kept_count) {
        status = pose_list_keep(&stream->block, name.kept, stream->columns.kept_count);
        row.kept = stream->block.rows[stream->block.count - 1].kept;
    }
    if (row.is_point) { /* for cones conus_pose_check_found() tells more */
        extent_add(&stream->extent, &row);
    }
    *out = row;
    return status;
}

/* What was passed over, at the end. Once. CONUS_ERROR_DATA where that is all there is. */
static conus_status note_passed(conus_pose_stream *stream)
{
    static const char *const kinds[LINE_KINDS] = {
        [LINE_ABSENT] = "rows without coordinates (n/a)", [LINE_CLOSING] = "rows called Mean, SD or Total",
        [LINE_AGAIN] = "lines that are the header again", [LINE_WORDS] = "lines without a number",
        [LINE_TITLE] = "titles above the rows",
    };
    conus_status status = CONUS_OK;
    for (size_t kind = 0; kind < LINE_KINDS; kind++) {
        const struct passed *passed = &stream->passed[kind];
        if (kinds[kind] && passed->count && !status) {
            status = stream->taken ? notes_add(&stream->list.notes, "%zu %s passed over, the first in line %zu",
                                               passed->count, kinds[kind], passed->first)
                                   : fail(CONUS_ERROR_DATA, "no poses: it has only %zu %s, the first in line %zu",
                                          passed->count, kinds[kind], passed->first);
        }
    }
    memset(stream->passed, 0, sizeof stream->passed);
    return status;
}

conus_status conus_pose_stream_read(conus_pose_row *rows, size_t *count, conus_pose_stream *stream, size_t capacity)
{
    size_t got = 0;
    bool found = true;
    conus_status status = capacity ? CONUS_OK : fail(CONUS_ERROR_ARGUMENT, "capacity: 0 rows, allowed is 1 or more");
    pose_list_clear(&stream->block);
    for (; !status && found && got < capacity; got += found, stream->taken += found) {
        conus_pose_row *row = &rows[got];
        const bool is_made = stream->candidates.count;
        found = stream->taken < count_known(stream);
        if (is_read_whole(stream)) {
            *row = found ? stream->list.rows[stream->taken] : *row;
        } else if (found) {
            status = is_made ? make_row(row, stream) : read_row(row, stream, &found);
        }
        found = found && !status;
        if (found && !is_made) {
            pose_row_end(row, &stream->options);
        }
        if (found && !is_made && stream->names.count < NAMES_COMPARED) {
            stream->names.count++;
            buffer_append(&stream->names.text, row->id, strlen(row->id) + 1);
        }
        if (found && !is_read_whole(stream) && stream->head.count < HEAD_ROWS) {
            status = pose_list_add(&stream->head, row, text_from(row->id), row->error);
        }
    }
    if (!status && !found) {
        status = note_extent(stream, &stream->list.notes);
        status = status ? status : note_passed(stream);
        status = status ? status : note_inward(stream);
        status = status ? status : note_equal_names(&stream->list.notes, &stream->names);
    }
    *count = status ? *count : got;
    return fail_of(stream, status);
}

conus_status conus_pose_stream_skip(conus_pose_stream *stream, uint64_t rows)
{
    conus_status status = CONUS_OK;
    stream->is_partial = stream->is_partial || rows;
    pose_list_clear(&stream->block);
    const uint64_t known = count_known(stream);
    if (known < UINT64_MAX) {
        stream->taken += rows < known - stream->taken ? rows : known - stream->taken;
        return CONUS_OK;
    }
    for (bool found = true; !status && found && rows; rows--) {
        status = next_row(NULL, NULL, NULL, NULL, stream, &stream->lines, &found);
        stream->taken += !status && found;
    }
    return fail_of(stream, status);
}

static conus_status count_again(uint64_t *count, conus_pose_stream *stream)
{
    struct pose_lines lines = {.descriptor = -1};
    conus_status status = CONUS_OK;
    *count = 0;
    if (stream->descriptor < 0) {
        pose_lines_init_text(&lines, stream->text);
    } else if (stream->lines.seekable) {
        status = pose_lines_init(&lines, stream->descriptor, true, stream->start);
        lines.state = stream->lines.state;
    } else {
        status = fail(CONUS_ERROR_UNSUPPORTED, "rows of a pipe cannot be counted before they are read");
    }
    status = status ? status : pose_lines_begin(&lines, pose_memory(&stream->options));
    for (bool found = true; !status && found; *count += found) {
        status = next_row(NULL, NULL, NULL, NULL, stream, &lines, &found);
        found = !status && found;
    }
    pose_lines_finish(&lines);
    return status;
}

conus_status conus_pose_stream_count(uint64_t *count, conus_pose_stream *stream)
{
    uint64_t rows = count_known(stream);
    conus_status status = rows < UINT64_MAX ? CONUS_OK : count_again(&rows, stream);
    *count = status ? *count : rows;
    return fail_of(stream, status);
}

conus_pose_facts conus_pose_stream_facts(const conus_pose_stream *stream)
{
    conus_pose_facts facts = conus_pose_list_facts(stream ? &stream->list : NULL);
    if (stream) {
        const struct columns *columns = &stream->columns;
        const bool is_whole = is_read_whole(stream);
        facts.format = formats[stream->format].name;
        facts.head = is_whole ? &stream->list : &stream->head;
        facts.is_live = stream->stop.file >= 0 && !is_whole;
        facts.has_times = is_whole ? stream->list.count == 0 || stream->whole.has_times : columns->has[ROLE_TIME];
        facts.has_angles = stream->options.aperture > 0 || stream->whole.has_angles ||
                           (columns->has[ROLE_ANGLE] && !columns->is_of_points);
        facts.has_ranges = stream->candidates.asked.to_target || stream->options.to_target || columns->has[ROLE_NEAR] ||
                           columns->has[ROLE_FAR] || columns->ends_at_target || columns->has[ROLE_DEPTH] ||
                           stream->whole.has_ranges;
        facts.has_radii = columns->has[ROLE_RADIUS];
        facts.has_points = is_whole ? stream->whole.has_points : columns->is_of_points && !stream->options.inward;
    }
    return facts;
}

void conus_pose_stream_stop(conus_pose_stream *stream)
{
    if (stream->stop.file >= 0) {
        system_wake(&stream->stop);
    }
}

bool conus_pose_stream_may_repeat_ids(const conus_pose_stream *stream)
{
    if (!is_read_whole(stream)) {
        return !stream->columns.has_header || stream->columns.has[ROLE_NAME] || stream->columns.has[ROLE_CONTACT];
    }
    struct name_set known = {0};
    bool repeated = false; /* or there is no memory */
    for (size_t i = 0; i < stream->list.count && !repeated; i++) {
        const char *id = stream->list.rows[i].id;
        repeated = name_set_find(&known, id) || name_set_add(&known, id, i);
    }
    name_set_finish(&known);
    return repeated;
}

uint64_t pose_stream_position(const conus_pose_stream *stream)
{
    return stream->taken;
}

size_t pose_stream_kept_count(const conus_pose_stream *stream)
{
    return stream->options.keep_count;
}

conus_status conus_pose_stream_sha256(char out[65], conus_pose_stream *stream)
{
    return fail_of(stream, stream->lines.seekable
                               ? pose_lines_sha256(out, &stream->lines)
                               : fail(CONUS_ERROR_UNSUPPORTED, "only a file has a SHA-256, a pipe has none"));
}

conus_status conus_pose_stream_match(conus_pose_stream *stream, const conus_atlas *atlas)
{
    return pose_space_match(&stream->list.notes, &stream->list.space, atlas);
}

const char *conus_pose_stream_note(const conus_pose_stream *stream, size_t index)
{
    return stream && index < stream->list.notes.count ? stream->list.notes.lines[index] : NULL;
}

conus_severity conus_pose_stream_note_severity(const conus_pose_stream *stream, size_t index)
{
    return notes_severity(&stream->list.notes, index);
}

static conus_status read_all(conus_pose_list *list, conus_pose_stream *stream)
{
    enum { BLOCK = 64 };
    conus_pose_list *whole = &stream->list;
    conus_pose_row rows[BLOCK];
    size_t count = 0;
    conus_status status = CONUS_OK;
    list->is_counted = true;
    list->max_memory = stream->options.max_memory;
    do {
        status = conus_pose_stream_read(rows, &count, stream, BLOCK);
        for (size_t i = 0; !status && i < count; i++) {
            struct kept_text kept[POSE_KEPT_LIMIT];
            status = fail_of(stream, pose_list_add(list, &rows[i], text_from(rows[i].id), rows[i].error));
            for (size_t k = 0; rows[i].kept && k < stream->columns.kept_count; k++) {
                kept[k] = (struct kept_text){text_from(rows[i].kept[k]), false};
            }
            status = status || !rows[i].kept ? status : pose_list_keep(list, kept, stream->columns.kept_count);
        }
    } while (!status && count);
    if (status) {
        return status;
    }
    list->space = whole->space;
    list->coordsystem = whole->coordsystem;
    whole->coordsystem = NULL;
    list->electrodes = whole->electrodes;
    whole->electrodes = NULL;
    status = pose_list_hear(list, &whole->sink);
    return status ? status : notes_move(&list->notes, &whole->notes);
}

/* All rows, with the space, notes and electrodes. Destroys the stream. */
static conus_status list_from_stream(conus_pose_list **out, conus_pose_stream *stream)
{
    conus_pose_list *list = memory_zeroed(1, sizeof *list);
    conus_status status = list ? read_all(list, stream) : CONUS_ERROR_MEMORY;
    conus_pose_stream_destroy(stream);
    if (status) {
        conus_pose_list_destroy(list);
        return status;
    }
    *out = list;
    return CONUS_OK;
}

conus_status pose_list_parse(conus_pose_list **out, struct text text, const conus_pose_options *options)
{
    conus_pose_stream *stream = NULL;
    conus_status status = pose_stream_parse(&stream, text, options);
    return status ? status : list_from_stream(out, stream);
}

conus_status conus_pose_list_load(conus_pose_list **out, const char *path, const conus_pose_options *options)
{
    conus_pose_stream *stream = NULL;
    conus_status status = conus_pose_stream_open(&stream, path, options);
    return status ? status : list_from_stream(out, stream);
}
