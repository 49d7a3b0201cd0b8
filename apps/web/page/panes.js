// SPDX-License-Identifier: BSD-3-Clause
// The three cuts and the 3-D view: canvases, what a pointer and keys do in them, and the handles of the cone.
import { digits } from "./state.js";

/** @typedef {import("./state.js").Point} Point */
/** @typedef {{origin: Point, toward: Point, angle: number, range?: number[] | null, cut: Point}} Aim */

/** Each cut: its name, the axes to its right and top, the axis through it, and letters of its left, right, top, bottom. */
export const CUTS = [
  { name: "Axial", right: 0, up: 1, through: 2, letters: "LRAP" },
  { name: "Coronal", right: 0, up: 2, through: 1, letters: "LRSI" },
  { name: "Sagittal", right: 1, up: 2, through: 0, letters: "PASI" },
];
export const ENDLESS = 1e4; // mm, in place of a cone's depth
const HANDLE = 12; // pixels of the page around an end of the axis that take it

/** Makes transparent what is empty in a cut: over an image only from the edges on, so that what is dark in a brain stays.
 * @param {ArrayBuffer} rgba @param {Uint32Array} objects @param {number} width @param {boolean} hasImage */
function clearGround(rgba, objects, width, hasImage) {
  const pixels = new Uint32Array(rgba);
  const next = /** @type {number[]} */ ([]);
  const around = (/** @type {number} */ i) => [i - 1, i + 1, i - width, i + width]; // beside a row's end, too, where the next one begins
  const visit = (/** @type {number} */ i) => {
    if (pixels[i] !== 0xff000000) return; // opaque black
    pixels[i] = 0;
    if (hasImage) next.push(i);
  };
  for (let i = 0; i < objects.length; i++) if (!hasImage || i < width || i >= objects.length - width || i % width === 0) visit(i);
  while (next.length) {
    for (const i of around(/** @type {number} */ (next.pop()))) {
      visit(i);
      if (objects[i]) around(i).forEach(visit); // the outline of an area outside of the image
    }
  }
}

let ink = ""; // of words and lines over pictures, by the page's theme, and what is around them
let ground = "";
/** Left, right and base of each word and end of the axis over a picture. @type {number[][]} */
let written = [];
const AROUND = [0, -1, 1].flatMap((x) => [0, -1, 1].map((y) => [x, y]));

/** Empties a canvas of so many points of the page, and returns its context. @param {HTMLCanvasElement} canvas @param {number} side */
function cleared(canvas, side) {
  const pixels = Math.round(side * devicePixelRatio);
  const isNew = canvas.width !== pixels || canvas.height !== pixels;
  if (isNew) [canvas.width, canvas.height] = [pixels, pixels]; // slow
  const c = /** @type {CanvasRenderingContext2D} */ (canvas.getContext("2d"));
  c.setTransform(devicePixelRatio, 0, 0, devicePixelRatio, 0, 0);
  if (!isNew) c.clearRect(0, 0, side, side); // which on paper also clears what is below
  written = [];
  ({ color: ink, backgroundColor: ground } = getComputedStyle(/** @type {Element} */ (canvas.parentElement)));
  return c;
}

const COLOURED = 6; // hits that have a colour of their own; the others share a grey, and have numbers

/** Places of the numbers of hits: each on the pixel of its object that is nearest to the middle of what shows of it, in
 * parts of the picture. @param {Uint32Array} objects @param {number} width @param {number[]} hits */
function numbered(objects, width, hits) {
  const found = new Map(hits.slice(COLOURED).map((object, i) => [object, { object, text: String(COLOURED + 1 + i), count: 0, x: 0, y: 0, near: Infinity, at: [0, 0] }]));
  if (!found.size) return [];
  const visit = (/** @type {(label: any, x: number, y: number) => void} */ step) => {
    for (let i = 0; i < objects.length; i += 2) {
      const label = objects[i] && found.get(objects[i]);
      if (label) step(label, i % width, Math.floor(i / width));
    }
  };
  visit((label, x, y) => { label.count++; label.x += x; label.y += y; });
  visit((label, x, y) => {
    const far = Math.hypot(x - label.x / label.count, y - label.y / label.count);
    if (far < label.near) [label.near, label.at] = [far, [x / width, y / width]];
  });
  return [...found.values()].filter((label) => label.count > objects.length / 4000);
}

/** A picture of the worker, and what is drawn over it. */
class Pane {
  /** @param {HTMLElement} box */
  constructor(box) {
    this.box = box;
    [this.canvas, this.over] = /** @type {HTMLCanvasElement[]} */ ([...box.querySelectorAll("canvas")]);
    this.zoom = 1;
    this.objects = new Uint32Array(); // of each pixel
    /** @type {{text: string, object: number, at: number[]}[]} */
    this.numbers = [];
    this.lastNumber = Infinity; // of paper that of the last row that its table has
    this.isStill = false; // on paper or in a file: nobody can turn it
    /** Where the pointer is. @type {number[] | null} */
    this.pointer = null;
    this.under = ""; // the name of what is under it
    this.depth = 0; // mm from the start to the deepest hit, where the cone ends; 0 = there is no cone
  }

  /** Points of the page along a side; those of one that a narrow screen does not show are for paper. */
  get side() { return Math.min(this.box.clientWidth, this.box.clientHeight) || 300; }

  /** Gives back what it no longer needs. @param {Record<string, ArrayBuffer>} picture @param {any} request @param {number[]} hits */
  show(picture, { width }, hits) {
    const free = [picture.rgba, this.objects.buffer];
    if (this.canvas.width !== width) this.canvas.width = this.canvas.height = width;
    this.canvas.getContext("2d")?.putImageData(new ImageData(new Uint8ClampedArray(picture.rgba), width), 0, 0);
    this.objects = new Uint32Array(picture.objects);
    this.numbers = numbered(this.objects, width, hits);
    return free;
  }

  /** The picture's pixel under a point, -1 beside it. @param {number[]} at */
  pixel(at) {
    const n = this.canvas.width;
    const [x, y] = at.map((v) => Math.floor(v / this.side * n));
    return x >= 0 && y >= 0 && x < n && y < n ? y * n + x : -1;
  }

  /** Writes each where it is in its object and on no other word, if there is such a place near its own. @param {CanvasRenderingContext2D} c */
  writeNumbers(c) {
    c.font = "12px sans-serif";
    c.textAlign = "center";
    for (const { text, object, at } of this.numbers) {
      if (Number(text) > this.lastNumber) break;
      const free = AROUND.map(([x, y]) => [at[0] * this.side + 18 * x, at[1] * this.side + 14 * y])
        .find(([x, y]) => this.objects[this.pixel([x, y])] === object && written.every(([left, right, low]) => x < left - 9 || x > right + 9 || Math.abs(y + 4 - low) > 13));
      if (free) outlined(c, text, free[0], free[1] + 4);
    }
  }

  /** @param {number} factor */
  zoomBy(factor) { this.zoom = Math.min(20, Math.max(0.3, this.zoom * factor)); }
}

/** A cut. */
export class Cut extends Pane {
  /** @param {typeof CUTS[number]} plane @param {HTMLElement} box */
  constructor(plane, box) {
    super(box);
    this.plane = plane;
    this.middle = [0, 0];
  }

  /** Shows the whole of a box of the world, mm. @param {Point} low @param {Point} high */
  frame(low, high) {
    const { right, up } = this.plane;
    const margin = 1.25;
    this.middle = [(low[right] + high[right]) / 2, (low[up] + high[up]) / 2];
    this.extent = margin * Math.max(...[0, 1, 2].map((a) => high[a] - low[a]));
    this.zoom = 1;
  }

  get mmPerPoint() { return (this.extent ?? 200) / this.side / this.zoom; }

  /** The worker's next picture: at the screen's density, or while something moves with a part of its detail. @param {Aim} aim @param {number | false} detail */
  request(aim, detail, fill, window) {
    const width = Math.round(detail ? Math.min(300, this.side) * Math.ceil(detail * 10) / 10 : Math.min(800, this.side * devicePixelRatio));
    const centre = [...aim.cut];
    centre[this.plane.right] = this.middle[0];
    centre[this.plane.up] = this.middle[1];
    return { right: this.plane.right, up: this.plane.up, centre, width, height: width, mm: this.mmPerPoint * this.side / width, fill, window: window ?? [0, 0], hasImage: Boolean(window) };
  }

  /** Where a position is on the page, points from the box's corner. @param {number[]} p */
  place(p) {
    const mm = this.mmPerPoint;
    return [(p[this.plane.right] - this.middle[0]) / mm + this.side / 2, this.side / 2 - (p[this.plane.up] - this.middle[1]) / mm];
  }

  /** The position in the cut under a point of the page. @param {number[]} at @param {number[]} cut */
  position(at, cut) {
    const p = [...cut];
    p[this.plane.right] = (at[0] - this.side / 2) * this.mmPerPoint + this.middle[0];
    p[this.plane.up] = (this.side / 2 - at[1]) * this.mmPerPoint + this.middle[1];
    return /** @type {Point} */ (p);
  }

  /** The object there, 0 if none. @param {number[]} at */
  object(at) { return this.objects[this.pixel(at)] ?? 0; }

  /** Which end of the axis is under a point: "origin", "toward" or null. @param {number[]} at @param {Aim} aim */
  end(at, aim) {
    const near = (/** @type {"origin" | "toward"} */ end) => Math.hypot(...this.place(aim[end]).map((v, i) => v - at[i])) <= HANDLE;
    return near("toward") ? "toward" : near("origin") ? "origin" : null;
  }

  /** @param {Record<string, ArrayBuffer>} picture @param {any} request @param {number[]} hits */
  show(picture, request, hits) {
    clearGround(picture.rgba, new Uint32Array(picture.objects), request.width, request.hasImage);
    return super.show(picture, request, hits);
  }

  /** The axis with its ends, the lines of the other cuts, letters, names and a scale.
   * @param {Aim} aim @param {string} chosenEnd @param {any[][]} names each object's, first of its members */
  annotate(aim, chosenEnd, names) {
    const side = this.side;
    const c = cleared(this.over, side);
    const [x, y] = this.place(aim.cut);
    for (const [u, v] of [[1, 0], [-1, 0], [0, 1], [0, -1]]) cased(c, ground, ink, 1, [[x + 16 * u, y + 16 * v], [x + 40 * u, y + 40 * v]]);
    if (this.depth) drawCone(c, section(coneOf(aim, this.depth), this.plane, aim.cut).map((p) => this.place(p)));
    axis(c, this.place(aim.origin), this.place(aim.toward), chosenEnd);
    c.font = "bold 13px sans-serif";
    c.textAlign = "center";
    for (const [i, at] of [[10, side / 2], [side - 10, side / 2], [side / 2, side < 300 ? 34 : 16], [side / 2, side - 8]].entries()) {
      outlined(c, this.plane.letters[i], at[0], at[1]);
    }
    const mm = [1, 2, 5, 10, 20, 50, 100].filter((length) => length / this.mmPerPoint <= side / 3).pop() ?? 1;
    line(c, ink, 2, [[12, side - 12], [12 + mm / this.mmPerPoint, side - 12]]);
    c.textAlign = "left";
    outlined(c, `${mm} mm`, 12, side - 18);
    this.writeNumbers(c);
    const title = `${this.plane.name}, ${"xyz"[this.plane.through]} = ${digits(Number(aim.cut[this.plane.through].toFixed(2)))} mm`;
    caption(c, title, this.under, side);
    const area = names[this.object([x, y]) - 1]?.[0] ?? "no area";
    this.over.setAttribute("aria-label", `${title}: ${area} at the crosshair. Arrows move the chosen end of the cone.`);
  }
}

/** @param {CanvasRenderingContext2D} c @param {string} colour @param {number} width @param {number[][]} points */
function line(c, colour, width, points) {
  c.beginPath();
  points.forEach(([x, y], i) => (i ? c.lineTo(x, y) : c.moveTo(x, y)));
  c.strokeStyle = colour;
  c.lineWidth = width;
  c.stroke();
}

/** A line that is seen on anything. @param {CanvasRenderingContext2D} c @param {string} around @param {string} colour @param {number} width
 * @param {number[][]} points */
function cased(c, around, colour, width, points) {
  line(c, around, width + 2, points);
  line(c, colour, width, points);
}

/** Fills the area that a cone covers, and draws its edge. @param {CanvasRenderingContext2D} c @param {number[][]} edge */
function drawCone(c, edge) {
  c.beginPath();
  for (const [x, y] of edge) c.lineTo(x, y);
  c.fillStyle = "LOOK_CONE1f"; // thin: colours of the hits stay what they are in the table
  c.fill();
  if (edge.length) cased(c, "LOOK_BLACK", "LOOK_CONE", 2, [...edge, edge[0]]);
}

/** @param {CanvasRenderingContext2D} c @param {string} text @param {number} x @param {number} y */
function outlined(c, text, x, y) {
  c.strokeStyle = ground;
  c.lineWidth = 3;
  c.strokeText(text, x, y);
  c.fillStyle = ink;
  c.fillText(text, x, y);
  const { actualBoundingBoxLeft: left, actualBoundingBoxRight: right } = c.measureText(text);
  written.push([x - left, x + right, y]);
}

/** A pane's title, and what is under the pointer. @param {CanvasRenderingContext2D} c @param {string} title @param {string} under @param {number} side */
function caption(c, title, under, side) {
  c.font = "13px sans-serif";
  c.textAlign = "left";
  outlined(c, title, 8, 18);
  c.textAlign = "right";
  c.font = "bold 14px sans-serif";
  outlined(c, under, side - 8, side - 16);
}

/** The axis from its start, a ring, to its target, a cross. @param {CanvasRenderingContext2D} c @param {number[]} from @param {number[]} to */
function axis(c, from, to, chosenEnd) {
  for (const [colour, width] of /** @type {[string, number][]} */ ([[ground, 4], [ink, 1.5]])) {
    line(c, colour, width, [from, to]);
    line(c, colour, width + 1, [[to[0] - 7, to[1]], [to[0] + 7, to[1]]]);
    line(c, colour, width + 1, [[to[0], to[1] - 7], [to[0], to[1] + 7]]);
    c.beginPath();
    c.arc(from[0], from[1], 7, 0, 7);
    c.stroke();
    const end = chosenEnd === "origin" ? from : to;
    if (colour === ink) {
      c.setLineDash([3, 3]);
      c.beginPath();
      c.arc(end[0], end[1], HANDLE, 0, 7);
      c.stroke();
      c.setLineDash([]);
    }
  }
  for (const [x, y] of [from, to]) written.push([x - HANDLE, x + HANDLE, y + 4]);
  c.font = "12px sans-serif";
  name(c, "start", from, from[0] < to[0]);
  name(c, "target", to, from[0] >= to[0]);
}

/** Names an end of the axis, on its left or right, where that is in the pane. @param {CanvasRenderingContext2D} c @param {string} text
 * @param {number[]} at @param {boolean} isLeft */
function name(c, text, [x, y], isLeft) {
  const room = 50;
  const goesLeft = isLeft ? x > room : x > c.canvas.width / devicePixelRatio - room;
  c.textAlign = goesLeft ? "right" : "left";
  outlined(c, text, x + (goesLeft ? -12 : 12), y - 12);
}

/** Points of the cone's rims, where it begins, and so many mm along its axis; 0 is at the target. @param {Aim} aim @param {number} depth */
function coneOf({ origin, toward, angle, range }, depth) {
  const axis = toward.map((v, a) => v - origin[a]);
  const length = Math.hypot(...axis) || 1;
  const least = axis.map(Math.abs).indexOf(Math.min(...axis.map(Math.abs)));
  const cross = (/** @type {number[]} */ p, /** @type {number[]} */ q) => [0, 1, 2].map((a) => p[(a + 1) % 3] * q[(a + 2) % 3] - p[(a + 2) % 3] * q[(a + 1) % 3]);
  const across = cross(axis, [0, 1, 2].map((a) => Number(a === least)));
  const scale = Math.hypot(...across) || 1;
  const up = cross(axis, across).map((v) => v / length);
  const radius = length * Math.tan(angle * Math.PI / 360) / scale;
  const round = Array.from({ length: 48 }, (_, i) => i * Math.PI / 24);
  const at = (/** @type {number} */ mm) => round.map((t) => origin.map((v, a) => v + mm / length * (axis[a] + radius * (Math.cos(t) * across[a] + Math.sin(t) * up[a]))));
  return { near: at(range?.[0] ?? 0), rim: at(Math.min(range?.[1] ?? Infinity, Math.max(range?.[0] ?? 0, depth || length))) };
}

/** The edge of a cone in a plane, which is convex. @param {{near: number[][], rim: number[][]}} cone @param {typeof CUTS[number]} plane @param {number[]} cut */
function section({ near, rim }, { right, up, through }, cut) {
  const points = rim.flatMap((p, i) => [[near[i], p], ...[near, rim].map((round) => [round[i], round[(i + 1) % rim.length]])]).flatMap(([p, q]) => {
    const part = (cut[through] - p[through]) / (q[through] - p[through]);
    return part >= 0 && part <= 1 ? [p.map((v, a) => v + part * (q[a] - v))] : [];
  });
  const [x, y] = [right, up].map((a) => points.reduce((sum, p) => sum + p[a], 0) / points.length);
  const turn = (/** @type {number[]} */ p) => Math.atan2(p[up] - y, p[right] - x);
  return points.sort((p, q) => turn(p) - turn(q));
}

/** The 3-D view: an eye on a sphere around the middle of the atlas. */
export class View extends Pane {
  /** @param {HTMLElement} box */
  constructor(box) {
    super(box);
    this.angle = 30;
    this.distances = new Float32Array();
  }

  /** @param {Point} low @param {Point} high */
  frame(low, high) {
    this.middle = low.map((v, a) => (v + high[a]) / 2);
    this.radius = Math.hypot(...low.map((v, a) => (high[a] - v) / 2));
    this.turn = Math.PI * 0.86; // degrees of longitude from +x: the left side, a little from the front
    this.tilt = 0.35;
    this.zoom = 1;
  }

  /** How far before the surface a click puts the start, mm: of a small atlas half its radius, as the window has it. */
  get away() {
    return Math.min(40, 0.36 * this.radius);
  }

  get eye() {
    const far = 0.85 * this.radius / Math.sin(this.angle * Math.PI / 360) / this.zoom;
    const flat = Math.cos(this.tilt);
    return [Math.cos(this.turn) * flat, Math.sin(this.turn) * flat, Math.sin(this.tilt)].map((v, a) => this.middle[a] + far * v);
  }

  /** While the eye moves with a part of its detail. @param {boolean} moving */
  request(moving) {
    const eye = this.eye;
    const isRough = moving && String(eye) !== String(this.drawn?.width === 384 && this.drawn.eye);
    return { width: isRough ? 96 : 384, eye, toward: this.middle, angle: this.angle };
  }

  /** @param {Record<string, ArrayBuffer>} picture @param {any} request @param {number[]} hits */
  show(picture, request, hits) {
    const free = [...super.show(picture, request, hits), this.distances.buffer];
    this.distances = new Float32Array(picture.distances);
    this.drawn = request;
    return free;
  }

  /** Unit vectors to the right, the top and ahead. */
  get axes() {
    const eye = this.eye;
    const length = Math.hypot(...eye.map((v, a) => this.middle[a] - v));
    const ahead = eye.map((v, a) => (this.middle[a] - v) / length);
    const flat = Math.hypot(ahead[0], ahead[1]);
    const right = [ahead[1] / flat, -ahead[0] / flat, 0];
    const up = [right[1] * ahead[2] - right[2] * ahead[1], right[2] * ahead[0] - right[0] * ahead[2], right[0] * ahead[1] - right[1] * ahead[0]];
    return { right, up, ahead };
  }

  /** @param {number[]} at @returns {{object: number, position: Point, inward: Point} | null} */
  pick(at) {
    if (!this.drawn) return null;
    const n = this.drawn.width;
    const pixel = this.pixel(at);
    if (!this.objects[pixel]) return null;
    const { right, up, ahead } = this.axes;
    const half = Math.tan(this.angle * Math.PI / 360);
    const [u, v] = [(2 * (pixel % n + 0.5) / n - 1) * half, (1 - 2 * (Math.floor(pixel / n) + 0.5) / n) * half];
    const ray = ahead.map((value, a) => value + u * right[a] + v * up[a]);
    const length = Math.hypot(...ray);
    const inward = /** @type {Point} */ (ray.map((value) => value / length));
    return { object: this.objects[pixel], inward, position: /** @type {Point} */ (inward.map((value, a) => this.eye[a] + this.distances[pixel] * value)) };
  }

  /** Whether the brain, as it is drawn, is before a position. @param {number[]} p */
  hides(p) { return this.distances[this.pixel(this.place(p))] < Math.hypot(...p.map((v, a) => v - this.eye[a])) - 1; }

  /** Turns it so many radians. @param {number} x @param {number} y */
  turnBy(x, y) {
    this.turn -= x;
    this.tilt = Math.min(1.5, Math.max(-1.5, this.tilt + y));
  }

  /** @param {number[]} p */
  place(p) {
    const { right, up, ahead } = this.axes;
    const offset = p.map((v, a) => v - this.eye[a]);
    const along = (/** @type {number[]} */ d) => d.reduce((sum, v, a) => sum + v * offset[a], 0);
    const half = Math.tan(this.angle * Math.PI / 360) * Math.max(along(ahead), 1);
    return [(along(right) / half + 1) / 2 * this.side, (1 - along(up) / half) / 2 * this.side];
  }

  /** @param {Aim} aim @param {string} chosenEnd */
  annotate(aim, chosenEnd) {
    const c = cleared(this.over, this.side);
    if (this.depth && aim.angle < 120) {
      const { near, rim } = coneOf(aim, this.depth < ENDLESS ? this.depth : 0);
      const [from, at] = [near, rim].map((round) => round.map((p) => this.place(p)));
      const ends = at.map((_, i) => (i + 1) % at.length);
      c.beginPath();
      at.forEach((p, i) => { // sides that all turn the same way, so that what two of them cover is filled once
        const q = at[ends[i]], tip = from[i], side = [tip, p, q, from[ends[i]]];
        const turns = (p[0] - tip[0]) * (q[1] - tip[1]) > (p[1] - tip[1]) * (q[0] - tip[0]);
        (turns ? side : side.reverse()).forEach(([x, y], corner) => (corner ? c.lineTo(x, y) : c.moveTo(x, y)));
      });
      c.fillStyle = "LOOK_CONE1f"; // thin: colours of the hits stay what they are in the table
      c.fill();
      for (const [colour, width] of /** @type {[string, number][]} */ ([["LOOK_BLACK", 4], ["LOOK_CONE", 2]])) {
        at.forEach((p, i) => {
          c.setLineDash(this.hides(rim[i]) ? [3, 3] : []);
          line(c, colour, width, [p, at[ends[i]]]);
          if (i % 12 === 0) line(c, colour, width - 1, [from[i], p]);
        });
      }
      c.setLineDash([]);
    }
    axis(c, this.place(aim.origin), this.place(aim.toward), chosenEnd);
    this.writeNumbers(c);
    caption(c, this.isStill ? "3-D" : "3-D, drag to turn", this.under, this.side);
  }
}
