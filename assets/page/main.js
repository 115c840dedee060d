// The page: reads the document, answers to hand and keyboard, and shows what is looked at.

import { Capture } from "./capture.js";
import { byId, choose, element, select, swatch } from "./elements.js";
import { PHASES, VIEWS, liveAddress, look, readAddress, writeAddress } from "./looking.js";
import { capitalized, count } from "./numbers.js";
import { layerOf, missing, viewOf } from "./palette.js";
import { listSteps, paintThumbnails, showPlace } from "./passes.js";
import { magnify, mark, paint } from "./picture.js";
import { showPixel } from "./pixel.js";

const capture = new Capture(JSON.parse(byId("document").textContent));
let layer = null;
let known = { pixel: null, told: null };

const within = (value, most) => Math.min(Math.max(value, 0), most);
const nameOf = (view) => (view === "color" ? "Colour" : capitalized(view));
// What is picked where one stands: a texel of a shown map, or a pixel.
const picked = () => (layer && viewOf(capture, look) === "map" ? "texel" : "pixel");

// What is known of the picked pixel; null while the frame is being unpacked.
function askedPixel() {
  if (!look.pixel || !capture.reader) return null;
  if (String(known.pixel) !== String(look.pixel)) known = { pixel: look.pixel, told: capture.ask({ pixel: look.pixel }) };
  return known.told;
}

function showLegend() {
  const entry = ({ color, name, count: pixels, hatch }) => element("span", { class: "entry" }, swatch(color),
    ["", "╱ ", "╲ ", "╳ ", "· "][hatch] + name, pixels === null ? null : element("span", { class: "number" }, count(pixels)));
  byId("legend").replaceChildren(...(layer ? layer.legend().slice(0, 24).map(entry) : []));
}

function showBar(view) {
  const shown = VIEWS.filter((id) => id !== "count" || capture.lights.some((light) => light.count !== null));
  const option = (id) => ({ id, name: nameOf(id), why: missing(capture, look, id) });
  choose(byId("views"), shown.map(option), look.view, (id) => go({ view: id }));
  const isSame = ["color", "stencil", "depth"].includes(view) ? null : "It does not change from step to step.";
  const isFirst = capture.frameBefore(look.step, look.draw) === null ? "Nothing was before the first step." : null;
  const phase = (id) => ({ id, name: capitalized(id), why: isSame ?? (id === "before" ? isFirst : null) });
  choose(byId("phases"), PHASES.map(phase), isSame ? null : look.phase, (id) => go({ phase: id }));
  const bits = Array.from({ length: 8 }, (_, bit) => `bit ${bit}`);
  select("bits", view === "stencil" ? ["all", ...bits] : [], look.bit === null ? 0 : look.bit + 1);
  select("light", capture.lights.map((light) => light.name), look.light);
  select("face", view === "map" ? capture.lights[look.light].faces.map((face) => face.name) : [], look.face);
  ["near", "far"].forEach((id, end) => {
    byId(`${id}-of`).hidden = view !== "depth";
    if (view === "depth" && layer) byId(id).value = Number(layer.range[end].toPrecision(5));
  });
}

function showHover(hover = look.hover) {
  look.hover = hover;
  const place = look.hover ?? look[picked()];
  const hint = layer ? "Point at a pixel for its value; click it for its history." : byId("picture").getAttribute("aria-label");
  byId("hover").textContent = layer && place ? `${place.join(", ")} · ${layer.text(place[1] * layer.size[0] + place[0])}` : hint;
  magnify(layer, place);
}

function show() {
  const view = viewOf(capture, look);
  layer = layerOf(capture, look);
  if (layer) paint(byId("picture"), layer);
  if (layer) byId("frame").style.setProperty("--ratio", layer.size[0] / layer.size[1]);
  byId("frame").classList.toggle("empty", !layer);
  const why = missing(capture, look, view) ?? "Nothing was before the first step.";
  byId("picture").setAttribute("aria-label", layer ? `${nameOf(view)}, ${look.phase} ${capture.steps[look.step].name}` : why);
  const told = askedPixel();
  const readers = look.texel && capture.ask({ readers: { light: look.light, face: look.face, at: look.texel } });
  showBar(view);
  showLegend();
  showPlace(capture, look);
  showPixel(capture, look, told, readers, {
    goTo: (step, draw) => go({ step, draw }), showMap: (face) => go({ view: "map", face }),
    showReaders: () => go({ view: "color", hover: null }), select: (event) => go({ selected: look.selected === event ? null : event }),
  });
  mark(capture, look, view, told, readers);
  showHover();
  writeAddress();
  if (capture.live) byId("live").href = liveAddress(capture);
}

// Looks at something else.
function go(changes) {
  const { after, light } = capture.steps[changes.step ?? look.step];
  const ofStep = changes.step === undefined ? {} : { draw: null, light: light ?? look.light, face: after.face ?? look.face };
  const was = String([look.light, look.face]);
  Object.assign(look, ofStep, changes, changes.pixel === undefined ? {} : { selected: null });
  look.face = within(look.face, Math.max(0, (capture.lights[look.light]?.faces.length ?? 1) - 1));
  if (String([look.light, look.face]) !== was) look.texel = null;
  show();
}

const goStep = (by) => capture.steps[look.step + by] && go({ step: look.step + by });

// Through the draws of a step: after the last one comes the step itself.
function goDraw(by) {
  if (!capture.hasDraws(look.step)) return;
  const { length } = capture.steps[look.step].draws;
  const next = look.draw === null && by > 0 ? 0 : (look.draw ?? length) + by;
  if (next >= 0) go({ draw: next >= length ? null : next });
}

function movePick(by) {
  const { size } = layer ?? capture;
  const moved = look[picked()]?.map((value, axis) => within(value + by[axis], size[axis] - 1));
  go({ hover: null, [picked()]: moved ?? size.map((side) => Math.floor(side / 2)) });
}

const ARROWS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };

function onKey(event) {
  const isTyping = event.target.matches("select, input:not([type=range])");
  if (isTyping || event.ctrlKey || event.altKey || event.metaKey) return;
  const arrow = ARROWS[event.key];
  const view = /^[1-9]$/.test(event.key) ? byId("views").children[event.key - 1] : null;
  const phase = /^[bad]$/i.test(event.key) ? byId("phases").children["bad".indexOf(event.key.toLowerCase())] : null;
  if (arrow && event.shiftKey) movePick(arrow);
  else if (arrow) (arrow[0] ? goStep : goDraw)(arrow[0] || arrow[1]);
  else if (event.key === "Escape") go({ pixel: null, texel: null });
  else if (view || phase) (view ?? phase).click();
  else return;
  event.preventDefault();
}

// The texel under a pointer.
function placeOf(event) {
  const box = byId("picture").getBoundingClientRect();
  const shares = [(event.clientX - box.left) / box.width, (event.clientY - box.top) / box.height];
  return layer && shares.map((share, axis) => within(Math.floor(share * layer.size[axis]), layer.size[axis] - 1));
}

function pickTyped() {
  const pixel = ["x", "y"].map((id, axis) => within(byId(id).valueAsNumber, capture.size[axis] - 1));
  if (pixel.every(Number.isInteger)) go({ pixel });
}

function turnTheme() {
  const { dataset } = document.documentElement;
  const isDark = dataset.theme ? dataset.theme === "dark" : matchMedia("(prefers-color-scheme: dark)").matches;
  dataset.theme = isDark ? "light" : "dark";
}

function listen() {
  const on = (id, kind, act) => byId(id).addEventListener(kind, act);
  document.addEventListener("keydown", onKey);
  for (const kind of ["pointermove", "pointerdown", "pointerleave"]) {
    on("picture", kind, (event) => showHover(kind === "pointerleave" ? null : placeOf(event)));
  }
  // A click's place is rounded to whole points, a pointer's is not.
  on("picture", "click", (event) => go({ [picked()]: look.hover ?? placeOf(event) }));
  const buttons = { previous: () => goStep(-1), next: () => goStep(1), up: () => goDraw(-1), down: () => goDraw(1), theme: turnTheme };
  for (const [id, act] of Object.entries(buttons)) on(id, "click", act);
  on("slider", "input", ({ target }) => go({ step: Number(target.value) }));
  on("bits", "change", ({ target }) => go({ bit: target.selectedIndex === 0 ? null : target.selectedIndex - 1 }));
  for (const id of ["light", "face"]) on(id, "change", ({ target }) => go({ [id]: target.selectedIndex }));
  const range = () => [byId("near").valueAsNumber, byId("far").valueAsNumber];
  for (const id of ["near", "far"]) on(id, "change", () => go({ range: range().every(Number.isFinite) ? range() : null }));
  on("pick", "change", pickTyped);
  on("pick", "submit", (event) => event.preventDefault());
  window.addEventListener("hashchange", () => {
    readAddress(capture);
    show();
  });
}

// The first step is shown as soon as its arrays are there; the others follow, and then what answers about pixels.
async function start() {
  await capture.open();
  const moment = new URLSearchParams(capture.opens).get("time");
  byId("title").textContent = `${capture.scene}, ${capture.technique}${moment === null ? "" : `, at ${moment} s`}`;
  const origin = capture.origin ? `${capture.origin.program ?? "another program"}, ${capture.origin.api} · ` : "";
  byId("made-by").textContent = `${capture.size.join("×")} · ${origin}${capture.adapter.name} · ${capture.program}`;
  const live = { id: "live", class: "button", target: "_blank", rel: "noopener", title: "Open this frame in a live window" };
  if (capture.live) byId("theme").before(element("a", live, "Open live"));
  readAddress(capture);
  const light = capture.lights[look.light];
  const faces = viewOf(capture, look) === "map" ? capture.lights.flatMap((one) => one.faces.map((face) => face.file)) : [];
  const frames = [capture.frameAt(look.step, look.draw), capture.frameBefore(look.step, look.draw)];
  const shown = frames.flatMap((frame) => (frame ? [frame.color, frame.depth, frame.stencil] : []));
  await capture.provide([...shown, light?.mask, light?.count, light?.findings, ...faces]);
  listSteps(capture, (step, draw) => go({ step, draw }));
  show();
  performance.mark("shown");
  await capture.openReader(byId("module").textContent);
  paintThumbnails(capture);
  listen();
  show();
  performance.mark("whole");
}

// For scripts and the console.
window.stencilscope = { capture };

start().catch((error) => {
  byId("told").textContent = `This frame can't be shown (${error.message}): make the page again.`;
  throw error;
});
