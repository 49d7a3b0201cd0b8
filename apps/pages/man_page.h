/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Man pages, in the macros of man(7). */
#ifndef CONUS_PAGES_MAN_PAGE_H
#define CONUS_PAGES_MAN_PAGE_H

#include "pages/pages.h"

/** The page of a program with several commands: what it is, its commands, its exit codes. */
void man_page_program(FILE *out, const struct program *program);

/** The page of one command; of a program with only this one, the program's page. False without memory. */
bool man_page_command(FILE *out, const struct program *program, const struct command *command);

#endif
