// The captured frame: its files are those of a capture folder (assets/help/capture-folder.md).

import { bytesOf, inflate, unpack } from "./arrays.js";
import { Reader } from "./reader.js";

export const LABELS = ["lit", "shadow", "background", "faces away"];
export const FINDINGS = ["agrees", "false shadow", "missing shadow", "wrong surface", "edge, excused", "not compared"];

// What is held after a pass or a draw, by the files that are named.
function stateOf(files, light) {
  if (files.map || files.textures) return { kind: "map", light, face: files.map_face ?? files.texture_layer ?? 0 };
  const target = ["labels", "count", "visibility"].find((name) => files[name]) ?? "picture";
  return { kind: "frame", target, color: files.color, depth: files.depth, stencil: files.stencil ?? null };
}

export class Capture {
  constructor(document) {
    Object.assign(this, document);
    [this.unpacked, this.pending, this.reader, this.problem] = [{}, {}, null, null];
  }

  // The numbers of a file; null before it is unpacked.
  array(name) { return this.unpacked[name] ?? null; }

  // Unpacks these files, each once.
  async provide(names) {
    await Promise.all(names.filter((name) => this.files[name]).map((name) => {
      this.pending[name] ??= unpack(this.files[name]).then((array) => {
        this.unpacked[name] = array;
        this.files[name].data = null;
      });
      return this.pending[name];
    }));
  }

  // Reads what there is: passes, draws, raster states, lights.
  async open() {
    await this.provide(["manifest.json", "frame.json"]);
    const [manifest, frame] = ["manifest.json", "frame.json"].map((name) => JSON.parse(new TextDecoder().decode(this.array(name))));
    const { passes, lights, scene, technique, size, adapter, program, depth, origin, left_out: leftOut } = manifest;
    const named = this.lights;
    Object.assign(this, { scene, technique, size, adapter, program, depth, origin, leftOut });
    this.passes = frame.plan.passes;
    this.steps = passes.map((pass, index) => {
      const captured = (at) => pass.draws_captured && stateOf(pass.draws_captured[at], pass.light);
      const otherwise = ({ differs }) => (differs ? differs.depth + differs.stencil : 0);
      const draws = pass.draw_list.map((draw, at) => ({ ...draw, after: captured(at) ?? null, differs: otherwise(draw) }));
      const { name, purpose, light } = pass;
      return { name, purpose, light, number: this.numbers[index], after: stateOf(pass, light), draws };
    });
    this.lights = lights.map(({ shadow, count, error_picture: findings, map, textures }, index) => {
      const faces = this.facesOf(map ?? textures, named[index].faces, !map);
      return { name: named[index].name, mask: shadow ?? null, count: count ?? null, findings: findings ?? null, faces };
    });
  }

  // The faces of a light's map are layers of one array.
  facesOf(file, named, isColor) {
    const [, height, width] = this.files[file]?.shape ?? [];
    return named.map((face, layer) => ({ ...face, file, layer, size: [width, height], isColor }));
  }

  texelsOf({ file, layer }) {
    const array = this.array(file);
    const texels = array.length / this.files[file].shape[0];
    return array.subarray(layer * texels, (layer + 1) * texels);
  }

  // Unpacks all files and gives them to what answers questions. Without it pictures are still shown.
  async openReader(module) {
    await this.provide(Object.keys(this.files));
    try {
      const reader = await Reader.of(await inflate(module));
      for (const [name, { header }] of Object.entries(this.files)) {
        const { buffer, byteOffset, byteLength } = this.array(name);
        reader.put(name, bytesOf(header ?? ""), new Uint8Array(buffer, byteOffset, byteLength));
        // What no picture shows is only asked about.
        if (/^(mesh|pass|frame\.|manifest\.)/.test(name)) delete this.unpacked[name];
      }
      reader.read();
      this.reader = reader;
    } catch (error) {
      this.problem = error.message;
    }
  }

  // The answer to a question; null where there is none.
  ask(question) {
    try {
      return this.reader?.ask(question) ?? null;
    } catch (error) {
      // What has failed once does not answer again.
      [this.reader, this.problem] = [null, error.message];
      return null;
    }
  }

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

  // Distance along the view axis of a stored depth; null where nothing was drawn, at infinity in a range of depths, and where
  // all depths are stored as one (math/depth.rs).
  distance(depth) {
    const { offset, scale, range, is_linear: isLinear } = this.depth;
    const isInfinite = !isLinear && range && Math.abs(depth - offset) <= 2 ** -23 * Math.abs(offset);
    if (depth === this.clear_depth || scale === 0 || isInfinite) return null;
    return isLinear ? (depth - offset) / scale : scale / (depth - offset);
  }
}

// Distance from the light of a depth in a face of its map; null where that is not known.
export function distanceInMap(face, depth) {
  if (!face.measure) return null;
  const { scale, offset, is_linear: isLinear } = face.measure;
  return isLinear ? (depth - offset) * scale : scale / (depth - offset);
}
