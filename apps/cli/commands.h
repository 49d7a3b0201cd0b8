/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The commands, one file each. */
#ifndef CONUS_CLI_COMMANDS_H
#define CONUS_CLI_COMMANDS_H

#include "options/options.h"

extern const struct command cmd_atlases;
extern const struct command cmd_info;
extern const struct command cmd_query;
extern const struct command cmd_batch;
extern const struct command cmd_render;
extern const struct command cmd_sweep;
extern const struct command cmd_track;
extern const struct command cmd_overlap;
extern const struct command cmd_connect;
extern const struct command cmd_plan;
extern const struct command cmd_manifest;
extern const struct command cmd_mesh;
extern const struct command cmd_phantom;
extern const struct command cmd_diff;
extern const struct command cmd_verify;
extern const struct command cmd_cite;
extern const struct command cmd_pack;
extern const struct command cmd_page;
extern const struct command cmd_view; /**< Another program's. */

#endif
