// Which triangles lie over a pixel, and how deep (src/plan/coverage.rs): a sieve of four planes through the eye, then
// the triangle itself, clipped and carried into the window in floats, its corners rounded to 1/256 of a pixel, with the
// top-left rule. Coverage and depth have the bits of Mesa's software GPU; another's last bits may be others.

const DOUBT = 1;
const SAFE = 1 / 16;
const SAFE_DEPTH = 1e-6;
const SUBPIXELS = 256;
const f32 = Math.fround;

// Does a pass draw into the picture?
export function isOfPicture(plan, pass) {
  const isMap = (target) => target !== null && plan.attachments[target.attachment].role.Map !== undefined;
  return !isMap(pass.color) && !isMap(pass.depth_stencil);
}

export function viewportOf(pass, size) {
  return pass.recorded?.viewport ?? { area: [0, 0, size[0], size[1]], depth: [0, 1] };
}

function reaches(pass, [x, y]) {
  if (!pass.scissor) return true;
  const [left, top, columns, rows] = pass.scissor;
  return x >= left && x < left + columns && y >= top && y < top + rows;
}

// A pixel's centre in normalized device coordinates, half of a pixel's sides, and how far inside of the viewport it is.
function squareOf([x, y], { area: [left, top, width, height] }) {
  const [u, v] = [(x + 0.5 - left) / width, (y + 0.5 - top) / height];
  const inside = Math.min(u * width, (1 - u) * width, v * height, (1 - v) * height);
  return { center: [2 * u - 1, 1 - 2 * v], half: [1 / width, 1 / height], inside };
}

// Of each corner four bits: right of, left of, above and below the square of twice the doubt.
function sieve(corners, { center: [x, y], half }) {
  const [reachX, reachY] = [half[0] * 2 * DOUBT, half[1] * 2 * DOUBT];
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
  const weights = edges.map((edge) => edge[2]);
  const sum = weights[0] + weights[1] + weights[2];
  const interpolated = (lane) => clip.reduce((total, corner, at) => total + weights[at] * corner[lane], 0) / sum;
  const w = interpolated(3);
  return {
    isInside: (least > 0 || most < 0) && w > 0,
    isCounterclockwise: sum > 0,
    depth: interpolated(2) / w,
    isSafe: (least > SAFE || most < -SAFE) && insideViewport > SAFE,
  };
}

// The planes of clip space as weights of x, y, z and w: the sides first, then near and far.
const PLANES = [[-1, 0, 0, 1], [1, 0, 0, 1], [0, -1, 0, 1], [0, 1, 0, 1], [0, 0, 1, 0], [0, 0, -1, 1]];

// What a corner is from a plane, each sum rounded.
const from = (plane, corner) => plane.reduce((sum, weight, lane) => f32(sum + f32(weight * corner[lane])), 0);

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
    if (triangle.every((clip) => from(plane, clip) >= 0)) continue;
    const distances = corners.map(({ clip }) => from(plane, clip));
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
function inWindow({ clip: [x, y, z, w], isNew }, { area: [left, top, width, height], depth: [near, far] }) {
  const inverse = f32(1 / w);
  const moved = (value, scale, offset) => {
    const product = f32(value * inverse) * scale;
    return f32((isNew ? f32(product) : product) + offset);
  };
  return [
    moved(x, width / 2, left + width / 2), moved(y, -height / 2, top + height / 2), moved(z, f32(far - near), near),
  ];
}

function rounded(value) {
  const low = Math.floor(value);
  const above = value - low;
  return above > 0.5 || (above === 0.5 && low % 2 !== 0) ? low + 1 : low;
}

// Does a triangle in the window cover a pixel's centre? Null where it has no area. Rows count downwards.
function covers(corners, [x, y]) {
  let [a, b, c] = corners.map(([cx, cy]) => [rounded(f32(cx - 0.5) * SUBPIXELS), rounded(f32(cy - 0.5) * SUBPIXELS)]);
  const area = (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1]);
  if (area === 0) return null;
  if (area < 0) [b, c] = [c, b];
  const isLeftOf = ([fromX, fromY], [toX, toY]) => {
    const [dx, dy] = [toX - fromX, toY - fromY];
    const side = dx * (y * SUBPIXELS - fromY) - dy * (x * SUBPIXELS - fromX);
    return side > 0 || (side === 0 && (dy < 0 || (dy === 0 && dx > 0)));
  };
  return isLeftOf(a, b) && isLeftOf(b, c) && isLeftOf(c, a) ? { isCounterclockwise: area < 0 } : null;
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
function fragmentOf(clip, { raster }, viewport, pixel) {
  const corners = clipped(clip, raster.unclipped_depth).map((corner) => inWindow(corner, viewport));
  for (let last = 2; last < corners.length; last++) {
    const part = [corners[0], corners[last - 1], corners[last]];
    const covered = covers(part, pixel);
    if (covered) return { ...covered, depth: planeDepth(part, pixel, raster.depth_bias) };
  }
  return null;
}

// What becomes of a triangle at a pixel: a fragment, or why there is none; null where it is elsewhere.
function fateOf(clip, draw, viewport, square, pixel, isReversed) {
  const seen = lie(clip, square);
  if (seen === null) return null;
  const { raster } = draw;
  const frontOf = ({ isCounterclockwise }) => isCounterclockwise === (raster.front_face === "ccw");
  const isCulled = (isFront) => raster.cull !== null && (raster.cull === "front") === isFront;
  const fragment = fragmentOf(clip, draw, viewport, pixel);
  if (fragment && !isCulled(frontOf(fragment))) return { isFront: frontOf(fragment), depth: fragment.depth, kind: "fragment" };
  if (!seen.isInside || !seen.isSafe) return null;
  const [near, far] = viewport.depth;
  const face = { isFront: frontOf(seen), depth: f32(near + (far - near) * seen.depth) };
  const isOutside = seen.depth < -SAFE_DEPTH || seen.depth > 1 + SAFE_DEPTH;
  if (isOutside && !raster.unclipped_depth) return { ...face, kind: "clipped", clip: seen.depth < 0 === isReversed ? "far" : "near" };
  return isCulled(face.isFront) ? { ...face, kind: "culled" } : null;
}

// Corners of a mesh as a view has them, and its triangles.
function meshOf(capture, draw, view) {
  const mesh = capture.meshes[draw.mesh];
  return { corners: capture.array(mesh.corners[view]), indices: capture.array(mesh.indices) };
}

export function cornersOf(capture, draw, view, triangle) {
  const { corners, indices } = meshOf(capture, draw, view);
  return [0, 1, 2].map((corner) => {
    const from = (indices[triangle * 3 + corner] + draw.base_vertex) * 4;
    return [corners[from], corners[from + 1], corners[from + 2], corners[from + 3]];
  });
}

// Every triangle over a pixel, in the order in which it is drawn, with what becomes of it before the tests.
export function covering(capture, pixel) {
  const { plan } = capture;
  const found = [];
  const sieves = new Map();
  plan.passes.forEach((pass, passIndex) => {
    if (!isOfPicture(plan, pass) || !reaches(pass, pixel)) return;
    const viewport = viewportOf(pass, capture.size);
    const square = squareOf(pixel, viewport);
    if (square.inside < -DOUBT) return;
    pass.draws.forEach((draw, drawIndex) => {
      const { corners, indices } = meshOf(capture, draw, pass.view);
      const key = `${draw.mesh} ${pass.view} ${viewport.area}`;
      if (!sieves.has(key)) sieves.set(key, sieve(corners, square));
      const outside = sieves.get(key);
      const { start, end } = draw.triangles;
      const near = [];
      for (let triangle = start, at = start * 3; triangle < end; triangle++, at += 3) {
        const base = draw.base_vertex;
        if ((outside[indices[at] + base] & outside[indices[at + 1] + base] & outside[indices[at + 2] + base]) === 0) {
          near.push(triangle);
        }
      }
      // Labels run in reverse order.
      const isReverse = draw.program.Label !== undefined;
      for (const triangle of isReverse ? near.reverse() : near) {
        const clip = cornersOf(capture, draw, pass.view, triangle);
        const fate = fateOf(clip, draw, viewport, square, pixel, capture.isReversed);
        const primitive = isReverse ? end - 1 - triangle : triangle - start;
        if (fate !== null) found.push({ pass: passIndex, draw: drawIndex, primitive, triangle, fate });
      }
    });
  });
  return found;
}
