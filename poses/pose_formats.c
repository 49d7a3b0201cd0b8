/* SPDX-License-Identifier: BSD-3-Clause */
/* The formats of poses: their names and parsers. */
#include "poses/pose_formats.h"

#include "base/status.h"
#include "poses/pose_table.h"
#include "poses/programs/pose_brainsight.h"
#include "poses/programs/pose_electrodes.h"
#include "poses/programs/pose_ibl.h"
#include "poses/programs/pose_invesalius.h"
#include "poses/programs/pose_lead_dbs.h"
#include "poses/programs/pose_localite.h"
#include "poses/programs/pose_markups.h"
#include "poses/programs/pose_nibs.h"
#include "poses/programs/pose_simnibs.h"
#include "poses/rows/pose_row.h"

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
