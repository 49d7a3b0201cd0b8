/* SPDX-License-Identifier: BSD-3-Clause */
/* Weights of files (Eq. 30): a grid of angles, offsets or distances, and perhaps depths, linear between. */
#include "base/memory.h"
#include "base/order.h"
#include "selection/weight/weight.h"

#include <math.h>

static const double most_weight = 1e100; /* so that sums stay finite */
enum { ROW_LIMIT = 1000000 };

/* A table on the way. */
struct row {
    double z, x, weight;
};

struct rows {
    struct row *at;
    size_t count, capacity;
    size_t column; /* of x */
    bool has_depth;
};

enum { ANGLE, OFFSET, DISTANCE, DEPTH, WEIGHT, COLUMNS };
static const char *const columns[COLUMNS] = {"angle_deg", "offset_mm", "distance_mm", "depth_mm", "weight"};

/* The one column that says where across the axis a row is; COLUMNS where there is none, or several. */
static size_t find_column(const struct named_cells *cells)
{
    size_t found = COLUMNS;
    size_t count = 0;
    for (size_t i = ANGLE; i <= DISTANCE; i++) {
        found = named_cells_has(cells, i) ? i : found;
        count += named_cells_has(cells, i);
    }
    return count == 1 && named_cells_has(cells, WEIGHT) ? found : COLUMNS;
}

static void take_row(struct job *job, const struct named_cells *cells, void *user)
{
    struct rows *rows = user;
    struct row row = {0};
    rows->column = find_column(cells);
    rows->has_depth = named_cells_has(cells, DEPTH);
    if (rows->column == COLUMNS) {
        job_bad(job, "columns angle_deg, offset_mm or distance_mm, and weight, are needed");
        return;
    }
    if (rows->column == DISTANCE && rows->has_depth) {
        job_bad(job, "distance_mm is from a ball's centre, which has no axis and no depth_mm");
    }
    named_cells_numbers(job, &row.x, cells, rows->column, 1);
    named_cells_numbers(job, &row.weight, cells, WEIGHT, 1);
    if (rows->has_depth) {
        named_cells_numbers(job, &row.z, cells, DEPTH, 1);
    }
    if (!(row.weight >= 0 && row.weight <= most_weight)) {
        job_bad(job, "weight: %g is out of range, allowed is 0 to %g", row.weight, most_weight);
    }
    if (!(row.x >= 0 && (rows->column != ANGLE || row.x < 90))) {
        job_fail(job, CONUS_ERROR_ARGUMENT, "%s: %g is out of range, allowed is 0 %s", columns[rows->column], row.x,
                 rows->column == ANGLE ? "to less than 90" : "or more");
    }
    if (!(row.z >= 0)) {
        job_fail(job, CONUS_ERROR_ARGUMENT, "depth_mm: %g is out of range, allowed is 0 or more", row.z);
    }
    if (rows->count == ROW_LIMIT) {
        job_bad(job, "more than %d rows", ROW_LIMIT);
    }
    bool has_room = job_ok(job) && memory_reserve(&rows->at, &rows->capacity, rows->count + 1, sizeof *rows->at);
    if (job_need(job, has_room ? rows->at : NULL)) {
        rows->at[rows->count++] = row;
    }
}

static int by_place(const void *a, const void *b)
{
    const struct row *p = a;
    const struct row *q = b;
    return p->z != q->z ? (p->z > q->z) - (p->z < q->z) : (p->x > q->x) - (p->x < q->x);
}

/* The place in the table of the last of count ascending numbers that is not above x, at most the last but one. */
static size_t weight_place(const double *at, size_t count, double x)
{
    size_t low = 0;
    size_t high = count - 1;
    const double part = (x - at[0]) / (at[high] - at[0]);
    const size_t guess = part > 0 && part < 1 ? (size_t)(part * (double)high) : 0; /* of equal steps */
    if (guess < high && at[guess] < x && x <= at[guess + 1]) {
        return guess;
    }
    while (high - low > 1) {
        size_t middle = low + (high - low) / 2;
        *(at[middle] < x ? &low : &high) = middle;
    }
    return low;
}

/* How far x is from the place to the next, 0 to 1; 0 where there is one place only. */
static double part_of(const double *at, size_t count, size_t place, double x)
{
    return count > 1 ? fmax((x - at[place]) / (at[place + 1] - at[place]), 0) : 0;
}

/* Bilinear; below the first angle, offset or distance as there, behind the last and at other depths 0. */
static double by_table(const conus_weight *weight, double x, double z)
{
    const size_t count = weight->counts[0];
    const size_t depths = weight->counts[1];
    const double *depth = weight->at + count;
    if (x > weight->at[count - 1] || (depths > 1 && !(z >= depth[0] && z <= depth[depths - 1]))) {
        return 0;
    }
    const size_t i = weight_place(weight->at, count, x);
    const size_t k = depths > 1 ? weight_place(depth, depths, z) : 0;
    const double s = part_of(weight->at, count, i, x);
    const double t = part_of(depth, depths, k, z);
    double sum[2] = {0};
    for (size_t d = 0; d < 1 + (depths > 1); d++) {
        const double *row = weight->values + (k + d) * count + i;
        sum[d] = row[0] + s * (row[1] - row[0]);
    }
    return sum[0] + t * (sum[1] - sum[0]);
}

/* The least difference of ascending numbers; infinite where there is one only. */
static double least_step(const double *at, size_t count)
{
    double least = INFINITY;
    for (size_t i = 1; i < count; i++) {
        least = fmin(least, at[i] - at[i - 1]);
    }
    return least;
}

/* Each angle, offset or distance at each depth, once. */
static conus_status check_grid(const struct rows *rows, size_t count, const char *path)
{
    const char *name = columns[rows->column];
    char depth[64] = "";
    for (size_t i = 1; i < rows->count; i++) {
        const struct row *row = &rows->at[i];
        if (by_place(row - 1, row) == 0) {
            (void)snprintf(depth, sizeof depth, rows->has_depth ? " at depth_mm %g" : "", row->z);
            return fail(CONUS_ERROR_DATA, "%s: %s %g is there twice%s", path, name, row->x, depth);
        }
        const struct row *above = i >= count ? row - count : NULL;
        const bool is_place = i % count ? row->z == row[-1].z : row->z != row[-1].z;
        if (!is_place || (above && above->x != row->x)) {
            return fail(CONUS_ERROR_DATA,
                        "%s: depth_mm %g has another set of %s than depth_mm %g; each combination is needed once", path,
                        is_place || i % count ? row->z : row[-1].z, name, rows->at[0].z);
        }
    }
    return rows->count % count == 0
               ? CONUS_OK
               : fail(CONUS_ERROR_DATA, "%s: depth_mm %g lacks some %s; each combination is needed", path,
                      rows->at[rows->count - 1].z, name);
}

/* How many rows the first depth has. */
static size_t count_first(const struct rows *rows)
{
    size_t count = 0;
    while (count < rows->count && rows->at[count].z == rows->at[0].z) {
        count++;
    }
    return count;
}

static conus_status fill(conus_weight *out, const struct rows *rows, size_t count)
{
    const size_t depths = rows->count / count;
    out->at = memory_raw(count + depths, sizeof *out->at);
    out->values = memory_raw(rows->count, sizeof *out->values);
    if (!out->at || !out->values) {
        return CONUS_ERROR_MEMORY;
    }
    for (size_t i = 0; i < rows->count; i++) {
        out->at[i < count ? i : count] = rows->at[i].x;
        out->values[i] = rows->at[i].weight;
    }
    for (size_t k = 0; k < depths; k++) {
        out->at[count + k] = rows->at[k * count].z;
    }
    out->counts[0] = count;
    out->counts[1] = depths;
    out->finest[0] = least_step(out->at, count);
    out->finest[1] = least_step(out->at + count, depths);
    out->value = by_table;
    const double last = out->at[count - 1];
    out->facts.form = "table";
    out->facts.rows = rows->count;
    out->facts.by = (enum weight_by[]){WEIGHT_BY_ANGLE, WEIGHT_BY_OFFSET, WEIGHT_BY_DISTANCE}[rows->column];
    out->facts.by_depth = rows->has_depth;
    out->facts.own = rows->column == ANGLE ? 2 * last : last;
    out->facts.depth[0] = rows->has_depth ? out->at[count] : 0;
    out->facts.depth[1] = rows->has_depth ? out->at[count + depths - 1] : 0;
    return CONUS_OK;
}

static conus_status check_rows(const struct rows *rows, size_t count, const char *path)
{
    if (rows->count < 2) {
        return fail(CONUS_ERROR_DATA, "%s: %zu rows, at least two are needed", path, rows->count);
    }
    if (rows->has_depth && count == rows->count) {
        return fail(CONUS_ERROR_ARGUMENT, "%s: one depth_mm, %g; at least two are needed, or no such column", path,
                    rows->at[0].z);
    }
    conus_status status = check_grid(rows, count, path);
    return status || count > 1
               ? status
               : fail(CONUS_ERROR_DATA, "%s: one %s, at least two are needed", path, columns[rows->column]);
}

conus_status weight_read_table(conus_weight *out, const char *path)
{
    struct rows rows = {0};
    conus_status status = rows_read(path, columns, COLUMNS, take_row, &rows, out->facts.unit);
    if (!status) {
        order_sort(rows.at, rows.count, sizeof *rows.at, by_place);
        const size_t count = count_first(&rows);
        status = check_rows(&rows, count, path);
        status = status ? status : fill(out, &rows, count);
    }
    memory_free(rows.at);
    return status;
}
