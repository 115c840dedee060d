// The picture, the marks over it, and the magnifier.

import { byId, css, element } from "./elements.js";

const TEXEL = 34;
const AROUND = [4, 3];

// Is a texel on a stroke of its hatching? A second sign beside colour.
function isInked(hatch, x, y) {
  const [up, down] = [(x + y) % 6 === 0, (x - y + 6e6) % 6 === 0];
  return [false, up, down, up || down, x % 4 === 0 && y % 4 === 0][hatch];
}

// Draws a layer into a canvas, every `every`-th texel of it.
export function paint(canvas, layer, every = 1) {
  const [width, height] = layer.size.map((side) => Math.max(1, Math.floor(side / every)));
  [canvas.width, canvas.height] = [width, height];
  const context = canvas.getContext("2d");
  const image = context.createImageData(width, height);
  for (let y = 0, to = 0; y < height; y++) {
    for (let x = 0; x < width; x++, to += 4) {
      const at = y * every * layer.size[0] + x * every;
      const color = layer.hatch && isInked(layer.hatch(at), x, y) ? [20, 22, 27] : layer.color(at);
      [image.data[to], image.data[to + 1], image.data[to + 2]] = color;
      image.data[to + 3] = 255;
    }
  }
  context.putImageData(image, 0, 0);
}

// A box round a texel, with arms that lead to it.
const crosshair = ([x, y]) => `M${x - 2} ${y - 2}h5v5h-5zM${x - 9} ${y + 0.5}h6m7 0h6M${x + 0.5} ${y - 9}v6m0 7v6`;
const box = ([x, y]) => `M${x} ${y}h1v1h-1z`;

// What lies over the picture or the map: the picked pixel or texel, what reads or is read, and the selected triangle.
export function mark(capture, look, view, told, readers) {
  const isMap = view === "map" && capture.lights[look.light].faces.length > 0;
  const [width, height] = isMap ? capture.lights[look.light].faces[look.face].size : capture.size;
  const compared = isMap && told?.lights[look.light]?.compared;
  const texels = compared && compared.face === look.face ? compared.texels.map(({ at }) => at) : [];
  const d = (isMap ? texels : look.pixel ? [look.pixel] : []).map(crosshair).join("");
  const linked = (isMap ? [look.texel].filter(Boolean).map(crosshair) : (readers ?? []).map(box)).join("");
  const points = isMap ? "" : (told?.rows[look.selected]?.outline ?? []).map(String).join(" ");
  byId("marks").setAttribute("viewBox", `0 0 ${width} ${height}`);
  byId("marks").replaceChildren(
    ...(linked ? [element("path", { d: linked, class: "linked" })] : []),
    ...(points ? ["halo", "face"].map((kind) => element("polygon", { points, class: kind })) : []),
    ...(d ? ["halo", "line"].map((kind) => element("path", { d, class: kind })) : []));
}

// The texels round a place, large, with their values.
export function magnify(layer, place) {
  byId("magnifier").hidden = !layer || !place;
  if (!layer || !place) return;
  const canvas = byId("magnified");
  const sides = AROUND.map((side) => (2 * side + 1) * TEXEL);
  const scale = window.devicePixelRatio || 1;
  [canvas.width, canvas.height] = sides.map((side) => side * scale);
  [canvas.style.width, canvas.style.height] = sides.map((side) => `${side}px`);
  const context = canvas.getContext("2d");
  context.scale(scale, scale);
  context.font = "10px ui-monospace, 'DejaVu Sans Mono', monospace";
  [context.textAlign, context.textBaseline] = ["center", "middle"];
  for (let top = 0; top < sides[1]; top += TEXEL) {
    for (let left = 0; left < sides[0]; left += TEXEL) {
      const [x, y] = [left, top].map((start, axis) => place[axis] + start / TEXEL - AROUND[axis]);
      if (x < 0 || y < 0 || x >= layer.size[0] || y >= layer.size[1]) continue;
      const at = y * layer.size[0] + x;
      const color = layer.color(at);
      context.fillStyle = css(color);
      context.fillRect(left, top, TEXEL - 1, TEXEL - 1);
      context.fillStyle = 0.299 * color[0] + 0.587 * color[1] + 0.114 * color[2] > 128 ? "#101010" : "#e1e1e1";
      context.fillText(layer.short(at), left + TEXEL / 2, top + TEXEL / 2, TEXEL - 3);
    }
  }
  const [left, top] = AROUND.map((side) => side * TEXEL);
  for (const [color, inset] of [["#101010", 0], ["#ffffff", 1.5]]) {
    context.strokeStyle = color;
    context.strokeRect(left + inset, top + inset, TEXEL - 1 - 2 * inset, TEXEL - 1 - 2 * inset);
  }
  canvas.setAttribute("aria-label", `Values round ${place.join(", ")}; in the middle ${layer.text(place[1] * layer.size[0] + place[0])}`);
}
