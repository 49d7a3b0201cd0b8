/* SPDX-License-Identifier: BSD-3-Clause */
/* Formats MRtrix's tractograms: a header of text, the points as floats, NaN behind each streamline, infinity at the
 * end. */
#include "loaders/tracts/tck_write.h"

#include "base/files/folder.h"
#include "base/memory.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { HEADER_SIZE = 128, POINT = 3 * sizeof(float) };

/* Gives the header's size, with what lies between it and the points, which begin at a multiple of 4. */
static size_t format_header(char out[HEADER_SIZE], size_t count)
{
    static const char form[] = "mrtrix tracks\ndatatype: Float32LE\ncount: %010zu\nfile: . %d\nEND\n";
    int size = snprintf(out, HEADER_SIZE, form, count, 99); /* 67 bytes: of two digits, too */
    int offset = (size + 3) / 4 * 4;
    memset(out, 0, HEADER_SIZE);
    (void)snprintf(out, HEADER_SIZE, form, count, offset);
    return (size_t)offset;
}

static uint8_t *put_point(uint8_t *at, const float point[3])
{
    for (int a = 0; a < 3; a++) {
        uint32_t bits;
        memcpy(&bits, &point[a], sizeof bits);
        for (int byte = 0; byte < 4; byte++) {
            *at++ = (uint8_t)(bits >> 8 * byte);
        }
    }
    return at;
}

static void put_streamlines(uint8_t *at, const float *points, const uint64_t *first, size_t count)
{
    static const float end_of_one[3] = {NAN, NAN, NAN};
    static const float end_of_all[3] = {INFINITY, INFINITY, INFINITY};
    for (size_t i = 0; i < count; i++) {
        for (uint64_t p = first[i]; p < first[i + 1]; p++) {
            at = put_point(at, points + 3 * p);
        }
        at = put_point(at, end_of_one);
    }
    (void)put_point(at, end_of_all);
}

conus_status tck_format(struct bytes *out, const conus_streamline_list *list)
{
    const conus_streamline_list_view view = conus_streamline_list_data(list);
    char header[HEADER_SIZE];
    size_t begin = format_header(header, view.count);
    size_t lines = view.points + view.count + 1;
    float *points = memory_raw(view.points, POINT);
    uint64_t *first = memory_raw(view.count + 1, sizeof *first);
    uint8_t *data = points && first ? memory_raw(lines + (begin + POINT - 1) / POINT, POINT) : NULL;
    if (data) {
        conus_streamline_list_points(points, first, list);
        memcpy(data, header, begin);
        put_streamlines(data + begin, points, first, view.count);
        *out = (struct bytes){.data = data, .size = begin + lines * POINT};
    }
    memory_free(points);
    memory_free(first);
    return data ? CONUS_OK : CONUS_ERROR_MEMORY;
}

conus_status conus_streamline_list_write(const conus_streamline_list *list, const char *path)
{
    struct bytes file = {0};
    if (!path_ends_in(path, ".tck")) {
        return fail(CONUS_ERROR_ARGUMENT, "%s: the name of a tractogram that is written ends in .tck", path);
    }
    conus_status status = tck_format(&file, list);
    status = status ? status : file_write(path, file.data, file.size);
    bytes_finish(&file);
    return status;
}
