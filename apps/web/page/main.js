// SPDX-License-Identifier: BSD-3-Clause
// The page: joins files, fields, pictures and table; the worker owns conus.
import { MM, ROWS, START, digits, fromFragment, inPage, quoted, readRow, readWithin, sigmaOf, textOf, toCommand, toFragment, toMethods, toOptions } from "./state.js";
import { CUTS, Cut, ENDLESS, View } from "./panes.js";
import { Stage } from "./stage.js";
import { Headset } from "./vr.js";
import { candidates, chosen as chosenFiles, dropped, inside, read, unpacked } from "./files.js";

/** @typedef {import("./state.js").Question} Question */
const source = /** @type {HTMLElement} */ (document.documentElement.cloneNode(true)); // before anything changes, and without conus and the files, which stand below this code
const FORMATS = { tsv: 1, csv: 2, json: 3 }; // their places in conus_format_at(); the sidecar has none
const REST = 150; // ms without a change, and pictures are drawn in full
const BUSY = 12; // ms of a picture of 60 in a second, the rest is the browser's
const SHEET = 11; // rows on paper, as page.css says
const SPEAK = 700; // ms, and the answer is spoken
const TABLE = /\.(txt|tsv|csv|lut|ctbl|json)$/i;
const WORDS = { origin: "Start", toward: "Target" };
const GREYS = ["#black", "#white"]; // of the image below the areas
const NUDGES = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };

const $ = (/** @type {string} */ selector) => /** @type {any} */ (document.querySelector(selector));
const form = $("#aim");
const cuts = CUTS.map((plane, i) => new Cut(plane, $(`[data-pane="${i}"]`)));
const view = new View($('[data-pane="3"]'));
const panes = [...cuts, view];

/** @type {Question} */
let question = { ...START };
let place = START.toward; // of the cuts that are drawn
let end = /** @type {"origin" | "toward" | "cut"} */ ("toward");
let chosen = 0;
/** @type {any} */
let atlas = null;
/** Names, red, green, blue, and side, "L", "R" or "". @type {[string, number, number, number, string][]} */
let objects = [];
/** Numbers of the objects that the answer has, in its order. @type {number[]} */
let hits = [];
/** The place of each among the colours. @type {number[]} */
let ranks = [];
/** The colour of each by it and its share. @type {string[]} */
let tints = [];
/** The files of the open atlas, each with whether it is an image below the areas. @type {[string, ArrayBuffer, boolean?][]} */
let files = [];
/** Those that came last, of which one may be opened. @type {[string, ArrayBuffer, boolean?][]} */
let offered = [];
let atlasFile = "";
let linked = ""; // the atlas that the link is for, until it is open: so long the address stays as it is
let refused = ""; // why the question has no rows, until somebody changes it: its link is wrong, or for another atlas
/** Fields that are wrong until they are mended, and why. @type {Map<HTMLInputElement, string>} */
const wrongs = new Map();
let unanswered = ""; // why the newest pictures have no answer
let given = null; // the question and rows that the program wrote into the page
/** @type {any[]} */
let rows = [];
let rowsText = ""; // of the same, as conus wrote them
let rowsKey = "";
let edition = 0; // of the atlas, its image and colours
const isInside = location.protocol === "about:"; // of another page, which has the address and all of this one's text
let asked = 0; // the number of the newest question of that page

// The worker: one message at a time

const worker = new Worker(URL.createObjectURL(new Blob([$("#worker").textContent], { type: "text/javascript" })));
let last = 0;
const waiting = new Map();

/** @param {string} call @param {object} [data] @param {Transferable[]} [give] @returns {Promise<any>} */
function ask(call, data = {}, give = []) {
  return new Promise((done, failed) => {
    waiting.set(++last, { done, failed });
    worker.postMessage({ id: last, call, ...data }, give);
  });
}

worker.onmessage = ({ data }) => {
  const { done, failed } = waiting.get(data.id);
  waiting.delete(data.id);
  if (data.objects) {
    edition++;
    headset?.session?.end(); // which shows the atlas before
  }
  if (data.error === undefined) done(data);
  else failed(new Error(inPage(data.error)));
};
worker.onerror = (event) => say(`the page cannot run: ${event.message}`);

// Words

/** Shows an error, where it can be seen, below the field that it is of, or the answer; "" takes it away.
 * @param {string} words @param {HTMLInputElement | null} [field] */
function say(words, field) {
  const error = $("#error");
  $("[aria-describedby]")?.removeAttribute("aria-describedby");
  if (words) (field?.closest("fieldset, .row > label") ?? $("#said")).after(error);
  field?.setAttribute("aria-describedby", "error");
  error.textContent = words;
  error.hidden = !words;
  if (words) error.scrollIntoView({ block: "nearest" });
}

let ofAnswer = "";

/** What was found wrong last, and the field. @param {boolean} [ofQuestion] whether those of the image do not count
 * @returns {[string, HTMLInputElement?]} */
const lastWrong = (ofQuestion) => {
  const [field, words] = [...wrongs].filter(([field]) => !ofQuestion || field.form).pop() ?? [];
  return [words ?? "", field];
};

/** Shows the error of a field that is still wrong, in place of all others. */
const sayWrong = () => say(...lastWrong());

/** Takes what stands in a field; where that cannot be, it stays with its error, until it is mended.
 * @param {HTMLInputElement} field @param {() => void} step */
function takeField(field, step) {
  wrongs.delete(field);
  field.removeAttribute("aria-invalid");
  try {
    step();
  } catch (error) {
    wrongs.set(field, /** @type {Error} */ (error).message);
    field.setAttribute("aria-invalid", "true");
  }
  sayWrong();
  redraw();
}

/** Takes away only what an answer has said: the next one comes soon, and other errors are to be read.
 * @param {string} words @param {HTMLInputElement | null} [field] */
function sayOfAnswer(words, field) {
  if (words ? words !== $("#error").textContent : ofAnswer && $("#error").textContent === ofAnswer) say(words, field);
  ofAnswer = words;
}

/** Runs a step, whose error the page shows, and draws what it changed. @param {() => any} step */
const attempt = async (step) => {
  try {
    sayWrong();
    await step();
  } catch (error) {
    const [words, field] = lastWrong();
    const { message } = /** @type {Error} */ (error);
    say(message, message === words ? field : null);
  }
  redraw();
};

const identity = () => (atlas ? `${atlas.name}@${atlas.sha256.slice(0, 8)}` : "");

function describeAtlas() {
  const names = atlas.source ? `names: ${atlas.source}` : "areas have no names, only numbers";
  $("#atlas").textContent = `${atlas.name}${atlas.sha256 && ` (${atlas.sha256.slice(0, 8)})`}, ${atlas.objects} ${atlas.objects === 1 ? "object" : "objects"}; ${names}${atlas.identity ? `; ${atlas.identity} (${atlas.reference.replace(/\.$/, "")})` : ""}${atlas.notes.map((/** @type {string} */ note) => `. ${inPage(note)}`).join("")}`;
  $("#warnings").hidden = !atlas.warnings.length;
  $("#warnings").textContent = atlas.warnings.map((/** @type {string} */ warning) => `Warning: ${inPage(warning)}.`).join(" ");
  $("#version").textContent = `conus ${atlas.version}`;
  $("#window").hidden = !atlas.window;
  GREYS.forEach((id, i) => {
    $(id).value = atlas.window ? digits(atlas.window[i]) : "";
    if (wrongs.has($(id))) takeField($(id), () => {});
  });
}

const byRank = () => $("#colours").value !== "1";
/** mm from the start, of what no ray hits first to where the first enters it. @param {any} row */
const nearestOf = (row) => row.distance_mm ?? row.entry_mm;

/** How much a row has: its posterior, where a weight gives one, else its share. @param {any} row @param {number} [places] */
const partOf = ({ posterior, pixels, share, time_s: step }, places = 1) => (typeof posterior === "number" || pixels ? `${(100 * (posterior ?? share)).toFixed(places)} %` : step === undefined ? "behind" : "before");

/** An answer as one sentence, with the window's words. @param {any[]} rows @param {number[]} hits */
function sentence(rows, hits) {
  const best = rows.find((row) => row.kind !== "unassigned");
  if (!best) return "Nothing is hit — no area lies in the cone";
  const [title, , , , side] = objects[hits[0] - 1];
  const part = partOf(best, (best.posterior ?? best.share) < 0.01 ? 1 : 0).replace(" ", "\u00a0");
  const share = !best.pixels ? "behind others" : typeof best.posterior === "number" ? `meant with a probability of ${part}` : `${part} of the cone`;
  const nearest = nearestOf(best); // null of what lies between all rays
  return `${title}${side === "L" ? ", left" : side === "R" ? ", right" : ""} — ${share}${typeof nearest === "number" ? `, ${nearest.toFixed(1)}\u00a0mm from the start` : ""}`;
}

let speaking = 0;
function describeAnswer() {
  const words = unanswered ? "" : sentence(rows, hits);
  $("#equal").hidden = true; // compare() may show it
  if ($("#said").textContent !== words) $("#said").textContent = words;
  clearTimeout(speaking);
  speaking = setTimeout(() => { $("#spoken").textContent = words && `${words}; ${hits.length} ${hits.length === 1 ? "area" : "areas"}`; }, SPEAK);
}

// Table

const body = $("tbody");
const emptyRow = document.createElement("tr");
emptyRow.tabIndex = 0;
for (let i = 0; i < 5; i++) emptyRow.append(document.createElement("td"));
emptyRow.cells[1].append(document.createElement("span"), "");
/** @type {any} */ (emptyRow.cells[1].firstChild).className = "swatch";

/** Rows stay the elements that they are, so that a focus stays, and only what differs is laid out again. */
function fillTable() {
  const shown = rows.filter((row) => row.kind !== "unassigned");
  $("th:nth-child(3)").textContent = shown.some(({ posterior }) => typeof posterior === "number") ? "Posterior" : "Share";
  $("#more").textContent = shown.length > SHEET ? `and ${shown.length - SHEET} more, which have no room on this sheet` : "";
  while (body.rows.length > shown.length) body.lastChild.remove();
  while (body.rows.length < shown.length) body.append(emptyRow.cloneNode(true));
  shown.forEach((row, i) => {
    const tr = body.rows[i];
    const number = hits[i];
    const [title, ...rgb] = objects[number - 1];
    const nearest = nearestOf(row);
    const [swatch, name] = tr.cells[1].childNodes;
    swatch.style.setProperty("--chip", byRank() ? tints[i] ?? "LOOK_RANK_MORE" : `rgb(${rgb.slice(0, 3)})`);
    swatch.classList.toggle("behind", !row.pixels);
    if (name.data !== title) name.data = title;
    for (const [column, text] of Object.entries({ 0: String(row.rank), 2: partOf(row, 2), 3: String(row.pixels), 4: typeof nearest === "number" ? nearest.toFixed(1) : "" })) {
      if (tr.cells[column].textContent !== text) tr.cells[column].textContent = text;
    }
    tr.dataset.number = String(number);
    tr.setAttribute("aria-selected", String(number === chosen && chosen > 0));
  });
}

/** @param {Event} event */
function choose(event) {
  const number = Number(/** @type {HTMLElement} */ (event.target).closest("tr")?.dataset.number);
  chosen = chosen === number ? 0 : number;
  redraw();
}
body.onclick = choose;
body.onkeydown = (/** @type {KeyboardEvent} */ event) => { if (event.key === "Enter" || event.key === " ") { event.preventDefault(); choose(event); } };

/** Whether rows differ in nothing but the last digits of numbers, as those of surfaces do: Embree works in single precision.
 * @param {string} a @param {string} b */
function nearlyEqual(a, b) {
  const number = /-?\d+\.?\d*(e[-+]?\d+)?/g;
  const [x, y] = [a, b].map((text) => (text.match(number) ?? []).map(Number));
  return a.replace(number, "#") === b.replace(number, "#") && x.every((v, i) => Math.abs(v - y[i]) <= 1e-6 * Math.max(1, Math.abs(v)));
}

/** Compares the rows with those that the program wrote into the page. @param {string} text */
function compare(text) {
  const same = given && toFragment({ ...given.question, cut: question.cut }, "") === toFragment(question, "");
  $("#equal").hidden = !same;
  if (same) $("#equal").textContent = text === given.rows ? `These rows are equal to those of conus ${given.version}.`
    : nearlyEqual(text, given.rows) ? `These rows are equal to those of conus ${given.version} to a millionth.`
      : `These rows are NOT those that conus ${given.version} wrote into this page: ${given.rows}`;
}

/** The question with the place of its cuts. */
const aim = () => ({ ...question, cut: question.cut ?? place });

// Drawing: at most one question under way; the newest waits

let busy = false;
let again = false; // after the question under way
let isDue = false; // in the next frame
let moving = false;
let resting = 0;
/** Buffers that pictures no longer need, for the worker's next ones. @type {ArrayBuffer[]} */
const spare = [];
let detail = 1; // of what moves, so that a slow machine keeps up

/** Once in a frame, however often something moved. @param {boolean} [isMoving] */
function redraw(isMoving = false) {
  moving = isMoving;
  clearTimeout(resting);
  if (isMoving) resting = setTimeout(() => redraw(false), REST);
  if (!isDue) requestAnimationFrame(draw);
  isDue = true;
}

/** The content of a picture; a picture with the same content is not drawn again. @param {Cut | View} pane @param {boolean} isMoving */
function wanted(pane, isMoving) {
  const request = pane instanceof Cut ? { ...pane.request({ ...question, cut: question.cut ?? question.toward }, isMoving && detail, 0.55, atlas.window) } : pane.request(isMoving);
  return { pane, request, key: JSON.stringify([request, edition, chosen, pane instanceof Cut ? refused || lastWrong(true)[0] || { ...question, cut: !question.cut } : [hits, rows.filter((row) => !row.pixels).length]]) };
}

/** Draws what lies over the pictures. */
function annotate() {
  if (atlas) for (const pane of panes) pane.annotate(aim(), end, objects);
}

const shows = (/** @type {Cut | View} */ pane) => pane.box.offsetParent !== null;

/** The worker draws while this thread draws what lies over its pictures. */
function draw() {
  isDue = false;
  if (busy) again = true;
  else if (atlas) answer();
  fillFields();
  annotate();
}

async function answer() {
  const began = performance.now();
  const said = { id: asked, fragment: toFragment(question, "") };
  again = false;
  busy = true;
  const isCut = (/** @type {any} */ { pane }) => pane instanceof Cut;
  const isShown = (/** @type {any} */ { pane }) => shows(pane);
  const all = panes.filter((pane) => wanted(pane, false).key !== pane.key).map((pane) => wanted(pane, moving)).filter(({ pane, key }) => key !== pane.key);
  const shown = all.filter(isShown);
  // The 3-D view comes after the cuts, and what only paper shows last, at rest.
  const needed = moving ? shown : [shown.filter(isCut), shown].find((some) => some.length) ?? all;
  const isFirst = !moving && needed.length < all.length;
  const solid = needed.find((need) => !isCut(need));
  try {
    const given = spare.splice(0);
    const [why, field] = refused ? [refused] : lastWrong(true); // and then conus is asked what it refuses
    const drawn = await ask("draw", { question: why ? { ...question, toward: question.origin } : question, cuts: needed.filter(isCut).map(({ request }) => request), view: solid?.request ?? null, chosen, given }, given);
    hits = drawn.hits;
    ranks = drawn.ranks;
    tints = drawn.colours;
    const marked = byRank() ? hits.map((_, i) => hits[ranks.indexOf(i + 1)]) : []; // in the order of the colours
    spare.push(...needed.filter(isCut).flatMap(({ pane, request }, i) => pane.show(drawn.cuts[i], request, marked)));
    if (solid) spare.push(...view.show(drawn.view, solid.request, marked));
    for (const { pane, key } of needed) pane.key = key;
    unanswered = why || (drawn.refused ?? "").replace(/^toward: is the origin/, "Target: is the start");
    for (const pane of panes) pane.depth = unanswered ? 0 : drawn.depth || ENDLESS;
    panes.forEach(mark);
    const next = question.cut ?? drawn.cut ?? question.toward;
    const isElsewhere = String(next) !== String(place);
    place = next;
    if (!moving || isElsewhere) annotate(); // which says what it shows
    fillRows(drawn.rows);
    again ||= isFirst || (shows(view) || !moving) && wanted(view, moving).key !== view.key; // which shows what is hit
    sayOfAnswer(unanswered, why ? field : form.elements.toward0);
    const took = performance.now() - began;
    if (moving) detail = Math.min(1, Math.max(0.4, detail * (took > BUSY ? 0.85 : 1.02)));
    const { dataset } = document.body;
    dataset.took = took.toFixed(1);
    dataset.drawn = String(Number(dataset.drawn ?? 0) + 1);
  } catch (error) {
    unanswered = /** @type {Error} */ (error).message;
    fillRows("");
    sayOfAnswer(unanswered);
  }
  busy = false;
  if (isInside && !moving) parent.postMessage({ conus: { ...said, rows: rowsText, refused: unanswered } }, "*");
  if (again) answer();
  else if (!moving && !document.body.classList.contains("embed") && !isInside && !linked) {
    history.replaceState(null, "", unanswered ? location.pathname + location.search : `#${toFragment(question, identity())}`);
  }
}

/** @param {string} text @returns {any[]} */
const readRows = (text) => text.trim().split("\n").filter(Boolean).map((row) => JSON.parse(row));

/** Shows rows, and what follows from them; none of a question that is refused. @param {string} text */
function fillRows(text) {
  const key = JSON.stringify([text, edition, chosen]);
  if (key !== rowsKey) {
    rowsKey = key;
    rowsText = text;
    rows = readRows(text);
    fillTable();
  }
  describeAnswer();
  if (!unanswered) compare(text);
}

// Fields

function fillFields() {
  const write = (/** @type {string} */ name, /** @type {string} */ text) => {
    const field = form.elements[name];
    const isMended = field.hasAttribute("aria-invalid") && !wrongs.has(field); // by a picture, a key or a link
    if (isMended) field.removeAttribute("aria-invalid");
    if (isMended || document.activeElement !== field && !wrongs.has(field)) field.value = text;
  };
  for (const a of [0, 1, 2]) {
    write(`origin${a}`, digits(question.origin[a]));
    write(`toward${a}`, digits(question.toward[a]));
  }
  for (const row of ROWS) {
    const text = textOf(row, question[row.name]);
    if (row.type === "choice") form.elements[row.name].value = text;
    else if (row.type === "flag") form.elements[row.name].checked = Boolean(text);
    else write(row.name, text);
  }
  form.elements.end.value = end;
}

form.addEventListener("input", (/** @type {Event} */ event) => {
  const field = /** @type {HTMLInputElement} */ (event.target);
  refused = linked = "";
  takeField(field, () => {
    const row = ROWS.find(({ name }) => name === field.name);
    const found = /^(origin|toward)(\d)$/.exec(field.name);
    if (found) question[/** @type {"origin"} */ (found[1])] = /** @type {any} */ (question[/** @type {"origin"} */ (found[1])].map((v, a) => (a === Number(found[2]) ? readWithin(`${WORDS[/** @type {"origin"} */ (found[1])]} ${"xyz"[a]}`, field.value, MM) : v)));
    else if (row) question[row.name] = readRow(row, row.type === "flag" && !field.checked ? "" : field.value);
    else end = /** @type {any} */ (field.value);
    if (row?.name === "weight" && field.value && sigmaOf(question) > 0) question.angle = Math.min(170, 8 * sigmaOf(question)); // as conus query fills its cone
    if (end === "toward" && field.name.startsWith("toward")) question.cut = null;
  });
});
form.addEventListener("submit", (/** @type {Event} */ event) => event.preventDefault());

// Pointers and keys

/** Mends what is wrong in fields, by what was done in a picture. @param {string} name how theirs begin */
function mend(name) {
  refused = linked = "";
  for (const field of wrongs.keys()) if (field.form && field.name.startsWith(name)) wrongs.delete(field);
  if (!$("#error").hidden) sayWrong();
}

/** @param {"origin" | "toward" | "cut"} which @param {import("./state.js").Point} position */
function put(which, position) {
  mend(which);
  question[which] = /** @type {any} */ (position.map((v) => Number(v.toFixed(2))));
  if (which === "toward") question.cut = null;
}

/** Makes the cone wider by so many degrees. @param {number} degrees */
function openBy(degrees) {
  mend("angle");
  question.angle = Math.min(170, Math.max(0.5, question.angle + degrees));
}

/** The point of a pane under a pointer. @param {HTMLElement} over @param {{clientX: number, clientY: number}} event */
function pointOf(over, event) {
  const box = over.getBoundingClientRect();
  return [event.clientX - box.left, event.clientY - box.top];
}

/** Names what is under the pointer, in the picture that is shown. Returns whether that is another name. @param {Cut | View} pane */
function mark(pane) {
  const number = !pane.pointer ? 0 : pane instanceof Cut ? pane.object(pane.pointer) : pane.pick(pane.pointer)?.object ?? 0;
  const under = objects[number - 1]?.[0] ?? "";
  const isOther = under !== pane.under;
  pane.under = under;
  if (isOther) pane.over.setAttribute("aria-description", under);
  return isOther;
}

panes.forEach((pane, number) => {
  const over = pane.over;
  const touches = new Map();
  let drag = /** @type {any} */ (null);
  over.addEventListener("pointerdown", (event) => {
    over.setPointerCapture(event.pointerId);
    touches.set(event.pointerId, pointOf(over, event));
    const at = pointOf(over, event);
    const held = pane instanceof Cut ? pane.end(at, question) : null;
    drag = { at, held, moved: false, spread: 0 };
    if (held) end = held;
    if (pane instanceof Cut && !held && end === "cut") put("cut", pane.position(at, aim().cut)), redraw(true);
  });
  over.addEventListener("pointermove", (event) => {
    const at = pointOf(over, event);
    pane.pointer = at;
    if (mark(pane) && !drag) pane.annotate(aim(), end, objects);
    if (!drag || !touches.has(event.pointerId)) return;
    touches.set(event.pointerId, at);
    if (touches.size === 2) {
      const [a, b] = [...touches.values()];
      const spread = Math.hypot(a[0] - b[0], a[1] - b[1]);
      if (drag.spread) pane.zoomBy(spread / drag.spread);
      drag.spread = spread;
      drag.moved = true;
      return redraw(true);
    }
    drag.moved ||= Math.hypot(at[0] - drag.at[0], at[1] - drag.at[1]) > 3;
    if (!drag.moved) return;
    if (pane instanceof Cut) {
      const which = drag.held ?? (end === "cut" ? "cut" : null);
      if (which) put(which, pane.position(at, aim()[/** @type {"origin"} */ (which)]));
      else {
        pane.middle[0] -= (at[0] - drag.at[0]) * pane.mmPerPoint;
        pane.middle[1] += (at[1] - drag.at[1]) * pane.mmPerPoint;
        drag.at = at;
      }
    } else {
      pane.turnBy((at[0] - drag.at[0]) / 120, (at[1] - drag.at[1]) / 120);
      drag.at = at;
    }
    redraw(true);
  });
  const release = (/** @type {PointerEvent} */ event) => {
    const at = pointOf(over, event);
    touches.delete(event.pointerId);
    if (drag && !drag.moved && event.type === "pointerup") {
      if (pane instanceof Cut && !drag.held) put(end, pane.position(at, aim().cut));
      else if (pane instanceof View) {
        const hit = pane.pick(at);
        if (hit && (event.shiftKey || end === "origin")) {
          put("origin", /** @type {any} */ (hit.position.map((v, a) => v - pane.away * hit.inward[a])));
          put("toward", /** @type {any} */ (hit.position.map((v, a) => v + 30 * hit.inward[a])));
        } else if (hit) put(end, hit.position);
      }
      redraw();
    }
    if (!touches.size) drag = null;
  };
  over.addEventListener("pointerleave", () => {
    pane.pointer = null;
    if (mark(pane) && atlas) pane.annotate(aim(), end, objects);
  });
  over.addEventListener("pointerup", release);
  over.addEventListener("pointercancel", release);
  over.addEventListener("wheel", (event) => {
    event.preventDefault();
    if (event.altKey) openBy(-Math.sign(event.deltaY));
    else pane.zoomBy(Math.exp(-event.deltaY / 500));
    redraw(true);
  }, { passive: false });
  over.addEventListener("keydown", (event) => { if (key(event, pane, number)) event.preventDefault(); });
});

/** @param {KeyboardEvent} event @param {Cut | View} pane @param {number} number */
function key(event, pane, number) {
  const step = event.shiftKey ? 10 : event.altKey ? 0.1 : 1;
  const nudge = NUDGES[/** @type {"ArrowUp"} */ (event.key)];
  if (nudge && pane instanceof View && (event.ctrlKey || end === "cut")) {
    pane.turnBy(nudge[0] / 10, -nudge[1] / 10);
  } else if (nudge) {
    const { right, up } = pane instanceof Cut ? pane.plane : CUTS[0];
    const moved = [...aim()[end]];
    moved[right] += step * nudge[0];
    moved[up] += step * nudge[1];
    put(end, /** @type {any} */ (moved));
  } else if ((event.key === "PageUp" || event.key === "PageDown") && pane instanceof Cut) {
    const cut = [...aim().cut];
    cut[pane.plane.through] += event.key === "PageUp" ? step : -step;
    question.cut = /** @type {any} */ (cut);
  } else if (event.key === "[" || event.key === "]") openBy(event.key === "]" ? 1 : -1);
  else if (event.key === "+" || event.key === "-") pane.zoomBy(event.key === "+" ? 1.25 : 0.8);
  else if (event.key === "s") end = "origin";
  else if (event.key === "t") end = "toward";
  else if (event.key === "c" && !event.ctrlKey && !event.metaKey) save("link");
  else if (event.key === "?") $("details").open = true;
  else return false;
  redraw(true);
  return true;
}

// Tabs of a narrow screen

[...CUTS, { name: "3-D" }].forEach(({ name }, number) => {
  const tab = document.createElement("button");
  tab.type = "button";
  tab.textContent = name;
  tab.setAttribute("role", "tab");
  tab.onclick = () => showTab(number);
  $("#tabs").append(tab);
});

/** @param {number} number */
function showTab(number) {
  panes.forEach((pane, i) => pane.box.classList.toggle("shown", i === number));
  [...$("#tabs").children].forEach((tab, i) => tab.setAttribute("aria-selected", String(i === number)));
  layOut();
  redraw();
}

/** Canvases are squares in the middle of their boxes. */
function layOut() {
  for (const pane of panes) {
    for (const { style } of [pane.canvas, pane.over]) style.width = style.height = `${pane.side}px`;
  }
}
new ResizeObserver(() => { layOut(); redraw(true); }).observe($("#panes"));

// Files

/** @param {string} name of the atlas @param {string} [image] */
const load = (name, image) => ask("open", { name, image, kind: Number($("#colours").value) });

/** One of the files that are offered. @param {string} name @param {string} [image] below its areas */
async function open(name, image) {
  const isFirst = !atlas;
  ({ atlas, objects } = await load(name, image));
  files = offered;
  if (!isFirst) given = null; // which is of the atlas before
  atlasFile = name;
  chosen = 0;
  for (const pane of panes) {
    pane.frame(atlas.low, atlas.high);
    pane.objects = new Uint32Array(); // numbers of the atlas before
    mark(pane);
  }
  unanswered = "the answer is not there yet";
  fillRows("");
  document.body.classList.replace("empty", "full");
  if (isFirst && toFragment(question, "") === toFragment(START, "")) aimAt(atlas.low, atlas.high);
  layOut();
  describeAtlas();
  showWays();
  $("#choose-t1").disabled = false;
  checkLink();
}

/** Aims at the middle from the left, where the target that a page begins with is not in the atlas. @param {number[]} low @param {number[]} high */
function aimAt(low, high) {
  if (question.toward.every((v, a) => v > low[a] && v < high[a])) return;
  put("toward", /** @type {any} */ (low.map((v, a) => (v + high[a]) / 2)));
  put("origin", [low[0] - 0.2 * (high[0] - low[0]), question.toward[1], question.toward[2]]);
}

/** A link's question is for its atlas alone. */
function checkLink() {
  if (!linked) return;
  refused = linked === identity() ? "" : `This link is for ${linked}, not for ${identity()}, so that no rows are shown. Open that atlas, or change the question.`;
  if (!refused) linked = "";
}

/** Names areas by files beside the open atlas; where none of them does, all stays as it is. @param {string[]} names */
async function takeTable(names) {
  const image = files.find((file) => file[2])?.[0];
  const { window } = atlas;
  try {
    const { source } = (await load(atlasFile)).atlas;
    if (!names.some((name) => `${source},`.includes(` in ${name.replace(/.*\//, "")},`))) {
      const { message } = await ask("open", { name: names[0] }).catch((error) => error);
      throw new Error(`This is no label table of ${atlas.name}, all stays as it is: ${message ?? names[0]}`);
    }
    await open(atlasFile, image);
    if (window) atlas.window = window;
    describeAtlas();
  } catch (error) {
    offered = files;
    await ask("put", { files, gone: names });
    await load(atlasFile, image);
    throw error;
  }
}

/** @param {[string, File][]} list */
const take = (list) => attempt(async () => {
  const added = await read(list);
  await ask("put", { files: added });
  const names = candidates(added.map(([name]) => name));
  const isTable = atlas && !names.length && added.some(([name]) => TABLE.test(name)); // of the open atlas
  if (!names.length && !isTable) throw new Error(`${list.map(([name]) => name).join(", ")}: no atlas among them. ${$("#kinds").textContent}`);
  offered = isTable ? [...files.filter(([name]) => !added.some(([other]) => other === name)), ...added] : added;
  if (isTable) return takeTable(added.map(([name]) => name));
  const select = $("#which select");
  select.replaceChildren(...names.map((name) => new Option(name, name)));
  $("#which").hidden = names.length < 2;
  await open(names[0]).catch((error) => {
    throw new Error(atlas ? `${error.message} (if it is an image: “Image under the areas…”)` : error.message);
  });
});

for (const button of document.querySelectorAll("[data-choose]")) {
  /** @type {HTMLElement} */ (button).onclick = () => {
    $("#files").webkitdirectory = /** @type {HTMLElement} */ (button).dataset.choose === "folder";
    $("#files").click();
  };
}
$("#choose-t1").onclick = () => $("#t1").click();
$("#files").onchange = (/** @type {any} */ event) => take(chosenFiles(event.target.files));
$("#which select").onchange = (/** @type {any} */ event) => attempt(() => open(event.target.value));
$("#t1").onchange = (/** @type {any} */ event) => attempt(async () => {
  const added = await read(chosenFiles(event.target.files));
  await ask("put", { files: added });
  ({ atlas, objects } = await ask("context", { name: added[0][0] }));
  describeAtlas();
  files = [...files.filter((file) => !file[2]), [...added[0], true]];
});
GREYS.forEach((id, i) => {
  $(id).oninput = (/** @type {any} */ { target }) => takeField(target, () => { atlas.window[i] = readWithin(["Black", "White"][i], target.value, MM); });
});
$("#colours").onchange = () => attempt(async () => { if (atlas) ({ objects } = await ask("colours", { kind: Number($("#colours").value) })); });
addEventListener("dragover", (event) => { event.preventDefault(); document.body.classList.add("dropping"); });
addEventListener("dragleave", () => document.body.classList.remove("dropping"));
addEventListener("drop", (event) => {
  event.preventDefault();
  document.body.classList.remove("dropping");
  attempt(async () => take(await dropped(/** @type {DataTransfer} */ (event.dataTransfer))));
});

// Saving

/** @param {string} name @param {Blob} blob */
function download(name, blob) {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(blob);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 60000);
}

/** @param {ArrayBuffer} bytes */
function toBase64(bytes) {
  const all = new Uint8Array(bytes);
  let text = "";
  for (let i = 0; i < all.length; i += 0x8000) text += String.fromCharCode(...all.subarray(i, i + 0x8000));
  return btoa(text);
}

/** This page with the open atlas and the question inside, as `conus page` writes it. */
function wholePage() {
  const page = /** @type {HTMLElement} */ (source.cloneNode(true));
  const add = (/** @type {string} */ type, /** @type {string} */ text, /** @type {object} */ names) => {
    const block = Object.assign(document.createElement("script"), { type, textContent: text });
    for (const [name, value] of Object.entries(names)) block.setAttribute(name, value);
    page.lastElementChild?.append(block, "\n");
  };
  page.lastElementChild?.append($("#wasm").cloneNode(true), "\n", document.createComment(" atlas "), "\n");
  const first = files.filter(([name]) => name === atlasFile);
  for (const [name, bytes, isImage] of [...first, ...files.filter(([name]) => name !== atlasFile)]) {
    add("application/octet-stream", toBase64(bytes), { "data-file": name, ...isImage && { "data-context": "" } });
  }
  const asked = JSON.stringify({ fragment: toFragment(question, identity()), version: atlas.version, rows: rowsText });
  add("application/json", asked.replaceAll("<", "\\u003c"), { id: "question" });
  return `<!doctype html>\n${page.outerHTML}`;
}

/** The four pictures side by side with what is drawn over them. */
function picture() {
  const shown = panes.filter(shows);
  const side = Math.max(...shown.map((pane) => pane.canvas.width));
  const columns = shown.length > 1 ? 2 : 1;
  const sheet = new OffscreenCanvas(columns * side, Math.ceil(shown.length / columns) * side);
  const c = /** @type {OffscreenCanvasRenderingContext2D} */ (sheet.getContext("2d"));
  c.fillStyle = getComputedStyle(panes[0].box).backgroundColor;
  c.fillRect(0, 0, sheet.width, sheet.height);
  for (const pane of panes) pane.isStill = true;
  annotate();
  shown.forEach((pane, i) => {
    for (const canvas of [pane.canvas, pane.over]) c.drawImage(canvas, i % columns * side, Math.floor(i / columns) * side, side, side);
  });
  for (const pane of panes) pane.isStill = false;
  annotate();
  return sheet.convertToBlob({ type: "image/png" });
}

/** @param {string} kind */
const save = (kind) => attempt(async () => {
  if (!atlas) throw new Error("open an atlas first");
  if (unanswered && kind !== "png") throw new Error(unanswered);
  const name = `conus-${atlas.name.replace(/\..*/, "")}`;
  const copy = (/** @type {string} */ text) => navigator.clipboard.writeText(text)
    .then(() => { $("#spoken").textContent = `The ${kind} is copied.`; }, () => { prompt("Copy this:", text); });
  if (kind === "link") await copy(`${location.href.replace(/#.*/s, "")}#${toFragment(question, identity())}`);
  else if (kind === "command") await copy(toCommand(question, atlasFile));
  else if (kind === "png") download(`${name}.png`, await picture());
  else if (kind === "poses") savePoses();
  else if (kind === "page") download(`${name}.html`, new Blob([wholePage()], { type: "text/html" }));
  else {
    const format = FORMATS[/** @type {"tsv"} */ (kind)];
    download(`${name}.${format ? kind : "json"}`, new Blob([(await ask("text", { format })).text]));
  }
});
for (const button of document.querySelectorAll("[data-save]")) {
  /** @type {HTMLElement} */ (button).onclick = () => save(/** @type {HTMLElement} */ (button).dataset.save ?? "");
}

// Paper

const setPaper = (/** @type {boolean} */ isPaper) => { // on which panes are those of the light theme
  document.documentElement.classList.toggle("paper", isPaper);
  $("#methods").textContent = atlas && !unanswered ? toMethods(question, atlas) : "";
  for (const pane of panes) pane.over.width = 0, pane.lastNumber = isPaper ? SHEET : Infinity, pane.isStill = isPaper;
  annotate();
};
addEventListener("beforeprint", () => setPaper(true));
addEventListener("afterprint", () => setPaper(false));
matchMedia("(prefers-color-scheme: dark)").onchange = annotate;
$("#print").onclick = () => print();

// In a headset

const CELLS = 90; // of surfaces, along the atlas's longest side
const SOLID = 32; // areas that are drawn whole, at most; what lies behind others only where it has a colour of its own
const RANKED = 6;
const buttons = /** @type {NodeListOf<HTMLButtonElement>} */ (document.querySelectorAll("[data-enter]"));
const ways = new Set(); // that this browser has
/** @type {Stage | null} */
let stage = null;
/** @type {Headset | null} */
let headset = null; // the last that was entered
let surfaces = -1; // the edition of the atlas whose surfaces the stage has

/** What a headset shows of an answer. @param {any} drawn @returns {import("./vr.js").Answer} */
function describeFor({ refused = "", depth, rows: text, hits, ranks, colours }) {
  const rows = readRows(text);
  const found = rows.filter((row) => row.kind !== "unassigned").map((row, i) => {
    const [name, ...own] = objects[hits[i] - 1];
    const rgb = byRank() ? [1, 3, 5].map((at) => parseInt(colours[i].slice(at, at + 2), 16)) : own.slice(0, 3);
    return { number: hits[i], name, rgb: /** @type {number[]} */ (rgb), behind: !row.pixels, isDrawn: ranks[i] && (row.pixels || ranks[i] <= RANKED), share: partOf(row) };
  });
  const nameOf = (/** @type {string} */ what) => found.find((_, i) => rows[i][what])?.name ?? ""; // of a step
  return { refused: inPage(refused), depth, best: hits[0] ?? 0, contact: found.length && rows[0].pixels ? [rows[0].contact_x, rows[0].contact_y, rows[0].contact_z] : null, hits: found.filter(({ isDrawn }) => isDrawn).slice(0, SOLID),
    selected: nameOf("selected"), confirmed: nameOf("confirmed"), said: { sentence: refused ? "" : sentence(rows, hits), rows: found.slice(0, RANKED), more: Math.max(0, found.length - RANKED) } };
}

/** @param {"immersive-vr" | "immersive-ar"} mode */
const enter = (mode) => attempt(async () => {
  const here = stage ??= new Stage(() => { // its context is lost
    stage = null;
    surfaces = -1;
    headset?.session?.end();
  });
  const { low, high } = atlas;
  const entered = headset = new Headset(here, {
    question: { ...question }, low, high, file: atlasFile, name: atlas.name,
    ask: async (asked, step) => describeFor(await ask("draw", { question: asked, step, cuts: [], view: null, chosen: 0, given: [] })
      .catch(({ message }) => ({ refused: message, depth: 0, rows: "", hits: [] }))),
    hold: (held) => {
      mend("");
      question = held;
    },
    ended: () => {
      showWays();
      redraw();
    },
  });
  const begun = entered.start(mode); // while the press of the button counts
  for (const button of buttons) button.disabled = true;
  try {
    if (surfaces !== edition) {
      const now = edition;
      const { parts, closed } = await ask("mesh", { cells: CELLS });
      here.take(parts, Boolean(closed));
      surfaces = now;
    }
    await begun;
    entered.repaint();
  } catch (error) {
    await begun.then(() => entered.session?.end(), () => {});
    showWays();
    throw error;
  }
});

/** Buttons are there where the browser has a headset, and the atlas surfaces. */
function showWays() {
  for (const button of buttons) {
    button.hidden = !ways.has(button.dataset.enter) || !atlas?.solid;
    button.disabled = Boolean(headset?.session);
  }
  $('[data-save="poses"]').hidden = !headset?.record.size;
}

const { xr } = /** @type {any} */ (navigator);
const findWays = async () => {
  for (const { dataset: { enter: mode } } of buttons) {
    if (await xr.isSessionSupported(mode).catch(() => false)) ways.add(mode);
    else ways.delete(mode);
  }
  showWays();
};
if (xr) findWays();
xr?.addEventListener("devicechange", findWays);
for (const button of buttons) button.onclick = () => enter(/** @type {any} */ (button.dataset.enter));

/** What was asked in the headset, as tables that the commands in their first lines answer: one for each kind of question. */
function savePoses() {
  if (!headset) return;
  const { name: whole, file: atlasFile } = headset.page, name = whole.replace(/\..*/, ""); // of the atlas that was asked
  for (const [kind, lines] of headset.record) {
    const [layers, resolution, track] = kind.split("-");
    const file = `conus-${name}-${kind}.tsv`, isTrials = kind === "trials";
    const command = isTrials ? `calibrate --poses ${file}`
      : `${track ?? "batch"} ${quoted(atlasFile)} --poses ${file} --layers ${layers} --resolution ${resolution}${toOptions(headset.page.question, ["angle", "layers", "resolution", "range", ...track ? ["weight"] : []])}${track ? " --score intenselect_plus" : ""} -o rows.tsv`;
    const more = isTrials ? ["aim_x", "aim_y", "aim_z"] : ["near", "far", "layers", "resolution", "trigger"];
    const head = `# conus ${command}\n${["name", "time_s", "x", "y", "z", "tx", "ty", "tz", "angle", ...more].join("\t")}\n`;
    download(file, new Blob([head, lines.join("\n"), "\n"]));
  }
}

// Start

/** Takes a question from outside. @param {() => void} read */
function takeQuestion(read) {
  mend("");
  try {
    read();
  } catch (error) {
    refused = /** @type {Error} */ (error).message;
  }
  redraw();
}

function readLink() {
  const link = fromFragment(location.hash);
  question = link.question;
  linked = link.atlas;
  document.body.classList.toggle("embed", link.embed);
}

addEventListener("hashchange", () => takeQuestion(() => {
  readLink();
  if (atlas) checkLink();
}));

// A notebook's cell asks by a link, and receives each answer (conus.widget).
addEventListener("message", ({ source, data }) => {
  if (!isInside || source !== parent || typeof data?.conus?.ask !== "string") return;
  asked = data.conus.id;
  takeQuestion(() => { question = fromFragment(data.conus.ask).question; });
});

/** Opens what is inside the page. Conus is compiled while its worker starts and the files are unpacked. */
async function start() {
  const compiled = WebAssembly.compileStreaming(new Response(unpacked($("#wasm")), { headers: { "Content-Type": "application/wasm" } }));
  const unpacking = inside();
  const names = [...document.querySelectorAll("script[data-file]")].map((block) => /** @type {HTMLElement} */ (block).dataset.file);
  if (names.length) {
    $("#atlas").textContent = `Opening ${names[0]} …`;
    document.body.classList.replace("empty", "full");
  }
  showTab(0);
  $('[data-save="link"]').hidden = isInside;
  const block = document.getElementById("question");
  if (block) {
    given = JSON.parse(block.textContent ?? "");
    given.question = fromFragment(given.fragment).question;
    question = { ...given.question };
  }
  try {
    if (location.hash) readLink();
  } catch (error) {
    refused = /** @type {Error} */ (error).message; // and nothing is guessed
  }
  offered = /** @type {any} */ (await unpacking);
  const steps = [ask("start", { module: await compiled })];
  if (names.length) {
    const image = offered.find((file) => file[2])?.[0];
    steps.push(ask("put", { files: offered }), open(offered[0][0], image));
    ask("draw", { question, cuts: [], view: null, chosen: 0, given: [] }).catch(() => {}); // the worker goes on while this thread reads what it opened
  }
  await Promise.all(steps).finally(() => {
    if (!atlas) return;
    draw(); // not in the next frame
    describeAtlas();
  });
  say(refused);
}

addEventListener("DOMContentLoaded", () => attempt(start).finally(() => {
  if (!atlas) document.body.classList.replace("full", "empty");
  document.body.dataset.ready = "yes";
}));
