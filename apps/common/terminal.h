/* SPDX-License-Identifier: BSD-3-Clause */
/** @file What a terminal can show: so many columns, and colour or not. */
#ifndef CONUS_COMMON_TERMINAL_H
#define CONUS_COMMON_TERMINAL_H

#include <stdbool.h>
#include <stddef.h>

/** Columns of the terminal at @p descriptor: as it says, else $COLUMNS; 0 where it is no terminal or nothing says. */
size_t terminal_width(int descriptor);

/** Whether @p descriptor is a terminal that shows bold and colours: neither $NO_COLOR nor TERM=dumb forbids them. */
bool terminal_has_colour(int descriptor);

#endif
