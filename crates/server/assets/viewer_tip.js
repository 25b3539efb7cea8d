// Tip: what is under the pointer, in a few words beside it.

import { inBrief } from "./viewer_legend.js";
import { fill } from "./dom.js";

/** Shows what was hit at a point of the canvas, or hides the tip (`hit` is null). */
export function showTip(tip, hit, { x, y }, scene, { width, height }) {
  tip.hidden = hit === null;
  if (hit === null) return;
  fill(tip, inBrief(hit, scene));
  const left = x + 14 + tip.offsetWidth > width ? x - 10 - tip.offsetWidth : x + 14;
  const top = y + 14 + tip.offsetHeight > height ? y - 10 - tip.offsetHeight : y + 14;
  tip.style.transform = `translate(${Math.max(left, 2)}px, ${Math.max(top, 2)}px)`;
}
