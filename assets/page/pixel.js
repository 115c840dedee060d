// The picked pixel: its sentence, its values, its history fragment by fragment, and the ladder.

import { FINDINGS, LABELS } from "./capture.js";
import { byId, element, swatch } from "./elements.js";
import { doesSomething, showsOutside } from "./history.js";
import { ladderOf } from "./ladder.js";
import { capitalized, count, countInFloat, depthText, digits, length, lightName, signed, signedAlone } from "./numbers.js";
import { texelsRead, verdictOf } from "./verdict.js";
import { countText } from "./why.js";

const SIGNS = { passed: "✓", failed: "✗", always: "always", "not-reached": "–" };
const SHORT = {
  keep: "keep", zero: "zero", replace: "set", invert: "invert", "increment-clamp": "+1", "increment-wrap": "+1",
  "decrement-clamp": "−1", "decrement-wrap": "−1",
};
const CLEARS = { put: "other content", "clear-depth": "clear depth", "clear-stencil": "clear stencil", "clear-count": "clear count" };

const BEYOND = { near: "it is nearer than the near plane", far: "it is beyond the far plane" };
const NOTES = {
  culled: () => "the draw shows only the other side of triangles", clipped: (clip) => BEYOND[clip],
  discarded: (clip) => `the shader discards it: ${BEYOND[clip]}`,
};

const distanceText = (capture, depth) => {
  const distance = capture.distance(depth);
  return distance === null ? "∞" : length(distance, capture.unit);
};

const card = (verdict) => element("section", { class: "card verdict" }, element("h3", {}, verdict.title), element("p", {}, verdict.reason));

// The pixel's values after every step.
function overSteps(capture, look, goTo) {
  const at = capture.index(look.pixel);
  const rows = capture.steps.map((step, index) => {
    const frame = capture.frameAt(index);
    if (step.after.kind !== "frame") return null;
    const [color, stencil] = [capture.array(frame.color), capture.array(frame.stencil)];
    const rgb = [0, 1, 2].map((lane) => color[at * 4 + lane]);
    const name = `${step.number ?? "–"} ${step.name}`;
    return element("tr", { class: index === look.step ? "here" : "" },
      element("th", { scope: "row" }, element("button", { type: "button", class: "link", onclick: () => goTo(index, null) }, name)),
      element("td", {}, stencil ? [swatch(capture.palette.stencil[stencil[at]]), signedAlone(stencil[at])] : "–"),
      element("td", {}, swatch(rgb), rgb.join(" ")),
      element("td", {}, distanceText(capture, capture.array(frame.depth)[at])));
  });
  const head = ["step", "stencil", "colour", "distance"].map((name) => element("th", { scope: "col" }, name));
  return element("table", { class: "values" }, element("caption", {}, "Over the steps"), element("thead", {}, element("tr", {}, head)), element("tbody", {}, rows));
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
  const what = part === "planar-shadow" ? "flattened" : part.replace("-", " ");
  return caster === null ? drawName : `${what} of ${caster}`;
}

function eventRow(capture, history, event, look, select) {
  const one = event.triangle;
  const index = history.events.indexOf(event);
  const step = capture.steps[event.pass];
  const isTested = one?.kind === "tested";
  const sign = (test) => element("td", { class: test }, SIGNS[test]);
  const face = one ? element("button", { type: "button", class: "link", "aria-pressed": String(look.selected === index), onclick: () => select(index) },
    element("span", { class: `part ${one.part}`, "aria-hidden": "true" }), named(one)) : CLEARS[event.kind];
  const cells = isTested ? [sign(one.depthTest), sign(one.operation ? one.stencilTest : "always"), element("td", {}, one.operation ? SHORT[one.operation] : "")]
    : [element("td", { colspan: 3, class: "note", title: NOTES[one?.kind]?.(one.clip) }, one ? `${one.kind}${one.clip ? ` at ${one.clip}` : ""}` : "")];
  return element("tr", { class: `${doesSomething(event) ? "" : "idle"} ${look.selected === index ? "here" : ""}` },
    element("td", {}, step.number ?? "–"), element("td", { class: "what" }, face), element("td", {}, one ? (showsOutside(one) ? "front" : "back") : ""),
    cells, element("td", { class: "change" }, changeText(capture, history, event)));
}

// "as the GPU stored it", or where it differs.
function agreement(history) {
  if (history.disagreements.length === 0) return element("p", { class: "agrees" }, `${history.events.length} events · as the GPU stored it`);
  return element("div", { class: "differs", role: "note" }, element("p", {}, `${history.events.length} events · not as the GPU stored it:`),
    element("ul", {}, history.disagreements.map((text) => element("li", {}, text))));
}

function historyTable(capture, history, look, select) {
  const head = ["#", "face", "side", "depth", "stencil", "op", "change"].map((name) => element("th", { scope: "col" }, name));
  const shown = history.events.filter((event) => capture.plan.passes[event.pass].timed || event.kind !== "triangle");
  const rows = shown.map((event) => eventRow(capture, history, event, look, select));
  return element("section", { class: "history" }, element("h3", {}, "History"), agreement(history),
    element("div", { class: "scroll", tabindex: 0, role: "region", "aria-label": "History" },
      element("table", {}, element("thead", {}, element("tr", {}, head)), element("tbody", {}, rows))));
}

function rungRow(capture, history, rung, look, select) {
  const one = history.events[rung.event].triangle;
  const added = rung.added === 0 ? "" : rung.added > 0 ? `▲ +${rung.added}` : `▼ −${-rung.added}`;
  return element("li", { class: `${rung.added === 0 ? "idle" : ""} ${look.selected === rung.event ? "here" : ""}` },
    element("span", { class: `part ${one.part}`, "aria-hidden": "true" }),
    element("button", { type: "button", class: "link", "aria-pressed": String(look.selected === rung.event), onclick: () => select(rung.event) }, `${named(one)}, ${showsOutside(one) ? "front" : "back"}`),
    element("span", { class: "number" }, Number.isFinite(rung.distance) ? length(rung.distance, capture.unit) : "∞"),
    element("span", { class: rung.added > 0 ? "plus" : "minus" }, added), element("span", { class: "running" }, rung.added === 0 ? "" : rung.running));
}

function ladderList(capture, history, look, select) {
  const ladder = ladderOf(capture, history, look.light);
  if (!ladder) return null;
  const mark = (kind, name, distance, running) => element("li", { class: kind }, element("span", { class: "part", "aria-hidden": "true" }), element("span", {}, name),
    element("span", { class: "number" }, distance), element("span"), element("span", { class: "running" }, running));
  const rows = ladder.rungs.map((rung) => ({ distance: rung.distance, row: rungRow(capture, history, rung, look, select) }));
  const isBehind = ladder.side === "behind";
  const surface = ladder.surface ?? Infinity;
  const at = mark("surface", "surface", Number.isFinite(surface) ? length(surface, capture.unit) : "∞", isBehind ? countText(ladder.tested) : "");
  const before = rows.filter(({ distance }) => distance < surface).map(({ row }) => row);
  const behind = rows.filter(({ distance }) => distance >= surface).map(({ row }) => row);
  const counting = ladder.rungs.filter(({ added }) => added !== 0).length;
  const way = isBehind ? "from infinity towards the surface" : "from the eye";
  return element("section", { class: "ladder" }, element("h3", {}, `Ladder of ${lightName(look.light)}`),
    element("p", { class: "dim" }, `Counted ${way}: ${counting} of ${ladder.rungs.length} faces count, ${countText(ladder.tested)} in all.`),
    element("ol", {}, mark("end", "eye", "0", isBehind ? "" : ladder.start), before, at, behind, mark("end", "infinity", "∞", isBehind ? ladder.start : "")));
}

// The texels of the shadow map that the pixel reads.
function readTable(capture, look, showMap) {
  const read = texelsRead(capture, look.light, look.pixel);
  if (!read) return null;
  const rows = read.texels.map(({ x, y, stored, isCaster, isLit }) => element("tr", {}, element("td", {}, `${x}, ${y}`),
    element("td", {}, isCaster ? depthText(stored) : "no caster"), element("td", {}, depthText(read.own)), element("td", {}, read.byPlane ? "" : isLit ? "lit" : "shadow")));
  const head = ["texel", "stored", "surface", ""].map((name) => element("th", { scope: "col" }, name));
  return element("section", { class: "reads" }, element("h3", {}, "Shadow map"),
    element("button", { type: "button", onclick: () => showMap(read.face) }, `Show ${capture.lights[look.light].faces[read.face].name}`),
    element("table", {}, element("thead", {}, element("tr", {}, head)), element("tbody", {}, rows)));
}

function valuesNow(capture, look) {
  const at = capture.index(look.pixel);
  const frame = capture.frameAt(look.step, look.draw);
  if (!frame) return null;
  const depth = capture.array(frame.depth)[at];
  const stencil = capture.array(frame.stencil);
  const facts = [["depth", depthText(depth)], ["distance", distanceText(capture, depth)]];
  if (stencil) facts.push(["stencil", `${signed(stencil[at])} · ${stencil[at].toString(2).padStart(8, "0")}`]);
  capture.lights.forEach((light, index) => {
    const [mask, findings] = [capture.array(light.mask), capture.array(light.findings)];
    if (mask) facts.push([lightName(index), `${LABELS[mask[at]]}${findings ? ` · ${FINDINGS[findings[at]]}` : ""}`]);
  });
  return element("dl", { class: "facts" }, facts.map(([name, value]) => element("div", {}, element("dt", {}, name), element("dd", {}, value))));
}

// Fills the panel of the picked pixel.
export function showPixel(capture, look, history, { goTo, select, showMap }) {
  [byId("x").max, byId("y").max] = capture.size.map((side) => side - 1);
  [byId("x").value, byId("y").value] = look.pixel ?? ["", ""];
  if (!look.pixel || !history) {
    const [width, height] = capture.size;
    byId("told").replaceChildren(element("p", { class: "dim" }, look.pixel ? "Unpacking the frame…" : `Click a pixel of the picture, or give its column and row: it has ${count(width * height)}.`));
    return;
  }
  const verdicts = capture.lights.map((_, light) => card(verdictOf(capture, history, light)));
  byId("told").replaceChildren(...verdicts, ...[valuesNow(capture, look), overSteps(capture, look, goTo), readTable(capture, look, showMap),
    historyTable(capture, history, look, select), ladderList(capture, history, look, select)].filter((part) => part !== null));
  byId("told").setAttribute("aria-label", capitalized(`pixel ${look.pixel.join(", ")}`));
}
