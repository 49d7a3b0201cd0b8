// SPDX-License-Identifier: BSD-3-Clause
// The atlas in a headset, by WebXR: a hand points a cone at it, conus answers in the page's worker. Lengths of the room
// are metres, those of the brain mm; `brain` (room_from_ras) joins them. A frame makes no objects; a question does.
import { ORIGIN, XR_FROM_RAS, apply, between, columns, cross, dot, invert, length, matrix, plus, point, scale, similarity, times, unit } from "./matrix.js";
import { Board, SIZE } from "./board.js";

/** @typedef {import("./state.js").Question} Question */
/** @typedef {{time: number, numbers: Float64Array}} Moment what was pointed at: origin, toward, angle, near */
/** @typedef {{refused: string, depth: number, best: number, contact: number[] | null, selected: string, confirmed: string, hits: {number: number, rgb: number[], behind: boolean}[], said: {sentence: string, rows: {name: string, rgb: number[], share: string}[], more: number}}} Answer */

const REACH = 100; // mm from the apex to the target that is asked: beyond, 0.001 mm is less than 0.0006 degrees
const DELAY = 150; // ms before a press, which itself moves the hand (Eq. 12)
const GAP = 500; // ms without a hand, and what it pointed at before is no more
const REST = 150; // ms within so many m and so much of a direction, and the hand rests
const STILL = [0.005, 0.026];
const ROUGH = 16; // rays a side while the hand moves
const LONG = 0.36; // m of the atlas's longest side: table-top, a human brain twice as large as it is
const AHEAD = 0.6, BELOW = 0.4; // m from the eyes to the brain's middle
const SIZES = [0.02, 20]; // m of the longest side, by hands
const STEPS = 1; // m from which on it turns in steps, for comfort
const TURN = Math.PI / 6; // a step
const DEAD = 0.15; // of a stick's way
const GESTURE = 8; // the angle's logarithm for a metre of a second hand's way
const ANGLES = [1, 120];
const ADVANCE = 0.1; // m that a stick moves the near plane in a second
const NO_END = 1e5; // mm to the far end of a range that begins at the near plane
const NUMBERS = 8; // of a moment
const BALL = 0.006; // m of its radius: a degree from 0.7 m
const CUTOFF = 1.5, BETA = 8, CUTOFF_SPEED = 1; // One Euro filter (Casiez et al. 2012): Hz, Hz per unit/s, Hz
const MOMENTS = 64; // the last half second, and more
const STRIPE = 8; // mm of an atlas of 180 mm

/** Follows a vector: smooth while it rests, at once while it moves fast. */
class OneEuro {
  constructor() {
    this.time = NaN;
    this.speed = point();
    this.x = point();
  }

  /** Smooths p, in place. @param {number} seconds @param {Float64Array} p */
  step(seconds, p) {
    const past = seconds - this.time;
    this.time = seconds;
    if (!(past > 0 && past < GAP / 1000)) {
      this.speed.fill(0);
      this.x.set(p);
      return;
    }
    const part = 1 / (1 + 1 / (2 * Math.PI * CUTOFF_SPEED * past));
    for (let a = 0; a < 3; a++) this.speed[a] += part * ((p[a] - this.x[a]) / past - this.speed[a]);
    const follow = 1 / (1 + 1 / (2 * Math.PI * (CUTOFF + BETA * length(this.speed)) * past));
    for (let a = 0; a < 3; a++) p[a] = this.x[a] += follow * (p[a] - this.x[a]);
  }
}

/** As links, commands and tables of poses have it. @param {number} v */
const rounded = (v) => Math.round(v * 1000) / 1000 + 0;

/** Writes origin and toward of a device at a place, looking ahead, of the room. @param {Float64Array} numbers @param {Float64Array} rasFromRoom
 * @param {Float64Array} at @param {Float64Array} ahead */
function aim(numbers, rasFromRoom, at, ahead) {
  apply(origin, rasFromRoom, at);
  unit(apply(direction, rasFromRoom, ahead, 0));
  for (let a = 0; a < 3; a++) {
    numbers[a] = rounded(origin[a]);
    numbers[3 + a] = rounded(numbers[a] + REACH * direction[a]);
  }
}
const origin = point(), direction = point();
const Y = Float64Array.of(0, 1, 0), Z = Float64Array.of(0, 0, 1);
const p = point(), q = point(), r = point();
const a = matrix(), b = matrix(), c = matrix();

export class Headset {
  /** @param {import("./stage.js").Stage} stage @param {{question: Question, low: number[], high: number[], file: string, name: string, ask: (question: Question, step?: [number, number]) => Promise<Answer>, hold: (question: Question) => void, ended: () => void}} page */
  constructor(stage, page) {
    this.stage = stage;
    this.page = page;
    this.board = new Board();
    this.angle = Math.min(ANGLES[1], Math.max(ANGLES[0], rounded(page.question.angle)));
    this.layers = page.question.layers;
    [this.near, this.far] = page.question.range ?? [0, NO_END]; // mm along the axis between which something counts
    this.middle = Float64Array.from(page.low, (low, i) => (low + page.high[i]) / 2);
    this.long = Math.max(...page.low.map((low, i) => page.high[i] - low)); // mm
    this.brain = matrix();
    this.back = matrix(); // its inverse
    this.isPlaced = false;
    this.hand = "right"; // that points
    /** @type {any} */
    this.source = null; // of it
    /** The last questions, round and round. @type {Moment[]} */
    this.past = Array.from({ length: MOMENTS }, () => ({ time: -Infinity, numbers: new Float64Array(NUMBERS) }));
    this.newest = 0;
    this.hasAimed = false;
    this.isOld = true; // the hand is not seen
    /** @type {Float64Array | null} */
    this.held = null;
    this.filters = [new OneEuro(), new OneEuro()];
    this.at = point();
    this.ahead = point();
    this.still = { since: -Infinity, at: point(), ahead: point() };
    this.asked = new Float64Array(NUMBERS); // and
    this.askedFull = false;
    this.askedLayers = "";
    this.isBusy = false;
    /** @type {Answer | null} */
    this.answer = null;
    /** Rows of poses, of each kind of question that was answered. @type {Map<string, string[]>} */
    this.record = new Map();
    this.isTracked = false; // ranks have a history
    this.tracks = 0;
    this.begins = false; // the next step is a track's first
    this.trigger = false; // was pressed since the last step
    this.confirmed = "";
    this.isTrial = false; // somebody aims at balls
    /** The ball's place, mm. @type {number[] | null} */
    this.ball = null; // and since when it is shown
    this.ballSince = 0;
    this.ballPlace = matrix();
    /** What carries the brain, by hand, and from where. @type {any[]} */
    this.grips = [null, null];
    this.gripped = 0; // which of them, in bits, `from` is of
    this.from = [matrix(), matrix()];
    this.now = [matrix(), matrix()];
    this.brainFrom = matrix();
    /** @type {any} */
    this.opening = null; // the second hand that makes the cone wider
    this.openingAt = 0;
    /** @type {any} */
    this.pinching = null; // the transient pointer that does not press a button
    this.pressed = [false, true]; // A or X is down, B or Y is up
    this.hasAdvanced = false; // the near plane, since B or Y went down
    this.hasTurned = false; // since the stick was last in its middle
    this.eye = point();
    this.scene = { brain: this.brain, cone: /** @type {Float64Array | null} */ (null), near: /** @type {Float64Array | null} */ (null), ball: /** @type {Float64Array | null} */ (null), isOld: true, wands: [0, 1, 2, 3].map(matrix), wandCount: 0, panel: matrix(), hasFloor: false };
    this.cones = [matrix(), matrix()]; // to its end, and to the near plane
    this.depths = new Float64Array(2); // mm, of these
    this.time = 0;
    this.began = 0;
    this.step = (/** @type {number} */ time, /** @type {any} */ frame) => {
      if (!this.session) return;
      this.session.requestAnimationFrame(this.step);
      this.draw(time, frame);
    };
  }

  /** Enters; needs the press of a button. @param {"immersive-vr" | "immersive-ar"} mode */
  async start(mode) {
    const session = this.session = await /** @type {any} */ (navigator).xr.requestSession(mode, { optionalFeatures: ["local-floor", "hand-tracking"] });
    session.addEventListener("end", () => {
      this.session = null;
      this.page.ended();
    });
    session.addEventListener("selectstart", (/** @type {any} */ event) => this.press(event));
    session.addEventListener("selectend", (/** @type {any} */ event) => this.release(event));
    session.addEventListener("squeezestart", ({ inputSource }) => { this.grips[this.sideOf(inputSource)] = inputSource; });
    session.addEventListener("squeezeend", ({ inputSource }) => { this.grips[this.sideOf(inputSource)] = null; });
    await this.stage.enter(session, mode === "immersive-ar", STRIPE * this.long / 180);
    this.space = await session.requestReferenceSpace("local-floor").then((/** @type {any} */ space) => {
      this.scene.hasFloor = true;
      return space;
    }, () => session.requestReferenceSpace("local"));
    this.space.addEventListener("reset", () => { this.isPlaced = false; });
    this.say();
    session.requestAnimationFrame(this.step);
  }

  // What the hands do

  sideOf(/** @type {any} */ source) { return source.handedness === "left" ? 0 : 1; }

  /** Whether a source points at a place, not at what a screen or eyes look at. @param {any} source */
  canPoint(source) { return source.targetRayMode === "tracked-pointer" || source.targetRayMode === "transient-pointer"; }

  findSource() {
    const sources = this.session.inputSources;
    let found = null;
    for (let i = 0; i < sources.length; i++) {
      if (this.canPoint(sources[i]) && (!found || sources[i].handedness === this.hand)) found = sources[i];
    }
    return found;
  }

  /** @param {any} event */
  press({ inputSource, frame }) {
    if (!this.space || this.session.visibilityState !== "visible" || !this.canPoint(inputSource)) return;
    const ray = frame.getPose(inputSource.targetRaySpace, this.space);
    const button = ray ? this.buttonAt(ray.transform.matrix) : "";
    if (button) this.use(button);
    else if (inputSource.hand && this.touches(inputSource, frame)) this.grips[this.sideOf(inputSource)] = inputSource;
    else if (inputSource.targetRayMode === "transient-pointer") [this.held, this.pinching] = [null, inputSource]; // and its end holds
    else if (inputSource !== this.source && inputSource.hand) [this.opening, this.openingAt] = [inputSource, NaN];
    else if (inputSource !== this.source) [this.hand, this.held] = [inputSource.handedness, null];
    else this.hold();
    this.say();
  }

  /** @param {any} event */
  release({ inputSource }) {
    if (inputSource === this.opening) this.opening = null;
    if (inputSource.hand) this.grips[this.sideOf(inputSource)] = null;
    if (inputSource === this.pinching && inputSource === this.source && !this.held) this.hold();
    if (inputSource === this.pinching) this.pinching = null;
    this.say();
  }

  /** Holds what was pointed at before the press, or lets go. */
  hold() {
    if (this.held || this.isOld) {
      this.held = null;
      return;
    }
    const now = this.past[this.newest].time;
    let found = this.past[this.newest];
    for (let i = 0; i < MOMENTS && found.time > now - DELAY; i++) {
      const before = this.past[(this.newest + MOMENTS - i) % MOMENTS];
      if (found.time - before.time > GAP) break;
      found = before;
    }
    if (this.isTrial) this.takeTrial(found);
    this.trigger = this.isTracked;
    if (this.isTrial || this.isTracked) return;
    this.held = Float64Array.from(found.numbers);
    this.page.hold(this.questionOf(this.held, true));
  }

  // Trials, for conus calibrate

  /** Records what was pointed at while a ball was to be aimed at, and shows the next one. @param {Moment} moment */
  takeTrial({ time, numbers }) {
    if (!this.ball || time < this.ballSince) return;
    this.write("trials", [...numbers.subarray(0, 7), ...this.ball], time);
    this.showBall();
  }

  /** Puts a ball at a random place that is seen from here: what a ray from the eye hits first. */
  async showBall() {
    const { low, high, question } = this.page;
    this.ball = null;
    while (this.isTrial && !this.ball && this.session) {
      const [from, to] = [apply(point(), this.back, this.eye), low.map((v, i) => v + Math.random() * (high[i] - v))];
      const { contact } = await this.page.ask(/** @type {any} */ ({ ...question, weight: null, origin: Array.from(from, rounded), toward: to.map(rounded), angle: 0.01, range: null, layers: "visible", resolution: 1, cut: null }));
      this.ball = this.isTrial && contact ? contact.map(rounded) : null;
      this.ballSince = this.time;
    }
    this.say();
  }

  /** @param {string} button */
  use(button) {
    if (button === "home") this.isPlaced = false;
    else if (button === "trials") {
      this.isTrial = !this.isTrial;
      this.held = null;
      this.showBall();
    } else if (button === "history") {
      this.isTracked = this.begins = !this.isTracked;
      this.tracks += Number(this.isTracked);
      this.trigger = false;
      this.confirmed = "";
      this.held = null;
      this.askedLayers = ""; // and nothing was asked
    } else this.layers = this.layers === "all" ? "visible" : "all";
    if (this.held) this.page.hold(this.questionOf(this.held, true));
  }

  /** The panel's button that a ray meets; "" = none. @param {Float32Array} m */
  buttonAt(m) {
    const { panel } = this.scene;
    const out = [panel[8], panel[9], panel[10]], to = [0, 1, 2].map((i) => panel[12 + i] - m[12 + i]);
    const far = dot(to, out) / -(m[8] * out[0] + m[9] * out[1] + m[10] * out[2]);
    if (!(far > 0)) return "";
    const on = to.map((v, i) => -far * m[8 + i] - v);
    const [u, v] = [0, 4].map((at) => dot(on, panel.subarray(at, at + 3)) / dot(panel.subarray(at, at + 3), panel.subarray(at, at + 3)));
    return Math.abs(u) <= 0.5 && Math.abs(v) <= 0.5 ? this.board.button(u + 0.5, 0.5 - v) : "";
  }

  /** Whether a hand is in the box around the brain. @param {any} source @param {any} frame */
  touches(source, frame) {
    const pose = frame.getPose(source.gripSpace ?? source.targetRaySpace, this.space);
    if (!pose) return false;
    const { x, y, z } = pose.transform.position;
    apply(p, this.back, [x, y, z]);
    return p.every((v, i) => v >= this.page.low[i] && v <= this.page.high[i]);
  }

  /** One hand carries and turns the brain; two also scale it. @param {any} frame */
  carry(frame) {
    let held = 0;
    for (let hand = 0; hand < 2; hand++) {
      const source = this.grips[hand];
      const pose = source && frame.getPose(source.gripSpace ?? source.targetRaySpace, this.space);
      if (!pose) continue;
      this.now[hand].set(pose.transform.matrix);
      held |= 1 << hand;
    }
    if (held !== this.gripped) {
      this.gripped = held;
      this.brainFrom.set(this.brain);
      for (let hand = 0; hand < 2; hand++) this.from[hand].set(this.now[hand]);
    }
    if (!held) return;
    if (held === 3) {
      this.move(times(b, between(a, apply(p, this.from[0], ORIGIN), apply(q, this.from[1], ORIGIN), apply(r, this.now[0], ORIGIN), apply(origin, this.now[1], ORIGIN)), this.brainFrom));
    } else {
      const hand = held - 1;
      this.move(times(b, times(a, this.now[hand], invert(c, this.from[hand])), this.brainFrom));
    }
  }

  /** Puts the brain where a matrix says, if that leaves a size that can be seen. @param {Float64Array} m */
  move(m) {
    const size = this.long * Math.hypot(m[0], m[1], m[2]);
    if (size >= SIZES[0] && size <= SIZES[1]) this.brain.set(m);
  }

  /** Turns the brain about the room's up, and scales it, round its middle. @param {number} angle @param {number} scale */
  turn(angle, scale) {
    apply(p, this.brain, this.middle);
    this.move(times(b, similarity(a, 0, Math.sin(angle / 2), 0, Math.cos(angle / 2), scale, p, p), this.brain));
  }

  /** Sticks and buttons: of the pointing hand the angle, or with B or Y the near plane; of the other one turn and scale. @param {number} seconds @param {any} frame */
  steer(seconds, frame) {
    const sources = this.session.inputSources;
    for (let i = 0; i < sources.length; i++) {
      const pad = sources[i].gamepad;
      if (pad?.mapping !== "xr-standard") continue;
      const x = Math.abs(pad.axes[2] ?? 0) > DEAD ? pad.axes[2] : 0;
      const y = Math.abs(pad.axes[3] ?? 0) > DEAD ? pad.axes[3] : 0;
      if (sources[i] === this.source) {
        const isAdvancing = Boolean(pad.buttons[5]?.pressed);
        if (y && isAdvancing) this.advance(-ADVANCE * y * seconds);
        else if (y) this.openBy(-1.5 * y * seconds);
        this.button(0, pad.buttons[4]?.pressed, "layers");
        this.button(1, !isAdvancing, this.hasAdvanced ? "" : "home");
        this.hasAdvanced = isAdvancing && (this.hasAdvanced || y !== 0);
      } else if (x || y) {
        const isLarge = this.long * Math.hypot(this.brain[0], this.brain[1], this.brain[2]) > STEPS;
        const turn = !isLarge ? 1.2 * x * seconds : this.hasTurned || Math.abs(x) < 0.7 ? 0 : Math.sign(x) * TURN;
        this.turn(turn, Math.exp(-y * seconds));
        this.hasTurned ||= isLarge && turn !== 0;
      } else this.hasTurned = false;
    }
    const pose = this.opening && frame.getPose(this.opening.gripSpace ?? this.opening.targetRaySpace, this.space);
    if (!pose) return;
    const { y } = pose.transform.position;
    if (y - this.openingAt) this.openBy(GESTURE * (y - this.openingAt));
    this.openingAt = y;
  }

  /** @param {number} by of the angle's logarithm */
  openBy(by) {
    if (this.held) return;
    this.angle = Math.min(ANGLES[1], Math.max(ANGLES[0], this.angle * Math.exp(by)));
    this.say();
  }

  /** Moves the near plane: what lies before it is as if it were not there. @param {number} by m */
  advance(by) {
    if (this.held) return;
    this.near = Math.max(0, Math.min(this.far - 1, this.near + by / Math.hypot(this.brain[0], this.brain[1], this.brain[2])));
    this.say();
  }

  /** @param {number} which @param {boolean | undefined} isPressed @param {string} name */
  button(which, isPressed, name) {
    if (isPressed && !this.pressed[which] && name) {
      this.use(name);
      this.say();
    }
    this.pressed[which] = Boolean(isPressed);
  }

  // A frame

  /** Puts the brain before a head, which looks along its -z. @param {Float32Array} head */
  put(head) {
    const yaw = Math.atan2(head[8], head[10]);
    p[0] = head[12] - AHEAD * Math.sin(yaw);
    p[1] = head[13] - BELOW;
    p[2] = head[14] - AHEAD * Math.cos(yaw);
    similarity(a, 0, Math.sin(yaw / 2), 0, Math.cos(yaw / 2), LONG / this.long, p, apply(q, XR_FROM_RAS, this.middle));
    times(this.brain, a, XR_FROM_RAS);
    this.isPlaced = true;
  }

  /** @param {number} time ms @param {any} frame */
  draw(time, frame) {
    const pose = frame.getViewerPose(this.space);
    if (!pose) return;
    const head = pose.transform.matrix;
    apply(this.eye, head, ORIGIN);
    if (!this.isPlaced) this.put(head);
    const seconds = Math.min(0.1, (time - this.time) / 1000);
    this.began ||= time;
    this.time = time;
    const takesInput = this.session.visibilityState === "visible";
    if (takesInput) {
      this.source = this.findSource();
      this.carry(frame);
      this.steer(seconds, frame);
    }
    invert(this.back, this.brain);
    const ray = takesInput && this.source ? frame.getPose(this.source.targetRaySpace, this.space) : null;
    const isOld = !this.held && (!ray || ray.emulatedPosition);
    if (isOld !== this.isOld) {
      this.isOld = isOld;
      this.say();
    }
    if (ray && !ray.emulatedPosition) this.point(ray.transform.matrix);
    const numbers = this.held ?? (this.hasAimed ? this.past[this.newest].numbers : null);
    if (numbers) this.ask(numbers);
    this.place(frame, numbers);
    if (this.board.step(time)) this.stage.show(this.board.canvas);
    this.stage.draw(pose.views, this.scene);
  }

  /** Takes a ray as the newest question. @param {Float32Array} m */
  point(m) {
    apply(this.at, m, ORIGIN);
    for (let i = 0; i < 3; i++) this.ahead[i] = -m[8 + i];
    if (!this.isTracked) { // a score with a history is smooth
      this.filters[0].step(this.time / 1000, this.at);
      this.filters[1].step(this.time / 1000, this.ahead);
    }
    unit(this.ahead);
    const { still } = this;
    if (length(plus(p, this.at, still.at, -1)) > STILL[0] || length(plus(p, this.ahead, still.ahead, -1)) > STILL[1]) {
      still.since = this.time;
      still.at.set(this.at);
      still.ahead.set(this.ahead);
    }
    this.newest = (this.newest + 1) % MOMENTS;
    const moment = this.past[this.newest];
    moment.time = this.time;
    aim(moment.numbers, this.back, this.at, this.ahead);
    moment.numbers[6] = rounded(this.angle);
    moment.numbers[7] = rounded(this.near);
    this.hasAimed = true;
  }

  /** What is drawn beside the brain. @param {any} frame @param {Float64Array | null} numbers */
  place(frame, numbers) {
    const { scene, page } = this, sources = this.session.inputSources;
    scene.wandCount = 0;
    for (let i = 0; i < sources.length && scene.wandCount < scene.wands.length; i++) {
      const pose = this.canPoint(sources[i]) ? frame.getPose(sources[i].targetRaySpace, this.space) : null;
      if (pose) scene.wands[scene.wandCount++].set(pose.transform.matrix);
    }
    scene.isOld = this.isOld;
    scene.cone = scene.near = null;
    scene.ball = this.ball && similarity(this.ballPlace, 0, 0, 0, 1, BALL, apply(p, this.brain, this.ball));
    if (numbers) {
      for (let i = 0; i < 3; i++) {
        origin[i] = numbers[i];
        direction[i] = numbers[3 + i] - numbers[i];
      }
      unit(direction);
      this.depths[0] = Math.min(this.far, this.answer?.depth || length(plus(p, this.middle, origin, -1)) + this.long); // through, where nothing ends it
      unit(cross(p, direction, Math.abs(direction[2]) < 0.9 ? Z : Y));
      cross(q, direction, p);
      columns(a, p, q, direction, origin);
      this.depths[1] = numbers[7];
      scene.cone = this.coneTo(0, numbers);
      if (numbers[7]) scene.near = this.coneTo(1, numbers);
    }
    // The panel: over the brain, turned to the eyes.
    apply(p, this.brain, this.middle);
    for (let i = 0; i < 3; i++) p[1] += Math.abs(this.brain[4 * i + 1]) * (this.middle[i] - page.low[i]); // the box's top
    p[1] += 0.03 + SIZE[1] / 2;
    unit(plus(q, this.eye, p, -1));
    unit(cross(r, Y, q));
    cross(direction, q, r);
    columns(scene.panel, scale(r, SIZE[0]), scale(direction, SIZE[1]), q, p);
  }

  /** One of the cones, whose axes `a` has; a number that is handed on would be an object. @param {number} which @param {Float64Array} numbers */
  coneTo(which, numbers) {
    const out = times(this.cones[which], this.brain, a), depth = this.depths[which];
    const radius = depth * Math.tan(numbers[6] * Math.PI / 360);
    for (let i = 0; i < 12; i++) out[i] *= i < 8 ? radius : depth;
    return out;
  }

  // Questions and answers

  /** @param {Float64Array} numbers @param {boolean} isFull @returns {Question} */
  questionOf(numbers, isFull) {
    const [x, y, z, tx, ty, tz, angle, near] = numbers;
    return { ...this.page.question, origin: [x, y, z], toward: [tx, ty, tz], angle, range: near || this.page.question.range ? [near, this.far] : null, layers: isFull ? this.layers : "visible", resolution: isFull ? this.page.question.resolution : ROUGH, cut: null };
  }

  /** Asks, if that is another question than the last: one is under way, and each frame comes with the newest. Rough ones
   * follow a hand; where it rests or holds, the question is whole. @param {Float64Array} numbers */
  ask(numbers) {
    if (this.isTracked) {
      if (this.isBusy || this.isOld) return;
      this.isBusy = true;
      this.answerTo({ ...this.questionOf(numbers, false), weight: null }, this.time, this.trigger, [1 + 2 * Number(this.trigger) + 4 * Number(this.begins), Number(this.seconds(this.time))]);
      this.trigger = this.begins = false;
      return;
    }
    const isFull = this.held !== null || this.time - this.still.since >= REST;
    let isSame = isFull === this.askedFull && this.layers === this.askedLayers;
    for (let i = 0; i < NUMBERS; i++) isSame &&= numbers[i] === this.asked[i];
    if (this.isBusy || isSame) return;
    this.isBusy = true;
    this.asked.set(numbers);
    this.askedFull = isFull;
    this.askedLayers = this.layers;
    this.answerTo(this.questionOf(numbers, isFull), this.time, this.held !== null);
  }

  /** Colours the stage's new surfaces. */
  repaint() { this.stage.paint(this.answer?.hits ?? []); }

  /** @param {Question} question @param {number} time @param {boolean} isHeld @param {[number, number]} [step] of a track: whether it was pressed, and begins, in bits, and s */
  async answerTo(question, time, isHeld, step) {
    const kind = `${question.layers}-${question.resolution}${step ? `-track-${this.tracks}` : ""}`;
    try {
      const answer = await this.page.ask(question, step);
      this.confirmed = answer.confirmed || this.confirmed;
      const best = this.answer?.best;
      this.answer = answer;
      this.repaint();
      this.shown = question;
      this.say();
      const { origin, toward, angle, range, layers, resolution } = question;
      if (!answer.refused) this.write(kind, [...origin, ...toward, angle, ...range ?? ["", ""], layers, resolution, Number(isHeld)], time);
      if (best !== undefined && best !== answer.best) this.source?.gamepad?.hapticActuators?.[0]?.pulse?.(0.3, 20);
    } finally {
      this.isBusy = false;
    }
  }

  /** Since it began, as the record has it. @param {number} time ms */
  seconds(time) { return ((time - this.began) / 1000).toFixed(3); }

  /** Adds a row to the record. @param {string} kind @param {(string | number)[]} cells @param {number} time ms */
  write(kind, cells, time) {
    const rows = this.record.get(kind) ?? [];
    this.record.set(kind, rows);
    rows.push([rows.length + 1, this.seconds(time), ...cells].join("\t"));
  }

  /** Says on the panel what is known. */
  say() {
    const { said, refused } = this.answer ?? {};
    const all = this.shown?.layers === "all" ? "all layers" : "first hits";
    const [from, to] = this.shown?.range ?? [0, NO_END];
    const depths = [this.shown?.weight && `posterior, ${this.shown.weight}`, to < NO_END ? `from ${Math.round(from)} to ${Math.round(to)} mm` : from ? `from ${Math.round(from)} mm` : ""].filter(Boolean).join(", ");
    const state = `${rounded(this.shown?.angle ?? this.angle)}°, ${all}, ${this.held ? "held" : this.isOld ? "old: no hand is seen" : `${this.shown?.resolution ?? ROUGH} × ${this.shown?.resolution ?? ROUGH} rays`}`;
    const trial = `Trial ${(this.record.get("trials")?.length ?? 0) + 1}: aim at the ball, and press`;
    const track = `${this.answer?.selected || "Nothing"} is selected${this.confirmed && `; ${this.confirmed} was confirmed`}`;
    this.board.say({ sentence: refused || (this.isTrial ? trial : this.isTracked ? track : said?.sentence ?? "Point at the brain"), rows: said?.rows ?? [], more: said?.more ?? 0, depths, state, layers: this.layers, isTrial: this.isTrial, isTracked: this.isTracked });
  }
}
