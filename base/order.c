/* SPDX-License-Identifier: BSD-3-Clause */
/* A stable sort: parts are merged through spare memory, or in place as far as there is not enough of it. */
#include "base/order.h"

#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

enum {
    FEW = 8,      /* rows that are sorted by insertion                      */
    SPARE = 4096, /* bytes that need no allocation                          */
    LARGE = 32    /* bytes of a row from which on it is dear to move it often */
};

struct sorting {
    order_compare *compare; /* or NULL */
    order_compare_by *compare_by;
    void *user;
    size_t size;
    uint8_t *spare;
    size_t room;       /* of `spare`, in rows               */
    bool are_pointers; /* whether each points to what to compare */
};

int compare_u32(const void *a, const void *b)
{
    return compare_unsigned(*(const uint32_t *)a, *(const uint32_t *)b);
}

int compare_u64(const void *a, const void *b)
{
    return compare_unsigned(*(const uint64_t *)a, *(const uint64_t *)b);
}

int compare_f64(const void *a, const void *b)
{
    return compare_double(*(const double *)a, *(const double *)b);
}

int compare_text_pointers(const void *a, const void *b)
{
    return strcmp(*(const char *const *)a, *(const char *const *)b);
}

static inline int compare_rows(const struct sorting *sorting, const void *a, const void *b)
{
    if (sorting->are_pointers) {
        a = *(const void *const *)a;
        b = *(const void *const *)b;
    }
    return sorting->compare ? sorting->compare(a, b) : sorting->compare_by(a, b, sorting->user);
}

/* The compiler copies a known number of bytes at once, others by a call. */
static inline void copy_row(void *to, const void *from, size_t size)
{
    switch (size) {
    case 4:
        memcpy(to, from, 4);
        break;
    case 8:
        memcpy(to, from, 8);
        break;
    case 16:
        memcpy(to, from, 16);
        break;
    case 24:
        memcpy(to, from, 24);
        break;
    case 32:
        memcpy(to, from, 32);
        break;
    default:
        memcpy(to, from, size);
    }
}

static void sort_few(const struct sorting *sorting, uint8_t *rows, size_t count)
{
    size_t size = sorting->size;
    for (uint8_t *row = rows + size; row < rows + count * size; row += size) {
        uint8_t *to = row;
        while (to > rows && compare_rows(sorting, to - size, row) > 0) {
            to -= size;
        }
        if (to < row) {
            copy_row(sorting->spare, row, size);
            for (uint8_t *from = row; from > to; from -= size) {
                copy_row(from, from - size, size);
            }
            copy_row(to, sorting->spare, size);
        }
    }
}

static void reverse_bytes(uint8_t *from, uint8_t *to)
{
    while (from < to) {
        uint8_t last = *--to;
        *to = *from;
        *from++ = last;
    }
}

/* Brings `right` bytes in front of the `left` ones before them. */
static void exchange(uint8_t *bytes, size_t left, size_t right)
{
    reverse_bytes(bytes, bytes + left);
    reverse_bytes(bytes + left, bytes + left + right);
    reverse_bytes(bytes, bytes + left + right);
}

/* How many of the sorted rows come before `key`; with `below` = 1, or are equal to it. */
static size_t count_before(const struct sorting *sorting, const uint8_t *rows, size_t count, const uint8_t *key,
                           int below)
{
    size_t low = 0;
    while (low < count) {
        size_t middle = low + (count - low) / 2;
        if (compare_rows(sorting, rows + middle * sorting->size, key) < below) {
            low = middle + 1;
        } else {
            count = middle;
        }
    }
    return low;
}

/* Merges `left` rows that fit into the spare memory with `right` ones behind them. */
static void merge_through(const struct sorting *sorting, uint8_t *rows, size_t left, size_t right)
{
    size_t size = sorting->size;
    const uint8_t *a = sorting->spare;
    const uint8_t *a_end = a + left * size;
    const uint8_t *b = rows + left * size;
    const uint8_t *b_end = b + right * size;
    memcpy(sorting->spare, rows, left * size);
    for (; a < a_end && b < b_end; rows += size) {
        if (compare_rows(sorting, a, b) > 0) {
            copy_row(rows, b, size);
            b += size;
        } else {
            copy_row(rows, a, size);
            a += size;
        }
    }
    memcpy(rows, a, (size_t)(a_end - a));
}

/* Merges two sorted parts. What does not fit into the spare memory is cut: at the middle row of the longer part, and at
 * its place in the other. */
static void merge(const struct sorting *sorting, uint8_t *rows, size_t left, size_t right)
{
    size_t size = sorting->size;
    uint8_t *other = rows + left * size;
    if (!left || !right || compare_rows(sorting, other - size, other) <= 0) {
        return;
    }
    if (left <= sorting->room) {
        merge_through(sorting, rows, left, right);
        return;
    }
    size_t i = left / 2;
    size_t j = right / 2;
    if (left < right) {
        i = count_before(sorting, rows, left, other + j * size, 1);
    } else {
        j = count_before(sorting, other, right, rows + i * size, 0);
    }
    exchange(rows + i * size, (left - i) * size, j * size);
    merge(sorting, rows, i, j);
    merge(sorting, rows + (i + j) * size, left - i, right - j);
}

static void sort_rows(const struct sorting *sorting, uint8_t *rows, size_t count)
{
    size_t half = count / 2;
    if (count <= (sorting->room ? FEW : 1)) {
        sort_few(sorting, rows, count);
        return;
    }
    sort_rows(sorting, rows, half);
    sort_rows(sorting, rows + half * sorting->size, count - half);
    merge(sorting, rows, half, count - half);
}

/* Sorts pointers to the rows, then moves each row once. The spare memory holds pointers, half of them again, and the
 * rows. */
static void sort_pointers(struct sorting *sorting, uint8_t *rows, size_t count)
{
    size_t size = sorting->size;
    size_t first = 0;
    const uint8_t **pointers = (const uint8_t **)(void *)sorting->spare;
    uint8_t *sorted = (uint8_t *)(pointers + count + count / 2);
    for (size_t i = 0; i < count; i++) {
        pointers[i] = rows + i * size;
    }
    sorting->size = sizeof *pointers;
    sorting->spare = (uint8_t *)(pointers + count);
    sorting->room = count / 2;
    sorting->are_pointers = true;
    sort_rows(sorting, (uint8_t *)pointers, count);
    while (first < count && pointers[first] == rows + first * size) {
        first++;
    }
    for (size_t i = first; i < count; i++) {
        memcpy(sorted + i * size, pointers[i], size);
    }
    memcpy(rows + first * size, sorted + first * size, (count - first) * size);
}

static void sort(struct sorting *sorting, void *rows, size_t count)
{
    _Alignas(max_align_t) uint8_t few[SPARE];
    size_t size = sorting->size;
    if (!size || count < 2) {
        return;
    }
    bool by_pointers = size > LARGE && count > FEW;
    size_t wanted = by_pointers ? (count + count / 2) * sizeof(void *) + count * size : count / 2 * size;
    uint8_t *more = wanted > SPARE ? malloc(wanted) : NULL;
    sorting->spare = more ? more : few;
    if (by_pointers && (more || wanted <= SPARE)) {
        sort_pointers(sorting, rows, count);
    } else {
        sorting->room = (more ? wanted : SPARE) / size;
        sort_rows(sorting, rows, count);
    }
    if (more) {
        free(more);
    }
}

void order_sort(void *rows, size_t count, size_t size, order_compare *compare)
{
    sort(&(struct sorting){.compare = compare, .size = size}, rows, count);
}

void order_sort_by(void *rows, size_t count, size_t size, order_compare_by *compare, void *user)
{
    sort(&(struct sorting){.compare_by = compare, .user = user, .size = size}, rows, count);
}

size_t u32_sort_unique(uint32_t *numbers, size_t count)
{
    size_t kept = 0;
    order_sort(numbers, count, sizeof *numbers, compare_u32);
    for (size_t i = 0; i < count; i++) {
        if (!kept || numbers[kept - 1] != numbers[i]) {
            numbers[kept++] = numbers[i];
        }
    }
    return kept;
}
