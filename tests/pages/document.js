(([x, y]) => {
  // A history of a page as `pixel --json` prints it (src/history/json.rs).

  const NAMES = {
    put: "other content", "clear-depth": "clear depth", "clear-stencil": "clear stencil", "clear-count": "clear count",
  };

  const NOTES = {
    culled: () => "culled: the draw shows only the other side of triangles",
    clipped: (clip) => `clipped: it is ${clip === "near" ? "nearer than the near plane" : "beyond the far plane"}`,
    discarded: (clip) =>
      `discarded by the shader: it is ${clip === "near" ? "nearer than the near plane" : "beyond the far plane"}`,
  };

  const WORDS_OF_TESTS = { passed: "pass", always: "pass", failed: "fail", "not-reached": null };

  // Why a triangle left no fragment; null where it did.
  function noteOf({ kind, clip }) {
    return NOTES[kind]?.(clip) ?? null;
  }

  function entryOf(history, event) {
    const one = event.triangle;
    const counts = event.before.count !== event.after.count || event.kind === "clear-count";
    const stencil = (value) => (history.hasStencil ? value : null);
    return {
      pass: event.pass,
      draw: one?.draw ?? null,
      name: NAMES[event.kind] ?? event.passName,
      light: event.light,
      caster: one?.caster ?? null,
      part: one?.part ?? null,
      primitive: one?.primitive ?? null,
      triangle: one?.triangle ?? null,
      front_facing: one?.isFront ?? null,
      depth: one?.depth ?? null,
      depth_test: one?.kind === "tested" ? WORDS_OF_TESTS[one.depthTest] : null,
      stencil_test: one?.operation ? WORDS_OF_TESTS[one.stencilTest] : null,
      operation: one?.operation ?? null,
      stencil_before: stencil(event.before.stencil),
      stencil_after: stencil(event.after.stencil),
      depth_before: event.before.depth,
      depth_after: event.after.depth,
      ...(counts ? { count_before: event.before.count, count_after: event.after.count } : {}),
      note: one ? noteOf(one) : null,
    };
  }

  const began = performance.now();
  const history = stencilscope.historyOf(stencilscope.capture, [x, y]);
  const milliseconds = performance.now() - began;
  const stored = ({ stencil, depth }) => ({ stencil: history.hasStencil ? stencil : null, depth });
  return {
    pixel: history.pixel,
    events: history.events.map((event) => entryOf(history, event)),
    final: stored(history.computed),
    captured: history.captured && stored(history.captured),
    agrees: history.disagreements.length === 0,
    why: history.labels.map((_, light) => {
      const why = stencilscope.whyOf(history, light);
      return why && stencilscope.whyText(why);
    }),
    milliseconds,
  };
})
