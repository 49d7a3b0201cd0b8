/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * Commands and their options as tables. One table feeds the parser, its messages and --help. */
#ifndef CONUS_OPTIONS_OPTIONS_H
#define CONUS_OPTIONS_OPTIONS_H

#include "sources/names.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

/** The digits of a constant, for the text of a help. */
#define OPTION_DIGITS(constant) OPTION_DIGITS_OF(constant)
#define OPTION_DIGITS_OF(digits) #digits

/** The kind of an option's value, and the C type of the field that receives it. */
enum option_type {
    OPTION_FLAG,   /**< No value; bool.                                          */
    OPTION_NUMBER, /**< double                                                   */
    OPTION_COUNT,  /**< Whole number; uint32_t.                                  */
    OPTION_VECTOR, /**< X,Y,Z; double[3].                                        */
    OPTION_RANGE,  /**< LOW,HIGH, the first below the second; double[2].         */
    OPTION_EDGES,  /**< LEFT,RIGHT,LOWER,UPPER, each pair ascending; double[4].  */
    OPTION_SIZE,   /**< WxH; uint32_t[2].                                        */
    OPTION_BYTES,  /**< Whole number with K, M, G or T after it; uint64_t.       */
    OPTION_CHOICE, /**< One of the option's choices; size_t, its index.          */
    OPTION_TEXT,   /**< const char *                                             */
    OPTION_LIST,   /**< Text, may be repeated; struct option_list.               */
};

struct option_list {
    const char **items;
    size_t count;
};

/** The role of an option in its command. The checks of files, the sidecar and `conus verify` follow from it. */
enum option_role {
    OPTION_PLAIN,          /**< A part of the question; but a text, which may be a path, is not asked again. */
    OPTION_ASKS,           /**< A text that is a part of the question, and no path. */
    OPTION_KEPT,           /**< No part of the question, but asked again: a limit, a format. */
    OPTION_OF_RUN,         /**< Says how a run goes, and not what it answers. */
    OPTION_LIVE,           /**< Poses come from a tracker, which cannot be asked again. */
    OPTION_READS,          /**< A file that is read, perhaps with keys behind it. */
    OPTION_READS_NAMES,    /**< Names or numbers, or a file of them: "@FILE", FILE. */
    OPTION_READS_ATLAS,    /**< An atlas, by its file or name. */
    OPTION_READS_IMAGE,    /**< Likewise a volume that is no atlas, or a surface. */
    OPTION_READS_POSES,    /**< A file of poses, or - for standard input. */
    OPTION_WRITES_ANSWER,  /**< The file of the answer. */
    OPTION_WRITES_SIDECAR, /**< The .json that describes it. */
    OPTION_WRITES,         /**< Another file that belongs to the answer, */
    OPTION_WRITES_ROWS,    /**< or one of rows, with a .json of its own. */
    OPTION_ENDS,           /**< Ends the program: --help, --version. */
};

/** What is in a file that an option or an operand names; JSON has its word (apps/pages). */
enum option_content {
    HOLDS_NOTHING, /**< It names no file. */
    HOLDS_ATLAS,
    HOLDS_VOLUME,
    HOLDS_LABELS, /**< Numbers and names: a table of labels. */
    HOLDS_POSES,
    HOLDS_PROBE,
    HOLDS_SURFACE,
    HOLDS_TRACTS,
    HOLDS_TRANSFORM,
    HOLDS_NAMES,
    HOLDS_ROWS,
    HOLDS_PICTURE,
    HOLDS_COLOURS,
    HOLDS_FOLDER,
    HOLDS_SIDECAR,
    HOLDS_SESSION,
    HOLDS_PAGE,
    HOLDS_PACK,
    HOLDS_TEXT,
};

/** The type of the option whose values a field takes: that of the field. An OPTION_BYTES says its own. */
#define OPTION_TYPE(field)                                                                                             \
    _Generic(&(field),                                                                                                 \
             bool *: OPTION_FLAG,                                                                                      \
             double *: OPTION_NUMBER,                                                                                  \
             uint32_t *: OPTION_COUNT,                                                                                 \
             double(*)[3]: OPTION_VECTOR,                                                                              \
             double(*)[2]: OPTION_RANGE,                                                                               \
             double(*)[4]: OPTION_EDGES,                                                                               \
             uint32_t(*)[2]: OPTION_SIZE,                                                                              \
             size_t *: OPTION_CHOICE,                                                                                  \
             const char **: OPTION_TEXT,                                                                               \
             struct option_list *: OPTION_LIST)
/** The two members of a row that say which field it fills, and so the type of its value. */
#define OPTION_AT(settings, member)                                                                                    \
    .type = OPTION_TYPE(((settings *)NULL)->member), .offset = offsetof(settings, member)

/** Likewise with the name, and with what stands for the value in a help. */
#define OPTION_NAMED(text, settings, member) .name = (text), OPTION_AT(settings, member)
#define OPTION_VALUED(text, settings, member, word) OPTION_NAMED(text, settings, member), .value = (word)

/** Likewise of a length or an angle. */
#define OPTION_MM(text, settings, member) OPTION_VALUED(text, settings, member, "MM"), .unit = "mm"
#define OPTION_DEGREES(text, settings, member) OPTION_VALUED(text, settings, member, "DEGREES"), .unit = "degrees"
/** --max-memory, a uint64_t. */
#define OPTION_MEMORY(settings, member)                                                                                \
    .name = "max-memory", .type = OPTION_BYTES, .offset = offsetof(settings, member), .value = "SIZE",                 \
    .unit = "bytes", .role = OPTION_KEPT
/** Of a file. */
#define OPTION_READING(content) .role = OPTION_READS, .holds = HOLDS_##content
#define OPTION_WRITING(content) .role = OPTION_WRITES, .holds = HOLDS_##content

/** The range of a row's numbers, with both ends, with none, or with the upper one. */
#define OPTION_FROM_TO(least, most) .low = (least), .high = (most)
#define OPTION_BETWEEN(below, above) .low = (below), .high = (above), .open = true
#define OPTION_ABOVE_TO(below, most) .low = (below), .high = (most), .open_below = true

/** Two depths along an axis, mm, of which the far one may be at a target. */
struct depth_range {
    double ends[2]; /**< [1] is 0 where that is at the target. */
    double beyond;  /**< So far behind it, mm. */
    bool to_target;
};

/** Limits and marks of an option. */
enum option_flags {
    OPTION_OF_CONE = 1 << 0,      /**< Means nothing beside --point. */
    OPTION_OF_RAYS = 1 << 1,      /**< Likewise, nor where no rays are traced. */
    OPTION_OF_ONE_ATLAS = 1 << 2, /**< Excludes --atlas. */
    OPTION_OF_ONE_POSE = 1 << 3,
    OPTION_IS_PICTURE = 1 << 4, /**< A file that holds the command line, so its bytes are not compared. */
    OPTION_IS_PLACE = 1 << 5,   /**< Where the value and the next two words are numbers, it is these three. */
    OPTION_TO_TARGET = 1 << 6,  /**< OPTION_RANGE: of a struct depth_range, LOW,target[+MM] is taken, too. */
    OPTION_OF_REGION = 1 << 7,  /**< Lists what is in a cone or ball: of a point alone, nothing. */
};

struct option {
    const char *name; /**< Without dashes; NULL ends a table. */
    char letter;      /**< 0 if it has none. */
    enum option_type type;
    size_t offset;     /**< The field, in its group's settings. */
    const char *value; /**< Stands for the value in the help. */
    const char *help;
    const char *standard;  /**< Its value where it is not given, which is then as if it were not: option_standard(). */
    const char *hint;      /**< Ends the refusal of a value that is no number; NULL = nothing to say. */
    const char *otherwise; /**< Or in words, where that is no one value: to give any counts. */
    const char *unit;      /**< Of its numbers: "mm", "degrees", "s", "Hz", ...; NULL = they have none. */
    const char *words;     /**< Other names that people use, "save, export", for the help and for hints; may be NULL. */
    bool common;           /**< One of the command's commonest, which -h lists. */
    double low, high;      /**< Range of numbers; both 0 = any. */
    bool open;             /**< The range's ends are outside of it, */
    bool open_below;       /**< or only the low one. */
    bool required;
    enum option_role role;
    enum option_content holds; /**< Of the file that it names. */
    const char *no_file;       /**< A value that names none, alone or before keys; may be NULL. */
    unsigned flags;            /**< enum option_flags */
    const char *needs;    /**< Options without which it has no effect: one of "pose|poses", or "sampling=slices". Those
                               that the command does not have do not count. */
    const char *excludes; /**< "pose,poses": options that cannot stand beside it. */
    const char *because;  /**< Why, at the end of their refusal; may be NULL. */
    const char *endings;  /**< ".exr .png": the file's name must have one of them. */
    const char *format;   /**< The answer's format (OPTION_WRITES_ANSWER) if no ending says one. */
    enum key_kind keys;   /**< Of an output that may have one behind its name: option_key() gives its value; or 0. */
    const char *const *choices;             /**< NULL-terminated, or: */
    const char *(*choice_at)(size_t index); /**< NULL past the last. */
    const char *advice;                     /**< Ends the refusal of what is none of them: "; it ..."; may be NULL. */
};

struct option_group {
    const char *title; /**< NULL ends a list of groups. */
    const struct option *options;
    size_t offset; /**< The group's settings, in the command's. */
};

/** OPTION_LIMIT: options of a command, with --help and --version; a name of one is shorter, too. */
enum { OPTION_LIMIT = 128, OPERAND_LIMIT = 2 };

/** An option as it was given. */
struct option_use {
    const struct option *option;
    const char *value; /**< NULL of a flag; without the key behind a file. */
    const char *key;   /**< That key's own value; NULL if it was not given. */
    const char *key_name;
    char *file; /**< The value, where a key was cut off it, or it is of several words; options_finish() frees it. */
};

/** The words of a command line, by their meaning. */
struct arguments {
    const struct command *command;
    const struct command *const *family; /**< The program's commands, up to NULL; NULL = only this one. */
    const char *operands[OPERAND_LIMIT];
    size_t operand_count;
    struct option_list more;     /**< Operands behind those, of a command that repeats the last one. */
    bool given[OPTION_LIMIT];    /**< Whether the command's n-th option was. */
    bool restated[OPTION_LIMIT]; /**< Whether it was with its default, and is not given. */
    struct option_use *uses;     /**< [use_count] In their order. */
    size_t use_count;
    bool is_brief; /**< Help was asked for by -h. */
    int count;     /**< The whole command line, for the provenance. */
    char **words;
};

struct command {
    const char *program; /**< That has it; NULL = conus. */
    const char *name;
    const char *summary;                      /**< One line, no final period. */
    const char *operands[OPERAND_LIMIT];      /**< "ATLAS"; NULL where there are fewer. */
    enum option_content holds[OPERAND_LIMIT]; /**< Of the files that they name. */
    const char *words;                        /**< Other names of the last one, "lesion, mask", for hints; or NULL. */
    bool optional;                            /**< The operands may be missing. */
    bool optional_last;                       /**< The last one may. */
    bool answers;                             /**< Its results can be verified: asked again by the command line. */
    bool repeats;                             /**< The last operand may stand any number of times. */
    bool resumes;                      /**< What is not given may be as it was left: to give a standard value counts. */
    const char *form;                  /**< Text that must follow the operands; may be NULL. */
    const char *description;           /**< Paragraphs for --help. */
    const char *examples;              /**< Lines for --help; -h shows the first two. */
    const char *see_also;              /**< Lines for --help about other commands; may be NULL. */
    const char *of_one;                /**< Of a command without operands: "conus info", that of one; may be NULL. */
    const struct option_group *groups; /**< Ends with a NULL title. */
    size_t settings_size;              /**< Bytes of the settings that @p run gets, zeroed before parsing. */
    void (*more_help)(FILE *out);      /**< Ends --help; may be NULL. */
    int (*run)(const void *settings, const struct arguments *arguments); /**< Gives the exit code. */
    int (*hand_over)(char **words); /**< Becomes the program that has this command, with its own options. Gives the
                                         exit code where that fails, -1 where there is none: it is run here then. */
};

/** Fills @p settings (zeroed, command->settings_size bytes) and @p out from words[first..count). @p family, which may
 * be NULL, are the program's commands, up to NULL: a message names the one that has an unknown option. Returns -1, or
 * the exit code where that ends the program: a mistake (said on stderr) or --help and --version (answered on stdout).
 * settings and @p out are the caller's to options_finish() in every case. */
int options_parse(struct arguments *out, void *settings, const struct command *command,
                  const struct command *const *family, int count, char **words, int first);
void options_finish(void *settings, struct arguments *arguments);

/** Whether the option @p name of the command was on the command line. */
bool option_given(const struct arguments *arguments, const char *name);

/** Whether it was there with its default, which is as if it were not. */
bool option_restated(const struct arguments *arguments, const char *name);
/** Prints a warning if it was: the option @p other, which is given, leaves it without effect. */
void option_warn_restated(const struct arguments *arguments, const char *name, const char *other);

/** The last value of the option @p name; NULL if it was not given. */
const char *option_text(const struct arguments *arguments, const char *name);

/** The value of the key behind the file of the option @p name; NULL if none was given. */
const char *option_key(const struct arguments *arguments, const char *name);

/** The number that it is, which its table has checked; @p otherwise if none was given. */
double option_key_number(const struct arguments *arguments, const char *name, double otherwise);

/** The option of this name; NULL if the command has none. */
const struct option *option_find(const struct command *command, const char *name);

/** The command of @p family, up to NULL, whose operand people call @p word; NULL if there is none. */
const struct command *command_of_operand(const struct command *const *family, const char *word);

/** The command's option at @p index; NULL past the last. */
const struct option *option_at(const struct command *command, size_t index);
/** Its field in the command's settings. */
void *option_field(const struct command *command, void *settings, size_t index);

/** Whether the row of @p option says that it cannot stand beside @p other. */
bool option_excludes(const struct option *option, const struct option *other);

/** The first option that was given and has one of @p flags; NULL if there is none. */
const struct option *option_with(const struct arguments *arguments, unsigned flags);

/** The command line as a shell would take it, "conus" in front. NULL without memory; the caller frees it. */
char *arguments_text(const struct arguments *arguments);

/** Words of a command line that is made, and NULL behind them. Zeroed: none. */
struct command_words {
    char **items;
    size_t count;
    bool is_lost; /**< One of them, for want of memory. */
};

/** Adds a copy of @p value; with an option "--option=value", or without a value "--option". */
void words_put(struct command_words *words, const char *option, const char *value);
void words_finish(struct command_words *words);

/** Runs the command on the words, of which the first two are the program and its name, in @p folder. Returns the exit
 * code and prints an error unless it is 0. */
int words_run(struct command_words *words, const struct command *command, const char *folder);

/** Choice @p index of an option, NULL past the last. */
const char *option_choice(const struct option *option, size_t index);

/** What the option is where it is not given, as it would be given: the first choice where its row says nothing else.
 * To give it is to give nothing: the field is zero, option_given() is false. NULL = there is no such value. */
const char *option_standard(const struct option *option);

/** Whether @p text, which the option takes, says that value; the @p field is zero then. */
bool option_is_standard(const struct option *option, const char *text, void *field);

/** Reads @p text into the option's field at @p field. Prints an error and returns false when it is not what is allowed.
 */
bool option_read(const struct option *option, void *field, const char *text);

/** The whole of @p text as a finite decimal number, whatever the locale; no hexadecimal, no spaces. */
bool number_parse(const char *text, double *out);
/** The whole of @p text as up to @p limit such numbers with @p separator between them: how many; 0 if it is anything
 * else. */
size_t numbers_parse(double *out, size_t limit, const char *text, char separator);
/** The whole of @p text as a decimal whole number up to @p limit. */
bool count_parse(const char *text, uint64_t limit, uint64_t *out);

/** Whether the value of an option that reads a file names one. */
bool option_names_file(const struct option *option, const char *value);

/** Cuts the @p text FILE,key=value of an option, which then is FILE. Prints an error and returns false where it is
 * none; @p text NULL: there is no memory. */
bool option_cut_keys(struct source_keys *out, const char *option, char *text, enum key_kind kind);

enum { OPTION_HELP = 2048 };

/** What an option is, on one line, and what it is where it is not given; with @p choices those, and other words. */
void option_describe(char out[OPTION_HELP], const struct option *option, bool choices);

/** --help of one command. */
void help_command(FILE *out, const struct command *command);
/** -h of one command: what it does, its commonest options and two examples, on at most 20 lines. */
void help_brief(FILE *out, const struct command *command);
/** One line that shows a command's form: "conus query ATLAS [options]". */
void help_usage(FILE *out, const struct command *command);

/** The meaning of exit code @p code, in a few words; NULL past the last. */
const char *help_exit_code(size_t code);

/* Tables of text that fit a terminal, and what a terminal can show. */

/** Fits the tables in @p text, UTF-8 with a final NUL, into @p width columns (0 = as wide as they are), and with
 * @p bold writes their headers so. Lines between them stay as they are. Where columns are left out, a last line names
 * those of the first such table, and says @p whole: "--format tsv has all". A table is lines with two gaps of two
 * spaces or more in their first, the header; its columns end where the words of the header end. NULL without memory;
 * the caller frees it. */
char *table_fit(const char *text, size_t width, bool bold, const char *whole);

/** Columns of the terminal at @p descriptor: as it says, else $COLUMNS; 0 where it is no terminal or nothing says. */
size_t terminal_width(int descriptor);

/** Whether @p descriptor is a terminal that shows bold and colours: neither $NO_COLOR nor TERM=dumb forbids them. */
bool terminal_has_colour(int descriptor);

/** conus_selector_options: numbers of the question, a web page's, too. */
extern const struct option ray_options[];

/* Angles from LOW to HIGH in steps, as --angles has them; in whatever unit. */

enum { ANGLE_LIMIT = 1000 };

/** How many there are: LOW, LOW + STEP and so on up to HIGH, which counts even if rounding puts it a little beyond.
 * 0 unless HIGH is from LOW on and STEP above 0; ANGLE_LIMIT + 1 for more than that many. */
size_t angles_count(const double range[3]);
/** The angle at @p index. */
double angles_at(const double range[3], size_t index);

#endif
