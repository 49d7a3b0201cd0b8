/* SPDX-License-Identifier: BSD-3-Clause */
/* Detects the format of poses from what they begin with. */
#include "poses/pose_guess.h"

#include "base/formats/matlab.h"
#include "poses/pose_table.h"
#include "poses/programs/pose_brainsight.h"
#include "poses/programs/pose_electrodes.h"
#include "poses/programs/pose_fcsv.h"
#include "poses/programs/pose_invesalius.h"
#include "poses/programs/pose_nibs.h"

/* What a text that begins with this line of data is. */
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

conus_pose_format pose_guess_format(struct text text, bool all, size_t *used)
{
    const char *begin = text.data;
    const char *end = text.data + text.size;
    struct text line;
    if (matlab_is(text)) { /* which program's is found when all of it is read */
        *used = 0;
        return CONUS_POSE_FORMAT_SIMNIBS;
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
