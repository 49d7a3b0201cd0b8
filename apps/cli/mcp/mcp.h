/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Commands as tools of the Model Context Protocol: what they take, what they may read, and their answers. */
#ifndef CONUS_CLI_MCP_MCP_H
#define CONUS_CLI_MCP_MCP_H

#include "options/options.h"

#include <jansson.h>
#include <stdbool.h>
#include <stddef.h>

/** What tools may read: what lies in these folders, whole paths without links. */
struct mcp_roots {
    char **folders; /**< [count] */
    size_t count;
};

/** The folders, of which none means the current one, and the places where `conus atlases` looks. The first becomes the
 * current folder: relative paths begin there. Returns the exit code and prints an error unless it is 0; @p out is the
 * caller's to finish in both cases. */
int mcp_roots_begin(struct mcp_roots *out, const struct option_list *folders);
void mcp_roots_finish(struct mcp_roots *roots);

enum { MCP_PIECES = 64 }; /**< Words of one text that paths are looked for in. */

/** Whether no path that @p text is or may hold ("FILE,key=FILE") leads out of the folders, by ".." or links either. It
 * opens nothing. */
bool mcp_roots_have(const struct mcp_roots *roots, const char *text);

/** The name of operand @p index and of an option as members of a call; "" of an option that no call may have: what
 * writes, what ends the program, what a server decides. */
void mcp_operand_name(char out[OPTION_LIMIT], const struct command *command, size_t index);
void mcp_option_name(char out[OPTION_LIMIT], const struct command *command, const struct option *option);

/** Whether @p option is the one of formats, and JSON is one of them. */
bool mcp_is_json_format(const struct option *option);

/** Tool @p command: its name, description and the schema of its members. A new reference. */
json_t *mcp_tool(const struct command *command);

struct mcp_call {
    const struct command *command;
    const json_t *members; /**< An object. */
    const struct mcp_roots *roots;
    uint64_t max_memory; /**< 0 = the command's own. */
};

/** Runs the command as a child, which can write no file, and gives the result of tools/call: an answer, or what is
 * wrong, for the model to read and mend. A new reference; NULL without memory. */
json_t *mcp_answer(const struct mcp_call *call);

#endif
