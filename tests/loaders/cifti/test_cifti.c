/* SPDX-License-Identifier: BSD-3-Clause */
/* CIFTI files of labels: reading, and every contradiction. Expected values are those of cifti_builder.h. */
#include "loaders/cifti/cifti_file.h"

#include "base/memory.h"
#include "builders/cifti_builder.h"
#include "builders/nifti_builder.h"
#include "loaders/file_kind.h"
#include "loaders/probe.h"
#include "loaders/surfaces/mesh_file.h"
#include "loaders/volumes/nifti.h"
#include "test.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const uint64_t MEMORY = 1 << 20;

static conus_status read_bytes(struct cifti_choice *out, const struct buffer *file, const char *map,
                               struct notes *notes)
{
    const struct bytes bytes = {(uint8_t *)file->data, file->size};
    return cifti_choice_read(out, &bytes, text_from(map), MEMORY, notes);
}

static void assert_map_one(const struct cifti_choice *choice)
{
    static const uint32_t left[4] = {5, 5, 5, 0};
    static const uint32_t right[4] = {5, 5, 8, 8};
    static const uint32_t voxels[12] = {7, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 7}; /* voxel 1 2 1: 1 + 2 (2 + 3) */
    const char *const names[] = {"CortexLeft", "CortexRight"};
    const uint32_t *const wanted[] = {left, right};
    uint32_t *labels = NULL;
    for (int i = 0; i < 2; i++) {
        struct label_table table = {0};
        const struct cifti_model *model = cifti_choice_surface(choice, names[i]);
        assert_non_null(model);
        assert_int_equal(model->vertex_count, 4);
        assert_int_equal(model->structure->side, i ? 'R' : 'L');
        assert_ok(cifti_choice_vertices(&labels, &table, choice, model));
        assert_memory_equal(labels, wanted[i], sizeof left);
        assert_int_equal(table.count, 1 + i);
        assert_string_equal(table.entries[0].name, "A");
        assert_int_equal(table.entries[0].rgb[0], 255);
        memory_free(labels);
        label_table_finish(&table);
    }
    struct label_table table = {0};
    assert_ok(cifti_choice_voxels(&labels, &table, choice));
    assert_memory_equal(labels, voxels, sizeof voxels);
    assert_int_equal(table.count, 1);
    assert_string_equal(table.entries[0].name, "Thalamus");
    assert_int_equal(table.entries[0].hemisphere, 'L');
    memory_free(labels);
    label_table_finish(&table);
}

static void all_types_in_both_orders(void **state)
{
    (void)state;
    static const int types[] = {VOLUME_UINT8, VOLUME_INT8,  VOLUME_UINT16, VOLUME_INT16,   VOLUME_UINT32,
                                VOLUME_INT32, VOLUME_INT64, VOLUME_UINT64, VOLUME_FLOAT32, VOLUME_FLOAT64};
    for (size_t i = 0; i < 2 * sizeof types / sizeof types[0]; i++) {
        struct buffer bytes = {0};
        struct cifti_choice choice = {0};
        struct notes notes = {0};
        cifti_build(&bytes, &(struct cifti_spec){.datatype = types[i / 2], .big = i % 2});
        assert_true(cifti_is((const uint8_t *)bytes.data, bytes.size));
        assert_ok(read_bytes(&choice, &bytes, "0", &notes));
        assert_map_one(&choice);
        assert_int_equal(notes.count, 0);
        cifti_choice_finish(&choice);
        notes_finish(&notes);
        buffer_finish(&bytes);
    }
}

/* 10^(exponent + 3) mm per unit: -3 leaves the numbers as they are, -6 (micrometres) divides by 1000. */
static void the_volume_lies_where_the_xml_says(void **state)
{
    (void)state;
    for (int micrometres = 0; micrometres < 2; micrometres++) {
        struct buffer bytes = {0};
        struct cifti_choice choice = {0};
        struct notes notes = {0};
        const double mm = micrometres ? 0.001 : 1;
        const double wanted[16] = {-2 * mm, 0, 0, 0, 0, 2 * mm, 0, 0, 0, 0, 2 * mm, 0, 90 * mm, -126 * mm, -72 * mm, 1};
        cifti_build(&bytes,
                    &(struct cifti_spec){.find = "MeterExponent=\"-3\"",
                                         .replace = micrometres ? "MeterExponent=\"-6\"" : "MeterExponent=\"-3\""});
        assert_ok(read_bytes(&choice, &bytes, "0", &notes));
        assert_int_equal(choice.cifti.dim[0], 2);
        assert_int_equal(choice.cifti.dim[1], 3);
        assert_int_equal(choice.cifti.dim[2], 2);
        for (int i = 0; i < 16; i++) {
            assert_near(choice.cifti.world_from_voxel[i], wanted[i], 1e-12);
        }
        cifti_choice_finish(&choice);
        notes_finish(&notes);
        buffer_finish(&bytes);
    }
}

static void a_map_is_chosen_by_number_or_name(void **state)
{
    (void)state;
    static const struct {
        const char *map;
        size_t found;
        const char *said; /* a note, or the error */
    } cases[] = {{"0", 0, NULL},
                 {"1", 1, NULL},
                 {"one", 0, NULL},
                 {"two", 1, NULL},
                 {"", 0,
                  "2 maps: number 0 (from 0) was used, \"one\"; add \",map=K\" or \",map=NAME\" to the file of "
                  "labels for another of 0 \"one\", 1 \"two\""},
                 {"2", 2, "map: found 2, allowed are 0 to 1"},
                 {"three", 2, "map: 0 maps are called \"three\", one is needed of 0 \"one\", 1 \"two\""}};
    struct buffer bytes = {0};
    cifti_build(&bytes, &(struct cifti_spec){0});
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct cifti_choice choice = {0};
        struct notes notes = {0};
        assert_fails(read_bytes(&choice, &bytes, cases[i].map, &notes),
                     cases[i].found < 2 ? CONUS_OK : CONUS_ERROR_ARGUMENT);
        if (cases[i].found < 2) {
            assert_int_equal(choice.map, cases[i].found);
            assert_int_equal(choice.labels[0], cases[i].found ? 8 : 5);
            assert_int_equal(choice.labels[7], cases[i].found ? 0 : 7);
            assert_int_equal(notes.count, cases[i].said != NULL);
        }
        if (cases[i].said) {
            assert_string_equal(notes.count ? notes.lines[0] : conus_message(), cases[i].said);
        }
        cifti_choice_finish(&choice);
        notes_finish(&notes);
    }
    buffer_finish(&bytes);
}

/* Models may stand in any order, and the volume behind them. */
static void order_in_the_xml_is_free(void **state)
{
    (void)state;
    static const struct cifti_spec specs[] = {
        {.find = "IndexOffset=\"0\" IndexCount=\"3\" ModelType=\"CIFTI_MODEL_TYPE_SURFACE\" "
                 "BrainStructure=\"CIFTI_STRUCTURE_CORTEX_LEFT\" SurfaceNumberOfVertices=\"4\"><VertexIndices>0 1 "
                 "2</VertexIndices></BrainModel>\n<BrainModel IndexOffset=\"3\" IndexCount=\"4\" "
                 "ModelType=\"CIFTI_MODEL_TYPE_SURFACE\" BrainStructure=\"CIFTI_STRUCTURE_CORTEX_RIGHT\" "
                 "SurfaceNumberOfVertices=\"4\"><VertexIndices>0 1 2 3</VertexIndices></BrainModel>",
         .replace =
             "IndexOffset=\"3\" IndexCount=\"4\" ModelType=\"CIFTI_MODEL_TYPE_SURFACE\" "
             "BrainStructure=\"CIFTI_STRUCTURE_CORTEX_RIGHT\" SurfaceNumberOfVertices=\"4\"><VertexIndices>0 1 2 "
             "3</VertexIndices></BrainModel>\n<BrainModel IndexOffset=\"0\" IndexCount=\"3\" "
             "ModelType=\"CIFTI_MODEL_TYPE_SURFACE\" BrainStructure=\"CIFTI_STRUCTURE_CORTEX_LEFT\" "
             "SurfaceNumberOfVertices=\"4\"><VertexIndices>0 1 2</VertexIndices></BrainModel>"},
        {.find = "<Volume ", .replace = "<Other/><Volume "},
    };
    for (size_t i = 0; i < 2; i++) {
        struct buffer bytes = {0};
        struct cifti_choice choice = {0};
        struct notes notes = {0};
        cifti_build(&bytes, &specs[i]);
        assert_ok(read_bytes(&choice, &bytes, "one", &notes));
        assert_map_one(&choice);
        cifti_choice_finish(&choice);
        notes_finish(&notes);
        buffer_finish(&bytes);
    }
}

static void numbers_below_0_are_no_area(void **state)
{
    (void)state;
    static const double values[18] = {5, 0, -1, 0, 5, 0, 5, 0, 5, 0, 8, 0, 8, 0, -7, 0, 7, 0};
    struct buffer bytes = {0};
    struct cifti_choice choice = {0};
    struct notes notes = {0};
    cifti_build(&bytes, &(struct cifti_spec){.values = values, .datatype = VOLUME_INT32});
    assert_ok(read_bytes(&choice, &bytes, "0", &notes));
    assert_int_equal(choice.labels[1], 0);
    assert_int_equal(choice.labels[7], 0);
    assert_int_equal(choice.labels[8], 7);
    assert_int_equal(notes.count, 1);
    assert_string_equal(notes.lines[0], "2 vertices or voxels have labels below 0 and belong to no area");
    cifti_choice_finish(&choice);
    notes_finish(&notes);
    buffer_finish(&bytes);
}

/* A label of voxels on both sides, or of a structure without a side, has no hemisphere. */
static void voxels_of_two_sides_have_none(void **state)
{
    (void)state;
    struct buffer bytes = {0};
    struct cifti_choice choice = {0};
    struct notes notes = {0};
    struct label_table table = {0};
    uint32_t *labels = NULL;
    cifti_build(&bytes, &(struct cifti_spec){
                            .find = "IndexCount=\"2\" ModelType=\"CIFTI_MODEL_TYPE_VOXELS\" "
                                    "BrainStructure=\"CIFTI_STRUCTURE_THALAMUS_LEFT\"><VoxelIndicesIJK>0 0 0\n",
                            .replace = "IndexCount=\"1\" ModelType=\"CIFTI_MODEL_TYPE_VOXELS\" "
                                       "BrainStructure=\"CIFTI_STRUCTURE_THALAMUS_RIGHT\"><VoxelIndicesIJK>0 0 "
                                       "0</VoxelIndicesIJK></BrainModel><BrainModel IndexOffset=\"8\" "
                                       "IndexCount=\"1\" ModelType=\"CIFTI_MODEL_TYPE_VOXELS\" "
                                       "BrainStructure=\"CIFTI_STRUCTURE_THALAMUS_LEFT\"><VoxelIndicesIJK>"});
    assert_ok(read_bytes(&choice, &bytes, "0", &notes));
    assert_ok(cifti_choice_voxels(&labels, &table, &choice));
    assert_int_equal(labels[0], 7);
    assert_int_equal(labels[11], 7);
    assert_int_equal(table.entries[0].hemisphere, 0);
    memory_free(labels);
    label_table_finish(&table);
    cifti_choice_finish(&choice);
    notes_finish(&notes);
    buffer_finish(&bytes);
}

/* A change of one field, and a part of the message about it. */
static const struct bend {
    struct cifti_spec spec;
    const char *message;
} bends[] = {
#define XML(from, to, message)                                                                                         \
    {                                                                                                                  \
        {.find = (from), .replace = (to)}, "XML: line " message                                                        \
    }
#define HEADER(name, at, number, message)                                                                              \
    {                                                                                                                  \
        {.field = (name), .index = (at), .value = (number)}, message                                                   \
    }
    HEADER("dim", 0, 5, "dim: found 5: 1 x 1 x 1 x 1 x ..., a CIFTI matrix has 6 dimensions"),
    HEADER("dim", 0, 7, "dim: found 7"),
    HEADER("dim", 1, 2, "dim: found 6: 2 x 1"),
    HEADER("dim", 4, 3, "dim: found 6: 1 x 1 x 1 x 3"),
    HEADER("dim", 5, 0, "dim[5]: found 0, allowed is 1 or more"),
    HEADER("dim", 6, 0, "dim[6]: found 0, allowed is 1 or more"),
    HEADER("dim", 5, 1, "NamedMap: found more than 1, which is dim[5]"),
    HEADER("dim", 6, 8, "IndexCount: found \"2\", allowed are whole numbers from 1 to 1"),
    HEADER("dim", 6, 10, "dim: 2 x 10 values of float32 end at byte"),
    HEADER("dim", 6, 0x1p40, "dim[6]: found 1099511627776, more labels than fit in 1048576 bytes"),
    HEADER("dim", 6, 0x1p62, "allowed are as many as fit in 2^62 bytes"),
    HEADER("magic", 1, 'i', "not a CIFTI-2 file: a single NIfTI-2 file of an intent_code"),
    HEADER("datatype", 0, 32, "datatype: found 32 (complex64)"),
    HEADER("bitpix", 0, 16, "bitpix: found 16"),
    HEADER("scl_slope", 0, 2, "scl_slope, scl_inter: found 2 and 0, labels are not scaled"),
    HEADER("vox_offset", 0, 540, "vox_offset: found 540"),
    HEADER("vox_offset", 0, 0x1p27, "vox_offset: found 134217728, at most 67108864 bytes of header and XML are read"),
    HEADER("vox_offset", 0, 1 << 20, "values of float32 end at byte 1048648, the file has"),
    HEADER("vox_offset", 0, 560, "extension at byte 544: found esize"),
    HEADER("extender", 0, 0, "extensions of ecode 32, which hold the XML: found 0, one is needed"),
    {{.copies = -1}, "extensions of ecode 32, which hold the XML: found 0, one is needed"},
    {{.copies = 1}, "extensions of ecode 32, which hold the XML: found 2, one is needed"},
    {{.cut = 1}, "values of float32 end at byte"},
    XML("<CIFTI Version", "<GIFTI Version", "2: outermost element: found <GIFTI>, allowed is <CIFTI>"),
    XML("Version=\"2\"", "Version=\"1\"", "2: Version: found \"1\", 2 is read"),
    XML(" Version=\"2\"", "", "2: Version: found \"\", 2 is read"),
    XML("</CIFTI>", "", "16: not well-formed XML: no element found"),
    XML("</Matrix></CIFTI>", "</Matrix><Matrix></Matrix></CIFTI>", "16: Matrix twice"),
    XML("AppliesToMatrixDimension=\"0\"", "AppliesToMatrixDimension=\"2\"",
        "4: AppliesToMatrixDimension: found \"2\", allowed are whole numbers from 0 to 1"),
    XML("AppliesToMatrixDimension=\"1\"", "AppliesToMatrixDimension=\"0\"",
        "7: IndicesMapToDataType: found \"CIFTI_INDEX_TYPE_BRAIN_MODELS\" for dimension 0, a .dlabel.nii has "
        "CIFTI_INDEX_TYPE_LABELS"),
    XML("TYPE_LABELS", "TYPE_SCALARS", "4: IndicesMapToDataType: found \"CIFTI_INDEX_TYPE_SCALARS\""),
    XML("</MatrixIndicesMap></Matrix>",
        "</MatrixIndicesMap><MatrixIndicesMap AppliesToMatrixDimension=\"0\" "
        "IndicesMapToDataType=\"CIFTI_INDEX_TYPE_LABELS\"/></Matrix>",
        "16: AppliesToMatrixDimension: 0 twice"),
    XML("<MapName>two</MapName>", "", "6: MapName is missing"),
    XML("<MapName>two</MapName>", "<MapName>two</MapName><MapName>3</MapName>", "6: MapName twice"),
    XML("<MetaData/>", "</NamedMap><NamedMap>", "6: NamedMap: found more than 2"),
    XML("Key=\"5\"", "Key=\"5.5\"", "5: line 5: label \"5.5\", a whole number"),
    XML("Red=\"1\" Green=\"0\"", "Red=\"2\" Green=\"0\"", "5: line 5: red is \"2\", a number from 0 to 1"),
    XML("<Label Key=\"0\"", "<MapName><Label/></MapName><Label Key=\"0\"", "5: line 5: label \"\", a whole number"),
    XML("\"2,3,2\"", "\"2,3\"", "8: VolumeDimensions: found \"2,3\", allowed are three whole numbers from 1"),
    XML("\"2,3,2\"", "\"2,3,2,1\"", "8: VolumeDimensions: found \"2,3,2,1\""),
    XML("\"2,3,2\"", "\"2,0,2\"", "8: VolumeDimensions: found \"2,0,2\""),
    {{.find = "\"2,3,2\"", .replace = "\"1000,1000,1000\""},
     "XML: VolumeDimensions: found \"1000,1000,1000\", more voxels than fit in 1048576 bytes (--max-memory)"},
    XML("\"2,3,2\"", "\"2,2,2\"", "16: VoxelIndicesIJK of ThalamusLeft: found 1 2 1, the volume has 2 x 2 x 2"),
    XML("</Volume>", "</Volume><Volume VolumeDimensions=\"2,3,2\"/>", "11: Volume twice"),
    XML("MeterExponent=\"-3\"", "MeterExponent=\"-33\"",
        "8: MeterExponent: found \"-33\", allowed are whole numbers from -9 to 3 (-3: mm)"),
    XML(" MeterExponent=\"-3\"", "", "8: MeterExponent: found \"\""),
    XML("-2 0 0 90", "-2 0 0 nan", "11: TransformationMatrixVoxelIndicesIJKtoXYZ: 16 finite numbers by rows"),
    XML("-2 0 0 90", "-2 0 0", "11: TransformationMatrixVoxelIndicesIJKtoXYZ: 16 finite numbers by rows"),
    XML("-2 0 0 90", "-2 0 0 90 1", "11: TransformationMatrixVoxelIndicesIJKtoXYZ: 16 finite numbers by rows"),
    XML("0 0 0 1<", "0 0 0 2<", "11: TransformationMatrixVoxelIndicesIJKtoXYZ: 16 finite numbers by rows"),
    XML("0 0 2 -72", "0 2 0 -72", "11: TransformationMatrixVoxelIndicesIJKtoXYZ: the matrix is singular"),
    XML("IndexOffset=\"3\"", "IndexOffset=\"2\"",
        "16: IndexOffset of CortexRight: found 2, the models before it end at 3"),
    XML("IndexOffset=\"3\"", "IndexOffset=\"4\"",
        "16: IndexOffset of CortexRight: found 4, the models before it end at 3"),
    XML("IndexOffset=\"3\"", "IndexOffset=\"9\"",
        "13: IndexOffset: found \"9\", allowed are whole numbers from 0 to 8"),
    XML("IndexCount=\"3\"", "IndexCount=\"4\"", "12: VertexIndices: found 3 numbers, IndexCount asks for 4"),
    XML("IndexCount=\"3\"", "IndexCount=\"2\"", "12: VertexIndices: found 3 numbers, IndexCount asks for 2"),
    XML("IndexCount=\"3\"", "IndexCount=\"0\"", "12: IndexCount: found \"0\", allowed are whole numbers from 1 to 9"),
    XML("IndexCount=\"3\"", "IndexCount=\"9\"", "12: VertexIndices: found 5 characters, IndexCount asks for 9"),
    XML("0 1 2<", "0 1 4<", "12: VertexIndices: number 2 is \"4\", allowed are whole numbers from 0 to 3"),
    XML("0 1 2<", "0 1 -1<", "12: VertexIndices: number 2 is \"-1\""),
    XML("0 1 2<", "0 1 1<", "12: VertexIndices: number 2 is 1 behind 1, allowed are ascending ones"),
    XML("0 1 2<", "0 2 1<", "12: VertexIndices: number 2 is 1 behind 2"),
    XML("<VertexIndices>0 1 2</VertexIndices>", "", "12: BrainModel: VertexIndices is missing"),
    XML("<VertexIndices>0 1 2</VertexIndices>",
        "<VertexIndices>0 1 2</VertexIndices><VertexIndices>0 1 2</VertexIndices>", "12: VertexIndices twice"),
    XML("<VertexIndices>0 1 2</VertexIndices>", "<VoxelIndicesIJK>0 0 0 1 0 0 0 1 0</VoxelIndicesIJK>",
        "12: VoxelIndicesIJK in a model of a surface"),
    XML("<VoxelIndicesIJK>0 0 0\n1 2 1</VoxelIndicesIJK>", "<VertexIndices>0 1</VertexIndices>",
        "14: VertexIndices in a model of voxels"),
    XML("1 2 1<", "0 0 0<", "16: VoxelIndicesIJK of ThalamusLeft: found 0 0 0 again, the volume has 2 x 3 x 2"),
    XML("1 2 1<", "2 0 0<", "16: VoxelIndicesIJK of ThalamusLeft: found 2 0 0, the volume has 2 x 3 x 2"),
    XML("1 2 1<", "1 2<", "15: VoxelIndicesIJK: found 5 numbers, IndexCount asks for 6"),
    XML("TYPE_VOXELS", "TYPE_PARCELS", "14: ModelType: found \"CIFTI_MODEL_TYPE_PARCELS\""),
    XML("STRUCTURE_CORTEX_LEFT", "STRUCTURE_CORTEX_UP", "12: BrainStructure: found \"CIFTI_STRUCTURE_CORTEX_UP\""),
    XML("STRUCTURE_CORTEX_RIGHT", "STRUCTURE_CORTEX_LEFT",
        "16: BrainStructure: two models of the surface of CortexLeft, allowed is one"),
    XML("SurfaceNumberOfVertices=\"4\"", "", "12: SurfaceNumberOfVertices: found \"\""),
    XML("SurfaceNumberOfVertices=\"4\"", "SurfaceNumberOfVertices=\"1000000000\"",
        "12: SurfaceNumberOfVertices: found \"1000000000\", allowed are whole numbers from 1 to 262144"),
    XML("<BrainModel ", "<NamedMap/><BrainModel ", "12: <NamedMap> in the wrong place"),
#undef XML
#undef HEADER
};

static void every_contradiction_is_an_error(void **state)
{
    (void)state;
    for (size_t i = 0; i < sizeof bends / sizeof bends[0]; i++) {
        struct buffer bytes = {0};
        struct cifti_choice choice = {0};
        struct notes notes = {0};
        cifti_build(&bytes, &bends[i].spec);
        if (!read_bytes(&choice, &bytes, "0", &notes) || !strstr(conus_message(), bends[i].message)) {
            fail_msg("bend %zu: wanted \"%s\", found \"%s\"", i, bends[i].message, conus_message());
        }
        assert_null(strchr(conus_message(), '\n'));
        notes_finish(&notes);
        buffer_finish(&bytes);
    }
}

static void labels_must_be_whole_and_in_the_table(void **state)
{
    (void)state;
    static const struct {
        double value;
        const char *message;
    } cases[] = {{5.5, "grayordinate 4: label 5.5, allowed are whole numbers up to 4294967295"},
                 {NAN, "grayordinate 4: label nan"},
                 {-INFINITY, "grayordinate 4: label -inf"},
                 {0x1p32, "grayordinate 4: label 4.2949673e+09, allowed"},
                 {6, "grayordinate 4: label 6, which the LabelTable of map \"one\" lacks"}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        double values[CIFTI_GRAYORDINATES * CIFTI_MAPS] = {0};
        struct buffer bytes = {0};
        struct cifti_choice choice = {0};
        struct notes notes = {0};
        values[8] = cases[i].value;
        cifti_build(&bytes, &(struct cifti_spec){.values = values, .datatype = VOLUME_FLOAT64});
        assert_fails(read_bytes(&choice, &bytes, "0", &notes), CONUS_ERROR_DATA);
        if (!strstr(conus_message(), cases[i].message)) {
            fail_msg("wanted \"%s\", found \"%s\"", cases[i].message, conus_message());
        }
        assert_ok(read_bytes(&choice, &bytes, "1", &notes)); /* for another map this does not matter */
        cifti_choice_finish(&choice);
        notes_finish(&notes);
        buffer_finish(&bytes);
    }
}

/* Every byte is needed: the file ends with the values. */
static void every_prefix_is_refused(void **state)
{
    (void)state;
    struct buffer bytes = {0};
    cifti_build(&bytes, &(struct cifti_spec){0});
    for (size_t size = 0; size < bytes.size; size++) {
        char *exact = malloc(size + !size); /* so that a sanitizer notices one byte too many */
        struct buffer prefix = {.data = exact, .size = size};
        struct cifti_choice choice = {0};
        struct notes notes = {0};
        assert_non_null(exact);
        memcpy(exact, bytes.data, size);
        assert_fails(read_bytes(&choice, &prefix, "0", &notes), CONUS_ERROR_DATA);
        notes_finish(&notes);
        free(exact);
    }
    buffer_finish(&bytes);
}

/* XML that ends early has unclosed elements, whatever follows. */
static void every_prefix_of_the_xml_is_refused(void **state)
{
    (void)state;
    struct buffer bytes = {0};
    cifti_build(&bytes, &(struct cifti_spec){0});
    const char *start = memmem(bytes.data, bytes.size, "<?xml", 5);
    char *end = memmem(bytes.data, bytes.size, "</CIFTI>", 8);
    assert_true(start && end);
    for (char *at = end + 7; at >= start; at--) {
        struct cifti_choice choice = {0};
        struct notes notes = {0};
        *at = '\0';
        assert_fails(read_bytes(&choice, &bytes, "0", &notes), CONUS_ERROR_DATA);
        notes_finish(&notes);
    }
    buffer_finish(&bytes);
}

static conus_status attempt(void *data)
{
    struct cifti_file file = {0};
    struct notes notes = {0};
    struct label_table table = {0};
    uint32_t *labels = NULL;
    conus_status status = cifti_file_open(&file, data, 0, &notes);
    if (!status) {
        status =
            cifti_choice_vertices(&labels, &table, &file.choice, cifti_choice_surface(&file.choice, "CortexRight"));
        memory_free(status ? NULL : labels);
        label_table_finish(&table);
        status = status ? status : cifti_choice_voxels(&labels, &table, &file.choice);
        memory_free(status ? NULL : labels);
        label_table_finish(&table);
        cifti_file_finish(&file);
    }
    notes_finish(&notes);
    return status;
}

static void every_failing_allocation(void **state)
{
    (void)state;
    struct buffer bytes = {0};
    char path[256];
    cifti_build(&bytes, &(struct cifti_spec){0});
    snprintf(path, sizeof path, "%s", write_packed("failing.dlabel.nii", &bytes));
    test_every_allocation(attempt, path);
    buffer_finish(&bytes);
}

static void files_are_plain_or_packed(void **state)
{
    (void)state;
    struct buffer bytes = {0};
    char path[300];
    cifti_build(&bytes, &(struct cifti_spec){0});
    for (int packed = 0; packed < 2; packed++) {
        struct cifti_file file = {0};
        struct notes notes = {0};
        struct probe probe;
        snprintf(path, sizeof path, "%s,map=two", (packed ? write_packed : write_bytes)("x.dlabel.nii", &bytes));
        assert_ok(probe_open(&probe, path));
        assert_int_equal(probe.reader, READER_CIFTI);
        probe_close(&probe);
        assert_ok(cifti_file_open(&file, path, 0, &notes));
        assert_int_equal(file.choice.map, 1);
        assert_int_equal(strlen(file.sha256), 64);
        assert_null(strstr(file.path, ",map"));
        assert_fails(cifti_file_open(&file, path, 100, &notes), CONUS_ERROR_MEMORY);
        cifti_file_finish(&file);
        notes_finish(&notes);
    }
    struct probe probe;
    struct cifti_file file = {0};
    struct notes notes = {0};
    assert_ok(probe_open(&probe, "absent.dlabel.nii"));
    assert_false(probe.is_open);
    assert_int_equal(probe.reader, READER_VOLUME);
    probe_close(&probe);
    snprintf(path, sizeof path, "%s,map=", test_scratch("x.dlabel.nii"));
    assert_fails(cifti_file_open(&file, path, 0, &notes), CONUS_ERROR_ARGUMENT);
    assert_non_null(strstr(conus_message(), "map: a number from 0 or a name is needed"));
    bytes.data[bytes.size - 5] = 0x78; /* 7 becomes 3.6e34 */
    assert_fails(cifti_file_open(&file, write_bytes("x.dlabel.nii", &bytes), 0, &notes), CONUS_ERROR_DATA);
    notes_finish(&notes);
    buffer_finish(&bytes);
}

/* The first version of CIFTI gives files of labels the code of connections. */
static void the_first_version_is_named(void **state)
{
    (void)state;
    struct buffer bytes = {0};
    struct volume_file file;
    struct notes notes = {0};
    const struct cifti_spec spec = {
        .field = "intent_code", .value = 3001, .find = "Version=\"2\"", .replace = "Version=\"1.0\""};
    cifti_build(&bytes, &spec);
    const struct bytes head = {(uint8_t *)bytes.data, bytes.size};
    assert_string_equal(file_kind_of(NULL, &head)->words, "a CIFTI-1 file");
    assert_fails(volume_file_open(&file, write_bytes("x.nii", &bytes), 0, &notes), CONUS_ERROR_UNSUPPORTED);
    assert_non_null(strstr(conus_message(), "a CIFTI-1 file, allowed are volumes; convert it to CIFTI-2: wb_command "));
    buffer_finish(&bytes);
    notes_finish(&notes);
}

/* nibabel writes 3000 unless it is told otherwise, XCP-D 3006, and others 0: the XML says what it is. */
static void the_xml_says_that_they_are_labels(void **state)
{
    (void)state;
    static const int codes[] = {0, 1002, 3000, 3001, 3002, 3006, 3099};
    for (size_t i = 0; i < sizeof codes / sizeof codes[0]; i++) {
        struct buffer bytes = {0};
        struct cifti_choice choice = {0};
        struct notes notes = {0};
        cifti_build(&bytes, &(struct cifti_spec){.field = "intent_code", .value = codes[i], .big = i % 2});
        const struct bytes head = {(uint8_t *)bytes.data, bytes.size};
        assert_int_equal(file_kind_of(NULL, &head)->reader, READER_CIFTI);
        assert_ok(read_bytes(&choice, &bytes, "0", &notes));
        assert_map_one(&choice);
        cifti_choice_finish(&choice);
        notes_finish(&notes);
        buffer_finish(&bytes);
    }
}

static void other_matrices_are_named(void **state)
{
    (void)state;
    static const struct {
        int intent_code; /* in the header, and what the XML has for columns */
        const char *columns;
        int found;
        const char *words, *way;
    } cases[] = {
        {3000, "PARCELS", 3000, "(a .plabel.nii, say)", "conus reads the .dlabel.nii of its parcels, as ATLAS"},
        {3001, "BRAIN_MODELS", 3001, "connections (.dconn.nii)", "conus has no use for connections"},
        {3002, "SERIES", 3002, "time series (.dtseries.nii)", "'wb_command -cifti-separate' writes its voxels"},
        {3003, "PARCELS", 3003, "connections of parcels (.pconn.nii)", "the .dlabel.nii of its parcels"},
        {3006, "SCALARS", 3006, "values (.dscalar.nii)", "'wb_command -cifti-separate' writes its voxels"},
        {3000, "SCALARS", 3006, "values (.dscalar.nii)", "'wb_command -cifti-separate' writes its voxels"},
        {3007, "SERIES", 3002, "time series (.dtseries.nii)", "'wb_command -cifti-separate' writes its voxels"},
        {3007, "LABELS", 3007, "labels (.dlabel.nii)", "give it as ATLAS, as --labels of a surface"},
        {3099, "PARCELS", 3099, "a CIFTI matrix of an unknown kind", "the .dlabel.nii of its parcels"}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct buffer bytes = {0};
        struct volume_file file;
        struct notes notes = {0};
        char columns[32];
        snprintf(columns, sizeof columns, "INDEX_TYPE_%s", cases[i].columns);
        const struct cifti_spec spec = {.field = "intent_code",
                                        .value = cases[i].intent_code,
                                        .find = "INDEX_TYPE_LABELS",
                                        .replace = columns,
                                        .big = i % 2};
        cifti_build(&bytes, &spec);
        const struct bytes head = {(uint8_t *)bytes.data, bytes.size};
        assert_non_null(strstr(file_kind_of(NULL, &head)->words, cases[i].words));
        assert_int_equal(nifti_matrix_intent(head.data, head.size), cases[i].found);
        assert_fails(volume_file_open(&file, write_bytes("x.nii", &bytes), 0, &notes), CONUS_ERROR_UNSUPPORTED);
        assert_non_null(strstr(conus_message(), cases[i].words));
        assert_non_null(strstr(conus_message(), cases[i].way));
        if (cases[i].found != NIFTI_DENSE_LABELS) {
            struct vertex_labels labels = {0};
            assert_fails(vertex_labels_read(&labels, test_scratch("x.nii"), NULL, &notes), CONUS_ERROR_DATA);
            assert_non_null(strstr(conus_message(), cases[i].words));
        }
        buffer_finish(&bytes);
    }
}

TEST_GROUP(cifti)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(all_types_in_both_orders),          cmocka_unit_test(the_volume_lies_where_the_xml_says),
        cmocka_unit_test(a_map_is_chosen_by_number_or_name), cmocka_unit_test(order_in_the_xml_is_free),
        cmocka_unit_test(numbers_below_0_are_no_area),       cmocka_unit_test(voxels_of_two_sides_have_none),
        cmocka_unit_test(every_contradiction_is_an_error),   cmocka_unit_test(labels_must_be_whole_and_in_the_table),
        cmocka_unit_test(every_prefix_is_refused),           cmocka_unit_test(every_prefix_of_the_xml_is_refused),
        cmocka_unit_test(every_failing_allocation),          cmocka_unit_test(files_are_plain_or_packed),
        cmocka_unit_test(the_first_version_is_named),        cmocka_unit_test(other_matrices_are_named),
        cmocka_unit_test(the_xml_says_that_they_are_labels),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
