/* SPDX-License-Identifier: BSD-3-Clause */
/* conus_pose_stream: detects the format, then reads rows line by line or, of some formats, all at once. A list is all
 * rows of a stream. */
#include "poses/pose_stream.h"

#include "base/buffer.h"
#include "base/child/hdf5.h"
#include "base/formats/matlab.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "base/options.h"
#include "base/order.h"
#include "base/path.h"
#include "base/system/system.h"
#include "base/text.h"
#include "conus/file.h"
#include "poses/pose_candidates.h"
#include "poses/pose_table.h"
#include "poses/programs/pose_programs.h"
#include "poses/rows/pose_lines.h"
#include "poses/rows/pose_list.h"
#include "poses/rows/pose_row.h"

#include <errno.h>
#include <math.h>
#include <string.h>

static conus_status parse_matrix(conus_pose_list *list, struct text text, const conus_pose_options *options)
{
    conus_pose_row row = pose_row_at(1);
    conus_status bad = CONUS_OK;
    if (!pose_plain_matrix(&row, &bad, text, options)) {
        return fail(CONUS_ERROR_DATA, "numbers, but neither the 16 of a matrix nor lines of x y z and a name");
    }
    return pose_list_add(list, &row, text_from(""), bad ? conus_message() : NULL);
}

/* Formats by number. A parser reads a text as a whole (pose_programs.h); without one it is read line by line. */
static const struct {
    const char *name;
    conus_status (*parse)(conus_pose_list *list, struct text text, const conus_pose_options *options);
} formats[] = {
    [CONUS_POSE_FORMAT_AUTO] = {"auto", NULL},
    [CONUS_POSE_FORMAT_TABLE] = {"table", NULL},
    [CONUS_POSE_FORMAT_MATRIX] = {"matrix", parse_matrix},
    [CONUS_POSE_FORMAT_POINTS] = {"points", NULL},
    [CONUS_POSE_FORMAT_BRAINSIGHT] = {"brainsight", pose_brainsight_parse},
    [CONUS_POSE_FORMAT_LOCALITE] = {"localite", pose_localite_parse},
    [CONUS_POSE_FORMAT_ELECTRODES] = {"electrodes", pose_electrodes_parse},
    [CONUS_POSE_FORMAT_MARKUPS] = {"markups", pose_markups_parse},
    [CONUS_POSE_FORMAT_SIMNIBS] = {"simnibs", pose_simnibs_parse},
    [CONUS_POSE_FORMAT_NIBS] = {"nibs", pose_nibs_parse},
    [CONUS_POSE_FORMAT_INVESALIUS] = {"invesalius", pose_invesalius_parse},
    [CONUS_POSE_FORMAT_LEAD_DBS] = {"lead-dbs", pose_lead_dbs_parse},
    [CONUS_POSE_FORMAT_LEAD_DBS_NATIVE] = {"lead-dbs-native", pose_lead_dbs_parse_native},
    [CONUS_POSE_FORMAT_IBL] = {"ibl", pose_ibl_parse},
    [CONUS_POSE_FORMAT_NWB] = {"nwb", pose_nwb_parse},
};

enum { FORMATS = sizeof formats / sizeof formats[0] };

const char *conus_pose_format_name(size_t index)
{
    return index < FORMATS ? formats[index].name : NULL;
}

/* The format of a text whose first line of data this is. */
static conus_pose_format format_of(struct text line)
{
    struct text word;
    struct text rest = line;
    double number;
    if (line.data[0] == '<' || line.data[0] == '{') {
        return line.data[0] == '<' ? CONUS_POSE_FORMAT_LOCALITE : CONUS_POSE_FORMAT_MARKUPS;
    }
    return pose_is_point(line)                                        ? CONUS_POSE_FORMAT_POINTS
           : text_word(&rest, &word) && text_to_double(word, &number) ? CONUS_POSE_FORMAT_MATRIX
           : pose_electrodes_header(line)                             ? CONUS_POSE_FORMAT_ELECTRODES
           : pose_nibs_header(line)                                   ? CONUS_POSE_FORMAT_NIBS
                                                                      : CONUS_POSE_FORMAT_TABLE;
}

/* The format of the first line with data, which ends behind *used bytes; CONUS_POSE_FORMAT_AUTO while it is not `all`
 * there. JSON is CONUS_POSE_FORMAT_MARKUPS and MATLAB's binary CONUS_POSE_FORMAT_SIMNIBS, whichever program wrote it.
 */
static conus_pose_format guess_format(struct text text, bool all, size_t *used)
{
    const char *begin = text.data;
    const char *end = text.data + text.size;
    struct text line;
    bool is_hdf5 = hdf5_is((const uint8_t *)text.data, text.size);
    if (matlab_is(text) || is_hdf5) { /* which program wrote it is known when all of it is read */
        *used = 0;
        return matlab_is(text) ? CONUS_POSE_FORMAT_SIMNIBS : CONUS_POSE_FORMAT_NWB;
    }
    *used = text.size;
    while (text_line(&text, &line)) {
        struct text trimmed = text_trim(line);
        if (!all && line.data + line.size == end) {
            return CONUS_POSE_FORMAT_AUTO;
        }
        *used = (size_t)(line.data + line.size - begin);
        if (pose_brainsight_line(line) || pose_invesalius_line(line)) {
            return pose_brainsight_line(line) ? CONUS_POSE_FORMAT_BRAINSIGHT : CONUS_POSE_FORMAT_INVESALIUS;
        }
        if (pose_fcsv_line(line)) {
            return CONUS_POSE_FORMAT_MARKUPS;
        }
        if (trimmed.size && trimmed.data[0] != '#') {
            return format_of(trimmed);
        }
    }
    return all ? CONUS_POSE_FORMAT_TABLE : CONUS_POSE_FORMAT_AUTO;
}

/* Why a text with these first bytes holds no poses; NULL if they do not show that. */
static const char *why_no_poses(struct text text)
{
    static const struct {
        const char *bytes, *kind;
    } kinds[] = {
        {"\x1f\x8b", "packed by gzip: unpack it, or let gzip -dc write it to standard input"},
        {"\xfd"
         "7zXZ",
         "packed by xz: unpack it, or let xz -dc write it to standard input"},
        {"BZh", "packed by bzip2: unpack it, or let bzip2 -dc write it to standard input"},
        {"\x28\xb5\x2f\xfd", "packed by zstd: unpack it, or let zstd -dc write it to standard input"},
        {"PK\x03\x04", "a zip file or a spreadsheet: unpack it, or export it as text with tabs or commas"},
        {"\xd0\xcf\x11\xe0", "a spreadsheet: export it as text with tabs or commas"},
        {"(", "a table of the sites of SpikeGLX's probe (.imro) says which are on, and not where the probe lies"},
        {"channel_groups", "a layout of a probe's channels (.prb) says where they are on it, and not where it lies"},
        {"\xff\xfe", "UTF-16 text: save it as UTF-8"},
        {"\xfe\xff", "UTF-16 text: save it as UTF-8"},
    };
    for (size_t i = 0; i < sizeof kinds / sizeof kinds[0]; i++) {
        if (text_starts(text, kinds[i].bytes)) {
            return kinds[i].kind;
        }
    }
    return NULL;
}

/* Where `text` is a MAT-file of another program than SimNIBS, sets *format and reads it into the list, as its parser
 * does: of level 7.3 another process reads the file, which takes longer than the rest. */
static conus_status find_format_of_matlab(conus_pose_format *format, conus_pose_list *list, struct text text,
                                          const conus_pose_options *options)
{
    bool is_lead = false;
    conus_status status = matlab_is(text) ? pose_lead_dbs_find(&is_lead, list, text, options) : CONUS_OK;
    *format = is_lead ? CONUS_POSE_FORMAT_LEAD_DBS : *format;
    return status;
}

/* The box around positions. */
struct extent {
    size_t count;
    double low[3], high[3]; /* mm. */
    double farthest;        /* Largest distance from the origin, mm. */
};

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

/* The names of the rows read. */
struct row_names {
    struct buffer text; /* each with a zero behind it */
    size_t count;
};

struct row_name {
    const char *name;
    size_t row;
};

static int compare_row_names(const void *a, const void *b)
{
    return strcmp(((const struct row_name *)a)->name, ((const struct row_name *)b)->name);
}

/* Of rows with the name of an earlier one the first, and how many there are. Forgets the names. */
static conus_status note_equal_names(struct notes *notes, struct row_names *names)
{
    conus_status status = buffer_status(&names->text);
    struct row_name *sorted = status ? NULL : memory_raw(names->count + 1, sizeof *sorted);
    status = status || sorted ? status : CONUS_ERROR_MEMORY;
    const char *at = names->text.data;
    size_t count = status ? 0 : names->count;
    const struct row_name *first = NULL;
    size_t repeated = 0;
    for (size_t i = 0; i < count; at += strlen(at) + 1, i++) {
        sorted[i] = (struct row_name){at, i};
    }
    order_sort(sorted, count, sizeof *sorted, compare_row_names); /* rows of one name stay in order */
    for (size_t i = 1; i < count; i++) {
        if (strcmp(sorted[i - 1].name, sorted[i].name) == 0) {
            first = !first || sorted[i].row < first->row ? &sorted[i] : first;
            repeated++;
        }
    }
    if (first) {
        status = notes_add(notes,
                           "poses %zu and %zu are both called \"%.60s\"; %zu of %zu have the name of an earlier one, "
                           "and only their order tells their answers apart",
                           first[-1].row + 1, first->row + 1, first->name, repeated, count);
    }
    memory_free(sorted);
    buffer_finish(&names->text);
    *names = (struct row_names){0};
    return status;
}

struct conus_pose_stream {
    conus_pose_options options; /* with a frame, this: */
    conus_frame frame;
    conus_pose_format format;
    char *name;              /* for messages; NULL for a text */
    const char *path;        /* while it is opened; NULL for a text and stdin */
    int descriptor;          /* -1 for a text */
    bool owned;              /* it is ours to close */
    struct system_wake stop; /* of a pipe: once the stream is stopped; of others none */
    uint64_t start;          /* of the text in the file */
    struct text text;
    struct pose_lines lines;
    struct pose_table table;
    conus_pose_list block; /* rows of the last block that were read line by line or made */
    struct pose_candidates candidates;
    conus_pose_list list; /* rows of a format that is read whole, and all notes */
    uint64_t taken;       /* rows read or passed over */
    struct extent extent; /* of the rows read, */
    bool is_partial;      /* some of which were passed over */
    struct row_names names;
};

static conus_status fail_of(const conus_pose_stream *stream, conus_status status)
{
    return status && stream->name ? fail_in(status, stream->name) : status;
}

/* Reads no more than it needs, so that it finds the same format in whatever pieces the text arrives. */
static conus_status find_format(conus_pose_stream *stream)
{
    struct pose_lines *lines = &stream->lines;
    conus_status status = CONUS_OK;
    conus_pose_format found = CONUS_POSE_FORMAT_AUTO;
    size_t used = 0;
    while (!status && found == CONUS_POSE_FORMAT_AUTO) {
        bool all = lines->ended || lines->size >= POSE_LINE_LIMIT;
        size_t size = lines->size < POSE_LINE_LIMIT ? lines->size : POSE_LINE_LIMIT;
        found = guess_format((struct text){lines->data, size}, all, &used);
        if (found == CONUS_POSE_FORMAT_AUTO) {
            status = pose_lines_fill(lines, lines->size + 1);
        }
    }
    const char *kind = status ? NULL : why_no_poses((struct text){lines->data, lines->size});
    if (kind) {
        return fail(CONUS_ERROR_DATA, "%s", kind);
    }
    if (!status && used && memchr(lines->data, '\0', used)) {
        status = fail(CONUS_ERROR_DATA, "a zero byte: not a text of poses");
    }
    stream->format = stream->options.format ? stream->options.format : found;
    return status;
}

static conus_status skip_mark(struct pose_lines *lines)
{
    static const char mark[] = "\xef\xbb\xbf";
    enum { SIZE = sizeof mark - 1 };
    conus_status status = pose_lines_fill(lines, SIZE);
    if (!status && lines->size >= SIZE && memcmp(lines->data, mark, SIZE) == 0) {
        lines->data += SIZE;
        lines->size -= SIZE;
    }
    return status;
}

/* The next line that holds data. */
static conus_status next_line(struct pose_lines *lines, struct pose_line *line, bool *found)
{
    conus_status status = CONUS_OK;
    do {
        status = pose_lines_next(lines, line, found);
    } while (!status && *found && line->blank);
    return status;
}

static conus_status read_header(conus_pose_stream *stream)
{
    struct pose_line line;
    bool found = false;
    conus_status status = next_line(&stream->lines, &line, &found);
    if (status) {
        return status;
    }
    if (!found) {
        return fail(CONUS_ERROR_DATA, "no poses: " POSE_FORMATS " is needed");
    }
    return line.too_long ? fail(CONUS_ERROR_DATA, "header: a line of more than %d bytes", POSE_LINE_LIMIT)
                         : pose_table_header(&stream->table, &stream->list.notes, line.text, &stream->options);
}

static bool is_read_whole(const conus_pose_stream *stream)
{
    return formats[stream->format].parse != NULL;
}

static bool is_of_rodents(conus_pose_format format)
{
    return format == CONUS_POSE_FORMAT_IBL || format == CONUS_POSE_FORMAT_NWB;
}

/* Warns where a head in metres would be as small: all positions lie within 1 mm of the origin, but not at it, or three
 * and more within 0.2 mm of each other. In the CCF, from bregma and in IBL's files the positions of a probe are as near
 * to each other. */
static conus_status note_extent(conus_pose_stream *stream)
{
    const struct extent extent = stream->extent;
    stream->extent = (struct extent){0};
    bool of_people = stream->options.space < CONUS_SPACE_CCF && !is_of_rodents(stream->format);
    if (!of_people || stream->is_partial) {
        return CONUS_OK;
    }
    double side = 0;
    for (int a = 0; a < 3; a++) {
        side = fmax(side, extent.high[a] - extent.low[a]);
    }
    bool near_origin = extent.farthest > 0 && extent.farthest <= NEAR_ORIGIN;
    bool near_each_other = extent.count >= LEAST && side > 0 && side <= NEAR_EACH_OTHER;
    if (!near_origin && !near_each_other) {
        return CONUS_OK;
    }
    /* Says that they are in mm; "" if none does. */
    const char *source = path_base(conus_pose_list_coordsystem(&stream->list));
    return notes_warn(&stream->list.notes,
                      "all positions lie within %s, as if they were in metres; they are taken as mm%s%s%s",
                      near_origin ? "1 mm of the origin" : "0.2 mm of each other", source[0] ? ", as " : "", source,
                      source[0] ? " says" : "");
}

static conus_status read_whole(conus_pose_stream *stream)
{
    struct bytes bytes = {0};
    conus_status status =
        (stream->format == CONUS_POSE_FORMAT_ELECTRODES || stream->format == CONUS_POSE_FORMAT_NIBS) && stream->path
            ? pose_coordsystem_find(&stream->list, stream->path)
            : CONUS_OK;
    status = status ? status : pose_lines_rest(&bytes, &stream->lines, pose_memory(&stream->options));
    const struct text text = {(const char *)bytes.data, bytes.size};
    if (!status && stream->options.format == CONUS_POSE_FORMAT_AUTO) {
        status = find_format_of_matlab(&stream->format, &stream->list, text, &stream->options);
    }
    bool is_read = !stream->options.format && stream->format == CONUS_POSE_FORMAT_LEAD_DBS;
    bool is_json = stream->format == CONUS_POSE_FORMAT_MARKUPS && text.size && text.data[0] != '#'; /* .fcsv */
    if (!status && !stream->options.format && is_json) {
        status = pose_json_find(&stream->format, text);
    }
    /* Positions in the CCF or from bregma are of tables, points, IBL and NWB; other programs' files are of people. */
    if (!status && stream->options.space >= CONUS_SPACE_CCF && !is_of_rodents(stream->format)) {
        status = fail(CONUS_ERROR_DATA,
                      "positions of format %s are not in space %s, which tables, points, ibl and nwb may be",
                      conus_pose_format_name(stream->format), conus_space_name((size_t)stream->options.space));
    }
    status = status || is_read ? status : formats[stream->format].parse(&stream->list, text, &stream->options);
    if (!status && stream->format == CONUS_POSE_FORMAT_ELECTRODES) {
        /* The table as it is, for an answer that adds columns to it. */
        bool is_text = !text.size || !memchr(text.data, '\0', text.size);
        stream->list.electrodes = is_text ? memory_text(text.data, text.size) : NULL;
        status = !is_text                  ? fail(CONUS_ERROR_DATA, "a zero byte: not a table of electrodes")
                 : stream->list.electrodes ? CONUS_OK
                                           : CONUS_ERROR_MEMORY;
    }
    bytes_finish(&bytes);
    for (size_t i = 0; !status && i < stream->list.count; i++) {
        extent_add(&stream->extent, &stream->list.rows[i]);
    }
    return status ? status : note_extent(stream);
}

static conus_status begin_text(conus_pose_stream *stream)
{
    conus_status status = skip_mark(&stream->lines);
    status = status ? status : find_format(stream);
    if (status) {
        return status;
    }
    if (stream->options.along_shafts && stream->format != CONUS_POSE_FORMAT_ELECTRODES) {
        return fail(CONUS_ERROR_DATA, "shafts are for electrodes (BIDS), not for %s",
                    conus_pose_format_name(stream->format));
    }
    if (is_read_whole(stream)) {
        return read_whole(stream);
    }
    if (stream->format == CONUS_POSE_FORMAT_TABLE) {
        return read_header(stream);
    }
    return stream->options.axis == CONUS_AXIS_OF_FORMAT
               ? CONUS_OK
               : fail(CONUS_ERROR_DATA, "points have no direction, so that no axis (%s) can be chosen",
                      pose_axis_name(stream->options.axis));
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

const char *pose_path_name(const char *path)
{
    return is_stdin(path) ? "standard input" : path;
}

static conus_status open_path(conus_pose_stream *stream, const char *path)
{
    const char *name = pose_path_name(path);
    stream->name = memory_text(name, strlen(name));
    if (!stream->name) {
        return CONUS_ERROR_MEMORY;
    }
    stream->list.sink.path = stream->name;
    stream->path = is_stdin(path) ? NULL : path;
    stream->descriptor = is_stdin(path) ? STDIN_FILENO : system_open(path, SYSTEM_READ);
    stream->owned = !is_stdin(path) && stream->descriptor >= 0;
    conus_inputs_add(is_stdin(path) ? "/dev/stdin" : path);
    return fail_of(stream, stream->descriptor < 0 ? fail_errno("open") : begin_file(stream));
}

static conus_status create_stream(conus_pose_stream **out, const conus_pose_options *options)
{
    options = options_of(conus_pose_options, options);
    if ((unsigned)options->space > CONUS_SPACE_BREGMA || (unsigned)options->axis > CONUS_AXIS_MINUS_Z ||
        !conus_pose_format_name((size_t)options->format)) {
        return fail(CONUS_ERROR_ARGUMENT, "options of poses: space, axis or format is none of its names");
    }
    conus_frame frame = {0}; /* the caller's, or that of a space that needs no atlas */
    conus_status status = CONUS_OK;
    if (options->frame) {
        frame = *options->frame;
        status =
            conus_space_name((size_t)frame.space) ? CONUS_OK : fail(CONUS_ERROR_ARGUMENT, "frame: its space is none");
    } else {
        status = conus_frame_find(&frame, NULL, options->space, NULL);
    }
    if (status) {
        return status;
    }
    conus_pose_stream *stream = memory_zeroed(1, sizeof *stream);
    if (!stream) {
        return CONUS_ERROR_MEMORY;
    }
    stream->options = *options;
    stream->frame = frame;
    stream->options.frame = &stream->frame;
    stream->options.space = frame.space;
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
        stream->format = CONUS_POSE_FORMAT_TABLE;
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
    buffer_finish(&stream->names.text);
    memory_free(stream->name);
    memory_free(stream);
}

/* The strings live until the next block. */
static conus_status name_row(conus_pose_row *row, conus_pose_stream *stream, struct text id, const char *error)
{
    conus_status status = pose_list_add(&stream->block, row, id, error);
    *row = status ? *row : stream->block.rows[stream->block.count - 1];
    return status;
}

static conus_status make_row(conus_pose_row *out, conus_pose_stream *stream, bool *found)
{
    *found = stream->taken < stream->candidates.count;
    if (!*found) {
        return CONUS_OK;
    }
    char id[POSE_CANDIDATE_ID];
    conus_status bad = pose_candidates_row(out, id, &stream->candidates, stream->taken);
    return name_row(out, stream, text_from(id), bad ? conus_message() : NULL);
}

static conus_status read_row(conus_pose_row *out, conus_pose_stream *stream, bool *found)
{
    struct pose_line line;
    conus_status status = next_line(&stream->lines, &line, found);
    if (status || !*found) {
        return status;
    }
    conus_pose_row row = pose_row_at(line.number);
    struct pose_name name;
    name.text = (struct text){"", 0};
    conus_status bad = line.too_long ? fail(CONUS_ERROR_DATA, "a line of more than %d bytes", POSE_LINE_LIMIT)
                       : stream->format == CONUS_POSE_FORMAT_POINTS
                           ? pose_point_row(&row, &name, line.text, &stream->options)
                           : pose_table_row(&row, &name, &stream->table, line.text, &stream->options);
    char ordinal[POSE_ORDINAL_SIZE];
    const char *bad_id = pose_check_id(&name.text, ordinal, stream->taken + 1);
    status = name_row(&row, stream, name.text, bad ? conus_message() : bad_id);
    if (row.is_point) { /* for cones conus_aims_found() tells more */
        extent_add(&stream->extent, &row);
    }
    *out = row;
    return status;
}

conus_status conus_pose_stream_read(conus_pose_row *rows, size_t *count, conus_pose_stream *stream, size_t capacity)
{
    size_t got = 0;
    bool found = true;
    conus_status status = capacity ? CONUS_OK : fail(CONUS_ERROR_ARGUMENT, "capacity: 0 rows, allowed is 1 or more");
    pose_list_clear(&stream->block);
    while (!status && found && got < capacity) {
        if (is_read_whole(stream)) {
            found = stream->taken < stream->list.count;
            if (found) {
                rows[got] = stream->list.rows[stream->taken];
            }
        } else {
            status = (stream->candidates.count ? make_row : read_row)(&rows[got], stream, &found);
        }
        if (!status && found && stream->names.count < NAMES_COMPARED && !stream->candidates.count) {
            stream->names.count++;
            buffer_append(&stream->names.text, rows[got].id, strlen(rows[got].id) + 1);
        }
        got += found;
        stream->taken += found;
    }
    if (!status && !found) {
        status = note_extent(stream);
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
    if (is_read_whole(stream) || stream->candidates.count) {
        uint64_t left = (is_read_whole(stream) ? stream->list.count : stream->candidates.count) - stream->taken;
        stream->taken += rows < left ? rows : left;
        return CONUS_OK;
    }
    for (bool found = true; !status && found && rows; rows--) {
        struct pose_line line;
        status = next_line(&stream->lines, &line, &found);
        stream->taken += !status && found;
    }
    return fail_of(stream, status);
}

static conus_status count_again(uint64_t *count, const conus_pose_stream *stream)
{
    struct pose_lines lines = {.descriptor = -1};
    conus_status status = CONUS_OK;
    if (stream->descriptor < 0) {
        pose_lines_init_text(&lines, stream->text);
    } else if (stream->lines.seekable) {
        status = pose_lines_init(&lines, stream->descriptor, true, stream->start);
        lines.state = stream->lines.state;
    } else {
        status = fail(CONUS_ERROR_UNSUPPORTED, "rows of a pipe cannot be counted before they are read");
    }
    status = status ? status : skip_mark(&lines);
    struct pose_line line;
    for (bool found = true; !status && found; *count += found) {
        status = next_line(&lines, &line, &found);
        found = !status && found;
    }
    pose_lines_finish(&lines);
    return status;
}

conus_status conus_pose_stream_count(uint64_t *count, conus_pose_stream *stream)
{
    if (is_read_whole(stream) || stream->candidates.count) {
        *count = is_read_whole(stream) ? stream->list.count : stream->candidates.count;
        return CONUS_OK;
    }
    uint64_t lines = 0;
    conus_status status = count_again(&lines, stream);
    if (status) {
        return fail_of(stream, status);
    }
    *count = lines - (stream->format == CONUS_POSE_FORMAT_TABLE); /* without the header */
    return CONUS_OK;
}

conus_pose_format conus_pose_stream_format(const conus_pose_stream *stream)
{
    return stream->format;
}

const char *conus_pose_stream_space(const conus_pose_stream *stream)
{
    return stream ? stream->list.space.name : "";
}

bool conus_pose_stream_is_live(const conus_pose_stream *stream)
{
    return stream->stop.file >= 0 && !is_read_whole(stream);
}

void conus_pose_stream_stop(conus_pose_stream *stream)
{
    if (stream->stop.file >= 0) {
        system_wake(&stream->stop);
    }
}

bool conus_pose_stream_has_times(const conus_pose_stream *stream)
{
    if (!is_read_whole(stream)) {
        return stream->format == CONUS_POSE_FORMAT_TABLE && stream->table.has_times;
    }
    bool found = stream->list.count == 0;
    for (size_t i = 0; i < stream->list.count && !found; i++) {
        found = !isnan(stream->list.rows[i].time_s);
    }
    return found;
}

bool conus_pose_stream_has_angles(const conus_pose_stream *stream)
{
    bool found = stream->format == CONUS_POSE_FORMAT_TABLE && stream->table.has_angles;
    for (size_t i = 0; is_read_whole(stream) && i < stream->list.count; i++) {
        found = found || stream->list.rows[i].angle != 0;
    }
    return found;
}

bool conus_pose_stream_has_ranges(const conus_pose_stream *stream)
{
    return stream->candidates.asked.to_target ||
           (stream->format == CONUS_POSE_FORMAT_TABLE && stream->table.has_ranges);
}

bool conus_pose_stream_has_points(const conus_pose_stream *stream)
{
    bool found = stream->format == CONUS_POSE_FORMAT_POINTS;
    for (size_t i = 0; is_read_whole(stream) && i < stream->list.count; i++) {
        found = found || stream->list.rows[i].is_point;
    }
    return found;
}

const char *conus_pose_stream_electrodes(const conus_pose_stream *stream)
{
    return conus_pose_list_electrodes(&stream->list);
}

uint64_t pose_stream_position(const conus_pose_stream *stream)
{
    return stream->taken;
}

const char *conus_pose_stream_coordsystem(const conus_pose_stream *stream)
{
    return stream ? conus_pose_list_coordsystem(&stream->list) : "";
}

const char *conus_pose_stream_coordsystem_sha256(const conus_pose_stream *stream)
{
    return stream ? stream->list.coordsystem_sha256 : "";
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
            status = fail_of(stream, pose_list_add(list, &rows[i], text_from(rows[i].id), rows[i].error));
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
