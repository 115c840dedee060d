// What happened to one pixel, fragment by fragment (src/history): the triangles over it go through the tests one by
// one, and what comes out is held against what the GPU stored after every pass.

import { covering } from "./coverage.js";
import { roundedToEven } from "./numbers.js";
import { testFragment } from "./stencil_machine.js";

const VOLUME_PARTS = ["side", "light-cap", "dark-cap", "caps"];
export const isOfVolume = (event) => VOLUME_PARTS.includes(event.triangle?.part);
const STEPS = { "increment-clamp": 1, "increment-wrap": 1, invert: 1, "decrement-clamp": -1, "decrement-wrap": -1 };

// How much an event added to the count of volumes.
export function countedBy({ before, after, triangle }) {
  const change = after.stencil - before.stencil;
  const step = STEPS[triangle?.operation] ?? ((change + 384) & 0xff) - 128;
  return (change === 0 ? 0 : step) + Math.trunc(after.count - before.count);
}

// What it was to add, also where the count was at its limit.
export const stepOf = (event) => (event.triangle?.operation ? STEPS[event.triangle.operation] ?? 0 : countedBy(event));
export const showsOutside = (triangle) => triangle.isFront !== triangle.facesInwards;
export const passedAll = ({ kind, depthTest }) => kind === "tested" && (depthTest === "passed" || depthTest === "always");

export function doesSomething(event) {
  const changes = ["depth", "stencil", "count"].some((aspect) => event.before[aspect] !== event.after[aspect]);
  return changes || (event.triangle !== null && passedAll(event.triangle) && !isOfVolume(event));
}

const testWord = (passed, compare) => (passed === null ? "not-reached" : !passed ? "failed" : compare === "always" ? "always" : "passed");

class Replay {
  constructor(capture, pixel) {
    this.capture = capture;
    this.at = capture.index(pixel);
    this.events = [];
    this.first = capture.passes.find((pass) => pass.is_of_picture && pass.has_depth);
    this.start = this.held = this.content(this.first, { depth: 0, stencil: 0, count: 0 });
  }

  // What a pass's target began with at the pixel, and of `held` where that says nothing.
  content({ start }, held) {
    const valueOf = (aspect) => this.capture.array(start?.[aspect])?.[this.at] ?? held[aspect];
    return { ...held, depth: valueOf("depth"), stencil: valueOf("stencil") };
  }

  push(pass, kind, after, triangle = null) {
    const place = { pass: this.capture.passes.indexOf(pass), passName: pass.name, light: pass.light, target: pass.target };
    this.events.push({ ...place, isFromCamera: pass.view === 0, kind, triangle, before: this.held, after });
    this.held = after;
  }

  clear(pass) {
    if (pass.start && pass !== this.first) this.push(pass, "put", this.content(pass, this.held));
    for (const aspect of ["depth", "stencil", "count"]) {
      const value = pass[`clear_${aspect}`];
      if (value !== null) this.push(pass, `clear-${aspect}`, { ...this.held, [aspect]: Math.fround(value) });
    }
  }

  // Takes a triangle through the tests.
  test(pass, { draw: index, primitive, triangle, fate }) {
    const draw = pass.draws[index];
    const { isFront, depth: made } = fate;
    const beyond = made < 0 && draw.discards[0] ? "near" : made > 1 && draw.discards[1] ? "far" : null;
    const { name: drawName, caster, faces_inwards: facesInwards, lights } = draw;
    const part = draw.is_dark === null ? draw.part : ["light-cap", "dark-cap"][this.capture.array(draw.is_dark)[primitive]];
    const own = { draw: index, drawName, caster, part, primitive, triangle, isFront, facesInwards, lights };
    const one = { ...own, depth: made, kind: fate.kind, clip: fate.clip ?? null, operation: null };
    if (fate.kind !== "fragment") return this.push(pass, "triangle", this.held, one);
    if (beyond) return this.push(pass, "triangle", this.held, { ...one, kind: "discarded", clip: beyond });
    const clamped = draw.raster.unclipped_depth ? Math.min(Math.max(made, pass.range[0]), pass.range[1]) : made;
    const steps = pass.depth_steps;
    const depth = steps ? Math.fround(roundedToEven(Math.fround(clamped * steps)) / steps) : clamped;
    const side = draw.sides[isFront ? 0 : 1];
    const { stencilPassed, depthPassed, operation, after } = testFragment(draw.raster, side, depth, this.held);
    const added = depthPassed && pass.target === "count" ? draw.adds[isFront ? 0 : 1] : 0;
    return this.push(pass, "triangle", { ...after, count: this.held.count + added }, {
      ...one, depth, kind: "tested", operation: draw.tests_stencil ? operation : null,
      stencilTest: testWord(stencilPassed, side.compare), depthTest: testWord(depthPassed, draw.raster.depth_compare),
    });
  }
}

// What the GPU stored at a pixel after each pass of the picture.
function capturedAfter(capture, pixel) {
  const at = capture.index(pixel);
  return capture.steps.flatMap(({ after, light }, pass) => {
    if (after.kind !== "frame") return [];
    const isLast = after.target === "count" && !capture.steps.some((one, later) =>
      later > pass && one.light === light && one.after.target === "count");
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

// The history of a pixel, with what it contradicts of the stored bytes.
export function historyOf(capture, pixel) {
  const replay = new Replay(capture, pixel);
  const triangles = covering(capture, pixel);
  let next = 0;
  capture.passes.forEach((pass, index) => {
    if (!pass.is_of_picture) return;
    replay.clear(pass);
    for (; next < triangles.length && triangles[next].pass === index; next++) replay.test(pass, triangles[next]);
  });
  const after = capturedAfter(capture, pixel);
  const history = {
    pixel, start: replay.start, events: replay.events, computed: replay.held, capturedAfter: after,
    captured: after[after.length - 1] ?? null, isReversed: capture.is_reversed, hasStencil: capture.has_stencil,
    labels: capture.lights.map((light) => capture.array(light.mask)?.[capture.index(pixel)] ?? null),
    countsIn: capture.lights.map((light) => light.bits),
  };
  return { ...history, disagreements: disagreements(history, capture) };
}
