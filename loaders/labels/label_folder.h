/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Candidates in a volume's folder that do not bear its name. */
#ifndef CONUS_LOADERS_LABELS_LABEL_FOLDER_H
#define CONUS_LOADERS_LABELS_LABEL_FOLDER_H

#include "loaders/labels/label_offer.h"

/** Tries what the volume's folder has under names of its own: an inherited BIDS table, an FSL atlas XML, ... */
conus_status label_search_folder(struct label_search *search);

#endif
