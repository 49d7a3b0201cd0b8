/* SPDX-License-Identifier: BSD-3-Clause */
/* Asks conus-mesh for the surfaces of areas. */
#include "loaders/child/mesh_extract.h"

#include "base/byte_order.h"
#include "base/memory.h"
#include "loaders/child/parts.h"

#include <stdio.h>
#include <string.h>

/* A run under way. */
struct extraction {
    const conus_atlas *atlas;
    const struct volume *volume;
    mesh_take take;
    void *user;
    struct notes *notes;
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

static const void *objects_of(const struct volume *volume)
{
    return volume->objects16 ? (const void *)volume->objects16 : volume->objects32;
}

static size_t size_of_objects(const struct volume *volume)
{
    return volume->voxel_count * (volume->objects16 ? sizeof *volume->objects16 : sizeof *volume->objects32);
}

static conus_status take_area(void *user, const struct mesh_frame *frame)
{
    struct extraction *work = user;
    struct mesh mesh = {0};
    char name[32];
    if (frame->kind == MESH_FRAME_FAILURE) {
        return fail(CONUS_ERROR_DATA, "conus-mesh: %.*s", (int)frame->text.size, frame->text.data);
    }
    bool found = false;
    while (!found && work->number < work->atlas->area_count) { /* frames come in the order of the areas */
        found = work->atlas->objects[work->number++].label == frame->id;
    }
    if (!found) {
        return fail(CONUS_ERROR_DATA, "mesh stream: a surface of label %u, which is none of the areas left", frame->id);
    }
    snprintf(name, sizeof name, "area %u", frame->id);
    conus_status status = mesh_from_frame(&mesh, frame);
    mesh.path = status ? NULL : memory_text(name, strlen(name));
    status = status || mesh.path ? status : CONUS_ERROR_MEMORY;
    status = status ? status : mesh_check(&mesh, work->notes);
    status = status ? status : work->take(work->user, work->number, &mesh);
    mesh_finish(&mesh);
    return status;
}

static conus_status run_child(struct extraction *work, const struct buffer *request,
                              const struct mesh_extract_options *options)
{
    const struct volume *volume = work->volume;
    const struct mesh_child_request all = {
        .head = *request, .voxels = objects_of(volume), .size = size_of_objects(volume)};
    /* AAL's 7 million voxels take 1 s, 5 s when decimated. */
    const uint32_t seconds = 120 + (uint32_t)(volume->voxel_count / 50000);
    const struct child_limits limits = {.memory = options->max_memory, .seconds = seconds, .wait = 4 * seconds};
    return mesh_child_run(&all, &limits, take_area, work);
}

conus_status mesh_extract(const conus_atlas *atlas, const struct mesh_extract_options *options, mesh_take take,
                          void *user, struct notes *notes)
{
    enum { MOST = 1 << 20 };
    conus_status status = CONUS_OK;
    for (size_t i = 0; !status && i < atlas_parcellation_count(atlas); i++) {
        struct extraction work = {
            .atlas = atlas, .volume = &atlas->volumes[i], .take = take, .user = user, .notes = notes};
        struct buffer request = {0};
        const conus_volume_info *info = &work.volume->info;
        for (int a = 0; !status && a < 3; a++) {
            if (info->dim[a] > MOST) {
                status = fail(CONUS_ERROR_UNSUPPORTED, "%s: %zu voxels along %c, surfaces are made of up to %d",
                              info->path, info->dim[a], "ijk"[a], MOST);
            }
        }
        if (!status) {
            append_request(&request, &work, options);
            status = buffer_status(&request);
        }
        status = status ? status : run_child(&work, &request, options);
        buffer_finish(&request);
    }
    return status;
}
