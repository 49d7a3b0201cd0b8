/* SPDX-License-Identifier: BSD-3-Clause */
/* NIfTI-1 and NIfTI-2 headers, extensions and voxels. */
#include "fuzz_volume.h"

#include "loaders/volumes/nifti.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void list_extensions(const struct volume_header *header, const uint8_t *data, size_t size)
{
    size_t head_size = !header->pair && header->offset < size ? (size_t)header->offset : size;
    struct bytes head = {memory_raw(head_size, 1), head_size};
    struct volume_extension *list = NULL;
    size_t count = 0;
    size_t end = 0;
    size_t sum = 0;
    if (head.data) {
        memcpy(head.data, data, head_size);
        if (!nifti_extensions_parse(&list, &count, &end, &head, header) && end > head_size) {
            abort();
        }
        for (size_t i = 0; i < count; i++) {
            for (size_t k = 0; k < list[i].size; k++) {
                sum += list[i].data[k]; /* every byte must be readable */
            }
        }
    }
    if (sum > 255 * size) {
        abort();
    }
    memory_free(list);
    bytes_finish(&head);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct volume_header header;
    struct notes notes = {0};
    if (!nifti_header_parse(&header, data, size, &notes)) {
        fuzz_check_header(&header);
        list_extensions(&header, data, size);
        fuzz_decode(&header, data, size);
    }
    notes_finish(&notes);
    return 0;
}
