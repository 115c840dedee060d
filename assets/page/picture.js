// The picture, the marks over it, and the magnifier.

import { cornersOf, viewportOf } from "./coverage.js";
import { byId, css, element } from "./elements.js";
import { texelsRead } from "./verdict.js";

const TEXEL = 34;
const [AROUND_X, AROUND_Y] = [4, 3];

// Is a texel on a stroke of its hatching? A second sign beside colour.
function isInked(hatch, x, y) {
  if (hatch === 1) return (x + y) % 6 === 0;
  if (hatch === 2) return (x - y + 6e6) % 6 === 0;
  if (hatch === 3) return (x + y) % 6 === 0 || (x - y + 6e6) % 6 === 0;
  return hatch === 4 && x % 4 === 0 && y % 4 === 0;
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
      const color = layer.hatch && isInked(layer.hatch(layer.values[at]), x, y) ? [20, 22, 27] : layer.color(at);
      image.data.set(color, to);
      image.data[to + 3] = 255;
    }
  }
  context.putImageData(image, 0, 0);
}

// The part of a triangle before the eye, in pixels.
function outline(capture, event) {
  const pass = capture.plan.passes[event.pass];
  const { triangle: index, draw } = event.triangle;
  const corners = cornersOf(capture, pass.draws[draw], pass.view, index);
  const { area: [left, top, width, height] } = viewportOf(pass, capture.size);
  const ahead = ([, , , w]) => w > 1e-6;
  const shown = corners.flatMap((from, at) => {
    const to = corners[(at + 1) % 3];
    const share = (from[3] - 1e-6) / (from[3] - to[3]);
    const crossing = from.map((value, lane) => value + (to[lane] - value) * share);
    return [...(ahead(from) ? [from] : []), ...(ahead(from) === ahead(to) ? [] : [crossing])];
  });
  const places = shown.map(([x, y, , w]) => [left + (x / w + 1) * width / 2, top + (1 - y / w) * height / 2]);
  return places.map((place) => place.map((value) => Math.min(Math.max(value, -1e5), 1e5).toFixed(2)).join(",")).join(" ");
}

// What lies over the picture: the picked pixel, the selected triangle, the texels that a pixel reads.
export function mark(capture, look, view, event) {
  const [width, height] = view === "map" ? capture.lights[look.light].faces[look.face].size : capture.size;
  const marks = byId("marks");
  marks.setAttribute("viewBox", `0 0 ${width} ${height}`);
  const boxes = [];
  if (view === "map") {
    const read = look.pixel && texelsRead(capture, look.light, look.pixel);
    if (read && read.face === look.face) boxes.push(...read.texels.map(({ x, y }) => [x, y]));
  } else if (look.pixel) boxes.push(look.pixel);
  const arms = ([x, y]) => `M${x - 9} ${y + 0.5}H${x - 3}M${x + 4} ${y + 0.5}H${x + 10}M${x + 0.5} ${y - 9}V${y - 3}M${x + 0.5} ${y + 4}V${y + 10}`;
  const box = ([x, y]) => `M${x - 2} ${y - 2}h5v5h-5z`;
  const path = boxes.map((at) => box(at) + arms(at)).join("");
  const lines = path ? ["halo", "line"].map((kind) => element("path", { d: path, class: kind })) : [];
  const triangle = event?.triangle && view !== "map"
    ? ["halo", "face"].map((kind) => element("polygon", { points: outline(capture, event), class: kind })) : [];
  marks.replaceChildren(...triangle, ...lines);
}

// The texels round a place, large, with their values.
export function magnify(layer, place) {
  const canvas = byId("magnified");
  byId("magnifier").hidden = !layer || !place;
  if (!layer || !place) return;
  const [columns, rows] = [2 * AROUND_X + 1, 2 * AROUND_Y + 1];
  const scale = window.devicePixelRatio || 1;
  [canvas.width, canvas.height] = [columns, rows].map((count) => count * TEXEL * scale);
  [canvas.style.width, canvas.style.height] = [columns, rows].map((count) => `${count * TEXEL}px`);
  const context = canvas.getContext("2d");
  context.scale(scale, scale);
  context.font = "10px ui-monospace, 'DejaVu Sans Mono', monospace";
  [context.textAlign, context.textBaseline] = ["center", "middle"];
  for (let row = 0; row < rows; row++) {
    for (let column = 0; column < columns; column++) {
      const [x, y] = [place[0] + column - AROUND_X, place[1] + row - AROUND_Y];
      if (x < 0 || y < 0 || x >= layer.size[0] || y >= layer.size[1]) continue;
      const at = y * layer.size[0] + x;
      const color = layer.color(at);
      context.fillStyle = css(color);
      context.fillRect(column * TEXEL, row * TEXEL, TEXEL - 1, TEXEL - 1);
      context.fillStyle = 0.299 * color[0] + 0.587 * color[1] + 0.114 * color[2] > 128 ? "#101010" : "#e1e1e1";
      context.fillText(layer.short(at), (column + 0.5) * TEXEL, (row + 0.5) * TEXEL, TEXEL - 3);
    }
  }
  context.strokeStyle = "#101010";
  context.strokeRect(AROUND_X * TEXEL, AROUND_Y * TEXEL, TEXEL - 1, TEXEL - 1);
  context.strokeStyle = "#ffffff";
  context.strokeRect(AROUND_X * TEXEL + 1.5, AROUND_Y * TEXEL + 1.5, TEXEL - 4, TEXEL - 4);
  canvas.setAttribute("aria-label", `Values round ${place.join(", ")}; in the middle ${layer.text(place[1] * layer.size[0] + place[0])}`);
}
