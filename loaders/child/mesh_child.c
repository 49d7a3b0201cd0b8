/* SPDX-License-Identifier: BSD-3-Clause */
/* Sends conus-mesh a request and takes its frames. */
#include "loaders/child/mesh_child.h"

#include "base/child/child.h"
#include "base/child/process.h"
#include "base/system/system.h"
#include "base/text.h"

#include <errno.h>
#include <string.h>

static const struct child_program program = {"conus-mesh", "CONUS_MESH", "VTK"};

conus_status mesh_child_find(char **path)
{
    return child_find(path, &program);
}

/* The progress through a stream. */
struct progress {
    mesh_frame_take take;
    void *user;
    bool begun, ended;
    uint32_t frames;
};

/* How many bytes from the start of `data` make the next whole thing, as far as that is known yet. */
static conus_status wanted_size(size_t *wanted, const struct progress *progress, const uint8_t *data, size_t size)
{
    struct mesh_frame frame;
    *wanted = progress->begun ? MESH_FRAME_HEADER_SIZE : MESH_MAGIC_SIZE;
    if (!progress->begun || size < *wanted) {
        return CONUS_OK;
    }
    conus_status status = mesh_frame_header(&frame, data);
    *wanted = status ? *wanted : frame.size;
    return status;
}

static conus_status take_frame(struct progress *progress, const uint8_t *data, size_t size)
{
    struct mesh_frame frame;
    conus_status status = mesh_frame_parse(&frame, data, size);
    if (status) {
        return status;
    }
    if (progress->ended || (frame.kind == MESH_FRAME_END && frame.id != progress->frames)) {
        return fail(CONUS_ERROR_DATA, "mesh stream: its end does not match its frames");
    }
    if (frame.kind == MESH_FRAME_CHECKED) {
        return fail(CONUS_ERROR_DATA, "mesh stream: frame of kind %d, which only the cache may hold", (int)frame.kind);
    }
    progress->ended = frame.kind == MESH_FRAME_END;
    progress->frames++;
    return progress->ended ? CONUS_OK : progress->take(progress->user, &frame);
}

static conus_status take_frames(void *user, size_t *used, size_t *wanted, const uint8_t *data, size_t size)
{
    struct progress *progress = user;
    conus_status status;
    while (!(status = wanted_size(wanted, progress, data + *used, size - *used)) && size - *used >= *wanted) {
        status = progress->begun ? take_frame(progress, data + *used, *wanted)
                                 : mesh_stream_begin(data + *used, size - *used);
        if (status) {
            return status;
        }
        progress->begun = true;
        *used += *wanted;
    }
    return status;
}

/* The request as a file in memory, or -1. */
static int request_file(const struct mesh_child_request *request)
{
    int descriptor = system_open_scratch(program.name);
    if (descriptor >= 0 && !(system_write(descriptor, request->head.data, request->head.size) &&
                             system_write(descriptor, request->voxels, request->size))) {
        close(descriptor);
        return -1;
    }
    return descriptor;
}

conus_status mesh_child_run(const struct mesh_child_request *request, const struct child_limits *limits,
                            mesh_frame_take take, void *user)
{
    char name[] = "conus-mesh";
    char file[] = "/dev/fd/3";
    char *const words[] = {name, file, NULL};
    struct progress progress = {.take = take, .user = user};
    struct bytes rest = {0};
    const struct child_task task = {.program = &program,
                                    .limits = *limits,
                                    .words = words,
                                    .descriptor = request_file(request),
                                    .take = take_frames,
                                    .user = &progress};
    if (task.descriptor < 0) {
        return fail(CONUS_ERROR_IO, "%s: cannot start: %s", program.name, text_error(errno));
    }
    conus_status status = child_run(&rest, &task);
    close(task.descriptor);
    if (!status && !(progress.ended && !rest.size)) {
        status = fail(CONUS_ERROR_DATA, "%s: its output is cut off or too long", program.name);
    }
    bytes_finish(&rest);
    return status;
}
