// The view ray through a pixel with the volume faces on it, nearest first, and the count as it runs: from infinity
// towards the surface where faces behind it count, else from the eye (src/history/ladder.rs).

import { countedBy, isOfVolume } from "./history.js";
import { clearedTo, countedAt, countedSide } from "./why.js";

// Of a light; null where none of its faces is on the ray.
export function ladderOf(capture, history, light) {
  const ofLight = (event) => event.light === light && isOfVolume(event);
  const near = history.events.filter((event) => ofLight(event) && !event.isFromCamera);
  const faces = history.events.map((event, index) => ({ event, index })).filter(({ event }) => ofLight(event) && event.isFromCamera);
  const first = faces[0]?.event ?? near[0];
  if (!first) return null;
  const start = clearedTo(history, light) + near.reduce((sum, event) => sum + countedBy(event), 0);
  // In two passes every face is drawn twice, and counts in one of them: there it is a rung.
  const once = new Map();
  for (const { event, index } of faces) {
    const distance = capture.distance(event.triangle.depth);
    const isAhead = distance !== null && distance >= 0;
    const rung = { event: index, distance: isAhead ? distance : Infinity, added: countedBy(event), running: 0 };
    const place = event.triangle.draw * 2 ** 32 + event.triangle.primitive;
    if (!once.has(place) || (once.get(place).added === 0 && rung.added !== 0)) once.set(place, rung);
  }
  const inOrder = [...once].sort(([a], [b]) => a - b).map(([, rung]) => rung);
  const rungs = inOrder.sort((a, b) => (a.distance === b.distance ? 0 : a.distance - b.distance));
  const side = countedSide(history, light) ?? "in-front";
  let count = start;
  for (const rung of side === "behind" ? [...rungs].reverse() : rungs) rung.running = count += rung.added;
  const surface = capture.distance(first.before.depth);
  return { surface, side, start, count, tested: countedAt(history, light), rungs };
}
