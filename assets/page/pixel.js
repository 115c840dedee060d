// The picked pixel: its sentence, its values, its history fragment by fragment, and the ladder.

import { FINDINGS, LABELS } from "./capture.js";
import { button, byId, element, partSign, row, swatch, table } from "./elements.js";
import { count, depthText, length, lightName, signed, signedAlone } from "./numbers.js";

const SIGNS = { passed: "✓", failed: "✗", always: "always", "not-reached": "–" };

function distanceText(capture, depth) {
  const distance = capture.distance(depth);
  const without = capture.depth.scale === 0 ? "not known" : "∞";
  return distance === null ? without : length(distance, capture.depth.unit);
}

// In whose shadow the pixel is, then the number that says so as it is read beside the values there.
const card = ({ step, draw }) => ({ whose, titles, reason }) => {
  const title = titles[step].at(draw ?? -1);
  return element("section", { class: "card verdict" }, element("h3", {}, whose ?? title),
    whose === null ? null : element("p", { class: "title" }, title), element("p", {}, reason));
};

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
  const words = readers === null ? "Which pixels read it is not known." : `Pixels that read it: ${count(readers.length)}.`;
  const show = readers?.length ? button({ onclick: showReaders }, "Show them in the picture") : null;
  const title = `Texel ${texel.join(", ")} of ${capture.lights[light].faces[face].name}`;
  return element("section", { class: "card texel" }, element("h3", {}, title), element("p", {}, words), show);
}

// The texels of the shadow map that the pixel is compared with.
function comparedTable(capture, look, { compared }, showMap) {
  if (!compared) return null;
  const rows = compared.texels.map(({ at, stored, surface, is_lit: isLit }) =>
    row({}, at.join(", "), stored === null ? "no caster" : depthText(stored), depthText(surface), isLit ? "lit" : "shadow"));
  const show = button({ onclick: () => showMap(compared.face) }, `Show ${capture.lights[look.light].faces[compared.face].name}`);
  return element("section", { class: "reads" }, element("h3", {}, "Shadow map"), show, table(["texel", "stored", "surface", "so"], rows));
}

// What became of a triangle: the signs of its tests, or why it left no fragment.
function outcomeCells({ outcome, depth, stencil, operation, why, note }) {
  const sign = (test) => element("td", { class: test }, SIGNS[test]);
  if (outcome === "tested") return [sign(depth), sign(stencil), operation];
  return [element("td", { colspan: 3, class: "note", title: note }, why ?? "")];
}

function eventRow(capture, event, index, look, select) {
  const isSelected = look.selected === index;
  const pressed = { class: "link", "aria-pressed": String(isSelected), onclick: () => select(index) };
  const what = event.part === null ? event.what : button(pressed, partSign(event.part), event.what);
  return row({ class: `${event.is_idle ? "idle" : ""} ${isSelected ? "here" : ""}` }, capture.steps[event.pass].number ?? "–",
    element("td", { class: "what" }, what), event.side, ...outcomeCells(event), element("td", { class: "change" }, event.change));
}

function historyTable(capture, { rows, history }, look, select) {
  const disagreements = history.disagreements ?? [];
  const isShown = (event) => capture.steps[event.pass].number !== null || event.part === null;
  const shown = rows.map((event, index) => (isShown(event) ? eventRow(capture, event, index, look, select) : null));
  const lines = [`${rows.filter(isShown).length} events · ${history.agrees ? "as" : "not as"} the GPU stored it`, ...disagreements];
  const agrees = element("div", { class: history.agrees ? "agrees" : "differs" }, lines.map((text) => element("p", {}, text)));
  const scroll = element("div", { class: "scroll", tabindex: 0, role: "region", "aria-label": "Events" },
    table(["#", "face", "side", "depth", "stencil", "op", "change"], shown));
  return element("section", { class: "history" }, element("h3", {}, "History"), agrees, scroll);
}

function ladderList(capture, { rows, lights }, look, select) {
  const ladder = lights[look.light]?.ladder;
  if (!ladder) return null;
  const span = (kind, text) => element("span", { class: kind }, String(text).replace("-", "−"));
  const far = (distance) => span("number", distance === null ? "∞" : length(distance, capture.depth.unit));
  const item = (attributes, part, name, distance, added, running) =>
    element("li", attributes, partSign(part), name, far(distance), added, span("running", running));
  const rung = ({ event, distance, added, running }) => {
    const one = rows[event];
    const isSelected = look.selected === event;
    const step = added === 0 ? "" : added > 0 ? `▲ +${added}` : `▼ −${-added}`;
    return item({ class: `${added === 0 ? "idle" : ""} ${isSelected ? "here" : ""}` }, one.part,
      button({ class: "link", "aria-pressed": String(isSelected), onclick: () => select(event) }, `${one.what}, ${one.side}`),
      distance, span(added > 0 ? "plus" : "minus", step), added === 0 ? "" : running);
  };
  const mark = (kind, distance, running) =>
    item({ class: `mark ${kind}` }, kind, element("span", {}, kind), distance, element("span"), running);
  const surface = ladder.surface ?? Infinity;
  const rungs = (isThere) => ladder.rungs.filter(({ distance }) => ((distance ?? Infinity) < surface) === isThere).map(rung);
  const counting = ladder.rungs.filter(({ added }) => added !== 0).length;
  const begins = ladder.is_from_infinity ? "infinity towards the surface" : "the eye";
  const words = `Counted from ${begins}: ${counting} of ${ladder.rungs.length} faces count.`;
  const [atEye, atSurface, atInfinity] = ladder.is_from_infinity ? ["", ladder.count, ladder.start] : [ladder.start, "", ""];
  const items = [mark("eye", 0, atEye), ...rungs(true), mark("surface", ladder.surface, atSurface), ...rungs(false),
    mark("infinity", null, atInfinity)];
  return element("section", { class: "ladder" }, element("h3", {}, `Ladder of ${lightName(look.light)}`),
    element("p", { class: "dim" }, words), element("ol", {}, items));
}

// Fills the panel of the picked pixel.
export function showPixel(capture, look, told, readers, { goTo, select, showMap, showReaders }) {
  capture.size.forEach((most, axis) => {
    const field = byId("xy"[axis]);
    [field.max, field.value] = [most - 1, look.pixel?.[axis] ?? ""];
  });
  const waits = capture.problem ? `Nothing is known of pixels here (${capture.problem}).` : "Unpacking the frame…";
  const all = count(capture.size[0] * capture.size[1]);
  const hint = look.pixel ? waits : `Click a pixel of the picture, or give its column and row: it has ${all}.`;
  const parts = told === null ? [element("p", { class: "dim" }, hint)] : [
    ...told.lights.map(card(look)), valuesNow(capture, look), overSteps(capture, look, goTo),
    comparedTable(capture, look, told.lights[look.light] ?? {}, showMap), historyTable(capture, told, look, select),
    ladderList(capture, told, look, select),
  ];
  byId("told").replaceChildren(...[texelCard(capture, look, readers, showReaders), ...parts].filter((part) => part !== null));
}
