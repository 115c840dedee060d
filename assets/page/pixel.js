// The picked pixel: its sentence, its values, its history fragment by fragment, and the ladder.

import { FINDINGS, LABELS } from "./capture.js";
import { button, byId, element, partSign, row, swatch, table } from "./elements.js";
import { doesSomething, showsOutside } from "./history.js";
import { ladderOf } from "./ladder.js";
import { count, countInFloat, depthText, digits, length, lightName, signed, signedAlone } from "./numbers.js";
import { texelsRead, verdictOf } from "./verdict.js";

const SIGNS = { passed: "✓", failed: "✗", always: "always", "not-reached": "–" };
const SHORT = {
  keep: "keep", zero: "zero", replace: "set", invert: "invert", "increment-clamp": "+1", "increment-wrap": "+1",
  "decrement-clamp": "−1", "decrement-wrap": "−1",
};
const CLEARS = { put: "other content", "clear-depth": "clear depth", "clear-stencil": "clear stencil", "clear-count": "clear count" };
const BEYOND = { near: "nearer than the near plane", far: "beyond the far plane" };
const side = (one) => (showsOutside(one) ? "front" : "back");

function distanceText(capture, depth) {
  const distance = capture.distance(depth);
  return distance === null ? "∞" : length(distance, capture.depth.unit);
}

const card = ({ title, reason }) => element("section", { class: "card verdict" }, element("h3", {}, title), element("p", {}, reason));

// The pixel's values where one stands.
function valuesNow(capture, look) {
  const at = capture.index(look.pixel);
  const frame = capture.frameAt(look.step, look.draw);
  if (!frame) return null;
  const [depth, stencil] = [capture.array(frame.depth)[at], capture.array(frame.stencil)];
  const facts = [["depth", depthText(depth)], ["distance", distanceText(capture, depth)]];
  if (stencil) facts.push(["stencil", `${signed(stencil[at])} · ${stencil[at].toString(2).padStart(8, "0")}`]);
  for (const { name, mask, findings } of capture.lights) {
    const finding = capture.array(findings)?.[at];
    if (mask !== null) facts.push([name, LABELS[capture.array(mask)[at]] + (finding === undefined ? "" : ` · ${FINDINGS[finding]}`)]);
  }
  const pair = ([name, value]) => element("div", {}, element("dt", {}, name), element("dd", {}, value));
  return element("dl", { class: "facts" }, facts.map(pair));
}

// And after every step.
function overSteps(capture, look, goTo) {
  const at = capture.index(look.pixel);
  const rows = capture.steps.map(({ after, name, number }, index) => {
    if (after.kind !== "frame") return null;
    const [color, stencil] = [capture.array(after.color), capture.array(after.stencil)];
    const rgb = [...color.subarray(at * 4, at * 4 + 3)];
    const link = button({ class: "link", onclick: () => goTo(index, null) }, `${number ?? "–"} ${name}`);
    return row({ class: index === look.step ? "here" : null }, element("th", { scope: "row" }, link),
      stencil ? [swatch(capture.palette.stencil[stencil[at]]), signedAlone(stencil[at])] : "–",
      [swatch(rgb), rgb.join(" ")], distanceText(capture, capture.array(after.depth)[at]));
  });
  return element("section", { class: "values" }, table(["step", "stencil", "colour", "distance"], rows, "Over the steps"));
}

// The picked texel of the shadow map, and how many pixels read it.
function texelCard(capture, { light, face, texel }, readers, showReaders) {
  if (!texel) return null;
  const told = readers === null ? "Which pixels read it is not known." : `Pixels that read it: ${count(readers.length)}.`;
  const show = readers?.length ? button({ onclick: showReaders }, "Show them in the picture") : null;
  const title = `Texel ${texel.join(", ")} of ${capture.lights[light].faces[face].name}`;
  return element("section", { class: "card texel" }, element("h3", {}, title), element("p", {}, told), show);
}

// The texels of the shadow map that the pixel reads.
function readTable(capture, look, showMap) {
  const read = texelsRead(capture, look.light, look.pixel);
  if (!read) return null;
  const rows = read.texels.map(({ x, y, own, stored, isCaster, isLit }) =>
    row({}, `${x}, ${y}`, isCaster ? depthText(stored) : "no caster", depthText(Math.fround(own)), isLit ? "lit" : "shadow"));
  const show = button({ onclick: () => showMap(read.face) }, `Show ${capture.lights[look.light].faces[read.face].name}`);
  return element("section", { class: "reads" }, element("h3", {}, "Shadow map"), show, table(["texel", "stored", "surface", "so"], rows));
}

function changeText(capture, history, { kind, before, after }) {
  if (kind === "clear-depth") return `→ ${digits(after.depth)}`;
  if (kind === "clear-stencil" || kind === "put") return `→ ${signedAlone(after.stencil)}`;
  if (kind === "clear-count") return `→ ${countInFloat(after.count)}`;
  if (before.stencil !== after.stencil) return `${signedAlone(before.stencil)} → ${signedAlone(after.stencil)}`;
  if (before.count !== after.count) return `${countInFloat(before.count)} → ${countInFloat(after.count)}`;
  if (before.depth !== after.depth) return `→ ${distanceText(capture, after.depth)}`;
  return history.hasStencil ? signedAlone(before.stencil) : "";
}

// The part of a face and its object: `dark cap` of `torus 2`.
function named({ part, caster, drawName }) {
  if (part === "surface") return drawName;
  if (part === "receiver") return `receiver ${drawName}`;
  if (caster === null) return drawName;
  return `${part === "planar-shadow" ? "flattened" : part.replace("-", " ")} of ${caster}`;
}

// What became of a triangle: the signs of its tests, or why it left no fragment.
function outcome(one) {
  const sign = (test) => element("td", { class: test }, SIGNS[test]);
  if (one?.kind === "tested") return [sign(one.depthTest), sign(one.operation ? one.stencilTest : "always"), SHORT[one.operation] ?? ""];
  const title = one && (one.kind === "culled" ? "the draw shows only the other side of triangles" : BEYOND[one.clip]);
  return [element("td", { colspan: 3, class: "note", title }, one ? `${one.kind}${one.clip ? ` at ${one.clip}` : ""}` : "")];
}

function eventRow(capture, history, index, look, select) {
  const event = history.events[index];
  const one = event.triangle;
  const isSelected = look.selected === index;
  const pressed = { class: "link", "aria-pressed": String(isSelected), onclick: () => select(index) };
  const link = one && button(pressed, partSign(one.part), named(one));
  return row({ class: `${doesSomething(event) ? "" : "idle"} ${isSelected ? "here" : ""}` }, capture.steps[event.pass].number ?? "–",
    element("td", { class: "what" }, link ?? CLEARS[event.kind]), one ? side(one) : "", ...outcome(one),
    element("td", { class: "change" }, changeText(capture, history, event)));
}

function historyTable(capture, history, look, select) {
  const { events, disagreements } = history;
  const isShown = (event) => capture.steps[event.pass].number !== null || event.kind !== "triangle";
  const rows = events.map((event, index) => (isShown(event) ? eventRow(capture, history, index, look, select) : null));
  const lines = [`${events.length} events · ${disagreements.length === 0 ? "as" : "not as"} the GPU stored it`, ...disagreements];
  const agrees = element("div", { class: disagreements.length === 0 ? "agrees" : "differs" }, lines.map((text) => element("p", {}, text)));
  const scroll = element("div", { class: "scroll", tabindex: 0, role: "region", "aria-label": "Events" },
    table(["#", "face", "side", "depth", "stencil", "op", "change"], rows));
  return element("section", { class: "history" }, element("h3", {}, "History"), agrees, scroll);
}

function ladderList(capture, history, look, select) {
  const ladder = ladderOf(capture, history, look.light);
  if (!ladder) return null;
  const isBehind = ladder.side === "behind";
  const span = (kind, text) => element("span", { class: kind }, String(text).replace("-", "−"));
  const far = (distance) => span("number", Number.isFinite(distance) ? length(distance, capture.depth.unit) : "∞");
  const item = (attributes, part, name, distance, added, running) =>
    element("li", attributes, partSign(part), name, far(distance), added, span("running", running));
  const rung = ({ event, distance, added, running }) => {
    const one = history.events[event].triangle;
    const isSelected = look.selected === event;
    const step = added === 0 ? "" : added > 0 ? `▲ +${added}` : `▼ −${-added}`;
    return item({ class: `${added === 0 ? "idle" : ""} ${isSelected ? "here" : ""}` }, one.part,
      button({ class: "link", "aria-pressed": String(isSelected), onclick: () => select(event) }, `${named(one)}, ${side(one)}`),
      distance, span(added > 0 ? "plus" : "minus", step), added === 0 ? "" : running);
  };
  const mark = (kind, distance, running) =>
    item({ class: `mark ${kind}` }, kind, element("span", {}, kind), distance, element("span"), running);
  const surface = ladder.surface ?? Infinity;
  const rungs = (isThere) => ladder.rungs.filter(({ distance }) => (distance < surface) === isThere).map(rung);
  const counting = ladder.rungs.filter(({ added }) => added !== 0).length;
  const words = `Counted from ${isBehind ? "infinity towards the surface" : "the eye"}: ${counting} of ${ladder.rungs.length} faces count.`;
  const items = [mark("eye", 0, isBehind ? "" : ladder.start), ...rungs(true), mark("surface", surface, isBehind ? ladder.count : ""),
    ...rungs(false), mark("infinity", Infinity, isBehind ? ladder.start : "")];
  return element("section", { class: "ladder" }, element("h3", {}, `Ladder of ${lightName(look.light)}`),
    element("p", { class: "dim" }, words), element("ol", {}, items));
}

// Fills the panel of the picked pixel.
export function showPixel(capture, look, history, readers, { goTo, select, showMap, showReaders }) {
  capture.size.forEach((most, axis) => {
    const field = byId("xy"[axis]);
    [field.max, field.value] = [most - 1, look.pixel?.[axis] ?? ""];
  });
  const hint = look.pixel ? "Unpacking the frame…"
    : `Click a pixel of the picture, or give its column and row: it has ${count(capture.size[0] * capture.size[1])}.`;
  const parts = history === null ? [element("p", { class: "dim" }, hint)] : [
    ...capture.lights.map((_, light) => card(verdictOf(capture, history, light))), valuesNow(capture, look), overSteps(capture, look, goTo),
    readTable(capture, look, showMap), historyTable(capture, history, look, select), ladderList(capture, history, look, select),
  ];
  byId("told").replaceChildren(...[texelCard(capture, look, readers, showReaders), ...parts].filter((part) => part !== null));
}
