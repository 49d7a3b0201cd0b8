/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * TRX (github.com/tee-ar-ex/trx-spec): a folder, or a zip archive, of header.json and arrays whose names say what they
 * are. Positions are world mm (RAS) already; those in half precision stay so. */
#ifndef CONUS_LOADERS_TRACTS_TRX_H
#define CONUS_LOADERS_TRACTS_TRX_H

#include "atlas/tracts/tractogram.h"
#include "base/files/file.h"

/** True of a zip archive, whatever it holds, by its first bytes @p head, and of a folder @p path (it may be NULL) with
 * header.json. */
bool trx_is(const struct bytes *head, const char *path);

/** True of a folder, and of a name that ends in .trx: of an archive that trx_is() knows from its first bytes only. */
bool trx_is_named(const char *path);

/** Reads the archive or folder @p path: format, sum, points or halves, first, scalars and groups, which are to be
 * checked. CONUS_ERROR_IO, CONUS_ERROR_DATA for what contradicts itself, CONUS_ERROR_UNSUPPORTED, CONUS_ERROR_MEMORY
 * above @p max_memory bytes, those of the archive included. Messages carry the path. */
conus_status trx_read(struct tractogram *out, const char *path, uint64_t max_memory, struct notes *notes);

/** The same of an archive in memory, without sum and path. @p archive is the caller's to finish, and may be empty
 * afterwards: positions that are not packed stay where they are. */
conus_status trx_parse(struct tractogram *out, struct bytes *archive, uint64_t max_memory, struct notes *notes);

#endif
