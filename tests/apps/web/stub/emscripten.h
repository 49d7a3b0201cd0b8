/* SPDX-License-Identifier: BSD-3-Clause */
/* Stands for emscripten's header where the page's functions are built for this machine. */
#define EMSCRIPTEN_KEEPALIVE
