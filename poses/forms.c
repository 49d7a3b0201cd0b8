/* SPDX-License-Identifier: BSD-3-Clause */
/* Tells files of poses by how they begin. */
#include "poses/pose_stream.h"

#include "base/formats/table.h"
#include "poses/programs/pose_programs.h"
#include "sources/format.h"

/* The format of a text whose first line of data this is. */
static conus_pose_format format_of(struct text line)
{
    if (line.data[0] == '<' || line.data[0] == '{') {
        return line.data[0] == '<' ? CONUS_POSE_FORMAT_LOCALITE : CONUS_POSE_FORMAT_MARKUPS;
    }
    return pose_electrodes_header(line) ? CONUS_POSE_FORMAT_ELECTRODES
           : pose_nibs_header(line)     ? CONUS_POSE_FORMAT_NIBS
                                        : CONUS_POSE_FORMAT_TABLE;
}

conus_pose_format forms_find(struct text text, bool all, size_t *used)
{
    const char *begin = text.data;
    const char *end = text.data + text.size;
    struct text line;
    const enum format_id id = format_id_of(&(struct bytes){(uint8_t *)text.data, text.size}, ROLE_POSES);
    if (id != FORMAT_OTHER) { /* which program wrote it is known when all of it is read */
        *used = 0;
        return id == FORMAT_MATLAB ? CONUS_POSE_FORMAT_SIMNIBS : CONUS_POSE_FORMAT_NWB;
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

const char *forms_why_none(struct text text)
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
        {"{\\rtf", "a text of a word processor (RTF): save it as plain text"},
        {"PK\x03\x04", "a zip file or a spreadsheet: unpack it, or export it as text with tabs or commas"},
        {"\xd0\xcf\x11\xe0", "a spreadsheet: export it as text with tabs or commas"},
        {"(",
         "a table of the sites of SpikeGLX's probe (.imro) says which are on, and not where the probe lies: --probe "
         "takes it, and a pose is another file"},
        {"acqApLfSy=", "a recording by SpikeGLX (.meta) says where contacts are on the probe, and not where it lies: "
                       "--probe takes it, and a pose is another file"},
        {"channel_groups", "a layout of a probe's channels (.prb) says where they are on it, and not where it lies"},
    };
    for (size_t i = 0; i < sizeof kinds / sizeof kinds[0]; i++) {
        if (text_starts(text, kinds[i].bytes)) {
            return kinds[i].kind;
        }
    }
    return NULL;
}
