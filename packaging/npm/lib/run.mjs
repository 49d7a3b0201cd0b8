// SPDX-License-Identifier: BSD-3-Clause
// conus's command line in memory: words and files in, text and files out. Each run is a fresh conus in an empty folder.
import createConus from "./conus-run.mjs";

const FOLDER = "/run/";

/** The files of a folder and of those in it. @param {any} FS @param {string} folder @returns {string[]} */
const listed = (FS, folder) => FS.readdir(folder).filter((name) => name !== "." && name !== "..")
  .flatMap((name) => (FS.isDir(FS.stat(folder + name).mode) ? listed(FS, `${folder}${name}/`) : [folder + name]));

/** @returns {[string, Uint8Array]} */
function readFile([name, data]) {
  if (!name || name.split("/").some((part) => !part || part === "." || part === "..")) throw new TypeError(`${name}: a name of a file in the folder is needed`);
  if (!(data instanceof ArrayBuffer || ArrayBuffer.isView(data))) throw new TypeError(`${name}: bytes are needed`);
  return [FOLDER + name, ArrayBuffer.isView(data) ? new Uint8Array(data.buffer, data.byteOffset, data.byteLength) : new Uint8Array(data)];
}

const text = (bytes) => new TextDecoder().decode(Uint8Array.from(bytes));
const same = (a, b) => a?.length === b.length && a.every((byte, i) => byte === b[i]);

let compiled;

export async function run(words, files = {}, { wasm } = {}) {
  if (!Array.isArray(words) || !words.every((word) => typeof word === "string")) throw new TypeError("words: a list of texts is needed");
  const given = new Map(Object.entries(files).map(readFile));
  compiled ??= await (wasm ? WebAssembly.compile(wasm) : WebAssembly.compileStreaming(fetch(new URL("./conus-run.wasm", import.meta.url))));
  const said = [[], []];
  const conus = await new Promise((done, failed) => createConus({
    stdin: () => null, stdout: (byte) => said[0].push(byte), stderr: (byte) => said[1].push(byte),
    quit: (status, error) => { throw error; },
    instantiateWasm(imports, use) {
      WebAssembly.instantiate(compiled, imports).then(use).catch(failed);
      return {};
    },
  }).then(done, failed));
  const { FS } = conus;
  FS.mkdir(FOLDER);
  FS.chdir(FOLDER);
  for (const [name, bytes] of given) {
    FS.mkdirTree(name.slice(0, name.lastIndexOf("/")));
    FS.writeFile(name, bytes);
  }
  let code;
  try {
    code = conus.callMain([...words]);
  } catch (error) {
    if (error?.name !== "ExitStatus") throw error;
    code = error.status;
  }
  const made = listed(FS, FOLDER).map((name) => [name, FS.readFile(name)]).filter(([name, bytes]) => !same(given.get(name), bytes));
  return { code, stdout: text(said[0]), stderr: text(said[1]), files: Object.fromEntries(made.map(([name, bytes]) => [name.slice(FOLDER.length), bytes])) };
}
