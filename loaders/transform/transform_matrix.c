/* SPDX-License-Identifier: BSD-3-Clause */
/* Matrices as text: four rows, and the MNI's three with a head. */
#include "loaders/transform/transform_formats.h"

#include "base/geometry/math3.h"

conus_status matrix_rows_parse(double out[16], struct text *rest, size_t rows, const char *what)
{
    struct text line = {0};
    size_t row = 0;
    while (row < rows && text_line(rest, &line)) {
        struct text word;
        size_t column = 0;
        line = text_trim(line);
        if (!line.size || line.data[0] == '#') {
            continue;
        }
        while (text_word(&line, &word)) {
            if (row + 1 == rows && word.size && word.data[word.size - 1] == ';') {
                word.size--;
            }
            if (!word.size) {
                continue;
            }
            if (column == 4 || !text_to_double(word, &out[4 * column + row]) || !isfinite(out[4 * column + row])) {
                return fail(CONUS_ERROR_DATA, "%s: row %zu: \"%.*s\", four finite numbers are needed", what, row + 1,
                            (int)(word.size < 40 ? word.size : 40), word.data);
            }
            column++;
        }
        if (column != 4) {
            return fail(CONUS_ERROR_DATA, "%s: row %zu: %zu numbers, four are needed", what, row + 1, column);
        }
        row++;
    }
    return row == rows ? CONUS_OK : fail(CONUS_ERROR_DATA, "%s: ends after %zu rows, %zu are needed", what, row, rows);
}

conus_status matrix_settle(double m[16], const char *what)
{
    return mat4_settle_last_row(m) ? CONUS_OK
                                   : fail(CONUS_ERROR_DATA, "%s: last row %.9g %.9g %.9g %.9g, 0 0 0 1 is needed", what,
                                          m[3], m[7], m[11], m[15]);
}

static bool is_blank_or_comment(struct text line)
{
    line = text_trim(line);
    return !line.size || line.data[0] == '#';
}

bool matrix_text_is(struct text text)
{
    struct text line;
    struct text word;
    double number;
    while (text_line(&text, &line)) {
        if (!is_blank_or_comment(line)) {
            return text_word(&line, &word) && text_to_double(word, &number);
        }
    }
    return false;
}

conus_status matrix_text_parse(double out[16], struct text text)
{
    struct text line;
    conus_status status = matrix_rows_parse(out, &text, 4, "matrix");
    while (!status && text_line(&text, &line)) {
        if (!is_blank_or_comment(line)) {
            status = fail(CONUS_ERROR_DATA, "matrix: more than four rows");
        }
    }
    return status ? status : matrix_settle(out, "matrix");
}

bool xfm_is(struct text text)
{
    return text_starts(text, "MNI Transform File");
}

conus_status xfm_parse(double out[16], struct text text)
{
    struct text line;
    bool linear = false;
    bool found = false;
    while (!found && text_line(&text, &line)) {
        line = text_trim(line);
        linear = linear || (text_starts(line, "Transform_Type") && text_mentions(line, "Linear;"));
        found = text_starts(line, "Linear_Transform");
        if (text_starts(line, "Transform_Type") && !text_mentions(line, "Linear;")) {
            return fail(CONUS_ERROR_UNSUPPORTED, "%.*s: only Linear is read", (int)(line.size < 60 ? line.size : 60),
                        line.data);
        }
    }
    if (!linear || !found) {
        return fail(CONUS_ERROR_DATA, "%s is missing", linear ? "Linear_Transform" : "Transform_Type = Linear;");
    }
    double m[16];
    mat4_identity(m);
    conus_status status = matrix_rows_parse(m, &text, 3, "Linear_Transform");
    if (!status && text_mentions(text, "Transform_Type")) {
        status = fail(CONUS_ERROR_UNSUPPORTED, "several transforms in one file, one is read");
    }
    if (!status) {
        memcpy(out, m, sizeof m);
    }
    return status;
}
