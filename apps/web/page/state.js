// SPDX-License-Identifier: BSD-3-Clause
// The question as the link, the fields and the command line have it. All positions are RAS mm, angles degrees.

/**
 * @typedef {[number, number, number]} Point
 * @typedef {{name: string, type: "number" | "count" | "range" | "choice" | "flag" | "text", help: string, unit?: string, default?: string, common: boolean, range?: {low: number, high: number}, choices?: string[]}} Row
 * @typedef {{origin: Point, toward: Point, angle: number, layers: "visible" | "all", resolution: number, range: number[] | null, cut: Point | null} & Record<string, any>} Question; cuts without a place go through the contact of the best hit
 */

/** What is asked beside the two places: apps/pages/question.c has the rows, pack.mjs puts them here. @type {Row[]} */
export const ROWS = CONUS_ROWS;

/** A number with the digits that a person would type. @param {number} x */
export const digits = (x) => String(Number(x.toFixed(3)));

/** A message of conus in the page's words: there are no options here. @param {string} text */
export const inPage = (text) => text.replace(/^--/, "").replaceAll("/atlas/", "").replace("--context draws an image", "“Image under the areas…” draws an image")
  .replace(/ \([^()]*(--|'conus )[^()]*\)/g, "").replace(/[,;:] [^,;:]*--[a-z][^,;:]*(, and [^,;:]*)?/g, "");

/** @param {Point} p */
const join = (p) => p.map(digits).join(",");

/** The part of a link behind #. @param {Question} q @param {string} atlas "aal.nii.gz@b512dcd3", or "" */
export function toFragment(q, atlas) {
  const pairs = { v: "1", atlas: encodeURIComponent(atlas).replaceAll("%40", "@"), origin: join(q.origin), toward: join(q.toward),
    ...Object.fromEntries(ROWS.map((row) => [row.name, textOf(row, q[row.name])])), cut: q.cut ? join(q.cut) : "" };
  return Object.entries(pairs).filter(([, value]) => value).map(([key, value]) => `${key}=${value}`).join("&");
}

/** mm of a position. @type {[number, number]} */
export const MM = [-1e5, 1e5];

/** A number in words; throws, with what the number is of. @param {string} what @param {string} text @param {number[]} limits */
export function readWithin(what, text, [low, high]) {
  const x = /^[+-]?(\d+\.?\d*|\.\d+)(e-\d+)?$/.test(text.trim()) ? Number(text) : NaN;
  if (!(x >= low && x <= high)) throw new Error(`${what}: ${text.trim() || "nothing"} is not a number from ${low} to ${high}`);
  return x;
}

/** @param {string} text @param {string} key @returns {Point} */
function readPoint(text, key) {
  const p = text.split(",").map((x) => readWithin(key, x, MM));
  if (p.length !== 3) throw new Error(`${key}=${text}: a position is three numbers x,y,z`);
  return /** @type {Point} */ (p);
}

/** The value of a row in words; throws, with what is allowed. @param {Row} row @param {string} text */
export function readRow({ name, type, range, choices = ["1", ""] }, text) {
  if (type === "number" || type === "count") {
    const x = readWithin(name, text, range ? [range.low, range.high] : [-Infinity, Infinity]);
    if (type === "count" && !Number.isInteger(x)) throw new Error(`${name}: ${text} is no whole number`);
    return x;
  }
  if (type === "range") {
    if (!text) return null;
    const ends = text.split(",").map((x) => readWithin(name, x, range ? [range.low, range.high] : [-Infinity, Infinity]));
    if (ends.length !== 2 || ends[0] >= ends[1]) throw new Error(`${name}=${text}: two numbers are allowed, the first below the second`);
    return ends;
  }
  if (type === "text") {
    if (!/^[\w=.]{0,40}$/.test(text)) throw new Error(`${name}: ${text} has what no ${name} has`);
    return text || null;
  }
  if (!choices.includes(text)) throw new Error(`${name}=${text}: ${choices.join(" and ")} are allowed`);
  return type === "choice" ? text : Boolean(text);
}

/** And back. @param {Row} row @param {any} value */
export const textOf = ({ type, unit }, value) => (type === "flag" ? (value ? "1" : "") : type === "range" ? value?.map(digits).join(",") ?? "" : type === "choice" || type === "text" ? value ?? "" : unit ? digits(value) : String(Number(value.toPrecision(9))));

/** @type {Question} */
export const START = { origin: [-90, 20, 20], toward: [0, -10, 10], cut: null, .../** @type {any} */ (Object.fromEntries(ROWS.map((row) => [row.name, readRow(row, row.default ?? "")]))) };

const READ = /** @type {Record<string, (text: string, key: string) => any>} */ ({ origin: readPoint, toward: readPoint, cut: readPoint,
  ...Object.fromEntries(ROWS.map((row) => [row.name, (/** @type {string} */ text) => readRow(row, text)])) });

/**
 * Reads the part of a link behind #; throws, with words, at what it does not know: nothing is guessed.
 * @param {string} text @returns {{question: Question, atlas: string, embed: boolean}}
 */
export function fromFragment(text) {
  const question = /** @type {any} */ ({ ...START });
  const said = new Set();
  let atlas = "";
  let embed = false;
  if (text.length > 1000) throw new Error("this link is longer than any that a page makes");
  for (const pair of text.replace(/^#/, "").split("&").filter(Boolean)) {
    const [key, value = ""] = pair.split(/=(.*)/s);
    if (said.has(key)) throw new Error(`this link has "${key}" twice`);
    said.add(key);
    if (Object.hasOwn(READ, key)) question[key] = READ[key](decodeURIComponent(value), key);
    else if (key === "atlas") atlas = decodeURIComponent(value);
    else if (key === "embed") embed = value === "1";
    else if (key === "v" && value === "1") continue;
    else throw new Error(key === "v" ? `this link is of version ${value}; this page knows version 1` : `this link has "${key}", which this page does not know`);
  }
  return { question, atlas, embed };
}

/** The rays of a cone: pixels whose centre is in the round aperture. @param {number} n */
function countRays(n) {
  let count = 0;
  for (let i = 0; i < n * n; i++) count += Number(Math.hypot(i % n + 0.5 - n / 2, Math.floor(i / n) + 0.5 - n / 2) <= n / 2);
  return count;
}

/** The paragraph that conus cite writes of the answer. @param {Question} q @param {any} atlas */
export function toMethods(q, atlas) {
  const all = q.layers === "all";
  const others = toOptions(q, ["angle", "layers", "resolution", "range", "weight"]); // of which no sentence below is
  const weight = q.weight && sigmaOf(q);
  return `The areas in a cone with its apex at ${join(q.origin)} and its axis through ${join(q.toward)} (x,y,z, RAS mm), and a full opening angle of ${digits(q.angle)}°, were determined with conus, version ${atlas.version}, which selects by conic volumes after Rick et al. (2010, doi:10.1109/VR.2010.5444783). ` +
    (q.range ? `Only what lies between two depths along the axis counted: ${q.range.map(digits).join(" mm and ")} mm from the apex. ` : "") +
    `The cone was filled with ${countRays(q.resolution)} rays${q.angle > 120 ? " (evenly spread in angle where it opens beyond 120°)" : ""}, one through the centre of each pixel in the round aperture of ${q.resolution} × ${q.resolution} pixels. ` +
    `Each ray was followed exactly, ${all ? "through all objects" : "to the first object that it hits"}: no voxel and no triangle on its way was left out. An object's share is the part of the solid angle whose rays hit this object before any other. ` +
    (all ? "Occluded objects counted, too. " : "") + (others ? `Other settings were${others}. ` : "") + `Objects were ranked by ${weight ? "the score posterior (Eq. 12 of conus's documentation)" : "their share"}. ` +
    (weight ? `Rays were weighted by a normal error of the axis's tilt, with a standard deviation of ${weight}° about each of two axes: an object's weight is the probability that the axis, if it lies in the cone, meets it before any other (Eq. 30 and 31 of conus's documentation). ` +
      `${all ? "An object's dose is the integral of the weight over its part in the cone or ball (Eq. 33). " : ""}The posterior of an object is the probability that it is meant, if each object is meant as often (Eq. 32). ` : "") + `The atlas was ${atlas.name}${atlas.sha256 && ` (SHA-256 ${atlas.sha256.slice(0, 8)}…; ${atlas.transform})`}. ` +
    "The cone is a geometric model: no field, heat or sound was computed.";
}

/** Degrees that a hand is off, of a weight. @param {Question} q */
export const sigmaOf = ({ weight }) => Number(weight.replace("gauss=", ""));

/** A file's name as a shell reads it. @param {string} name */
export const quoted = (name) => (/^[\w./-]+$/.test(name) ? name : `'${name.replaceAll("'", "'\\''")}'`);

/** Its options beside the places, without some: those that are always said, and what is not as it began; of a weight the score, too.
 * @param {Question} q @param {string[]} but */
export const toOptions = (q, but = []) => ROWS.filter((row) => !but.includes(row.name) && (row.common || q[row.name] !== START[row.name]))
  .map((row) => ` --${row.name}${row.type === "flag" ? "" : ` ${textOf(row, q[row.name])}`}${row.name === "weight" ? " --score posterior" : ""}`).join("");

/** The command that gives the same rows. @param {Question} q @param {string} name */
export function toCommand(q, name) {
  return `conus query ${quoted(name)} --origin ${join(q.origin)} --toward ${join(q.toward)}${toOptions(q)}`;
}
