// What is looked at: step, draw, view, pixel. It stands in the address's fragment, so a link goes to it.

export const VIEWS = ["auto", "color", "stencil", "count", "depth", "mask", "error", "map"];
export const PHASES = ["before", "after", "diff"];

export const look = {
  step: 0, draw: null, view: "auto", phase: "after", light: 0, face: 0, bit: null, pixel: null, range: null,
  selected: null, hover: null,
};

const whole = (text, most) => {
  const value = Number(text);
  return text !== null && /^\d+$/.test(text) && value <= most ? value : null;
};

// Reads the fragment; what is not of this frame is left as it was at first.
export function readAddress(capture) {
  const words = new URLSearchParams(location.hash.slice(1));
  const step = whole(words.get("step"), capture.steps.length);
  look.step = step ? step - 1 : 0;
  const draw = whole(words.get("draw"), capture.steps[look.step].draws.length);
  look.draw = draw && capture.hasDraws(look.step) ? draw - 1 : null;
  look.view = VIEWS.includes(words.get("view")) ? words.get("view") : "auto";
  look.phase = PHASES.includes(words.get("phase")) ? words.get("phase") : "after";
  const light = whole(words.get("light"), capture.lights.length);
  look.light = light ? light - 1 : 0;
  const [x, y] = (words.get("pixel") ?? "").split(",").map((side, at) => whole(side, capture.size[at] - 1));
  look.pixel = Number.isInteger(x) && Number.isInteger(y) ? [x, y] : null;
}

export function writeAddress() {
  const words = [];
  if (look.pixel) words.push(`pixel=${look.pixel}`);
  words.push(`step=${look.step + 1}`);
  if (look.draw !== null) words.push(`draw=${look.draw + 1}`);
  words.push(`view=${look.view}`);
  if (look.phase !== "after") words.push(`phase=${look.phase}`);
  if (look.light) words.push(`light=${look.light + 1}`);
  if (location.hash.slice(1) !== words.join("&")) history.replaceState(null, "", `#${words.join("&")}`);
}
