/* SPDX-License-Identifier: BSD-3-Clause */
/* Leaves the peer scenarios out in a build without VTK. */
#include "bench/support/bench.h"

static conus_status leave_out(struct bench *bench, const char *scenario)
{
    fail(CONUS_ERROR_UNSUPPORTED, "conus-bench was built without VTK 9.1");
    return bench_leave_out(bench, scenario);
}

conus_status bench_peers_mesh(struct bench *bench)
{
    return leave_out(bench, "peers_mesh");
}

conus_status bench_peers_colour(struct bench *bench)
{
    return leave_out(bench, "peers_colour");
}
