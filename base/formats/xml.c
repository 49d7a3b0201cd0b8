/* SPDX-License-Identifier: BSD-3-Clause */
/* Parses XML through expat. */
#include "base/formats/xml.h"

#include "base/formats/encoding.h"
#include "base/memory.h"

#include <expat.h>
#include <limits.h>
#include <math.h>
#include <string.h>

enum { DEPTH_LIMIT = 64 };

struct parsing {
    const struct xml_handler *handler;
    XML_Parser parser;
    struct buffer text; /* characters behind the last tag */
    int depth;
    bool is_strange; /* an element was not known */
    conus_status status;
};

static void stop_parser(struct parsing *parsing, conus_status status)
{
    if (status && !parsing->status) {
        parsing->status = status;
        XML_StopParser(parsing->parser, XML_FALSE);
    }
}

static size_t line_of(const struct parsing *parsing)
{
#if XML_MAJOR_VERSION * 100 + XML_MINOR_VERSION >= 209 /* which deprecates the older one */
    return (size_t)XML_GetCurrentLineNumber64(parsing->parser);
#else
    return XML_GetCurrentLineNumber(parsing->parser);
#endif
}

static void xml_on_start(void *user, const char *name, const char **attributes)
{
    struct parsing *parsing = user;
    struct xml_event event = {.name = name, .attributes = attributes, .line = line_of(parsing)};
    event.text = (struct text){parsing->text.data, parsing->text.size};
    parsing->text.size = 0;
    stop_parser(parsing, buffer_status(&parsing->text));
    if (parsing->status) {
        return;
    }
    if (++parsing->depth > DEPTH_LIMIT) {
        stop_parser(parsing,
                    fail(CONUS_ERROR_DATA, "line %zu: elements nested deeper than %d", event.line, DEPTH_LIMIT));
        return;
    }
    const struct xml_handler *handler = parsing->handler;
    if (handler->known && !parsing->is_strange && !text_is_one_of(text_from(name), handler->known, true)) {
        parsing->is_strange = true;
        stop_parser(parsing, notes_add(handler->strange, "XML, line %zu: <%.40s> is not known, and was passed over",
                                       event.line, name));
    }
    stop_parser(parsing, handler->start(handler->user, &event));
}

static void xml_on_end(void *user, const char *name)
{
    struct parsing *parsing = user;
    struct xml_event event = {.name = name, .line = line_of(parsing)};
    if (parsing->status) {
        return;
    }
    stop_parser(parsing, buffer_status(&parsing->text));
    parsing->depth--;
    if (!parsing->status) {
        event.text = (struct text){parsing->text.data, parsing->text.size};
        stop_parser(parsing, parsing->handler->end(parsing->handler->user, &event));
    }
    parsing->text.size = 0;
}

static void on_text(void *user, const char *text, int length)
{
    struct parsing *parsing = user;
    buffer_append(&parsing->text, text, (size_t)length);
}

static void on_doctype(void *user, const char *name, const char *system_id, const char *public_id, int has_subset)
{
    (void)name, (void)system_id, (void)public_id;
    struct parsing *parsing = user;
    if (has_subset || !parsing->handler->doctype) {
        stop_parser(parsing, fail(CONUS_ERROR_DATA, "line %zu: a document type (<!DOCTYPE)%s, which is not read",
                                  line_of(parsing), has_subset ? " with declarations" : ""));
    }
}

/* A definition that was passed over might have declared it. */
static void on_skipped_entity(void *user, const char *name, int is_parameter)
{
    (void)is_parameter;
    struct parsing *parsing = user;
    stop_parser(parsing, fail(CONUS_ERROR_DATA, "line %zu: unknown entity &%.40s;", line_of(parsing), name));
}

static conus_status run_parser(struct parsing *parsing, struct text text)
{
    XML_SetUserData(parsing->parser, parsing);
    XML_SetElementHandler(parsing->parser, xml_on_start, xml_on_end);
    XML_SetCharacterDataHandler(parsing->parser, on_text);
    XML_SetStartDoctypeDeclHandler(parsing->parser, on_doctype);
    XML_SetSkippedEntityHandler(parsing->parser, on_skipped_entity);
    if (XML_Parse(parsing->parser, text.data, (int)text.size, XML_TRUE) == XML_STATUS_OK || parsing->status) {
        return parsing->status;
    }
    enum XML_Error error = XML_GetErrorCode(parsing->parser);
    return error == XML_ERROR_NO_MEMORY
               ? fail(CONUS_ERROR_MEMORY, "no memory to read XML")
               : fail(CONUS_ERROR_DATA, "line %zu: not well-formed XML: %s", line_of(parsing), XML_ErrorString(error));
}

static void *allocate_block(size_t size)
{
    return memory_raw(size, 1);
}

static void *reallocate_block(void *block, size_t size)
{
    return memory_resize(block, size, 1);
}

conus_status xml_parse(const struct xml_handler *handler, struct text text)
{
    static const XML_Memory_Handling_Suite memory = {allocate_block, reallocate_block, memory_free};
    struct parsing parsing = {.handler = handler};
    char *owned = NULL;
    conus_status status = encoding_decode(&owned, &text, handler->notes);
    text = text_trim(text); /* a declaration must be the very first thing */
    if (!status && text.size > INT_MAX) {
        status = fail(CONUS_ERROR_UNSUPPORTED, "%zu bytes of XML, at most %d are read", text.size, INT_MAX);
    }
    parsing.parser = status ? NULL : XML_ParserCreate_MM(NULL, &memory, NULL);
    if (!status && !parsing.parser) {
        status = fail(CONUS_ERROR_MEMORY, "no memory to read XML");
    }
    status = status ? status : run_parser(&parsing, text);
    XML_ParserFree(parsing.parser);
    buffer_finish(&parsing.text);
    memory_free(owned);
    return status;
}

const char *xml_attribute(const struct xml_event *event, const char *name)
{
    for (const char **at = event->attributes; at && at[0]; at += 2) {
        if (strcmp(at[0], name) == 0) {
            return at[1];
        }
    }
    return NULL;
}

uint64_t xml_whole(struct job *job, const struct xml_event *event, const char *name, uint64_t low, uint64_t high)
{
    const char *given = xml_attribute(event, name);
    uint64_t value = 0;
    if (!given || !text_to_uint(text_trim(text_from(given)), high, &value) || value < low) {
        job_bad(job, "%s: found \"%.60s\", allowed are whole numbers from %llu to %llu", name, given ? given : "",
                (unsigned long long)low, (unsigned long long)high);
    }
    return value;
}

bool xml_matrix(double out[16], struct text text)
{
    struct text word;
    size_t n = 0;
    for (; n < 16 && text_word(&text, &word); n++) {
        double *number = &out[4 * (n % 4) + n / 4];
        if (!text_to_double(word, number) || !isfinite(*number)) {
            return false;
        }
    }
    return n == 16 && !text_word(&text, &word);
}

struct text xml_root(struct text text)
{
    text = text_trim(text);
    while (text_starts(text, "<?") || text_starts(text, "<!")) { /* a declaration, a comment or a document type */
        const char *close = memchr(text.data, '>', text.size);
        bool has_subset = close && memchr(text.data, '[', (size_t)(close - text.data));
        const char *ending = text_starts(text, "<?")     ? "?>"
                             : text_starts(text, "<!--") ? "-->"
                             : has_subset                ? "]>"
                                                         : ">";
        const char *end = text_find(text, ending);
        if (!end) {
            return (struct text){0};
        }
        size_t skipped = (size_t)(end - text.data) + strlen(ending);
        text = text_trim((struct text){text.data + skipped, text.size - skipped});
    }
    size_t length = 0;
    while (text_starts(text, "<") && 1 + length < text.size && !strchr(" \t\r\n/>", text.data[1 + length])) {
        length++;
    }
    return (struct text){text.data + (length > 0), length};
}
