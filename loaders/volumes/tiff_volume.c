/* SPDX-License-Identifier: BSD-3-Clause */
/* Joins the pages of a TIFF stack with its place in the world. */
#include "loaders/volumes/tiff_volume.h"

#include "atlas/space.h"

#include <stdio.h>
#include <string.h>

conus_status tiff_volume_place(struct brainglobe_metadata *out, const char *path,
                               const struct brainglobe_metadata *stated, struct file_sums *read)
{
    bool found = false;
    bool whole = stated->orientation[0] && stated->resolution[0] > 0;
    struct brainglobe_metadata place = {0};
    conus_status status = whole ? CONUS_OK : brainglobe_metadata_read(&place, &found, path, read);
    if (stated->orientation[0]) {
        memcpy(place.orientation, stated->orientation, sizeof place.orientation);
    }
    if (stated->resolution[0] > 0) {
        memcpy(place.resolution, stated->resolution, sizeof place.resolution);
    }
    bool sized = place.resolution[0] > 0;
    if (!status && (!sized || !place.orientation[0])) {
        const char *missing = sized                  ? "no orientation"
                              : place.orientation[0] ? "no resolution"
                                                     : "no resolution and no orientation";
        status = fail(CONUS_ERROR_DATA,
                      "a TIFF stack does not say where it lies: %s %s beside it; give FILE,resolution=25,"
                      "orientation=asr (micrometres; where page, row and column start)",
                      missing, found ? "in metadata.json" : "is given, and there is no metadata.json");
    }
    if (!status) {
        *out = place;
    }
    return status;
}

static int datatype_of(const struct tiff_page *page)
{
    static const int types[][3] = {
        {VOLUME_UINT8, VOLUME_INT8, 0},
        {VOLUME_UINT16, VOLUME_INT16, 0},
        {VOLUME_UINT32, VOLUME_INT32, VOLUME_FLOAT32},
        {VOLUME_UINT64, VOLUME_INT64, VOLUME_FLOAT64},
    };
    int row = page->bits == 8 ? 0 : page->bits == 16 ? 1 : page->bits == 32 ? 2 : 3;
    return types[row][page->format - TIFF_UNSIGNED];
}

static conus_status check_shape(const struct volume_header *header, const uint64_t shape[3])
{
    const size_t *dim = header->info.dim;
    return !shape[0] || (shape[0] == dim[2] && shape[1] == dim[1] && shape[2] == dim[0])
               ? CONUS_OK
               : fail(CONUS_ERROR_DATA,
                      "shape: metadata.json says %llu x %llu x %llu, the stack has %zu pages of %zu rows and %zu "
                      "columns",
                      (unsigned long long)shape[0], (unsigned long long)shape[1], (unsigned long long)shape[2], dim[2],
                      dim[1], dim[0]);
}

conus_status tiff_volume_header(struct volume_header *out, const struct tiff *tiff,
                                const struct brainglobe_metadata *place)
{
    const struct tiff_page *page = &tiff->pages[0];
    const int64_t dim[7] = {(int64_t)page->width, (int64_t)page->length, (int64_t)tiff->depth, 1, 1, 1, 1};
    double world[16];
    struct volume_header header = {
        .swapped = tiff->file.swapped, .footer = true, .offset = tiff->whole ? tiff->start : 0};
    header.info.slope = 1;
    snprintf(header.info.format, sizeof header.info.format, tiff->file.big ? "BigTIFF" : "TIFF");
    conus_status status = volume_header_set_datatype(&header, datatype_of(page));
    status = status ? status : volume_header_set_dim(&header, dim);
    status = status ? status : check_shape(&header, place->shape);
    status = status ? status : brainglobe_voxels(world, place);
    status = status ? status : space_describe(&header.info, world, "resolution and orientation");
    if (!status) {
        *out = header;
    }
    return status;
}
