/* SPDX-License-Identifier: BSD-3-Clause */
/* The table of formats that conus knows by their first bytes or by the ending of the name. */
#include "loaders/file_kind.h"

#include "base/formats/gzip.h"
#include "base/formats/xml.h"
#include "base/text.h"
#include "loaders/labels/label_bytes.h"
#include "loaders/surfaces/freesurfer_surface.h"
#include "loaders/volumes/mgh.h"
#include "loaders/volumes/nifti.h"
#include "loaders/volumes/volume_text.h"

#include <stdio.h>
#include <string.h>
#include <strings.h>

#define STREAMLINES "give it as --streamlines, or a volume of its density as --pathway"
#define FOREIGN "convert it to NIfTI"
#define TIFF "a stack of TIFF pages"

static const struct file_kind volume = {"a volume", "give it as ATLAS, --pathway or --context"};
static const struct file_kind surface = {"a surface", "give it as ATLAS"};
static const struct file_kind vertex_labels = {"labels of the vertices of a surface",
                                               "give it as --labels, and the surface as ATLAS"};
static const struct file_kind vertex_values = {"values of the vertices of a surface", NULL};
static const struct file_kind table = {"a label table", "give it as --labels"};
static const struct file_kind manifest = {"a manifest", "give it as ATLAS"};
static const struct file_kind fsl_labels = {"an FSL atlas XML of type Label", "give it as ATLAS or --labels"};
static const struct file_kind fsl_volumes = {"an FSL atlas XML",
                                             "'conus manifest FOLDER' makes pathways of its volumes"};
static const struct file_kind spm = {"an SPM or CAT12 atlas XML", "give it as ATLAS or --labels"};
static const struct file_kind html = {"a web page", NULL};
static const struct file_kind xml = {"XML of another kind", NULL};
static const struct file_kind json = {"JSON of another kind", NULL};
static const struct file_kind dicom = {"a DICOM file", "convert its series to NIfTI (dcm2niix)"};
static const struct file_kind trx = {"a TRX tractogram", STREAMLINES};
static const struct file_kind lines = {"a VTK file of lines", STREAMLINES};
static const struct file_kind plain_text = {"plain text", NULL};

/* What begins with given bytes. */
static const struct {
    const char *magic;
    size_t size;
    struct file_kind kind;
} magics[] = {
#define MAGIC(text) (text), sizeof(text) - 1
    {MAGIC("TRACK\0"), {"a TrackVis tractogram", STREAMLINES}},
    {MAGIC("mrtrix tracks"), {"an MRtrix tractogram", STREAMLINES}},
    {MAGIC("mrtrix image"), {"an MRtrix image", FOREIGN " (mrconvert)"}},
    {MAGIC("CDF\1"), {"a MINC-1 volume", FOREIGN " (mnc2nii)"}},
    {MAGIC("CDF\2"), {"a MINC-1 volume", FOREIGN " (mnc2nii)"}},
    {MAGIC("\x89HDF\r\n\x1a\n"), {"an HDF5 file (a MINC-2 volume, say)", FOREIGN " (mnc2nii)"}},
    {MAGIC("MZ"), {"an MZ3 surface", "give it as ATLAS with the ending .mz3"}},
    {MAGIC("# vtk DataFile"), {"a VTK file", "give it as ATLAS with the ending .vtk, or its lines as --streamlines"}},
    {MAGIC("ply\n"), {"a PLY surface", "give it as ATLAS with the ending .ply"}},
    {MAGIC("ply\r\n"), {"a PLY surface", "give it as ATLAS with the ending .ply"}},
    {MAGIC("solid "), {"an STL surface", "give it as ATLAS with the ending .stl"}},
    {MAGIC("#!ascii label"), {"a FreeSurfer label of vertices", "give it as --labels, and its surface as ATLAS"}},
    {MAGIC("/NumWaves"), {"a design matrix of FSL's statistics", NULL}},
    {MAGIC("/ContrastName"), {"contrasts of FSL's statistics", NULL}},
    {MAGIC("#!ascii version"), {"a FreeSurfer surface as text", "convert it (mris_convert)"}},
    {MAGIC("OFF"), {"an OFF surface", "give it as ATLAS with the ending .off"}},
    {MAGIC("# OFF"), {"an OFF surface", "give it as ATLAS with the ending .off"}},
    {MAGIC("\x89PNG\r\n\x1a\n"), {"a PNG picture", NULL}},
    {MAGIC("\xff\xd8\xff"), {"a JPEG picture", NULL}},
    {MAGIC("\x76\x2f\x31\x01"), {"an OpenEXR picture", NULL}},
    {MAGIC("II*\0"), {TIFF, "give it as ATLAS, --pathway or --context"}},
    {MAGIC("MM\0*"), {TIFF, "give it as ATLAS, --pathway or --context"}},
    {MAGIC("II+\0"), {TIFF, "give it as ATLAS, --pathway or --context"}},
    {MAGIC("MM\0+"), {TIFF, "give it as ATLAS, --pathway or --context"}},
    {MAGIC("GIF8"), {"a GIF picture", NULL}},
    {MAGIC("%PDF-"), {"a PDF document", NULL}},
    {MAGIC("PK\3\4"), {"a ZIP archive", "unpack it, or give it as --streamlines if it is a TRX tractogram"}},
    {MAGIC("Rar!"), {"a RAR archive", "unpack it"}},
    {MAGIC("7z\xbc\xaf\x27\x1c"), {"a 7z archive", "unpack it"}},
    {MAGIC("BZh"), {"a file packed with bzip2", "unpack it, or pack it with gzip"}},
    {MAGIC("\xfd\x37zXZ"), {"a file packed with xz", "unpack it, or pack it with gzip"}},
    {MAGIC("\x28\xb5\x2f\xfd"), {"a file packed with zstd", "unpack it, or pack it with gzip"}},
    {MAGIC("MATLAB 5.0"), {"a MATLAB file", FOREIGN}},
    {MAGIC("\x93NUMPY"), {"a NumPy array", FOREIGN " (nibabel)"}},
    {MAGIC("\x7f"
           "ELF"),
     {"a program", NULL}},
    {MAGIC("version https://git-lfs"), {"a Git LFS pointer, not the file itself", "fetch it (git lfs pull)"}},
#undef MAGIC
};

/* Known by the ending of the name only. */
static const struct {
    const char *ending;
    struct file_kind kind;
} endings[] = {
    {".annot", {"a FreeSurfer annotation", "give it as --labels, and the surface as ATLAS"}},
    {".BRIK", {"the voxels of an AFNI data set", "give its .HEAD as ATLAS, --pathway or --context"}},
    {".dcm", {"a DICOM file", "convert its series to NIfTI (dcm2niix)"}},
    {".trk", {"a tractogram", STREAMLINES}},
    {".tck", {"a tractogram", STREAMLINES}},
    {".tt", {"a tractogram", STREAMLINES}},
    {".stl", {"an STL surface", "give it as ATLAS"}},
    {".obj", {"an OBJ surface", "give it as ATLAS"}},
    {".lut", {"a table of colours", "put it beside the volume as X.lut"}},
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

static const struct file_kind *atlas_xml(struct text text)
{
    if (text_mentions(text, "<index>")) {
        return &spm;
    }
    return text_mentions(text, ">Label</type>") ? &fsl_labels : &fsl_volumes;
}

static const struct file_kind *kind_of_markup(struct text text)
{
    struct text root = xml_root(text);
    if (text_equal(root, "GIFTI")) {
        return text_mentions(text, "NIFTI_INTENT_POINTSET") ? &surface
               : text_mentions(text, "NIFTI_INTENT_LABEL")  ? &vertex_labels
                                                            : &vertex_values;
    }
    if (text_equal(root, "VTKFile")) {
        return text_mentions(text, "NumberOfPolys=\"0\"") && !text_mentions(text, "NumberOfLines=\"0\"") ? &lines
                                                                                                         : &surface;
    }
    if (text_equal(root, "atlas")) {
        return atlas_xml(text);
    }
    return text_equal_ignoring_case(root, "html") ? &html : label_format_of(text) ? &table : &xml;
}

static const struct file_kind *kind_of_text(struct text text)
{
    struct text start = text_trim(text);
    if (!start.size) {
        return NULL;
    }
    if (start.data[0] == '<') {
        return kind_of_markup(start);
    }
    if (start.data[0] == '{' && text_mentions(start, "\"conus_atlas\"")) {
        return &manifest;
    }
    if (label_format_of(start)) {
        return &table;
    }
    return start.data[0] == '{' || start.data[0] == '[' ? &json : NULL;
}

static const struct file_kind *kind_of_magic(const struct bytes *head)
{
    for (size_t i = 0; i < sizeof magics / sizeof magics[0]; i++) {
        if (head->size >= magics[i].size && memcmp(head->data, magics[i].magic, magics[i].size) == 0) {
            return &magics[i].kind;
        }
    }
    return NULL;
}

static bool is_dicom(const struct bytes *head)
{
    enum { PREAMBLE = 128 };
    return head->size >= PREAMBLE + 4 && memcmp(head->data + PREAMBLE, "DICM", 4) == 0;
}

static const struct file_kind *kind_of_ending(const char *path)
{
    for (size_t i = 0; path && i < sizeof endings / sizeof endings[0]; i++) {
        if (ends_with(path, endings[i].ending)) {
            return &endings[i].kind;
        }
    }
    return NULL;
}

char file_first_character(const char *path)
{
    uint8_t start[64];
    FILE *file = file_exists(path) ? fopen(path, "rbe") : NULL;
    size_t size = file ? fread(start, 1, sizeof start, file) : 0;
    if (file) {
        fclose(file);
    }
    struct text text = text_trim(text_from_bytes(start, size));
    return text.size ? text.data[0] : '\0';
}

bool file_kind_is_vague(const struct file_kind *kind)
{
    return kind == &xml || kind == &json || kind == &plain_text;
}

bool file_kind_is_lines(const struct bytes *bytes)
{
    struct text text = {(const char *)bytes->data, bytes->size};
    bool legacy = text_starts(text, "# vtk DataFile") && text_mentions(text, "\nLINES ") &&
                  !text_mentions(text, "\nPOLYGONS ") && !text_mentions(text, "\nTRIANGLE_STRIPS ");
    return legacy || file_kind_of(NULL, bytes) == &lines;
}

const struct file_kind *file_kind_of(const char *path, const struct bytes *head)
{
    struct text text = text_from_bytes(head->data, head->size);
    const struct file_kind *kind = kind_of_magic(head);
    if (kind) {
        return path && head->data[0] == 'P' && ends_with(path, ".trx") ? &trx : kind;
    }
    if (is_dicom(head)) {
        return &dicom;
    }
    if (mgh_is_of_vertices(head->data, head->size)) {
        return &vertex_values;
    }
    kind = nifti_matrix_kind(head->data, head->size);
    if (kind) {
        return kind;
    }
    if (nifti_has_magic(head->data, head->size) || mgh_is(head->data, head->size) || volume_text_is(head)) {
        return &volume;
    }
    if (freesurfer_is_surface(head->data, head->size)) {
        return freesurfer_is_curvature(head->data, head->size) ? &vertex_values : &surface;
    }
    kind = text_is_readable(text) ? kind_of_text(text) : NULL;
    bool named = !text_is_readable(text) || (path && ends_with(path, ".obj")); /* the others are not text */
    kind = kind || !named ? kind : kind_of_ending(path);
    return kind ? kind : text_is_readable(text) ? &plain_text : NULL;
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

const struct file_kind *file_kind_of_stored(const char *path, const struct bytes *stored)
{
    struct bytes head = {0};
    size_t size = stored->size < FILE_KIND_HEAD ? stored->size : FILE_KIND_HEAD;
    const struct bytes start = {stored->data, size};
    if (!gzip_is(stored->data, stored->size) || gzip_head(&head, stored->data, stored->size, FILE_KIND_HEAD)) {
        return file_kind_of(path, &start);
    }
    const struct file_kind *kind = file_kind_of(path, &head);
    bytes_finish(&head);
    return kind;
}

conus_status file_kind_fail(const char *path, const struct bytes *stored, const char *needed)
{
    const struct file_kind *kind = stored->size ? file_kind_of_stored(path, stored) : NULL;
    if (!stored->size) {
        return fail(CONUS_ERROR_DATA, "content: the file is empty; needed is %s", needed);
    }
    if (!kind || kind == &plain_text) {
        return fail(CONUS_ERROR_DATA, "content: found %s\"%s\"; needed is %s", kind ? "plain text, " : "",
                    sample_of(stored).text, needed);
    }
    return fail(CONUS_ERROR_DATA, "this is %s%s%s; needed is %s", kind->words, kind->way ? ": " : "",
                kind->way ? kind->way : "", needed);
}

conus_status file_kind_refuse(const char *path, const char *needed)
{
    struct bytes stored = {0};
    conus_status status = file_read_head(&stored, path, FILE_KIND_HEAD);
    status = status ? status : fail_in(file_kind_fail(path, &stored, needed), path);
    bytes_finish(&stored);
    return status;
}
