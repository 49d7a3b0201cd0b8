// SPDX-License-Identifier: BSD-3-Clause
// Draws the brain, the cone, hands and the panel for each eye, by WebGL2. Nothing depends on pixels of the screen: each
// eye has a screen of its own.
import { matrix, times } from "./matrix.js";

const BLOCK = 1 << 20; // bytes of surfaces that a frame gives to the graphics processor
const SIDES = 48; // of what is round
const PAINTS = 256; // objects in a row of the texture of their colours
const NEAR = 0.03, FAR = 30; // m: a head may be in the brain

const BRAIN = [`#version 300 es
uniform mat4 clip, room; uniform vec3 eye; uniform sampler2D paints; uniform bool glass;
layout(location = 0) in vec3 position; layout(location = 1) in vec3 normal; layout(location = 2) in uint object;
out vec3 n; out vec3 toEye; out float along; flat out vec4 paint;
void main() {
  gl_Position = clip * vec4(position, 1);
  n = mat3(room) * normal;
  toEye = eye - (room * vec4(position, 1)).xyz;
  along = position.x + position.y + position.z;
  paint = texelFetch(paints, ivec2(object % ${PAINTS}u, object / ${PAINTS}u), 0);
  if (glass && paint.a > 0.0) gl_Position = vec4(0, 0, 2, 1); // what is hit is no glass
}`, `#version 300 es
precision mediump float;
uniform vec3 rest; uniform float opacity; uniform highp float stripe; uniform bool glass;
in vec3 n; in vec3 toEye; in highp float along; flat in vec4 paint; out vec4 colour;
void main() {
  float cosine = abs(dot(normalize(n), normalize(toEye)));
  float light = 0.35 + 0.65 * cosine;
  float alpha = glass ? mix(0.75, opacity, cosine) : 1.0;
  bool isBehind = paint.a < 0.9 && fract(along / stripe) > 0.5;
  colour = vec4((glass || isBehind ? rest : paint.rgb) * light * alpha, alpha);
}`];
const PLAIN = [`#version 300 es
uniform mat4 clip; layout(location = 0) in vec3 position; layout(location = 1) in vec2 at; out vec2 uv;
void main() { gl_Position = clip * vec4(position, 1); uv = at; }`, `#version 300 es
precision mediump float;
uniform vec4 colour; uniform sampler2D picture; uniform bool hasPicture; in vec2 uv; out vec4 result;
void main() { result = hasPicture ? texture(picture, uv) : vec4(colour.rgb * colour.a, colour.a); }`];

/** Of a colour "#rrggbb", and an opacity. @param {string} hex @param {number} opacity */
const rgba = (hex, opacity) => Float32Array.of(...[1, 3, 5].map((i) => parseInt(hex.slice(i, i + 2), 16) / 255), opacity);
const COLOURS = {
  ground: rgba("LOOK_PANE_DARK", 1), rest: rgba("LOOK_NOT_HIT", 1), floor: rgba("LOOK_NOT_HIT", 0.4), ball: rgba("LOOK_SECOND", 1),
};
/** Of the cone, and of an old one: its end, that where it is hidden, and its wall. */
const CONES = ["LOOK_CONE", "LOOK_CONE_OLD"].map((hex) => [1, 0.5, 0.14].map((opacity) => rgba(hex, opacity)));

/** What a frame shows. @typedef {{brain: Float64Array, cone: Float64Array | null, near: Float64Array | null, ball: Float64Array | null, isOld: boolean, wands: Float64Array[], wandCount: number, panel: Float64Array, hasFloor: boolean}} Scene */

export class Stage {
  /** @param {() => void} lost */
  constructor(lost) {
    const canvas = document.createElement("canvas");
    const gl = canvas.getContext("webgl2", { xrCompatible: true, antialias: true, alpha: true });
    if (!gl) throw new Error("this browser has no WebGL 2");
    canvas.addEventListener("webglcontextlost", lost);
    this.gl = gl;
    this.clip = matrix();
    this.model = matrix();
    this.numbers = new Float32Array(16); // of what a shader takes
    this.eye = new Float32Array(3);
    this.brain = this.program(BRAIN);
    this.plain = this.program(PLAIN);
    this.paints = this.texture(gl.NEAREST);
    this.picture = this.texture(gl.LINEAR_MIPMAP_LINEAR);
    const round = Array.from({ length: SIDES + 1 }, (_, i) => [Math.cos(2 * Math.PI * i / SIDES), Math.sin(2 * Math.PI * i / SIDES)]);
    const ends = round.slice(1).map((p, i) => [...round[i], ...p]);
    const band = (/** @type {number} */ inner, /** @type {(x: number, y: number) => number[]} */ at) => ends.flatMap(([x, y, u, v]) => [at(x, y), at(u, v), at(inner * u, inner * v), at(x, y), at(inner * u, inner * v), at(inner * x, inner * y)].flat());
    this.shapes = {
      cone: this.shape(ends.flatMap(([x, y, u, v]) => [0, 0, 0, x, y, 1, u, v, 1])), // along +z, 1 deep and wide
      rim: this.shape(band(0.97, (x, y) => [x, y, 1])),
      wand: this.shape(ends.flatMap(([x, y, u, v]) => [0, 0, 0, 0.01 * x, 0.01 * y, 0.12, 0.01 * u, 0.01 * v, 0.12])), // its tip is the cone's apex
      square: this.shape([-0.5, -0.5, 0, 0.5, -0.5, 0, 0.5, 0.5, 0, -0.5, -0.5, 0, 0.5, 0.5, 0, -0.5, 0.5, 0], [0, 1, 1, 1, 1, 0, 0, 1, 1, 0, 0, 0]),
      ball: this.shape(Array.from({ length: SIDES / 4 }, (_, i) => [i, i + 1].map((v) => 4 * Math.PI * v / SIDES)).flatMap(([low, high]) => ends.flatMap(([x, y, u, v]) => [[x, y, low], [u, v, low], [u, v, high], [x, y, low], [u, v, high], [x, y, high]].flatMap(([a, b, t]) => [a * Math.sin(t), b * Math.sin(t), Math.cos(t)])))),
      floor: this.shape(band(0.985, (x, z) => [x, 0, z])),
    };
    this.hasPanel = false;
    this.isReady = false; // all of the brain is there
    /** The ranges of corners of what is hit. @type {number[][]} */
    this.hits = [];
    /** Blocks that the graphics processor has not got. @type {{target: number, buffer: WebGLBuffer | null, bytes: Uint8Array, done: number}[]} */
    this.pending = [];
  }

  /** @param {string[]} sources */
  program(sources) {
    const { gl } = this;
    const made = /** @type {WebGLProgram} */ (gl.createProgram());
    sources.forEach((source, i) => {
      const shader = /** @type {WebGLShader} */ (gl.createShader(i ? gl.FRAGMENT_SHADER : gl.VERTEX_SHADER));
      gl.shaderSource(shader, source);
      gl.compileShader(shader);
      gl.attachShader(made, shader);
    });
    gl.linkProgram(made);
    if (!gl.getProgramParameter(made, gl.LINK_STATUS)) throw new Error(`this browser's WebGL does not draw: ${gl.getProgramInfoLog(made)}`);
    /** @type {Record<string, WebGLUniformLocation | null>} */
    const at = {};
    for (let i = gl.getProgramParameter(made, gl.ACTIVE_UNIFORMS) - 1; i >= 0; i--) {
      const { name } = /** @type {WebGLActiveInfo} */ (gl.getActiveUniform(made, i));
      at[name] = gl.getUniformLocation(made, name);
    }
    return { made, at };
  }

  /** @param {number} filter */
  texture(filter) {
    const { gl } = this, made = gl.createTexture();
    gl.bindTexture(gl.TEXTURE_2D, made);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, filter);
    if (filter === gl.NEAREST) gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, filter);
    return made;
  }

  /** @param {number[]} positions @param {number[]} [uv] */
  shape(positions, uv) {
    const { gl } = this, array = gl.createVertexArray();
    gl.bindVertexArray(array);
    [positions, uv ?? []].forEach((numbers, i) => {
      if (!numbers.length) return;
      gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
      gl.bufferData(gl.ARRAY_BUFFER, new Float32Array(numbers), gl.STATIC_DRAW);
      gl.enableVertexAttribArray(i);
      gl.vertexAttribPointer(i, i ? 2 : 3, gl.FLOAT, false, 0, 0);
    });
    gl.bindVertexArray(null);
    return { array, count: positions.length / 3 };
  }

  /** Takes surfaces, as the worker gives them; the frames that follow bring them to the graphics processor, block by block.
   * @param {ArrayBuffer[]} parts @param {boolean} isClosed */
  take([positions, normals, objects, corners, outer, first], isClosed) {
    const { gl } = this;
    for (const buffer of this.buffers ?? []) gl.deleteBuffer(buffer);
    for (const array of [this.whole, this.outer]) gl.deleteVertexArray(array ?? null); // which keep buffers
    this.pending = [];
    const buffers = this.buffers = [positions, normals, objects, corners, outer].map((bytes, i) => {
      const target = i < 3 ? gl.ARRAY_BUFFER : gl.ELEMENT_ARRAY_BUFFER, buffer = gl.createBuffer();
      gl.bindBuffer(target, buffer);
      gl.bufferData(target, bytes.byteLength, gl.STATIC_DRAW);
      this.pending.push({ target, buffer, bytes: new Uint8Array(bytes), done: 0 });
      return buffer;
    });
    [this.whole, this.outer] = [3, 4].map((indices) => {
      const array = gl.createVertexArray();
      gl.bindVertexArray(array);
      for (let i = 0; i < 3; i++) {
        gl.bindBuffer(gl.ARRAY_BUFFER, buffers[i]);
        gl.enableVertexAttribArray(i);
        if (i === 2) gl.vertexAttribIPointer(i, 1, gl.UNSIGNED_SHORT, 0, 0);
        else gl.vertexAttribPointer(i, 3, i ? gl.BYTE : gl.FLOAT, Boolean(i), i ? 4 : 0, 0);
      }
      gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, buffers[indices]);
      gl.bindVertexArray(null);
      return array;
    });
    this.outerCount = outer.byteLength / 4;
    this.first = new Uint32Array(first);
    this.colours = new Uint8Array(4 * PAINTS * Math.ceil(this.first.length / PAINTS));
    this.isClosed = isClosed;
    this.isReady = false;
  }

  /** Gives the graphics processor one block. */
  upload() {
    const { gl } = this, next = this.pending[0];
    if (!next) return;
    gl.bindVertexArray(null);
    gl.bindBuffer(next.target, next.buffer);
    const size = Math.min(BLOCK, next.bytes.length - next.done);
    gl.bufferSubData(next.target, next.done, next.bytes, next.done, size);
    next.done += size;
    if (next.done === next.bytes.length) this.pending.shift();
    this.isReady = !this.pending.length;
  }

  /** Colours of what is hit; all else is glass. @param {{number: number, rgb: number[], behind: boolean}[]} hits */
  paint(hits) {
    const { gl, first, colours } = this;
    if (!first || !colours) return;
    this.hits = hits.map(({ number }) => [first[number], first[number + 1] - first[number]]).filter(([, count]) => count);
    colours.fill(0);
    for (const { number, rgb, behind } of hits) colours.set([...rgb, behind ? 128 : 255], 4 * number);
    gl.bindTexture(gl.TEXTURE_2D, this.paints);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA8, PAINTS, colours.length / 4 / PAINTS, 0, gl.RGBA, gl.UNSIGNED_BYTE, colours);
  }

  /** @param {HTMLCanvasElement} canvas */
  show(canvas) {
    const { gl } = this;
    gl.bindTexture(gl.TEXTURE_2D, this.picture);
    gl.pixelStorei(gl.UNPACK_PREMULTIPLY_ALPHA_WEBGL, true);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA8, gl.RGBA, gl.UNSIGNED_BYTE, canvas);
    gl.generateMipmap(gl.TEXTURE_2D);
    gl.pixelStorei(gl.UNPACK_PREMULTIPLY_ALPHA_WEBGL, false);
    this.hasPanel = true;
  }

  /** Draws into a session from now on. @param {any} session @param {boolean} seesRoom @param {number} stripe mm of what is striped */
  async enter(session, seesRoom, stripe) {
    const { gl, brain: { made, at } } = this;
    this.seesRoom = seesRoom;
    await gl.makeXRCompatible();
    gl.useProgram(made);
    gl.uniform3fv(at.rest, COLOURS.rest.subarray(0, 3));
    gl.uniform1f(at.stripe, stripe);
    gl.uniform1f(at.opacity, seesRoom ? 0.6 : 0.3);
    const layer = this.layer = new globalThis.XRWebGLLayer(session, gl, { antialias: true, alpha: true });
    if ("fixedFoveation" in layer) layer.fixedFoveation = 1 / 3; // low: the panel has words
    session.updateRenderState({ baseLayer: layer, depthNear: NEAR, depthFar: FAR });
  }

  /** @param {any} views @param {Scene} scene */
  draw(views, scene) {
    const { gl, layer } = this;
    this.upload();
    gl.bindFramebuffer(gl.FRAMEBUFFER, layer.framebuffer); // which on a headset is not the canvas
    const { ground } = COLOURS;
    if (this.seesRoom) gl.clearColor(0, 0, 0, 0);
    else gl.clearColor(ground[0], ground[1], ground[2], 1);
    gl.depthMask(true);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.enable(gl.DEPTH_TEST);
    gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
    for (let i = 0; i < views.length; i++) {
      const { x, y, width, height } = layer.getViewport(views[i]);
      gl.viewport(x, y, width, height);
      times(this.clip, views[i].projectionMatrix, views[i].transform.inverse.matrix);
      if (this.isReady) this.drawBrain(views[i].transform.position, scene);
      this.drawRest(scene);
    }
  }

  /** What is hit, opaque; then the nearest surface of all else as glass: its depth, and then it alone.
   * @param {{x: number, y: number, z: number}} eye @param {Scene} scene */
  drawBrain(eye, { brain }) {
    const { gl, hits } = this, { made, at } = this.brain;
    gl.useProgram(made);
    this.numbers.set(times(this.model, this.clip, brain));
    gl.uniformMatrix4fv(at.clip, false, this.numbers);
    this.numbers.set(brain);
    gl.uniformMatrix4fv(at.room, false, this.numbers);
    this.eye[0] = eye.x;
    this.eye[1] = eye.y;
    this.eye[2] = eye.z;
    gl.uniform3fv(at.eye, this.eye);
    gl.bindTexture(gl.TEXTURE_2D, this.paints);
    if (this.isClosed) gl.enable(gl.CULL_FACE);
    gl.disable(gl.BLEND);
    gl.uniform1i(at.glass, 0);
    gl.bindVertexArray(this.whole ?? null);
    for (let i = 0; i < hits.length; i++) gl.drawElements(gl.TRIANGLES, hits[i][1], gl.UNSIGNED_INT, 4 * hits[i][0]);
    gl.uniform1i(at.glass, 1);
    gl.bindVertexArray(this.outer ?? null);
    gl.colorMask(false, false, false, false);
    gl.drawElements(gl.TRIANGLES, this.outerCount ?? 0, gl.UNSIGNED_INT, 0);
    gl.colorMask(true, true, true, true);
    gl.depthFunc(gl.LEQUAL);
    gl.depthMask(false);
    gl.enable(gl.BLEND);
    gl.drawElements(gl.TRIANGLES, this.outerCount ?? 0, gl.UNSIGNED_INT, 0);
    gl.disable(gl.CULL_FACE);
    gl.depthMask(true);
  }

  /** @param {Scene} scene */
  drawRest({ cone, near, ball, isOld, wands, wandCount, panel, hasFloor }) {
    const { gl, shapes } = this;
    gl.enable(gl.BLEND);
    gl.depthFunc(gl.LEQUAL);
    for (let i = 0; i < wandCount; i++) this.put(times(this.model, this.clip, wands[i]), shapes.wand, COLOURS.rest);
    if (this.hasPanel) this.put(times(this.model, this.clip, panel), shapes.square, null);
    if (ball) this.put(times(this.model, this.clip, ball), shapes.ball, COLOURS.ball);
    gl.depthMask(false);
    if (hasFloor && !this.seesRoom) this.put(this.clip, shapes.floor, COLOURS.floor);
    const colours = CONES[Number(isOld)];
    if (near) this.putRim(near, colours);
    if (cone) {
      this.putRim(cone, colours);
      this.put(this.model, shapes.cone, colours[2]);
    }
    gl.depthMask(true);
    gl.depthFunc(gl.LESS);
  }

  /** The end of a cone, which is seen in the brain, too. @param {Float64Array} cone @param {Float32Array[]} colours */
  putRim(cone, colours) {
    const { gl, shapes: { rim } } = this;
    times(this.model, this.clip, cone);
    gl.disable(gl.DEPTH_TEST);
    this.put(this.model, rim, colours[1]);
    gl.enable(gl.DEPTH_TEST);
    this.put(this.model, rim, colours[0]);
  }

  /** @param {Float64Array} clip @param {{array: any, count: number}} shape @param {Float32Array | null} colour null: the panel's picture */
  put(clip, { array, count }, colour) {
    const { gl } = this, { made, at } = this.plain;
    gl.useProgram(made);
    this.numbers.set(clip);
    gl.uniformMatrix4fv(at.clip, false, this.numbers);
    gl.uniform1i(at.hasPicture, colour ? 0 : 1);
    if (colour) gl.uniform4fv(at.colour, colour);
    else gl.bindTexture(gl.TEXTURE_2D, this.picture);
    gl.bindVertexArray(array);
    gl.drawArrays(gl.TRIANGLES, 0, count);
  }
}
