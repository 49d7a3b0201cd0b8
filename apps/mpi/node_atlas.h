/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * One atlas for all ranks of a node. The first rank packs its atlas into a file in memory (memfd_create); the others
 * map it. Nobody can write to it then. It is gone with the last process that maps it, however that process ends. */
#ifndef CONUS_MPI_NODE_ATLAS_H
#define CONUS_MPI_NODE_ATLAS_H

#include "conus/atlas.h"

#include <mpi.h>

struct node_atlas {
    const void *memory; /**< NULL = not shared. */
    size_t size;
};

/** All ranks of @p node at once. On its first rank *atlas is loaded, and exchanged for the shared one where that can be
 * had; on the others *atlas is NULL, and stays so where it cannot. */
void node_atlas_share(struct node_atlas *out, conus_atlas **atlas, MPI_Comm node);

/** Behind the end of the atlas. */
void node_atlas_finish(struct node_atlas *shared);

#endif
