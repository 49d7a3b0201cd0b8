/* SPDX-License-Identifier: BSD-3-Clause */
/* What a tool takes, from the rows of its command's options. */
#include "base/system/system.h"
#include "cli/mcp/mcp.h"
#include "pages/pages.h"

#include <ctype.h>
#include <string.h>

bool mcp_is_json_format(const struct option *option)
{
    bool is = false;
    const char *choice;
    for (size_t i = 0; strcmp(option->name, "format") == 0 && (choice = option_choice(option, i)); i++) {
        is = is || strcmp(choice, "json") == 0;
    }
    return is;
}

/* A member has letters, digits and '_'. */
static void put_name(char out[OPTION_LIMIT], const char *before, const char *name, size_t size)
{
    snprintf(out, OPTION_LIMIT, "%s%.*s", before, (int)size, name);
    for (char *c = out; *c; c++) {
        *c = (char)(*c == '-' ? '_' : tolower((unsigned char)*c));
    }
}

void mcp_operand_name(char out[OPTION_LIMIT], const struct command *command, size_t index)
{
    put_name(out, "", command->operands[index], strcspn(command->operands[index], "|."));
}

static bool may_have(const struct option *option)
{
    static const bool kept[] = {
        [OPTION_PLAIN] = true,       [OPTION_ASKS] = true,        [OPTION_READS] = true,
        [OPTION_READS_NAMES] = true, [OPTION_READS_ATLAS] = true, [OPTION_READS_IMAGE] = true,
        [OPTION_READS_POSES] = true, [OPTION_ENDS] = false,
    };
    return kept[option->role] && !mcp_is_json_format(option);
}

/* The option that a row names first; NULL where the command has none. */
static const struct option *named(const struct command *command, const char *text)
{
    char name[OPTION_LIMIT];
    snprintf(name, sizeof name, "%.*s", (int)strcspn(text, "=|"), text);
    return option_find(command, name);
}

/* Whether it has an effect without what no call may have: it needs nothing, or something else. */
static bool has_effect(const struct command *command, const struct option *option)
{
    bool needs = false;
    bool has = false;
    for (const char *at = option->needs; at && *at; at += strcspn(at, "|"), at += *at == '|') {
        const struct option *other = named(command, at);
        needs = needs || other;
        has = has || (other && may_have(other));
    }
    return has || !needs;
}

void mcp_option_name(char out[OPTION_LIMIT], const struct command *command, const struct option *option)
{
    char operand[OPTION_LIMIT];
    const char *before = "";
    for (size_t i = 0; i < OPERAND_LIMIT && command->operands[i]; i++) {
        mcp_operand_name(operand, command, i);
        before = strcmp(operand, option->name) == 0 ? "more_" : before;
    }
    bool has_name = may_have(option) && has_effect(command, option);
    put_name(out, has_name ? before : "", option->name, has_name ? strlen(option->name) : 0);
}

static json_t *numbers(int count)
{
    return json_pack("{s:s, s:{s:s}, s:i, s:i}", "type", "array", "items", "type", "number", "minItems", count,
                     "maxItems", count);
}

static json_t *typed(const char *type)
{
    return json_pack("{s:s}", "type", type);
}

static json_t *list_of(json_t *items)
{
    return json_pack("{s:s, s:o}", "type", "array", "items", items);
}

static json_t *either(json_t *one, json_t *other)
{
    return json_pack("{s:[o, o]}", "anyOf", one, other);
}

static json_t *number(const char *type, const json_t *range)
{
    static const double ANY = 1e9; /* from here on a limit says nothing */
    json_t *low = json_object_get(range, "low");
    json_t *high = json_object_get(range, "high");
    return json_pack("{s:s, s:O*, s:O*}", "type", type,
                     json_is_true(json_object_get(range, "above")) ? "exclusiveMinimum" : "minimum",
                     json_number_value(low) > -ANY ? low : NULL,
                     json_is_true(json_object_get(range, "below")) ? "exclusiveMaximum" : "maximum",
                     json_number_value(high) < ANY ? high : NULL);
}

static json_t *value_schema(const struct option *option, const json_t *row)
{
    bool is_place = option->flags & OPTION_IS_PLACE;
    switch (option->type) {
    case OPTION_FLAG:
        return typed("boolean");
    case OPTION_NUMBER:
        return number("number", json_object_get(row, "range"));
    case OPTION_COUNT:
        return number("integer", json_object_get(row, "range"));
    case OPTION_VECTOR:
        return numbers(3);
    case OPTION_RANGE:
        return option->flags & OPTION_TO_TARGET ? either(numbers(2), typed("string")) : numbers(2);
    case OPTION_EDGES:
        return numbers(4);
    case OPTION_CHOICE:
        return json_pack("{s:s, s:O, s:O*}", "type", "string", "enum", json_object_get(row, "choices"), "default",
                         json_object_get(row, "default"));
    case OPTION_LIST:
        return is_place ? either(numbers(3), list_of(either(numbers(3), typed("string")))) : list_of(typed("string"));
    case OPTION_SIZE:
    case OPTION_BYTES:
    case OPTION_TEXT:
        break;
    }
    return is_place ? either(numbers(3), typed("string")) : typed("string");
}

/* "; not beside a, b", of the options of a row that a call may have. */
static void put_others(FILE *out, const struct command *command, const json_t *list, const char *before)
{
    size_t i;
    const json_t *other;
    json_array_foreach(list, i, other)
    {
        char name[OPTION_LIMIT];
        const char *text = json_string_value(other);
        mcp_option_name(name, command, named(command, text));
        if (*name) {
            fprintf(out, "%s%s%s", before, name, text + strcspn(text, "="));
            before = ", ";
        }
    }
}

static json_t *option_schema(const struct command *command, const struct option *option, const json_t *row)
{
    char help[OPTION_HELP];
    struct system_text text;
    option_describe(help, option, false);
    FILE *out = system_text_open(&text);
    if (out) {
        size_t size = strlen(help);
        fprintf(out, "%.*s", (int)(size && help[size - 1] == ':' ? size - 1 : size), help); /* choices would follow */
        put_others(out, command, json_object_get(row, "needs"), "; needs one of ");
        put_others(out, command, json_object_get(row, "excludes"), "; not beside ");
    }
    json_t *schema = value_schema(option, row);
    bool is_form = option->value && (option->type == OPTION_TEXT || option->type == OPTION_LIST);
    if (is_form) {
        json_object_set_new(schema, "title", json_string(option->value));
    }
    json_object_set_new(schema, "description", json_string(system_text_close(&text)));
    free(text.data);
    return schema;
}

static json_t *operand_schema(const struct command *command, size_t index)
{
    bool is_last = index + 1 == OPERAND_LIMIT || !command->operands[index + 1];
    const char *words =
        command->holds[index] == HOLDS_ATLAS ? "a name that the tool atlases lists, or a file" : "a file";
    return command->repeats && is_last ? json_pack("{s:s, s:{s:s}, s:i, s:s}", "type", "array", "items", "type",
                                                   "string", "minItems", 1, "description", words)
                                       : json_pack("{s:s, s:s}", "type", "string", "description", words);
}

json_t *mcp_tool(const struct command *command)
{
    json_t *members = json_object();
    json_t *required = json_array();
    json_t *rows = pages_command(command);
    char name[OPTION_LIMIT];
    const struct option *option;
    for (size_t i = 0; i < OPERAND_LIMIT && command->operands[i]; i++) {
        mcp_operand_name(name, command, i);
        json_object_set_new(members, name, operand_schema(command, i));
        json_array_append_new(required, json_string(name));
    }
    for (size_t i = 0; (option = option_at(command, i)); i++) {
        mcp_option_name(name, command, option);
        if (*name) {
            const json_t *row = json_array_get(json_object_get(rows, "options"), i);
            json_object_set_new(members, name, option_schema(command, option, row));
            if (option->required) {
                json_array_append_new(required, json_string(name));
            }
        }
    }
    json_decref(rows);
    return json_pack("{s:s, s:s, s:{s:s, s:o, s:o, s:b}, s:{s:b, s:b}}", "name", command->name, "description",
                     command->summary, "inputSchema", "type", "object", "properties", members, "required", required,
                     "additionalProperties", 0, "annotations", "readOnlyHint", 1, "openWorldHint", 0);
}
