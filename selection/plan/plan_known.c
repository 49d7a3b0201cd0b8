/* SPDX-License-Identifier: BSD-3-Clause */
/* The progress of plans as text: a line for each kind of numbers, and the reason why the first row is no pose. */
#include "selection/plan/plan_known.h"

#include "base/memory.h"

#include <stdio.h>
#include <string.h>

static const uint64_t MOST = UINT64_C(1) << 62; /* so that no sum is too large */
static const char *const words[PLAN_LINES] = {"rows", "left", "none", "kept", "entries", "targets"};

void plan_known_reason(char out[PLAN_WHY], struct text why)
{
    char copy[PLAN_WHY];
    snprintf(copy, sizeof copy, "%.*s", TEXT_SHOW(why, sizeof copy - 1));
    text_make_plain(copy, "");
    why = text_trim(text_from(copy));
    snprintf(out, PLAN_WHY, "%.*s", TEXT_SHOW(why, sizeof copy - 1));
}

void plan_known_format(struct buffer *out, const struct plan_known *known)
{
    for (size_t k = 0; k < PLAN_LINES; k++) {
        buffer_text(out, words[k]);
        for (size_t i = 0; i < known->lines[k].count; i++) {
            buffer_text(out, " ");
            buffer_whole(out, known->lines[k].items[i]);
        }
        buffer_text(out, "\n");
    }
    buffer_format(out, "why %s\n", known->why);
}

/* Takes the next line, whose first word is `name`. */
static bool take_line(struct text *line, struct text *rest, const char *name)
{
    struct text word;
    return text_line(rest, line) && text_word(line, &word) && text_equal(word, name);
}

/* CONUS_ERROR_DATA where a word of the line is no number. */
static conus_status take_numbers(struct plan_numbers *out, struct text line)
{
    size_t capacity = 0;
    struct text word;
    uint64_t number = 0;
    while (text_word(&line, &word)) {
        if (!text_to_uint(word, MOST, &number)) {
            return CONUS_ERROR_DATA;
        }
        if (!memory_reserve(&out->items, &capacity, out->count + 1, sizeof *out->items)) {
            return CONUS_ERROR_MEMORY;
        }
        out->items[out->count++] = number;
    }
    return CONUS_OK;
}

/* Whether the numbers belong to one plan. */
static bool is_sound(const struct plan_known *known)
{
    const struct plan_numbers *lines = known->lines;
    const struct plan_numbers *left = &lines[PLAN_LEFT];
    const uint64_t *rows = lines[PLAN_ROWS].items;
    if (lines[PLAN_ROWS].count != 2 || rows[0] > rows[1] || left->count < 2 || left->count > PLAN_CONSTRAINTS + 1 ||
        lines[PLAN_NONE].count != 2 || left->items[0] + lines[PLAN_NONE].items[0] != rows[1] - rows[0]) {
        return false;
    }
    bool sound = true;
    for (size_t i = 1; i < left->count; i++) {
        sound = sound && left->items[i] <= left->items[i - 1];
    }
    uint64_t before = rows[0];
    for (size_t i = 0; i < lines[PLAN_KEPT].count; i++) {
        sound = sound && lines[PLAN_KEPT].items[i] > before && lines[PLAN_KEPT].items[i] <= rows[1];
        before = lines[PLAN_KEPT].items[i];
    }
    for (size_t k = PLAN_ENTRIES; k <= PLAN_TARGETS; k++) {
        for (size_t i = 0; i < lines[k].count; i++) {
            sound = sound && lines[k].items[i] <= left->items[left->count - 1];
        }
    }
    return sound;
}

conus_status plan_known_parse(struct plan_known *out, const char *text, size_t size)
{
    struct text rest = {text, size};
    struct text line = {0};
    conus_status status = size && text[size - 1] == '\n' ? CONUS_OK : CONUS_ERROR_DATA;
    *out = (struct plan_known){0};
    for (size_t k = 0; k < PLAN_LINES && !status; k++) {
        status = take_line(&line, &rest, words[k]) ? take_numbers(&out->lines[k], line) : CONUS_ERROR_DATA;
    }
    if (!status && (!take_line(&line, &rest, "why") || rest.size || !is_sound(out))) {
        status = CONUS_ERROR_DATA;
    }
    line = text_trim(line);
    plan_known_reason(out->why, line);
    status = status || (strlen(out->why) == line.size && text_equal(line, out->why)) ? status : CONUS_ERROR_DATA;
    return status == CONUS_ERROR_DATA ? fail(status, "no state of a plan, or not whole") : status;
}

void plan_known_finish(struct plan_known *known)
{
    for (size_t k = 0; k < PLAN_LINES; k++) {
        memory_free(known->lines[k].items);
    }
}
