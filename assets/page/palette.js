// What a picture shows as colours and words: a layer knows the colour and the text of each texel, and its legend.

import { FINDINGS, LABELS, distanceInMap } from "./capture.js";
import { countInFloat, depthText, length, signed } from "./numbers.js";

const [UP, DOWN, APPEARED, WENT] = [[0xe0, 0x70, 0x3a], [0x56, 0xb4, 0xe9], [0x2f, 0xb5, 0x8a], [0xcc, 0x79, 0xa7]];
const BITS = [[0x1b, 0x2a, 0x3d], [0xf0, 0xe4, 0x42]];
// Second signs beside the colours of findings: 1 and 2 are strokes of two directions, 3 both, 4 dots.
const HATCHES = [0, 1, 2, 3, 4, 0];

// What a step writes: its view where none is chosen.
export function viewOf(capture, { view, step, draw }) {
  if (view !== "auto") return view;
  const state = capture.state(step, draw);
  if (state.kind === "map") return "map";
  if (state.target !== "picture") return state.target === "count" ? "count" : "mask";
  const { draws } = capture.passes[step];
  const isDrawn = (draw === null ? draws : [draws[draw]]).some(({ raster }) => raster.color !== "None");
  return state.stencil === null || draws.length === 0 || isDrawn ? "color" : "stencil";
}

// Why a view is not there; null where it is.
export function missing(capture, look, view) {
  const light = capture.lights[look.light];
  const needs = {
    stencil: [capture.frameAt(look.step, look.draw)?.stencil ?? null, "This frame has no stencil buffer."],
    count: [light?.count ?? null, "No count is kept in floats."],
    mask: [light?.mask ?? null, "No mask of this light is known."],
    error: [light?.findings ?? null, "The truth was not traced: make the page with --truth."],
    map: [light?.faces[0] ?? null, "This light has no shadow map."],
  };
  const [found, why] = needs[view] ?? [true];
  return found === null ? why : null;
}

const grey = (place) => new Array(3).fill(Math.floor(238 - 196 * Math.min(Math.max(place, 0), 1)));

// How many texels have each value, smallest first.
function tally(values) {
  const counts = new Map();
  for (const value of values) counts.set(value, (counts.get(value) ?? 0) + 1);
  return [...counts].sort(([a], [b]) => a - b);
}

// Of values that are few and have names.
function ofNamed(values, color, name, hatch = () => 0) {
  const entry = ([value, count]) => ({ color: color(value), name: name(value), count, hatch: hatch(value) });
  return {
    values, hatch: (at) => hatch(values[at]), key: (at) => values[at], color: (at) => color(values[at]),
    text: (at) => name(values[at]), short: (at) => name(values[at]).split(" ")[0], legend: () => tally(values).map(entry),
  };
}

// Of stored depths, grey by distance between the nearest and the farthest, or within a range.
function ofDepth(capture, values, distance, range) {
  const known = (depth) => (depth === capture.clear_depth ? null : distance(depth));
  let [low, high] = range ?? [Infinity, -Infinity];
  for (const depth of range ? [] : values) {
    const value = known(depth);
    if (value === null || !Number.isFinite(value)) continue;
    [low, high] = [Math.min(low, value), Math.max(high, value)];
  }
  const words = (value) => (value === null ? "nothing" : length(value, capture.depth.unit));
  const brief = (value) => (value === null ? "none" : Number.isFinite(value) ? value.toPrecision(4) : "∞");
  const color = (value) => (value === null ? capture.palette.stencil[0] : grey(high > low ? (value - low) / (high - low) : 0));
  return {
    values, range: [low, high], key: (at) => values[at], color: (at) => color(known(values[at])),
    text: (at) => `${depthText(values[at])} · ${words(known(values[at]))}`,
    short: (at) => brief(known(values[at])),
    legend: () => [low, high].map((end, at) => ({ color: grey(at), name: words(end), count: null, hatch: 0 })),
  };
}

function ofColor(values, shown = (byte) => byte) {
  const rgb = (at) => [values[at * 4], values[at * 4 + 1], values[at * 4 + 2]];
  const hex = (byte) => byte.toString(16).padStart(2, "0");
  const text = (at) => rgb(at).join(" ");
  return { values, key: text, color: (at) => rgb(at).map(shown), text, short: (at) => rgb(at).map(hex).join(""), legend: () => [] };
}

// The picture of an aspect in a frame; null where there is none.
function ofAspect(capture, look, view, frame) {
  const values = frame && capture.array(frame[view]);
  if (!values) return null;
  if (view === "color") return ofColor(values);
  if (view === "depth") return ofDepth(capture, values, (depth) => capture.distance(depth), look.range);
  if (look.bit === null) return ofNamed(values, (value) => capture.palette.stencil[value], signed);
  return ofNamed(values.map((value) => (value >> look.bit) & 1), (value) => BITS[value], String);
}

function ofMap(capture, look) {
  const face = capture.lights[look.light].faces[look.face];
  const values = capture.texelsOf(face);
  const layer = face.isColor ? ofColor(values, (byte) => capture.palette.linear[byte])
    : ofDepth(capture, values, (depth) => distanceInMap(face, depth) ?? depth, null);
  return { ...layer, size: face.size };
}

// After against before: what did not change stands back.
function difference(capture, view, before, after) {
  const isChanged = (at) => before === null || before.key(at) !== after.key(at);
  const kindOf = {
    stencil: (at) => (((after.values[at] - (before?.values[at] ?? 0)) & 0xff) < 128 ? [UP, "more"] : [DOWN, "less"]),
    depth: (at) => {
      const [was, is] = [before?.values[at] ?? capture.clear_depth, after.values[at]];
      if (was === capture.clear_depth) return [APPEARED, "appeared"];
      if (is === capture.clear_depth) return [WENT, "went"];
      return is > was === capture.is_reversed ? [UP, "nearer"] : [DOWN, "farther"];
    },
    color: (at) => [after.color(at), "changed"],
  }[view];
  const legend = () => {
    const found = new Map();
    for (let at = 0; at < capture.size[0] * capture.size[1]; at++) {
      if (!isChanged(at)) continue;
      const [color, name] = kindOf(at);
      found.set(name, { color: view === "color" ? [255, 255, 255] : color, name, count: (found.get(name)?.count ?? 0) + 1, hatch: 0 });
    }
    return [...found.values()];
  };
  return {
    ...after, legend, color: (at) => (isChanged(at) ? kindOf(at)[0] : after.color(at).map((byte) => Math.round(byte * 0.22))),
    text: (at) => (isChanged(at) ? `${before?.text(at) ?? "nothing"} → ${after.text(at)}` : `${after.text(at)}, unchanged`),
  };
}

// What is shown; null where there is nothing of it.
export function layerOf(capture, look) {
  const view = viewOf(capture, look);
  if (missing(capture, look, view) !== null) return null;
  const { size, palette, lights: { [look.light]: light } } = capture;
  if (view === "map") return ofMap(capture, look);
  if (view === "mask") return { ...ofNamed(capture.array(light.mask), (value) => palette.labels[value], (value) => LABELS[value]), size };
  if (view === "error") {
    const [color, name] = [(value) => palette.findings[value], (value) => FINDINGS[value]];
    return { ...ofNamed(capture.array(light.findings), color, name, (value) => HATCHES[value]), size };
  }
  if (view === "count") return { ...ofNamed(capture.array(light.count), (value) => palette.stencil[value & 0xff], countInFloat), size };
  const after = ofAspect(capture, look, view, capture.frameAt(look.step, look.draw));
  const before = ofAspect(capture, look, view, capture.frameBefore(look.step, look.draw));
  const layer = { before, after, diff: after && look.phase === "diff" ? difference(capture, view, before, after) : null }[look.phase];
  return layer && { ...layer, size };
}
