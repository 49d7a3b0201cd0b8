/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Rows beside the answers, of --segments, --clearance and --endpoints, each in a report of its own;
 * --connectivity: which areas the streamlines connect, as rows and as a table of areas. */
#ifndef CONUS_CLI_ANSWERS_ENDS_H
#define CONUS_CLI_ANSWERS_ENDS_H

#include "conus/report.h"
#include "options/provenance.h"
#include "settings/atlases.h"
#include "settings/settings.h"

struct rows_file {
    const struct rows_kind *kind;
    const char *path; /**< NULL = none. */
    double within;    /**< Clearances up to so many mm. */
    conus_format format;
    char *sidecar;          /**< Path; NULL if there is none to write. */
    conus_report **reports; /**< [count] That of the first atlas has the rows of all. */
    size_t count;
};

/* Those that return an int give the exit code and print an error unless it is 0. With no path they do nothing. */

/** Finds format and sidecar of the file @p path (none where --sidecar says so): the format by the ending, or @p format
 * where that is no file. @p out is the caller's to rows_file_finish() in any case. */
int rows_file_init(struct rows_file *out, const struct rows_kind *kind, const char *path, conus_format format,
                   const struct arguments *arguments);
void rows_file_finish(struct rows_file *file);

/** Makes the report of the next atlas. @p options has space, command and the atlas's name. */
conus_status rows_file_report(struct rows_file *file, const conus_selector *selector,
                              const conus_report_options *options);

/** Adds a row for each atlas that says why a pose has no answer. */
int rows_file_refuse(struct rows_file *file, const char *id, size_t line, const char *why);

/** Writes the sidecar and then the rows. */
int rows_file_write(const struct rows_file *file, const struct provenance *provenance);

struct ends_settings {
    const char *endpoints;
    const char *connectivity;
    double radius;
};

extern const struct option endpoints_options[];
extern const struct option connectivity_options[]; /**< --connectivity and --endpoint-radius. */

/** Whether the options fit together; prints an error if not. */
bool ends_check(const struct ends_settings *settings, const struct arguments *arguments);

/** The library's radius that these settings mean. */
double ends_radius_of(const struct ends_settings *settings, const struct arguments *arguments);

/** False with a message where no atlas has a bundle to look at. */
bool ends_check_atlases(const struct atlases *atlases);

/** The file of --connectivity, of one answer. */
struct matrix_file {
    const char *path; /**< NULL = none. */
    conus_format format;
    conus_report *report;
    const conus_table *table; /**< The report has it. */
};

/** Both files, of a query. */
struct ends {
    struct rows_file rows;
    struct matrix_file matrix;
    double radius; /**< The library's. */
};

/* Those that return an int give the exit code and print an error unless it is 0. With no path they do nothing. */

/** Finds the format. @p out is the caller's to matrix_file_finish() in any case. */
int matrix_file_init(struct matrix_file *out, const char *path);
void matrix_file_finish(struct matrix_file *file);

/** Takes the connections of query @p id. @p options has space and command. */
int matrix_file_take(struct matrix_file *file, const conus_selector *selector, const conus_report_options *options,
                     const char *id, conus_table *table);

/** Writes it, as JSON with what it rests on. */
int matrix_file_write(const struct matrix_file *file, const struct provenance *provenance);

/** Finds the formats. @p out is the caller's to ends_finish() in any case. */
int ends_init(struct ends *out, const struct ends_settings *settings, const struct arguments *arguments);
void ends_finish(struct ends *ends);

/** Adds what the streamlines of an answer of atlas @p index connect; @p options as for matrix_file_take(). */
int ends_add(struct ends *ends, size_t index, const char *id, conus_selector *selector,
             const conus_selection *selection, const conus_report_options *options);

int ends_write(const struct ends *ends, const struct provenance *provenance);

#endif
