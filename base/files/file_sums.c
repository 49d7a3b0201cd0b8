/* SPDX-License-Identifier: BSD-3-Clause */
/* A list of the files that were read, with their SHA-256. */
#include "base/files/file.h"

#include "base/memory.h"

#include <nettle/sha2.h>
#include <string.h>

void file_sums_cut(struct file_sums *sums, size_t count)
{
    name_set_finish(&sums->paths);
    while (sums->count > count) {
        memory_free(sums->items[--sums->count].path);
    }
}

void file_sums_finish(struct file_sums *sums)
{
    file_sums_cut(sums, 0);
    memory_free(sums->items);
    *sums = (struct file_sums){0};
}

static conus_status find_path(bool *out, struct file_sums *sums, const char *path)
{
    conus_status status = CONUS_OK;
    while (!status && sums->paths.count < sums->count) {
        status = name_set_add(&sums->paths, sums->items[sums->paths.count].path, sums->paths.count);
    }
    *out = !status && name_set_find(&sums->paths, path);
    return status;
}

/* Takes the path of `sum`. */
static conus_status append_sum(struct file_sums *sums, const struct file_sum *sum)
{
    struct file_sum *items = memory_resize(sums->items, sums->count + 1, sizeof *items);
    if (!items) {
        return CONUS_ERROR_MEMORY;
    }
    sums->items = items;
    items[sums->count++] = *sum;
    return CONUS_OK;
}

conus_status file_sums_put(struct file_sums *sums, const char *path, const char sha256[65])
{
    bool known;
    conus_status status = find_path(&known, sums, path);
    if (status || known) {
        return status;
    }
    inputs_take(path);
    struct file_sum sum = {.path = memory_text(path, strlen(path))};
    memcpy(sum.sha256, sha256, sizeof sum.sha256);
    status = sum.path ? append_sum(sums, &sum) : CONUS_ERROR_MEMORY;
    if (status) {
        memory_free(sum.path);
    }
    return status;
}

conus_status file_sha256_open(char out[65], const struct open_file *file, bool (*stops)(void *user), void *user)
{
    enum { PART = 1 << 20 };
    struct sha256_ctx context;
    uint8_t *part = memory_raw(PART, 1);
    conus_status status = part ? CONUS_OK : CONUS_ERROR_MEMORY;
    sha256_init(&context);
    for (uint64_t at = 0; !status && at < file->before.size; at += PART) {
        uint64_t left = file->before.size - at;
        size_t size = left < PART ? (size_t)left : PART;
        status = stops && stops(user) ? CONUS_ERROR_CANCELLED : file_part_here(part, file, at, size);
        sha256_update(&context, status ? 0 : size, part);
    }
    memory_free(part);
    if (!status) {
        file_sha256_end(out, &context);
    }
    return status;
}

conus_status file_sums_add_open(struct file_sums *sums, const struct open_file *file)
{
    char sha256[65];
    conus_status status = file_sha256_open(sha256, file, NULL, NULL);
    return status ? fail_in(status, file->path) : file_sums_put(sums, file->path, sha256);
}

conus_status file_sums_add(struct file_sums *sums, const char *path, const struct bytes *content)
{
    char sha256[65];
    bool known;
    conus_status status = find_path(&known, sums, path);
    if (status || known) {
        return status;
    }
    file_sha256(sha256, content);
    return file_sums_put(sums, path, sha256);
}

conus_status file_sums_move(struct file_sums *sums, struct file_sums *from)
{
    conus_status status = CONUS_OK;
    for (size_t i = 0; !status && i < from->count; i++) {
        bool known;
        status = find_path(&known, sums, from->items[i].path);
        if (!status && !known) {
            status = append_sum(sums, &from->items[i]);
            from->items[i].path = status ? from->items[i].path : NULL;
        }
    }
    file_sums_finish(from);
    return status;
}
