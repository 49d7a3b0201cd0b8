/* SPDX-License-Identifier: BSD-3-Clause */
/* FILE,key=value of any kind, the first byte, from any bytes: the file and the values lie in the text, numbers are
 * finite, and what is put together again is no longer than the text. */
#include "sources/names.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void check(bool is_so)
{
    if (!is_so) {
        abort();
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    enum { KINDS = 19 };
    char *text = calloc(size + 1, 1);
    char *cut = calloc(size + 1, 1);
    char *kept = calloc(size + 1, 1);
    struct source_keys keys;
    if (text && cut && kept && size > 1) {
        const enum key_kind kind = (enum key_kind)(1U << (data[0] + 256U - '0') % KINDS);
        memcpy(text, data + 1, size - 1);
        memcpy(cut, text, size);
        bool is_fine = keys_read(&keys, text, kind);
        check(is_fine == !keys.why[0] && keys.length <= strlen(text));
        check(keys_cut(&keys, cut, kind) == is_fine);
        check(is_fine ? strlen(cut) == keys.length && keys_file_length(text, kind) == keys.length : !strcmp(cut, text));
        for (size_t i = 0; is_fine && i < keys.count; i++) {
            const struct key_value *value = &keys.values[i];
            check(value->text.data >= cut && value->text.data + value->text.size <= cut + strlen(text));
            for (size_t k = 0; k < value->count; k++) {
                check(isfinite(value->numbers[k]));
            }
        }
        if (is_fine && kind != KEYS_STREAMLINES && kind != KEYS_TRANSFORM && kind != KEYS_ENTRIES &&
            kind != KEYS_REACH) { /* which have flags */
            keys_keep(kept, cut, &keys, kind);
            check(!strcmp(kept, text));
        }
        (void)keys_read_alone(&keys, text, kind);
    }
    free(text);
    free(cut);
    free(kept);
    return 0;
}
