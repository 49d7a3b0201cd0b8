// SPDX-License-Identifier: BSD-3-Clause
// Owns conus: the page sends one message at a time, {id, call, ...}, and gets {id, ...} or {id, error}.
import createConus from "conus.mjs";

const FOLDER = "/atlas/";
/** Numbers of web.c's functions; those of text have "string". */
const SIGNATURES = {
  open: ["string", ["string"]], add_context: ["string", ["string"]], objects: ["string", []], use_colours: [null, ["number"]],
  ask: ["string", [...Array(6).fill("number"), "string", "number", "number"]], rows: ["string", ["number"]], sidecar: ["string", []], error: ["string", []],
  cut: ["number", Array(11).fill("number")], view: ["number", Array(9).fill("number")],
  mesh: ["string", ["number"]], mesh_end: [null, []], part: ["number", ["number"]],
};
const NDJSON = 4;
let module, conus;
/** Buffers that the page has given back: new ones take the machine longer to get than to fill. @type {ArrayBuffer[]} */
let spare = [];
let cut; // where cuts go that nobody has placed

const parse = (text) => {
  const value = JSON.parse(text);
  if (value.error) throw new Error(value.error);
  return value;
};
const pixels = (at, bytes) => {
  if (!at) parse(conus.error());
  const i = spare.findIndex((buffer) => buffer.byteLength === bytes);
  const buffer = i < 0 ? new ArrayBuffer(bytes) : spare.splice(i, 1)[0];
  new Uint8Array(buffer).set(module.HEAPU8.subarray(at, at + bytes));
  return buffer;
};

/** Where cuts go that nobody has placed: through the contact of the best hit, and a little into it; else the target. */
function placeCuts({ origin, toward }, rows) {
  const best = rows.split("\n").find((row) => /"contact_x":[-\d]/.test(row));
  if (!best) return toward;
  const { contact_x: x, contact_y: y, contact_z: z } = JSON.parse(best);
  const axis = toward.map((v, a) => v - origin[a]);
  return [x, y, z].map((v, a) => v + 0.001 * axis[a] / Math.hypot(...axis));
}

/** What is asked beside the places, as conus reads it. */
const settingsOf = ({ origin, toward, cut: place, ...settings }) => Object.entries(settings).filter(([, value]) => value !== false && value !== null).map((pair) => pair.join("=")).join("&");

const CALLS = {
  async start({ module: compiled }) {
    module = await new Promise((done, failed) => createConus({ locateFile: (name) => name, instantiateWasm(imports, use) {
      WebAssembly.instantiate(compiled, imports).then(use).catch(failed);
      return {};
    } }).then(done, failed));
    module.FS.mkdir(FOLDER.slice(0, -1));
    conus = Object.fromEntries(Object.entries(SIGNATURES).map(([name, [result, args]]) => [name, module.cwrap(`web_${name}`, result, args)]));
    return {};
  },
  /** Puts files where conus can open them: [[name with folders, bytes], ...]. */
  put({ files, gone = [] }) {
    for (const name of gone) module.FS.unlink(FOLDER + name);
    for (const [name, bytes] of files) {
      const parts = name.split("/").filter((part) => part && part !== "." && part !== "..");
      for (let i = 1; i < parts.length; i++) {
        const folder = FOLDER + parts.slice(0, i).join("/");
        if (!module.FS.analyzePath(folder).exists) module.FS.mkdir(folder);
      }
      module.FS.writeFile(FOLDER + parts.join("/"), new Uint8Array(bytes), { canOwn: true });
    }
    return {};
  },
  open({ name, image, kind }) {
    let atlas = parse(conus.open(FOLDER + name));
    if (image) atlas = parse(conus.add_context(FOLDER + image));
    if (kind) conus.use_colours(kind);
    return { atlas, objects: JSON.parse(conus.objects()) };
  },
  context: ({ name }) => ({ atlas: parse(conus.add_context(FOLDER + name)), objects: JSON.parse(conus.objects()) }),
  colours({ kind }) {
    conus.use_colours(kind);
    return { objects: JSON.parse(conus.objects()) };
  },
  /** The answer to a question and all pictures of it; of one that is refused why, and pictures without a cone. */
  draw({ question: q, step = [0, 0], cuts, view, chosen, given }) {
    spare = given;
    const { error: refused, depth, hits = [], ranks = [], colours = [] } = JSON.parse(conus.ask(...q.origin, ...q.toward, settingsOf(q), ...step)); // bits of web.c's enum step, and the time in s
    const rows = refused ? "" : conus.rows(NDJSON);
    if (!refused) cut = placeCuts(q, rows);
    const out = { refused, depth, rows, hits, ranks, colours, cut, cuts: [] };
    for (const c of cuts) {
      const through = 3 - c.right - c.up;
      if (!q.cut && cut) c.centre[through] = cut[through];
      const size = 4 * c.width * c.height;
      const rgba = pixels(conus.cut(c.right, c.up, ...c.centre, c.width, c.height, c.mm, c.fill, c.window[0], c.window[1]), size);
      out.cuts.push({ rgba, objects: pixels(conus.part(6), size) });
    }
    if (view) {
      const size = 4 * view.width * view.width;
      const rgba = pixels(conus.view(view.width, ...view.eye, ...view.toward, view.angle, chosen), size);
      out.view = { rgba, objects: pixels(conus.part(7), size), distances: pixels(conus.part(8), size) };
    }
    return out;
  },
  /** Surfaces of all areas: positions, normals, objects, corners, outer, first, as struct nets says. */
  mesh({ cells }) {
    const { sizes, closed } = parse(conus.mesh(cells));
    const parts = sizes.map((bytes, part) => pixels(conus.part(part), bytes));
    conus.mesh_end();
    return { parts, closed };
  },
  /** The answer as text: by its place in conus_format_at(), or the sidecar. */
  text: ({ format }) => ({ text: format ? conus.rows(format) : conus.sidecar() }),
};

let last = Promise.resolve();
const answer = async ({ data }) => {
  try {
    const out = await CALLS[data.call](data);
    const give = out.parts ?? [...(out.cuts ?? []), ...(out.view ? [out.view] : [])].flatMap((picture) => Object.values(picture));
    self.postMessage({ id: data.id, ...out }, give);
  } catch (error) {
    const words = error instanceof WebAssembly.RuntimeError ? "conus has stopped: this file needs more than a page has; the program can open it"
      : String(error?.message ?? error);
    self.postMessage({ id: data.id, error: words });
  }
};
self.onmessage = (event) => { last = last.then(() => answer(event)); }; // one after the other
