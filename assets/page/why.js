// Why a light does or does not arrive at a pixel, from what its history counts (src/history/why.rs).

import { BACKGROUND, FACES_AWAY } from "./capture.js";
import { countedBy, isOfVolume, passedAll, showsOutside, stepOf } from "./history.js";
import { amount, countInFloat, signed } from "./numbers.js";

const BIT_NAMES = ["one bit", "two bits", "three bits", "four bits", "five bits", "six bits", "seven bits", "eight bits"];
const PREPOSITIONS = { "in-front": "in front of", behind: "behind", "as-needed": "on either side of" };
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
  if (!last) return 0;
  return last.kind === "clear-stencil" ? last.after.stencil : Math.trunc(last.after.count);
}

// On which side of the surface a light's faces count; null where none tells.
export function countedSide(history, light) {
  const faces = history.events.filter((event) =>
    event.light === light && event.isFromCamera && isOfVolume(event) && event.triangle.kind === "tested");
  const seen = faces.map((event) => {
    const { triangle: { depth }, before } = event;
    return { counts: stepOf(event) !== 0, isBehind: history.isReversed ? depth <= before.depth : depth >= before.depth };
  });
  if (seen.length === 0) return null;
  const counting = (side) => seen.some(({ counts, isBehind }) => counts && isBehind === side);
  if (counting(false) && counting(true)) return "as-needed";
  if (counting(false)) return "in-front";
  return counting(true) || seen[0].isBehind ? "behind" : "in-front";
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
  const found = { casters: [], failedStencil: 0, failedDepth: 0, hidden: 0 };
  for (const { triangle } of events) {
    if (passedAll(triangle)) found.casters.push(triangle.caster ?? triangle.drawName);
    else if (triangle.kind !== "tested") found.hidden += 1;
    else found[triangle.stencilTest === "failed" ? "failedStencil" : "failedDepth"] += 1;
  }
  return { ...found, casters: [...new Set(found.casters)].sort(), isMarked: events[0].before.stencil !== 0 };
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

function holdOtherwise(bits, sum, byte) {
  const modulus = 2 ** bits;
  const least = bits === 8 ? -128 : 0;
  return ((sum % modulus) + modulus) % modulus === byte && (sum < least || sum >= modulus);
}

function verbOf({ count, side }, all) {
  const isOne = all === 1;
  if (count.inFloat) return isOne ? "is counted" : "are counted";
  if (side === "as-needed") return "count as their volumes need it";
  const verb = side === "behind" ? "fail" : "pass";
  return `${verb}${isOne ? (verb === "pass" ? "es" : "s") : ""} the depth test`;
}

function countedText(counted) {
  const { side, faces: { front, back, onSurface, stopped }, near, sum, bits, count } = counted;
  const minus = (value) => (value < 0 ? "−" : "");
  let text = counted.clearedTo === 0 ? "" : `the count begins at ${counted.clearedTo}; `;
  if (near !== null) text += `the near plane is in ${minus(near)}${amount(Math.abs(near), "volume")}; `;
  const all = front + back;
  const place = side === "behind" && onSurface > 0 ? "on or behind" : PREPOSITIONS[side];
  if (all === 0) text += "no volume face on the view ray counts";
  else {
    const sides = side === "behind" ? `${back} back, ${front} front` : `${front} front, ${back} back`;
    text += `${amount(all, "volume face")} ${place} the surface ${verbOf(counted, all)}: ${sides}`;
  }
  if (stopped > 0) text += `, of which ${stopped} found the count at its limit`;
  if (!count.inFloat && holdOtherwise(bits, sum, count.value)) {
    const verb = bits === 1 ? "holds" : "hold";
    return `${text}; together ${minus(sum)}${Math.abs(sum)}, which ${BIT_NAMES[bits - 1]} ${verb} as ${count.value}`;
  }
  return `${text}; count ${!count.inFloat && sum > 127 ? count.value : countText(count)}`;
}

function flattenedText({ casters, failedStencil, failedDepth, hidden, isMarked }) {
  if (casters.length > 0) return `the flattened shadow of ${casters.join(" and ")} falls on the surface here`;
  if (failedDepth > 0) {
    const verb = failedDepth === 1 ? "fails" : "fail";
    return `${amount(failedDepth, "flattened triangle")} over the surface ${verb} the depth test against it`;
  }
  if (failedStencil > 0) {
    const why = isMarked ? "of another receiver: this surface has a mark of its own"
      : "over the surface, which is no receiver";
    const verb = failedStencil === 1 ? "is" : "are";
    return `${amount(failedStencil, "flattened triangle")} ${verb} ${why}, and the stencil test keeps shadow off it`;
  }
  return `${amount(hidden, "flattened triangle")} over it left no fragment`;
}

export function whyText(why) {
  if (why.kind === "background") return "no surface is here that a shadow could fall on";
  if (why.kind === "counted") return `${countedText(why.counted)}, so ${LIGHT_PASS[why.pass]}`;
  const text = flattenedText(why.flattened);
  const darkens = why.flattened.casters.length > 0 && why.pass === "adds";
  return darkens ? `${text}, and darkens it after the light pass` : `${text}, so ${LIGHT_PASS[why.pass]}`;
}
