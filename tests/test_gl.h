/* SPDX-License-Identifier: BSD-3-Clause */
/** @file What tests of the GL part share. */
#ifndef CONUS_TESTS_TEST_GL_H
#define CONUS_TESTS_TEST_GL_H

#include "render/context.h"
#include "test.h"

/** A context, or the running test is skipped, saying why. */
static inline struct gl_context *test_gl_context(conus_log log, void *log_user)
{
    struct gl_context *context = NULL;
    if (gl_context_create(&context, log, log_user)) {
        print_message("skipped: %s\n", conus_message());
        skip();
    }
    return context;
}

#endif
