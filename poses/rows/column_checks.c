/* SPDX-License-Identifier: BSD-3-Clause */
/* What the head of a table says of the space and unit of its positions, what its numbers say against their unit, their
 * signs or their sides, and what names say of sides. */
#include "base/geometry/math3.h"
#include "base/path.h"
#include "base/status.h"
#include "poses/rows/columns.h"
#include "poses/rows/columns_head.h"

#include <ctype.h>
#include <stdio.h>
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

static void hear_rows(struct head *head)
{
    struct columns *out = head->out;
    struct space_words *said = &out->said;
    for (size_t i = 0; i < out->count; i++) {
        for (size_t r = 0; out->role_of[i] == ROLE_UNIT && r < head->row_count; r++) {
            space_words_hear_of(said, space_unit_mm(columns_cell(head, r, i)) != 0 ? columns_cell(head, r, i)
                                                                                   : text_from(""));
        }
        const struct column_cells *cells = &head->cells[i];
        bool is_name = out->role_of[i] == ROLE_NAME && cells->strong && cells->strong == cells->given;
        bool is_heard = (is_name || out->role_of[i] == ROLE_SPACE) && !head->options->any_space;
        struct space_words own = is_heard ? hear_column(head, i) : (struct space_words){0};
        own = is_name && !own.space.brain ? (struct space_words){0} : own; /* "In" is no unit there */
        if (said->space.brain && own.space.brain && said->space.brain != own.space.brain) {
            job_bad(head->job,
                    "\"%s\" is said in one place, and \"%s\" in column \"%.*s\": in which space are the positions?",
                    said->space.name, own.heard, POSE_QUOTE(head->line.cells[i]));
        }
        said->space = said->space.brain ? said->space : own.space;
        said->why = said->why ? said->why : own.why;
        if (own.heard[0] && !said->heard[0]) {
            memcpy(said->heard, own.heard, sizeof said->heard);
        }
    }
}

/* Reads a row without a header whose name is a space: "TAL: -42 -20 50". */
static void hear_name(struct head *head, struct text row)
{
    double point[3];
    struct text name;
    struct space_words own;
    bool is_asked = !head->out->has_header && !head->options->any_space;
    if (is_asked && columns_point(point, &name, &head->out->table, row) && space_words_hear_cell(&own, name, true) &&
        own.space.brain) {
        space_words_hear_of(&head->out->said, name);
    }
}

/* Whether the columns of a space stand in that order. */
static bool is_order_of(const struct space_words *said, conus_space space)
{
    static const int orders[][3] = {[CONUS_SPACE_CCF] = {1, 2, 0}, [CONUS_SPACE_BREGMA] = {1, 0, 2}};
    return said->axes == SPACE_AXES_ORDERED && space >= CONUS_SPACE_CCF &&
           memcmp(said->order, orders[space], sizeof said->order) == 0;
}

/* Refuses a line that names other axes than columns have, unless it is the header, or the user names them. */
static void check_axes(const struct head *head, const struct space_words *said, struct text line, size_t number)
{
    const conus_pose_options *options = head->options;
    bool is_header = head->out->has_header && columns_sum(line) == head->out->header_sum;
    if (is_header || head->is_named || is_order_of(said, options->space)) {
        return;
    }
    switch (said->axes) {
    case SPACE_AXES_PLAIN:
        break;
    case SPACE_AXES_TURNED:
        if (options->space < CONUS_SPACE_CCF && !options->any_space) { /* rodents' axes have other signs */
            job_bad(
                head->job,
                "line %zu, \"%.*s\", says another axis or sign than x to the right, y to the front or z to the top: "
                "turn the columns; %s",
                number, POSE_QUOTE(line), space_any(options->space));
        }
        break;
    case SPACE_AXES_VOXELS:
        job_bad(head->job, "line %zu, \"%.*s\": i j k are %s", number, POSE_QUOTE(line), space_why_voxels);
        break;
    case SPACE_AXES_ORDERED:
        job_bad(
            head->job,
            "line %zu, \"%.*s\", names other axes than x (to the right), y (front) and z (top): write x, y and z there "
            "in the order of the columns",
            number, POSE_QUOTE(line));
        break;
    }
}

/* Whether a word is the name of contacts: "RAI1", "RAI-1", "RAI'1", "RAI,1". */
static bool is_of_contacts(struct text head, const char *word)
{
    const size_t size = strlen(word);
    bool found = false;
    for (size_t i = 0; i + size + 1 < head.size && !found; i++) {
        const char *end = head.data + i + size;
        end += strchr(" -_'.,;\t", *end) != NULL;
        found = strncmp(head.data + i, word, size) == 0 && *end >= '0' && *end <= '9';
    }
    return found;
}

/* Whether a line that is only a code of axes is the heading of the contacts below: "RAI", "RAI,,,". */
static bool is_heading(const struct head *head, const struct space_words *said, struct text line)
{
    const size_t size = strlen(said->heard);
    bool is_one = said->why && said->why != space_why_voxels && text_starts(line, said->heard);
    for (size_t i = size; i < line.size && is_one; i++) {
        is_one = strchr(" ,;\t", line.data[i]) != NULL;
    }
    return is_one && is_of_contacts(head->text, said->heard);
}

void columns_hear_words(struct head *head)
{
    struct job *job = head->job;
    struct columns *out = head->out;
    struct space_words *said = &out->said;
    struct text rest = head->text;
    struct text text;
    struct text inside;
    for (size_t number = 1; text_line(&rest, &text); number++) {
        struct space_words own = {0};
        out->heard_lines = number;
        if (!is_of_words(&inside, head, text, number)) {
            hear_name(head, text);
            continue;
        }
        space_words_hear(&own, inside);
        check_axes(head, &own, inside, number);
        if (!head->options->any_space && !is_heading(head, &own, text_trim(inside))) {
            space_words_hear(said, inside);
        }
    }
    hear_rows(head);
    static const char *const own[] = {
        [CONUS_SPACE_LPS] = "radiological/rai", [CONUS_SPACE_CCF] = "asr", [CONUS_SPACE_BREGMA] = "bregma"};
    const char *code = own[head->options->space];
    bool is_own_code = code && text_is_one_of(text_from(said->heard), code, false);
    char why[SPACE_WHY];
    if (said->why && !is_own_code && !(said->why == space_why_unit && out->is_own_unit)) {
        bool is_unit = said->why == space_why_unit;
        job_bad(job, "positions are said to be \"%s\": %s; %s%s%s", said->heard, space_words_why(why, said),
                is_unit ? "only if they are mm, type " : "", is_unit ? out->file : space_any(head->options->space),
                is_unit ? ",unit=mm" : "");
    }
    if (said->says_mni && (said->space.brain == POSE_BRAIN_ANIMAL || said->space.brain == POSE_BRAIN_MOUSE)) {
        job_bad(job,
                "positions are said to be in MNI, and to be in \"%s\": of which brain are they? Take the other word "
                "out of the file; %s",
                said->heard, space_any(head->options->space));
    }
    if (said->may_be_lps && !said->has_signs && head->options->space == CONUS_SPACE_RAS) {
        job_bad(
            job,
            "a line says LPS, or x to the left or y to the back, but not of what: --space lps takes them as x left, "
            "y back; %s; if only one is turned, change its signs in the file",
            space_any(CONUS_SPACE_RAS));
    }
    if (said->has_signs && head->has_axes && head->side * (said->signs == CONUS_SPACE_LPS ? -1 : 1) < 0) {
        job_bad(job, "%s is said, and brackets of the header or --space say another: which is it?",
                said->signs == CONUS_SPACE_LPS ? "LPS" : "RAS");
    }
    if (said->are_two && !out->is_own_unit) {
        job_bad(job, "two units are named: which is that of the positions?");
    }
    if (said->mm > 0 && !out->is_own_unit) {
        double scale = said->mm / columns_space_mm(head->options->space);
        if (out->scale > 0 && out->scale != scale) {
            const double mm = out->scale * columns_space_mm(head->options->space);
            job_bad(job, "1 is %g mm by a line, %g mm by the header: keep one unit, or type %s,unit=mm (or cm, m, um)",
                    said->mm, mm, out->file);
        }
        out->scale = scale;
    }
    if (said->has_signs && head->options->space < CONUS_SPACE_CCF) { /* of people */
        out->space = said->signs;
        pose_note_space(job, head->options, said->signs == CONUS_SPACE_LPS);
        return;
    }
    out->moves = space_moves(&said->space, head->options);
    if (out->moves) {
        space_note_move(job, &said->space);
    }
}

void columns_check_name(struct job *job, const struct columns *columns, const char *path, struct text head,
                        const conus_pose_options *options, bool is_said)
{
    const struct space_words *said = &columns->said;
    struct space_words of_name = {0};
    if (!path || options->any_space || options->space != CONUS_SPACE_RAS || columns->place || said->has_signs ||
        columns->has[ROLE_SPACE]) {
        return;
    }
    space_words_hear_name(&of_name, text_from(path_base(path)));
    bool is_of_mm = of_name.why == space_why_voxels && (said->space.name[0] || columns->has_unit);
    bool is_refused =
        of_name.why && !is_said && !columns->has_space && !is_of_mm && !is_of_contacts(head, of_name.heard);
    if (of_name.may_be_lps || is_refused) {
        char why[SPACE_WHY];
        job_bad(job, "only the file's name says \"%s\": %s; %s", of_name.may_be_lps ? "LPS" : of_name.heard,
                of_name.may_be_lps ? "--space lps takes them as x left, y back" : space_words_why(why, &of_name),
                space_any(options->space));
    }
}

enum { SIDE_COLUMNS = 4 };

/* The numbers of the head's rows, mm or as the space has them. */
struct census {
    size_t points, negatives, shallow, first_shallow, axes, short_axes;
    double farthest, nearest_target, farthest_target;
    struct sides sides[1 + SIDE_COLUMNS]; /* by names, and by these columns: */
    size_t columns[SIDE_COLUMNS], column_count;
    size_t first_wrong[1 + SIDE_COLUMNS]; /* The line of the first row on the other side; 0 = none. */
    size_t bad, rows;
};

/* Words beside a side that is not one of the brain, */
static const char limbs[] = "hand/hands/handed/handedness/foot/feet/leg/arm/limb/finger/fingers/thumb/toe/toes/wrist/"
                            "elbow/shoulder/face/lip/muscle/tapping/button/press/grip/hemifield/fdi/apb/adm/ecr/fcr/"
                            "tibialis";

/* and in the name of a column. */
static const char not_of_point[] = "eye/ear/field/response/task/contrast/condition/stimulus/cue/onset/symptom/symptoms/"
                                   "affected/paretic/seed/reference/ref/dominance/dominant/language/of";

/* The columns whose cells all say a side, whatever their header, or some below one that is called so. */
static void find_side_columns(struct census *out, const struct head *head)
{
    for (size_t i = 0; i < head->line.count && out->column_count < SIDE_COLUMNS && head->out->has_header; i++) {
        struct text name = text_from(head->names[i]);
        struct text word;
        bool is_called = strstr(head->names[i], "hemi") || strcmp(head->names[i], "side") == 0;
        const struct column_cells *cells = &head->cells[i];
        bool all = head->out->role_of[i] == ROLES && (is_called || cells->sides + cells->middles == cells->given);
        while (text_word(&name, &word)) {
            all = all && !text_is_one_of(word, limbs, false) && !text_is_one_of(word, not_of_point, false);
        }
        if (all && cells->sides) {
            out->columns[out->column_count++] = i;
        }
    }
}

static void count_row(struct census *census, const struct head *head, const conus_pose_row *row, struct text text,
                      struct text name, double width)
{
    double p[3];
    struct table_line line;
    conus_frame_from_world(p, head->options->frame, row->pose.world_from_device + 12);
    const double *world = row->pose.world_from_device + 12;
    bool is_of_bregma = head->options->space == CONUS_SPACE_BREGMA;
    double distance = vec3_length(head->options->space < CONUS_SPACE_CCF ? world : p);
    census->points++;
    census->farthest = fmax(census->farthest, distance);
    census->negatives += p[0] < 0 || p[1] < 0 || p[2] < 0;
    if (is_of_bregma && row->is_point && p[2] > 0 && !census->shallow++) {
        census->first_shallow = row->line;
    }
    if (isfinite(row->range[1]) && head->out->ends_at_target) {
        census->axes++;
        census->short_axes += row->range[1] < width / 20;
    } else if (head->out->has[ROLE_TX]) { /* at one distance from all positions they are directions */
        census->nearest_target = census->axes ? fmin(census->nearest_target, row->target_mm) : row->target_mm;
        census->farthest_target = fmax(census->farthest_target, row->target_mm);
        census->axes++;
        census->short_axes += row->target_mm < width / 20;
    }
    const conus_frame *frame = head->options->frame;
    const bool is_of_ccf = head->options->space == CONUS_SPACE_CCF;
    const double x = is_of_bregma ? p[1] : is_of_ccf ? (p[2] - frame->bregma[2]) / 1000 : world[0];
    bool is_wrong = sides_count(&census->sides[0], sides_of_name(name), name, x, width / 36);
    size_t *first = &census->first_wrong[0];
    *first = *first || !is_wrong ? *first : row->line;
    bool fits = census->column_count && table_split(&line, &head->out->table, text);
    for (size_t i = 0; fits && i < census->column_count; i++) {
        const size_t at = census->columns[i];
        first = &census->first_wrong[1 + i];
        is_wrong = sides_count(&census->sides[1 + i], at < line.count ? sides_of_name(line.cells[at]) : 0,
                               text_from(""), x, width / 36);
        *first = *first || !is_wrong ? *first : row->line;
    }
}

/* What names and columns say of sides: each is evidence. Half of two points or more is refused, one is warned of. */
static bool judge_sides(const struct census *c, const struct head *head)
{
    static const char *const turns[] = {
        "if y > 0 is the back, too, type --space lps; else turn the sign of x",
        "if y > 0 is the front, type --space ras; else turn the sign of x", "mend ML",
        "ML is to the right: where it has no signs, put a minus before those of the left; else mend ML"};
    const char *turn = head->out->said.has_signs ? "mend x" : turns[head->options->space];
    bool are_right = false;
    for (size_t i = 0; i <= c->column_count; i++) {
        const struct sides *sides = &c->sides[i];
        const struct text column = i ? head->line.cells[c->columns[i - 1]] : text_from("");
        size_t wrong = sides->left_on_right + sides->right_on_left;
        char why[256];
        snprintf(why, sizeof why, "%s%.*s%s%s, or correct the %s", i ? "by column \"" : "", POSE_QUOTE(column),
                 i ? "\", if these are sides of the brain; " : "", turn, i ? "sides" : "names");
        are_right = are_right || (sides->left && sides->right && !wrong);
        if (head->out->is_of_points) {
            sides_check(head->job, sides, why, head->out->file);
        }
        if (wrong) {
            job_warn(head->job, "%zu row%s on the other side than %s%.*s%s (the first in line %zu)", wrong,
                     wrong == 1 ? " lies" : "s lie", i ? "column \"" : "the name", POSE_QUOTE(column),
                     i ? "\" says" : " says", c->first_wrong[i]);
        }
    }
    return are_right;
}

static void judge(const struct census *c, const struct head *head, double longest, const char *first_fault)
{
    enum { LEAST = 3 };
    static const double HEAD = 170;   /* mm */
    static const double MACAQUE = 50; /* A brain as large has people's positions in centimetres in its middle. */
    struct job *job = head->job;
    conus_space space = head->options->space;
    bool of_people = space < CONUS_SPACE_CCF;
    bool is_known = head->options->longest > 0;
    bool is_list = c->points >= LEAST && head->out->is_of_points;
    bool is_unsaid = is_list && !head->out->has_unit;
    bool is_probe = space == CONUS_SPACE_BREGMA && !head->out->is_of_points && !head->out->has_unit;
    if (c->rows > 1 && 2 * c->bad > c->rows && head->out->has_header) {
        job_bad(job,
                "%zu of %zu rows have no number where the header has x y z or a direction: is the order of the "
                "columns another? The first: %s",
                c->bad, c->rows, first_fault);
    }
    bool is_asked = is_known && !head->words.any_sides && head->out->said.space.brain != POSE_BRAIN_FRAME;
    bool are_right = is_asked && judge_sides(c, head);
    if (is_unsaid && of_people && c->farthest > 0.5 && c->farthest <= 1.001) {
        job_bad(job,
                "all positions lie within 1 mm of the origin, the farthest %.2g: on a sphere of radius 1 they are "
                "directions, not positions: save those of the cap in MNI, in mm; only if these are mm, type "
                "%s,unit=mm",
                c->farthest, head->out->file);
    } else if ((is_unsaid || is_probe) && (of_people || space == CONUS_SPACE_BREGMA) && c->farthest > 0 &&
               c->farthest <= (of_people ? 1 : 0.02)) {
        job_bad(job,
                "all positions lie within %s mm of the origin, as if they were in metres: %stype %s,unit=m; if they "
                "are mm, %s,unit=mm",
                of_people ? "1" : "0.02",
                of_people ? "where x points to the nose (Brainstorm, CTF), bring them to MNI first; else " : "",
                head->out->file, head->out->file);
    }
    if (c->farthest > fmax(10 * longest, 1000) && space != CONUS_SPACE_CCF && is_known && !head->out->has_unit) {
        job_bad(
            job,
            "a position lies %g mm from the origin, as if it were in micrometres: type %s,unit=um%s; if they are mm, "
            "%s,unit=mm",
            c->farthest, head->out->file,
            of_people ? "" : ", or, if they count from the corner of the CCF, --space ccf", head->out->file);
    }
    if (is_unsaid && is_known && space == CONUS_SPACE_CCF && c->farthest < 1000 * longest / 14) {
        job_bad(job,
                "all positions lie within %.0f um of the corner, outside of any brain: are they voxels? space ccf is "
                "in micrometres; if they are, type %s,unit=um",
                1000 * longest / 14, head->out->file);
    }
    if (space == CONUS_SPACE_BREGMA && is_list && 2 * c->shallow > c->points) {
        const double *b = head->options->frame->bregma;
        job_bad(job,
                "%zu of %zu positions have a DV above 0, above bregma: if they are depths, put a minus before each DV; "
                "if they lie above it, as a skull, --space ccf takes them: AP %g - 1000 AP, DV %g - 1000 DV, ML %g + "
                "1000 ML, um",
                c->shallow, c->points, b[0], b[1], b[2]);
    } else if (c->shallow) {
        job_warn(job,
                 "%zu of %zu positions have a DV above 0, above bregma, the first in line %zu: is a minus missing?",
                 c->shallow, c->points, c->first_shallow);
    }
    bool are_ends = head->out->ends_at_target || c->farthest_target > 1.5 * c->nearest_target;
    if (is_known && c->axes && are_ends && 2 * c->short_axes >= c->axes) {
        columns_refuse_short(job, c->short_axes, c->axes, longest);
    }
    bool is_macaque = of_people && longest > MACAQUE && head->options->atlas &&
                      conus_atlas_brain(head->options->atlas).brain == CONUS_BRAIN_TEMPLATE;
    const double near = (is_macaque ? fmax(longest, HEAD) : longest) / 14;
    if (is_unsaid && space != CONUS_SPACE_CCF && is_known && c->farthest < near) {
        job_warn(job,
                 "all positions lie within %.3g mm of %s: are they in centimetres? Then type %s,unit=cm; else "
                 "%s,unit=mm",
                 near, of_people ? "the origin" : "bregma", head->out->file, head->out->file);
    } else if (is_list && of_people && is_known && !c->negatives && !are_right) {
        job_warn(job, "no position has a negative number: are they voxels, or positions in a frame?");
    }
    if (is_asked && is_list) {
        sides_warn(job, &c->sides[0], head->out->side);
    }
}

/* Whether a word stands where a number is to be, and a character that is no sign before a coordinate; of a row of
 * numbers also the largest coordinate, which may be far from any mouse. */
static void find_faults(bool *has_word, bool *has_glyph, double *farthest, const struct columns *columns,
                        struct text text)
{
    struct table_line line;
    bool fits = table_split(&line, &columns->table, text);
    bool is_whole = true;
    double largest = 0;
    *has_word = *has_glyph = false;
    for (size_t i = 0; fits && i < line.count && i < columns->count; i++) {
        double value = NAN;
        struct text cell = line.cells[i];
        bool is_coordinate = columns->role_of[i] < ROLE_X + 3;
        bool is_word = !columns_is_absent(cell) && !table_number(&value, &columns->table, cell);
        is_whole = is_whole && (!is_coordinate || (!is_word && isfinite(value)));
        largest = is_coordinate ? fmax(largest, fabs(value)) : largest;
        bool is_glyph = cell.size && (unsigned char)cell.data[0] >= 0x80 && !text_minus(cell);
        size_t length = is_glyph ? text_character(cell) : 0;
        *has_word |= is_word && columns->role_of[i] < ROLE_ANGLE;
        *has_glyph |=
            is_word && is_coordinate && length && length < cell.size && isdigit((unsigned char)cell.data[length]);
    }
    *farthest = is_whole ? fmax(*farthest, largest) : *farthest;
}

void columns_check_numbers(const struct head *head)
{
    struct census census = {0};
    struct text rest = head->text;
    struct text text;
    const conus_pose_options *options = head->options;
    const double longest = options->longest; /* 0: what needs it is not asked */
    find_side_columns(&census, head);
    char first_fault[256] = "";
    for (size_t number = 1; text_line(&rest, &text); number++) {
        conus_pose_row row = pose_row_at(number);
        struct pose_name name = {.text = {"", 0}};
        conus_status bad = CONUS_OK;
        enum columns_line kind = columns_read(&row, &name, &bad, head->out, text, number, options);
        bool has_word = false;
        bool has_glyph = false;
        census.rows += kind == LINE_ROW;
        if (kind == LINE_ROW && bad) {
            find_faults(&has_word, &has_glyph, &census.farthest, head->out, text);
        } else if (kind == LINE_ROW) {
            count_row(&census, head, &row, text, name.text, longest);
        }
        if (has_glyph) {
            job_bad(head->job, "line %zu: a character before a number that is no minus (as PDFs lose them): %s", number,
                    conus_message());
            return;
        }
        if (has_word && !census.bad++) {
            snprintf(first_fault, sizeof first_fault, "%s", conus_message());
        }
    }
    judge(&census, head, longest, first_fault);
}

/* Words of at least so many letters count, and none beside one of a hand or the like. */
static int find_side(struct text name, size_t least)
{
    static const char left[] = "left/l/lh/links/gauche", right[] = "right/r/rh/rechts/droite";
    int side = 0;
    for (size_t i = 0; i < name.size;) {
        size_t size = 0;
        while (i + size < name.size && !strchr(" _-.,()[]", name.data[i + size])) {
            size++;
        }
        const struct text word = {name.data + i, size};
        if (text_is_one_of(word, limbs, false)) {
            return 0;
        }
        side = size < least                         ? side
               : text_is_one_of(word, left, false)  ? -1
               : text_is_one_of(word, right, false) ? 1
                                                    : side;
        i += size + 1;
    }
    return side;
}

int sides_of_name(struct text name)
{
    return find_side(name, 1);
}

int sides_of_file(const char *path)
{
    return path ? find_side(text_from(path_base(path)), 2) : 0;
}

/* The letters of a contact's name: "LPH" of "LPH 1". They begin with two capitals, L or R the first. *ends: whether the
 * name ends with a number. */
static struct text letters_of(struct text name, bool *ends)
{
    static const char capitals[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZ", small[] = "abcdefghijklmnopqrstuvwxyz";
    size_t size = name.size;
    while (size && strchr("0123456789", name.data[size - 1])) {
        size--;
    }
    *ends = size < name.size;
    size -= size && strchr(" _-", name.data[size - 1]);
    bool fits =
        *ends && size >= 2 && size < SIDES_SHAFT_SIZE && strchr("LR", name.data[0]) && strchr(capitals, name.data[1]);
    for (size_t i = 2; i < size && fits; i++) {
        fits = strchr(capitals, name.data[i]) || strchr(small, name.data[i]);
    }
    return (struct text){name.data, fits ? size : 0};
}

static void count_shaft(struct sides *sides, struct text name, double x, double edge)
{
    bool ends;
    const struct text letters = letters_of(name, &ends);
    size_t i = 0;
    while (i < sides->shaft_count && !text_equal(letters, sides->shafts[i].letters)) {
        i++;
    }
    if (!letters.size || i == SIDES_SHAFTS) {
        sides->has_others = sides->has_others || ends;
        return;
    }
    struct shaft *shaft = &sides->shafts[i];
    if (i == sides->shaft_count) {
        sides->shaft_count++;
        memcpy(shaft->letters, letters.data, letters.size);
    }
    shaft->contacts++;
    shaft->wrong += letters.data[0] == 'L' ? x > edge : x < -edge;
}

static void count_ending(struct sides *sides, struct text name, double x, double edge)
{
    const char last = name.size > 1 ? name.data[name.size - 1] : ' ';
    const unsigned char before = name.size > 1 ? (unsigned char)name.data[name.size - 2] : ' ';
    if ((last == 'L' || last == 'R') && (islower(before) || isdigit(before))) {
        sides->ended[last == 'R']++;
        sides->ended_wrong += last == 'L' ? x > edge : x < -edge;
    }
}

bool sides_count(struct sides *sides, int side, struct text name, double x, double edge)
{
    bool is_wrong = side < 0 ? x > edge : side > 0 && x < -edge;
    size_t *wrong = side < 0 ? &sides->left_on_right : &sides->right_on_left;
    sides->points++;
    sides->beyond[0] += x < -edge;
    sides->beyond[1] += x > edge;
    if (side) {
        *(side < 0 ? &sides->left : &sides->right) += 1;
        *wrong += is_wrong;
    } else {
        count_shaft(sides, name, x, edge);
        count_ending(sides, name, x, edge);
    }
    return is_wrong;
}

void sides_check(struct job *job, const struct sides *s, const char *why, const char *file)
{
    bool is_wrong = (s->left && 2 * s->left_on_right >= s->left) || (s->right && 2 * s->right_on_left >= s->right);
    if (is_wrong && s->left + s->right >= 2) {
        job_bad(job,
                "sides: %zu of %zu rows called left lie on the right, %zu of %zu called right on the left; %s; only if "
                "numbers and sides are both right, type %s,sides=anyway",
                s->left_on_right, s->left, s->right_on_left, s->right, why, file);
    }
}

void sides_warn(struct job *job, const struct sides *sides, int of_file)
{
    enum { LEAST = 3 };
    char shown[4 * SIDES_SHAFT_SIZE] = "";
    size_t of_letter[2] = {0};
    size_t wrong = 0;
    const size_t beyond = of_file ? sides->beyond[of_file < 0] : 0;
    if (sides->points >= LEAST && 2 * beyond > sides->points) {
        job_warn(job,
                 "its name says %s, and %zu of %zu points lie on the %s; is x mirrored? If not, type "
                 "FILE,sides=anyway",
                 of_file < 0 ? "left" : "right", beyond, sides->points, of_file < 0 ? "right" : "left");
    }
    for (size_t i = 0; i < sides->shaft_count; i++) {
        of_letter[sides->shafts[i].letters[0] == 'R']++;
    }
    bool are_all = !sides->has_others && sides->shaft_count >= (of_letter[0] && of_letter[1] ? 2 : 3);
    for (size_t i = 0; i < sides->shaft_count; i++) {
        const struct shaft *shaft = &sides->shafts[i];
        bool is_side = are_all;
        for (size_t k = 0; k < sides->shaft_count; k++) {
            const char *other = sides->shafts[k].letters;
            is_side = is_side || (other[0] != shaft->letters[0] && strcmp(other + 1, shaft->letters + 1) == 0);
        }
        if (is_side && shaft->contacts >= LEAST && shaft->wrong == shaft->contacts && wrong++ < 3) {
            size_t used = strlen(shown);
            snprintf(shown + used, sizeof shown - used, "%s%s", used ? ", " : "", shaft->letters);
        }
    }
    const size_t *ended = sides->ended;
    if (ended[0] && ended[1] && ended[0] + ended[1] > 2 && sides->ended_wrong == ended[0] + ended[1]) {
        job_warn(job,
                 "all names that end with L or R (%zu and %zu) lie on the other side; is x mirrored? If not, type "
                 "FILE,sides=anyway",
                 ended[0], ended[1]);
    }
    if (wrong) {
        job_warn(job,
                 "%zu of %zu electrodes lie on the other side than the first letter of their names says "
                 "(%s%s); is x mirrored? If not, type FILE,sides=anyway",
                 wrong, sides->shaft_count, shown, wrong > 3 ? ", ..." : "");
    }
}
