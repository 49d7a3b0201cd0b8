/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests of format_nearest(), which names a file's format for messages. Each sample begins as the format's specification
 * or its usual writer has it. */
#include "builders/nifti_builder.h"
#include "conus/own.h"
#include "loaders/refuse.h"
#include "test.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#define BYTES(text) (text), sizeof(text) - 1

static const struct {
    const char *name;
    const char *data;
    size_t size;
    const char *words; /* NULL: not known */
    const char *way;   /* a part of it, NULL: none */
} samples[] = {
    {"a.trk", BYTES("TRACK\0\1\0"), "a TrackVis tractogram", "--streamlines"},
    {"a.trk", BYTES("\1\2\3"), "a tractogram", "--streamlines"},
    {"a.tck", BYTES("mrtrix tracks\ncount: 3\n"), "an MRtrix tractogram", "--streamlines"},
    {"a.trx", BYTES("PK\3\4\x14\0"), "a TRX tractogram", "--streamlines, or a volume of its density as --pathway"},
    {"a.tt.gz", BYTES("\0\0\0\0\1\0\0\0"), "a tractogram", "--streamlines"},
    {"a.zip", BYTES("PK\3\4\x14\0"), "a ZIP archive", "unpack it, or give it as --streamlines if it is a TRX"},
    {"a.vtk", BYTES("# vtk DataFile Version 3.0\nx\nASCII\n"), "a VTK file", "lines as --streamlines"},
    {"a.vtp", BYTES("<VTKFile type=\"PolyData\"><Piece NumberOfLines=\"3\" NumberOfPolys=\"0\">"),
     "a VTK file of lines", "--streamlines"},
    {"a.vtp", BYTES("<VTKFile type=\"PolyData\"><Piece NumberOfLines=\"0\" NumberOfPolys=\"0\">"), "a surface",
     "ATLAS"},
    {"a.mif", BYTES("mrtrix image\ndim: 3"), "an MRtrix image", "mrconvert"},
    {"a.nrrd", BYTES("NRRD0004\ntype: uchar\n"), "a volume", "ATLAS"},
    {"a.mha", BYTES("ObjectType = Image\nNDims = 3\n"), "a volume", "ATLAS"},
    {"a.mhd", BYTES("NDims = 3\n"), "a volume", "ATLAS"},
    {"a.mat", BYTES("MATLAB 7.3 MAT-file, Platform: GLNXA64"), "a MATLAB file of version 7.3", "convert it to NIfTI"},
    {"a.mnc", BYTES("CDF\1\0\0"), "a MINC-1 volume", "mincconvert -2"},
    {"a.mnc", BYTES("\x89HDF\r\n\x1a\n\0"), "an HDF5 file (a MINC-2 volume, say)", "give a volume as ATLAS"},
    {"a+tlrc.HEAD", BYTES("\ntype = string-attribute\nname = HISTORY_NOTE\n"), "a volume", "ATLAS"},
    {"a+tlrc.BRIK.gz", BYTES("\1\2\3\4\5\6\7\0"), "the voxels of an AFNI data set", "its .HEAD"},
    {"lh.aparc.annot", BYTES("\0\0\x27\x0a\0\0\0\0\0"), "a FreeSurfer annotation", "--labels"},
    {"lh.x.label", BYTES("#!ascii label  , from subject\n3\n"), "a FreeSurfer label of vertices", "--labels"},
    {"design.mat", BYTES("/NumWaves\t2\n/NumPoints\t2\n/PPheights\t1 1\n\n/Matrix\n1 0\n1 1\n"),
     "a design matrix of FSL's statistics", NULL},
    {"one.mat", BYTES("/NumWaves 1\n/NumPoints 2\n/PPheights 1\n"), "a design matrix of FSL's statistics", NULL},
    {"design.con", BYTES("/ContrastName1\tmean\n/NumWaves\t1\n"), "contrasts of FSL's statistics", NULL},
    {"lh.curv", BYTES("\xff\xff\xff\0\0\2\x82\0\0\5\0\0\0\0\1\0\0\0\0"), "values of the vertices of a surface", NULL},
    {"lh.pial",
     BYTES("\xff\xff\xfe"
           "created by\n\n"),
     "a surface", "ATLAS"},
    {"lh.asc", BYTES("#!ascii version of lh.pial\n"), "a FreeSurfer surface as text", "mris_convert"},
    {"x.surf.gii", BYTES("<?xml version=\"1.0\"?><GIFTI><DataArray Intent=\"NIFTI_INTENT_POINTSET\"/>"), "a surface",
     "ATLAS"},
    {"x.label.gii", BYTES("<GIFTI><DataArray Intent=\"NIFTI_INTENT_LABEL\"/>"), "labels of the vertices of a surface",
     "--labels"},
    {"x.func.gii", BYTES("<GIFTI><DataArray Intent=\"NIFTI_INTENT_SHAPE\"/>"), "values of the vertices of a surface",
     NULL},
    {"x.mz3", BYTES("MZ\3\0\x0c\0\0\0"), "an MZ3 surface", "ATLAS"},
    {"x.ply", BYTES("ply\nformat ascii 1.0\n"), "a PLY surface", "ATLAS"},
    {"x.stl", BYTES("binary\0\1\2"), "an STL surface", "ATLAS"},
    {"x.stl", BYTES("solid cube\nfacet normal 0 0 1\n"), "an STL surface", "ATLAS"},
    {"x.obj", BYTES("v 0 0 0\nv 1 0 0\n"), "an OBJ surface", "ATLAS"},
    {"x.annot", BYTES("hello\n"), "plain text", NULL},
    {"x.xml", BYTES("<atlas version=\"1.0\"><header><type>Label</type><label index=\"1\">"),
     "an FSL atlas XML of type Label", "ATLAS or --labels"},
    {"x.xml", BYTES("<atlas><header><type>Probabilistic</type>"), "an FSL atlas XML", "conus manifest"},
    {"labels_x.xml", BYTES("<atlas version=\"2.0\"><data><label><index>4</index><name>A</name></label>"),
     "an SPM or CAT12 atlas XML", "ATLAS or --labels"},
    {"x.xml", BYTES("<LabelTable><Label Key=\"1\">A</Label></LabelTable>"), "a label table", "--labels"},
    {"x.xml", BYTES("<other/>"), "XML of another kind", NULL},
    {"x.nii.gz", BYTES("<!DOCTYPE html>\n<html><body>404"), "a web page", NULL},
    {"x.txt", BYTES("1 Precentral_L\n2 Precentral_R\n"), "a label table", "--labels"},
    {"x.tsv", BYTES("index\tname\n1\tA\n"), "a label table", "--labels"},
    {"x.json", BYTES("{\"conus_atlas\": 1}"), "a manifest", "ATLAS"},
    {"x.json", BYTES("{\"Name\": \"a sidecar\"}"), "JSON of another kind", NULL},
    {"x.md", BYTES("A manifest has the key \"conus_atlas\".\n"), "plain text", NULL},
    {"x.png", BYTES("\x89PNG\r\n\x1a\n\0\0"), "a PNG picture", NULL},
    {"x.pdf", BYTES("%PDF-1.7\n"), "a PDF document", NULL},
    {"x.nii", BYTES("version https://git-lfs.github.com/spec/v1\n"), "a Git LFS pointer, not the file itself", "fetch"},
    {"x.bin", BYTES("\1\2\3\4"), NULL, NULL},
};

static const struct format *nearest(const char *path, const struct bytes *bytes)
{
    const struct file_head head = head_of(path, bytes);
    return format_nearest(&head);
}

/* The kind found in the first `size` bytes of sample `i`. They are copied, so that reading past them is noticed. */
static const struct format *kind_of_sample(size_t i, size_t size)
{
    uint8_t *exact = malloc(size ? size : 1);
    assert_non_null(exact);
    memcpy(exact, samples[i].data, size);
    const struct bytes head = {exact, size};
    const struct format *kind = nearest(samples[i].name, &head);
    free(exact);
    return kind;
}

static void a_kind_is_detected_from_content_and_ending(void **state)
{
    (void)state;
    for (size_t i = 0; i < sizeof samples / sizeof samples[0]; i++) {
        const struct format *kind = kind_of_sample(i, samples[i].size);
        if (!kind != !samples[i].words || (kind && strcmp(kind->words, samples[i].words) != 0)) {
            fail_msg("%s: %s, not %s", samples[i].name, kind ? kind->words : "?", samples[i].words);
        }
        assert_int_equal(kind && kind->way, samples[i].way != NULL);
        assert_true(!samples[i].way || strstr(kind->way, samples[i].way));
        for (size_t size = 0; size < samples[i].size; size++) {
            kind = kind_of_sample(i, size);
            assert_true(!kind || kind->words);
        }
    }
}

static void a_dicom_file_has_its_mark_behind_128_bytes(void **state)
{
    (void)state;
    uint8_t data[132] = {0};
    const struct bytes head = {data, sizeof data};
    assert_null(nearest("IM0001", &head));
    memcpy(data + 128, "DICM", 4);
    assert_string_equal(nearest("IM0001", &head)->words, "a DICOM file");
}

static void lines_are_told_from_surfaces(void **state)
{
    (void)state;
    static const struct {
        const char *text;
        bool lines;
    } files[] = {
        {"# vtk DataFile Version 3.0\nx\nASCII\nDATASET POLYDATA\nPOINTS 2 float\n0 0 0 1 1 1\nLINES 1 3\n2 0 1\n",
         true},
        {"# vtk DataFile Version 3.0\nx\nASCII\nDATASET POLYDATA\nLINES 1 3\n2 0 1\nPOLYGONS 1 4\n3 0 1 2\n", false},
        {"# vtk DataFile Version 3.0\nx\nASCII\nDATASET POLYDATA\nLINES 1 3\n2 0 1\nTRIANGLE_STRIPS 1 4\n", false},
        {"# vtk DataFile Version 3.0\nx\nASCII\nDATASET POLYDATA\nPOLYGONS 1 4\n3 0 1 2\n", false},
        {"<VTKFile><Piece NumberOfLines=\"1\" NumberOfPolys=\"0\"/></VTKFile>", true},
        {"<VTKFile><Piece NumberOfLines=\"1\" NumberOfPolys=\"2\"/></VTKFile>", false},
        {"\nLINES 1\n", false},
    };
    for (size_t i = 0; i < sizeof files / sizeof files[0]; i++) {
        const struct bytes bytes = {(uint8_t *)files[i].text, strlen(files[i].text)};
        assert_int_equal(format_is_lines(&bytes), files[i].lines);
    }
}

static void write_text(const char *name, const char *text)
{
    assert_ok(conus_write_file(test_in(name), text, strlen(text)));
}

static void assert_message(conus_status status, const char *name, const char *message)
{
    assert_int_equal(status, CONUS_ERROR_DATA);
    if (!strstr(conus_message(), name) || !strstr(conus_message(), message) || strchr(conus_message(), '\n')) {
        fail_msg("not \"%s: %s\", but \"%s\"", name, message, conus_message());
    }
}

static void refuse_atlas(const char *name, const char *message)
{
    conus_atlas *atlas = NULL;
    assert_message(conus_atlas_load(&atlas, test_in(name), NULL), name, message);
    assert_null(atlas);
}

static void refuse_labels(const char *atlas_name, const char *name, const char *message)
{
    conus_atlas *atlas = NULL;
    char labels[512];
    snprintf(labels, sizeof labels, "%s", test_in(name));
    const conus_load_options options = {.labels = labels};
    assert_message(conus_atlas_load(&atlas, test_in(atlas_name), &options), name, message);
    assert_null(atlas);
}

static void write_volume(const char *name)
{
    struct nifti_builder file;
    const int64_t dim[3] = {2, 1, 1};
    nifti_begin(&file, 1, false, 2, dim);
    nifti_voxel(&file, 1);
    nifti_voxel(&file, 2);
    assert_ok(conus_write_file(test_in(name), file.bytes.data, file.bytes.size));
    buffer_finish(&file.bytes);
}

static const char atlas_needs[] = "needed is a labelled volume (NIfTI, MGH, NRRD, MetaImage, AFNI, TIFF, MINC, "
                                  "OME-Zarr), a surface, a folder of surfaces, "
                                  "a manifest (with the key \"conus_atlas\") or an FSL atlas XML";

static void each_place_says_what_it_takes(void **state)
{
    (void)state;
    conus_atlas *atlas = NULL;
    char message[512];
    test_folder("places");
    write_volume("v.nii");
    write_text("a.trk", "TRACK");
    write_text("a.mif", "mrtrix image\n");
    write_text("a.txt", "1 A\n2 B\n");
    write_text("a.md", "Read me first.\n");
    write_text("lh.annot", "\1\2\3\4\5");
    write_text("a.xml", "<atlas><type>Probabilistic</type></atlas>");
    write_text("spm.xml",
               "<atlas version=\"2.0\">\n<data><label><index>4</index><name>A</name></label></data></atlas>");
    snprintf(message, sizeof message, "this is an MRtrix image: convert it to NIfTI (mrconvert); %s", atlas_needs);
    refuse_atlas("a.mif", message);
    refuse_atlas("a.txt", "this is a label table: give it as --labels; needed is");
    refuse_atlas("lh.annot", "this is a FreeSurfer annotation: give it as --labels, and the surface as ATLAS; needed");
    refuse_atlas("a.md", "content: found plain text, \"Read me first..\"; needed is a labelled volume");
    refuse_atlas("spm.xml", "none of its 0 images is there");
    refuse_labels("v.nii", "v.nii",
                  "this is a volume: give it as ATLAS, --pathway or --context; needed is "
                  "a label table");
    refuse_labels("v.nii", "lh.annot",
                  "this is a FreeSurfer annotation: give it as --labels, and the surface as ATLAS");
    refuse_labels("v.nii", "a.md", "not a label table of a known format (known: ");
    assert_ok(conus_atlas_load(&atlas, test_in("v.nii"), NULL));
    assert_message(conus_atlas_add_pathway(atlas, test_in("a.trk"), NULL), "a.trk",
                   "needed is a volume (NIfTI, MGH, NRRD, MetaImage, AFNI, TIFF, MINC or OME-Zarr)");
    assert_message(
        conus_atlas_add_pathway(atlas, test_in("a.xml"), NULL), "a.xml",
        "this is an FSL atlas XML: 'conus manifest FOLDER' makes pathways of its volumes; needed is a volume");
    assert_message(conus_atlas_set_context(atlas, test_in("a.txt"), NULL), "a.txt", "needed is a volume (NIfTI, MGH");
    conus_atlas_destroy(atlas);
    write_text("m.atlas.json", "{\"conus_atlas\": 1, \"parcellation\": \"a.mif\"}");
    refuse_atlas(
        "m.atlas.json",
        "a.mif: this is an MRtrix image: convert it to NIfTI (mrconvert); needed is a labelled "
        "volume (NIfTI, MGH, NRRD, MetaImage, AFNI, TIFF, MINC or OME-Zarr) or an FSL atlas XML of type Label");
}

/* FreeSurfer stores values of vertices as volumes of N x 1 x 1. */
static void rows_of_vertices_are_no_volumes(void **state)
{
    (void)state;
    uint8_t file[284 + 642] = {0, 0, 0, 1, 0, 0, 2, 0x82, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
    test_folder("rows");
    memset(file + 284, 1, 642);
    assert_ok(conus_write_file(test_in("lh.aparc.mgh"), file, sizeof file));
    refuse_atlas("lh.aparc.mgh", "642 x 1 x 1 values of the vertices of a surface, not a volume");
    write_text("s.gii", "<GIFTI Version=\"1.0\" NumberOfDataArrays=\"0\"></GIFTI>");
    refuse_atlas("s.gii", "no POINTSET array: not a surface");
    conus_atlas *atlas = NULL;
    file[7] = 0x81; /* 641 */
    assert_ok(conus_write_file(test_in("row.mgh"), file, sizeof file - 1));
    assert_ok(conus_atlas_load(&atlas, test_in("row.mgh"), NULL));
    conus_atlas_destroy(atlas);
}

TEST_GROUP(formats)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_kind_is_detected_from_content_and_ending),
        cmocka_unit_test(a_dicom_file_has_its_mark_behind_128_bytes),
        cmocka_unit_test(lines_are_told_from_surfaces),
        cmocka_unit_test(each_place_says_what_it_takes),
        cmocka_unit_test(rows_of_vertices_are_no_volumes),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
