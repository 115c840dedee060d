// The steps of the frame with their draws, why each is there, its raster state, and what was left out.

import { button, byId, element, partSign, row } from "./elements.js";
import { capitalized, count, lightName } from "./numbers.js";
import { layerOf } from "./palette.js";
import { paint } from "./picture.js";

function drawItem(draw, onclick) {
  const isKept = draw.after !== null;
  const title = isKept ? null : "What this draw left was not kept: make the page with --every draw.";
  const differs = draw.differs ? ` · ${count(draw.differs)} pixels otherwise than stored` : "";
  const name = element("span", { class: "name" }, draw.name + differs);
  const number = element("span", { class: "number" }, count(draw.triangles));
  return element("li", {}, button({ disabled: !isKept, title, onclick }, partSign(draw.part), name, number));
}

// The list; it is made once.
export function listSteps(capture, goTo) {
  const items = capture.steps.map((step, index) => {
    const triangles = step.draws.reduce((sum, draw) => sum + draw.triangles, 0);
    const facts = step.number === null ? "beside the frame" : `${count(triangles)} triangles`;
    const of = step.light === null ? "scene" : lightName(step.light);
    const name = step.number === null ? step.name : `${step.number} · ${step.name}`;
    const words = [element("span", { class: "name" }, name), element("span", { class: "facts" }, `${of} · ${facts}`)];
    const picture = element("canvas", { class: "thumbnail", "aria-hidden": "true" });
    const draws = step.draws.map((draw, at) => drawItem(draw, () => goTo(index, at)));
    return element("li", {}, button({ class: "step", onclick: () => goTo(index, null) }, picture, element("span", {}, words)),
      element("ol", { class: "draws", hidden: true }, draws));
  });
  byId("steps").replaceChildren(...items);
  const absent = ({ what, of, name, because }) =>
    element("li", {}, element("b", {}, [what, name, "of", of].filter(Boolean).join(" ")), ` ${because}`);
  byId("absent").replaceChildren(...capture.leftOut.map(absent));
  byId("left-out").hidden = capture.leftOut.length === 0;
  byId("slider").max = capture.steps.length - 1;
}

// Small pictures of what the steps write.
export function paintThumbnails(capture) {
  document.querySelectorAll(".thumbnail").forEach((canvas, step) => {
    const { after: { face }, light } = capture.steps[step];
    const layer = layerOf(capture, { step, draw: null, view: "auto", phase: "after", light: light ?? 0, face, bit: null, range: null });
    if (layer) paint(canvas, layer, Math.max(1, Math.round(layer.size[0] / 104)));
  });
}

// The raster state of a draw in WebGPU's words.
function rasterRows({ name, raster }) {
  const { stencil, depth_bias: bias } = raster;
  const face = ({ compare, failOp, depthFailOp, passOp }) => `${compare}; fail ${failOp}, depth fail ${depthFailOp}, pass ${passOp}`;
  const facts = {
    draw: name, "depth test": raster.depth_compare, "depth write": raster.depth_write ? "on" : "off",
    "depth clip": raster.unclipped_depth ? "clamped" : "clipped",
    "depth bias": `${bias.constant}, slope ${bias.slope_scale}, clamp ${bias.clamp}`,
    "stencil, front": face(stencil.front), "stencil, back": face(stencil.back),
    masks: `read ${stencil.read_mask}, write ${stencil.write_mask}`, reference: raster.stencil_reference,
    "front is": raster.front_face, culled: raster.cull ?? "none", colour: raster.color.toLowerCase(),
  };
  return Object.entries(facts).map(([fact, value]) => row({}, element("th", { scope: "row" }, fact), String(value)));
}

// Marks where one stands.
export function showPlace(capture, look) {
  const step = capture.steps[look.step];
  const { draws } = capture.passes[look.step];
  const isHere = (index, draw) => String(index === look.step && look.draw === draw && "step");
  [...byId("steps").children].forEach((item, index) => {
    const [own, list] = item.children;
    item.classList.toggle("here", index === look.step);
    own.setAttribute("aria-current", isHere(index, null));
    list.hidden = index !== look.step || list.children.length === 0;
    [...list.children].forEach((draw, at) => draw.firstChild.setAttribute("aria-current", isHere(index, at)));
  });
  const ofStep = step.number === null ? `${step.name}, beside the frame` : `step ${step.number}: ${step.name}`;
  const ofAll = draws.length > 0 ? ` · after its ${draws.length} draws` : "";
  const after = look.draw === null ? ofAll : ` · after draw ${look.draw + 1}, ${step.draws[look.draw].name}`;
  byId("place").textContent = capitalized(ofStep) + after;
  byId("slider").value = look.step;
  byId("slider").setAttribute("aria-valuetext", ofStep);
  byId("why-pass").textContent = step.purpose;
  byId("state").hidden = draws.length === 0;
  byId("raster").replaceChildren(element("table", {}, draws.length === 0 ? [] : rasterRows(draws[look.draw ?? 0])));
  byId("previous").disabled = look.step === 0;
  byId("next").disabled = look.step === capture.steps.length - 1;
  for (const id of ["up", "down"]) byId(id).disabled = !capture.hasDraws(look.step);
}
