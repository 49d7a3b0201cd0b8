// SPDX-License-Identifier: BSD-3-Clause
/** @file What ends conus-mesh, or the reading of one file. */
#ifndef CONUS_MESH_FAILURE_HPP
#define CONUS_MESH_FAILURE_HPP

#include <stdexcept>

/** One line that says what is wrong. */
struct Failure : std::runtime_error {
    using std::runtime_error::runtime_error;
};

#endif
