/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Tables in a volume's folder whose name is like the volume's. */
#ifndef CONUS_LOADERS_LABELS_LABEL_ALIKE_H
#define CONUS_LOADERS_LABELS_LABEL_ALIKE_H

#include "loaders/labels/label_offer.h"

/** Tries the tables in @p folder whose names have no word that the volume's lacks, unless they may belong to another
 * volume there, and whose numbers fit (label_fit_is_good()). A note says what was taken, or why not. */
conus_status label_search_alike(struct label_search *search, const char *folder);

#endif
