// SPDX-License-Identifier: BSD-3-Clause
// The question as the link, the fields and the command line have it. All positions are RAS mm, angles degrees.

/**
 * @typedef {[number, number, number]} Point
 * @typedef {{origin: Point, toward: Point, angle: number, layers: "visible" | "all", resolution: number, cut: Point}} Question
 */

/** @type {Question} */
export const START = { origin: [-90, 20, 20], toward: [0, -10, 10], angle: 20, layers: "visible", resolution: 16, cut: [0, -10, 10] };

/** A number with the digits that a person would type. @param {number} x */
export const digits = (x) => String(Number(x.toFixed(3)));

/** @param {Point} p */
const join = (p) => p.map(digits).join(",");

/** The part of a link behind #. @param {Question} q @param {string} atlas "aal.nii.gz@b512dcd3", or "" */
export function toFragment(q, atlas) {
  const pairs = { v: "1", atlas: encodeURIComponent(atlas).replaceAll("%40", "@"), origin: join(q.origin), toward: join(q.toward),
    angle: digits(q.angle), layers: q.layers, resolution: String(q.resolution), cut: join(q.cut) };
  return Object.entries(pairs).filter(([, value]) => value).map(([key, value]) => `${key}=${value}`).join("&");
}

/** @param {string} text @returns {Point} */
function readPoint(text) {
  const p = text.split(",").map(readNumber);
  if (p.length !== 3) throw new Error(`${text}: a position is three numbers x,y,z`);
  return /** @type {Point} */ (p);
}

/** @param {string} text */
function readNumber(text) {
  const x = /^[+-]?(\d+\.?\d*|\.\d+)$/.test(text) ? Number(text) : NaN;
  if (!(Math.abs(x) <= 1e5)) throw new Error(`${text}: a number from -100000 to 100000 is needed`);
  return x;
}

/** @param {string} text @param {number} low @param {number} high */
export function readWithin(text, low, high) {
  const x = readNumber(text.trim());
  if (!(x >= low && x <= high)) throw new Error(`${text}: ${low} to ${high} is allowed`);
  return x;
}

const READ = {
  origin: readPoint, toward: readPoint, cut: readPoint,
  angle: (/** @type {string} */ text) => readWithin(text, 0.001, 170),
  resolution: (/** @type {string} */ text) => Math.round(readWithin(text, 1, 256)),
  layers: (/** @type {string} */ text) => {
    if (text !== "visible" && text !== "all") throw new Error(`layers=${text}: visible and all are allowed`);
    return text;
  },
};

/**
 * Reads the part of a link behind #; throws, with words, at what it does not know: nothing is guessed.
 * @param {string} text @returns {{question: Question, atlas: string, embed: boolean}}
 */
export function fromFragment(text) {
  const question = /** @type {any} */ ({ ...START });
  let atlas = "";
  let embed = false;
  if (text.length > 1000) throw new Error("this link is longer than any that a page makes");
  for (const pair of text.replace(/^#/, "").split("&").filter(Boolean)) {
    const [key, value = ""] = pair.split(/=(.*)/s);
    if (Object.hasOwn(READ, key)) question[key] = /** @type {any} */ (READ)[key](decodeURIComponent(value));
    else if (key === "atlas") atlas = decodeURIComponent(value);
    else if (key === "embed") embed = value === "1";
    else if (key === "v" && value === "1") continue;
    else throw new Error(key === "v" ? `this link is of version ${value}; this page knows version 1` : `this link has "${key}", which this page does not know`);
  }
  return { question, atlas, embed };
}

/** The command that gives the same rows. @param {Question} q @param {string} name */
export function toCommand(q, name) {
  const file = /^[\w./-]+$/.test(name) ? name : `'${name.replaceAll("'", "'\\''")}'`;
  return `conus query ${file} --origin ${join(q.origin)} --toward ${join(q.toward)} --angle ${digits(q.angle)}` +
    (q.layers === "all" ? " --layers all" : "") + (q.resolution !== START.resolution ? ` --resolution ${q.resolution}` : "");
}
