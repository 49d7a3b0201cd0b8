/* SPDX-License-Identifier: BSD-3-Clause */
/* What separates the cells of any bytes, and these: no cell lies outside of its line, all are there that the decision
 * counted, and what is a number by the decision is one again. */
#include "base/formats/table.h"

#include <stdlib.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void check(bool fine)
{
    if (!fine) {
        abort();
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct text head = {(const char *)data, size < TABLE_HEAD ? size : TABLE_HEAD};
    struct table table = {.quotes_are_plain = size % 5 == 0};
    struct text text;
    struct text inside;
    size_t rows = 0;
    table_decide(&table, head);
    check(table.separator < TABLE_SEPARATORS && table.cells <= TABLE_CELLS && !table.cells == !table.first);
    for (size_t number = 1; text_line(&head, &text); number++) {
        struct table_line line;
        if (!table_split(&line, &table, text)) {
            continue;
        }
        check(line.given <= line.count && line.count <= TABLE_CELLS);
        for (size_t i = 0; i < line.count; i++) {
            struct text cell = line.cells[i];
            double value;
            check(!cell.size || (cell.data >= text.data && cell.data + cell.size <= text.data + text.size));
            check(!table_number(&value, &table, cell) || cell.size);
        }
        bool is_row = !table_is_comment(&inside, text) && !table_is_blank(text) && line.count == table.cells &&
                      table_numbers(&line) >= 3;
        check(!is_row || (table.first && table.first <= number));
        rows += is_row;
    }
    check(!table.cells == !rows);
    return 0;
}
