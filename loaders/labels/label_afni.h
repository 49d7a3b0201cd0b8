/* SPDX-License-Identifier: BSD-3-Clause */
/** @file AFNI's label tables, in NIML. */
#ifndef CONUS_LOADERS_TABLES_LABEL_AFNI_H
#define CONUS_LOADERS_TABLES_LABEL_AFNI_H

#include "loaders/labels/label_format.h"

extern const struct label_format label_format_afni;

#endif
