/* SPDX-License-Identifier: BSD-3-Clause */
/* Keeps what a thread asks of the file system, and asks it again. */
#include "base/files/file_trace.h"

#include "base/files/inputs.h"
#include "base/memory.h"
#include "base/order.h"
#include "base/system/system.h"

#include <stdlib.h>
#include <string.h>

static _Thread_local struct file_trace *open_trace; /* of this thread; NULL = none */

void file_trace_finish(struct file_trace *trace)
{
    for (size_t i = 0; i < trace->count; i++) {
        memory_free(trace->items[i].path);
        memory_free(trace->items[i].more);
    }
    memory_free(trace->items);
    *trace = (struct file_trace){0};
}

/* Takes over the strings of `item`. Without memory its path is NULL, or `more` where there was one; then the trace is
 * broken. */
static void append_item(struct file_trace *trace, struct traced item, const char *given)
{
    bool whole = item.path && (item.more || !given) &&
                 memory_reserve(&trace->items, &trace->capacity, trace->count + 1, sizeof item);
    if (whole) {
        trace->items[trace->count++] = item;
        return;
    }
    memory_free(item.path);
    memory_free(item.more);
    trace->broken = true;
}

static void keep(enum trace_kind kind, const char *path, const char *more, const struct file_state *state,
                 const char *sum)
{
    struct traced item = {.kind = kind, .path = memory_text(path, strlen(path))};
    item.more = more ? memory_text(more, strlen(more)) : NULL;
    if (state) {
        item.state = *state;
    }
    if (sum) {
        memcpy(item.sum, sum, sizeof item.sum);
    }
    append_item(open_trace, item, more);
}

static enum trace_kind kind_of(struct file_state *out, const struct system_stat *info)
{
    *out = (struct file_state){0};
    if (!info) {
        return TRACE_NOTHING;
    }
    if (info->kind == SYSTEM_FILE) {
        file_state_take(out, info);
        return TRACE_FILE;
    }
    out->device = info->device;
    out->inode = info->inode;
    return info->kind == SYSTEM_FOLDER ? TRACE_FOLDER : TRACE_OTHER;
}

void file_trace_path(const char *path, const struct system_stat *info)
{
    struct file_state state;
    if (open_trace) {
        enum trace_kind kind = kind_of(&state, info);
        keep(kind, path, NULL, &state, NULL);
    }
}

void file_trace_input(const char *path, const struct system_stat *info)
{
    file_trace_path(path, info);
    if (inputs_read(path, info) && open_trace && open_trace->count) {
        open_trace->items[open_trace->count - 1].is_input = true;
    }
}

void file_trace_take(const char *path)
{
    struct system_stat info;
    if (inputs_search(false)) {
        if (path && system_stat(&info, path)) {
            file_trace_input(path, &info);
        }
        inputs_search(true);
    }
}

void file_trace_tell(const struct file_trace *trace)
{
    for (size_t i = 0; i < trace->count; i++) {
        if (trace->items[i].is_input) {
            inputs_put(trace->items[i].path, &trace->items[i].state);
        }
    }
}

void file_trace_failed(void)
{
    if (open_trace) {
        open_trace->broken = true;
    }
}

static void sum_names(char out[65], const struct names *names)
{
    struct buffer all = {0};
    for (size_t i = 0; i < names->count; i++) {
        buffer_append(&all, names->names[i], strlen(names->names[i]) + 1);
    }
    const struct bytes bytes = {(uint8_t *)all.data, all.size};
    file_sha256(out, &bytes);
    out[0] = all.failed ? '\0' : out[0];
    buffer_finish(&all);
}

conus_status names_list(struct names *out, const char *folder, const char *ending)
{
    conus_status status = names_read(out, folder, ending);
    char sum[65];
    if (!status && open_trace) {
        sum_names(sum, out);
        open_trace->broken = open_trace->broken || !sum[0];
        keep(TRACE_NAMES, folder, ending, NULL, sum);
    }
    return status;
}

const char *file_trace_environment(const char *name)
{
    const char *value = system_variable(name);
    if (open_trace) {
        keep(TRACE_ENVIRONMENT, name, value, NULL, NULL);
    }
    return value;
}

bool file_trace_real_path(char *out, const char *path)
{
    bool found = system_real_path(out, path);
    if (open_trace) {
        keep(TRACE_REAL_PATH, path, found ? out : NULL, NULL, NULL);
    }
    return found;
}

void file_trace_begin(struct file_trace *out)
{
    *out = (struct file_trace){0};
    clock_gettime(CLOCK_REALTIME, &out->begun);
    open_trace = out;
}

static int compare_texts(const char *a, const char *b)
{
    return a && b ? strcmp(a, b) : (a != NULL) - (b != NULL);
}

/* Whether they are the same question: the kinds up to TRACE_OTHER are answers to one. */
static int compare_questions(const struct traced *a, const struct traced *b)
{
    int topic[2] = {a->kind < TRACE_OTHER ? TRACE_OTHER : (int)a->kind,
                    b->kind < TRACE_OTHER ? TRACE_OTHER : (int)b->kind};
    int order = topic[0] - topic[1];
    order = order ? order : strcmp(a->path, b->path);
    return order || topic[0] != TRACE_NAMES ? order : strcmp(a->more, b->more);
}

static int compare_items(const void *a, const void *b)
{
    return compare_questions(a, b);
}

void file_trace_end(struct file_trace *trace)
{
    size_t kept = 0;
    open_trace = NULL;
    order_sort(trace->items, trace->count, sizeof *trace->items, compare_items);
    for (size_t i = 0; i < trace->count; i++) {
        struct traced *last = kept ? &trace->items[kept - 1] : NULL;
        bool repeated = last && compare_questions(last, &trace->items[i]) == 0;
        trace->broken = trace->broken || (repeated && !(last->kind == trace->items[i].kind &&
                                                        compare_texts(last->more, trace->items[i].more) == 0 &&
                                                        file_state_equal(&last->state, &trace->items[i].state) &&
                                                        memcmp(last->sum, trace->items[i].sum, sizeof last->sum) == 0));
        if (repeated) {
            last->is_input = last->is_input || trace->items[i].is_input;
            memory_free(trace->items[i].path);
            memory_free(trace->items[i].more);
        } else {
            trace->items[kept++] = trace->items[i];
        }
    }
    trace->count = kept;
}

const struct traced *file_trace_find(const struct file_trace *trace, const char *path)
{
    const struct traced key = {.kind = TRACE_FILE, .path = (char *)path};
    const struct traced *found =
        trace->count ? bsearch(&key, trace->items, trace->count, sizeof key, compare_items) : NULL;
    size_t length = strlen(path);
    bool is_folder = found && found->kind == TRACE_FOLDER;
    for (size_t i = 0; is_folder && i < trace->count; i++) {
        const struct traced *item = &trace->items[i];
        if (item->kind == TRACE_FILE && strncmp(item->path, path, length) == 0 && item->path[length] == '/') {
            return item;
        }
    }
    return found && found->kind == TRACE_FILE ? found : NULL;
}

/* Size, inode, mtime and ctime do not show a second change within one step of the clock, so a file must have rested for
 * a while. A server's clock may be wrong, and does not say for how long. */
bool file_trace_is_settled(const struct file_trace *trace)
{
    bool settled = !trace->broken;
    for (size_t i = 0; i < trace->count && settled; i++) {
        const struct traced *item = &trace->items[i];
        settled = item->kind != TRACE_OTHER;
        if (item->kind == TRACE_FILE) {
            const int64_t *times = item->state.times;
            int64_t last = times[0] > times[2] ? times[0] : times[2];
            int64_t rest = (int64_t)trace->begun.tv_sec - last; /* at least, but for a second */
            settled =
                rest > TRACE_REST_ELSEWHERE_SECONDS || (rest > TRACE_REST_SECONDS && system_has_own_clock(item->path));
        }
    }
    return settled;
}

static bool find_kind(enum trace_kind *out, struct file_state *state, const char *path)
{
    struct system_stat info;
    bool found = system_stat(&info, path);
    *out = kind_of(state, found ? &info : NULL);
    int descriptor = *out == TRACE_FILE ? system_open(path, SYSTEM_READ | SYSTEM_AT_ONCE) : -1;
    if (*out != TRACE_FILE) {
        return true;
    }
    found = descriptor >= 0 && system_stat_open(&info, descriptor);
    *out = kind_of(state, found ? &info : NULL);
    if (descriptor >= 0) {
        close(descriptor);
    }
    return found;
}

static bool same_names(const struct traced *item)
{
    struct names names = {0};
    char sum[65] = "";
    if (!names_read(&names, item->path, item->more)) {
        sum_names(sum, &names);
    }
    names_finish(&names);
    return memcmp(sum, item->sum, sizeof sum) == 0;
}

static bool holds(const struct traced *item)
{
    struct file_state state;
    enum trace_kind kind;
    char real[SYSTEM_PATH];
    switch (item->kind) {
    case TRACE_NAMES:
        return same_names(item);
    case TRACE_REAL_PATH:
        return compare_texts(system_real_path(real, item->path) ? real : NULL, item->more) == 0;
    case TRACE_ENVIRONMENT:
        return compare_texts(system_variable(item->path), item->more) == 0;
    case TRACE_NOTHING:
    case TRACE_FILE:
    case TRACE_FOLDER:
        return find_kind(&kind, &state, item->path) && kind == item->kind && file_state_equal(&state, &item->state);
    case TRACE_OTHER:
    case TRACE_KINDS:
        break;
    }
    return false;
}

bool file_trace_holds(const struct file_trace *trace)
{
    struct file_trace *own = open_trace;
    bool same = !trace->broken;
    open_trace = NULL; /* these questions are not recorded */
    for (size_t i = 0; i < trace->count && same; i++) {
        same = holds(&trace->items[i]);
    }
    open_trace = own;
    return same;
}

/* Ahead of the strings of an item. Sizes count a final NUL; 0 = no string. */
struct item_head {
    uint64_t kind, path_size, more_size, is_input;
    struct file_state state;
    char sum[72];
};

void file_trace_write(struct buffer *out, const struct file_trace *trace)
{
    for (size_t i = 0; i < trace->count; i++) {
        const struct traced *item = &trace->items[i];
        struct item_head head = {.kind = item->kind,
                                 .path_size = strlen(item->path) + 1,
                                 .more_size = item->more ? strlen(item->more) + 1 : 0,
                                 .is_input = item->is_input,
                                 .state = item->state};
        memcpy(head.sum, item->sum, sizeof item->sum);
        buffer_append(out, &head, sizeof head);
        buffer_append(out, item->path, head.path_size);
        if (item->more) {
            buffer_append(out, item->more, head.more_size);
        }
    }
}

/* Whether `size` bytes are a string and its end. */
static bool is_text(const uint8_t *data, uint64_t size)
{
    return size && memchr(data, 0, size) == data + size - 1;
}

/* The item at the beginning of the bytes; its size, 0 where there is none. */
static size_t parse_item(struct file_trace *out, const uint8_t *data, size_t size)
{
    struct item_head head;
    if (size < sizeof head) {
        return 0;
    }
    memcpy(&head, data, sizeof head);
    size -= sizeof head;
    const uint8_t *path = data + sizeof head;
    bool fits = head.kind < TRACE_KINDS && head.path_size <= size && head.more_size <= size - head.path_size &&
                is_text(path, head.path_size) && head.sum[sizeof head.sum - 1] == '\0' &&
                (!head.more_size || is_text(path + head.path_size, head.more_size)) &&
                (head.kind != TRACE_NAMES || head.more_size);
    if (!fits) {
        return 0;
    }
    const char *more = head.more_size ? (const char *)path + head.path_size : NULL;
    struct traced item = {.kind = (enum trace_kind)head.kind,
                          .path = memory_text((const char *)path, head.path_size - 1),
                          .more = more ? memory_text(more, head.more_size - 1) : NULL,
                          .is_input = head.is_input,
                          .state = head.state};
    memcpy(item.sum, head.sum, sizeof item.sum);
    append_item(out, item, more);
    return out->broken ? 0 : sizeof head + head.path_size + head.more_size;
}

bool file_trace_parse(struct file_trace *out, const uint8_t *data, size_t size)
{
    struct file_trace trace = {0};
    size_t used = 1;
    for (size_t at = 0; at < size && used; at += used) {
        used = parse_item(&trace, data + at, size - at);
    }
    if (!used) {
        file_trace_finish(&trace);
        return false;
    }
    *out = trace;
    return true;
}
