// The captured frame (src/capture): what is held after each step and draw, and where surfaces are.

import { unpack } from "./arrays.js";

export const LABELS = ["lit", "shadow", "background", "faces away"];
export const [LIT, SHADOW, BACKGROUND, FACES_AWAY] = [0, 1, 2, 3];
export const FINDINGS = ["agrees", "false shadow", "missing shadow", "wrong surface", "edge band", "not compared"];

export class Capture {
  constructor(document) {
    Object.assign(this, document);
    [this.unpacked, this.pending] = [[], []];
  }

  // The array of an index; null before it is unpacked.
  array(index) { return this.unpacked[index] ?? null; }

  // Unpacks these arrays, each once.
  async provide(indexes) {
    await Promise.all(indexes.filter(Number.isInteger).map((index) => {
      this.pending[index] ??= unpack(this.arrays[index]).then((array) => {
        this.unpacked[index] = array;
        this.arrays[index] = null;
      });
      return this.pending[index];
    }));
  }

  provideAll() { return this.provide([...this.arrays.keys()]); }
  index([x, y]) { return y * this.size[0] + x; }

  // What is there after a step, or after one of its draws where that was captured.
  state(step, draw) { return (draw === null ? null : this.steps[step].draws[draw].after) ?? this.steps[step].after; }

  // The picture after a step or draw: that of an earlier step where this one made a map.
  frameAt(step, draw = null) {
    if (step < 0) return null;
    const state = this.state(step, draw);
    return state.kind === "frame" ? state : this.frameAt(step - 1);
  }

  // The picture before a step, or before one of its draws.
  frameBefore(step, draw = null) { return draw ? this.frameAt(step, draw - 1) : this.frameAt(step - 1); }

  hasDraws(step) {
    const { draws } = this.steps[step];
    return draws.length > 0 && draws.every((draw) => draw.after !== null);
  }

  // Distance along the view axis of a stored depth; null where nothing was drawn (math/depth.rs).
  distance(depth) {
    const { offset, scale, is_linear: isLinear } = this.depth;
    return depth === this.clear_depth ? null : isLinear ? (depth - offset) / scale : scale / (depth - offset);
  }
}

// Distance from the light of a depth in a face of its map; null where that is not known.
export function distanceInMap(face, depth) {
  if (!face.measure) return null;
  const { scale, offset, is_linear: isLinear } = face.measure;
  return isLinear ? (depth - offset) * scale : scale / (depth - offset);
}
