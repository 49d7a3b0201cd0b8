/* SPDX-License-Identifier: BSD-3-Clause */
/* Finds a program, starts it, and takes what it writes. */
#include "base/child/child.h"

#include "base/memory.h"
#include "base/path.h"
#include "base/system/system.h"
#include "base/text.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

enum { WORDS_SIZE = 512, READ_SIZE = 1 << 20 };

static bool is_program(const char *path)
{
    return file_exists(path) && system_allows(path, SYSTEM_RUN);
}

/* "folder/program" if it is there. NULL in *found otherwise. */
static conus_status look_in(char **found, const char *program, const char *folder, size_t length)
{
    struct buffer path = {0};
    buffer_append(&path, folder, length);
    buffer_format(&path, "/%s" PROCESS_FILE_ENDING, program);
    conus_status status = buffer_status(&path);
    if (!status && length && is_program(path.data)) {
        *found = path.data;
        return CONUS_OK;
    }
    buffer_finish(&path);
    return status;
}

/* The program that the environment names. */
static conus_status take_chosen(char **path, const char *chosen, const struct child_program *program)
{
    if (!is_program(chosen)) {
        return fail(CONUS_ERROR_UNSUPPORTED, "%s: %s is no program; %s is needed (Debian package %s)",
                    program->variable, chosen, program->name, program->name);
    }
    char *found = memory_text(chosen, strlen(chosen));
    if (!found) {
        return CONUS_ERROR_MEMORY;
    }
    *path = found;
    return CONUS_OK;
}

conus_status child_find(char **path, const struct child_program *program)
{
    const char *chosen = system_variable(program->variable);
    if (chosen && *chosen) {
        return take_chosen(path, chosen, program);
    }
    char *found = NULL;
    char self[SYSTEM_PATH];
    size_t length = system_program(self) ? path_folder_length(self) : 0;
    conus_status status = length > 1 ? look_in(&found, program->name, self, length - 1) : CONUS_OK;
    const char *list = system_variable("PATH");
    struct text rest = text_from(list ? list : "");
    struct text folder;
    for (bool more = true; !status && !found && text_field(&rest, SYSTEM_LIST, &more, &folder);) {
        status = look_in(&found, program->name, folder.data, folder.size);
    }
    if (!status && !found) {
        return fail(CONUS_ERROR_UNSUPPORTED,
                    "the program %s is not installed (Debian package %s): it is neither beside this program nor in "
                    "PATH nor named by %s",
                    program->name, program->name, program->variable);
    }
    if (!status) {
        *path = found;
    }
    return status;
}

struct child {
    const struct child_task *task;
    const char *name;
    struct process process;
    double deadline; /* monotonic seconds */
    uint8_t *data;   /* what came and is not used */
    size_t size, capacity;
    char words[WORDS_SIZE]; /* the beginning of what it said on stderr */
    size_t word_count;
};

static conus_status fail_system(const struct child *child, const char *action)
{
    return fail(CONUS_ERROR_IO, "%s: cannot %s: %s", child->name, action, text_error(errno));
}

static conus_status start_child(struct child *child, const char *path)
{
    const struct child_task *task = child->task;
    uint64_t space = task->limits.memory + task->limits.beside;
    const struct process_limits limits = {.space = space < task->limits.memory ? UINT64_MAX : space,
                                          .seconds = task->limits.seconds};
    const struct process_start start = {
        .path = path, .words = task->words, .given = task->descriptor, .limits = &limits};
    bool begun = process_begin(&child->process, &start);
    child->deadline = process_now() + task->limits.wait;
    return begun ? CONUS_OK : fail_system(child, "start");
}

/* Capacity for the `wanted` bytes of the next step, and for one more reading. */
static conus_status child_reserve(struct child *child, size_t wanted)
{
    size_t most = wanted > child->size ? wanted : child->size;
    size_t needed = wanted > child->size + READ_SIZE ? wanted : child->size + READ_SIZE;
    if (most > child->task->limits.memory) {
        return fail(CONUS_ERROR_MEMORY, "%s: an answer of %zu bytes, allowed are %llu (--max-memory)", child->name,
                    most, (unsigned long long)child->task->limits.memory);
    }
    if (needed > child->capacity) {
        uint8_t *grown = memory_resize(child->data, needed + needed / 2, 1);
        if (!grown) {
            return CONUS_ERROR_MEMORY;
        }
        child->data = grown;
        child->capacity = needed + needed / 2;
    }
    return CONUS_OK;
}

static conus_status take_output(struct child *child)
{
    size_t used = 0;
    size_t wanted = 0;
    const struct child_task *task = child->task;
    conus_status status = task->take ? task->take(task->user, &used, &wanted, child->data, child->size) : CONUS_OK;
    if (!status && used) {
        child->size -= used;
        memmove(child->data, child->data + used, child->size);
    }
    return status ? status : child_reserve(child, wanted);
}

static conus_status fail_late(const struct child *child)
{
    return fail(CONUS_ERROR_DATA, "%s: no end after %u seconds", child->name, child->task->limits.wait);
}

static conus_status read_output(struct child *child)
{
    uint8_t rest[WORDS_SIZE];
    struct process_part parts[2] = {{.data = child->data + child->size, .capacity = child->capacity - child->size},
                                    {.data = rest, .capacity = sizeof rest}};
    enum process_reading reading = process_read(parts, &child->process, child->deadline - process_now());
    if (reading != PROCESS_CAME) {
        return reading == PROCESS_LATE ? fail_late(child) : fail_system(child, "read what it writes");
    }
    size_t capacity = WORDS_SIZE - 1 - child->word_count;
    size_t kept = parts[PROCESS_ERR].got < capacity ? parts[PROCESS_ERR].got : capacity;
    memcpy(child->words + child->word_count, rest, kept);
    child->word_count += kept;
    child->size += parts[PROCESS_OUT].got;
    return parts[PROCESS_OUT].got ? take_output(child) : CONUS_OK;
}

static conus_status check_end(const struct child *child, const struct process_end *end)
{
    switch (end->kind) {
    case PROCESS_NO_MEMORY:
        return fail(CONUS_ERROR_MEMORY, "%s: killed, most likely since the computer had no memory left", child->name);
    case PROCESS_NO_TIME:
        return fail(CONUS_ERROR_DATA, "%s: no end after %u seconds of work", child->name, child->task->limits.seconds);
    case PROCESS_CRASHED:
        return fail(CONUS_ERROR_DATA, "%s: %s crashed (%s)", child->name, child->task->program->library, end->how);
    case PROCESS_EXITED:
        break;
    }
    if (end->code) {
        struct text rest = {child->words, child->word_count};
        struct text line = {0};
        text_line(&rest, &line);
        return fail(CONUS_ERROR_DATA, "%s: %.*s (exit code %d)", child->name, (int)line.size,
                    line.size ? line.data : "", end->code);
    }
    return CONUS_OK;
}

conus_status child_run(struct bytes *rest, const struct child_task *task)
{
    char *path = NULL;
    struct child child = {.task = task, .name = task->program->name};
    struct process_end end = {0};
    conus_status status = child_find(&path, task->program);
    if (status) {
        return status;
    }
    status = start_child(&child, path);
    memory_free(path);
    if (status) {
        return status;
    }
    status = child_reserve(&child, 0);
    while (!status && process_writes(&child.process)) {
        status = read_output(&child);
    }
    if (!status && !process_wait(&end, &child.process, child.deadline - process_now())) {
        status = fail_late(&child);
    }
    process_finish(&child.process);
    status = status ? status : check_end(&child, &end);
    if (status) {
        memory_free(child.data);
        return status;
    }
    *rest = (struct bytes){child.data, child.size};
    return CONUS_OK;
}
