/* SPDX-License-Identifier: BSD-3-Clause */
/* Reads the numbers of a position as people paste them: first pieces and what joins them, then what a comma is. */
#include "base/text.h"

#include <math.h>

enum { WANTED = 3, PIECE_LIMIT = 12, DEPTH_LIMIT = 8, NAME_LIMIT = 4 };

/** What a comma between two digits is. */
enum comma {
    COMMA_UNKNOWN = 0,
    COMMA_DECIMAL, /* -42,5 is -42.5 */
    COMMA_GROUPS   /* 5,739 is 5739 */
};

/** What stands between a piece and the one before it. */
enum joint {
    JOINT_BLANK, /* or a semicolon, a bracket, a word */
    JOINT_COMMA, /* with something beside it */
    JOINT_TIGHT, /* a comma alone, before a sign or a point */
    JOINT_DIGITS /* a comma alone between two digits: perhaps within a number */
};

/** Digits, perhaps with a sign, a point and an exponent: a number, or a part of one that has commas. */
struct piece {
    struct text whole;
    struct text digits; /* without the sign */
    char sign;          /* '-', '+', 0 = none */
    char letter;        /* L R A P S I, 0 = none */
    bool is_plain;      /* only digits */
    enum joint joint;
};

struct scan {
    struct numbers *out;
    struct text rest;
    const char *behind; /* of the last piece */
    bool letters_lead;  /* they stand before their numbers */
    enum comma comma;
    struct piece pieces[PIECE_LIMIT];
    size_t count;
    struct text names[NAME_LIMIT]; /* x y z, as they came */
    size_t before[NAME_LIMIT];     /* pieces before each */
    size_t named;
    char letter; /* one that waits for its number */
    char open[DEPTH_LIMIT];
    size_t depth;
    unsigned separators; /* since the last piece */
    bool has_comma;      /* among them */
    bool after_word;
    bool has_word;
};

static bool is_digit(char c)
{
    return c >= '0' && c <= '9';
}

static bool is_letter(char c)
{
    return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || c == '_';
}

/* The first fault stays. */
static void refuse_part(struct scan *scan, struct text at, const char *why)
{
    if (!scan->out->why) {
        scan->out->at = at;
        scan->out->why = why;
    }
}

static struct text take_bytes(struct text *rest, size_t size)
{
    struct text taken = {rest->data, size};
    rest->data += size;
    rest->size -= size;
    return taken;
}

/* Finds the piece that a text begins with; false if there is none. */
static bool find_piece(struct piece *out, struct text text)
{
    struct piece piece = {0};
    size_t start = text_sign(&piece.sign, text);
    size_t whole = text_digits(text, start);
    size_t end = start + whole;
    size_t fraction = end < text.size && text.data[end] == '.' ? 1 + text_digits(text, end + 1) : 0;
    piece.is_plain = !fraction;
    end += fraction;
    if (whole + fraction < 1 + (size_t)(whole == 0)) {
        return false;
    }
    if (end < text.size && (text.data[end] == 'e' || text.data[end] == 'E')) {
        size_t at = end + 1;
        at += at < text.size && (text.data[at] == '-' || text.data[at] == '+');
        size_t exponent = text_digits(text, at);
        piece.is_plain = piece.is_plain && !exponent;
        end = exponent ? at + exponent : end;
    }
    piece.whole = (struct text){text.data, end};
    piece.digits = (struct text){text.data + start, end - start};
    *out = piece;
    return true;
}

static void take_piece(struct scan *scan, struct piece *piece)
{
    bool is_alone = scan->has_comma && scan->behind && scan->behind + 1 == piece->whole.data;
    piece->joint = !scan->has_comma                                               ? JOINT_BLANK
                   : !is_alone                                                    ? JOINT_COMMA
                   : is_digit(piece->whole.data[0]) && is_digit(scan->behind[-1]) ? JOINT_DIGITS
                                                                                  : JOINT_TIGHT;
    take_bytes(&scan->rest, piece->whole.size);
    if (scan->count && scan->behind == piece->whole.data) {
        refuse_part(scan, piece->whole, "stands directly behind another number");
    }
    if (scan->separators > (scan->count ? 1 : 0) && (scan->count || !scan->has_word)) {
        refuse_part(scan, piece->whole, "has an empty place before it, where a number is missing");
    }
    piece->letter = scan->letter;
    scan->letter = 0;
    if (scan->count < PIECE_LIMIT) {
        scan->pieces[scan->count] = *piece;
    }
    scan->count++;
    scan->behind = piece->whole.data + piece->whole.size;
    scan->separators = 0;
    scan->has_comma = false;
    scan->after_word = false;
}

static bool is_side(struct text word)
{
    return word.size == 1 && memchr("LRAPSI", word.data[0], 6);
}

/* All letters stand before their numbers, or all behind them; the first one shows which. */
static void take_letter(struct scan *scan, struct text word)
{
    struct piece *last = scan->count && scan->count <= PIECE_LIMIT ? &scan->pieces[scan->count - 1] : NULL;
    bool is_first = !scan->out->has_letters;
    scan->out->has_letters = true;
    scan->letters_lead = is_first ? !scan->count : scan->letters_lead;
    if (scan->letters_lead && !scan->letter) {
        scan->letter = word.data[0];
    } else if (!scan->letters_lead && last && !last->letter && !scan->separators) {
        last->letter = word.data[0];
    } else {
        refuse_part(scan, word, "stands with no number of its own");
    }
}

static void take_word(struct scan *scan)
{
    struct text rest = scan->rest;
    size_t size = 1;
    while (size < rest.size && (is_letter(rest.data[size]) || is_digit(rest.data[size]))) {
        size++;
    }
    bool is_before_digits = size > 1 && text_digits(rest, 1) == size - 1;
    struct text word = take_bytes(&scan->rest, is_before_digits && is_side((struct text){rest.data, 1}) ? 1 : size);
    bool is_name = text_is_one_of(word, "x/y/z", false);
    scan->after_word = true;
    scan->has_word = true;
    if (is_side(word)) {
        take_letter(scan, word);
    } else if (is_name && scan->named < NAME_LIMIT) {
        scan->before[scan->named] = scan->count;
        scan->names[scan->named++] = word;
        scan->separators = scan->count ? scan->separators : 0;
    } else if (text_is_one_of(word, "mni/mni152", false)) {
        scan->out->says_mni = true;
    } else if (text_equal_ignoring_case(word, "mm")) {
        scan->out->says_mm = true;
    } else if (text_equal_ignoring_case(word, "ras")) {
        scan->out->says_ras = true;
    } else if (is_name || !text_is_one_of(word, "at/peak", false)) {
        refuse_part(scan, word, "is no number, sign or known word (x y z, mm, MNI, MNI152, RAS, at, peak)");
    }
}

static void take_mark(struct scan *scan, size_t size)
{
    static const char opening[] = "([{";
    static const char closing[] = ")]}";
    struct text mark = take_bytes(&scan->rest, size);
    char c = mark.data[0];
    const char *open = strchr(opening, c);
    const char *close = strchr(closing, c);
    if (c == ',' || c == ';') {
        scan->separators++;
        scan->has_comma = scan->has_comma || c == ',';
    } else if (c && open && scan->depth < DEPTH_LIMIT) {
        scan->open[scan->depth++] = closing[open - opening];
    } else if (c && close && scan->depth && scan->open[scan->depth - 1] == c) {
        scan->depth--;
    } else if ((c != '=' && c != ':') || !scan->after_word) {
        refuse_part(scan, mark, c && (open || close) ? "has no counterpart" : "is no number, sign or known word there");
    }
    scan->after_word = scan->after_word && c && close;
}

static void scan_text(struct scan *scan)
{
    while (scan->rest.size) {
        struct piece piece;
        size_t blank = text_blank(scan->rest);
        size_t character = text_character(scan->rest);
        if (blank) {
            take_bytes(&scan->rest, blank);
        } else if (find_piece(&piece, scan->rest)) {
            take_piece(scan, &piece);
        } else if (is_letter(scan->rest.data[0])) {
            take_word(scan);
        } else {
            take_mark(scan, character ? character : 1);
        }
    }
}

/** The pieces of a number, from the first to before the last. */
struct run {
    size_t first, end;
};

/* What the commas of a number can only be; UNKNOWN where they may be either, or *none where they are neither. */
static enum comma judge_commas(bool *is_neither, const struct piece *pieces, const struct run *run)
{
    const struct piece *first = &pieces[run->first];
    bool is_decimal = run->end - run->first == 2 && first->is_plain && pieces[run->first + 1].is_plain;
    bool is_grouped = first->is_plain && first->digits.size <= 3 && first->digits.data[0] != '0';
    for (size_t i = run->first + 1; i < run->end; i++) {
        is_grouped = is_grouped && text_digits(pieces[i].digits, 0) == 3 && (pieces[i].is_plain || i + 1 == run->end);
    }
    *is_neither = !is_decimal && !is_grouped;
    return is_decimal == is_grouped ? COMMA_UNKNOWN : is_decimal ? COMMA_DECIMAL : COMMA_GROUPS;
}

/* Decides which pieces are one number. False where they are refused. */
static bool join_pieces(struct run runs[WANTED], struct scan *scan)
{
    static const char *const mixed = "has a comma that may stand within a number or between two; write decimal points";
    struct piece *pieces = scan->pieces;
    size_t within = 0;
    bool separates = false; /* a comma does so for sure, */
    bool has_other = false; /* or something else does */
    struct text at = pieces[0].whole;
    for (size_t i = 1; i < scan->count && i < PIECE_LIMIT; i++) {
        bool is_within = pieces[i].joint == JOINT_DIGITS;
        at = is_within && !within ? pieces[i].whole : at;
        within += is_within;
        separates = separates || pieces[i].joint == JOINT_COMMA || pieces[i].joint == JOINT_TIGHT;
        has_other = has_other || pieces[i].joint == JOINT_BLANK || pieces[i].joint == JOINT_COMMA;
    }
    bool is_split = scan->count == WANTED && (!within || !has_other);
    if (!is_split && (scan->count > PIECE_LIMIT || scan->count - within != WANTED)) {
        bool is_short = scan->count == WANTED; /* as in "12,5 30" */
        refuse_part(scan, is_short ? at : pieces[WANTED].whole,
                    is_short ? mixed
                    : scan->count == 2 * WANTED
                        ? "is a number too many; where commas are decimal, blanks or semicolons "
                          "stand between numbers: \"-42,5 12,0 30,1\""
                        : "is a number too many");
        return false;
    }
    if (!is_split && separates) {
        refuse_part(scan, at, mixed);
        return false;
    }
    for (size_t i = 0, count = 0; i < scan->count; i++) {
        count += i == 0 || is_split || pieces[i].joint != JOINT_DIGITS;
        runs[count - 1] =
            (struct run){i && !is_split && pieces[i].joint == JOINT_DIGITS ? runs[count - 1].first : i, i + 1};
    }
    return true;
}

/* A number as it stands in the text. */
static struct text text_of_run(const struct scan *scan, const struct run *run)
{
    struct text last = scan->pieces[run->end - 1].whole;
    const char *first = scan->pieces[run->first].whole.data;
    return (struct text){first, (size_t)(last.data + last.size - first)};
}

/* What commas within the numbers are. False where that is not known. */
static bool settle_commas(struct scan *scan, const struct run *runs)
{
    const struct run *doubtful = NULL;
    bool shows[3] = {false};
    bool has_commas = false;
    for (size_t i = 0; i < WANTED; i++) {
        const struct piece *first = &scan->pieces[runs[i].first];
        bool is_joined = runs[i].end - runs[i].first > 1;
        bool is_neither = false;
        enum comma shown = is_joined         ? judge_commas(&is_neither, scan->pieces, &runs[i])
                           : first->is_plain ? COMMA_UNKNOWN
                                             : COMMA_GROUPS; /* it has a point */
        if (is_neither) {
            refuse_part(scan, text_of_run(scan, &runs[i]),
                        "has a comma that is neither a decimal comma nor one of thousands");
            return false;
        }
        has_commas = has_commas || is_joined;
        doubtful = is_joined && !shown && !doubtful ? &runs[i] : doubtful;
        shows[shown] = true;
    }
    if (!has_commas) {
        return true;
    }
    if (shows[COMMA_DECIMAL] && shows[COMMA_GROUPS]) {
        refuse_part(scan, scan->pieces[0].whole, "and the other numbers contradict each other in what a comma is");
        return false;
    }
    scan->comma = shows[COMMA_DECIMAL] ? COMMA_DECIMAL : shows[COMMA_GROUPS] ? COMMA_GROUPS : COMMA_UNKNOWN;
    if (!scan->comma) {
        refuse_part(scan, text_of_run(scan, doubtful),
                    "has a comma before three digits: a decimal comma, or one of thousands? Write a dot, or no comma");
    }
    return scan->comma;
}

static bool read_number(double *out, const struct scan *scan, const struct run *run)
{
    char digits[64];
    size_t size = 0;
    for (size_t i = run->first; i < run->end; i++) {
        struct text piece = scan->pieces[i].digits;
        bool has_comma = i > run->first && scan->comma == COMMA_DECIMAL;
        if (size + piece.size + has_comma >= sizeof digits) {
            return false;
        }
        digits[size] = '.';
        memcpy(digits + size + has_comma, piece.data, piece.size);
        size += has_comma + piece.size;
    }
    double value;
    bool is_number = text_to_double((struct text){digits, size}, &value) && isfinite(value);
    if (is_number) {
        *out = scan->pieces[run->first].sign == '-' ? -value : value;
    }
    return is_number;
}

/* Turns the number by the letter beside it. */
static bool turn_by_letter(double *value, struct scan *scan, const struct run *run, size_t axis)
{
    static const char *const letters[] = {"LR", "PA", "IS"};
    const struct piece *first = &scan->pieces[run->first];
    const struct piece *last = &scan->pieces[run->end - 1];
    char letter = first->letter ? first->letter : last->letter;
    if (!letter) {
        return true;
    }
    const char *found = strchr(letters[axis], letter);
    bool is_negative = found == letters[axis];
    if (!found || (first->letter && last->letter && first != last) ||
        (first->sign && (first->sign == '-') != is_negative)) {
        refuse_part(scan, first->whole,
                    found ? "has a sign and a letter that contradict each other"
                          : "has a letter of another axis; wanted are L or R, then P or A, then I or S");
        return false;
    }
    *value = is_negative ? -fabs(*value) : *value;
    return true;
}

static bool check_names(struct scan *scan, const struct run *runs)
{
    static const char *const axes[] = {"x", "y", "z"};
    bool is_front = true; /* all before the first number */
    bool is_each = true;  /* or each before its own */
    for (size_t i = 0; i < scan->named; i++) {
        bool is_right = i < WANTED && text_equal_ignoring_case(scan->names[i], axes[i]);
        is_front = is_front && is_right && scan->before[i] == 0;
        is_each = is_each && is_right && scan->before[i] == runs[i % 3].first;
    }
    if (scan->named && (scan->named != 3 || (!is_front && !is_each))) {
        refuse_part(scan, scan->names[0], "and the other names of axes do not stand as x, y, z before the numbers");
        return false;
    }
    return true;
}

enum numbers_found numbers_read(struct numbers *out, struct text text)
{
    struct run runs[WANTED] = {{0}};
    *out = (struct numbers){0};
    struct scan scan = {.out = out, .rest = text};
    scan_text(&scan);
    out->count = scan.count;
    if (scan.count < WANTED) {
        out->why = NULL;
        return NUMBERS_NONE;
    }
    if (scan.separators > 1 || scan.depth || scan.letter) {
        refuse_part(&scan, scan.pieces[0].whole,
                    scan.depth ? "stands in a bracket that is not closed" : "and the others end in a sign of more");
    }
    bool is_fine = !out->why && join_pieces(runs, &scan) && settle_commas(&scan, runs) && check_names(&scan, runs);
    for (size_t i = 0; i < WANTED && is_fine; i++) {
        if (!read_number(&out->value[i], &scan, &runs[i])) {
            refuse_part(&scan, scan.pieces[runs[i].first].whole, "is out of the range of numbers");
        }
        is_fine = !out->why && turn_by_letter(&out->value[i], &scan, &runs[i], i);
    }
    return is_fine ? NUMBERS_FOUND : NUMBERS_WRONG;
}
