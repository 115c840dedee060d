// Why a light does or does not arrive at a pixel, from what its history counts (src/history/why.rs).

import { BACKGROUND, FACES_AWAY } from "./capture.js";
import { countedBy, isOfVolume, passedAll, showsOutside, stepOf } from "./history.js";
import { amount, countInFloat, signed } from "./numbers.js";

const BIT_NAMES = ["one bit", "two bits", "three bits", "four bits", "five bits", "six bits", "seven bits", "eight bits"];
const PLACES = { "in-front": "in front of", behind: "behind", "as-needed": "on either side of" };
const LIGHT_PASS = {
  adds: "the light pass adds the light",
  skips: "the light pass skips it",
  "faces-away": "the light pass lets it through; but it faces away from the light or is beyond its range, and stays dark",
  "asks-nothing": "it would be lit only at 0; but the object receives no shadows, and the light pass adds the light",
};

// What a light's count was cleared to.
export function clearedTo(history, light) {
  const clears = history.events.filter((event) => event.light === light && event.kind.startsWith("clear-"));
  const last = clears.filter(({ kind }) => kind !== "clear-depth").pop();
  return last?.kind === "clear-stencil" ? last.after.stencil : Math.trunc(last?.after.count ?? 0);
}

// On which side of the surface a light's faces count; null where none tells.
export function countedSide(history, light) {
  const isFace = (event) => event.light === light && event.isFromCamera && isOfVolume(event) && event.triangle.kind === "tested";
  const faces = history.events.filter(isFace);
  if (faces.length === 0) return null;
  const isBehind = ({ triangle: { depth }, before }) => (history.isReversed ? depth <= before.depth : depth >= before.depth);
  const counting = faces.filter((event) => stepOf(event) !== 0);
  if (counting.some(isBehind) && !counting.every(isBehind)) return "as-needed";
  return isBehind(counting[0] ?? faces[0]) ? "behind" : "in-front";
}

// The count of a light as its light pass tests it.
export function countedAt(history, light) {
  const inFloat = history.events.some(({ kind }) => kind === "clear-count");
  const ofLight = history.events.filter((event) => event.light === light);
  const last = ofLight.filter(isOfVolume).pop();
  const tested = ofLight.find(({ triangle }) => triangle && triangle.lights !== null);
  const held = last?.after ?? tested?.before ?? history.computed;
  return { inFloat, value: inFloat ? held.count : held.stencil };
}

export const countText = ({ inFloat, value }) => (inFloat ? countInFloat(value) : signed(value));

function countedFaces(history, light, bits) {
  const ofLight = history.events.filter((event) => event.light === light && isOfVolume(event));
  const faces = { front: 0, back: 0, onSurface: 0, stopped: 0 };
  for (const event of ofLight.filter((one) => one.isFromCamera && stepOf(one) !== 0)) {
    faces[showsOutside(event.triangle) ? "front" : "back"] += 1;
    if (event.triangle.depth === event.before.depth) faces.onSurface += 1;
    if (countedBy(event) === 0) faces.stopped += 1;
  }
  const total = (events) => events.reduce((sum, event) => sum + countedBy(event), 0);
  const near = ofLight.filter((event) => !event.isFromCamera);
  const start = clearedTo(history, light);
  return {
    side: countedSide(history, light) ?? "in-front", faces, clearedTo: start,
    near: near.length > 0 ? total(near) : null, sum: start + total(ofLight), bits, count: countedAt(history, light),
  };
}

function flattenedOf(events) {
  const found = { passed: [], stencil: 0, depth: 0, hidden: 0, isMarked: events[0].before.stencil !== 0 };
  for (const { triangle } of events) {
    if (passedAll(triangle)) found.passed.push(triangle.caster ?? triangle.drawName);
    else found[triangle.kind !== "tested" ? "hidden" : triangle.stencilTest === "failed" ? "stencil" : "depth"] += 1;
  }
  return { ...found, casters: [...new Set(found.passed)].sort() };
}

function lightPass(history, light, counted) {
  const lit = history.events.find(({ light: of, triangle, target }) =>
    of === light && triangle && triangle.lights !== null && target === "picture" && passedAll(triangle));
  if (!lit) return "skips";
  const { lights, operation } = lit.triangle;
  if (lights === "Count") return counted?.count.inFloat && counted.count.value !== 0 ? "skips" : "adds";
  return lights === "Everywhere" && operation === null && counted ? "asks-nothing" : "adds";
}

// What decided about a light; null where the technique leaves no events that tell.
export function whyOf(history, light) {
  const flattened = history.events.filter(({ light: of, target, triangle }) =>
    of === light && target !== "labels" && triangle?.part === "planar-shadow");
  const bits = history.countsIn[light];
  if (bits === null && flattened.length === 0) return null;
  const label = history.labels[light];
  if (label === BACKGROUND) return { kind: "background" };
  const counted = bits === null ? null : countedFaces(history, light, bits);
  const did = lightPass(history, light, counted);
  const pass = did === "adds" && label === FACES_AWAY ? "faces-away" : did;
  return counted ? { kind: "counted", counted, pass } : { kind: "flattened", flattened: flattenedOf(flattened), pass };
}

// Do bits hold a sum as this byte although it is another number? Of eight bits, the upper half reads as negative.
const holdOtherwise = (bits, sum, byte) => (sum & (2 ** bits - 1)) === byte && (sum < (bits === 8 ? -128 : 0) || sum >= 2 ** bits);

function verbOf({ count, side }, isOne) {
  if (count.inFloat) return isOne ? "is counted" : "are counted";
  if (side === "as-needed") return "count as their volumes need it";
  const [one, many] = side === "behind" ? ["fails", "fail"] : ["passes", "pass"];
  return `${isOne ? one : many} the depth test`;
}

const signedAmount = (value) => `${value < 0 ? "−" : ""}${Math.abs(value)}`;

function countedText(counted) {
  const { side, faces: { front, back, onSurface, stopped }, near, sum, bits, count, clearedTo: start } = counted;
  const volumes = near === 1 || near === -1 ? "volume" : "volumes";
  const begins = start === 0 ? "" : `the count begins at ${start}; `;
  const inNear = near === null ? "" : `the near plane is in ${signedAmount(near)} ${volumes}; `;
  const place = side === "behind" && onSurface > 0 ? "on or behind" : PLACES[side];
  const sides = side === "behind" ? `${back} back, ${front} front` : `${front} front, ${back} back`;
  const faces = front + back === 0 ? "no volume face on the view ray counts"
    : `${amount(front + back, "volume face")} ${place} the surface ${verbOf(counted, front + back === 1)}: ${sides}`;
  const lost = stopped > 0 ? `, of which ${stopped} found the count at its limit` : "";
  const held = `which ${BIT_NAMES[bits - 1]} ${bits === 1 ? "holds" : "hold"} as ${count.value}`;
  const left = !count.inFloat && holdOtherwise(bits, sum, count.value) ? `together ${signedAmount(sum)}, ${held}`
    : `count ${!count.inFloat && sum > 127 ? count.value : countText(count)}`;
  return `${begins}${inNear}${faces}${lost}; ${left}`;
}

function flattenedText({ casters, stencil, depth, hidden, isMarked }) {
  if (casters.length > 0) return `the flattened shadow of ${casters.join(" and ")} falls on the surface here`;
  const triangles = (number) => amount(number, "flattened triangle");
  if (depth > 0) return `${triangles(depth)} over the surface ${depth === 1 ? "fails" : "fail"} the depth test against it`;
  if (stencil === 0) return `${triangles(hidden)} over it left no fragment`;
  const why = isMarked ? "of another receiver: this surface has a mark of its own" : "over the surface, which is no receiver";
  return `${triangles(stencil)} ${stencil === 1 ? "is" : "are"} ${why}, and the stencil test keeps shadow off it`;
}

export function whyText({ kind, counted, flattened, pass }) {
  if (kind === "background") return "no surface is here that a shadow could fall on";
  if (kind === "counted") return `${countedText(counted)}, so ${LIGHT_PASS[pass]}`;
  const darkens = flattened.casters.length > 0 && pass === "adds";
  return `${flattenedText(flattened)}, ${darkens ? "and darkens it after the light pass" : `so ${LIGHT_PASS[pass]}`}`;
}
