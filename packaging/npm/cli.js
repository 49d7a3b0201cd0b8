#!/usr/bin/env node
// SPDX-License-Identifier: BSD-3-Clause
"use strict";
if (process.platform === "win32") {
  console.error("conus: npm's program is not for Windows; take the program for Windows");
  process.exit(3);
}
require("./conus.js");
