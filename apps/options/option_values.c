/* SPDX-License-Identifier: BSD-3-Clause */
/* Reads the values of options by their types. */
#include "base/text.h"
#include "options/messages.h"
#include "options/options.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

static const char digits[] = "0123456789";

/* Behind the sign: digits with at most one point among them, exponent: the form that strtod() reads the same in every
 * program, and none of "nan", "inf", "0x1p3" and " 1" that it would take as well. */
static bool is_decimal(const char *text)
{
    size_t whole = strspn(text, digits);
    text += whole;
    size_t fraction = 0;
    if (*text == '.') {
        fraction = strspn(++text, digits);
        text += fraction;
    }
    if (whole + fraction == 0) {
        return false;
    }
    if (*text == 'e' || *text == 'E') {
        text++;
        text += *text == '-' || *text == '+';
        size_t exponent = strspn(text, digits);
        return exponent > 0 && text[exponent] == '\0';
    }
    return *text == '\0';
}

bool number_parse(const char *text, double *out)
{
    char sign; /* a typographic minus, too, as texts and tables are copied */
    text += text_sign(&sign, text_from(text));
    if (!is_decimal(text)) {
        return false;
    }
    double number = strtod(text, NULL); /* the program never leaves the C locale */
    number = sign == '-' ? -number : number;
    if (!isfinite(number)) {
        return false;
    }
    *out = number;
    return true;
}

bool count_parse(const char *text, uint64_t limit, uint64_t *out)
{
    size_t length = strspn(text, digits);
    if (length == 0 || text[length]) {
        return false;
    }
    errno = 0;
    unsigned long long number = strtoull(text, NULL, 10);
    if (errno || number > limit) {
        return false;
    }
    *out = number;
    return true;
}

static bool outside(const struct option *option, double number)
{
    if (option->low == 0 && option->high == 0) {
        return false;
    }
    return (number < option->low || (number == option->low && (option->open || option->open_below))) ||
           (number > option->high || (number == option->high && option->open));
}

static bool refuse_value(const struct option *option, const char *text, const char *wanted)
{
    return refuse("--%s: \"%s\" is not %s%s", option->name, text, wanted, option->hint ? option->hint : "");
}

static bool refuse_range(const struct option *option, const char *text)
{
    const char *form = option->open         ? "--%s: %s is out of range, allowed is more than %.10g and less than %.10g"
                       : option->open_below ? "--%s: %s is out of range, allowed is more than %.10g to %.10g"
                                            : "--%s: %s is out of range, allowed is %.10g to %.10g";
    return refuse(form, option->name, text, option->low, option->high);
}

static bool read_count(const struct option *option, uint32_t *field, const char *text)
{
    uint64_t number;
    if (!count_parse(text, UINT64_MAX, &number)) {
        return refuse_value(option, text, "a whole number");
    }
    if (number > UINT32_MAX || outside(option, (double)number)) {
        return refuse_range(option, text);
    }
    *field = (uint32_t)number;
    return true;
}

enum { NUMBERS_SIZE = 256 };

size_t numbers_parse(double *out, size_t limit, const char *text, char separator)
{
    for (size_t count = 0; count < limit; text++) {
        char word[NUMBERS_SIZE];
        size_t length = strcspn(text, (const char[]){separator, '\0'});
        if (length >= sizeof word) {
            return 0;
        }
        memcpy(word, text, length);
        word[length] = '\0';
        if (!number_parse(word, &out[count++])) {
            return 0;
        }
        text += length;
        if (!*text) {
            return count;
        }
    }
    return 0;
}

static bool read_numbers(const struct option *option, double *field, size_t count, const char *text, const char *wanted)
{
    double numbers[4];
    if (numbers_parse(numbers, count, text, ',') != count) {
        return refuse_value(option, text, wanted);
    }
    for (size_t i = 0; i < count; i++) {
        if (outside(option, numbers[i])) {
            return refuse_range(option, text);
        }
    }
    memcpy(field, numbers, count * sizeof *field);
    return true;
}

/* A number with or without the option's unit behind it: "5", "5mm", "0.5 cm". */
static bool read_number(const struct option *option, double *field, const char *text)
{
    static const struct {
        const char *unit, *word;
        double factor;
    } units[] = {
        {"mm", "mm", 1}, {"mm", "cm", 10}, {"degrees", "deg", 1}, {"degrees", "degrees", 1}, {"degrees", "°", 1}};
    char word[NUMBERS_SIZE];
    double number = 0;
    bool is_number = number_parse(text, &number);
    for (size_t i = 0; !is_number && option->unit && i < sizeof units / sizeof units[0]; i++) {
        const size_t unit = strlen(units[i].word);
        size_t length = strlen(text);
        if (strcmp(option->unit, units[i].unit) == 0 && length > unit && length < sizeof word &&
            strcasecmp(text + length - unit, units[i].word) == 0) {
            length -= unit;
            length -= text[length - 1] == ' ';
            memcpy(word, text, length);
            word[length] = '\0';
            is_number = number_parse(word, &number);
            number *= units[i].factor;
        }
    }
    if (!is_number) {
        return refuse_value(option, text, "a number");
    }
    if (outside(option, number)) {
        return refuse_range(option, text);
    }
    *field = number;
    return true;
}

/* LOW,target[+MM] */
static bool read_to_target(const struct option *option, struct depth_range *field, const char *text)
{
    static const char mark[] = ",target";
    const char *at = strstr(text, mark);
    char low[NUMBERS_SIZE];
    double numbers[2] = {0};
    snprintf(low, sizeof low, "%.*s", at ? (int)(at - text) : 0, text);
    at += at ? sizeof mark - 1 : 0;
    if (!at || !number_parse(low, &numbers[0]) || (*at && (*at != '+' || !number_parse(at + 1, &numbers[1])))) {
        return refuse_value(option, text, "two numbers NEAR,FAR or NEAR,target[+MM] without spaces");
    }
    if (outside(option, numbers[0]) || outside(option, numbers[1])) {
        return refuse_range(option, text);
    }
    *field = (struct depth_range){.ends = {numbers[0], 0}, .beyond = numbers[1], .to_target = true};
    return true;
}

static bool read_size(const struct option *option, uint32_t field[2], const char *text)
{
    double numbers[2];
    bool is_size = !text[strspn(text, "0123456789x")] && numbers_parse(numbers, 2, text, 'x') == 2;
    for (size_t i = 0; i < 2; i++) {
        if (!is_size || numbers[i] > UINT32_MAX) {
            return refuse_value(option, text, "a size WxH");
        }
        if (outside(option, numbers[i])) {
            return refuse_range(option, text);
        }
        field[i] = (uint32_t)numbers[i];
    }
    return true;
}

static bool read_bytes(const struct option *option, uint64_t *field, const char *text)
{
    static const char units[] = "KMGT";
    static const char wanted[] = "a number of bytes above 0, like 512M or 2G";
    char copy[NUMBERS_SIZE];
    size_t length = strlen(text);
    if (length == 0 || length >= sizeof copy) {
        return refuse_value(option, text, wanted);
    }
    memcpy(copy, text, length + 1);
    const char *unit = strchr(units, copy[length - 1]);
    unsigned shift = unit ? 10 * (unsigned)(unit - units + 1) : 0;
    if (unit) {
        copy[length - 1] = '\0';
    }
    uint64_t number;
    if (!count_parse(copy, UINT64_MAX >> shift, &number) || number == 0) {
        return refuse_value(option, text, wanted);
    }
    *field = number << shift;
    return true;
}

const char *option_choice(const struct option *option, size_t index)
{
    return option->choices ? option->choices[index] : option->choice_at(index);
}

const char *option_standard(const struct option *option)
{
    bool is_choice = option->type == OPTION_CHOICE && !option->otherwise;
    return option->standard || !is_choice ? option->standard : option_choice(option, 0);
}

static const char *choice_of(const void *option, size_t index)
{
    return option_choice(option, index);
}

static bool read_choice(const struct option *option, size_t *field, const char *text)
{
    const char *choice;
    for (size_t i = 0; (choice = option_choice(option, i)); i++) {
        if (strcasecmp(choice, text) == 0) {
            *field = i;
            return true;
        }
    }
    const char *near = closest_name(text, choice_of, option);
    if (near) {
        return refuse("--%s: \"%s\" is none of its choices; did you mean %s?", option->name, text, near);
    }
    char list[NUMBERS_SIZE] = "";
    for (size_t i = 0; (choice = option_choice(option, i)); i++) {
        size_t used = strlen(list);
        snprintf(list + used, sizeof list - used, "%s%s", i ? ", " : "", choice);
    }
    return refuse("--%s: \"%s\" is none of its choices: %s%s", option->name, text, list,
                  option->advice ? option->advice : "");
}

static bool read_text(const struct option *option, const char **field, const char *text)
{
    *field = text;
    return *text || refuse_value(option, text, option->value);
}

static bool read_item(const struct option *option, struct option_list *field, const char *text)
{
    const char **items = realloc(field->items, (field->count + 1) * sizeof *items);
    if (!items) {
        return refuse("--%s: not enough memory", option->name);
    }
    field->items = items;
    return read_text(option, &items[field->count++], text);
}

bool option_read(const struct option *option, void *field, const char *text)
{
    double *numbers = field; /* of the types that are numbers */
    switch (option->type) {
    case OPTION_FLAG:
        *(bool *)field = true;
        return true;
    case OPTION_NUMBER:
        return read_number(option, numbers, text);
    case OPTION_COUNT:
        return read_count(option, field, text);
    case OPTION_VECTOR:
        return read_numbers(option, field, 3, text, "three numbers X,Y,Z without spaces");
    case OPTION_RANGE:
        if (option->flags & OPTION_TO_TARGET && strchr(text, 't')) {
            return read_to_target(option, field, text);
        }
        return read_numbers(option, field, 2, text, "two numbers LOW,HIGH without spaces") &&
               (numbers[0] < numbers[1] || refuse_value(option, text, "two numbers, the lower one first"));
    case OPTION_EDGES:
        return read_numbers(option, field, 4, text, "four numbers LEFT,RIGHT,LOWER,UPPER without spaces") &&
               ((numbers[0] < numbers[1] && numbers[2] < numbers[3]) ||
                refuse_value(option, text, "left before right and lower before upper"));
    case OPTION_SIZE:
        return read_size(option, field, text);
    case OPTION_BYTES:
        return read_bytes(option, field, text);
    case OPTION_CHOICE:
        return read_choice(option, field, text);
    case OPTION_TEXT:
        return read_text(option, field, text);
    case OPTION_LIST:
        return read_item(option, field, text);
    }
    return false;
}

bool option_names_file(const struct option *option, const char *value)
{
    const size_t word = option->no_file ? strlen(option->no_file) : 0;
    return !word || strncmp(value, option->no_file, word) != 0 || (value[word] && value[word] != ',');
}

bool option_cut_keys(struct source_keys *out, const char *option, char *text, enum key_kind kind)
{
    return text ? (keys_cut(out, text, kind) && *text) ||
                      refuse("--%s: %s", option, *text ? out->why : "\"\" names no file")
                : refuse("--%s: not enough memory", option);
}

/* Bytes of the fields of options that may have a standard value. */
static const size_t field_sizes[] = {
    [OPTION_NUMBER] = sizeof(double),     [OPTION_COUNT] = sizeof(uint32_t), [OPTION_VECTOR] = 3 * sizeof(double),
    [OPTION_SIZE] = 2 * sizeof(uint32_t), [OPTION_CHOICE] = sizeof(size_t),  [OPTION_BYTES] = sizeof(uint64_t),
    [OPTION_TEXT] = sizeof(const char *)};

bool option_is_standard(const struct option *option, const char *text, void *field)
{
    union {
        double numbers[3];
        uint64_t whole;
        const char *text;
    } standard = {0}, given = {0};
    const char *is = option_standard(option);
    if (!is || !text || !option_read(option, &standard, is) || !option_read(option, &given, text)) {
        return false;
    }
    const size_t size = field_sizes[option->type];
    bool same = option->type == OPTION_TEXT ? strcmp(is, text) == 0 : memcmp(&standard, &given, size) == 0;
    if (same) {
        memset(field, 0, size);
    }
    return same;
}
