// The page: reads the document, answers to hand and keyboard, and shows what is looked at.

import { Capture } from "./capture.js";
import { byId, choose, element, select, swatch } from "./elements.js";
import { historyOf } from "./history.js";
import { PHASES, VIEWS, look, readAddress, writeAddress } from "./looking.js";
import { capitalized, count } from "./numbers.js";
import { layerOf, missing, viewOf } from "./palette.js";
import { listSteps, paintThumbnails, showPlace } from "./passes.js";
import { magnify, mark, paint } from "./picture.js";
import { showPixel } from "./pixel.js";
import { whyOf, whyText } from "./why.js";

const VIEW_NAMES = { color: "Colour", map: "Map" };
const capture = new Capture(JSON.parse(byId("document").textContent));
let isWhole = false;
let layer = null;
let known = { pixel: null, history: null };

// The history of the picked pixel; null while the frame is being unpacked.
function pickedHistory() {
  if (!look.pixel || !isWhole) return null;
  if (String(known.pixel) !== String(look.pixel)) known = { pixel: look.pixel, history: historyOf(capture, look.pixel) };
  return known.history;
}

function showLegend() {
  const hatches = ["", "╱", "╲", "╳", "·"];
  const row = ({ color, name, count: pixels, hatch }) => element("span", { class: "entry" }, swatch(color), element("span", {}, `${hatches[hatch]} ${name}`),
    pixels === null ? null : element("span", { class: "number" }, count(pixels)));
  byId("legend").replaceChildren(...(layer ? layer.legend().slice(0, 24).map(row) : []));
}

function showBar(view) {
  const option = (id) => ({ id, name: VIEW_NAMES[id] ?? capitalized(id), why: missing(capture, look, id), isThere: missing(capture, look, id) === null });
  const shown = VIEWS.filter((id) => id !== "count" || capture.lights.some((light) => light.count !== null));
  choose(byId("views"), shown.map(option), look.view, (id) => go({ view: id }));
  const hasPhases = ["color", "stencil", "depth"].includes(view);
  const hasBefore = capture.frameBefore(look.step, look.draw) !== null;
  const phases = PHASES.map((id) => ({ id, name: capitalized(id), isThere: hasPhases && (hasBefore || id !== "before"), why: hasPhases ? "Nothing was before the first step." : "It does not change from step to step." }));
  choose(byId("phases"), phases, hasPhases ? look.phase : null, (id) => go({ phase: id }));
  select("bits", view === "stencil" ? ["all", ...Array.from({ length: 8 }, (_, bit) => `bit ${bit}`)] : [], look.bit === null ? 0 : look.bit + 1);
  select("light", capture.lights.map((light) => light.name), look.light);
  select("face", view === "map" ? capture.lights[look.light].faces.map((face) => face.name) : [], look.face);
  for (const [end, id] of ["near", "far"].entries()) {
    byId(`${id}-of`).hidden = view !== "depth";
    if (view === "depth" && layer) byId(id).value = Number(layer.range[end].toPrecision(5));
  }
}

function hoverText(place) {
  if (!layer || !place) return "Point at a pixel for its value; click it for its history.";
  return `${place.join(", ")} · ${layer.text(place[1] * layer.size[0] + place[0])}`;
}

function showHover() {
  const view = viewOf(capture, look);
  const place = look.hover ?? (view === "map" ? null : look.pixel);
  byId("hover").textContent = hoverText(place);
  magnify(layer, place);
}

function show() {
  const view = viewOf(capture, look);
  layer = layerOf(capture, look);
  if (layer) paint(byId("picture"), layer);
  const why = missing(capture, look, view) ?? "Nothing was before the first step.";
  const { name } = capture.steps[look.step];
  byId("picture").setAttribute("aria-label", layer ? `${VIEW_NAMES[view] ?? capitalized(view)} ${look.phase} ${name}` : why);
  byId("frame").classList.toggle("empty", !layer);
  if (layer) byId("frame").style.setProperty("--ratio", layer.size[0] / layer.size[1]);
  const history = pickedHistory();
  showBar(view);
  showLegend();
  showPlace(capture, look);
  showPixel(capture, look, history, { goTo: (step, draw) => go({ step, draw }), select: selectEvent, showMap: (face) => go({ view: "map", face }) });
  mark(capture, look, view, look.selected === null ? null : history?.events[look.selected]);
  showHover();
  writeAddress();
}

// Looks at something else.
function go(changes) {
  if (changes.step !== undefined && changes.step !== look.step) changes.draw ??= null;
  if (changes.pixel !== undefined) changes.selected = null;
  Object.assign(look, changes);
  const { after, light } = capture.steps[look.step];
  if (changes.step !== undefined && light !== null) look.light = light;
  if (changes.step !== undefined && after.kind === "map") look.face = after.face;
  look.face = Math.min(look.face, Math.max(0, (capture.lights[look.light]?.faces.length ?? 1) - 1));
  show();
}

function selectEvent(index) {
  go({ selected: look.selected === index ? null : index });
}

function goStep(by) {
  const step = look.step + by;
  if (step >= 0 && step < capture.steps.length) go({ step, draw: null });
}

function goDraw(by) {
  if (!capture.hasDraws(look.step)) return;
  const last = capture.steps[look.step].draws.length - 1;
  const draw = look.draw === null ? (by < 0 ? last : null) : look.draw + by;
  if (look.draw === null && by > 0) go({ draw: 0 });
  else if (draw !== null && draw >= 0) go({ draw: draw > last ? null : draw });
}

function movePick([right, down]) {
  const from = look.pixel ?? capture.size.map((side) => Math.floor(side / 2));
  const within = (value, side) => Math.min(Math.max(value, 0), side - 1);
  go({ pixel: look.pixel ? [within(from[0] + right, capture.size[0]), within(from[1] + down, capture.size[1])] : from, hover: null });
}

const ARROWS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };

function onKey(event) {
  const isTyping = event.target.matches("select, input:not([type=range]), textarea");
  if (isTyping || event.ctrlKey || event.altKey || event.metaKey) return;
  const arrow = ARROWS[event.key];
  const views = byId("views").children;
  if (arrow && event.shiftKey) movePick(arrow);
  else if (arrow && arrow[0]) goStep(arrow[0]);
  else if (arrow) goDraw(arrow[1]);
  else if (event.key === "Escape") go({ pixel: null });
  else if (/^[1-9]$/.test(event.key) && views[event.key - 1]) views[event.key - 1].click();
  else if (/^[bad]$/i.test(event.key)) byId("phases").children["bad".indexOf(event.key.toLowerCase())].click();
  else return;
  event.preventDefault();
}

// The texel under a pointer.
function placeOf(event) {
  if (!layer) return null;
  const box = byId("picture").getBoundingClientRect();
  const share = [(event.clientX - box.left) / box.width, (event.clientY - box.top) / box.height];
  return share.map((part, axis) => Math.min(Math.max(Math.floor(part * layer.size[axis]), 0), layer.size[axis] - 1));
}

function listen() {
  document.addEventListener("keydown", onKey);
  const picture = byId("picture");
  picture.addEventListener("pointermove", (event) => {
    look.hover = placeOf(event);
    showHover();
  });
  picture.addEventListener("pointerleave", () => {
    look.hover = null;
    showHover();
  });
  picture.addEventListener("click", (event) => {
    if (viewOf(capture, look) !== "map") go({ pixel: placeOf(event) });
  });
  const onClick = { previous: () => goStep(-1), next: () => goStep(1), up: () => goDraw(-1), down: () => goDraw(1) };
  for (const [id, act] of Object.entries(onClick)) byId(id).addEventListener("click", act);
  byId("slider").addEventListener("input", (event) => go({ step: Number(event.target.value) }));
  byId("bits").addEventListener("change", (event) => go({ bit: event.target.selectedIndex === 0 ? null : event.target.selectedIndex - 1 }));
  byId("light").addEventListener("change", (event) => go({ light: event.target.selectedIndex }));
  byId("face").addEventListener("change", (event) => go({ face: event.target.selectedIndex }));
  for (const id of ["near", "far"]) {
    byId(id).addEventListener("change", () => go({ range: ["near", "far"].map((end) => byId(end).valueAsNumber).every(Number.isFinite) ? [byId("near").valueAsNumber, byId("far").valueAsNumber] : null }));
  }
  byId("pick").addEventListener("change", () => {
    const pixel = [byId("x"), byId("y")].map((field, axis) => Math.min(Math.max(field.valueAsNumber, 0), capture.size[axis] - 1));
    if (pixel.every(Number.isInteger)) go({ pixel });
  });
  byId("pick").addEventListener("submit", (event) => event.preventDefault());
  byId("help").addEventListener("click", () => {
    byId("keys").hidden = !byId("keys").hidden;
    byId("help").setAttribute("aria-expanded", String(!byId("keys").hidden));
  });
  byId("theme").addEventListener("click", () => {
    const { dataset } = document.documentElement;
    const isDark = dataset.theme ? dataset.theme === "dark" : matchMedia("(prefers-color-scheme: dark)").matches;
    dataset.theme = isDark ? "light" : "dark";
  });
  window.addEventListener("hashchange", () => {
    readAddress(capture);
    show();
  });
}

// The first step is shown as soon as its arrays are there; the others follow.
async function start() {
  const [width, height] = capture.size;
  byId("title").textContent = `${capture.scene}, ${capture.technique}`;
  byId("made-by").textContent = `${width}×${height} · ${capture.adapter.name} · ${capture.program}`;
  readAddress(capture);
  const light = capture.lights[look.light];
  const faces = capture.lights.flatMap((one) => one.faces.map((face) => face.image));
  const frames = [capture.frameAt(look.step, look.draw), capture.frameBefore(look.step, look.draw)];
  const shown = frames.flatMap((frame) => (frame ? [frame.color, frame.depth, frame.stencil] : []));
  const isMap = viewOf(capture, look) === "map";
  await capture.provide([...shown, light?.mask, light?.count, light?.findings, ...(isMap ? faces : [])]);
  listSteps(capture, (step, draw) => go({ step, draw }));
  show();
  performance.mark("shown");
  await capture.provideAll();
  isWhole = true;
  paintThumbnails(capture);
  listen();
  show();
  performance.mark("whole");
}

// For scripts and the console.
window.stencilscope = { capture, historyOf, whyOf, whyText };

start();
