// The depth and stencil tests of one fragment (src/stencil_machine.rs): the stencil test first, then depth.

const COMPARE = {
  never: () => false,
  less: (a, b) => a < b,
  equal: (a, b) => a === b,
  "less-equal": (a, b) => a <= b,
  greater: (a, b) => a > b,
  "not-equal": (a, b) => a !== b,
  "greater-equal": (a, b) => a >= b,
  always: () => true,
};

const OPERATE = {
  keep: (stored) => stored,
  zero: () => 0,
  replace: (_, reference) => reference,
  invert: (stored) => ~stored & 0xff,
  "increment-clamp": (stored) => Math.min(stored + 1, 255),
  "decrement-clamp": (stored) => Math.max(stored - 1, 0),
  "increment-wrap": (stored) => (stored + 1) & 0xff,
  "decrement-wrap": (stored) => (stored - 1) & 0xff,
};

// Tests and operations of a side of triangles, with its reference and masks (plan/raster.rs).
export function faceOf(raster, isFront) {
  const { front, back, read_mask: read, write_mask: write } = raster.stencil;
  const masks = { reference: raster.stencil_reference, read: read & 0xff, write: write & 0xff };
  return isFront ? { face: front, masks } : { face: back, masks: raster.back ?? masks };
}

export function isStencilEnabled({ stencil: { front, back, read_mask: read, write_mask: write } }) {
  const ignores = ({ compare, failOp, depthFailOp, passOp }) =>
    compare === "always" && [failOp, depthFailOp, passOp].every((operation) => operation === "keep");
  return !(ignores(front) && ignores(back)) && (read !== 0 || write !== 0);
}

export function testFragment(raster, { depth, isFront }, stored) {
  const { face, masks: { reference, read, write } } = faceOf(raster, isFront);
  const stencilPassed = COMPARE[face.compare](reference & read, stored.stencil & read);
  const depthPassed = stencilPassed ? COMPARE[raster.depth_compare](depth, stored.depth) : null;
  const operation = [[null, face.failOp], [false, face.depthFailOp], [true, face.passOp]]
    .find(([passed]) => passed === depthPassed)[1];
  const stencil = (stored.stencil & ~write & 0xff) | (OPERATE[operation](stored.stencil, reference) & write);
  const storesDepth = depthPassed === true && raster.depth_write;
  return { stencilPassed, depthPassed, operation, after: { depth: storesDepth ? depth : stored.depth, stencil } };
}
