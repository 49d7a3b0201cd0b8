/* SPDX-License-Identifier: BSD-3-Clause */
/* replay TARGET FOLDER...: runs a fuzz target over every file in corpus folders, and over every prefix of the small
 * ones, so that old findings of the fuzzer are tried again with any compiler. */
#include "base/files/file.h"

#include <ftw.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef int fuzz_target(const uint8_t *data, size_t size);

#define GROUP(name) fuzz_target fuzz_##name;
#include "groups.h"
#undef GROUP

static const struct {
    const char *name;
    fuzz_target *run;
} targets[] = {
#define GROUP(name) {#name, fuzz_##name},
#include "groups.h"
};

enum { PREFIX_LIMIT = 4096 };

static void run_prefixes(fuzz_target *run, const struct bytes *bytes)
{
    for (size_t size = 0; size < bytes->size && size < PREFIX_LIMIT; size++) {
        uint8_t *exact = malloc(size ? size : 1); /* so that a sanitizer notices one byte too many */
        if (exact) {
            memcpy(exact, bytes->data, size);
            run(exact, size);
        }
        free(exact);
    }
}

static bool run_file(fuzz_target *run, const char *path)
{
    struct bytes bytes;
    if (file_read(&bytes, path, 1 << 26)) {
        fprintf(stderr, "%s\n", conus_message());
        return false;
    }
    run(bytes.data, bytes.size);
    run_prefixes(run, &bytes);
    bytes_finish(&bytes);
    return true;
}

static fuzz_target *find_target(const char *name)
{
    for (size_t i = 0; i < sizeof targets / sizeof targets[0]; i++) {
        if (strcmp(targets[i].name, name) == 0) {
            return targets[i].run;
        }
    }
    return NULL;
}

static fuzz_target *target;
static size_t count;

static int replay(const char *path, const struct stat *info, int type, struct FTW *walk)
{
    (void)info;
    (void)walk;
    count += type == FTW_F;
    return type == FTW_F && !run_file(target, path);
}

int main(int argc, char **argv)
{
    enum { OPEN_FOLDERS = 8 };
    target = argc > 2 ? find_target(argv[1]) : NULL;
    bool fine = target != NULL;
    for (int i = 2; i < argc && fine; i++) {
        fine = nftw(argv[i], replay, OPEN_FOLDERS, FTW_PHYS) == 0;
    }
    printf("%zu inputs replayed\n", count);
    return fine && count ? EXIT_SUCCESS : EXIT_FAILURE;
}
