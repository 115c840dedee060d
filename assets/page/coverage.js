// Which triangles lie over a pixel, and how deep (src/plan/coverage.rs): a sieve of four planes through the eye, then
// the triangle itself, clipped and carried into the window in floats, its corners rounded to 1/256 of a pixel, with the
// top-left rule. Coverage and depth have the bits of Mesa's software GPU; another's last bits may be others.

import { roundedToEven } from "./numbers.js";

const DOUBT = 1;
const [SAFE, SAFE_DEPTH] = [1 / 16, 1e-6];
const SUBPIXELS = 256;
const f32 = Math.fround;

// May a pass change a pixel? Outside of its scissor it does not.
const reaches = ({ scissor }, pixel) => !scissor
  || pixel.every((place, axis) => place >= scissor[axis] && place < scissor[axis] + scissor[axis + 2]);

// A pixel's centre in normalized device coordinates, half of a pixel's sides, and how far inside of the viewport it is.
function squareOf([x, y], { area: [left, top, width, height] }) {
  const [u, v] = [(x + 0.5 - left) / width, (y + 0.5 - top) / height];
  const inside = Math.min(u * width, (1 - u) * width, v * height, (1 - v) * height);
  return { center: [2 * u - 1, 1 - 2 * v], half: [1 / width, 1 / height], inside };
}

// Of each corner four bits: right of, left of, above and below the square of twice the doubt.
function sieve(corners, { center: [x, y], half }) {
  const [reachX, reachY] = half.map((side) => side * 2 * DOUBT);
  const bits = new Uint8Array(corners.length / 4);
  for (let at = 0, from = 0; at < bits.length; at++, from += 4) {
    const [cx, cy, w] = [corners[from], corners[from + 1], corners[from + 3]];
    bits[at] = (cx > w * (x + reachX) ? 1 : 0) | (cx < w * (x - reachX) ? 2 : 0)
      | (cy > w * (y + reachY) ? 4 : 0) | (cy < w * (y - reachY) ? 8 : 0);
  }
  return bits;
}

const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];

// How a triangle lies to the centre: null where it is farther than doubt reaches.
function lie(clip, { center, half, inside: insideViewport }) {
  const seen = clip.map(([x, y, , w]) => [(x - center[0] * w) / (2 * half[0]), (y - center[1] * w) / (2 * half[1]), w]);
  const edges = [cross(seen[1], seen[2]), cross(seen[2], seen[0]), cross(seen[0], seen[1])];
  const distances = edges.map(([x, y, z]) => z / Math.hypot(x, y));
  const [least, most] = [Math.min(...distances), Math.max(...distances)];
  if (least < -DOUBT && most > DOUBT) return null;
  const sum = edges[0][2] + edges[1][2] + edges[2][2];
  const [z, w] = [2, 3].map((lane) => clip.reduce((total, corner, at) => total + edges[at][2] * corner[lane], 0) / sum);
  const isSafe = (least > SAFE || most < -SAFE) && insideViewport > SAFE;
  return { isInside: (least > 0 || most < 0) && w > 0, isCounterclockwise: sum > 0, depth: z / w, isSafe };
}

// The planes of clip space as weights of x, y, z and w: the sides first, then near and far.
const PLANES = [[-1, 0, 0, 1], [1, 0, 0, 1], [0, -1, 0, 1], [0, 1, 0, 1], [0, 0, 1, 0], [0, 0, -1, 1]];

// How far a corner is inside of a plane, each sum rounded.
const insideOf = (plane, corner) => plane.reduce((sum, weight, lane) => f32(sum + f32(weight * corner[lane])), 0);

// The corner where an edge goes through a plane, made from the end that is nearer to it.
function crossing(ends, distances) {
  const nearer = Math.abs(distances[0]) <= Math.abs(distances[1]) ? 0 : 1;
  const share = f32((nearer === 0 ? -distances[0] : distances[1]) / f32(distances[1] - distances[0]));
  const [start, end] = [ends[nearer], ends[1 - nearer]];
  return { isNew: true, clip: start.clip.map((value, lane) => f32(value + f32(share * f32(end.clip[lane] - value)))) };
}

// The part of a triangle in clip space's box, as corners in order (Sutherland and Hodgman 1974).
function clipped(triangle, isUnclipped) {
  let corners = triangle.map((clip) => ({ clip, isNew: false }));
  for (const plane of isUnclipped ? PLANES.slice(0, 4) : PLANES) {
    if (triangle.every((clip) => insideOf(plane, clip) >= 0)) continue;
    const distances = corners.map(({ clip }) => insideOf(plane, clip));
    corners = corners.flatMap((corner, at) => {
      const next = (at + 1) % corners.length;
      const [here, there] = [distances[at], distances[next]];
      const crossed = here >= 0 !== there >= 0 ? [crossing([corner, corners[next]], [here, there])] : [];
      return here >= 0 ? [corner, ...crossed] : crossed;
    });
  }
  return corners;
}

// A corner in the window, rounded as floats are on their way there: a new one is not multiplied and added at once.
function inWindow({ clip: [x, y, z, w], isNew }, { area: [left, top, width, height], range: [near, far] }) {
  const inverse = f32(1 / w);
  const scaled = (value, scale) => (isNew ? f32(f32(value * inverse) * scale) : f32(value * inverse) * scale);
  const moved = (value, scale, offset) => f32(scaled(value, scale) + offset);
  return [moved(x, width / 2, left + width / 2), moved(y, -height / 2, top + height / 2), moved(z, f32(far - near), near)];
}

// Does a triangle in the window cover a pixel's centre? Null where it has no area. Rows count downwards.
function covers(corners, [x, y]) {
  const [a, b, c] = corners.map((corner) => [0, 1].map((axis) => roundedToEven(f32(corner[axis] - 0.5) * SUBPIXELS)));
  const area = (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1]);
  if (area === 0) return null;
  const isLeftOf = ([fromX, fromY], [toX, toY]) => {
    const [dx, dy] = [toX - fromX, toY - fromY];
    const side = dx * (y * SUBPIXELS - fromY) - dy * (x * SUBPIXELS - fromX);
    return side > 0 || (side === 0 && (dy < 0 || (dy === 0 && dx > 0)));
  };
  const [second, third] = area < 0 ? [c, b] : [b, c];
  const isCovered = isLeftOf(a, second) && isLeftOf(second, third) && isLeftOf(third, a);
  return isCovered ? { isCounterclockwise: area < 0 } : null;
}

// Depth at a pixel's centre from the plane through a triangle's corners, in floats, as Mesa's software GPU sets it up;
// a draw's bias is steps of the largest depth's exponent, and of the slope.
function planeDepth([a, b, c], [x, y], { constant, slope_scale: slope, clamp }) {
  const [dx01, dy01, dz01] = [0, 1, 2].map((axis) => f32(a[axis] - b[axis]));
  const [dx20, dy20, dz20] = [0, 1, 2].map((axis) => f32(c[axis] - a[axis]));
  const area = f32(1 / f32(f32(dx01 * dy20) - f32(dy01 * dx20)));
  const share = (difference) => f32(difference * area);
  const alongX = f32(f32(dz01 * share(dy20)) - f32(dz20 * share(dy01)));
  const alongY = f32(f32(dz20 * share(dx01)) - f32(dz01 * share(dx20)));
  const largest = Math.max(a[2], b[2], c[2]);
  const step = largest > 0 ? 2 ** (Math.floor(Math.log2(largest)) - 23) : 0;
  let bias = f32(f32(step * constant) + f32(Math.max(Math.abs(alongX), Math.abs(alongY)) * slope));
  if (clamp !== 0) bias = clamp > 0 ? Math.min(bias, clamp) : Math.max(bias, clamp);
  const back = f32(f32(alongX * f32(a[0] - 0.5)) + f32(alongY * f32(a[1] - 0.5)));
  return f32(alongY * y + f32(alongX * x + f32(f32(a[2] + bias) - back)));
}

// The fragment of a triangle at a pixel: of that part of its fan that covers it.
function fragmentOf(clip, { raster }, pass, pixel) {
  const corners = clipped(clip, raster.unclipped_depth).map((corner) => inWindow(corner, pass));
  for (let last = 2; last < corners.length; last++) {
    const part = [corners[0], corners[last - 1], corners[last]];
    const covered = covers(part, pixel);
    if (covered) return { ...covered, depth: planeDepth(part, pixel, raster.depth_bias) };
  }
  return null;
}

// What becomes of a triangle at a pixel: a fragment, or why there is none; null where it is elsewhere.
function fateOf(clip, draw, pass, square, pixel, isReversed) {
  const seen = lie(clip, square);
  if (seen === null) return null;
  const { raster } = draw;
  const frontOf = ({ isCounterclockwise }) => isCounterclockwise === (raster.front_face === "ccw");
  const isCulled = (isFront) => raster.cull !== null && (raster.cull === "front") === isFront;
  const fragment = fragmentOf(clip, draw, pass, pixel);
  if (fragment && !isCulled(frontOf(fragment))) return { isFront: frontOf(fragment), depth: fragment.depth, kind: "fragment" };
  if (!seen.isInside || !seen.isSafe) return null;
  const [near, far] = pass.range;
  const face = { isFront: frontOf(seen), depth: f32(near + (far - near) * seen.depth) };
  const isOutside = seen.depth < -SAFE_DEPTH || seen.depth > 1 + SAFE_DEPTH;
  if (isOutside && !raster.unclipped_depth) return { ...face, kind: "clipped", clip: seen.depth < 0 === isReversed ? "far" : "near" };
  return isCulled(face.isFront) ? { ...face, kind: "culled" } : null;
}

// Corners of a triangle as a view has them.
export function cornersOf(capture, draw, view, triangle) {
  const mesh = capture.meshes[draw.mesh];
  const [corners, indices] = [capture.array(mesh.corners[view]), capture.array(mesh.indices)];
  const from = (corner) => (indices[triangle * 3 + corner] + draw.base_vertex) * 4;
  return [from(0), from(1), from(2)].map((at) => [corners[at], corners[at + 1], corners[at + 2], corners[at + 3]]);
}

// Every triangle over a pixel, in the order in which it is drawn, with what becomes of it before the tests.
export function covering(capture, pixel) {
  const found = [];
  const sieves = new Map();
  capture.passes.forEach((pass, passIndex) => {
    const square = squareOf(pixel, pass);
    if (!pass.is_of_picture || !reaches(pass, pixel) || square.inside < -DOUBT) return;
    pass.draws.forEach((draw, drawIndex) => {
      const mesh = capture.meshes[draw.mesh];
      const indices = capture.array(mesh.indices);
      const key = `${draw.mesh} ${pass.view} ${pass.area}`;
      if (!sieves.has(key)) sieves.set(key, sieve(capture.array(mesh.corners[pass.view]), square));
      const outside = sieves.get(key);
      const { triangles: [start, end], base_vertex: base, is_reverse: isReverse } = draw;
      const near = [];
      for (let triangle = start, at = start * 3; triangle < end; triangle++, at += 3) {
        const bits = outside[indices[at] + base] & outside[indices[at + 1] + base] & outside[indices[at + 2] + base];
        if (bits === 0) near.push(triangle);
      }
      for (const triangle of isReverse ? near.reverse() : near) {
        const clip = cornersOf(capture, draw, pass.view, triangle);
        const fate = fateOf(clip, draw, pass, square, pixel, capture.is_reversed);
        const primitive = isReverse ? end - 1 - triangle : triangle - start;
        if (fate !== null) found.push({ pass: passIndex, draw: drawIndex, primitive, triangle, fate });
      }
    });
  });
  return found;
}
