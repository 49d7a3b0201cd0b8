// SPDX-License-Identifier: BSD-3-Clause
export interface Ran {
  /** The exit code: 0 done, 1 some queries have no answer or there is a difference, 2 usage, 3 bad input or too little memory, 4 no OpenGL. */
  code: number;
  stdout: string;
  stderr: string;
  /** Files that the command wrote, by their paths in the folder; none that it wrote elsewhere. */
  files: Record<string, Uint8Array>;
}

/** Runs `conus WORDS...` in a folder in memory that has these files; in this thread. */
export function run(words: readonly string[], files?: Record<string, ArrayBuffer | ArrayBufferView>, options?: {
  /** conus-run.wasm, where it is not beside this module; that of the first call is kept. */
  wasm?: ArrayBuffer | ArrayBufferView;
}): Promise<Ran>;
