// Plans: the signs of floor plans on the canvas, quietly beneath what robots have seen.

import { shifted, moved } from "./viewer_scene.js";
import { textOf } from "./viewer_labels.js";

const DIMMED = 0.25;
/** Wide enough to frame the diamond of an anchor that hangs there. */
const SIDE_PX = 14;

/** The signs of the plans that a layout shows, as points that can be picked. A session's own frame shows those inside it only. */
export function planPoints({ beneath, frames, framed, plane: [u, v] }) {
  const points = [];
  for (const { plan, placed, group: { session, du, dv } } of beneath) {
    const frame = framed && frames.find(({ members }) => members.includes(session));
    const isShown = frame ? within(shifted(frame)) : () => true;
    for (const { anchor, place } of plan.anchors) {
      const at = moved(placed, place);
      const point = { kind: "anchor", id: anchor.id, u: at[u] + du, v: at[v] + dv, anchor, session, plan: plan.name };
      if (isShown(point)) points.push(point);
    }
  }
  return points;
}

function within({ u0, u1, v0, v1 }) {
  return ({ u, v }) => u >= u0 && u <= u1 && v >= v0 && v <= v1;
}

/** Small hollow squares with their texts. */
export function drawPlans({ map, context, theme, labels }) {
  const { size: { width, height }, marks: { anchor: selected, found } } = map;
  for (const { id, anchor, ...point } of map.anchors.filter(({ plan }) => plan)) {
    const { x, y } = map.onScreen(point);
    if (x < -20 || y < -20 || x > width + 20 || y > height + 20) continue;
    const [isSelected, isFound] = [id === selected, Boolean(found?.has(id))];
    const side = isSelected ? SIDE_PX + 4 : SIDE_PX;
    context.strokeStyle = isSelected ? theme.accent : theme["strong-line"];
    context.lineWidth = isSelected ? 3 : 2;
    context.globalAlpha = found && !isFound && !isSelected ? DIMMED : 1;
    context.strokeRect(x - side / 2, y - side / 2, side, side);
    context.globalAlpha = 1;
    if (!isSelected && !isFound && (!map.labels || found)) continue;
    const rank = isSelected ? "selected" : isFound ? "marked" : "plan";
    const colour = isSelected || isFound ? theme.text : theme.muted;
    labels.beside(textOf(anchor), { x, y }, 11, { rank, colour, halo: theme.ground, bold: isSelected || isFound });
  }
}
