/* SPDX-License-Identifier: BSD-3-Clause */
/* The formats of poses: their names and parsers, and what a file's first bytes say that it is. */
#include "poses/pose_formats.h"

#include "base/child/hdf5.h"
#include "base/formats/matlab.h"
#include "base/status.h"
#include "poses/pose_table.h"
#include "poses/programs/pose_programs.h"

static conus_status parse_matrix(conus_pose_list *list, struct text text, const conus_pose_options *options)
{
    conus_pose_row row = pose_row_at(1);
    conus_status bad = CONUS_OK;
    if (!pose_plain_matrix(&row, &bad, text, options)) {
        return fail(CONUS_ERROR_DATA, "numbers, but neither the 16 of a matrix nor lines of x y z and a name");
    }
    return pose_list_add(list, &row, text_from(""), bad ? conus_message() : NULL);
}

/* Formats by number. Those without a parser are read line by line. */
static const struct {
    const char *name;
    pose_parser parse;
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

pose_parser pose_format_parser(conus_pose_format format)
{
    return formats[format].parse;
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

conus_pose_format pose_format_guess(struct text text, bool all, size_t *used)
{
    const char *begin = text.data;
    const char *end = text.data + text.size;
    struct text line;
    bool is_hdf5 = hdf5_is((const uint8_t *)text.data, text.size);
    if (matlab_is(text) || is_hdf5) { /* which program's MATLAB is found when all of it is read */
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

const char *pose_format_refused(struct text text)
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

conus_status pose_format_of_matlab(conus_pose_format *format, conus_pose_list *list, struct text text,
                                   const conus_pose_options *options)
{
    bool is_lead = false;
    conus_status status = matlab_is(text) ? pose_lead_dbs_find(&is_lead, list, text, options) : CONUS_OK;
    *format = is_lead ? CONUS_POSE_FORMAT_LEAD_DBS : *format;
    return status;
}
