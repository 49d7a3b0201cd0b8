/* SPDX-License-Identifier: BSD-3-Clause */
/* Shares one atlas among the ranks of a node, through a sealed file in memory. */
#include "mpi/node_atlas.h"

#include <fcntl.h>
#include <stdio.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

/* How the others find the file: /proc/PROCESS/fd/DESCRIPTOR. */
struct address {
    long process;
    int descriptor; /* -1 = there is none */
    size_t size;
};

static void *map_file(int descriptor, size_t size, int protection)
{
    void *memory = mmap(NULL, size, protection, MAP_SHARED, descriptor, 0);
    return memory == MAP_FAILED ? NULL : memory;
}

/* Packs the atlas into the file, which then nobody can change. */
static bool pack_atlas(int descriptor, size_t size, const conus_atlas *atlas)
{
    void *memory = ftruncate(descriptor, (off_t)size) ? NULL : map_file(descriptor, size, PROT_READ | PROT_WRITE);
    bool packed = memory && conus_atlas_pack(memory, size, atlas) == CONUS_OK;
    if (memory) {
        munmap(memory, size);
    }
    return packed && fcntl(descriptor, F_ADD_SEALS, F_SEAL_WRITE | F_SEAL_SHRINK | F_SEAL_GROW | F_SEAL_SEAL) == 0;
}

static struct address offer_atlas(const conus_atlas *atlas)
{
    struct address address = {.process = getpid(), .size = conus_atlas_packed_size(atlas)};
    /* A limit on the sizes of files (ulimit -f) is one on these, too; to exceed it ends a program. */
    struct rlimit limit;
    bool is_allowed =
        getrlimit(RLIMIT_FSIZE, &limit) == 0 && (limit.rlim_cur == RLIM_INFINITY || address.size <= limit.rlim_cur);
    address.descriptor = is_allowed ? memfd_create("conus-atlas", MFD_CLOEXEC | MFD_ALLOW_SEALING) : -1;
    if (address.descriptor >= 0 && !pack_atlas(address.descriptor, address.size, atlas)) {
        close(address.descriptor);
        address.descriptor = -1;
    }
    return address;
}

/* Opens the file at the address; -1 if it is another one: processes have other numbers in other containers. */
static int open_address(const struct address *address)
{
    char path[64];
    struct stat info;
    snprintf(path, sizeof path, "/proc/%ld/fd/%d", address->process, address->descriptor);
    int descriptor = address->descriptor < 0 ? -1 : open(path, O_RDONLY | O_CLOEXEC);
    if (descriptor >= 0 &&
        (fstat(descriptor, &info) || (size_t)info.st_size != address->size || fcntl(descriptor, F_GET_SEALS) <= 0)) {
        close(descriptor);
        return -1;
    }
    return descriptor;
}

static void attach_atlas(struct node_atlas *out, conus_atlas **atlas, const struct address *address)
{
    int descriptor = open_address(address);
    conus_atlas *attached = NULL;
    void *memory = descriptor < 0 ? NULL : map_file(descriptor, address->size, PROT_READ);
    if (descriptor >= 0) {
        close(descriptor);
    }
    if (memory && conus_atlas_attach(&attached, memory, address->size)) {
        munmap(memory, address->size);
        memory = NULL;
    }
    if (memory) {
        conus_atlas_destroy(*atlas);
        *atlas = attached;
        *out = (struct node_atlas){memory, address->size};
    }
}

void node_atlas_share(struct node_atlas *out, conus_atlas **atlas, MPI_Comm node)
{
    struct address address = {.descriptor = -1};
    int rank;
    int ranks;
    *out = (struct node_atlas){0};
    MPI_Comm_rank(node, &rank);
    MPI_Comm_size(node, &ranks);
    if (ranks == 1) {
        return;
    }
    if (rank == 0) {
        address = offer_atlas(*atlas);
    }
    MPI_Bcast(&address, sizeof address, MPI_BYTE, 0, node);
    attach_atlas(out, atlas, &address);
    MPI_Barrier(node); /* all have it open */
    if (address.descriptor >= 0 && rank == 0) {
        close(address.descriptor);
    }
}

void node_atlas_finish(struct node_atlas *shared)
{
    if (shared->memory) {
        munmap((void *)shared->memory, shared->size);
    }
    *shared = (struct node_atlas){0};
}
