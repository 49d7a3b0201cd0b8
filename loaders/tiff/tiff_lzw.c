/* SPDX-License-Identifier: BSD-3-Clause */
/* TIFF 6.0, section 13: code 256 empties the table, 257 ends the data, and codes get wider one code early. */
#include "loaders/tiff/tiff.h"

enum { CLEAR = 256, END = 257, FIRST_FREE = 258, LEAST_BITS = 9, MOST_BITS = 12 };

/* The packed bytes as a row of bits. */
struct bits {
    const uint8_t *data;
    size_t size, at;
    uint32_t kept; /* bits that were read and not used, the last ones of it */
    unsigned count;
};

/* The next code; END where the bits end, since some writers leave it out. */
static unsigned next_code(struct bits *bits, unsigned width)
{
    while (bits->count < width) {
        if (bits->at == bits->size) {
            return END;
        }
        bits->kept = bits->kept << 8 | bits->data[bits->at++];
        bits->count += 8;
    }
    bits->count -= width;
    return bits->kept >> bits->count & ((1U << width) - 1);
}

/* Writes the string of `code`, backwards from its end. */
static void write_string(uint8_t *out, const struct tiff_lzw *lzw, unsigned code)
{
    for (size_t left = lzw->length[code]; left; left--) {
        out[left - 1] = lzw->last[code];
        code = lzw->before[code];
    }
}

/* Bits of the next code when `next` codes are taken. */
static unsigned code_width(unsigned next)
{
    unsigned width = LEAST_BITS;
    while (width < MOST_BITS && next >= (1U << width) - 1) {
        width++;
    }
    return width;
}

bool tiff_lzw_unpack(uint8_t *out, size_t size, const uint8_t *packed, size_t packed_size, struct tiff_lzw *lzw)
{
    struct bits bits = {.data = packed, .size = packed_size};
    size_t done = 0;
    unsigned next = FIRST_FREE;
    unsigned before = CLEAR; /* the code before this one; CLEAR where there is none */
    unsigned code = next_code(&bits, LEAST_BITS);
    if (code != CLEAR) { /* as all writers begin; the other bit order of the oldest shows here */
        return false;
    }
    for (unsigned byte = 0; byte < CLEAR; byte++) {
        lzw->before[byte] = 0;
        lzw->length[byte] = 1;
        lzw->first[byte] = lzw->last[byte] = (uint8_t)byte;
    }
    while ((code = next_code(&bits, code_width(next))) != END) {
        if (code == CLEAR) {
            next = FIRST_FREE;
            before = CLEAR;
            continue;
        }
        bool anew = before != CLEAR;
        if (code >= next + anew || (anew && next == TIFF_LZW_CODES)) {
            return false;
        }
        if (anew) {
            lzw->before[next] = (uint16_t)before;
            lzw->length[next] = (uint16_t)(lzw->length[before] + 1);
            lzw->last[next] = lzw->first[code == next ? before : code];
            lzw->first[next] = lzw->first[before];
            next++;
        }
        if (lzw->length[code] > size - done) {
            return false;
        }
        write_string(out + done, lzw, code);
        done += lzw->length[code];
        before = code;
    }
    return done == size;
}
