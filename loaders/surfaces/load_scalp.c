/* SPDX-License-Identifier: BSD-3-Clause */
/* Reads a scalp, and finds the positions of the 10-10 system on it. */
#include "loaders/surfaces/surfaces.h"

conus_status conus_scalp_load(conus_scalp **out, const char *path, const double landmarks[4][3])
{
    struct job job = {0};
    struct mesh mesh = {0};
    conus_scalp *scalp = memory_zeroed(1, sizeof *scalp);
    surface_read(&job, &mesh, NULL, path, &(const struct mesh_file_options){.external = true});
    if (job_need(&job, scalp)) {
        (void)JOB_CALL(&job, scalp_make(scalp, &mesh, landmarks));
    }
    mesh_finish(&mesh);
    conus_status status = job_close(&job, NULL, NULL); /* its notes are about the shape: scalp_make() looks at that */
    if (status) {
        conus_scalp_destroy(scalp);
        return status;
    }
    *out = scalp;
    return CONUS_OK;
}

void conus_scalp_destroy(conus_scalp *scalp)
{
    if (scalp) {
        mesh_finish(&scalp->mesh);
        memory_free(scalp);
    }
}
