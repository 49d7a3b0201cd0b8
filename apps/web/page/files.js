// SPDX-License-Identifier: BSD-3-Clause
// Files: those inside the page, those that are dropped or chosen, and which of them is the atlas.

const LIMIT = 2 ** 31;
/** Endings of what can be an atlas, the likeliest first, in the order of sources/endings.c; others (tables, colours) lie beside one. */
const ATLASES = [".atlas.json", ".dlabel.nii", ".nii", ".hdr", ".img", ".mgz", ".mgh", ".seg.nrrd", ".nrrd", ".nhdr", ".mha", ".mhd", ".head", ".brik", ".tiff", ".tif",
  ".surf.gii", ".label.gii", ".gii", ".annot", ".pial", ".white", ".inflated", ".obj", ".ply", ".stl", ".off", ".mz3", ".vtk", ".vtp", ".trk", ".tck", ".trx", ".tt", ".xml"];

/** The bytes of a block of base64. @param {Element} block */
function decoded(block) {
  const text = (block.textContent ?? "").trim();
  const { fromBase64 } = /** @type {any} */ (Uint8Array); // newer browsers have it
  if (fromBase64) return fromBase64.call(Uint8Array, text);
  const all = atob(text);
  const bytes = new Uint8Array(all.length);
  for (let i = 0; i < bytes.length; i++) bytes[i] = all.charCodeAt(i);
  return bytes;
}

/** Unpacks a block of base64 that is packed by gzip. @param {Element} block @returns {ReadableStream} */
export const unpacked = (block) => new Blob([decoded(block)]).stream().pipeThrough(new DecompressionStream("gzip"));

/** The files that the page has inside: [[name, bytes, whether it is an image below], ...], the atlas first. */
export async function inside() {
  const blocks = /** @type {HTMLElement[]} */ ([...document.querySelectorAll("script[data-file]")]);
  return Promise.all(blocks.map(async (block) => [block.dataset.file ?? "", block.dataset.packed === undefined ? decoded(block).buffer : await new Response(unpacked(block)).arrayBuffer(), block.hasAttribute("data-context")]));
}

/** @param {FileSystemEntry} entry @returns {Promise<[string, File][]>} */
async function walk(entry) {
  if (entry.isFile) {
    const file = await new Promise((done, failed) => /** @type {FileSystemFileEntry} */ (entry).file(done, failed));
    return [[entry.fullPath.replace(/^\//, ""), file]];
  }
  const reader = /** @type {FileSystemDirectoryEntry} */ (entry).createReader();
  const all = [];
  for (;;) { // each call gives some
    const some = await new Promise((done, failed) => reader.readEntries(done, failed));
    if (!some.length) return (await Promise.all(all.map(walk))).flat();
    all.push(...some);
  }
}

/** Files as they are: a page that is itself a file may not read them as entries, in Chromium. @param {DataTransfer} transfer @returns {Promise<[string, File][]>} */
export async function dropped(transfer) {
  const items = [...transfer.items].filter((item) => item.kind === "file").map((item) => ({ entry: item.webkitGetAsEntry(), file: item.getAsFile() }));
  return (await Promise.all(items.map(({ entry, file }) => (entry?.isDirectory || !file ? walk(/** @type {any} */ (entry)).catch(() => {
    throw new Error(`${entry?.name}: this browser does not open a folder here; drop the files in it, or choose it`);
  }) : [/** @type {[string, File]} */ ([file.name, file])])))).flat();
}

/** @param {FileList} list @returns {[string, File][]} */
export const chosen = (list) => [...list].map((file) => [file.webkitRelativePath || file.name, file]);

/** Reads them, or says which are too large. @param {[string, File][]} files */
export async function read(files) {
  const size = files.reduce((sum, [, file]) => sum + file.size, 0);
  if (size > LIMIT) throw new Error(`${(size / 1e9).toFixed(1)} GB: a page opens 2 GB; the program conus has no such limit`);
  return Promise.all(files.map(async ([name, file]) => /** @type {[string, ArrayBuffer]} */ ([name, await file.arrayBuffer()])));
}

/** Which of the names may be the atlas, the likeliest first. @param {string[]} names */
export function candidates(names) {
  const place = (/** @type {string} */ name) => ATLASES.findIndex((ending) => name.toLowerCase().replace(/\.gz$/, "").endsWith(ending));
  return names.filter((name) => place(name) >= 0).sort((a, b) => place(a) - place(b) || a.length - b.length || (a < b ? -1 : 1));
}
