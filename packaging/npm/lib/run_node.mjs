// SPDX-License-Identifier: BSD-3-Clause
// The same in node, which does not fetch files of the package.
import { readFile } from "node:fs/promises";
import { run as runHere } from "./run.mjs";

export const run = async (words, files, options) => runHere(words, files, { wasm: await readFile(new URL("./conus-run.wasm", import.meta.url)), ...options });
