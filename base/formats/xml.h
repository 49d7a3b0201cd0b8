/* SPDX-License-Identifier: BSD-3-Clause */
/** @file XML from untrusted files: expat with our memory functions, without entities of their own; nothing else
 * is ever opened. */
#ifndef CONUS_BASE_FORMATS_XML_H
#define CONUS_BASE_FORMATS_XML_H

#include "base/job/job.h"
#include "base/text.h"

struct xml_event {
    const char *name;        /**< The element's name. */
    const char **attributes; /**< At its start: name, value, ..., NULL. NULL at its end.        */
    struct text text;        /**< The characters since the last tag, in UTF-8.                  */
    size_t line;             /**< From 1.                                                       */
};

/** Called at the start and the end of each element. A failure stops the parser and is passed on. */
struct xml_handler {
    conus_status (*start)(void *user, const struct xml_event *event);
    conus_status (*end)(void *user, const struct xml_event *event);
    void *user;
    bool doctype;          /**< A <!DOCTYPE> that only points to a definition is passed over instead of refused. */
    struct notes *notes;   /**< Gets one on a text that is not UTF-8 and declares nothing else; NULL: none. */
    const char *known;     /**< The elements that the format has, '/' between them; NULL: any. */
    struct notes *strange; /**< Gets one on the first that is none of them, and is passed over. */
};

/** Parses the document @p text, which encoding_decode() makes UTF-8. Errors of the document itself are CONUS_ERROR_DATA
 * with their line. */
conus_status xml_parse(const struct xml_handler *handler, struct text text);

/** Value of attribute @p name, or NULL. */
const char *xml_attribute(const struct xml_event *event, const char *name);

/** That attribute as a whole number from @p low to @p high. */
uint64_t xml_whole(struct job *job, const struct xml_event *event, const char *name, uint64_t low, uint64_t high);

/** Reads a matrix of 16 finite numbers by rows, column-major; false where @p text is none. */
bool xml_matrix(double out[16], struct text text);

/** Name of the outermost element of @p text, found without parsing; empty if there is none. */
struct text xml_root(struct text text);

#endif
