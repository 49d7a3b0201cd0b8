/* SPDX-License-Identifier: BSD-3-Clause */
/* conus_pose_list_load(): all rows of a stream as a list. */
#include "poses/pose_load.h"

#include "base/memory.h"
#include "poses/pose_stream.h"

static conus_status read_all(conus_pose_list *list, conus_pose_stream *stream)
{
    enum { BLOCK = 64 };
    conus_pose_row rows[BLOCK];
    size_t count = 0;
    conus_status status = CONUS_OK;
    do {
        status = conus_pose_stream_read(rows, &count, stream, BLOCK);
        for (size_t i = 0; !status && i < count; i++) {
            status = pose_list_add(list, &rows[i], text_from(rows[i].id), rows[i].error);
        }
    } while (!status && count);
    return status ? status : pose_stream_take_header(list, stream);
}

/* Ends the stream. */
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
