/* SPDX-License-Identifier: BSD-3-Clause */
/* Lists the names in a folder, and makes paths. */
#include "base/files/file.h"

#include "base/memory.h"
#include "base/order.h"
#include "base/system/system.h"

#include <string.h>

void names_finish(struct names *names)
{
    for (size_t i = 0; i < names->count; i++) {
        memory_free(names->names[i]);
    }
    memory_free(names->names);
}

static bool ends_with(const char *name, const char *ending)
{
    if (strchr(ending, '/')) {
        return path_ending_length(name, ending);
    }
    size_t length = strlen(name);
    size_t tail = strlen(ending);
    return length >= tail && strcmp(name + length - tail, ending) == 0;
}

conus_status names_add(struct names *names, const char *name)
{
    char **grown = memory_resize(names->names, names->count + 1, sizeof *grown);
    if (!grown) {
        return CONUS_ERROR_MEMORY;
    }
    names->names = grown;
    char *copy = memory_text(name, strlen(name));
    if (!copy) {
        return CONUS_ERROR_MEMORY;
    }
    grown[names->count++] = copy;
    return CONUS_OK;
}

/* What names_list() looks for. */
struct wanted {
    struct names *out;
    const char *ending;
    conus_status status;
};

static bool take_name(void *user, const char *name)
{
    struct wanted *wanted = user;
    bool is_full = wanted->out->count >= NAMES_LIMIT;
    if (!is_full && ends_with(name, wanted->ending)) {
        wanted->status = names_add(wanted->out, name);
    }
    return !is_full && !wanted->status;
}

conus_status names_list(struct names *out, const char *folder, const char *ending)
{
    struct wanted wanted = {.out = out, .ending = ending};
    system_list(folder, take_name, &wanted);
    if (!wanted.status) {
        order_sort(out->names, out->count, sizeof *out->names, compare_text_pointers);
    }
    return wanted.status;
}

char *path_folder(const char *path)
{
    size_t length = path_folder_length(path);
    return length ? memory_text(path, length) : memory_text("./", 2);
}
