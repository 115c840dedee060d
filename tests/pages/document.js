(([x, y]) => {
  // A history of a page, as `pixel --json` prints it (src/history/json.rs).
  const began = performance.now();
  const { history } = stencilscope.capture.reader.ask({ pixel: [x, y] });
  return { ...history, milliseconds: performance.now() - began };
})
