// What is looked at: step, draw, view, pixel. It stands in the address's fragment, so a link goes to it.

export const VIEWS = ["auto", "color", "stencil", "count", "depth", "mask", "error", "map"];
export const PHASES = ["before", "after", "diff"];
export const look = { step: 0, draw: null, view: "auto", phase: "after", light: 0, face: 0, bit: null, range: null };
Object.assign(look, { pixel: null, texel: null, selected: null, hover: null });

const whole = (text, most) => (/^\d+$/.test(text) && Number(text) <= most ? Number(text) : null);

// Reads the fragment, or, where there is none, what the page was made to open at; what is not of this frame is left as it
// was at first.
export function readAddress(capture) {
  const words = new URLSearchParams(location.hash.slice(1) || capture.opens);
  const step = whole(words.get("step"), capture.steps.length);
  look.step = step ? step - 1 : 0;
  const draw = whole(words.get("draw"), capture.steps[look.step].draws.length);
  look.draw = draw && capture.hasDraws(look.step) ? draw - 1 : null;
  look.view = VIEWS.includes(words.get("view")) ? words.get("view") : "auto";
  look.phase = PHASES.includes(words.get("phase")) ? words.get("phase") : "after";
  look.light = Math.max(0, (whole(words.get("light"), capture.lights.length) ?? 1) - 1);
  look.face = capture.steps[look.step].after.face ?? 0;
  const [x, y] = (words.get("pixel") ?? "").split(",").map((side, at) => whole(side, capture.size[at] - 1));
  look.pixel = Number.isInteger(x) && Number.isInteger(y) ? [x, y] : null;
}

// The address of what is looked at in a live window (src/link.rs), where steps are counted from 0.
export function liveAddress({ live }) {
  return `${live}&step=${look.step}${look.pixel ? `&pixel=${look.pixel.join(",")}` : ""}`;
}

export function writeAddress() {
  const { pixel, step, draw, view, phase, light } = look;
  const words = { pixel, step: step + 1, draw: draw === null ? null : draw + 1, view };
  Object.assign(words, { phase: phase === "after" ? null : phase, light: light === 0 ? null : light + 1 });
  const told = Object.entries(words).filter(([, value]) => value !== null).map((pair) => pair.join("="));
  if (location.hash.slice(1) !== told.join("&")) history.replaceState(null, "", `#${told.join("&")}`);
}
