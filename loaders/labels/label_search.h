/* SPDX-License-Identifier: BSD-3-Clause */
/** @file A candidate for a volume's label table: bytes or a file that may be one. */
#ifndef CONUS_LOADERS_LABELS_LABEL_SEARCH_H
#define CONUS_LOADERS_LABELS_LABEL_SEARCH_H

#include "loaders/labels/label_offer.h"

/** Tries @p text, called @p path in messages, which is that of @p file or, where that is NULL, lies in the volume's. */
conus_status label_search_bytes(struct label_search *search, const char *path, const struct bytes *file,
                                struct text text);

/** Tries the file @p path, if it exists. */
conus_status label_search_file(struct label_search *search, const char *path);

#endif
