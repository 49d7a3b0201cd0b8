// SPDX-License-Identifier: BSD-3-Clause
// The panel beside the brain in a headset: the answer in words, and buttons for a hand that has none of its own.

const WIDTH = 1024, HEIGHT = 640; // pixels
const EVERY = 100; // ms between two writings
const BUTTONS = [{ name: "layers", left: 596, right: 816, low: 606 }, { name: "home", left: 832, right: 992, low: 606 }, { name: "history", left: 596, right: 816, low: 530 }, { name: "trials", left: 832, right: 992, low: 530 }];
const OVER = 50, UNDER = 22; // pixels of a button above and below its words' base

/** m. A capital letter of the least type, 40 pixels, is 11 mm high: 0.54 degrees at 1.2 m. */
export const SIZE = [0.4, 0.4 * HEIGHT / WIDTH];

/** What a panel says. @typedef {{sentence: string, rows: {name: string, rgb: number[], share: string}[], more: number, depths: string, state: string, layers: string, isTrial: boolean, isTracked: boolean}} Said */

export class Board {
  constructor() {
    this.canvas = Object.assign(document.createElement("canvas"), { width: WIDTH, height: HEIGHT });
    this.wrote = -Infinity;
    /** @type {Said | null} */
    this.next = null;
  }

  /** Says something, now or in the next frames. @param {Said} said */
  say(said) { this.next = said; }

  /** Once in a frame: writes what is to be said. Returns whether the picture is another. @param {number} time ms */
  step(time) {
    if (!this.next || time - this.wrote < EVERY) return false;
    this.wrote = time;
    this.write(this.next);
    this.next = null;
    return true;
  }

  /** @param {Said} said */
  write({ sentence, rows, more, depths, state, layers, isTrial, isTracked }) {
    const c = /** @type {CanvasRenderingContext2D} */ (this.canvas.getContext("2d"));
    const words = (/** @type {string} */ font, /** @type {string} */ text, /** @type {number} */ x, /** @type {number} */ y, /** @type {number} */ room) => {
      c.font = `${font} system-ui, sans-serif`;
      c.fillText(text, x, y, room);
    };
    const box = (/** @type {string} */ colour, /** @type {number} */ x, /** @type {number} */ y, /** @type {number} */ width, /** @type {number} */ height, /** @type {number} */ round) => {
      c.fillStyle = colour;
      c.beginPath();
      c.roundRect(x, y, width, height, round);
      c.fill();
      c.fillStyle = "LOOK_OVER";
    };
    c.clearRect(0, 0, WIDTH, HEIGHT);
    box("LOOK_PANE_DARK", 0, 0, WIDTH, HEIGHT, 32);
    c.textAlign = "left";
    c.font = "600 44px system-ui, sans-serif";
    const lines = [""];
    for (const word of sentence.split(" ")) {
      const line = `${lines[lines.length - 1]} ${word}`.trim();
      if (c.measureText(line).width <= WIDTH - 80) lines[lines.length - 1] = line;
      else lines.push(word);
    }
    const second = lines.slice(1).join(" ");
    words("600 44px", lines[0], 40, 68, WIDTH - 80);
    words("600 44px", second, 40, 122, WIDTH - 80);
    rows.forEach(({ name, rgb, share }, i) => {
      const y = 190 + 56 * i;
      box(`rgb(${rgb})`, 40, y - 34, 38, 38, 4);
      words("44px", name, 100, y, WIDTH - 340);
      c.textAlign = "right";
      words("44px", share, WIDTH - 40, y, 180);
      c.textAlign = "left";
    });
    words("40px", more ? `and ${more} more` : "", 40, 526, BUTTONS[2].left - 60);
    words("40px", depths, 40, 566, BUTTONS[0].left - 60);
    words("40px", state, 40, 606, BUTTONS[0].left - 60);
    c.textAlign = "center";
    const texts = [layers === "all" ? "first hits" : "all layers", "home", isTracked ? "no history" : "history", isTrial ? "no trials" : "trials"];
    BUTTONS.forEach(({ left, right, low }, i) => {
      box("LOOK_DARK_BUTTON", left, low - OVER, right - left, OVER + UNDER, 12);
      words("40px", texts[i], (left + right) / 2, low, right - left - 16);
    });
  }

  /** The button at a place, 0 to 1 from the left and the top; "" where there is none. @param {number} u @param {number} v */
  button(u, v) {
    const x = u * WIDTH, y = v * HEIGHT;
    return BUTTONS.find(({ left, right, low }) => x >= left && x <= right && y >= low - OVER && y <= low + UNDER)?.name ?? "";
  }
}
