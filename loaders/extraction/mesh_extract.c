/* SPDX-License-Identifier: BSD-3-Clause */
/* Asks conus-mesh for the surfaces of areas. */
#include "loaders/extraction/mesh_extract.h"

#include "base/byte_order.h"
#include "base/memory.h"
#include "loaders/extraction/parts.h"

#include <stdio.h>
#include <string.h>

/* A run under way. */
struct extraction {
    struct job *job;
    const conus_atlas *atlas;
    const struct volume *volume;
    mesh_take take;
    void *user;
    uint32_t number; /* of the area that came last */
};

static void append_f64(struct buffer *out, double value)
{
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    mesh_append_u32(out, (uint32_t)bits);
    mesh_append_u32(out, (uint32_t)(bits >> 32));
}

static void append_request(struct buffer *out, const struct extraction *work,
                           const struct mesh_extract_options *options)
{
    const conus_volume_info *info = &work->volume->info;
    buffer_append(out, MESH_REQUEST_MAGIC, MESH_MAGIC_SIZE);
    mesh_append_u32(out, MESH_REQUEST_SURFACES);
    mesh_append_u32(out, (uint32_t)work->atlas->area_count);
    for (int a = 0; a < 3; a++) {
        mesh_append_u32(out, (uint32_t)info->dim[a]);
    }
    mesh_append_u32(out, work->volume->objects16 ? 2 : 4);
    mesh_append_u32(out, options->iterations);
    mesh_append_u32(out, 0);
    append_f64(out, options->pass_band);
    append_f64(out, options->reduction);
    for (int i = 0; i < 16; i++) {
        append_f64(out, info->world_from_voxel[i]);
    }
    for (size_t i = 0; i < work->atlas->area_count; i++) {
        mesh_append_u32(out, work->atlas->objects[i].label);
    }
}

static conus_status take_area(void *user, const struct mesh_frame *frame)
{
    struct extraction *work = user;
    struct job *job = work->job;
    struct mesh mesh = {0};
    char name[32];
    bool found = false;
    while (!found && work->number < work->atlas->area_count) { /* frames come in the order of the areas */
        found = work->atlas->objects[work->number++].label == frame->id;
    }
    if (frame->kind == MESH_FRAME_FAILURE) {
        job_bad(job, "conus-mesh: %.*s", (int)frame->text.size, frame->text.data);
    } else if (!found) {
        job_bad(job, "mesh stream: a surface of label %u, which is none of the areas left", frame->id);
    } else if (JOB_CALL(job, mesh_from_frame(&mesh, frame))) {
        snprintf(name, sizeof name, "area %u", frame->id);
        mesh.path = memory_text(name, strlen(name));
        job_need(job, mesh.path);
    }
    if (JOB_CALL(job, mesh_check(&mesh, &job->notes))) {
        work->take(job, work->user, work->number, &mesh);
    }
    mesh_finish(&mesh);
    return job->status;
}

static void extract_volume(struct extraction *work, const struct mesh_extract_options *options)
{
    enum { MOST = 1 << 20 };
    struct job *job = work->job;
    const struct volume *volume = work->volume;
    const conus_volume_info *info = &volume->info;
    /* AAL's 7 million voxels take 1 s, 5 s when decimated. */
    const uint32_t seconds = 120 + (uint32_t)(volume->voxel_count / 50000);
    const struct child_limits limits = {.memory = options->max_memory, .seconds = seconds, .wait = 4 * seconds};
    const bool is_small = volume->objects16;
    struct mesh_child_request request = {.voxels = is_small ? (const void *)volume->objects16 : volume->objects32,
                                         .size = volume->voxel_count *
                                                 (is_small ? sizeof *volume->objects16 : sizeof *volume->objects32)};
    for (int a = 0; a < 3; a++) {
        if (info->dim[a] > MOST) {
            job_refuse(job, "%s: %zu voxels along %c, surfaces are made of up to %d", info->path, info->dim[a],
                       "ijk"[a], MOST);
        }
    }
    append_request(&request.head, work, options);
    if (JOB_CALL(job, buffer_status(&request.head))) {
        (void)JOB_CALL(job, mesh_child_run(&request, &limits, take_area, work));
    }
    buffer_finish(&request.head);
}

void mesh_extract(struct job *job, const conus_atlas *atlas, const struct mesh_extract_options *options, mesh_take take,
                  void *user)
{
    for (size_t i = 0; job_ok(job) && i < atlas_parcellation_count(atlas); i++) {
        struct extraction work = {.job = job, .atlas = atlas, .volume = &atlas->volumes[i], .take = take, .user = user};
        extract_volume(&work, options);
    }
}
