/* SPDX-License-Identifier: BSD-3-Clause */
/* The table of formats: how a file is known, what reads it, and what a message advises where it is not the needed one.
 */
#include "loaders/formats/formats.h"

#include "base/child/hdf5.h"
#include "base/formats/gzip.h"
#include "base/formats/xml.h"
#include "base/text.h"
#include "loaders/formats/signatures.h"

#include <string.h>
#include <strings.h>

#define STREAMLINES "give it as --streamlines, or a volume of its density as --pathway"
#define FOREIGN "convert it to NIfTI"
#define TIFF "a stack of TIFF pages"
#define VOLUME "give it as ATLAS, --pathway or --context"
#define SEPARATE "'wb_command -cifti-separate' writes its voxels as a volume"
#define CIFTI_1 "convert it to CIFTI-2: wb_command -file-convert -cifti-version-convert IN 2 OUT"
#define PARCELS "conus reads the .dlabel.nii of its parcels, as ATLAS"

/* The first bytes of a file, and what the rows of the table ask of them. */
struct head {
    const struct bytes *bytes;
    const char *path;  /* may be NULL */
    bool readable;     /* they are text */
    struct text start; /* without white space at their ends */
    struct text root;  /* name of the outermost element of XML, else empty */
    int intent;        /* of a CIFTI-2 matrix, else 0 */
};

static bool is_dicom(const uint8_t *data, size_t size)
{
    enum { PREAMBLE = 128 };
    return size >= PREAMBLE + 4 && memcmp(data + PREAMBLE, "DICM", 4) == 0;
}

static bool is_volume(const uint8_t *data, size_t size)
{
    return nifti_has_magic(data, size) || mgh_is(data, size) || volume_text_is(&(struct bytes){(uint8_t *)data, size});
}

/* CIFTI-1 calls labels by the code of connections; which version it is stands in the XML only. */
static bool is_first_cifti(const struct head *head)
{
    return head->intent &&
           text_mentions((struct text){(const char *)head->bytes->data, head->bytes->size}, "<CIFTI Version=\"1");
}

static bool is_matrix(const struct head *head)
{
    return head->intent;
}

static bool has_lines_only(const struct head *head)
{
    return head->readable && text_mentions(head->start, "NumberOfPolys=\"0\"") &&
           !text_mentions(head->start, "NumberOfLines=\"0\"");
}

/* FreeSurfer's curvature as text: "000 x y z value", counting. */
static bool is_vertex_values(const struct head *head)
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

static bool is_web_page(const struct head *head)
{
    return head->readable && text_equal_ignoring_case(head->root, "html");
}

static bool is_text(const struct head *head)
{
    return head->readable;
}

static bool is_no_text(const struct head *head)
{
    return !head->readable;
}

/* The first row whose conditions all hold decides. */
static const struct format {
    struct {
        const char *data;
        size_t size;
    } magic;              /* with which the file begins */
    int intent;           /* of a CIFTI-2 matrix */
    const char *root;     /* the outermost element of XML */
    const char *begins;   /* the text begins with one of these */
    const char *mentions; /* words in it */
    bool (*has)(const uint8_t *data, size_t size);
    bool (*is)(const struct head *head);
    const char *ending; /* of the name, perhaps with .gz behind it */
    struct file_kind kind;
} formats[] = {
#define BYTES(text)                                                                                                    \
    {                                                                                                                  \
        (text), sizeof(text) - 1                                                                                       \
    }
    {.magic = BYTES("conus pack\0"),
     .kind = {"a pack", "give it as ATLAS with the ending .conus; conus pack packs an atlas and what is added to it"}},
    {.magic = BYTES("TRACK\0"), .kind = {"a TrackVis tractogram", STREAMLINES}},
    {.magic = BYTES("mrtrix tracks"), .kind = {"an MRtrix tractogram", STREAMLINES}},
    {.magic = BYTES("mrtrix image"), .kind = {"an MRtrix image", FOREIGN " (mrconvert)"}},
    {.magic = BYTES("CDF\1"), .kind = {"a MINC-1 volume", "convert it to MINC 2 (mincconvert -2)"}},
    {.magic = BYTES("CDF\2"), .kind = {"a MINC-1 volume", "convert it to MINC 2 (mincconvert -2)"}},
    {.magic = BYTES("MATLAB 7.3"), .kind = {"a MATLAB file of version 7.3", FOREIGN}},
    {.has = hdf5_is, .kind = {"an HDF5 file (a MINC-2 volume, say)", "give a volume as ATLAS, --pathway or --context"}},
    {.magic = BYTES("MZ"), .kind = {"an MZ3 surface", "give it as ATLAS with the ending .mz3"}},
    {.magic = BYTES("# vtk DataFile"),
     .kind = {"a VTK file", "give it as ATLAS with the ending .vtk, or its lines as --streamlines"}},
    {.magic = BYTES("ply\n"), .kind = {"a PLY surface", "give it as ATLAS with the ending .ply"}},
    {.magic = BYTES("ply\r\n"), .kind = {"a PLY surface", "give it as ATLAS with the ending .ply"}},
    {.magic = BYTES("solid "), .kind = {"an STL surface", "give it as ATLAS with the ending .stl"}},
    {.magic = BYTES("#!ascii label"),
     .kind = {"a FreeSurfer label of vertices", "give it as --labels, and its surface as ATLAS"}},
    {.magic = BYTES("/NumWaves"), .kind = {"a design matrix of FSL's statistics", NULL}},
    {.magic = BYTES("/ContrastName"), .kind = {"contrasts of FSL's statistics", NULL}},
    {.magic = BYTES("#!ascii version"), .kind = {"a FreeSurfer surface as text", "convert it (mris_convert)"}},
    {.magic = BYTES("OFF"), .kind = {"an OFF surface", "give it as ATLAS with the ending .off"}},
    {.magic = BYTES("# OFF"), .kind = {"an OFF surface", "give it as ATLAS with the ending .off"}},
    {.magic = BYTES("\x89PNG\r\n\x1a\n"), .kind = {"a PNG picture", NULL}},
    {.magic = BYTES("\xff\xd8\xff"), .kind = {"a JPEG picture", NULL}},
    {.magic = BYTES("\x76\x2f\x31\x01"), .kind = {"an OpenEXR picture", NULL}},
    {.magic = BYTES("II*\0"), .kind = {TIFF, VOLUME}},
    {.magic = BYTES("MM\0*"), .kind = {TIFF, VOLUME}},
    {.magic = BYTES("II+\0"), .kind = {TIFF, VOLUME}},
    {.magic = BYTES("MM\0+"), .kind = {TIFF, VOLUME}},
    {.magic = BYTES("GIF8"), .kind = {"a GIF picture", NULL}},
    {.magic = BYTES("%PDF-"), .kind = {"a PDF document", NULL}},
    {.magic = BYTES("PK\3\4"), .ending = ".trx", .kind = {"a TRX tractogram", STREAMLINES}},
    {.magic = BYTES("PK\3\4"),
     .mentions = "[Content_Types].xml",
     .kind = {"a document of Office (an Excel workbook, say)", "save its table as CSV"}},
    {.magic = BYTES("PK\3\4"),
     .kind = {"a ZIP archive", "unpack it, or give it as --streamlines if it is a TRX tractogram"}},
    {.magic = BYTES("Rar!"), .kind = {"a RAR archive", "unpack it"}},
    {.magic = BYTES("7z\xbc\xaf\x27\x1c"), .kind = {"a 7z archive", "unpack it"}},
    {.magic = BYTES("BZh"), .kind = {"a file packed with bzip2", "unpack it, or pack it with gzip"}},
    {.magic = BYTES("\xfd\x37zXZ"), .kind = {"a file packed with xz", "unpack it, or pack it with gzip"}},
    {.magic = BYTES("\x28\xb5\x2f\xfd"), .kind = {"a file packed with zstd", "unpack it, or pack it with gzip"}},
    {.magic = BYTES("MATLAB 5.0"), .kind = {"a MATLAB file", FOREIGN}},
    {.magic = BYTES("\x93NUMPY"), .kind = {"a NumPy array", FOREIGN " (nibabel)"}},
    {.magic = BYTES("\x7f"
                    "ELF"),
     .kind = {"a program", NULL}},
    {.magic = BYTES("version https://git-lfs"),
     .kind = {"a Git LFS pointer, not the file itself", "fetch it (git lfs pull)"}},
    {.has = is_dicom, .kind = {"a DICOM file", "convert its series to NIfTI (dcm2niix)"}},
    {.has = mgh_is_of_vertices, .kind = {"values of the vertices of a surface", NULL}},
    {.intent = NIFTI_DENSE_LABELS, .is = is_first_cifti, .kind = {"a CIFTI-1 file", CIFTI_1, READER_CIFTI}},
    {.is = is_first_cifti, .kind = {"a CIFTI-1 file", CIFTI_1}},
    {.intent = 3000, .kind = {"a CIFTI matrix without a kind (a .plabel.nii, say)", PARCELS}},
    {.intent = 3001, .kind = {"a CIFTI matrix of connections (.dconn.nii)", "conus has no use for connections"}},
    {.intent = 3002, .kind = {"a CIFTI matrix of time series (.dtseries.nii)", SEPARATE}},
    {.intent = 3003, .kind = {"a CIFTI matrix of connections of parcels (.pconn.nii)", PARCELS}},
    {.intent = 3004, .kind = {"a CIFTI matrix of time series of parcels (.ptseries.nii)", PARCELS}},
    {.intent = 3006, .kind = {"a CIFTI matrix of values (.dscalar.nii)", SEPARATE}},
    {.intent = NIFTI_DENSE_LABELS,
     .kind = {"a CIFTI matrix of labels (.dlabel.nii)",
              "give it as ATLAS, as --labels of a surface, or in a manifest as parcellation or vertex_labels",
              READER_CIFTI}},
    {.intent = 3008, .kind = {"a CIFTI matrix of values of parcels (.pscalar.nii)", PARCELS}},
    {.intent = 3009, .kind = {"a CIFTI matrix of connections of parcels (.pdconn.nii)", PARCELS}},
    {.intent = 3010, .kind = {"a CIFTI matrix of connections of parcels (.dpconn.nii)", PARCELS}},
    {.intent = 3011, .kind = {"a CIFTI matrix of connections of parcels (.pconnseries.nii)", PARCELS}},
    {.intent = 3012, .kind = {"a CIFTI matrix of connections of parcels (.pconnscalar.nii)", PARCELS}},
    {.is = is_matrix, .kind = {"a CIFTI matrix of an unknown kind", PARCELS}},
    {.has = is_volume, .kind = {"a volume", VOLUME}},
    {.has = freesurfer_is_curvature, .kind = {"values of the vertices of a surface", NULL, READER_SURFACE}},
    {.has = freesurfer_is_surface, .kind = {"a surface", "give it as ATLAS", READER_SURFACE}},
    {.root = "GIFTI", .mentions = "NIFTI_INTENT_POINTSET", .kind = {"a surface", "give it as ATLAS", READER_SURFACE}},
    {.root = "GIFTI",
     .mentions = "NIFTI_INTENT_LABEL",
     .kind = {"labels of the vertices of a surface", "give it as --labels, and the surface as ATLAS", READER_SURFACE}},
    {.root = "GIFTI", .kind = {"values of the vertices of a surface", NULL, READER_SURFACE}},
    {.root = "VTKFile", .is = has_lines_only, .kind = {"a VTK file of lines", STREAMLINES}},
    {.root = "VTKFile", .is = is_text, .kind = {"a surface", "give it as ATLAS"}},
    {.root = "atlas",
     .mentions = "<index>",
     .kind = {"an SPM or CAT12 atlas XML", "give it as ATLAS or --labels", READER_ATLAS_XML}},
    {.root = "atlas",
     .mentions = ">Label</type>",
     .kind = {"an FSL atlas XML of type Label", "give it as ATLAS or --labels", READER_ATLAS_XML}},
    {.root = "atlas",
     .kind = {"an FSL atlas XML", "'conus manifest FOLDER' makes pathways of its volumes", READER_ATLAS_XML}},
    {.is = is_web_page, .kind = {"a web page", NULL}},
    {.begins = "<", .is = is_text, .kind = {"XML of another kind", NULL, .certainty = KIND_VAGUE}},
    {.begins = "{",
     .mentions = "\"conus_atlas\"",
     .is = is_text,
     .kind = {"a manifest", "give it as ATLAS", READER_MANIFEST}},
    {.begins = "{[", .is = is_text, .kind = {"JSON of another kind", NULL, .certainty = KIND_VAGUE}},
    {.ending = ".annot",
     .is = is_no_text,
     .kind = {"a FreeSurfer annotation", "give it as --labels, and the surface as ATLAS", .certainty = KIND_BY_NAME}},
    {.ending = ".BRIK",
     .is = is_no_text,
     .kind = {"the voxels of an AFNI data set", "give its .HEAD as ATLAS, --pathway or --context",
              .certainty = KIND_BY_NAME}},
    {.ending = ".dcm",
     .is = is_no_text,
     .kind = {"a DICOM file", "convert its series to NIfTI (dcm2niix)", .certainty = KIND_BY_NAME}},
    {.ending = ".trk", .is = is_no_text, .kind = {"a tractogram", STREAMLINES, .certainty = KIND_BY_NAME}},
    {.ending = ".tck", .is = is_no_text, .kind = {"a tractogram", STREAMLINES, .certainty = KIND_BY_NAME}},
    {.ending = ".tt", .is = is_no_text, .kind = {"a tractogram", STREAMLINES, .certainty = KIND_BY_NAME}},
    {.ending = ".stl", .is = is_no_text, .kind = {"an STL surface", "give it as ATLAS", .certainty = KIND_BY_NAME}},
    {.ending = ".obj", .kind = {"an OBJ surface", "give it as ATLAS", .certainty = KIND_BY_NAME}},
    {.ending = ".lut",
     .is = is_no_text,
     .kind = {"a table of colours", "put it beside the volume as X.lut", .certainty = KIND_BY_NAME}},
    {.is = is_vertex_values, .kind = {"values of the vertices of a surface, as text", NULL}},
    {.is = is_text, .kind = {"plain text", NULL, .certainty = KIND_VAGUE}},
#undef BYTES
};

static bool ends_with(const char *path, const char *ending)
{
    size_t length = strlen(path);
    size_t tail = strlen(ending);
    if (length > 3 && strcasecmp(path + length - 3, ".gz") == 0) {
        length -= 3;
    }
    return length > tail && strncasecmp(path + length - tail, ending, tail) == 0;
}

static bool matches(const struct format *row, const struct head *head)
{
    const struct bytes *bytes = head->bytes;
    return (!row->magic.size ||
            (bytes->size >= row->magic.size && memcmp(bytes->data, row->magic.data, row->magic.size) == 0)) &&
           (!row->intent || row->intent == head->intent) && (!row->root || text_equal(head->root, row->root)) &&
           (!row->begins || (head->start.size && strchr(row->begins, head->start.data[0]))) &&
           (!row->mentions || text_mentions(head->start, row->mentions)) &&
           (!row->has || row->has(bytes->data, bytes->size)) && (!row->is || row->is(head)) &&
           (!row->ending || (head->path && ends_with(head->path, row->ending)));
}

static const struct file_kind *find_kind(const struct head *head)
{
    for (size_t i = 0; i < sizeof formats / sizeof formats[0]; i++) {
        if (matches(&formats[i], head)) {
            return &formats[i].kind;
        }
    }
    return NULL;
}

static struct head head_of(const char *path, const struct bytes *bytes)
{
    struct text text = text_from_bytes(bytes->data, bytes->size);
    struct head head = {.bytes = bytes, .path = path, .readable = text_is_readable(text)};
    head.start = text_trim(text);
    head.root = xml_root(head.start);
    return head;
}

const struct file_kind *format_find(const char *path, const struct bytes *bytes)
{
    struct head head = head_of(path, bytes);
    head.intent = nifti_matrix_intent(bytes->data, bytes->size);
    return find_kind(&head);
}

const struct file_kind *format_find_matrix(int intent_code, const struct bytes *bytes)
{
    return find_kind(&(struct head){.bytes = bytes, .intent = intent_code});
}

bool format_is_lines(const struct bytes *bytes)
{
    struct text text = {(const char *)bytes->data, bytes->size};
    if (text_starts(text, "# vtk DataFile")) {
        return text_mentions(text, "\nLINES ") && !text_mentions(text, "\nPOLYGONS ") &&
               !text_mentions(text, "\nTRIANGLE_STRIPS ");
    }
    struct head head = head_of(NULL, bytes);
    return text_equal(head.root, "VTKFile") && has_lines_only(&head);
}

bool format_unpack_head(struct bytes *head, const struct bytes *stored)
{
    return gzip_is(stored->data, stored->size) && !gzip_head(head, stored->data, stored->size, FILE_KIND_HEAD);
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

conus_status format_fail(const struct file_kind *kind, const struct bytes *stored, const char *needed)
{
    if (!stored->size) {
        return fail(CONUS_ERROR_DATA, "content: the file is empty; needed is %s", needed);
    }
    if (!kind || strcmp(kind->words, "plain text") == 0) {
        return fail(CONUS_ERROR_DATA, "content: found %s\"%s\"; needed is %s", kind ? "plain text, " : "",
                    sample_of(stored).text, needed);
    }
    return fail(CONUS_ERROR_DATA, "this is %s%s%s; needed is %s", kind->words, kind->way ? ": " : "",
                kind->way ? kind->way : "", needed);
}
