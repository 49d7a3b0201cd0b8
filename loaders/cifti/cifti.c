/* SPDX-License-Identifier: BSD-3-Clause */
/* Header, XML and values of a .dlabel.nii. */
#include "loaders/cifti/cifti.h"

#include "base/memory.h"
#include "loaders/cifti/cifti_xml.h"
#include "loaders/volumes/nifti.h"
#include "loaders/volumes/volume_values.h"

#include <math.h>

enum { XML_CODE = 32 }; /* nifti1.h: NIFTI_ECODE_CIFTI */

void cifti_finish(struct cifti *cifti)
{
    for (size_t i = 0; i < cifti->map_count; i++) {
        memory_free(cifti->maps[i].name);
        label_table_finish(&cifti->maps[i].table);
        notes_finish(&cifti->maps[i].notes);
    }
    for (size_t i = 0; i < cifti->model_count; i++) {
        memory_free(cifti->models[i].indices);
    }
    memory_free(cifti->maps);
    memory_free(cifti->models);
    *cifti = (struct cifti){0};
}

bool cifti_is(const uint8_t *data, size_t size)
{
    return nifti_matrix_intent(data, size) == NIFTI_DENSE_LABELS;
}

/* The header, and what it asks of the rest. */
static conus_status read_header(struct volume_header *header, size_t shape[2], const uint8_t *data, size_t size,
                                uint64_t max_memory)
{
    conus_status status = nifti_matrix_parse(header, shape, data, size);
    if (status) {
        return status;
    }
    if (header->intent_code != NIFTI_DENSE_LABELS) {
        return fail(CONUS_ERROR_UNSUPPORTED, "intent_code: found %d, allowed is %d (labels)", header->intent_code,
                    NIFTI_DENSE_LABELS);
    }
    if (header->info.slope != 1 || header->info.intercept != 0) {
        return fail(CONUS_ERROR_DATA, "scl_slope, scl_inter: found %g and %g, labels are not scaled",
                    header->info.slope, header->info.intercept);
    }
    if (header->offset > CIFTI_HEAD_LIMIT) {
        return fail(CONUS_ERROR_UNSUPPORTED, "vox_offset: found %llu, at most %d bytes of header and XML are read",
                    (unsigned long long)header->offset, CIFTI_HEAD_LIMIT);
    }
    if (shape[1] > max_memory / sizeof(uint32_t)) {
        return fail(CONUS_ERROR_MEMORY, "dim[6]: found %zu, more labels than fit in %llu bytes (--max-memory)",
                    shape[1], (unsigned long long)max_memory);
    }
    size_t values = header->info.volume_count * header->volume_size; /* counted by the header's reader */
    if (header->offset > size || values > size - header->offset) {
        return fail(CONUS_ERROR_DATA, "dim: %zu x %zu values of %s end at byte %llu, the file has %zu", shape[0],
                    shape[1], header->info.datatype, (unsigned long long)header->offset + values, size);
    }
    return CONUS_OK;
}

/* The XML: the only extension with its code. */
static conus_status find_xml(struct text *out, const struct bytes *head, const struct volume_header *header)
{
    struct volume_extension *extensions = NULL;
    size_t count = 0;
    size_t found = 0;
    size_t end;
    conus_status status = nifti_extensions_parse(&extensions, &count, &end, head, header);
    for (size_t i = 0; !status && i < count; i++) {
        if (extensions[i].code == XML_CODE) {
            *out = text_from_bytes(extensions[i].data, extensions[i].size);
            found++;
        }
    }
    memory_free(extensions);
    return status || found == 1
               ? status
               : fail(CONUS_ERROR_DATA, "extensions of ecode %d, which hold the XML: found %zu, one is needed",
                      XML_CODE, found);
}

conus_status cifti_parse(struct cifti *out, const uint8_t *data, size_t size, uint64_t max_memory)
{
    struct volume_header header;
    size_t shape[2];
    struct text xml = {0};
    conus_status status = read_header(&header, shape, data, size, max_memory);
    if (status) {
        return status;
    }
    const struct bytes head = {(uint8_t *)data, (size_t)header.offset};
    struct cifti cifti = {
        .count = shape[1], .values = data + header.offset, .datatype = header.datatype, .swapped = header.swapped};
    status = find_xml(&xml, &head, &header);
    status = status ? status : cifti_xml_parse(&cifti, xml, shape[0], max_memory);
    if (status) {
        cifti_finish(&cifti);
        return status;
    }
    *out = cifti;
    return CONUS_OK;
}

static conus_status take_label(uint32_t *out, double value, const struct cifti_map *map, size_t grayordinate)
{
    if (!isfinite(value) || value != floor(value) || value > UINT32_MAX) {
        return fail(CONUS_ERROR_DATA, "grayordinate %zu: label %.9g, allowed are whole numbers up to 4294967295",
                    grayordinate, value);
    }
    *out = value > 0 ? (uint32_t)value : 0;
    return !*out || label_table_find(&map->table, *out)
               ? CONUS_OK
               : fail(CONUS_ERROR_DATA, "grayordinate %zu: label %u, which the LabelTable of map \"%.60s\" lacks",
                      grayordinate, *out, map->name ? map->name : "");
}

conus_status cifti_labels(uint32_t **out, const struct cifti *cifti, size_t map, struct notes *notes)
{
    size_t size = volume_datatype_size(cifti->datatype);
    size_t negative = 0;
    uint32_t *labels = memory_raw(cifti->count, sizeof *labels);
    conus_status status = labels ? CONUS_OK : CONUS_ERROR_MEMORY;
    for (size_t i = 0; !status && i < cifti->count; i++) {
        const uint8_t *at = (const uint8_t *)cifti->values + (i * cifti->map_count + map) * size;
        double value = volume_value_at(at, cifti->datatype, cifti->swapped);
        status = take_label(&labels[i], value, &cifti->maps[map], i);
        negative += value < 0;
    }
    if (!status && negative) {
        status = notes_warn(notes, "%zu vertices or voxels have labels below 0 and belong to no area", negative);
    }
    if (status) {
        memory_free(labels);
        return status;
    }
    *out = labels;
    return CONUS_OK;
}
