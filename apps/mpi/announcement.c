/* SPDX-License-Identifier: BSD-3-Clause */
/* Announcements of rank 0: five strings, by MPI_Bcast. */
#include "mpi/announcement.h"

#include "options/messages.h"

#include <mpi.h>
#include <stdlib.h>
#include <string.h>

enum { STRINGS = 5 };

/* Its size with the final NUL, then the string; size 0 = none. */
static void send_string(const char *string)
{
    int size = string ? (int)strlen(string) + 1 : 0;
    MPI_Bcast(&size, 1, MPI_INT, 0, MPI_COMM_WORLD);
    MPI_Bcast((void *)string, size, MPI_CHAR, 0, MPI_COMM_WORLD);
}

static char *receive_string(void)
{
    int size;
    MPI_Bcast(&size, 1, MPI_INT, 0, MPI_COMM_WORLD);
    char *string = size ? malloc((size_t)size) : NULL;
    if (size && !string) {
        print_error_line("not enough memory");
        MPI_Abort(MPI_COMM_WORLD, EXIT_DATA);
    }
    MPI_Bcast(string, size, MPI_CHAR, 0, MPI_COMM_WORLD);
    return string;
}

void announcement_send(const struct announcement *announcement)
{
    static const struct announcement none;
    const struct announcement *a = announcement ? announcement : &none;
    const char *const strings[STRINGS] = {a->atlas, a->poses, a->output, a->shard, a->rows};
    for (int i = 0; i < STRINGS; i++) {
        send_string(strings[i]);
    }
}

bool announcement_receive(struct announcement *out)
{
    out->atlas = receive_string();
    out->poses = receive_string();
    out->output = receive_string();
    out->shard = receive_string();
    out->rows = receive_string();
    return out->atlas;
}

void announcement_finish(struct announcement *announcement)
{
    free((char *)announcement->atlas);
    free((char *)announcement->poses);
    free((char *)announcement->output);
    free((char *)announcement->shard);
    free((char *)announcement->rows);
}
