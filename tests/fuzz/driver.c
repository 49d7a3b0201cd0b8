/* SPDX-License-Identifier: BSD-3-Clause */
/* Runs a fuzz target over every file of a corpus folder, and over every prefix of the small ones, so that what the
 * fuzzer once found stays found with any compiler. */
#include "base/files/file.h"

#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

enum { PREFIX_LIMIT = 4096 };

static void run_prefixes(const struct bytes *bytes)
{
    for (size_t size = 0; size < bytes->size && size < PREFIX_LIMIT; size++) {
        uint8_t *exact = malloc(size ? size : 1); /* so that a sanitizer sees one byte too many */
        if (exact) {
            memcpy(exact, bytes->data, size);
            LLVMFuzzerTestOneInput(exact, size);
        }
        free(exact);
    }
}

static bool run_file(const char *path)
{
    struct bytes bytes;
    if (file_read(&bytes, path, 1 << 26)) {
        fprintf(stderr, "%s\n", conus_message());
        return false;
    }
    LLVMFuzzerTestOneInput(bytes.data, bytes.size);
    run_prefixes(&bytes);
    bytes_finish(&bytes);
    return true;
}

int main(int argc, char **argv)
{
    size_t count = 0;
    DIR *folder = argc == 2 ? opendir(argv[1]) : NULL;
    bool fine = folder != NULL;
    for (struct dirent *entry; fine && (entry = readdir(folder));) {
        char path[4096];
        snprintf(path, sizeof path, "%s/%s", argv[1], entry->d_name);
        if (file_exists(path)) {
            fine = run_file(path);
            count++;
        }
    }
    if (folder) {
        closedir(folder);
    }
    printf("%zu inputs replayed\n", count);
    return fine && count ? EXIT_SUCCESS : EXIT_FAILURE;
}
