/* SPDX-License-Identifier: BSD-3-Clause */
/* Sends conus-mesh a request and takes its frames. */
#include "loaders/extraction/parts.h"

#include "base/child/child.h"
#include "base/system/system.h"
#include "base/text.h"

#include <errno.h>
#include <string.h>

static const struct child_program program = {"conus-mesh", "CONUS_MESH", "VTK"};

conus_status mesh_child_find(char **path)
{
    return child_find(path, &program);
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
    struct mesh_frames frames = {.take = take, .user = user};
    struct bytes rest = {0};
    const struct child_task task = {.program = &program,
                                    .limits = *limits,
                                    .words = words,
                                    .descriptor = request_file(request),
                                    .take = mesh_frames_take,
                                    .user = &frames};
    if (task.descriptor < 0) {
        return fail(CONUS_ERROR_IO, "%s: cannot start: %s", program.name, text_error(errno));
    }
    conus_status status = child_run(&rest, &task);
    close(task.descriptor);
    if (!status && !(frames.ended && !rest.size)) {
        status = fail(CONUS_ERROR_DATA, "%s: its output is cut off or too long", program.name);
    }
    bytes_finish(&rest);
    return status;
}
