/* SPDX-License-Identifier: BSD-3-Clause */
/* Finds from trials how far off a device points, and whether posteriors are as often right as they say (Eq. 34). */
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "conus/own.h"
#include "poses/rows/pose_row.h"
#include "selection/selection.h"
#include "selection/study/study.h"

#include <math.h>
#include <string.h>

enum { LEAST_TRIALS = 5 };

/* What was found of the errors of pointing. */
struct parameter {
    struct table_object object; /* none */
    const char *name;
    double value, low, high, p;
    uint64_t trials;
};

static const struct table_field parameter_columns[] = {
    {"parameter", NULL,
     "bias_x, bias_y: how far the axis points to the device's right and up of what was aimed at; sigma: standard "
     "deviation about each of two axes, sigma_x, sigma_y: about each; kurtosis: 8 of normal errors; isotropy: 0 of "
     "errors that are alike in all directions (Eq. 34)",
     TABLE_OF(TEXT, struct parameter, name)},
    {"value", NULL, "its value; degrees, but of kurtosis and isotropy", TABLE_OF(NUMBER, struct parameter, value)},
    {"low", NULL, "low end of its interval of 95 %", TABLE_OF(NUMBER, struct parameter, low)},
    {"high", NULL, "high end of the same", TABLE_OF(NUMBER, struct parameter, high)},
    {"p", NULL, "of normal errors, or of isotropic ones, the part that has such a value or one farther off",
     TABLE_OF(NUMBER, struct parameter, p)},
    {"n", NULL, "trials", TABLE_OF(LARGE_COUNT, struct parameter, trials)},
};

const struct table_fields calibration_fields = {parameter_columns,
                                                sizeof parameter_columns / sizeof *parameter_columns};

/* How far the axis of a pose points from its aim, to the right and up, degrees. */
static conus_status find_error(double out[2], const conus_trial *trial, size_t number)
{
    conus_pose pose;
    double way[3];
    double along[3];
    conus_status status = pose_settle(&pose, trial->pose.world_from_device);
    if (status) {
        return status;
    }
    const double *m = pose.world_from_device;
    vec3_sub(way, trial->aim, m + 12);
    for (int a = 0; a < 3; a++) {
        along[a] = vec3_dot(way, m + 4 * a);
    }
    const double across = hypot(along[0], along[1]);
    if (!vec3_is_finite(way) || !(vec3_length(way) > 0) || along[2] >= 0) {
        return fail(CONUS_ERROR_DATA,
                    "trial %zu: %s: are the columns aim_x, aim_y and aim_z in the space of the poses?", number,
                    !vec3_is_finite(way)   ? "no point that was aimed at"
                    : vec3_length(way) > 0 ? "the device points 90 degrees or more away from what was aimed at"
                                           : "the device is where it was aimed at");
    }
    const double degrees = degrees_from_radians(atan2(across, -along[2]));
    for (int a = 0; a < 2; a++) {
        out[a] = across > 0 ? -degrees * along[a] / across : 0;
    }
    return CONUS_OK;
}

/* Sums over errors. */
struct moments {
    size_t count;
    double mean[2];
    double products[3]; /* Σ of xx, xy, yy about the mean */
    double fourth;      /* mean of the squared distances, squared; NaN where the errors lie on a line */
};

static struct moments sum_up(double (*errors)[2], size_t count)
{
    struct moments made = {.count = count};
    const double n = (double)count;
    for (size_t i = 0; i < count; i++) {
        made.mean[0] += errors[i][0] / n;
        made.mean[1] += errors[i][1] / n;
    }
    for (size_t i = 0; i < count; i++) {
        const double x = errors[i][0] - made.mean[0];
        const double y = errors[i][1] - made.mean[1];
        made.products[0] += x * x;
        made.products[1] += x * y;
        made.products[2] += y * y;
    }
    const double xx = made.products[0] / n;
    const double xy = made.products[1] / n;
    const double yy = made.products[2] / n;
    const double area = xx * yy - xy * xy;
    const double size = (xx + yy) / 2;
    for (size_t i = 0; i < count; i++) {
        const double x = errors[i][0] - made.mean[0];
        const double y = errors[i][1] - made.mean[1];
        const double q = (yy * x * x - 2 * xy * x * y + xx * y * y) / area;
        made.fourth += area > 1e-12 * size * size ? q * q / n : NAN;
    }
    return made;
}

/* A standard deviation by a sum of squares, with its limits. */
static struct parameter deviation(const char *name, double squares, size_t degrees, size_t trials)
{
    return (struct parameter){.name = name,
                              .value = sqrt(squares / (double)degrees),
                              .low = sqrt(squares / quantile_chi_squared(0.975, degrees)),
                              .high = sqrt(squares / quantile_chi_squared(0.025, degrees)),
                              .p = NAN,
                              .trials = trials};
}

static struct parameter bias(const char *name, double mean, double sigma, size_t trials)
{
    const double half = quantile_t(0.975, 2 * (trials - 1)) * sigma / sqrt((double)trials);
    return (struct parameter){
        .name = name, .value = mean, .low = mean - half, .high = mean + half, .p = NAN, .trials = trials};
}

enum { PARAMETERS = 7 };

static void find_parameters(struct parameter out[PARAMETERS], const struct moments *m)
{
    const size_t n = m->count;
    const double trials = (double)n;
    const double *s = m->products;
    const double z = (m->fourth - 8) * sqrt(trials) / 8;
    const double mean = (s[0] + s[2]) / 2;
    const bool is_flat = isnan(m->fourth);
    const double isotropy = is_flat ? NAN : -trials * log((s[0] * s[2] - s[1] * s[1]) / (mean * mean));
    const struct parameter sigma = deviation("sigma", s[0] + s[2], 2 * (n - 1), n);
    const struct parameter rows[PARAMETERS] = {
        bias("bias_x", m->mean[0], sigma.value, n),
        bias("bias_y", m->mean[1], sigma.value, n),
        sigma,
        deviation("sigma_x", s[0], n - 1, n),
        deviation("sigma_y", s[2], n - 1, n),
        {.name = "kurtosis", .value = m->fourth, .low = NAN, .high = NAN, .p = erfc(fabs(z) / sqrt(2)), .trials = n},
        {.name = "isotropy", .value = isotropy, .low = NAN, .high = NAN, .p = exp(-isotropy / 2), .trials = n},
    };
    memcpy(out, rows, sizeof rows);
}

static conus_status check_count(size_t count)
{
    return count >= LEAST_TRIALS ? CONUS_OK
                                 : fail(CONUS_ERROR_DATA, "%zu trials, at least %d are needed", count, LEAST_TRIALS);
}

conus_status conus_calibrate(conus_table **out, const conus_trial *trials, size_t count)
{
    conus_frame world = {.space = CONUS_SPACE_RAS};
    struct parameter rows[PARAMETERS];
    double(*errors)[2] = memory_raw(count, sizeof *errors);
    conus_status status = errors ? check_count(count) : CONUS_ERROR_MEMORY;
    for (size_t i = 0; i < count && !status; i++) {
        status = find_error(errors[i], &trials[i], i + 1);
    }
    const struct moments moments = status ? (struct moments){0} : sum_up(errors, count);
    memory_free(errors);
    if (!status && !(moments.products[0] + moments.products[2] > 1e-18 * (double)count)) {
        status = fail(CONUS_ERROR_DATA, "all %zu trials are off alike: no spread can be found", count);
    }
    if (status) {
        return status;
    }
    find_parameters(rows, &moments);
    mat4_identity(world.world_from_space);
    return table_create(out, &(struct table_source){NULL, &world}, &calibration_fields, &(struct table_question){0},
                        rows, sizeof *rows, PARAMETERS);
}

/* How often answers were right, of all trials or of those whose answer was as sure as a bin says. */
struct reliability {
    struct table_object object; /* none */
    const char *kind;           /* "all", "bin" */
    double low, high;
    uint64_t trials;
    double said, right, right_low, right_high, log_loss, power;
};

static const struct table_field reliability_columns[] = {
    {"kind", NULL, "all: of all trials; bin: of those whose largest posterior is from low to below high (Eq. 34)",
     TABLE_OF(TEXT, struct reliability, kind)},
    {"low", NULL, "least of the largest posteriors", TABLE_OF(NUMBER, struct reliability, low)},
    {"high", NULL, "upper end of the same; 1 is in the last bin", TABLE_OF(NUMBER, struct reliability, high)},
    {"n", NULL, "trials", TABLE_OF(LARGE_COUNT, struct reliability, trials)},
    {"said", NULL, "mean of the largest posterior; 0 of a trial that hits no area",
     TABLE_OF(NUMBER, struct reliability, said)},
    {"right", NULL, "part of the trials whose largest posterior is that of what was meant",
     TABLE_OF(NUMBER, struct reliability, right)},
    {"right_low", NULL, "low end of its interval of 95 % (Wilson)", TABLE_OF(NUMBER, struct reliability, right_low)},
    {"right_high", NULL, "high end of the same", TABLE_OF(NUMBER, struct reliability, right_high)},
    {"log_loss", NULL, "mean of -ln P of what was meant, P at least 0.0001",
     TABLE_OF(NUMBER, struct reliability, log_loss)},
    {"power", NULL, "exponent of likelihoods, 0.25 to 8, with the least log_loss: power of --prior",
     TABLE_OF(NUMBER, struct reliability, power)},
};

const struct table_fields reliability_fields = {reliability_columns,
                                                sizeof reliability_columns / sizeof *reliability_columns};

/* The posteriors of all trials, one trial behind the other. */
struct answers {
    double *chances;
    size_t chance_count, capacity;
    struct answer {
        size_t first, count;
        size_t meant; /* among its chances; SIZE_MAX: it is not there */
        double largest;
        bool is_right;
    } * at;
    size_t count;
};

static const double LEAST_CHANCE = 1e-4;

static conus_status take_answer(struct answers *to, const conus_selection *selection, uint32_t meant)
{
    const struct statistics *found = &selection->statistics;
    struct answer answer = {.first = to->chance_count, .meant = SIZE_MAX};
    if (!memory_reserve(&to->chances, &to->capacity, to->chance_count + found->count + 1, sizeof *to->chances)) {
        return CONUS_ERROR_MEMORY;
    }
    for (size_t i = 0; i < found->count; i++) {
        const conus_result *result = &found->results[i];
        if (!(result->object && result->posterior > 0)) {
            continue;
        }
        const bool is_meant = result->object == meant;
        const bool is_larger = result->posterior > answer.largest; /* of equal ones the first */
        answer.is_right = is_larger ? is_meant : answer.is_right;
        answer.largest = is_larger ? result->posterior : answer.largest;
        answer.meant = is_meant ? answer.count : answer.meant;
        to->chances[to->chance_count++] = result->posterior;
        answer.count++;
    }
    to->at[to->count++] = answer;
    return CONUS_OK;
}

/* Mean log loss with likelihoods raised to the power of `times` theirs. */
static double log_loss(const struct answers *answers, double times)
{
    double sum = 0;
    for (size_t i = 0; i < answers->count; i++) {
        const struct answer *answer = &answers->at[i];
        const double *chances = answers->chances + answer->first;
        double all = 0;
        double meant = 0;
        for (size_t k = 0; k < answer->count; k++) {
            const double chance = pow(chances[k] / answer->largest, times);
            meant = k == answer->meant ? chance : meant;
            all += chance;
        }
        sum -= log(fmax(all > 0 ? meant / all : 0, LEAST_CHANCE));
    }
    return sum / (double)answers->count;
}

/* The power of least log loss, by golden section on its logarithm; of equal ones the smallest. `power` is that of the
 * chances. */
static double best_power(const struct answers *answers, double power)
{
    const double golden = (sqrt(5) - 1) / 2;
    double low = log(0.25);
    double high = log(8);
    double inner[2] = {high - golden * (high - low), low + golden * (high - low)};
    double loss[2] = {log_loss(answers, exp(inner[0]) / power), log_loss(answers, exp(inner[1]) / power)};
    while (high - low > 1e-3) {
        const int kept = loss[0] <= loss[1] ? 0 : 1; /* the point that stays inside, on this side of the other */
        low = kept == 0 ? low : inner[0];
        high = kept == 0 ? inner[1] : high;
        inner[1 - kept] = inner[kept];
        loss[1 - kept] = loss[kept];
        inner[kept] = kept == 0 ? high - golden * (high - low) : low + golden * (high - low);
        loss[kept] = log_loss(answers, exp(inner[kept]) / power);
    }
    const double ends[] = {log(0.25), (low + high) / 2, log(8)};
    double best = ends[0];
    for (int i = 1; i < 3; i++) {
        best = log_loss(answers, exp(ends[i]) / power) < log_loss(answers, exp(best) / power) ? ends[i] : best;
    }
    return exp(best);
}

/* Wilson's interval of a part of n. */
static void set_interval(struct reliability *row)
{
    const double n = (double)row->trials;
    const double z2 = NORMAL_975 * NORMAL_975;
    const double middle = (row->right + z2 / (2 * n)) / (1 + z2 / n);
    const double half = NORMAL_975 * sqrt(row->right * (1 - row->right) / n + z2 / (4 * n * n)) / (1 + z2 / n);
    row->right_low = fmax(middle - half, 0);
    row->right_high = fmin(middle + half, 1);
}

/* The trials from low to below high, or to 1. */
static struct reliability count_up(const struct answers *answers, const char *kind, double low, double high)
{
    struct reliability row = {
        .kind = kind, .low = low, .high = high, .right_low = NAN, .right_high = NAN, .log_loss = NAN, .power = NAN};
    for (size_t i = 0; i < answers->count; i++) {
        const struct answer *answer = &answers->at[i];
        if (answer->largest >= low && (answer->largest < high || high == 1)) {
            row.trials++;
            row.said += answer->largest;
            row.right += answer->is_right;
        }
    }
    row.said /= (double)row.trials;
    row.right /= (double)row.trials;
    if (row.trials) {
        set_interval(&row);
    }
    return row;
}

static conus_status answer_trial(struct answers *to, conus_selector *selector, const conus_trial *trial, size_t number)
{
    conus_selection *selection = NULL;
    const uint32_t *group = level_group(selector->level);
    const uint32_t meant = group ? group[trial->meant] : trial->meant;
    if (!prior_has_row(selector->atlas, group, meant)) {
        return fail(CONUS_ERROR_DATA, "trial %zu: %.60s has no row of its own%s", number,
                    conus_atlas_object(selector->atlas, trial->meant)->name, group ? " at this level" : "");
    }
    conus_status status = conus_selector_set_range(selector, trial->range);
    status = status ? status : conus_select(&selection, selector, &trial->pose, trial->angle);
    status = status ? status : take_answer(to, selection, meant);
    conus_selection_destroy(selection);
    return status;
}

enum { BINS = 5 };

conus_status conus_reliability(conus_table **out, conus_selector *selector, const conus_trial *trials, size_t count,
                               conus_progress progress, void *user)
{
    struct answers answers = {.at = memory_raw(count, sizeof *answers.at)};
    struct reliability rows[1 + BINS];
    conus_status status = !answers.at ? CONUS_ERROR_MEMORY
                          : selector->prior.power == 0 || selector->options.radius > 0
                              ? fail(CONUS_ERROR_ARGUMENT, "the selector has no posterior of cones")
                              : check_count(count);
    for (size_t i = 0; i < count && !status; i++) {
        status = answer_trial(&answers, selector, &trials[i], i + 1);
        if (!status && progress && !progress(user, i + 1, count)) {
            status = fail(CONUS_ERROR_CANCELLED, "calibration: cancelled after %zu of %zu trials", i + 1, count);
        }
    }
    if (!status) {
        rows[0] = count_up(&answers, "all", 0, 1);
        rows[0].log_loss = log_loss(&answers, 1);
        rows[0].power = best_power(&answers, selector->prior.power);
        for (int i = 0; i < BINS; i++) {
            rows[1 + i] = count_up(&answers, "bin", i / 5.0, (i + 1) / 5.0);
        }
        status = table_create(out, &(struct table_source){selector->atlas, &selector->frame}, &reliability_fields,
                              &(struct table_question){0}, rows, sizeof *rows, 1 + BINS);
    }
    memory_free(answers.chances);
    memory_free(answers.at);
    return status;
}
