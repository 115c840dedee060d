// The depth and stencil tests of one fragment (src/stencil_machine.rs): the stencil test first, then depth.

const COMPARE = {
  never: () => false, always: () => true,
  less: (a, b) => a < b, "less-equal": (a, b) => a <= b,
  equal: (a, b) => a === b, "not-equal": (a, b) => a !== b,
  greater: (a, b) => a > b, "greater-equal": (a, b) => a >= b,
};

const OPERATE = {
  keep: (stored) => stored, invert: (stored) => ~stored & 0xff,
  zero: () => 0, replace: (_, reference) => reference,
  "increment-clamp": (stored) => Math.min(stored + 1, 255), "increment-wrap": (stored) => (stored + 1) & 0xff,
  "decrement-clamp": (stored) => Math.max(stored - 1, 0), "decrement-wrap": (stored) => (stored - 1) & 0xff,
};

// Tests a fragment of a side of triangles against what is stored.
export function testFragment(raster, side, depth, stored) {
  const { compare, failOp, depthFailOp, passOp, reference, read, write } = side;
  const stencilPassed = COMPARE[compare](reference & read, stored.stencil & read);
  const depthPassed = stencilPassed ? COMPARE[raster.depth_compare](depth, stored.depth) : null;
  const operation = stencilPassed ? (depthPassed ? passOp : depthFailOp) : failOp;
  const stencil = (stored.stencil & ~write & 0xff) | (OPERATE[operation](stored.stencil, reference) & write);
  const after = { depth: depthPassed && raster.depth_write ? depth : stored.depth, stencil };
  return { stencilPassed, depthPassed, operation, after };
}
