/* SPDX-License-Identifier: BSD-3-Clause */
/* Writes CIFTI files: the XML as text, the rest by nifti_builder.h. */
#include "builders/cifti_builder.h"

#include "builders/nifti_builder.h"
#include "loaders/volumes/volumes.h"
#include "test.h"

#include <string.h>

#define TABLE                                                                                                          \
    "<LabelTable><Label Key=\"0\" Red=\"1\" Green=\"1\" Blue=\"1\" Alpha=\"0\">unknown</Label>"                        \
    "<Label Key=\"5\" Red=\"1\" Green=\"0\" Blue=\"0\" Alpha=\"1\">A</Label>"                                          \
    "<Label Key=\"7\" Red=\"0\" Green=\"0\" Blue=\"1\" Alpha=\"1\">Thalamus</Label>"                                   \
    "<Label Key=\"8\" Red=\"0\" Green=\"1\" Blue=\"0\" Alpha=\"1\">B</Label></LabelTable>"

static const char document[] =
    "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<CIFTI Version=\"2\"><Matrix>\n"
    "<MetaData><MD><Name>Provenance</Name><Value>test</Value></MD></MetaData>\n"
    "<MatrixIndicesMap AppliesToMatrixDimension=\"0\" IndicesMapToDataType=\"CIFTI_INDEX_TYPE_LABELS\">\n"
    "<NamedMap><MapName>one</MapName>" TABLE "</NamedMap>\n"
    "<NamedMap><MapName>two</MapName><MetaData/>" TABLE "</NamedMap></MatrixIndicesMap>\n"
    "<MatrixIndicesMap AppliesToMatrixDimension=\"1\" IndicesMapToDataType=\"CIFTI_INDEX_TYPE_BRAIN_MODELS\">\n"
    "<Volume VolumeDimensions=\"2,3,2\"><TransformationMatrixVoxelIndicesIJKtoXYZ MeterExponent=\"-3\">"
    "-2 0 0 90\n0 2 0 -126\n0 0 2 -72\n0 0 0 1</TransformationMatrixVoxelIndicesIJKtoXYZ></Volume>\n"
    "<BrainModel IndexOffset=\"0\" IndexCount=\"3\" ModelType=\"CIFTI_MODEL_TYPE_SURFACE\" "
    "BrainStructure=\"CIFTI_STRUCTURE_CORTEX_LEFT\" SurfaceNumberOfVertices=\"4\">"
    "<VertexIndices>0 1 2</VertexIndices></BrainModel>\n"
    "<BrainModel IndexOffset=\"3\" IndexCount=\"4\" ModelType=\"CIFTI_MODEL_TYPE_SURFACE\" "
    "BrainStructure=\"CIFTI_STRUCTURE_CORTEX_RIGHT\" SurfaceNumberOfVertices=\"4\">"
    "<VertexIndices>0 1 2 3</VertexIndices></BrainModel>\n"
    "<BrainModel IndexOffset=\"7\" IndexCount=\"2\" ModelType=\"CIFTI_MODEL_TYPE_VOXELS\" "
    "BrainStructure=\"CIFTI_STRUCTURE_THALAMUS_LEFT\">"
    "<VoxelIndicesIJK>0 0 0\n1 2 1</VoxelIndicesIJK></BrainModel>\n"
    "</MatrixIndicesMap></Matrix></CIFTI>";

static const double labels[CIFTI_GRAYORDINATES * CIFTI_MAPS] = {5, 8, 5, 8, 5, 8, 5, 0, 5, 0, 8, 0, 8, 0, 7, 0, 7, 0};

/* Writes the document with its edit, and NULs up to a multiple of 16, counting the 8 bytes of its size and code. */
static void make_xml(struct buffer *out, const struct cifti_spec *spec)
{
    const char *at = spec->find ? strstr(document, spec->find) : NULL;
    assert_true(!spec->find || at);
    if (at) {
        buffer_append(out, document, (size_t)(at - document));
        buffer_text(out, spec->replace);
        at += strlen(spec->find);
    }
    buffer_text(out, at ? at : document);
    do {
        buffer_append(out, "", 1);
    } while ((out->size + 8) % 16);
}

void cifti_build(struct buffer *out, const struct cifti_spec *spec)
{
    static const int64_t one[3] = {1, 1, 1};
    struct nifti_builder b;
    struct buffer xml = {0};
    make_xml(&xml, spec);
    nifti_begin(&b, 2, spec->big, spec->datatype ? spec->datatype : VOLUME_FLOAT32, one);
    nifti_set(&b, "dim", 0, 6);
    nifti_set(&b, "dim", 5, CIFTI_MAPS);
    nifti_set(&b, "dim", 6, CIFTI_GRAYORDINATES);
    nifti_set(&b, "intent_code", 0, 3007);
    nifti_set(&b, "sform_code", 0, 0);
    nifti_extend(&b, (int)xml.size + 8, 32, xml.data, xml.size);
    for (size_t i = 0; i < CIFTI_GRAYORDINATES * CIFTI_MAPS; i++) {
        nifti_voxel(&b, spec->values ? spec->values[i] : labels[i]);
    }
    if (spec->field) {
        nifti_set(&b, spec->field, spec->index, spec->value);
    }
    buffer_append(out, b.bytes.data, b.bytes.size);
    buffer_finish(&b.bytes);
    buffer_finish(&xml);
}
