/* SPDX-License-Identifier: BSD-3-Clause */
/* What the head of a table says of the space and unit of its positions, in lines and in columns. */
#include "base/status.h"
#include "poses/rows/columns_head.h"

#include <string.h>

/* Whether a line of the head is a title, a comment or a closing line: neither a row nor the header. */
static bool is_of_words(struct text *inside, const struct head *head, struct text text, size_t number)
{
    const struct columns *out = head->out;
    bool is_header = number == out->head_lines && out->has_header;
    bool is_comment = table_is_comment(inside, text);
    return is_comment ||
           (!is_header && (number < out->table.first ||
                           (number > out->head_lines && (!columns_has_digit(text) || columns_is_sentence(out, text)))));
}

/* What the cells of a column say of the rows' brain: MNI 152 where one is of that, else the first one's, and rows of
 * another are errors; nothing where some say only how numbers grow. */
static struct space_words hear_column(const struct head *head, size_t column)
{
    struct space_words best = {0};
    bool all_refused = true;
    bool all_brains = true;
    for (size_t r = 0; r < head->row_count; r++) {
        struct space_words own;
        const struct text cell = columns_cell(head, r, column);
        bool is_heard = space_words_hear_cell(&own, cell, false);
        bool is_better = !best.heard[0] || (best.why && !own.why) ||
                         (own.space.brain == POSE_BRAIN_MNI152 && best.space.brain != POSE_BRAIN_MNI152);
        all_brains = all_brains && (own.heard[0] || !(is_heard || text_is_one_of(cell, "ccf/bregma", false)));
        all_refused = all_refused && (!is_heard || own.why);
        best = own.heard[0] && is_better ? own : best;
    }
    return all_brains && !(best.why && !all_refused) ? best : (struct space_words){0};
}

/* What columns say of the rows. */
static conus_status hear_rows(struct head *head)
{
    struct columns *out = head->out;
    struct space_words *said = &out->said;
    for (size_t i = 0; i < out->count; i++) {
        for (size_t r = 0; out->role_of[i] == ROLE_UNIT && r < head->row_count; r++) {
            space_words_hear_of(said, space_unit_mm(columns_cell(head, r, i)) != 0 ? columns_cell(head, r, i)
                                                                                   : text_from(""));
        }
        const struct space_words own =
            out->role_of[i] == ROLE_SPACE && !head->options->any_space ? hear_column(head, i) : (struct space_words){0};
        if (said->space.brain && own.space.brain && said->space.brain != own.space.brain) {
            return fail(CONUS_ERROR_DATA,
                        "\"%s\" is said in one place, and \"%s\" in column \"%.*s\": in which space are the positions?",
                        said->space.name, own.heard, POSE_QUOTE(head->line.cells[i]));
        }
        said->space = said->space.brain ? said->space : own.space;
        said->why = said->why ? said->why : own.why;
        if (own.heard[0] && !said->heard[0]) {
            memcpy(said->heard, own.heard, sizeof said->heard);
        }
    }
    return CONUS_OK;
}

/* What is said of spaces and units; the user's word, and a column of LPS or RAS, beat it. */
conus_status columns_hear_words(struct head *head, struct notes *notes)
{
    struct columns *out = head->out;
    struct space_words *said = &out->said;
    struct text rest = head->text;
    struct text text;
    struct text inside;
    for (size_t number = 1; text_line(&rest, &text); number++) {
        out->heard_lines = number;
        if (!head->options->any_space && is_of_words(&inside, head, text, number)) {
            space_words_hear(said, inside);
        }
    }
    conus_status status = hear_rows(head);
    if (status) {
        return status;
    }
    if (said->why && !(said->why == space_why_unit && out->is_own_unit)) {
        return fail(CONUS_ERROR_DATA, "positions are said to be \"%s\": %s; %s", said->heard, said->why,
                    said->why == space_why_unit ? "',unit=mm' behind FILE takes them as mm"
                                                : "--any-space takes them as they are");
    }
    if (said->may_be_lps && !said->has_signs && head->options->space == CONUS_SPACE_RAS) {
        return fail(CONUS_ERROR_DATA, "a line says \"LPS\", but not of what: --space lps reads the positions so; "
                                      "--any-space takes them as RAS, with x to the right");
    }
    if (said->are_two && !out->is_own_unit) {
        return fail(CONUS_ERROR_DATA, "two units are named: which is that of the positions?");
    }
    if (said->mm > 0 && !out->is_own_unit) {
        double scale = said->mm / columns_space_mm(head->options->space);
        if (out->scale > 0 && out->scale != scale) {
            return fail(CONUS_ERROR_DATA, "a line names another unit than the header has");
        }
        out->scale = scale;
    }
    bool is_of_people = head->options->space < CONUS_SPACE_CCF;
    if (said->has_signs && is_of_people) {
        out->space = said->signs;
        return pose_note_space(notes, head->options, said->signs == CONUS_SPACE_LPS);
    }
    out->moves = space_moves(&said->space, head->options);
    return out->moves ? space_note_move(notes, &said->space) : CONUS_OK;
}
