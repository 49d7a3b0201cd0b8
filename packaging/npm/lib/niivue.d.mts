// SPDX-License-Identifier: BSD-3-Clause
import type { NiiVueGPU } from "@niivue/niivue";
import type { Atlas, LoadOptions, Point, Question, Row } from "./index.mjs";

/** A question without its target, and the place of the volume among NiiVue's where several have names. */
export interface Settings {
  origin: Point;
  angle: number;
  [option: string]: unknown;
}

export class Cone {
  private constructor();
  /** Show its warnings. */
  readonly atlas: Atlas;
  /** What is asked next; the target is the crosshair. */
  settings: Settings;
  /** Is called with each answer. */
  onanswer: (rows: Row[], question: Question) => void;
  onerror: (error: Error) => void;
  /** Asks; so does each move of the crosshair. */
  point(toward: Point): Promise<void>;
  /** Gives the volume its colours back. */
  dispose(): Promise<void>;
}

export function attachConus(nv: NiiVueGPU, options: Settings & Pick<LoadOptions, "worker" | "wasm"> & { volume?: number }): Promise<Cone>;
