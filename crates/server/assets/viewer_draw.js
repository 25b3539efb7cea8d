// Draw: the marks on the canvas, from the ground up: frames, plans, paths, loops, keyframes, anchors, places, the scale.

import { drawPlaces } from "./viewer_cameras.js";
import { classColour, sessionColour, theme } from "./viewer_colours.js";
import { Labels, isName, rankOf, textOf } from "./viewer_labels.js";
import { drawPicture } from "./viewer_picture.js";
import { drawPlans } from "./viewer_plans.js";
import { AXES, shifted } from "./viewer_scene.js";

const CROWD = 120;
const MANY_LOOPS = 60;

/** Draws everything that a `MapCanvas` shows; gives the boxes of its texts. */
export function drawScene(map) {
  const context = map.canvas.getContext("2d");
  const ratio = window.devicePixelRatio || 1;
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  context.clearRect(0, 0, map.size.width, map.size.height);
  context.lineJoin = context.lineCap = "round";
  const brush = { map, context, theme: theme(), labels: new Labels(context, map.size) };
  if (map.layout.framed) drawFrames(brush);
  drawPicture(brush);
  drawPlans(brush);
  drawPaths(brush);
  drawLoops(brush);
  drawKeyframes(brush);
  drawLines(brush);
  drawRings(brush);
  drawAnchors(brush);
  drawChanges(brush);
  drawPlaces(brush);
  drawScale(brush);
  return brush.labels.write();
}

function drawFrames({ map, context, theme, labels }) {
  context.font = "12px system-ui, sans-serif";
  context.textBaseline = "bottom";
  context.lineWidth = 1;
  for (const frame of map.layout.frames) {
    const box = shifted(frame);
    const [start, end] = [map.onScreen({ u: box.u0, v: box.v1 }), map.onScreen({ u: box.u1, v: box.v0 })];
    const [width, height] = [end.x - start.x, end.y - start.y];
    if (end.x < 0 || end.y < 0 || start.x > map.size.width || start.y > map.size.height) continue;
    context.fillStyle = theme.panel;
    context.strokeStyle = theme.line;
    context.beginPath();
    context.roundRect(start.x, start.y, width, height, 6);
    context.fill();
    context.stroke();
    const title = width > 30 ? fitted(context, frame.title, width) : "";
    context.fillStyle = theme.muted;
    context.fillText(title, start.x + 2, start.y - 2);
    if (title) labels.reserve(title, start.x + 2, start.y - 16, context.measureText(title).width, 14);
  }
}

function fitted(context, text, width) {
  if (context.measureText(text).width <= width) return text;
  let cut = text.length;
  while (cut > 1 && context.measureText(`${text.slice(0, cut)}…`).width > width) cut -= 1;
  return cut > 1 ? `${text.slice(0, cut)}…` : "";
}

function drawPaths({ map, context }) {
  context.lineWidth = 1.4;
  for (const [session, points] of map.bySession) {
    context.strokeStyle = sessionColour(session.index);
    context.beginPath();
    for (const point of points) {
      const { x, y } = map.onScreen(point);
      context.lineTo(x, y);
    }
    context.stroke();
  }
}

/** Wider than the paths, so that they are seen; one that contradicts the others is dashed. */
function drawLoops({ map, context, theme }) {
  for (const isSuspect of [false, true]) {
    context.strokeStyle = isSuspect ? theme.bad : theme.good;
    context.lineWidth = map.scene.loops.length > MANY_LOOPS && !isSuspect ? 2 : 3.5;
    context.setLineDash(isSuspect ? [9, 6] : []);
    context.beginPath();
    for (const { id, keyframe, candidate } of map.scene.loops) {
      if (map.scene.suspects.has(id) === isSuspect) segment(map, context, map.byId.get(keyframe), map.byId.get(candidate));
    }
    context.stroke();
  }
  context.setLineDash([]);
}

function segment(map, context, from, to) {
  if (!from || !to) return;
  const [a, b] = [map.onScreen(from), map.onScreen(to)];
  context.moveTo(a.x, a.y);
  context.lineTo(b.x, b.y);
}

/** A dot, and a line the way the camera looks: keyframes that turn on the spot are told apart by it. */
function drawKeyframes({ map, context }) {
  const { width, height } = map.size;
  const length = map.tickLength();
  const radius = length === 0 ? 1.6 : 2.6;
  for (const [session, points] of map.bySession) {
    context.fillStyle = context.strokeStyle = sessionColour(session.index);
    context.lineWidth = 1.3;
    const dots = new Path2D();
    const ticks = new Path2D();
    for (const point of points) {
      const { x, y } = map.onScreen(point);
      if (x < -20 || y < -20 || x > width + 20 || y > height + 20) continue;
      dots.rect(x - radius, y - radius, 2 * radius, 2 * radius);
      ticks.moveTo(x, y);
      ticks.lineTo(x + point.ahead[0] * length, y - point.ahead[1] * length);
    }
    if (length > 0) context.stroke(ticks);
    context.fill(dots);
  }
}

/** Lines of the selection: to the anchors around it with their distances, and to the candidates of a verdict. */
function drawLines({ map, context, theme, labels }) {
  for (const { from, to, tone, text, dashed } of map.marks.lines) {
    if (!from || !to) continue;
    context.strokeStyle = theme[tone];
    context.lineWidth = 1.6;
    context.setLineDash(dashed ? [3, 4] : []);
    context.beginPath();
    segment(map, context, from, to);
    context.stroke();
    if (!text) continue;
    const [a, b] = [map.onScreen(from), map.onScreen(to)];
    if (Math.hypot(a.x - b.x, a.y - b.y) > 24) {
      const middle = { x: (a.x + b.x) / 2, y: (a.y + b.y) / 2 };
      labels.beside(text, middle, 0, { rank: "figure", colour: theme[tone], halo: theme.ground, centred: true });
    }
  }
  context.setLineDash([]);
}

function drawRings({ map, context, theme, labels }) {
  const ring = (point, tone, radius, width) => {
    const { x, y } = map.onScreen(point);
    context.strokeStyle = theme[tone];
    context.lineWidth = width;
    context.beginPath();
    context.arc(x, y, radius, 0, 2 * Math.PI);
    context.stroke();
  };
  for (const [id, tone] of map.marks.rings) {
    const point = map.byId.get(id);
    if (point) ring(point, tone, 5.5, 1.8);
  }
  const selected = map.byId.get(map.marks.keyframe);
  if (!selected) return;
  const { x, y } = map.onScreen(selected);
  // Of all that stand on one spot, this is where the selected one looks.
  context.strokeStyle = theme.accent;
  context.lineWidth = 3;
  context.beginPath();
  context.moveTo(x, y);
  context.lineTo(x + selected.ahead[0] * 20, y - selected.ahead[1] * 20);
  context.stroke();
  ring(selected, "accent", 8, 3);
  labels.beside(selected.id, { x, y }, 14, { rank: "selected", colour: theme.accent, halo: theme.ground, bold: true });
}

function drawAnchors({ map, context, theme, labels }) {
  const { marks: { anchor: selected, found, changes }, size: { width, height }, scene } = map;
  const classes = new Map(scene.classes.map(({ name, index }) => [name, index]));
  const rank = ({ id, anchor }) => (id === selected ? 0 : found?.has(id) ? 1 : anchor.state === "valid" ? 2 : 3);
  const points = map.anchors.filter((point) => !point.plan).sort((a, b) => rank(a) - rank(b));
  const shown = [];
  for (const point of points) {
    const at = map.onScreen(point);
    if (at.x > -20 && at.y > -20 && at.x < width + 20 && at.y < height + 20) shown.push({ point, at });
  }
  const size = shown.length > CROWD ? 4 : 5.5;
  // The least important first, so that the others lie on top of it.
  for (const { point, at } of shown.toReversed()) {
    const { id, anchor } = point;
    context.globalAlpha = found && !found.has(id) && id !== selected ? 0.25 : 1;
    diamond(context, theme, at, classColour(classes.get(anchor.class)), anchor.state, id === selected, size, point.assumed);
  }
  context.globalAlpha = 1;
  for (const { point: { id, anchor }, at } of shown) {
    if (isName(anchor)) labels.keepFree(at.x - size, at.y - size, 2 * size, 2 * size);
    const change = changes?.anchors.get(id);
    const marked = id === selected || found?.has(id) || change;
    if (!marked && (!map.labels || found)) continue;
    const rank = id === selected ? "selected" : marked ? "marked" : rankOf(anchor);
    labels.beside(textOf(anchor), at, change ? 13 : 9, { rank, colour: theme[change?.tone ?? "text"], halo: theme.ground, bold: marked });
  }
}

/** What a comparison found: a ring around what is new or other than before, a cross through a sign that hangs there no longer. */
function drawChanges({ map, context, theme }) {
  const { changes } = map.marks;
  if (!changes) return;
  const ring = ({ x, y }, tone, radius) => {
    context.strokeStyle = theme[tone];
    context.lineWidth = 2;
    context.beginPath();
    context.arc(x, y, radius, 0, 2 * Math.PI);
    context.stroke();
  };
  for (const [id, tone] of changes.keyframes) {
    const point = map.byId.get(id);
    if (point) ring(map.onScreen(point), tone, 6.5);
  }
  for (const point of map.anchors) {
    const change = changes.anchors.get(point.id);
    if (!change) continue;
    const at = map.onScreen(point);
    if (change.isCrossed) cross(context, at, theme);
    else ring(at, change.tone, 9);
  }
}

function cross(context, { x, y }, theme) {
  const arm = 7;
  for (const [colour, width] of [[theme.ground, 6], [theme.bad, 3]]) {
    context.strokeStyle = colour;
    context.lineWidth = width;
    context.beginPath();
    for (const way of [1, -1]) {
      context.moveTo(x - arm, y - way * arm);
      context.lineTo(x + arm, y + way * arm);
    }
    context.stroke();
  }
}

/** Filled: described. Hollow: not described yet. Small: says too little to be matched. Small and hollow: retired. */
/** A sign; one whose distance nobody measured is drawn with a broken line, as loops and places that are unsure are. */
function diamond(context, theme, { x, y }, colour, state, selected, size, assumed) {
  const [isSmall, isHollow] = [["uninformative", "retired"], ["pending", "retired"]].map((states) => states.includes(state));
  const radius = (isSmall ? 0.65 : 1) * size + (selected ? 2 : 0);
  context.beginPath();
  context.moveTo(x, y - radius);
  context.lineTo(x + radius, y);
  context.lineTo(x, y + radius);
  context.lineTo(x - radius, y);
  context.closePath();
  context.fillStyle = isHollow ? theme.ground : colour;
  context.fill();
  context.strokeStyle = selected ? theme.accent : isHollow || assumed ? colour : theme.ground;
  context.lineWidth = selected ? 3 : isHollow ? 2 : 1;
  if (assumed) {
    // Around the sign, so that what is hollow stays so.
    context.stroke();
    context.beginPath();
    context.arc(x, y, radius + 3, 0, 2 * Math.PI);
    context.setLineDash([2, 3]);
    context.lineWidth = 1.2;
  }
  context.stroke();
  context.setLineDash([]);
}

/** A bar of a round length, and which axes the page shows. */
function drawScale({ map, context, theme, labels }) {
  const { width, height } = map.size;
  const about = 110 / map.view.scale;
  const step = 10 ** Math.floor(Math.log10(about));
  const length = [5, 2, 1].map((n) => n * step).find((n) => n <= about) ?? step;
  const [x, y] = [width - 16, height - 16];
  context.strokeStyle = context.fillStyle = theme.muted;
  context.lineWidth = 1.5;
  context.beginPath();
  context.moveTo(x - length * map.view.scale, y - 5);
  context.lineTo(x - length * map.view.scale, y);
  context.lineTo(x, y);
  context.lineTo(x, y - 5);
  context.stroke();
  context.font = "12px system-ui, sans-serif";
  context.textBaseline = "bottom";
  const [right, up] = map.layout.plane.map((axis) => AXES[axis]);
  const text = `${right} →  ${up} ↑   ${metric(length)}`;
  const across = context.measureText(text).width;
  context.fillText(text, x - across, y - 8);
  labels.reserve(text, x - Math.max(across, length * map.view.scale), y - 22, Math.max(across, length * map.view.scale), 24);
}

function metric(metres) {
  if (metres >= 1000) return `${metres / 1000} km`;
  if (metres < 0.01) return `${Number((metres * 1000).toPrecision(1))} mm`;
  return `${Number(metres.toPrecision(1))} m`;
}
