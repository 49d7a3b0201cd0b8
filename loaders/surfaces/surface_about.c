/* SPDX-License-Identifier: BSD-3-Clause */
/* Structure, layer and size of a GIFTI surface. */
#include "loaders/surfaces/surface_about.h"

#include "base/formats/gzip.h"
#include "base/formats/xml.h"
#include "base/memory.h"
#include "loaders/surfaces/gifti.h"

static const uint64_t DEFAULT_MEMORY = UINT64_C(8) << 30;

void surface_about_finish(struct surface_about *about)
{
    memory_free(about->structure);
    memory_free(about->layer);
    memory_free(about->geometric_type);
    *about = (struct surface_about){0};
}

static char *take(char **from)
{
    char *text = *from;
    *from = NULL;
    return text;
}

static void take_about(struct surface_about *out, struct gifti *gifti)
{
    *out = (struct surface_about){.structure = take(&gifti->structure),
                                  .layer = take(&gifti->layer),
                                  .geometric_type = take(&gifti->geometric_type)};
    for (size_t i = gifti->array_count; i-- > 0;) {
        out->vertices = gifti->arrays[i].intent == GIFTI_POINTSET ? gifti->arrays[i].dim[0] : out->vertices;
    }
}

conus_status surface_about_read(struct surface_about *out, const char *path, uint64_t max_memory)
{
    const struct gifti_options options = {.max_memory = max_memory, .outline = true};
    struct bytes bytes = {0};
    struct gifti gifti = {0};
    struct notes notes = {0}; /* said again by whoever reads the surface */
    conus_status status = gzip_read(&bytes, path, max_memory ? max_memory : DEFAULT_MEMORY, NULL);
    *out = (struct surface_about){0};
    if (!status && text_equal(xml_root(text_from_bytes(bytes.data, bytes.size)), "GIFTI")) {
        status = gifti_parse(&gifti, bytes.data, bytes.size, &options, &notes);
        status = status ? fail_in(status, path) : CONUS_OK;
        take_about(out, &gifti);
    }
    gifti_finish(&gifti);
    notes_finish(&notes);
    bytes_finish(&bytes);
    return status;
}
