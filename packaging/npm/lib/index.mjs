// SPDX-License-Identifier: BSD-3-Clause
// conus in a page: files in, rows out. Each atlas has a worker of its own, which is that of conus page (apps/web).

const FORMATS = { sidecar: 0, tsv: 1, csv: 2, json: 3, ndjson: 4 }; // their places in conus_format_at()

export class ConusError extends Error {
  name = "ConusError";
}

/** Of options here, and files that lie nowhere. @param {string} text */
const plain = (text) => text.replaceAll("/atlas/", "").replace(/^--/, "");

/** @param {any} data @returns {Promise<ArrayBuffer>} its bytes, which the worker may keep */
const bytesOf = async (data) => (data instanceof ArrayBuffer ? data.slice(0) : ArrayBuffer.isView(data) ? new Uint8Array(data.buffer, data.byteOffset, data.byteLength).slice().buffer : data.arrayBuffer());

/** [[name, bytes], ...] of which the first is the atlas. @param {any} source @param {string} [name] */
function listFiles(source, name) {
  const isOne = source instanceof ArrayBuffer || ArrayBuffer.isView(source) || typeof source?.arrayBuffer === "function";
  const list = isOne ? [[name ?? source.name, source]] : Object.entries(source?.[Symbol.iterator] ? {} : source ?? {}); // files of a list have no names of their places
  if (!list.length || !list.every(([key]) => key)) throw new ConusError("name: the name of a file, whose ending says its format, is needed");
  return Promise.all(list.map(async ([key, data]) => [key, await bytesOf(data)]));
}

/** @param {string} name @param {any} p */
function readPlace(name, p) {
  const place = Array.from(p ?? []);
  if (place.length !== 3 || !place.every(Number.isFinite)) throw new ConusError(`${name}: a position is three numbers [x, y, z], RAS mm`);
  return place;
}

/** Options of conus page, which the worker joins to one text: numbers, words and [near, far]; undefined is what nobody said. */
function readSettings({ cut, ...settings }) {
  if (cut !== undefined) throw new ConusError("cut: rows have none");
  const said = Object.entries(settings).filter(([, value]) => value !== undefined);
  for (const [name, value] of said) {
    const isPair = Array.isArray(value) && value.length === 2 && value.every(Number.isFinite);
    if (!/^[\w-]+$/.test(name) || !isPair && typeof value !== "number" && !(typeof value === "string" && /^[\w.,=+-]+$/.test(value))) throw new ConusError(`${name}: a number, a word or two numbers [a, b] are needed`);
  }
  return Object.fromEntries(said);
}

export class Atlas {
  #worker;
  #waiting = new Map();
  #last = 0;
  #isRefused = false; // the last question, here already

  /** @param {any} worker */
  constructor(worker) {
    this.#worker = worker;
    worker.onmessage = ({ data }) => {
      const { done, failed } = this.#waiting.get(data.id) ?? {};
      if (!done) return; // it was closed before
      this.#waiting.delete(data.id);
      if (!this.#waiting.size) worker.unref?.(); // node ends where nothing is asked
      if (data.error === undefined) done(data);
      else failed(new ConusError(plain(data.error)));
    };
    worker.onerror = (event) => this.#end(event.message || "the worker cannot be started");
  }

  #end(why) {
    for (const { failed } of this.#waiting.values()) failed(new ConusError(why));
    this.#waiting.clear();
    this.#worker?.terminate();
    this.#worker = null;
  }

  #ask(call, data = {}) {
    if (!this.#worker) return Promise.reject(new ConusError("this atlas is closed"));
    this.#worker.postMessage({ id: ++this.#last, call, ...data });
    this.#worker.ref?.();
    return new Promise((done, failed) => this.#waiting.set(this.#last, { done, failed }));
  }

  static async load(source, { name, worker, wasm } = {}) {
    const files = await listFiles(source, name);
    const url = new URL("./conus.wasm", import.meta.url);
    const module = await (wasm ? WebAssembly.compile(wasm) : WebAssembly.compileStreaming(fetch(url)));
    const atlas = new this(worker ? await worker() : new Worker(new URL("./worker.js", import.meta.url)));
    try {
      await atlas.#ask("start", { module });
      await atlas.#ask("put", { files });
      const { atlas: found, objects } = await atlas.#ask("open", { name: files[0][0] });
      return Object.assign(atlas, found, { objects: objects.map(([title, r, g, b, side]) => ({ name: title, rgb: [r, g, b], side })) });
    } catch (error) {
      atlas.close();
      throw error;
    }
  }

  async select({ origin, toward, ...settings }) {
    this.#isRefused = true;
    if (settings.angle === undefined) throw new ConusError("angle: how wide the cone is, in degrees, is needed");
    const question = { ...readSettings(settings), origin: readPlace("origin", origin), toward: readPlace("toward", toward) };
    this.#isRefused = false;
    const { refused, rows, colours } = await this.#ask("draw", { question, cuts: [], view: null, chosen: 0, given: [] });
    if (refused) throw new ConusError(plain(refused));
    this.colours = colours;
    return rows.trim().split("\n").filter(Boolean).map((row) => JSON.parse(row));
  }

  async text(format = "tsv") {
    if (!Object.hasOwn(FORMATS, format)) throw new ConusError(`text: "${format}" is none of ${Object.keys(FORMATS).join(", ")}`);
    if (this.#isRefused) throw new ConusError("text: there is no answer");
    const { text } = await this.#ask("text", { format: FORMATS[format] });
    if (text.startsWith('{"error"')) throw new ConusError("text: there is no answer");
    return text;
  }

  close() {
    this.#end("this atlas is closed");
  }
}

export const load = (source, options) => Atlas.load(source, options);
