/* SPDX-License-Identifier: BSD-3-Clause */
/* The list of structures of the CIFTI-2 specification, "BrainStructure". */
#include "loaders/cifti/cifti_structure.h"

#include <stddef.h>
#include <string.h>

#define WHOLE(word, name)                                                                                              \
    {                                                                                                                  \
        "CIFTI_STRUCTURE_" word, name, 0                                                                               \
    }
#define SIDES(word, name)                                                                                              \
    {"CIFTI_STRUCTURE_" word "_LEFT", name "Left", 'L'},                                                               \
    {                                                                                                                  \
        "CIFTI_STRUCTURE_" word "_RIGHT", name "Right", 'R'                                                            \
    }

static const struct cifti_structure structures[] = {
    SIDES("ACCUMBENS", "Accumbens"),
    WHOLE("ALL_WHITE_MATTER", "AllWhiteMatter"),
    WHOLE("ALL_GREY_MATTER", "AllGreyMatter"),
    SIDES("AMYGDALA", "Amygdala"),
    WHOLE("BRAIN_STEM", "BrainStem"),
    SIDES("CAUDATE", "Caudate"),
    SIDES("CEREBELLAR_WHITE_MATTER", "CerebellarWhiteMatter"),
    WHOLE("CEREBELLUM", "Cerebellum"),
    SIDES("CEREBELLUM", "Cerebellum"),
    SIDES("CEREBRAL_WHITE_MATTER", "CerebralWhiteMatter"),
    WHOLE("CORTEX", "Cortex"),
    SIDES("CORTEX", "Cortex"),
    SIDES("DIENCEPHALON_VENTRAL", "DiencephalonVentral"),
    SIDES("HIPPOCAMPUS", "Hippocampus"),
    WHOLE("OTHER", "Other"),
    WHOLE("OTHER_GREY_MATTER", "OtherGreyMatter"),
    WHOLE("OTHER_WHITE_MATTER", "OtherWhiteMatter"),
    SIDES("PALLIDUM", "Pallidum"),
    SIDES("PUTAMEN", "Putamen"),
    SIDES("THALAMUS", "Thalamus"),
};

const struct cifti_structure *cifti_structure_find(const char *word)
{
    for (size_t i = 0; i < sizeof structures / sizeof structures[0]; i++) {
        if (strcmp(word, structures[i].word) == 0) {
            return &structures[i];
        }
    }
    return NULL;
}
