/* SPDX-License-Identifier: BSD-3-Clause */
/* The program conus-hdf5: opens the HDF5 file that is its descriptor 3, and answers what was asked. */
#include "conus_hdf5.h"

#include "base/system/system.h"

#include <conus/version.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { INPUT = 3 };

/* Bytes of memory for libhdf5's own, beside the file and the datasets. */
#define MEMORY_SPARE (UINT64_C(1) << 27)

/* The mapped file, which libhdf5 takes in place of memory of its own: nothing is copied, nothing freed. */
static void *image;

static void *image_place(size_t size, H5FD_file_image_op_t use, void *user)
{
    (void)size;
    (void)use;
    (void)user;
    return image;
}

static void *image_keep(void *out, const void *from, size_t size, H5FD_file_image_op_t use, void *user)
{
    (void)size;
    (void)use;
    (void)user;
    return out == from ? out : NULL;
}

static herr_t image_leave(void *memory, H5FD_file_image_op_t use, void *user)
{
    (void)memory;
    (void)use;
    (void)user;
    return 0;
}

/* Where nothing can be: libhdf5 refuses an image with the name of a file that exists. */
static const char image_name[] = "/dev/null/image";

static hid_t open_input(void)
{
    H5FD_file_image_callbacks_t callbacks = {
        .image_malloc = image_place, .image_memcpy = image_keep, .image_free = image_leave};
    struct system_stat info;
    if (!system_stat_open(&info, INPUT) || !info.size) {
        refuse(false, "an HDF5 file of at least one byte is needed");
    }
    image = system_map(INPUT, (size_t)info.size);
    memory_allow(MEMORY_SPARE + info.size); /* packed bytes are copied, too */
    hid_t access = H5Pcreate(H5P_FILE_ACCESS);
    bool fine = image && access >= 0 && H5Pset_fapl_core(access, 1 << 16, false) >= 0 &&
                H5Pset_file_image_callbacks(access, &callbacks) >= 0 &&
                H5Pset_file_image(access, image, (size_t)info.size) >= 0;
    hid_t file = fine ? H5Fopen(image_name, H5F_ACC_RDONLY, access) : -1;
    if (file < 0) {
        refuse_damaged("HDF5", "open it");
    }
    return file;
}

static const char help[] =
    "usage: conus-hdf5 BYTES PATTERN... 3<FILE\n\nReads an HDF5 file for conus; see base/child/hdf5_protocol.h. It is "
    "no command for people.\n";

/* Answers --version and --help; false where the word is neither. */
static bool is_answered(const char *word)
{
    if (strcmp(word, "--version") == 0) {
        puts("conus " CONUS_VERSION);
        return true;
    }
    if (strcmp(word, "--help") == 0 || strcmp(word, "-h") == 0) {
        fputs(help, stdout);
        return true;
    }
    return false;
}

int main(int argc, char **argv)
{
    char *end = NULL;
    system_begin(&argc, &argv, false);
    if (argc == 2 && is_answered(argv[1])) {
        return fflush(stdout) ? 1 : 0;
    }
    uint64_t limit = argc > 2 ? strtoull(argv[1], &end, 10) : 0;
    if (!end || *end) {
        fputs(help, stderr);
        return 2;
    }
    /* A filter that the file names would else be looked for in folders, and loaded. Variables choose drivers, too. */
    system_forget_variables();
    stream_begin(limit);
    if (H5PLset_loading_state(0) < 0 || H5Eset_auto2(H5E_DEFAULT, NULL, NULL) < 0) {
        refuse(false, "libhdf5 cannot be told to load nothing");
    }
    hid_t file = open_input();
    for (int i = 2; i < argc; i++) {
        write_objects(file, argv[i]);
    }
    stream_end();
}
