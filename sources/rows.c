/* SPDX-License-Identifier: BSD-3-Clause */
/* The table of formats: how a file is known, what it may be given as, and what a message advises where that is not what
 * is needed. */
#include "sources/source.h"

#include "base/child/hdf5.h"
#include "base/formats/matlab.h"
#include "base/formats/packed.h"
#include "base/formats/xml.h"
#include "base/path.h"

#include <stdio.h>
#include <string.h>

#define STREAMLINES "give it as --streamlines, or a volume of its density as --pathway"
#define FOREIGN "convert it to NIfTI"
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

/* A header of NRRD or MetaImage that has three real numbers at each voxel. */
static bool has_vectors(const struct file_head *head)
{
    bool is_nrrd = text_starts(head->bytes, "NRRD");
    return is_nrrd
               ? text_mentions(head->bytes, "kinds: vector") || text_mentions(head->bytes, "kinds: covariant-vector") ||
                     text_mentions(head->bytes, "kinds: 3-vector")
               : text_mentions(head->bytes, "ElementNumberOfChannels = 3") &&
                     (text_mentions(head->bytes, "MET_FLOAT") || text_mentions(head->bytes, "MET_DOUBLE"));
}

/* elastix's parameters, which may come in any order. */
static bool is_elastix(const struct file_head *head)
{
    return text_starts(head->start, "(Transform ") || text_mentions(head->bytes, "\n(Transform ");
}

static bool is_elastix_toml(const struct file_head *head)
{
    return text_starts(head->start, "Transform = \"") || text_mentions(head->bytes, "\nTransform = \"");
}

static bool is_zarr(const struct file_head *head)
{
    return has_file(head->path, "zarr.json") || has_file(head->path, ".zarray") || has_file(head->path, ".zattrs");
}

/* The voxels of a pair have no header of their own, and no mark, whatever they hold. */
static bool is_image_half(const struct file_head *head)
{
    const uint8_t *data = (const uint8_t *)head->bytes.data;
    return !nifti_has_magic(data, head->bytes.size) && !tiff_is(data, head->bytes.size) &&
           !hdf5_is(data, head->bytes.size);
}

static bool has_trx_header(const struct file_head *head)
{
    return has_file(head->path, "header.json");
}

static bool ends_with(const char *path, const char *endings)
{
    return path_ending_within(path, strlen(path) - path_ending_length(path, ".gz"), endings) > 0;
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

#define MAGIC(text) .magic = {(text), sizeof(text) - 1}
#define NAMED(text) .named = (text)
/* A format that is only named; that is read; and that is hidden without a role. */
#define TOLD(words_, way_, ...)                                                                                        \
    {                                                                                                                  \
        .words = words_, .way = way_, __VA_ARGS__                                                                      \
    }
#define KNOWN(id_, roles_, words_, way_, ...)                                                                          \
    {                                                                                                                  \
        .id = FORMAT_##id_, .roles = roles_, .words = words_, .way = way_, __VA_ARGS__                                 \
    }
#define POSES(word_, ...) HIDDEN(OTHER, ROLE_POSES, .poses = word_, __VA_ARGS__)
#define NO_POSES(why_, ...) HIDDEN(OTHER, ROLE_POSES, .words = why_, __VA_ARGS__)
#define HIDDEN(id_, roles_, ...)                                                                                       \
    {                                                                                                                  \
        .id = FORMAT_##id_, .roles = roles_, .is_hidden = true, __VA_ARGS__                                            \
    }
/* One whose words are for a transform. */
#define NO_TRANSFORM(words_, way_, ...) HIDDEN(OTHER, ROLE_TRANSFORM, .words = words_, .way = way_, __VA_ARGS__)

/* In the order in which they are asked. */
static const struct format formats[] = {
    TOLD("a pack", "give it as ATLAS with the ending .conus; conus pack packs an atlas and what is added to it",
         MAGIC("conus pack\0")),
    HIDDEN(TRK, ROLE_TRACTS, MAGIC("TRACK")), /* also where a byte is wrong */
    TOLD("a TrackVis tractogram", STREAMLINES, MAGIC("TRACK\0")),
    HIDDEN(TCK, ROLE_TRACTS, .has = tck_is),
    TOLD("an MRtrix tractogram", STREAMLINES, MAGIC("mrtrix tracks")),
    TOLD("an MRtrix image", FOREIGN " (mrconvert)", MAGIC("mrtrix image")),
    TOLD("a MINC-1 volume", "convert it to MINC 2 (mincconvert -2)", MAGIC("CDF\1")),
    TOLD("a MINC-1 volume", "convert it to MINC 2 (mincconvert -2)", MAGIC("CDF\2")),
    HIDDEN(MATLAB, ROLE_POSES, .poses = "simnibs", .is = is_matlab),
    TOLD("a MATLAB file of version 7.3", FOREIGN, MAGIC("MATLAB 7.3")),
    HIDDEN(ZARR, ROLE_VOLUME, .is_folder = true, .is = is_zarr),
    HIDDEN(BRIK, ROLE_VOLUME, NAMED(".BRIK")),
    HIDDEN(IMG, ROLE_VOLUME, NAMED(".img"), .is = is_image_half),
    KNOWN(HDF5, ROLE_VOLUME | ROLE_TRANSFORM | ROLE_REGION | ROLE_POSES, "an HDF5 file (a MINC-2 volume, say)",
          "give a volume as ATLAS, --pathway or --context", .has = hdf5_is, .poses = "nwb"),
    HIDDEN(TT, ROLE_TRACTS, .has = tt_is),
    HIDDEN(TRX, ROLE_TRACTS, .is_folder = true, .is = has_trx_header),
    HIDDEN(TRX, ROLE_TRACTS, .has = zip_is), /* other archives, too */
    HIDDEN(MZ3, ROLE_SURFACE, MAGIC("MZ"), .is = is_no_program),
    TOLD("an MZ3 surface", "give it as ATLAS with the ending .mz3", MAGIC("MZ")),
    KNOWN(VTK, ROLE_SURFACE | ROLE_TRACTS, "a VTK file", "give it as ATLAS, or its lines as --streamlines",
          MAGIC("# vtk DataFile")),
    KNOWN(PLY, ROLE_SURFACE, "a PLY surface", "give it as ATLAS", MAGIC("ply\n")),
    KNOWN(PLY, ROLE_SURFACE, "a PLY surface", "give it as ATLAS", MAGIC("ply\r")),
    TOLD("an STL surface", "give it as ATLAS with the ending .stl", MAGIC("solid ")),
    KNOWN(FREESURFER_LABEL, ROLE_VERTEX_LABELS, "a FreeSurfer label of vertices",
          "give it as --labels, and its surface as ATLAS", MAGIC("#!ascii label")),
    TOLD("a design matrix of FSL's statistics", NULL, MAGIC("/NumWaves")),
    TOLD("contrasts of FSL's statistics", NULL, MAGIC("/ContrastName")),
    TOLD("a FreeSurfer surface as text", "convert it (mris_convert)", MAGIC("#!ascii version")),
    TOLD("an OFF surface", "give it as ATLAS with the ending .off", MAGIC("OFF")),
    TOLD("an OFF surface", "give it as ATLAS with the ending .off", MAGIC("# OFF")),
    TOLD("a PNG picture", NULL, MAGIC("\x89PNG\r\n\x1a\n")),
    TOLD("a JPEG picture", NULL, MAGIC("\xff\xd8\xff")),
    TOLD("an OpenEXR picture", NULL, MAGIC("\x76\x2f\x31\x01")),
    KNOWN(TIFF, ROLE_VOLUME, "a stack of TIFF pages", VOLUME, .has = tiff_is),
    TOLD("a GIF picture", NULL, MAGIC("GIF8")),
    TOLD("a PDF document", NULL, MAGIC("%PDF-")),
    TOLD("a TRX tractogram", STREAMLINES, MAGIC("PK\3\4"), NAMED(".trx")),
    TOLD("a document of Office (an Excel workbook, say)", "save its table as CSV", MAGIC("PK\3\4"),
         .mentions = "[Content_Types].xml"),
    TOLD("a ZIP archive", "unpack it, or give it as --streamlines if it is a TRX tractogram", MAGIC("PK\3\4")),
    TOLD("a RAR archive", "unpack it", MAGIC("Rar!")),
    TOLD("a 7z archive", "unpack it", MAGIC("7z\xbc\xaf\x27\x1c")),
    TOLD("a file packed with bzip2", "unpack it, or pack it with gzip", MAGIC("BZh")),
    TOLD("a file packed with xz", "unpack it, or pack it with gzip", MAGIC("\xfd\x37zXZ")),
    TOLD("a file packed with zstd", "unpack it, or pack it with gzip", MAGIC("\x28\xb5\x2f\xfd")),
    TOLD("a MATLAB file", FOREIGN, MAGIC("MATLAB 5.0")),
    TOLD("a NumPy array", FOREIGN " (nibabel)", MAGIC("\x93NUMPY")),
    TOLD("a program", NULL,
         MAGIC("\x7f"
               "ELF")),
    TOLD("a Git LFS pointer, not the file itself", "fetch it (git lfs pull)", MAGIC("version https://git-lfs")),
    TOLD("a DICOM file", "convert its series to NIfTI (dcm2niix)", .has = is_dicom),
    TOLD("values of the vertices of a surface", NULL, .has = mgh_is_of_vertices),
    KNOWN(CIFTI, ROLE_VERTEX_LABELS | ROLE_SCENE, "a CIFTI-1 file", CIFTI_1, .intent = NIFTI_DENSE_LABELS,
          .is = is_first_cifti),
    TOLD("a CIFTI-1 file", CIFTI_1, .is = is_first_cifti),
    TOLD("a CIFTI matrix without a kind (a .plabel.nii, say)", PARCELS, .intent = 3000),
    TOLD("a CIFTI matrix of connections (.dconn.nii)", "conus has no use for connections", .intent = 3001),
    TOLD("a CIFTI matrix of time series (.dtseries.nii)", SEPARATE, .intent = 3002),
    TOLD("a CIFTI matrix of connections of parcels (.pconn.nii)", PARCELS, .intent = 3003),
    TOLD("a CIFTI matrix of time series of parcels (.ptseries.nii)", PARCELS, .intent = 3004),
    TOLD("a CIFTI matrix of values (.dscalar.nii)", SEPARATE, .intent = 3006),
    KNOWN(CIFTI, ROLE_VERTEX_LABELS | ROLE_SCENE, "a CIFTI matrix of labels (.dlabel.nii)",
          "give it as ATLAS, as --labels of a surface, or in a manifest as parcellation or vertex_labels",
          .intent = NIFTI_DENSE_LABELS),
    TOLD("a CIFTI matrix of values of parcels (.pscalar.nii)", PARCELS, .intent = 3008),
    TOLD("a CIFTI matrix of connections of parcels (.pdconn.nii)", PARCELS, .intent = 3009),
    TOLD("a CIFTI matrix of connections of parcels (.dpconn.nii)", PARCELS, .intent = 3010),
    TOLD("a CIFTI matrix of connections of parcels (.pconnseries.nii)", PARCELS, .intent = 3011),
    TOLD("a CIFTI matrix of connections of parcels (.pconnscalar.nii)", PARCELS, .intent = 3012),
    TOLD("a CIFTI matrix of an unknown kind", PARCELS, .is = is_matrix),
    KNOWN(NIFTI, ROLE_VOLUME | ROLE_TRANSFORM, "a volume", VOLUME, .has = nifti_has_magic),
    HIDDEN(NIFTI, ROLE_VOLUME, .has = nifti_is), /* ANALYZE has no more than a size */
    KNOWN(MGH, ROLE_VOLUME, "a volume", VOLUME, .has = mgh_is),
    HIDDEN(NRRD, ROLE_TRANSFORM, .has = nrrd_is, .is = has_vectors),
    HIDDEN(METAIMAGE, ROLE_TRANSFORM, .has = metaimage_is, .is = has_vectors),
    KNOWN(NRRD, ROLE_VOLUME, "a volume", VOLUME, .has = nrrd_is),
    KNOWN(METAIMAGE, ROLE_VOLUME, "a volume", VOLUME, .has = metaimage_is),
    KNOWN(AFNI, ROLE_VOLUME, "a volume", VOLUME, .has = afni_is),
    KNOWN(FREESURFER, ROLE_SURFACE | ROLE_VERTEX_LABELS, "values of the vertices of a surface", NULL,
          .has = freesurfer_is_curvature),
    KNOWN(FREESURFER, ROLE_SURFACE | ROLE_VERTEX_LABELS, "a surface", "give it as ATLAS", .has = freesurfer_is_surface),
    KNOWN(GIFTI, ROLE_SURFACE | ROLE_VERTEX_LABELS, "a surface", "give it as ATLAS", .root = "GIFTI",
          .mentions = "NIFTI_INTENT_POINTSET"),
    KNOWN(GIFTI, ROLE_SURFACE | ROLE_VERTEX_LABELS, "labels of the vertices of a surface",
          "give it as --labels, and the surface as ATLAS", .root = "GIFTI", .mentions = "NIFTI_INTENT_LABEL"),
    KNOWN(GIFTI, ROLE_SURFACE | ROLE_VERTEX_LABELS, "values of the vertices of a surface", NULL, .root = "GIFTI"),
    HIDDEN(VTP, ROLE_SURFACE | ROLE_TRACTS, .root = "VTKFile"),
    TOLD("a VTK file of lines", STREAMLINES, .root = "VTKFile", .is = has_lines_only),
    TOLD("a surface", "give it as ATLAS", .root = "VTKFile", .is = is_text),
    KNOWN(ATLAS_XML, ROLE_SCENE, "an SPM or CAT12 atlas XML", "give it as ATLAS or --labels", .root = "atlas",
          .mentions = "<index>"),
    KNOWN(ATLAS_XML, ROLE_SCENE, "an FSL atlas XML of type Label", "give it as ATLAS or --labels", .root = "atlas",
          .mentions = ">Label</type>"),
    KNOWN(ATLAS_XML, ROLE_SCENE, "an FSL atlas XML", "'conus manifest FOLDER' makes pathways of its volumes",
          .root = "atlas"),
    TOLD("a web page", NULL, .is = is_web_page),
    TOLD("XML of another kind", NULL, .begins = "<", .is = is_text, .certainty = KIND_VAGUE),
    HIDDEN(MANIFEST, ROLE_SCENE, .begins = "{"),
    TOLD("a manifest", "give it as ATLAS", .begins = "{", .mentions = "\"conus_atlas\"", .is = is_text),
    TOLD("JSON of another kind", NULL, .begins = "{[", .is = is_text, .certainty = KIND_VAGUE),
    TOLD("a FreeSurfer annotation", "give it as --labels, and the surface as ATLAS", NAMED(".annot"), .is = is_no_text,
         .certainty = KIND_BY_NAME),
    TOLD("the voxels of an AFNI data set", "give its .HEAD as ATLAS, --pathway or --context", NAMED(".BRIK"),
         .is = is_no_text, .certainty = KIND_BY_NAME),
    TOLD("a DICOM file", "convert its series to NIfTI (dcm2niix)", NAMED(".dcm"), .is = is_no_text,
         .certainty = KIND_BY_NAME),
    TOLD("a tractogram", STREAMLINES, NAMED(".trk"), .is = is_no_text, .certainty = KIND_BY_NAME),
    TOLD("a tractogram", STREAMLINES, NAMED(".tck"), .is = is_no_text, .certainty = KIND_BY_NAME),
    TOLD("a tractogram", STREAMLINES, NAMED(".tt"), .is = is_no_text, .certainty = KIND_BY_NAME),
    TOLD("an STL surface", "give it as ATLAS", NAMED(".stl"), .is = is_no_text, .certainty = KIND_BY_NAME),
    TOLD("an OBJ surface", "give it as ATLAS", NAMED(".obj"), .certainty = KIND_BY_NAME),
    HIDDEN(STL, ROLE_SURFACE | ROLE_VERTEX_LABELS, NAMED(".stl")),
    HIDDEN(OFF, ROLE_SURFACE | ROLE_VERTEX_LABELS, NAMED(".off")),
    HIDDEN(OBJ, ROLE_SURFACE | ROLE_VERTEX_LABELS, NAMED(".obj")),
    HIDDEN(OTHER, ROLE_SURFACE | ROLE_VERTEX_LABELS, NAMED(".vtk/.vtp/.ply/.mz3")), /* whose reader says what it is */
    NO_POSES("packed by gzip: unpack it, or let gzip -dc write it to standard input", MAGIC("\x1f\x8b")),
    NO_POSES("packed by xz: unpack it, or let xz -dc write it to standard input", MAGIC("\xfd\x37zXZ")),
    NO_POSES("packed by bzip2: unpack it, or let bzip2 -dc write it to standard input", MAGIC("BZh")),
    NO_POSES("packed by zstd: unpack it, or let zstd -dc write it to standard input", MAGIC("\x28\xb5\x2f\xfd")),
    NO_POSES("a text of a word processor (RTF): save it as plain text", MAGIC("{\\rtf")),
    NO_POSES("a zip file or a spreadsheet: unpack it, or export it as text with tabs or commas", MAGIC("PK\3\4")),
    NO_POSES("a spreadsheet: export it as text with tabs or commas", MAGIC("\xd0\xcf\x11\xe0")),
    NO_POSES(
        "a table of the sites of SpikeGLX's probe (.imro) says which are on, and not where the probe lies: --probe "
        "takes it, and a pose is another file",
        MAGIC("(")),
    NO_POSES(
        "a recording by SpikeGLX (.meta) says where contacts are on the probe, and not where it lies: --probe takes "
        "it, and a pose is another file",
        MAGIC("acqApLfSy=")),
    NO_POSES("a layout of a probe's channels (.prb) says where they are on it, and not where it lies",
             MAGIC("channel_groups")),
    POSES("brainsight",
          .lines = "# Coordinate system:/# Target Name/# Sample Name/# Electrode Name/#Target Name/#Sample Name/"
                   "#Electrode Name"),
    POSES("invesalius", .lines = "##INVESALIUS3_MARKER_FILE_"),
    POSES("localite", .lines = "<"),
    POSES("markups",
          .lines = "{/# Markups fiducial file/# Fiducial List file/# columns = id,x,y,z/# columns = label,x,y,z"),
    HIDDEN(MATRIX, ROLE_TRANSFORM, .has = matrix_is, .is = is_text),
    HIDDEN(ITK, ROLE_TRANSFORM, .has = itk_is, .is = is_text),
    HIDDEN(XFM, ROLE_TRANSFORM, .has = xfm_is, .is = is_text),
    HIDDEN(LTA, ROLE_TRANSFORM, .has = lta_is, .is = is_text),
    HIDDEN(REGISTER, ROLE_TRANSFORM, .has = register_is, .is = is_text),
    HIDDEN(ITK_MATLAB, ROLE_TRANSFORM, .has = itk_matlab_is),
    NO_TRANSFORM("a MATLAB file of level 5",
                 "which is not read as a transform; ITK's (level 4, as out_0GenericAffine.mat) and 4 x 4 numbers of "
                 "RAS mm as text are",
                 MAGIC("MATLAB 5.0")),
    NO_TRANSFORM("elastix's parameters",
                 "which are not read; with (WriteITKCompositeTransform \"true\") and "
                 "(ITKTransformOutputFileNameExtension \"tfm\") among its own, elastix writes ITK's text",
                 .is = is_elastix),
    NO_TRANSFORM("a design matrix of FSL's statistics", "and no transform", MAGIC("/NumWaves")),
    NO_TRANSFORM("elastix's parameters as TOML",
                 "which are not read; elastix writes ITK's text, too, with WriteITKCompositeTransform and "
                 "ITKTransformOutputFileNameExtension = \"tfm\"",
                 .is = is_elastix_toml),
    TOLD("a table of colours", "put it beside the volume as X.lut", NAMED(".lut"), .is = is_no_text,
         .certainty = KIND_BY_NAME),
    TOLD("values of the vertices of a surface, as text", NULL, .is = is_vertex_values),
    TOLD("plain text", NULL, .is = is_text, .certainty = KIND_VAGUE),
};

/* The lines with # up to the first other one, and this. */
static bool has_line(struct text rest, const char *beginnings)
{
    struct text line;
    bool found = false;
    for (bool is_comment = true; !found && is_comment && text_line(&rest, &line);) {
        struct text all = text_from(beginnings);
        struct text beginning;
        line = text_trim(line);
        is_comment = !line.size || line.data[0] == '#';
        for (bool more = true; !found && text_field(&all, '/', &more, &beginning);) {
            found = line.size >= beginning.size && memcmp(line.data, beginning.data, beginning.size) == 0;
        }
    }
    return found;
}

static bool matches(const struct format *row, const struct file_head *head)
{
    const struct text bytes = head->bytes;
    return row->is_folder == head->is_folder &&
           (!row->magic.size ||
            (bytes.size >= row->magic.size && memcmp(bytes.data, row->magic.data, row->magic.size) == 0)) &&
           (!row->intent || row->intent == head->intent) && (!row->root || text_equal(head->root, row->root)) &&
           (!row->begins || (head->start.size && head->start.data[0] && strchr(row->begins, head->start.data[0]))) &&
           (!row->mentions || text_mentions(head->start, row->mentions)) &&
           (!row->lines || has_line(bytes, row->lines)) &&
           (!row->has || row->has((const uint8_t *)bytes.data, bytes.size)) && (!row->is || row->is(head)) &&
           (!row->named || (head->path && ends_with(head->path, row->named)));
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
        const bool is_packed = format && stored->size > 1 && stored->data[0] == 0x1f && stored->data[1] == 0x8b;
        return is_packed ? fail(CONUS_ERROR_DATA, "content: found plain text, packed by gzip; needed is %s", needed)
                         : fail(CONUS_ERROR_DATA, "content: found %s\"%s\"; needed is %s", format ? "plain text, " : "",
                                sample_of(stored).text, needed);
    }
    return fail(CONUS_ERROR_DATA, "this is %s%s%s; needed is %s", format->words, format->way ? ": " : "",
                format->way ? format->way : "", needed);
}
