/* SPDX-License-Identifier: BSD-3-Clause */
/* A row of labels as a volume, and its names in conus. */
#include "builders/label_row.h"

#include "base/files/file.h"
#include "base/memory.h"
#include "builders/nifti_builder.h"
#include "conus/own.h"
#include "test.h"

#include <stdio.h>
#include <string.h>

void row_text(const char *path, const char *text)
{
    assert_ok(conus_write_file(path, text, strlen(text)));
}

void row_write(const char *name, size_t count, int edge)
{
    struct nifti_builder file;
    const int64_t dim[3] = {(int64_t)count, 1, 1};
    nifti_begin(&file, 1, false, 2, dim);
    for (size_t i = 0; i < 12; i++) {
        nifti_set(&file, "srow", i, i == 0 ? edge : i % 5 == 0 ? 1 : 0);
    }
    for (size_t i = 1; i < 4; i++) {
        nifti_set(&file, "pixdim", i, i == 1 ? edge : 1);
    }
    for (size_t i = 0; i < count; i++) {
        nifti_voxel(&file, (double)i * edge);
    }
    assert_ok(conus_write_file(test_in(name), file.bytes.data, file.bytes.size));
    buffer_finish(&file.bytes);
}

/* The notes of an atlas, each with a '
 * ', until the next call. */
static const char *notes_of(const conus_atlas *atlas)
{
    static struct buffer text;
    buffer_clear(&text);
    buffer_text(&text, "");
    for (size_t i = 0; i < conus_atlas_note_count(atlas); i++) {
        buffer_format(&text, "%s\n", conus_atlas_note(atlas, i));
    }
    return text.data ? text.data : "";
}

void assert_row(const char *name, uint32_t label, const char *source, const char *note)
{
    assert_row_of("v.nii", name, label, source, note);
}

void assert_row_of(const char *file, const char *name, uint32_t label, const char *source, const char *note)
{
    conus_atlas *atlas = NULL;
    const conus_object *found = NULL;
    assert_ok(conus_atlas_load(&atlas, test_in(file), NULL));
    assert_string_equal(conus_atlas_label_source(atlas), source);
    for (size_t i = 1; i <= conus_atlas_object_count(atlas); i++) {
        const conus_object *object = conus_atlas_object(atlas, i);
        found = object->label == label ? object : found;
    }
    assert_non_null(found);
    assert_string_equal(found->name, name);
    if (note && !strstr(notes_of(atlas), note)) {
        fail_msg("\"%s\" is not in\n%s", note, notes_of(atlas));
    }
    static const char *const words[] = {"contradict",  "which is used", "although", "off by one",
                                        "passed over", "taken",         "fits"};
    for (size_t i = 0; !note && i < sizeof words / sizeof words[0]; i++) {
        if (strstr(notes_of(atlas), words[i])) {
            fail_msg("unwanted: %s", notes_of(atlas));
        }
    }
    conus_atlas_destroy(atlas);
}
