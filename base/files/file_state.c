/* SPDX-License-Identifier: BSD-3-Clause */
/* A file's identity: its state, and the SHA-256 of its bytes. */
#include "base/files/file.h"

#include "base/system/system.h"

#include <nettle/sha2.h>
#include <stdio.h>
#include <string.h>

void file_state_take(struct file_state *out, const struct system_stat *info)
{
    *out =
        (struct file_state){info->device,
                            info->inode,
                            info->size,
                            {info->changed.tv_sec, info->changed.tv_nsec, info->altered.tv_sec, info->altered.tv_nsec}};
}

bool file_state_of(struct file_state *out, int descriptor)
{
    struct system_stat info;
    bool found = system_stat_open(&info, descriptor);
    if (found) {
        file_state_take(out, &info);
    }
    return found;
}

bool file_state_equal(const struct file_state *a, const struct file_state *b)
{
    return memcmp(a, b, sizeof *a) == 0;
}

void file_sha256_end(char out[65], struct sha256_ctx *context)
{
    uint8_t digest[SHA256_DIGEST_SIZE];
    sha256_digest(context, sizeof digest, digest);
    for (size_t i = 0; i < sizeof digest; i++) {
        snprintf(out + 2 * i, 3, "%02x", digest[i]);
    }
}

void file_sha256(char out[65], const struct bytes *bytes)
{
    struct sha256_ctx context;
    sha256_init(&context);
    sha256_update(&context, bytes->size, bytes->data);
    file_sha256_end(out, &context);
}
