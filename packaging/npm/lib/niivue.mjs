// SPDX-License-Identifier: BSD-3-Clause
// conus in NiiVue 1.0: a cone from a device to the crosshair, in a volume with names that NiiVue shows. What is hit is
// painted in conus's colours, and the rest fades.
import { ConusError, load } from "./index.mjs";

const REST = [190, 190, 190, 60];

/** Red, green and blue. @param {string} text "#rrggbb" */
const rgb = (text) => [1, 3, 5].map((at) => parseInt(text.slice(at, at + 2), 16));

/** @param {any} nv @param {number} [place] */
function findVolume(nv, place) {
  const named = nv.volumes.filter((volume, i) => volume.colormapLabel?.labels && (place ?? i) === i);
  if (named.length !== 1) throw new ConusError(`volume: ${named.length || "no"} volumes ${place === undefined ? "" : `at ${place} `}have names (setColormapLabel()), and one is needed`);
  return named[0];
}

/** What NiiVue shows, as the files of an atlas. "?" is its name of what has none. */
async function filesOf(nv, volume) {
  const { labels, min = 0 } = volume.colormapLabel;
  const names = labels.flatMap((name, i) => (min + i && name && name !== "?" ? [`${min + i}\t${name.replace(/\s/g, " ")}\n`] : []));
  const bytes = await nv.saveVolume({ filename: "", volumeByIndex: nv.volumes.indexOf(volume) });
  if (!bytes) throw new ConusError("volume: NiiVue does not have its voxels");
  return { "atlas.nii": bytes, "atlas.tsv": new TextEncoder().encode(`index\tname\n${names.join("")}`) };
}

export class Cone {
  onanswer = () => {};
  onerror = console.error;
  #nv;
  #volume;
  #own; // colours of the volume, before
  #context;
  #next = null;
  #isBusy = false;

  constructor(nv, volume, atlas, settings) {
    Object.assign(this, { atlas, settings });
    this.#nv = nv;
    this.#volume = volume;
    this.#own = volume.colormapLabel;
    this.#context = nv.createExtensionContext();
    this.#context.on("locationChange", ({ detail }) => this.point(detail.mm.slice(0, 3)));
  }

  /** Of what comes while conus answers, the last is asked next. */
  async point(toward) {
    this.#next = toward;
    if (this.#isBusy) return;
    this.#isBusy = true;
    while (this.#next) {
      const question = { ...this.settings, toward: this.#next };
      this.#next = null;
      try {
        const rows = await this.atlas.select(question);
        const hits = rows.filter(({ rank }) => rank !== null).map(({ index }, i) => [index, [...rgb(this.atlas.colours[i]), 255]]);
        const found = new Map(hits.reverse()); // the best of several parts of one label
        await this.#paint((i, label) => (label ? found.get(label) ?? REST : [0, 0, 0, 0]));
        this.onanswer(rows, question);
      } catch (error) {
        await this.#paint().catch(this.onerror); // not the answer before
        this.onerror(error);
      }
    }
    this.#isBusy = false;
  }

  async #paint(colourOf = (i) => this.#own.lut.subarray(4 * i, 4 * i + 4)) {
    const { labels, min = 0 } = this.#own;
    const I = labels.map((_, i) => min + i);
    const colours = I.map((label, i) => colourOf(i, label));
    const [R, G, B, A] = [0, 1, 2, 3].map((part) => colours.map((colour) => colour[part]));
    const place = this.#nv.volumes.indexOf(this.#volume);
    if (place >= 0) await this.#nv.setColormapLabel(place, { R, G, B, A, I, labels });
  }

  async dispose() {
    this.#context.dispose();
    this.onanswer = this.onerror = () => {};
    this.#next = null;
    this.atlas.close();
    const painted = this.#paint();
    this.#volume = null; // an answer that is here already paints no more
    await painted;
  }
}

export async function attachConus(nv, { volume, worker, wasm, ...settings }) {
  const shown = findVolume(nv, volume);
  return new Cone(nv, shown, await load(await filesOf(nv, shown), { worker, wasm }), settings);
}
