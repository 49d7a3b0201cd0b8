/* SPDX-License-Identifier: BSD-3-Clause */
/** @file ProbeInterface's JSON from bytes. */
#ifndef CONUS_POSES_PROGRAMS_PROBE_INTERFACE_H
#define CONUS_POSES_PROGRAMS_PROBE_INTERFACE_H

#include "base/text.h"
#include "conus/probe.h"

/** As conus_probe_load(), from @p text. Errors name no file. */
conus_status probe_parse(conus_probe **out, struct text text, const conus_probe_options *options);

#endif
