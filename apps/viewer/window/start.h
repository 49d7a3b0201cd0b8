/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The offers of the start page: atlases that were opened lately, those that are installed, a sample, and a line
 * for a path or for words to search by. */
#ifndef CONUS_VIEWER_WINDOW_START_H
#define CONUS_VIEWER_WINDOW_START_H

#include "base/system/system.h"
#include "conus/own.h"
#include "viewer/window/recent.h"
#include "viewer/window/texture.h"
#include <stdbool.h>
#include <stddef.h>

/** Whether each word of @p text is in the atlas's name, or is its source's name or the beginning of that. Upper and
 * lower case are the same, and so are '-', '_', '.', '+' and spaces. An empty text fits all. */
bool installed_fits(const conus_installed *atlas, const char *text);
/** What an atlas of that name is, and of which animal; NULL = it is not known. */
const char *installed_about(const char *name);
/** Whether one before atlas @p index is the same in another place: lists leave it out. */
bool installed_is_twin(const conus_catalogue *catalogue, size_t index);
/** The words that open the atlas: its name, "source:name", or where both mean others its path,
 * which is shorter than SYSTEM_PATH; false where it is not. */
bool installed_words(char out[SYSTEM_PATH], const conus_catalogue *catalogue, const conus_installed *atlas);

enum { START_WHY = 512 };

/** What is known of an atlas that was open before. */
struct known_atlas {
    bool is_looked_for;
    uint32_t areas;         /**< 0 = not known. */
    struct texture picture; /**< Name 0 = there is none. */
};

struct start {
    bool on;         /**< The window shows the page: always, while there is no atlas. */
    bool takes_keys; /**< From the next frame on what is typed goes into the path. */
    bool is_set;     /**< The line has to take over what is typed below, which a letter began. */
    char typed[SYSTEM_PATH];
    char why[START_WHY]; /**< Why the last one was not opened, plain; "" = there is nothing to say. */
    struct recent recent;
    char
        found[SYSTEM_PATH]; /**< The sample, Debian's AAL atlas, if it is there and not among the recent ones; or "". */
    bool has_no_sample;     /**< That atlas is not installed: a phantom is the sample. */
    conus_catalogue *catalogue;  /**< The installed atlases; NULL = not looked for. */
    struct known_atlas *known;   /**< What start_known() found, first that of the paths; NULL = no memory. */
    struct viewer *painted;      /**< Draws the picture of path `paints`; NULL = no picture is drawn. */
    size_t paints;               /**< Past the paths: none was asked for yet. */
    size_t picked;               /**< Index of the installed atlas that Enter opens; past the last = none. */
    bool scrolls;                /**< The list is to scroll to it. */
    char picked_by[SYSTEM_PATH]; /**< The text when it was picked. */
};

/** Fills the lists anew; to be ended by start_finish(). */
void start_look(struct start *start);
void start_finish(struct start *start);
/** Path @p index of the lists, the recent ones first; NULL past the last. */
const char *start_path(const struct start *start, size_t index);
/** What is known of path @p index of the lists, or of the installed atlas with this index; all 0 = nothing. */
struct known_atlas start_known(struct start *start, size_t index, bool is_installed);
/** Index of the first path of the lists that has a picture, which where none has is being drawn of the sample, and is
 * there some frames later: @p wake is called then. With @p keeps that is kept for the next time. SIZE_MAX = none will
 * have one. */
size_t start_pictured(struct start *start, void (*wake)(void), bool keeps);
/** Ends what draws that picture, as where the page goes away. */
void start_stop(struct start *start);
/** The installed atlas that is the file @p path; NULL = none. */
const conus_installed *start_installed(const struct start *start, const char *path);
/** Whether the list of installed atlases has this one: what is typed fits, or nothing is typed and it stands in no
 * other list. */
bool start_lists(struct start *start, size_t index);
/** Path @p index without what may not be shown, and where its last name begins in it. */
const char *start_words(char words[SYSTEM_PATH], const struct start *start, size_t index);
/** The search among installed atlases: the typed text, or "" if that is a path. */
const char *start_words_typed(const struct start *start);
/** Index of the installed atlas that is marked, which what was typed finds or the arrow keys chose; past the last =
 * none, as where nothing was typed or it is a path. */
size_t start_picked(struct start *start);
/** Marks the next installed atlas, by 1 below, by -1 above. */
void start_move(struct start *start, int by);
/** The path that Enter opens: the one that was typed, where ~ is the home folder, or the atlas that is marked; false
 * where there is none, or it is too long. */
bool start_typed(char path[SYSTEM_PATH], struct start *start);
/** The path of the phantom that is the sample, which is written where it is missing; false with conus_message(). */
bool start_sample(char path[SYSTEM_PATH]);

#endif
