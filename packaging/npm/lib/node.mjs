// SPDX-License-Identifier: BSD-3-Clause
// The same in node: its threads as a page's workers, and files of the package, which node does not fetch.
import { readFile } from "node:fs/promises";
import { Worker } from "node:worker_threads";
import { Atlas, ConusError } from "./index.mjs";

const PAGE = `const { parentPort } = require("node:worker_threads");
globalThis.self = globalThis;
globalThis.location = { href: "" };
globalThis.crypto ??= require("node:crypto").webcrypto;
globalThis.postMessage = (data, give) => parentPort.postMessage(data, give);
parentPort.on("message", (data) => self.onmessage({ data }));
`;

async function startWorker() {
  const worker = new Worker(PAGE + await readFile(new URL("./worker.js", import.meta.url), "utf8"), { eval: true });
  worker.on("message", (data) => worker.onmessage({ data })).on("error", (error) => worker.onerror(error));
  return worker;
}

export const load = async (source, options) => Atlas.load(source, { worker: startWorker, wasm: await readFile(new URL("./conus.wasm", import.meta.url)), ...options });
export { Atlas, ConusError };
