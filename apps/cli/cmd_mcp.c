/* SPDX-License-Identifier: BSD-3-Clause */
/* conus mcp: answers a program with a language model, a line of JSON-RPC for a line. */
#include "cli/commands.h"
#include "cli/mcp/mcp.h"
#include "conus/version.h"
#include "options/messages.h"
#include "options/output.h"

#include <jansson.h>
#include <stdlib.h>
#include <string.h>

enum { LINE_LIMIT = 1 << 20, NO_JSON = -32700, NO_REQUEST = -32600, NO_METHOD = -32601 };

struct mcp_settings {
    struct option_list roots;
    uint64_t max_memory;
    struct common_settings common;
};

static const struct option own_options[] = {
    {OPTION_VALUED("root", struct mcp_settings, roots, "FOLDER"),
     .help =
         "files in here may be read, and no others but atlases that are installed; relative paths begin in the first "
         "one; may be repeated",
     .otherwise = "the current folder", .words = "folder", .common = true, OPTION_READING(FOLDER)},
    {OPTION_MEMORY(struct mcp_settings, max_memory), .help = "most memory of a call, like 512M or 8G",
     .otherwise = "as of each command"},
    {0},
};

static const struct option_group groups[] = {
    {"Options", own_options, 0},
    {"", plain_options, offsetof(struct mcp_settings, common)},
    {0},
};

static const struct command *const tools[] = {&cmd_query, &cmd_overlap, &cmd_plan, &cmd_info,
                                              &cmd_cite,  &cmd_atlases, NULL};

static const char instructions[] =
    "Positions are RAS mm (x to the right, y to the front, z up), angles degrees. An atlas is a name that the tool "
    "atlases lists, or a file. Rows are named with their share; what is in no area is said. Notes and warnings belong "
    "to the answer. A refusal says what to give instead. Not a medical device.";

struct server {
    const struct mcp_settings *settings;
    struct mcp_roots roots;
};

/* Revisions, the newest first; those from HANDSHAKE on have one. */
static const char *const revisions[] = {"2026-07-28", "2025-11-25", "2025-06-18", "2025-03-26", "2024-11-05"};
enum { HANDSHAKE = 1, REVISIONS = sizeof revisions / sizeof *revisions };

/* Adds what a client without a handshake may keep, and for how long. */
static json_t *kept(json_t *result)
{
    json_t *more = json_pack("{s:s, s:i, s:s}", "resultType", "complete", "ttlMs", 3600000, "cacheScope", "private");
    json_object_update(result, more);
    json_decref(more);
    return result;
}

static json_t *server_facts(void)
{
    return json_pack("{s:{s:{}}, s:{s:s, s:s}, s:s}", "capabilities", "tools", "serverInfo", "name", "conus", "version",
                     conus_version(), "instructions", instructions);
}

static json_t *answer_initialize(const struct server *server, const json_t *members)
{
    (void)server;
    const char *asked = json_string_value(json_object_get(members, "protocolVersion"));
    const char *version = revisions[HANDSHAKE];
    for (size_t i = HANDSHAKE; asked && i < REVISIONS; i++) {
        version = strcmp(asked, revisions[i]) == 0 ? revisions[i] : version;
    }
    json_t *result = server_facts();
    json_object_set_new(result, "protocolVersion", json_string(version));
    return result;
}

static json_t *answer_discover(const struct server *server, const json_t *members)
{
    (void)server;
    (void)members;
    json_t *versions = json_array();
    for (size_t i = 0; i < REVISIONS; i++) {
        json_array_append_new(versions, json_string(revisions[i]));
    }
    json_t *result = server_facts();
    json_object_set_new(result, "supportedVersions", versions);
    return kept(result);
}

static json_t *answer_list(const struct server *server, const json_t *members)
{
    (void)server;
    (void)members;
    json_t *list = json_array();
    for (size_t i = 0; tools[i]; i++) {
        json_array_append_new(list, mcp_tool(tools[i]));
    }
    return kept(json_pack("{s:o}", "tools", list));
}

static json_t *answer_call(const struct server *server, const json_t *members)
{
    const char *name = json_string_value(json_object_get(members, "name"));
    json_t *none = json_object();
    json_t *given = json_object_get(members, "arguments");
    struct mcp_call call = {
        .members = given ? given : none, .roots = &server->roots, .max_memory = server->settings->max_memory};
    for (size_t i = 0; name && tools[i]; i++) {
        call.command = strcmp(name, tools[i]->name) == 0 ? tools[i] : call.command;
    }
    json_t *result = call.command && json_is_object(call.members) ? mcp_answer(&call) : NULL;
    if (!result) {
        result = json_pack("{s:[{s:s, s:s}], s:b, s:s}", "content", "type", "text", "text",
                           !call.command                   ? "there is no such tool"
                           : !json_is_object(call.members) ? "wanted is an object of arguments"
                                                           : "not enough memory",
                           "isError", 1, "resultType", "complete");
    }
    json_decref(none);
    return result;
}

static const struct {
    const char *name;
    json_t *(*answer)(const struct server *server, const json_t *members); /* NULL: with an empty object */
} methods[] = {
    {"initialize", answer_initialize}, {"server/discover", answer_discover}, {"ping", NULL},
    {"tools/list", answer_list},       {"tools/call", answer_call},
};

static json_t *failure(json_t *id, int code, const char *message)
{
    return json_pack("{s:s, s:O?, s:{s:i, s:s}}", "jsonrpc", "2.0", "id", id, "error", "code", code, "message",
                     message);
}

/* The reply to a message; NULL to a notification. A batch is no request: the protocol dropped
 * them with revision 2025-06-18. */
static json_t *reply_to(const struct server *server, const json_t *message)
{
    const char *protocol = json_string_value(json_object_get(message, "jsonrpc"));
    const char *method = json_string_value(json_object_get(message, "method"));
    json_t *id = json_object_get(message, "id");
    bool is_id = !id || json_is_string(id) || json_is_integer(id) || json_is_null(id);
    if (!protocol || strcmp(protocol, "2.0") != 0 || !method || !is_id) {
        return failure(is_id ? id : NULL, NO_REQUEST, "no request of JSON-RPC 2.0");
    }
    for (size_t i = 0; id && i < sizeof methods / sizeof *methods; i++) {
        if (strcmp(method, methods[i].name) == 0) {
            return json_pack("{s:s, s:O, s:o}", "jsonrpc", "2.0", "id", id, "result",
                             !methods[i].answer ? json_object()
                                                : methods[i].answer(server, json_object_get(message, "params")));
        }
    }
    return id ? failure(id, NO_METHOD, "no such method") : NULL;
}

/* Reads a line to its end; *size is LINE_LIMIT + 1 where it is longer than that. False at the end of the input. */
static bool read_line(char line[LINE_LIMIT], size_t *size)
{
    int c = getchar();
    if (c == EOF) {
        return false;
    }
    for (*size = 0; c != EOF && c != '\n'; c = getchar()) {
        if (*size < LINE_LIMIT) {
            line[*size] = (char)c;
        }
        *size += *size <= LINE_LIMIT;
    }
    return true;
}

static int take_line(const struct server *server, const char *line, size_t size)
{
    bool is_long = size > LINE_LIMIT;
    json_t *message = is_long ? NULL : json_loadb(line, size, JSON_REJECT_DUPLICATES | JSON_DECODE_ANY, NULL);
    json_t *reply =
        message ? reply_to(server, message) : failure(NULL, NO_JSON, is_long ? "a line of more than 1 MB" : "no JSON");
    char *text = reply ? json_dumps(reply, JSON_COMPACT | JSON_REAL_PRECISION(9)) : NULL;
    bool is_lost = reply && !text;
    json_decref(reply);
    json_decref(message);
    int code = text ? output_write(NULL, text, strlen(text)) : is_lost ? print_no_memory() : EXIT_DONE;
    code = code || !text ? code : output_write(NULL, "\n", 1);
    free(text);
    return code;
}

static int run_mcp(const void *given, const struct arguments *arguments)
{
    (void)arguments;
    static char line[LINE_LIMIT];
    struct server server = {.settings = given};
    size_t size;
    int code = mcp_roots_begin(&server.roots, &server.settings->roots);
    while (!code && read_line(line, &size)) {
        code = take_line(&server, line, size);
    }
    mcp_roots_finish(&server.roots);
    return code;
}

const struct command cmd_mcp = {
    .name = "mcp",
    .summary = "answer a program with a language model, by the Model Context Protocol",
    .description =
        "Reads requests from standard input and writes answers to standard output, a line of JSON each, until the\n"
        "input ends. The tools are query, overlap, plan, info, cite and atlases, with the options that ask: none\n"
        "that writes a file. What a call names must lie in a --root or be an atlas that is installed. What files\n"
        "in there name themselves is read, too. Nothing is sent; an answer ends after 60 s, and has 200 rows.",
    .examples = "  conus mcp --root ~/study\n",
    .groups = groups,
    .settings_size = sizeof(struct mcp_settings),
    .run = run_mcp,
};
