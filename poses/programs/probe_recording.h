/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The probe of a recording, as ProbeInterface's JSON. */
#ifndef CONUS_POSES_PROGRAMS_PROBE_RECORDING_H
#define CONUS_POSES_PROGRAMS_PROBE_RECORDING_H

#include "base/buffer.h"
#include "base/text.h"

/** Whether @p text is of a recording: SpikeGLX's .ap.meta or .imro, or XML. */
bool probe_recording_is(struct text text);

/** Writes such a text's contacts and tips as JSON of ProbeInterface: a probe of SpikeGLX, the probes of Open Ephys's
 * settings.xml. @p tip: mm from the tip to the lowest row that the probe has, recorded or not; 0 = that of its part
 * number. CONUS_ERROR_DATA for what does not say where its contacts are. */
conus_status probe_recording_write(struct buffer *out, struct text text, double tip);

#endif
