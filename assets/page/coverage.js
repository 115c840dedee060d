// Which triangles lie over a pixel, and how deep (src/plan/coverage.rs): a sieve of four planes through the eye, then
// the triangle itself. Where the window's corners say which pixels are covered, they are rounded to 1/256 of a pixel
// with the top-left rule, as GPUs do; a triangle that is clipped is looked at unrounded.

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

function isClipped(clip, isUnclipped) {
  return clip.some(([, , z, w]) => !(w > 0) || (!isUnclipped && (z < 0 || z > w)));
}

// Corners in the window, rounded as the GPU's floats are.
function windowCorners(clip, { area: [left, top, width, height] }) {
  const [scaleX, scaleY] = [f32(width / 2), f32(-height / 2)];
  return clip.map(([x, y, z, w]) => {
    const inverse = f32(1 / w);
    return [
      f32(f32(f32(x * inverse) * scaleX) + f32(left + width / 2)),
      f32(f32(f32(y * inverse) * scaleY) + f32(top + height / 2)),
      f32(z * inverse),
    ];
  });
}

function rounded(value) {
  const low = Math.floor(value);
  const above = value - low;
  return above > 0.5 || (above === 0.5 && low % 2 !== 0) ? low + 1 : low;
}

// Does a triangle that is not clipped cover a pixel's centre? Rows count downwards.
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
  return { isCovered: isLeftOf(a, b) && isLeftOf(b, c) && isLeftOf(c, a), isCounterclockwise: area < 0 };
}

// What a draw's depth bias adds, where depths are floats: steps of the largest depth's exponent, and of the slope.
function biasOf({ constant, slope_scale: slope, clamp }, corners) {
  if (constant === 0 && slope === 0) return 0;
  const [[ax, ay, az], [bx, by, bz], [cx, cy, cz]] = corners;
  const area = (bx - ax) * (cy - ay) - (cx - ax) * (by - ay);
  const alongX = ((bz - az) * (cy - ay) - (cz - az) * (by - ay)) / area;
  const alongY = ((cz - az) * (bx - ax) - (bz - az) * (cx - ax)) / area;
  const largest = Math.max(Math.abs(az), Math.abs(bz), Math.abs(cz));
  const step = largest > 0 ? 2 ** (Math.floor(Math.log2(largest)) - 23) : 0;
  const bias = constant * step + slope * Math.max(Math.abs(alongX), Math.abs(alongY));
  if (clamp > 0) return Math.min(bias, clamp);
  return clamp < 0 ? Math.max(bias, clamp) : bias;
}

const isCulledFace = (cull, isFront) => cull !== null && (cull === "front") === isFront;

// What becomes of a triangle at a pixel: a fragment, or why there is none; null where it is elsewhere.
function fateOf(clip, { raster }, viewport, square, pixel, isReversed) {
  const seen = lie(clip, square);
  if (seen === null) return null;
  const isUnclipped = raster.unclipped_depth;
  const needsClip = isClipped(clip, isUnclipped);
  const corners = windowCorners(clip, viewport);
  const raster2d = needsClip ? null : covers(corners, pixel);
  const stored = (depth) => viewport.depth[0] + (viewport.depth[1] - viewport.depth[0]) * depth;
  const runs = raster2d ?? seen;
  const isFront = runs.isCounterclockwise === (raster.front_face === "ccw");
  const face = { isFront, depth: f32(stored(seen.depth)) };
  const outside = isUnclipped ? null
    : seen.depth < -SAFE_DEPTH ? (isReversed ? "far" : "near")
      : seen.depth > 1 + SAFE_DEPTH ? (isReversed ? "near" : "far") : null;
  const isSure = seen.isInside && seen.isSafe;
  if (isSure && outside !== null) return { ...face, kind: "clipped", clip: outside };
  if (isCulledFace(raster.cull, isFront)) return isSure ? { ...face, kind: "culled" } : null;
  const isInRange = isUnclipped || (seen.depth >= 0 && seen.depth <= 1);
  const isCovered = needsClip ? seen.isInside && isInRange : raster2d !== null && raster2d.isCovered;
  if (!isCovered) return null;
  const depth = f32(stored(seen.depth) + biasOf(raster.depth_bias, corners));
  return { isFront, depth, kind: "fragment" };
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
