/* SPDX-License-Identifier: BSD-3-Clause */
/* Lists the files that the process has read, each once or more often, and those that it has made. */
#include "base/files/file.h"

#include "base/memory.h"
#include "base/system/system.h"
#include "conus/own.h"

#include <pthread.h>
#include <string.h>

struct input {
    char *path; /* owned */
    struct file_state state;
};

struct input_list {
    struct input *items;
    size_t count, capacity;
    bool broken; /* there was no memory for one */
};

static _Thread_local bool is_searching;

static pthread_mutex_t inputs_lock = PTHREAD_MUTEX_INITIALIZER;
static bool are_kept; /* somebody asked for it */
static struct input_list inputs, products;

static void append(struct input_list *list, const char *path, const struct file_state *state)
{
    struct input item = {.path = memory_text(path, strlen(path)), .state = *state};
    if (item.path && memory_reserve(&list->items, &list->capacity, list->count + 1, sizeof item)) {
        list->items[list->count++] = item;
        return;
    }
    memory_free(item.path);
    list->broken = true;
}

static bool state_of(struct file_state *out, const struct system_stat *info)
{
    bool is_file = info && info->kind == SYSTEM_FILE;
    if (is_file) {
        file_state_take(out, info);
    }
    return is_file;
}

static void put(const char *path, const struct file_state *state)
{
    bool is_product = false; /* what the process itself has made may be made anew */
    pthread_mutex_lock(&inputs_lock);
    for (size_t i = 0; i < products.count; i++) {
        is_product = is_product || file_state_equal(&products.items[i].state, state);
    }
    if (are_kept && !is_product) {
        append(&inputs, path, state);
    }
    pthread_mutex_unlock(&inputs_lock);
}

void inputs_read(const char *path, const struct system_stat *info)
{
    struct file_state state;
    if (!is_searching && state_of(&state, info)) {
        put(path, &state);
    }
}

void inputs_product(const char *path)
{
    struct system_stat info;
    struct file_state state;
    pthread_mutex_lock(&inputs_lock);
    if (are_kept && system_stat(&info, path) && state_of(&state, &info)) {
        append(&products, path, &state);
    }
    pthread_mutex_unlock(&inputs_lock);
}

bool inputs_search(bool searches)
{
    bool before = is_searching;
    is_searching = searches;
    return before;
}

void inputs_take(const char *path)
{
    if (inputs_search(false)) {
        conus_inputs_add(path);
        inputs_search(true);
    }
}

/* Whether a file with the state is this input: not another one, with its number, after the input was removed. */
static bool is_input(const struct input *input, const struct file_state *state)
{
    struct system_stat info;
    return input->state.device == state->device && input->state.inode == state->inode &&
           (file_state_equal(&input->state, state) ||
            (system_stat(&info, input->path) && info.device == state->device && info.inode == state->inode));
}

/* The name of the input that is this file; with no memory for all inputs, any file may be one. */
const char *conus_inputs_find(const char *path)
{
    struct system_stat info;
    struct file_state state;
    const char *found = NULL;
    pthread_mutex_lock(&inputs_lock);
    if (are_kept && path && system_stat(&info, path) && state_of(&state, &info)) {
        found = inputs.broken ? path : NULL;
        for (size_t i = 0; i < inputs.count && !found; i++) {
            found = is_input(&inputs.items[i], &state) ? inputs.items[i].path : NULL;
        }
    }
    pthread_mutex_unlock(&inputs_lock);
    return found;
}

static void lock_inputs(void)
{
    pthread_mutex_lock(&inputs_lock);
}

static void unlock_inputs(void)
{
    pthread_mutex_unlock(&inputs_lock);
}

conus_status conus_inputs_keep(void)
{
    pthread_mutex_lock(&inputs_lock);
    if (!are_kept) {
        pthread_atfork(lock_inputs, unlock_inputs, unlock_inputs); /* a child would wait for ever */
    }
    are_kept = true;
    pthread_mutex_unlock(&inputs_lock);
    return CONUS_OK;
}

void conus_inputs_add(const char *path)
{
    struct system_stat info;
    if (path && system_stat(&info, path)) {
        inputs_read(path, &info);
    }
}

const char *conus_inputs_at(size_t index)
{
    pthread_mutex_lock(&inputs_lock);
    const char *path = index < inputs.count ? inputs.items[index].path : NULL;
    pthread_mutex_unlock(&inputs_lock);
    return path;
}
