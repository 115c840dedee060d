// The steps of the frame with their draws, why each is there, its raster state, and what was left out.

import { byId, element } from "./elements.js";
import { capitalized, count, lightName } from "./numbers.js";
import { layerOf } from "./palette.js";
import { paint } from "./picture.js";

const sum = (draws) => draws.reduce((total, { triangles }) => total + triangles, 0);

function drawButton(capture, step, draw, index, goTo) {
  const differs = draw.differs ? ` · ${count(draw.differs)} pixels otherwise than stored` : "";
  const parts = [element("span", { class: `part ${draw.part}`, "aria-hidden": "true" }), element("span", { class: "name" }, draw.name + differs),
    element("span", { class: "number" }, count(draw.triangles))];
  return element("li", {}, element("button", {
    type: "button", "data-draw": index, disabled: draw.after === null, onclick: () => goTo(step, index),
    title: draw.after === null ? "What this draw left was not kept: make the page with --every draw." : "",
  }, parts));
}

// The list; it is made once.
export function listSteps(capture, goTo) {
  const items = capture.steps.map((step, index) => {
    const name = step.number === null ? step.name : `${step.number} · ${step.name}`;
    const of = step.light === null ? "scene" : lightName(step.light);
    const facts = step.number === null ? "beside the frame" : `${count(sum(step.draws))} triangles`;
    const button = element("button", { type: "button", class: "step", onclick: () => goTo(index, null) },
      element("canvas", { class: "thumbnail", "aria-hidden": "true" }),
      element("span", {}, element("span", { class: "name" }, name), element("span", { class: "facts" }, `${of} · ${facts}`)));
    const draws = step.draws.map((draw, at) => drawButton(capture, index, draw, at, goTo));
    return element("li", {}, button, draws.length > 0 ? element("ol", { class: "draws", hidden: true }, draws) : null);
  });
  byId("steps").replaceChildren(...items);
  byId("absent").replaceChildren(...capture.left_out.map(({ what, of, name, because }) =>
    element("li", {}, element("b", {}, `${what}${name ? ` ${name}` : ""} of ${of}`), element("span", {}, ` ${because}`))));
  byId("left-out").hidden = capture.left_out.length === 0;
  byId("slider").max = capture.steps.length - 1;
}

// Small pictures of what the steps write.
export function paintThumbnails(capture) {
  document.querySelectorAll(".thumbnail").forEach((canvas, step) => {
    const { after, light } = capture.steps[step];
    const look = { step, draw: null, view: "auto", phase: "after", light: light ?? 0, face: after.face ?? 0, bit: null, range: null };
    const layer = layerOf(capture, look);
    if (layer) paint(canvas, layer, Math.max(1, Math.round(layer.size[0] / 104)));
  });
}

const faceWords = ({ compare, failOp, depthFailOp, passOp }) => `${compare}; fail ${failOp}, depth fail ${depthFailOp}, pass ${passOp}`;

// The raster state of a draw in WebGPU's words.
function rasterRows(draw) {
  const { raster } = draw;
  const { stencil, depth_bias: bias } = raster;
  return [
    ["draw", draw.name], ["depth test", raster.depth_compare], ["depth write", raster.depth_write ? "on" : "off"],
    ["depth clip", raster.unclipped_depth ? "clamped" : "clipped"],
    ["depth bias", `${bias.constant}, slope ${bias.slope_scale}, clamp ${bias.clamp}`],
    ["stencil, front", faceWords(stencil.front)], ["stencil, back", faceWords(stencil.back)],
    ["masks", `read ${stencil.read_mask}, write ${stencil.write_mask}`], ["reference", String(raster.stencil_reference)],
    ["front is", raster.front_face], ["culled", raster.cull ?? "none"], ["colour", raster.color.toLowerCase()],
  ];
}

// Marks where one stands.
export function showPlace(capture, look) {
  const step = capture.steps[look.step];
  [...byId("steps").children].forEach((item, index) => {
    const [button, draws] = item.children;
    const isHere = index === look.step;
    button.setAttribute("aria-current", isHere && look.draw === null ? "step" : "false");
    item.classList.toggle("here", isHere);
    if (!draws) return;
    draws.hidden = !isHere;
    [...draws.children].forEach((draw, at) => draw.firstChild.setAttribute("aria-current", isHere && look.draw === at ? "step" : "false"));
  });
  const ofStep = step.number === null ? `${step.name}, beside the frame` : `step ${step.number}: ${step.name}`;
  const after = look.draw === null ? (step.draws.length > 0 ? `after its ${step.draws.length} draws` : "") : `after draw ${look.draw + 1}, ${step.draws[look.draw].name}`;
  byId("place").textContent = `${capitalized(ofStep)}${after ? ` · ${after}` : ""}`;
  byId("slider").value = look.step;
  byId("slider").setAttribute("aria-valuetext", ofStep);
  byId("why-pass").textContent = step.purpose;
  const { draws } = capture.plan.passes[look.step];
  byId("state").hidden = draws.length === 0;
  const rows = draws.length === 0 ? [] : rasterRows(draws[look.draw ?? 0]);
  byId("raster").replaceChildren(element("table", {}, rows.map(([name, value]) => element("tr", {}, element("th", { scope: "row" }, name), element("td", {}, value)))));
  byId("previous").disabled = look.step === 0;
  byId("next").disabled = look.step === capture.steps.length - 1;
  [byId("up").disabled, byId("down").disabled] = [!capture.hasDraws(look.step), !capture.hasDraws(look.step)];
}
