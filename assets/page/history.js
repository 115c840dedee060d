// What happened to one pixel, fragment by fragment (src/history): the triangles over it go through the tests one by
// one, and what comes out is held against what the GPU stored after every pass.

import { covering, isOfPicture, viewportOf } from "./coverage.js";
import { isStencilEnabled, faceOf, testFragment } from "./stencil_machine.js";

const VOLUME_PARTS = ["side", "light-cap", "dark-cap"];

export const isOfVolume = (event) => VOLUME_PARTS.includes(event.triangle?.part);

const STEPS = { "increment-clamp": 1, "increment-wrap": 1, invert: 1, "decrement-clamp": -1, "decrement-wrap": -1 };

// How much an event added to the count of volumes.
export function countedBy({ before, after, triangle }) {
  const change = after.stencil - before.stencil;
  const inStencil = change === 0 ? 0 : STEPS[triangle?.operation] ?? ((change + 384) & 0xff) - 128;
  return inStencil + Math.trunc(after.count - before.count);
}

// What it was to add, also where the count was at its limit.
export function stepOf(event) {
  return event.triangle?.operation ? STEPS[event.triangle.operation] ?? 0 : countedBy(event);
}

export function showsOutside(triangle) {
  return triangle.isFront !== triangle.facesInwards;
}

export function passedAll(triangle) {
  return triangle.kind === "tested" && (triangle.depthTest === "passed" || triangle.depthTest === "always");
}

export function doesSomething(event) {
  const { before, after } = event;
  const changes = before.depth !== after.depth || before.stencil !== after.stencil || before.count !== after.count;
  return changes || (event.triangle !== null && passedAll(event.triangle) && !isOfVolume(event));
}

// What a draw whose depths are integers stores.
function storedDepth(format, depth) {
  const steps = { "depth16unorm": 0xffff, "depth24plus": 0xffffff, "depth24plus-stencil8": 0xffffff }[format];
  if (!steps) return depth;
  const product = Math.fround(depth * steps);
  const low = Math.floor(product);
  const up = product - low > 0.5 || (product - low === 0.5 && low % 2 === 1);
  return Math.fround((up ? low + 1 : low) / steps);
}

// Which side of the depth range a program throws away (plan/mod.rs, Program::discards).
function discards(program, depth) {
  if (program.Ambient?.from_near && depth < 0) return "near";
  const isLit = program.Light !== undefined || program.Label !== undefined || program === "Through";
  return isLit && depth > 1 ? "far" : null;
}

// Whom a program asks how much light arrives; null where it adds none.
function lightsOf({ program, part }) {
  if (program.Light !== undefined) return program.Light;
  return program.Recorded !== undefined && part === "surface" ? "Everywhere" : null;
}

function countOf({ raster, program, constants }, isFront) {
  if (raster.color === "None") return 0;
  if (program === "Count") return isFront ? constants.count : -constants.count;
  return program === "Flat" ? constants.flat[0] : 0;
}

const testWord = (passed, compare) =>
  passed === null ? "not-reached" : passed ? (compare === "always" ? "always" : "passed") : "failed";

class Replay {
  constructor(capture, pixel) {
    this.capture = capture;
    this.pixel = pixel;
    this.events = [];
    const { passes } = capture.plan;
    this.first = passes.findIndex((pass) => isOfPicture(capture.plan, pass) && pass.depth_stencil !== null);
    this.held = this.content(this.first, { depth: 0, stencil: 0, count: 0 });
    this.start = this.held;
  }

  // What a pass's target began with at the pixel, and of `held` where that says nothing.
  content(pass, held) {
    const start = this.capture.starts[pass];
    if (!start) return held;
    const at = this.capture.index(this.pixel);
    const depth = this.capture.array(start.depth)?.[at] ?? held.depth;
    return { ...held, depth, stencil: this.capture.array(start.stencil)?.[at] ?? held.stencil };
  }

  countsInFloat(pass) {
    const role = pass.color && this.capture.plan.attachments[pass.color.attachment].role;
    return Boolean(role) && role.Count !== undefined;
  }

  target(pass) {
    const role = pass.color ? this.capture.plan.attachments[pass.color.attachment].role : null;
    if (role?.Labels !== undefined) return "labels";
    return role?.Count !== undefined ? "count" : "picture";
  }

  push(index, kind, after, triangle = null) {
    const pass = this.capture.plan.passes[index];
    this.events.push({
      pass: index, passName: pass.name, light: pass.light, isFromCamera: pass.view === 0, target: this.target(pass),
      kind, triangle, before: this.held, after,
    });
    this.held = after;
  }

  clear(index, pass) {
    if (this.capture.starts[index] && index !== this.first) this.push(index, "put", this.content(index, this.held));
    const { clear_depth: depth = null, clear_stencil: stencil = null } = pass.depth_stencil ?? {};
    if (depth !== null) this.push(index, "clear-depth", { ...this.held, depth: Math.fround(depth) });
    if (stencil !== null) this.push(index, "clear-stencil", { ...this.held, stencil });
    if (this.countsInFloat(pass) && pass.color.clear) {
      this.push(index, "clear-count", { ...this.held, count: Math.fround(pass.color.clear[0]) });
    }
  }

  triangle(pass, one) {
    const draw = pass.draws[one.draw];
    return {
      draw: one.draw, drawName: draw.name, caster: draw.caster, part: draw.part, primitive: one.primitive,
      triangle: one.triangle, isFront: one.fate.isFront, facesInwards: draw.faces_inwards, lights: lightsOf(draw),
      depth: one.fate.depth, kind: one.fate.kind, clip: one.fate.clip ?? null, operation: null,
    };
  }

  // Takes a fragment through the tests.
  test(pass, one) {
    const draw = pass.draws[one.draw];
    const triangle = this.triangle(pass, one);
    const clip = one.fate.kind === "fragment" ? discards(draw.program, triangle.depth) : null;
    if (one.fate.kind !== "fragment" || clip !== null) {
      const kind = clip === null ? one.fate.kind : "discarded";
      this.push(one.pass, "triangle", this.held, { ...triangle, kind, clip: clip ?? triangle.clip });
      return;
    }
    const [near, far] = viewportOf(pass, this.capture.size).depth;
    const clamped = draw.raster.unclipped_depth ? Math.min(Math.max(triangle.depth, near), far) : triangle.depth;
    const target = pass.depth_stencil && this.capture.plan.attachments[pass.depth_stencil.attachment];
    const depth = target ? storedDepth(target.format, clamped) : clamped;
    const outcome = testFragment(draw.raster, { depth, isFront: triangle.isFront }, this.held);
    const { face } = faceOf(draw.raster, triangle.isFront);
    const added = outcome.depthPassed && this.countsInFloat(pass) ? countOf(draw, triangle.isFront) : 0;
    this.push(one.pass, "triangle", { ...outcome.after, count: this.held.count + added }, {
      ...triangle, depth, kind: "tested",
      stencilTest: testWord(outcome.stencilPassed, face.compare),
      depthTest: testWord(outcome.depthPassed, draw.raster.depth_compare),
      operation: isStencilEnabled(draw.raster) ? outcome.operation : null,
    });
  }
}

// What the GPU stored at a pixel after each pass of the picture.
function capturedAfter(capture, pixel) {
  const at = capture.index(pixel);
  const counts = (step) => {
    const { after } = capture.steps[step];
    return after.kind === "frame" && after.target === "count" ? capture.plan.passes[step].light : null;
  };
  return capture.steps.flatMap(({ after }, pass) => {
    if (after.kind !== "frame") return [];
    const light = counts(pass);
    const isLast = light !== null && !capture.steps.some((_, later) => later > pass && counts(later) === light);
    const count = isLast ? capture.array(capture.lights[light].count)?.[at] ?? null : null;
    return [{ pass, depth: capture.array(after.depth)[at], stencil: capture.array(after.stencil)?.[at] ?? 0, count }];
  });
}

// Lines of what the events make otherwise than the GPU has stored it; depth to the last bits.
function disagreements(history, capture) {
  return history.capturedAfter.flatMap(({ pass, depth, stencil, count }) => {
    const last = history.events.filter((event) => event.pass <= pass).pop();
    const held = last ? last.after : history.start;
    const isSame = Math.abs(held.depth - depth) <= capture.depth_rounding
      && (!history.hasStencil || held.stencil === stencil) && (count === null || held.count === count);
    if (isSame) return [];
    return [`after pass ${pass + 1} the events make depth ${held.depth}, stencil ${held.stencil}, count ${held.count}; `
      + `the GPU stored depth ${depth}, stencil ${stencil}${count === null ? "" : `, count ${count}`}`];
  });
}

// The bits of a write mask from the lowest on; eight where it has gaps (plan/count_bits.rs).
function bitsOfMask(mask) {
  const ones = 31 - Math.clz32((mask + 1) & -(mask + 1));
  return ones >= 1 && ones < 8 && mask === (1 << ones) - 1 ? ones : 8;
}

function countsIn(capture, light) {
  const passes = capture.plan.passes.filter((pass) => pass.light === light);
  const draw = passes.flatMap((pass) => pass.draws).find(({ part }) => VOLUME_PARTS.includes(part));
  return draw ? bitsOfMask(draw.raster.stencil.write_mask) : null;
}

export function historyOf(capture, pixel) {
  const replay = new Replay(capture, pixel);
  const triangles = covering(capture, pixel);
  let next = 0;
  capture.plan.passes.forEach((pass, index) => {
    if (!isOfPicture(capture.plan, pass)) return;
    replay.clear(index, pass);
    for (; next < triangles.length && triangles[next].pass === index; next++) replay.test(pass, triangles[next]);
  });
  const after = capturedAfter(capture, pixel);
  const history = {
    pixel,
    hasStencil: capture.plan.attachments.some(({ role, format }) =>
      role === "DepthStencil" && format.endsWith("stencil8")),
    isReversed: capture.isReversed,
    start: replay.start,
    events: replay.events,
    computed: replay.held,
    capturedAfter: after,
    captured: after[after.length - 1] ?? null,
    labels: capture.lights.map((light) => capture.array(light.mask)?.[capture.index(pixel)] ?? null),
    countsIn: capture.lights.map((_, light) => countsIn(capture, light)),
  };
  return { ...history, disagreements: disagreements(history, capture) };
}
