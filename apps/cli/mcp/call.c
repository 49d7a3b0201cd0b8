/* SPDX-License-Identifier: BSD-3-Clause */
/* A call: its members become a command line, which a child answers. */
#include "base/child/process.h"
#include "base/system/system.h"
#include "cli/answers/answers.h"
#include "cli/mcp/mcp.h"
#include "options/messages.h"

#include <inttypes.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

enum { WORD_LIMIT = 1000, ROW_LIMIT = 200, SECOND_LIMIT = 60, READ_SIZE = 1 << 16, ANSWER_LIMIT = 1 << 26 };

struct calling {
    const struct mcp_call *call;
    struct command_words words;
    struct system_text out, said; /* stdout and stderr */
    char why[1024];               /* of a refusal */
};

static bool refuse_call(struct calling *calling, const char *format, ...) __attribute__((format(printf, 2, 3)));

static bool refuse_call(struct calling *calling, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    vsnprintf(calling->why, sizeof calling->why, format, args);
    va_end(args);
    make_plain_line(calling->why);
    return false;
}

/* A word; with a name, an option's. */
static bool put_word(struct calling *calling, const char *name, const char *value)
{
    if (calling->words.count == WORD_LIMIT) {
        return refuse_call(calling, "more than %d values", WORD_LIMIT);
    }
    words_put(&calling->words, name, value);
    return !calling->words.is_lost || refuse_call(calling, "not enough memory");
}

/* Whether a text is neither an option, standard input, nor a list in a file, and no path leads out of the folders. */
static bool check_text(struct calling *calling, const char *member, const char *text, enum option_role role)
{
    const char *at = strchr(text, '@');
    if (strlen(text) >= SYSTEM_PATH) {
        return refuse_call(calling, "%s: a text of %zu bytes", member, strlen(text));
    }
    if (*text == '-') {
        return refuse_call(calling, "%s: \"%.200s\" begins with \"-\"; numbers are given as [X, Y, Z]", member, text);
    }
    if (at && (at == text || strchr(", ", at[-1]) || role == OPTION_READS_NAMES)) {
        return refuse_call(calling, "%s: \"%.200s\": a list in a file is not read; names are given as they are", member,
                           text);
    }
    if (!mcp_roots_have(calling->call->roots, text)) {
        return refuse_call(
            calling,
            "%s: \"%.200s\" is not in a folder that conus mcp may read, or has more than %d words; conus "
            "mcp --root FOLDER says which folders it may",
            member, text, MCP_PIECES);
    }
    return (role != OPTION_READS_NAMES || !system_allows(text, 0)) ||
           refuse_call(calling, "%s: \"%.200s\" is a file; names are given as they are", member, text);
}

static bool put_text(struct calling *calling, const char *member, const char *name, const json_t *value,
                     enum option_role role)
{
    return json_is_string(value) ? check_text(calling, member, json_string_value(value), role) &&
                                       put_word(calling, name, json_string_value(value))
                                 : refuse_call(calling, "%s: wanted is a text", member);
}

/* Numbers with commas between them. */
static bool put_numbers(struct calling *calling, const char *member, const char *name, const json_t *list, size_t count)
{
    char text[256] = "";
    size_t i;
    const json_t *value;
    int used = 0;
    bool fine = json_array_size(list) == count;
    json_array_foreach(list, i, value)
    {
        fine = fine && json_is_number(value);
        used +=
            fine ? snprintf(text + used, sizeof text - (size_t)used, "%s%.17g", i ? "," : "", json_number_value(value))
                 : 0;
    }
    return fine ? put_word(calling, name, text) : refuse_call(calling, "%s: wanted are %zu numbers", member, count);
}

/* A text, or of a place three numbers. */
static bool put_value(struct calling *calling, const char *member, const struct option *option, const json_t *value)
{
    return option->flags & OPTION_IS_PLACE && json_is_array(value)
               ? put_numbers(calling, member, option->name, value, 3)
               : put_text(calling, member, option->name, value, option->role);
}

static bool put_values(struct calling *calling, const char *member, const struct option *option, const json_t *list)
{
    size_t i;
    const json_t *value;
    if (json_is_string(list) || json_is_number(json_array_get(list, 0))) { /* of a list of one, that one */
        return put_value(calling, member, option, list);
    }
    bool fine = json_is_array(list) || refuse_call(calling, "%s: wanted is a list", member);
    json_array_foreach(list, i, value)
    {
        fine = fine && put_value(calling, member, option, value);
    }
    return fine;
}

static bool put_number(struct calling *calling, const char *member, const char *name, const json_t *value, bool whole)
{
    char text[64];
    if (whole ? !json_is_integer(value) : !json_is_number(value)) {
        return refuse_call(calling, "%s: wanted is a %snumber", member, whole ? "whole " : "");
    }
    snprintf(text, sizeof text, "%.17g", json_number_value(value));
    return put_word(calling, name, text);
}

static bool put_option(struct calling *calling, const char *member, const struct option *option, const json_t *value)
{
    static const size_t sizes[] = {[OPTION_VECTOR] = 3, [OPTION_RANGE] = 2, [OPTION_EDGES] = 4};
    const char *name = option->name;
    switch (option->type) {
    case OPTION_FLAG:
        return json_is_boolean(value) ? !json_is_true(value) || put_word(calling, name, NULL)
                                      : refuse_call(calling, "%s: wanted is true or false", member);
    case OPTION_NUMBER:
    case OPTION_COUNT:
        return put_number(calling, member, name, value, option->type == OPTION_COUNT);
    case OPTION_VECTOR:
    case OPTION_RANGE:
    case OPTION_EDGES:
        return option->flags & OPTION_TO_TARGET && json_is_string(value)
                   ? put_text(calling, member, name, value, option->role)
                   : put_numbers(calling, member, name, value, sizes[option->type]);
    case OPTION_LIST:
        return put_values(calling, member, option, value);
    case OPTION_SIZE:
    case OPTION_BYTES:
    case OPTION_CHOICE:
    case OPTION_TEXT:
        break;
    }
    return put_value(calling, member, option, value);
}

/* The option that a call may have by this name; NULL if there is none. */
static const struct option *find_option(const struct command *command, const char *member)
{
    char name[OPTION_LIMIT];
    const struct option *option;
    for (size_t i = 0; (option = option_at(command, i)); i++) {
        mcp_option_name(name, command, option);
        if (*name && strcmp(name, member) == 0) {
            return option;
        }
    }
    return NULL;
}

static bool put_options(struct calling *calling)
{
    const struct command *command = calling->call->command;
    const char *member;
    json_t *value;
    bool fine = true;
    json_object_foreach((json_t *)calling->call->members, member, value)
    {
        bool is_operand = false;
        char name[OPTION_LIMIT];
        for (size_t i = 0; i < OPERAND_LIMIT && command->operands[i]; i++) {
            mcp_operand_name(name, command, i);
            is_operand = is_operand || strcmp(name, member) == 0;
        }
        const struct option *option = is_operand ? NULL : find_option(command, member);
        if (fine && !is_operand) {
            fine = option ? put_option(calling, member, option, value)
                          : refuse_call(calling, "%s has no member \"%s\"", command->name, member);
        }
    }
    return fine;
}

static bool put_operands(struct calling *calling)
{
    const struct command *command = calling->call->command;
    bool fine = true;
    for (size_t i = 0; fine && i < OPERAND_LIMIT && command->operands[i]; i++) {
        char name[OPTION_LIMIT];
        size_t k;
        const json_t *one;
        mcp_operand_name(name, command, i);
        const json_t *value = json_object_get(calling->call->members, name);
        bool is_list = command->repeats && json_is_array(value);
        fine = is_list ? json_array_size(value) || refuse_call(calling, "%s is empty", name)
               : value ? put_text(calling, name, NULL, value, OPTION_READS)
                       : refuse_call(calling, "%s is missing", name);
        json_array_foreach(is_list ? value : NULL, k, one)
        {
            fine = fine && put_text(calling, name, NULL, one, OPTION_READS);
        }
    }
    return fine;
}

/* Whether the command answers in JSON. */
static bool answers_json(const struct command *command)
{
    const struct option *format = option_find(command, "format");
    return format && mcp_is_json_format(format);
}

static bool put_words(struct calling *calling)
{
    const struct mcp_call *call = calling->call;
    char size[32];
    snprintf(size, sizeof size, "%" PRIu64, call->max_memory);
    bool has_memory = call->max_memory && option_find(call->command, "max-memory");
    return put_word(calling, NULL, "conus") && put_word(calling, NULL, call->command->name) && put_options(calling) &&
           (!has_memory || put_word(calling, "max-memory", size)) &&
           (!answers_json(call->command) || put_word(calling, "format", "json")) && put_operands(calling);
}

/* Keeps what it writes. */
static bool read_process(struct calling *calling, struct process *process, double deadline)
{
    static char data[2][READ_SIZE];
    FILE *const to[] = {calling->out.stream, calling->said.stream};
    size_t total = 0;
    while (process_writes(process)) {
        struct process_part parts[] = {{.data = data[0], .capacity = READ_SIZE},
                                       {.data = data[1], .capacity = READ_SIZE}};
        enum process_reading reading = process_read(parts, process, deadline - process_now());
        if (reading != PROCESS_CAME) {
            return reading == PROCESS_LATE ? refuse_call(calling, "no answer within %d s", SECOND_LIMIT)
                                           : refuse_call(calling, "the answer cannot be read");
        }
        for (size_t i = 0; i < 2; i++) {
            fwrite(data[i], 1, parts[i].got, to[i]);
            total += parts[i].got;
        }
        if (total > ANSWER_LIMIT) {
            return refuse_call(calling, "an answer of more than %d MB", ANSWER_LIMIT >> 20);
        }
    }
    return true;
}

/* Runs the words as this program. False unless it ended by itself. */
static bool run_words(struct calling *calling, struct process_end *end)
{
    static const struct process_limits limits = {.space = UINT64_MAX, .seconds = UINT32_MAX};
    char self[SYSTEM_PATH];
    struct process process;
    const struct process_start start = {
        .path = self, .words = calling->words.items, .given = SYSTEM_NO_FILE, .limits = &limits};
    if (!system_program(self) || !process_begin(&process, &start)) {
        return refuse_call(calling, "no program can be started here");
    }
    double deadline = process_now() + SECOND_LIMIT;
    bool ended = read_process(calling, &process, deadline);
    ended = ended && (process_wait(end, &process, deadline - process_now()) ||
                      refuse_call(calling, "no answer within %d s", SECOND_LIMIT));
    process_finish(&process);
    return ended && (end->kind == PROCESS_EXITED || refuse_call(calling, "conus ended: %s", end->how));
}

/* Of a line about a file, words of that file go: a client may read answers, and not any file. */
static void hide_words(char *line)
{
    char *begin = line + (strncmp(line, "conus: ", 7) == 0 ? 7 : 0);
    bool is_of_file = false;
    for (char *colon = begin; (colon = strstr(colon, ": ")) && !is_of_file; colon += 2) {
        *colon = '\0';
        is_of_file = system_allows(begin, 0);
        *colon = ':';
    }
    if (is_of_file) {
        message_drop_quotes(line);
    }
}

/* Lines of stderr. */
static json_t *notes_of(char *said)
{
    json_t *notes = json_array();
    for (char *rest, *line = strtok_r(said, "\n", &rest); line; line = strtok_r(NULL, "\n", &rest)) {
        hide_words(line);
        json_array_append_new(notes, info_json_bytes(line));
    }
    return notes;
}

/* Cuts long lists, and notes it. */
static void cut_rows(json_t *answer, json_t *notes)
{
    const char *name;
    json_t *list;
    json_object_foreach(answer, name, list)
    {
        size_t size = json_array_size(list);
        char line[256];
        if (size > ROW_LIMIT) {
            snprintf(line, sizeof line, "note: %.100s: the first %d of %zu", name, ROW_LIMIT, size);
            json_array_append_new(notes, json_string(line));
            while (json_array_size(list) > ROW_LIMIT) {
                json_array_remove(list, json_array_size(list) - 1);
            }
        }
    }
}

static json_t *result_of(const char *text, bool is_error)
{
    return json_pack("{s:[{s:s, s:o}], s:b, s:s}", "content", "type", "text", "text", info_json_bytes(text), "isError",
                     is_error, "resultType", "complete");
}

/* An answer in JSON, the same as a text; else the text of the command. */
static json_t *answer_result(struct calling *calling, json_t *notes)
{
    const struct arguments line = {
        .command = calling->call->command, .count = (int)calling->words.count, .words = calling->words.items};
    char *command = arguments_text(&line);
    json_t *answer = answers_json(line.command) ? json_loads(calling->out.data, 0, NULL) : NULL;
    cut_rows(answer, notes);
    json_t *whole = json_pack("{s:o*, s:s*, s:O}", "answer", answer, "command", command, "notes", notes);
    char *text = answer ? json_dumps(whole, JSON_COMPACT | JSON_REAL_PRECISION(9)) : NULL;
    json_t *result = result_of(text ? text : calling->out.data, false);
    json_object_set(result, "structuredContent", whole);
    json_decref(whole);
    free(text);
    free(command);
    return result;
}

/* What is wrong, a line each. */
static json_t *refusal_result(const struct calling *calling, const json_t *notes)
{
    struct system_text text;
    FILE *out = system_text_open(&text);
    size_t i;
    const json_t *note;
    if (!out) {
        return NULL;
    }
    fputs(calling->why, out);
    json_array_foreach(notes, i, note)
    {
        fprintf(out, "%s%s", i ? "\n" : "", json_string_value(note));
    }
    json_t *result = result_of(system_text_close(&text) ? text.data : "not enough memory", true);
    free(text.data);
    return result;
}

json_t *mcp_answer(const struct mcp_call *call)
{
    struct calling calling = {.call = call};
    struct process_end end = {0};
    bool opened = system_text_open(&calling.out);
    opened = system_text_open(&calling.said) && opened;
    bool ran = opened && put_words(&calling) && run_words(&calling, &end);
    bool whole = system_text_close(&calling.out);
    whole = system_text_close(&calling.said) && whole;
    json_t *notes = whole && ran ? notes_of(calling.said.data) : json_array();
    bool answered = whole && ran && end.code <= EXIT_DIFFERENT;
    json_t *result = answered ? answer_result(&calling, notes) : refusal_result(&calling, notes);
    json_decref(notes);
    words_finish(&calling.words);
    free(calling.out.data);
    free(calling.said.data);
    return result;
}
