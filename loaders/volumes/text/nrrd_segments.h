/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The segments of 3D Slicer in an NRRD header: Segment0_Name:=..., _LabelValue, _Layer, _Color. */
#ifndef CONUS_LOADERS_VOLUMES_TEXT_NRRD_SEGMENTS_H
#define CONUS_LOADERS_VOLUMES_TEXT_NRRD_SEGMENTS_H

#include "base/text.h"
#include "loaders/volumes/text/text_volume.h"

enum nrrd_segment_field {
    NRRD_SEGMENT_NAME,
    NRRD_SEGMENT_ID,
    NRRD_SEGMENT_VALUE,
    NRRD_SEGMENT_LAYER,
    NRRD_SEGMENT_COLOUR,
    NRRD_SEGMENT_FIELDS
};

struct nrrd_segment {
    struct text fields[NRRD_SEGMENT_FIELDS]; /**< Inside the header's bytes. */
};

struct nrrd_segments {
    struct nrrd_segment *segments;
    size_t count, capacity;
};

/** Takes a line "key:=value" if it is one of a segment. */
conus_status nrrd_segments_read(struct nrrd_segments *segments, struct text key, struct text value);

/** Turns them into out->segments, whose count and interleaved are known. Segments that contradict each other or the
 * volumes are CONUS_ERROR_DATA: names would be wrong. */
conus_status nrrd_segments_take(struct text_volume *out, const struct nrrd_segments *segments);

void nrrd_segments_finish(struct nrrd_segments *segments);

#endif
