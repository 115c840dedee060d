// One sentence about a pixel under a light, and what stands behind it (src/reading/verdict.rs).

import { BACKGROUND, FACES_AWAY, LIT, distanceInMap } from "./capture.js";
import { capitalized, depthText, length } from "./numbers.js";
import { countText, countedAt, whyOf, whyText } from "./why.js";

// The texels of a light's map that a pixel reads, row by row; null where it reads none, or that is not known.
export function texelsRead(capture, light, pixel) {
  const { reads, faces } = capture.lights[light];
  const texels = reads && capture.array(reads.texels);
  if (!texels) return null;
  const at = capture.index(pixel);
  const [face, column, row] = [0, 1, 2].map((lane) => texels[at * 3 + lane] - 1);
  if (face < 0) return null;
  const { size: [width, height], image } = faces[face];
  const within = (value, side) => Math.min(Math.max(value - Math.floor(reads.filter / 2), 0), side - 1);
  const depth = capture.array(reads.depths)[at];
  const slope = capture.array(reads.slopes)?.subarray(at * 2, at * 2 + 2) ?? [0, 0];
  const texelOf = (_, index) => {
    const [x, y] = [within(column + index % reads.filter, width), within(row + Math.floor(index / reads.filter), height)];
    const own = depth + slope[0] * (x - column) + slope[1] * (y - row);
    const stored = capture.array(image)[y * width + x];
    const isCaster = stored !== capture.clear_depth;
    const isNearest = capture.clear_depth === 0 ? own >= stored : own <= stored;
    return { x, y, own, stored, isCaster, isLit: !isCaster || isNearest };
  };
  return { face, middle: [column, row], texels: Array.from({ length: reads.filter ** 2 }, texelOf) };
}

// The pixels that read a texel of a face, in reading order; null where that is not known.
export function readersOf(capture, { light, face, texel }) {
  const { reads } = capture.lights[light];
  const texels = reads && capture.array(reads.texels);
  if (!texels) return null;
  const offset = Math.floor(reads.filter / 2) + 1;
  const nth = (at, axis) => texel[axis] - texels[at * 3 + 1 + axis] + offset;
  const isRead = (at, axis) => nth(at, axis) >= 0 && nth(at, axis) < reads.filter;
  const pixels = [...Array(texels.length / 3).keys()].filter((at) => texels[at * 3] - 1 === face && isRead(at, 0) && isRead(at, 1));
  return pixels.map((at) => [at % capture.size[0], Math.floor(at / capture.size[0])]);
}

function mapReason(capture, light, pixel, fallback) {
  const read = texelsRead(capture, light, pixel);
  if (!read) return fallback;
  const face = capture.lights[light].faces[read.face];
  const middle = read.texels.find(({ x, y }) => x === read.middle[0] && y === read.middle[1]);
  const place = `${read.middle.join(", ")}${capture.lights[light].faces.length > 1 ? ` of ${face.name}` : ""}`;
  if (!middle.isCaster && read.texels.length === 1) {
    return `Texel ${place} holds no caster: nothing nearer is stored, so the light pass adds the light.`;
  }
  const far = (value) => {
    const distance = distanceInMap(face, value);
    return distance === null ? `depth ${depthText(value)}` : `${length(distance, capture.depth.unit)} from the light`;
  };
  const told = middle.isCaster ? `holds a caster ${far(middle.stored)}` : "holds no caster";
  const lit = read.texels.filter(({ isLit }) => isLit).length;
  const follows = read.texels.length > 1 ? `of the ${read.texels.length} texels read, ${lit} hold nothing nearer to the light`
    : lit === 0 ? "it is nearer, so the light pass adds nothing" : "it is not nearer, so the light pass adds the light";
  return `Texel ${place} ${told}; this surface is ${far(middle.own)}: ${follows}.`;
}

export function verdictOf(capture, history, light) {
  const { name, decided_by: { kind }, reasons } = capture.lights[light];
  const label = history.labels[light];
  const why = whyOf(history, light);
  const because = why ? `${capitalized(whyText(why))}.` : null;
  const verdict = (title, reason) => ({ title, reason });
  if (label === null) return verdict("No light was asked about this pixel.", because ?? "The frame holds no mask of this light.");
  if (label === BACKGROUND) return verdict("Background: no surface is at this pixel.", "Nothing was drawn that a shadow could fall on.");
  const away = `${capitalized(name)} shines on the other side of this surface, so shading alone leaves it dark.`;
  if (label === FACES_AWAY) return verdict(`Turned away from ${name}.`, away);
  const title = label === LIT ? `Lit by ${name}` : `Dark under ${name}`;
  const fallback = reasons[label === LIT ? 0 : 1];
  if (kind === "map") return verdict(`${title}.`, mapReason(capture, light, history.pixel, fallback));
  const counts = { "stencil-count": "stencil count", "float-count": "count" }[kind];
  const count = counts ? `: its ${counts} is ${countText(countedAt(history, light))}` : "";
  return verdict(`${title}${count}.`, because ?? fallback);
}
