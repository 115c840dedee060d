// What a picture shows as colours and words: a layer knows the colour and the text of each texel, and its legend.

import { FINDINGS, LABELS, distanceInMap } from "./capture.js";
import { countInFloat, depthText, length, signed, signedAlone } from "./numbers.js";

const UP = [0xe0, 0x70, 0x3a];
const DOWN = [0x56, 0xb4, 0xe9];
const APPEARED = [0x2f, 0xb5, 0x8a];
const WENT = [0xcc, 0x79, 0xa7];
const BITS = [[0x1b, 0x2a, 0x3d], [0xf0, 0xe4, 0x42]];
// Second signs beside colour: 1 and 2 are strokes of two directions, 3 crosses, 4 dots.
const HATCHES = [0, 1, 2, 3, 4, 0];

// What a step writes: its view where none is chosen.
export function autoView(capture, { step, draw }) {
  const state = capture.state(step, draw);
  if (state.kind === "map") return "map";
  if (state.target !== "picture") return state.target === "labels" ? "mask" : "count";
  const all = capture.plan.passes[step].draws;
  const draws = draw === null ? all : [all[draw]];
  if (state.stencil === null || draws.length === 0 || draws.some(({ raster }) => raster.color !== "None")) return "color";
  return "stencil";
}

export const viewOf = (capture, look) => (look.view === "auto" ? autoView(capture, look) : look.view);

// Why a view is not there; null where it is.
export function missing(capture, look, view) {
  const light = capture.lights[look.light];
  const hasStencil = () => capture.frameAt(look.step, look.draw)?.stencil !== null;
  if (view === "stencil") return hasStencil() ? null : "This frame has no stencil buffer.";
  if (view === "count") return light && light.count !== null ? null : "No count is kept in floats.";
  if (view === "mask") return light && light.mask !== null ? null : "No mask of this light is known.";
  if (view === "error") return light && light.findings !== null ? null : "The truth was not traced: make the page with --truth.";
  if (view === "map") return light && light.faces.length > 0 ? null : "This light has no shadow map.";
  return null;
}

const grey = (place) => new Array(3).fill(Math.floor(238 - 196 * Math.min(Math.max(place, 0), 1)));

// The nearest and farthest surface of an array of depths.
function rangeOf(depths, distance) {
  let [low, high] = [Infinity, -Infinity];
  for (const depth of depths) {
    const value = distance(depth);
    if (value === null || !Number.isFinite(value)) continue;
    low = Math.min(low, value);
    high = Math.max(high, value);
  }
  return low <= high ? [low, high] : [0, 1];
}

function tally(values, most) {
  const counts = new Array(most).fill(0);
  for (const value of values) counts[value] += 1;
  return counts;
}

function ofBytes(values, color, name, hatch = () => 0) {
  return {
    values, hatch, key: (at) => values[at], color: (at) => color(values[at]), text: (at) => name(values[at]),
    short: (at) => name(values[at]).slice(0, 4),
    legend: () => tally(values, 256).map((count, value) => ({ color: color(value), name: name(value), count, hatch: hatch(value) }))
      .filter(({ count }) => count > 0),
  };
}

function ofDepth(capture, values, distance, range, hasSurface) {
  const [low, high] = range ?? rangeOf(values, distance);
  const place = (value) => (high > low ? (value - low) / (high - low) : 0);
  const color = (at) => (hasSurface(values[at]) ? grey(place(distance(values[at]))) : capture.palette.stencil[0]);
  const words = (value) => (hasSurface(value) ? length(distance(value), capture.unit) : "no surface");
  return {
    values, range: [low, high], key: (at) => values[at], color, text: (at) => `${depthText(values[at])} · ${words(values[at])}`,
    short: (at) => (hasSurface(values[at]) ? String(Number(distance(values[at]).toPrecision(3))) : "–"),
    legend: () => [0, 1].map((end) => ({ color: grey(end), name: length([low, high][end], capture.unit), count: null, hatch: 0 })),
  };
}

function ofColor(values, shown = (byte) => byte) {
  const rgb = (at) => [values[at * 4], values[at * 4 + 1], values[at * 4 + 2]];
  return {
    values, key: (at) => rgb(at).join(" "), color: (at) => rgb(at).map(shown), text: (at) => rgb(at).join(" "),
    short: (at) => rgb(at).map((byte) => byte.toString(16).padStart(2, "0")).join(""), legend: () => [],
  };
}

function ofStencil(capture, values, bit) {
  if (bit === null) {
    const layer = ofBytes(values, (value) => capture.palette.stencil[value], signed);
    return { ...layer, short: (at) => signedAlone(values[at]) };
  }
  const isSet = values.map((value) => (value >> bit) & 1);
  return ofBytes(isSet, (value) => BITS[value] ?? BITS[0], (value) => `${value}`);
}

function ofCount(capture, values) {
  const color = (value) => capture.palette.stencil[((Math.round(value) % 256) + 256) % 256];
  const legend = () => {
    const counts = new Map();
    for (const value of values) counts.set(value, (counts.get(value) ?? 0) + 1);
    return [...counts].sort(([a], [b]) => a - b)
      .map(([value, count]) => ({ color: color(value), name: countInFloat(value), count, hatch: 0 }));
  };
  return {
    values, key: (at) => values[at], color: (at) => color(values[at]), text: (at) => countInFloat(values[at]),
    short: (at) => countInFloat(values[at]), legend,
  };
}

// The picture of an aspect in a frame; null where there is none.
function aspectOf(capture, look, view, frame) {
  if (!frame) return null;
  const distance = (depth) => capture.distance(depth);
  const hasSurface = (depth) => depth !== capture.clear_depth;
  const values = capture.array(frame[view]);
  if (view === "color") return ofColor(values);
  if (view === "stencil") return values && ofStencil(capture, values, look.bit);
  return ofDepth(capture, values, distance, look.range, hasSurface);
}

function ofMap(capture, look) {
  const faces = capture.lights[look.light].faces;
  const face = faces[Math.min(look.face, faces.length - 1)];
  const values = capture.array(face.image);
  const distance = (depth) => distanceInMap(face, depth) ?? depth;
  const isCaster = (depth) => depth !== capture.clear_depth;
  const layer = face.is_color ? ofColor(values, (byte) => capture.palette.linear[byte])
    : ofDepth(capture, values, distance, null, isCaster);
  if (!face.is_color) layer.range = rangeOf(values.filter(isCaster), distance);
  return { ...layer, size: face.size };
}

// Before and after: what did not change stands back.
function difference(capture, view, before, after) {
  const isChanged = (at) => (before ? before.key(at) !== after.key(at) : true);
  const away = (color) => color.map((byte) => Math.round(byte * 0.22));
  const signedStep = (at) => ((after.values[at] - (before ? before.values[at] : 0) + 384) & 0xff) - 128;
  const depthChange = (at) => {
    const [was, is] = [before ? before.values[at] : capture.clear_depth, after.values[at]];
    if (was === capture.clear_depth) return APPEARED;
    if (is === capture.clear_depth) return WENT;
    return (is > was) === capture.isReversed ? UP : DOWN;
  };
  const changed = { stencil: (at) => (signedStep(at) > 0 ? UP : DOWN), depth: depthChange }[view] ?? after.color;
  const names = view === "stencil" ? [[UP, "more"], [DOWN, "less"]]
    : [[APPEARED, "appeared"], [WENT, "went"], [UP, "nearer"], [DOWN, "farther"]];
  const legend = () => {
    const counts = new Map();
    let all = 0;
    for (let at = 0; at < capture.size[0] * capture.size[1]; at++) {
      if (!isChanged(at)) continue;
      all += 1;
      if (view !== "color") counts.set(changed(at), (counts.get(changed(at)) ?? 0) + 1);
    }
    const ofKinds = names.filter(([color]) => counts.has(color));
    return view === "color" ? [{ color: [255, 255, 255], name: "changed", count: all, hatch: 0 }]
      : ofKinds.map(([color, name]) => ({ color, name, count: counts.get(color), hatch: 0 }));
  };
  return {
    ...after, legend, color: (at) => (isChanged(at) ? changed(at) : away(after.color(at))),
    text: (at) => (isChanged(at) ? `${before ? before.text(at) : "nothing"} → ${after.text(at)}` : `${after.text(at)}, unchanged`),
  };
}

// What is shown; null where there is nothing of it.
export function layerOf(capture, look) {
  const view = viewOf(capture, look);
  if (missing(capture, look, view) !== null) return null;
  const { size } = capture;
  const light = capture.lights[look.light];
  if (view === "map") return ofMap(capture, look);
  if (view === "mask") {
    const layer = ofBytes(capture.array(light.mask), (value) => capture.palette.labels[value] ?? [0, 0, 0], (value) => LABELS[value]);
    return { ...layer, size };
  }
  if (view === "error") {
    const color = (value) => capture.palette.findings[value] ?? [0, 0, 0];
    return { ...ofBytes(capture.array(light.findings), color, (value) => FINDINGS[value], (value) => HATCHES[value]), size };
  }
  if (view === "count") return { ...ofCount(capture, capture.array(light.count)), size };
  const after = aspectOf(capture, look, view, capture.frameAt(look.step, look.draw));
  const before = aspectOf(capture, look, view, capture.frameBefore(look.step, look.draw));
  if (!after || (look.phase === "before" && !before)) return null;
  const layer = look.phase === "diff" ? difference(capture, view, before, after) : look.phase === "before" ? before : after;
  return { ...layer, size };
}
