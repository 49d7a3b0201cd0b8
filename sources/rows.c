/* SPDX-License-Identifier: BSD-3-Clause */
/* The table of formats: how a file is known, what it may be given as, and what a message advises where that is not what
 * is needed. */
#include "sources/format.h"

#include "base/child/hdf5.h"
#include "base/formats/matlab.h"
#include "base/formats/xml.h"
#include "base/formats/zip.h"
#include "sources/signatures.h"

#include <stdio.h>
#include <string.h>
#include <strings.h>

#define STREAMLINES "give it as --streamlines, or a volume of its density as --pathway"
#define FOREIGN "convert it to NIfTI"
#define TIFF "a stack of TIFF pages"
#define VOLUME "give it as ATLAS, --pathway or --context"
#define SEPARATE "'wb_command -cifti-separate' writes its voxels as a volume"
#define CIFTI_1 "convert it to CIFTI-2: wb_command -file-convert -cifti-version-convert IN 2 OUT"
#define PARCELS "conus reads the .dlabel.nii of its parcels, as ATLAS"

static bool is_dicom(const uint8_t *data, size_t size)
{
    enum { PREAMBLE = 128 };
    return size >= PREAMBLE + 4 && memcmp(data + PREAMBLE, "DICM", 4) == 0;
}

/* CIFTI-1 calls labels by the code of connections; which version it is stands in the XML only. */
static bool is_first_cifti(const struct file_head *head)
{
    return head->intent && text_mentions(head->bytes, "<CIFTI Version=\"1");
}

static bool is_matrix(const struct file_head *head)
{
    return head->intent;
}

static bool has_lines_only(const struct file_head *head)
{
    return head->readable && text_mentions(head->start, "NumberOfPolys=\"0\"") &&
           !text_mentions(head->start, "NumberOfLines=\"0\"");
}

/* FreeSurfer's curvature as text: "000 x y z value", counting. */
static bool is_vertex_values(const struct file_head *head)
{
    struct text rest = head->start;
    struct text line;
    bool is = head->readable;
    for (size_t i = 0; is && i < 3; i++) {
        struct text word;
        uint64_t index = 1;
        double number;
        is = text_line(&rest, &line) && text_word(&line, &word) && word.size >= 3 && text_to_uint(word, 2, &index) &&
             index == i;
        for (size_t k = 0; is && k < 4; k++) {
            is = text_word(&line, &word) && text_to_double(word, &number);
        }
        is = is && !text_trim(line).size;
    }
    return is;
}

static bool is_web_page(const struct file_head *head)
{
    return head->readable && text_equal_ignoring_case(head->root, "html");
}

static bool has_file(const char *folder, const char *name)
{
    char path[4096];
    int size = snprintf(path, sizeof path, "%s/%s", folder, name);
    return size < (int)sizeof path && file_exists(path);
}

static bool is_matlab(const struct file_head *head)
{
    return matlab_is(head->bytes);
}

static bool is_zarr(const struct file_head *head)
{
    return has_file(head->path, "zarr.json") || has_file(head->path, ".zarray") || has_file(head->path, ".zattrs");
}

static bool has_trx_header(const struct file_head *head)
{
    return has_file(head->path, "header.json");
}

/* Whether the name ends in one of the endings, with '/' between them, perhaps with .gz behind it. */
static bool ends_with(const char *path, const char *endings)
{
    struct text rest = text_from(endings);
    struct text ending;
    size_t length = strlen(path);
    bool ends = false;
    if (length > 3 && strcasecmp(path + length - 3, ".gz") == 0) {
        length -= 3;
    }
    for (bool more = true; !ends && text_field(&rest, '/', &more, &ending);) {
        ends = length > ending.size && strncasecmp(path + length - ending.size, ending.data, ending.size) == 0;
    }
    return ends;
}

/* MZ3, whose mark is also that of programs for Windows. */
static bool is_no_program(const struct file_head *head)
{
    return head->path && ends_with(head->path, ".vtk/.vtp/.ply/.off/.mz3");
}

static bool is_text(const struct file_head *head)
{
    return head->readable;
}

static bool is_no_text(const struct file_head *head)
{
    return !head->readable;
}

/* In the order in which they are asked. */
static const struct format formats[] = {
#define BYTES(text)                                                                                                    \
    {                                                                                                                  \
        (text), sizeof(text) - 1                                                                                       \
    }
    {.magic = BYTES("conus pack\0"),
     .words = "a pack",
     .way = "give it as ATLAS with the ending .conus; conus pack packs an atlas and what is added to it"},
    {.id = FORMAT_TRK,
     .roles = ROLE_TRACTS,
     .is_hidden = true,
     .magic = BYTES("TRACK")}, /* also where a byte is wrong */
    {.magic = BYTES("TRACK\0"), .words = "a TrackVis tractogram", .way = STREAMLINES},
    {.id = FORMAT_TCK, .roles = ROLE_TRACTS, .is_hidden = true, .has = tck_is},
    {.magic = BYTES("mrtrix tracks"), .words = "an MRtrix tractogram", .way = STREAMLINES},
    {.magic = BYTES("mrtrix image"), .words = "an MRtrix image", .way = FOREIGN " (mrconvert)"},
    {.magic = BYTES("CDF\1"), .words = "a MINC-1 volume", .way = "convert it to MINC 2 (mincconvert -2)"},
    {.magic = BYTES("CDF\2"), .words = "a MINC-1 volume", .way = "convert it to MINC 2 (mincconvert -2)"},
    {.id = FORMAT_MATLAB, .roles = ROLE_POSES, .is_hidden = true, .is = is_matlab},
    {.magic = BYTES("MATLAB 7.3"), .words = "a MATLAB file of version 7.3", .way = FOREIGN},
    {.id = FORMAT_ZARR, .roles = ROLE_VOLUME, .is_hidden = true, .is_folder = true, .is = is_zarr},
    {.id = FORMAT_HDF5,
     .roles = ROLE_VOLUME | ROLE_TRANSFORM | ROLE_REGION | ROLE_POSES,
     .has = hdf5_is,
     .words = "an HDF5 file (a MINC-2 volume, say)",
     .way = "give a volume as ATLAS, --pathway or --context"},
    {.id = FORMAT_TT, .roles = ROLE_TRACTS, .is_hidden = true, .has = tt_is},
    {.id = FORMAT_TRX, .roles = ROLE_TRACTS, .is_hidden = true, .is_folder = true, .is = has_trx_header},
    {.id = FORMAT_TRX, .roles = ROLE_TRACTS, .is_hidden = true, .has = zip_is}, /* other archives, too */
    {.id = FORMAT_MZ3, .roles = ROLE_SURFACE, .is_hidden = true, .magic = BYTES("MZ"), .is = is_no_program},
    {.magic = BYTES("MZ"), .words = "an MZ3 surface", .way = "give it as ATLAS with the ending .mz3"},
    {.id = FORMAT_VTK,
     .roles = ROLE_SURFACE | ROLE_TRACTS,
     .magic = BYTES("# vtk DataFile"),
     .words = "a VTK file",
     .way = "give it as ATLAS, or its lines as --streamlines"},
    {.id = FORMAT_PLY,
     .roles = ROLE_SURFACE,
     .magic = BYTES("ply\n"),
     .words = "a PLY surface",
     .way = "give it as ATLAS"},
    {.id = FORMAT_PLY,
     .roles = ROLE_SURFACE,
     .magic = BYTES("ply\r"),
     .words = "a PLY surface",
     .way = "give it as ATLAS"},
    {.magic = BYTES("solid "), .words = "an STL surface", .way = "give it as ATLAS with the ending .stl"},
    {.id = FORMAT_FREESURFER_LABEL,
     .roles = ROLE_VERTEX_LABELS,
     .magic = BYTES("#!ascii label"),
     .words = "a FreeSurfer label of vertices",
     .way = "give it as --labels, and its surface as ATLAS"},
    {.magic = BYTES("/NumWaves"), .words = "a design matrix of FSL's statistics"},
    {.magic = BYTES("/ContrastName"), .words = "contrasts of FSL's statistics"},
    {.magic = BYTES("#!ascii version"), .words = "a FreeSurfer surface as text", .way = "convert it (mris_convert)"},
    {.magic = BYTES("OFF"), .words = "an OFF surface", .way = "give it as ATLAS with the ending .off"},
    {.magic = BYTES("# OFF"), .words = "an OFF surface", .way = "give it as ATLAS with the ending .off"},
    {.magic = BYTES("\x89PNG\r\n\x1a\n"), .words = "a PNG picture"},
    {.magic = BYTES("\xff\xd8\xff"), .words = "a JPEG picture"},
    {.magic = BYTES("\x76\x2f\x31\x01"), .words = "an OpenEXR picture"},
    {.id = FORMAT_TIFF, .roles = ROLE_VOLUME, .magic = BYTES("II*\0"), .words = TIFF, .way = VOLUME},
    {.id = FORMAT_TIFF, .roles = ROLE_VOLUME, .magic = BYTES("MM\0*"), .words = TIFF, .way = VOLUME},
    {.id = FORMAT_TIFF, .roles = ROLE_VOLUME, .magic = BYTES("II+\0"), .words = TIFF, .way = VOLUME},
    {.id = FORMAT_TIFF, .roles = ROLE_VOLUME, .magic = BYTES("MM\0+"), .words = TIFF, .way = VOLUME},
    {.magic = BYTES("GIF8"), .words = "a GIF picture"},
    {.magic = BYTES("%PDF-"), .words = "a PDF document"},
    {.magic = BYTES("PK\3\4"), .ending = ".trx", .words = "a TRX tractogram", .way = STREAMLINES},
    {.magic = BYTES("PK\3\4"),
     .mentions = "[Content_Types].xml",
     .words = "a document of Office (an Excel workbook, say)",
     .way = "save its table as CSV"},
    {.magic = BYTES("PK\3\4"),
     .words = "a ZIP archive",
     .way = "unpack it, or give it as --streamlines if it is a TRX tractogram"},
    {.magic = BYTES("Rar!"), .words = "a RAR archive", .way = "unpack it"},
    {.magic = BYTES("7z\xbc\xaf\x27\x1c"), .words = "a 7z archive", .way = "unpack it"},
    {.magic = BYTES("BZh"), .words = "a file packed with bzip2", .way = "unpack it, or pack it with gzip"},
    {.magic = BYTES("\xfd\x37zXZ"), .words = "a file packed with xz", .way = "unpack it, or pack it with gzip"},
    {.magic = BYTES("\x28\xb5\x2f\xfd"), .words = "a file packed with zstd", .way = "unpack it, or pack it with gzip"},
    {.magic = BYTES("MATLAB 5.0"), .words = "a MATLAB file", .way = FOREIGN},
    {.magic = BYTES("\x93NUMPY"), .words = "a NumPy array", .way = FOREIGN " (nibabel)"},
    {.magic = BYTES("\x7f"
                    "ELF"),
     .words = "a program"},
    {.magic = BYTES("version https://git-lfs"),
     .words = "a Git LFS pointer, not the file itself",
     .way = "fetch it (git lfs pull)"},
    {.has = is_dicom, .words = "a DICOM file", .way = "convert its series to NIfTI (dcm2niix)"},
    {.has = mgh_is_of_vertices, .words = "values of the vertices of a surface"},
    {.id = FORMAT_CIFTI,
     .roles = ROLE_VERTEX_LABELS | ROLE_SCENE,
     .intent = NIFTI_DENSE_LABELS,
     .is = is_first_cifti,
     .words = "a CIFTI-1 file",
     .way = CIFTI_1},
    {.is = is_first_cifti, .words = "a CIFTI-1 file", .way = CIFTI_1},
    {.intent = 3000, .words = "a CIFTI matrix without a kind (a .plabel.nii, say)", .way = PARCELS},
    {.intent = 3001, .words = "a CIFTI matrix of connections (.dconn.nii)", .way = "conus has no use for connections"},
    {.intent = 3002, .words = "a CIFTI matrix of time series (.dtseries.nii)", .way = SEPARATE},
    {.intent = 3003, .words = "a CIFTI matrix of connections of parcels (.pconn.nii)", .way = PARCELS},
    {.intent = 3004, .words = "a CIFTI matrix of time series of parcels (.ptseries.nii)", .way = PARCELS},
    {.intent = 3006, .words = "a CIFTI matrix of values (.dscalar.nii)", .way = SEPARATE},
    {.id = FORMAT_CIFTI,
     .roles = ROLE_VERTEX_LABELS | ROLE_SCENE,
     .intent = NIFTI_DENSE_LABELS,
     .words = "a CIFTI matrix of labels (.dlabel.nii)",
     .way = "give it as ATLAS, as --labels of a surface, or in a manifest as parcellation or vertex_labels"},
    {.intent = 3008, .words = "a CIFTI matrix of values of parcels (.pscalar.nii)", .way = PARCELS},
    {.intent = 3009, .words = "a CIFTI matrix of connections of parcels (.pdconn.nii)", .way = PARCELS},
    {.intent = 3010, .words = "a CIFTI matrix of connections of parcels (.dpconn.nii)", .way = PARCELS},
    {.intent = 3011, .words = "a CIFTI matrix of connections of parcels (.pconnseries.nii)", .way = PARCELS},
    {.intent = 3012, .words = "a CIFTI matrix of connections of parcels (.pconnscalar.nii)", .way = PARCELS},
    {.is = is_matrix, .words = "a CIFTI matrix of an unknown kind", .way = PARCELS},
    {.id = FORMAT_NIFTI, .roles = ROLE_VOLUME, .has = nifti_has_magic, .words = "a volume", .way = VOLUME},
    {.id = FORMAT_NIFTI,
     .roles = ROLE_VOLUME,
     .is_hidden = true,
     .has = nifti_is}, /* ANALYZE has no more than a size */
    {.id = FORMAT_MGH, .roles = ROLE_VOLUME, .has = mgh_is, .words = "a volume", .way = VOLUME},
    {.id = FORMAT_NRRD, .roles = ROLE_VOLUME, .has = nrrd_is, .words = "a volume", .way = VOLUME},
    {.id = FORMAT_METAIMAGE, .roles = ROLE_VOLUME, .has = metaimage_is, .words = "a volume", .way = VOLUME},
    {.id = FORMAT_AFNI, .roles = ROLE_VOLUME, .has = afni_is, .words = "a volume", .way = VOLUME},
    {.id = FORMAT_FREESURFER,
     .roles = ROLE_SURFACE | ROLE_VERTEX_LABELS,
     .has = freesurfer_is_curvature,
     .words = "values of the vertices of a surface"},
    {.id = FORMAT_FREESURFER,
     .roles = ROLE_SURFACE | ROLE_VERTEX_LABELS,
     .has = freesurfer_is_surface,
     .words = "a surface",
     .way = "give it as ATLAS"},
    {.id = FORMAT_GIFTI,
     .roles = ROLE_SURFACE | ROLE_VERTEX_LABELS,
     .root = "GIFTI",
     .mentions = "NIFTI_INTENT_POINTSET",
     .words = "a surface",
     .way = "give it as ATLAS"},
    {.id = FORMAT_GIFTI,
     .roles = ROLE_SURFACE | ROLE_VERTEX_LABELS,
     .root = "GIFTI",
     .mentions = "NIFTI_INTENT_LABEL",
     .words = "labels of the vertices of a surface",
     .way = "give it as --labels, and the surface as ATLAS"},
    {.id = FORMAT_GIFTI,
     .roles = ROLE_SURFACE | ROLE_VERTEX_LABELS,
     .root = "GIFTI",
     .words = "values of the vertices of a surface"},
    {.id = FORMAT_VTP, .roles = ROLE_SURFACE | ROLE_TRACTS, .is_hidden = true, .root = "VTKFile"},
    {.root = "VTKFile", .is = has_lines_only, .words = "a VTK file of lines", .way = STREAMLINES},
    {.root = "VTKFile", .is = is_text, .words = "a surface", .way = "give it as ATLAS"},
    {.id = FORMAT_ATLAS_XML,
     .roles = ROLE_SCENE,
     .root = "atlas",
     .mentions = "<index>",
     .words = "an SPM or CAT12 atlas XML",
     .way = "give it as ATLAS or --labels"},
    {.id = FORMAT_ATLAS_XML,
     .roles = ROLE_SCENE,
     .root = "atlas",
     .mentions = ">Label</type>",
     .words = "an FSL atlas XML of type Label",
     .way = "give it as ATLAS or --labels"},
    {.id = FORMAT_ATLAS_XML,
     .roles = ROLE_SCENE,
     .root = "atlas",
     .words = "an FSL atlas XML",
     .way = "'conus manifest FOLDER' makes pathways of its volumes"},
    {.is = is_web_page, .words = "a web page"},
    {.begins = "<", .is = is_text, .words = "XML of another kind", .certainty = KIND_VAGUE},
    {.id = FORMAT_MANIFEST, .roles = ROLE_SCENE, .is_hidden = true, .begins = "{"},
    {.id = FORMAT_MANIFEST,
     .begins = "{",
     .mentions = "\"conus_atlas\"",
     .is = is_text,
     .words = "a manifest",
     .way = "give it as ATLAS"},
    {.begins = "{[", .is = is_text, .words = "JSON of another kind", .certainty = KIND_VAGUE},
    {.ending = ".annot",
     .is = is_no_text,
     .words = "a FreeSurfer annotation",
     .way = "give it as --labels, and the surface as ATLAS",
     .certainty = KIND_BY_NAME},
    {.ending = ".BRIK",
     .is = is_no_text,
     .words = "the voxels of an AFNI data set",
     .way = "give its .HEAD as ATLAS, --pathway or --context",
     .certainty = KIND_BY_NAME},
    {.ending = ".dcm",
     .is = is_no_text,
     .words = "a DICOM file",
     .way = "convert its series to NIfTI (dcm2niix)",
     .certainty = KIND_BY_NAME},
    {.ending = ".trk", .is = is_no_text, .words = "a tractogram", .way = STREAMLINES, .certainty = KIND_BY_NAME},
    {.ending = ".tck", .is = is_no_text, .words = "a tractogram", .way = STREAMLINES, .certainty = KIND_BY_NAME},
    {.ending = ".tt", .is = is_no_text, .words = "a tractogram", .way = STREAMLINES, .certainty = KIND_BY_NAME},
    {.ending = ".stl",
     .is = is_no_text,
     .words = "an STL surface",
     .way = "give it as ATLAS",
     .certainty = KIND_BY_NAME},
    {.ending = ".obj", .words = "an OBJ surface", .way = "give it as ATLAS", .certainty = KIND_BY_NAME},
    {.id = FORMAT_STL, .roles = ROLE_SURFACE | ROLE_VERTEX_LABELS, .is_hidden = true, .ending = ".stl"},
    {.id = FORMAT_OFF, .roles = ROLE_SURFACE | ROLE_VERTEX_LABELS, .is_hidden = true, .ending = ".off"},
    {.id = FORMAT_OBJ, .roles = ROLE_SURFACE | ROLE_VERTEX_LABELS, .is_hidden = true, .ending = ".obj"},
    {.roles = ROLE_SURFACE | ROLE_VERTEX_LABELS,
     .is_hidden = true,
     .ending = ".vtk/.vtp/.ply/.mz3"}, /* whose reader says what it is */
    {.ending = ".lut",
     .is = is_no_text,
     .words = "a table of colours",
     .way = "put it beside the volume as X.lut",
     .certainty = KIND_BY_NAME},
    {.is = is_vertex_values, .words = "values of the vertices of a surface, as text"},
    {.is = is_text, .words = "plain text", .certainty = KIND_VAGUE},
#undef BYTES
};

static bool matches(const struct format *row, const struct file_head *head)
{
    const struct text bytes = head->bytes;
    return row->is_folder == head->is_folder &&
           (!row->magic.size ||
            (bytes.size >= row->magic.size && memcmp(bytes.data, row->magic.data, row->magic.size) == 0)) &&
           (!row->intent || row->intent == head->intent) && (!row->root || text_equal(head->root, row->root)) &&
           (!row->begins || (head->start.size && head->start.data[0] && strchr(row->begins, head->start.data[0]))) &&
           (!row->mentions || text_mentions(head->start, row->mentions)) &&
           (!row->has || row->has((const uint8_t *)bytes.data, bytes.size)) && (!row->is || row->is(head)) &&
           (!row->ending || (head->path && ends_with(head->path, row->ending)));
}

const struct format *format_find(const struct file_head *head, unsigned roles)
{
    for (size_t i = 0; i < sizeof formats / sizeof formats[0]; i++) {
        const struct format *row = &formats[i];
        if ((roles ? (row->roles & roles) != 0 : !row->is_hidden) && matches(row, head)) {
            return row;
        }
    }
    return NULL;
}

static struct file_head describe_head(const char *path, const struct bytes *bytes)
{
    struct text text = text_from_bytes(bytes->data, bytes->size);
    struct file_head head = {.bytes = {bytes->size ? (const char *)bytes->data : "", bytes->size},
                             .path = path,
                             .readable = text_is_readable(text),
                             .start = text_trim(text),
                             .intent = nifti_matrix_intent(bytes->data, bytes->size)};
    head.root = xml_root(head.start);
    return head;
}

struct file_head head_of(const char *path, const struct bytes *bytes)
{
    return describe_head(path, &(struct bytes){bytes->data, bytes->size < HEAD_SIZE ? bytes->size : HEAD_SIZE});
}

enum format_id format_id_of(const struct bytes *bytes, unsigned roles)
{
    const struct file_head head = head_of(NULL, bytes);
    const struct format *format = format_find(&head, roles);
    return format ? format->id : FORMAT_OTHER;
}

bool format_is_lines(const struct bytes *bytes)
{
    struct text text = {(const char *)bytes->data, bytes->size};
    if (text_starts(text, "# vtk DataFile")) {
        return text_mentions(text, "\nLINES ") && !text_mentions(text, "\nPOLYGONS ") &&
               !text_mentions(text, "\nTRIANGLE_STRIPS ");
    }
    struct file_head head = describe_head(NULL, bytes);
    return text_equal(head.root, "VTKFile") && has_lines_only(&head);
}

/* The first bytes as a message shows them. */
struct sample {
    char text[17];
};

static struct sample sample_of(const struct bytes *head)
{
    struct sample sample = {0};
    for (size_t i = 0; i < head->size && i < sizeof sample.text - 1; i++) {
        bool printable = head->data[i] >= 0x20 && head->data[i] < 0x7f;
        sample.text[i] = printable ? (char)head->data[i] : '.';
    }
    return sample;
}

conus_status format_refuse(const struct format *format, const struct bytes *stored, const char *needed)
{
    if (!stored->size) {
        return fail(CONUS_ERROR_DATA, "content: the file is empty; needed is %s", needed);
    }
    if (!format || strcmp(format->words, "plain text") == 0) {
        return fail(CONUS_ERROR_DATA, "content: found %s\"%s\"; needed is %s", format ? "plain text, " : "",
                    sample_of(stored).text, needed);
    }
    return fail(CONUS_ERROR_DATA, "this is %s%s%s; needed is %s", format->words, format->way ? ": " : "",
                format->way ? format->way : "", needed);
}
