// SPDX-License-Identifier: BSD-3-Clause
/** A position, RAS mm. */
export type Point = readonly [x: number, y: number, z: number];
/** A file's content; a File brings its name. */
export type Data = Blob | ArrayBuffer | ArrayBufferView;

/** A cone. */
export interface Question {
  /** Its apex. */
  origin: Point;
  /** A point of its axis. */
  toward: Point;
  /** Full opening angle, degrees, 0.001 to 170. */
  angle: number;
  /** First hits, or all in the cone; default "visible". */
  layers?: "visible" | "all";
  /** Rays along a side, 1 to 256; default 64, as that of conus query. */
  resolution?: number;
  /** Nearest and farthest depth along the axis, mm from the apex; default all. */
  range?: readonly [near: number, far: number] | string;
  /** "gauss=DEGREES": how far a hand is off; rows then have a posterior, and ranks by it. */
  weight?: string;
  /** Other options of `conus page` that are no places, by their names. */
  [option: string]: unknown;
}

/** A row of conus query, as its format ndjson has it; null = n/a. */
export interface Row {
  kind: string;
  index: number | null;
  name: string;
  rank: number | null;
  pixels: number;
  share: number;
  distance_mm: number | null;
  [column: string]: number | string | boolean | null;
}

export interface AtlasObject {
  name: string;
  rgb: [red: number, green: number, blue: number];
  /** "" where it is not known. */
  side: "L" | "R" | "";
}

export interface LoadOptions {
  /** Of bytes that have none; its ending says the format. */
  name?: string;
  /** Starts ./worker.js where the bundler needs another way. */
  worker?: () => Worker | Promise<Worker>;
  /** conus.wasm, where it is not beside this module. */
  wasm?: ArrayBuffer | ArrayBufferView;
}

/** What conus refuses, in its words. */
export class ConusError extends Error {}

export class Atlas {
  private constructor();
  readonly name: string;
  /** Of the volume's file; "" of surfaces. */
  readonly sha256: string;
  /** Of conus. */
  readonly version: string;
  /** Which published atlas it is, where its voxels or names say so. */
  readonly identity?: string;
  readonly notes: readonly string[];
  /** What looks wrong: show them. */
  readonly warnings: readonly string[];
  /** Corners of the box around its areas, RAS mm. */
  readonly low: Point;
  readonly high: Point;
  readonly objects: readonly AtlasObject[];
  /** Of the last answer's areas, in its order, as pictures have them: "#rrggbb". */
  readonly colours?: readonly string[];
  /** The rows of conus query for this cone; rejects with a ConusError. */
  select(question: Question): Promise<Row[]>;
  /** The last answer as text, or the JSON that describes it. */
  text(format?: "tsv" | "csv" | "json" | "ndjson" | "sidecar"): Promise<string>;
  /** Ends its worker. */
  close(): void;
}

/** Opens an atlas: a file, or {name: data} of one and what lies beside it, such as its label table, the atlas first. */
export function load(source: Data | Record<string, Data>, options?: LoadOptions): Promise<Atlas>;
