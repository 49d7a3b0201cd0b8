/* SPDX-License-Identifier: BSD-3-Clause */
/* Knows files that are no poses by their first bytes, and those of MATLAB by what is in them. */
#include "poses/pose_bytes.h"

#include "base/formats/matlab.h"
#include "poses/programs/pose_lead_dbs.h"

const char *pose_bytes_kind(struct text text)
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
        {"\x89HDF", "HDF5, as MATLAB's level 7.3 is: save it anew with MATLAB's save(..., '-v7')"},
        {"MATLAB 7.3", "MATLAB's level 7.3, which is HDF5: save it anew with MATLAB's save(..., '-v7')"},
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

conus_status pose_bytes_program(conus_pose_format *format, struct text text, const conus_pose_options *options)
{
    bool is_lead = false;
    conus_status status = matlab_is(text) ? pose_lead_dbs_find(&is_lead, text, options) : CONUS_OK;
    *format = is_lead ? CONUS_POSE_FORMAT_LEAD_DBS : *format;
    return status;
}
