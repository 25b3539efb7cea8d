// Views: two local anchor maps side by side, each from above as its camera sees it, and lines between what belongs together.

import { theme } from "./viewer_colours.js";
import { Labels, isName, rankOf, textOf } from "./viewer_labels.js";
import { unpaired } from "./viewer_pairs.js";
import { svg } from "./dom.js";

const RADIUS = 150;
const MARK = 9;
const HEAD = 34;
/** By how much the lines of two pairs are bent apart: anchors in a row would have them on one another. */
const BOW = 18;
const SIDES = ["query", "candidate"];
/** Where the two stand on the sheet: beside each other, or one above the other where the page is narrow. */
const WIDE = { width: 760, height: 360, centres: [[180, 196], [580, 196]] };
const NARROW = { width: 350, height: 720, centres: [[175, 196], [175, 550]] };

/** The drawing. `maps` are the two local maps (null: none is stored), `names` their keyframes, `pairs` as `pairsOf` gives them. */
export function twoViews(maps, names, pairs, isNarrow) {
  const { width, height, centres } = isNarrow ? NARROW : WIDE;
  const colours = theme();
  const metres = reach(maps, pairs);
  const labels = new Labels(document.createElement("canvas").getContext("2d"), { width, height });
  const place = (side, anchor) => onSheet(centres[side], anchor, metres);
  const sheet = svg("svg", {
    viewBox: `0 0 ${width} ${height}`, class: isNarrow ? "views narrow" : "views", role: "img",
    "aria-label": "The anchors around both keyframes as seen from above by their cameras. The list below holds the same.",
  });
  centres.forEach((centre, side) => sheet.append(ground(centre, names[side], maps[side], metres, colours, labels)));
  const tied = pairs.filter(({ query, candidate }) => query && candidate);
  tied.forEach((pair, index) => sheet.append(...tie(pair, place, colours, (index - (tied.length - 1) / 2) * BOW)));
  centres.forEach(([x, y], side) => sheet.append(svg("text", {
    x, y: y - RADIUS - 18, fill: colours.text, stroke: colours.ground, "text-anchor": "middle", class: "head name",
  }, names[side])));
  SIDES.forEach((side, index) => {
    for (const anchor of unpaired(maps[index], pairs, side)) sheet.append(loneMark(place(index, anchor), anchor, colours, labels));
    for (const pair of pairs.filter((one) => one[side])) sheet.append(pairMark(place(index, pair[side]), pair, side, colours, labels));
  });
  for (const { text, left, top, colour, bold } of labels.arrange()) {
    sheet.append(svg("text", { x: left, y: top + 11, fill: colour, stroke: colours.ground, class: bold ? "name strong" : "name" }, text));
  }
  return sheet;
}

/** How far the rim is, in metres: what is paired lies inside, and what is much farther is drawn at the rim. */
function reach(maps, pairs) {
  const paired = pairs.flatMap(({ query, candidate }) => [query, candidate]).filter(Boolean);
  const all = paired.length > 0 ? paired : maps.flatMap((map) => [...(map?.values() ?? [])]);
  return Math.max(1, ...all.map(({ distance_m: metres }) => metres)) * 1.15;
}

/** Ahead is up, and right is right; what lies beyond the rim is drawn at it. */
function onSheet([x, y], { bearing: [right, , ahead], distance_m: metres }, rim) {
  const turn = Math.atan2(right, ahead);
  const out = Math.min(metres / rim, 1) * RADIUS;
  return { x: x + out * Math.sin(turn), y: y - out * Math.cos(turn), isBeyond: metres > rim };
}

function ground([x, y], name, map, metres, colours, labels) {
  const { ground: paper, panel, line, muted, text } = colours;
  const parts = [svg("circle", { cx: x, cy: y, r: RADIUS, fill: panel, stroke: line })];
  const step = ringStep(metres);
  for (let ring = step; ring < metres && map; ring += step) {
    parts.push(svg("circle", { cx: x, cy: y, r: (ring / metres) * RADIUS, fill: "none", stroke: line }));
    const label = `${Number(ring.toPrecision(3))} m`;
    parts.push(svg("text", { x, y: y + (ring / metres) * RADIUS - 3, fill: muted, "text-anchor": "middle", class: "ring" }, label));
    labels.reserve(label, x - 16, y + (ring / metres) * RADIUS - 14, 32, 13);
  }
  labels.reserve(name, x - RADIUS, y - RADIUS - HEAD, 2 * RADIUS, HEAD - 6);
  if (map) {
    parts.push(svg("path", { d: `M ${x} ${y - 11} l 7 16 l -7 -4 l -7 4 z`, fill: text, stroke: paper }));
    labels.reserve("camera", x - 8, y - 12, 16, 18);
  } else {
    const line = (text, down) => svg("text", { x, y: y + down, fill: muted, "text-anchor": "middle", class: "ring" }, text);
    parts.push(line("This keyframe was asked about", 0), line("and not stored.", 16));
  }
  return svg("g", {}, ...parts);
}

/** One, two or five times a power of ten, so that there are two to five rings. */
function ringStep(metres) {
  const power = 10 ** Math.floor(Math.log10(metres / 2));
  return [5, 2, 1].map((times) => times * power).find((step) => step <= metres / 2) ?? power;
}

/** A line from one view to the other; in the second view, where the anchor would be if the two were one place. */
function tie({ query, candidate, colour, kind }, place, { ground: paper }, bow) {
  const [from, to, ghost] = [place(0, query), place(1, candidate), place(1, query)];
  const dashes = { agrees: null, contradicts: "7 4", differs: "2 4", elsewhere: "2 4" }[kind];
  const length = Math.max(Math.hypot(to.x - from.x, to.y - from.y), 1);
  const [bendX, bendY] = [(from.x + to.x) / 2 - (bow * (to.y - from.y)) / length, (from.y + to.y) / 2 + (bow * (to.x - from.x)) / length];
  const line = svg("path", {
    d: `M ${from.x} ${from.y} Q ${bendX} ${bendY} ${to.x} ${to.y}`, fill: "none", stroke: colour, "stroke-dasharray": dashes, class: "tie",
  });
  if (Math.hypot(ghost.x - to.x, ghost.y - to.y) < MARK) return [line];
  return [line, svg("line", { x1: ghost.x, y1: ghost.y, x2: to.x, y2: to.y, stroke: colour, class: "off" }),
    svg("circle", { cx: ghost.x, cy: ghost.y, r: MARK - 2, fill: paper, stroke: colour, "stroke-dasharray": "2 2", class: "ghost" })];
}

function pairMark({ x, y, isBeyond }, { number, colour, kind, ...pair }, side, { ground: paper, text }, labels) {
  const anchor = pair[side];
  labels.reserve(String(number), x - MARK, y - MARK, 2 * MARK, 2 * MARK);
  const rank = kind === "contradicts" && isName(anchor) ? "marked" : rankOf(anchor);
  labels.beside(named(anchor, isBeyond), { x, y }, MARK + 3, { rank, colour: text, bold: true });
  return svg("g", { "data-pair": number, "data-kind": kind }, svg("circle", { cx: x, cy: y, r: MARK, fill: colour, stroke: paper }),
    svg("text", { x, y: y + 4, fill: paper, "text-anchor": "middle", class: "number" }, number), svg("title", {}, named(anchor, true)));
}

function loneMark({ x, y, isBeyond }, anchor, { ground: paper, muted }, labels) {
  labels.reserve("", x - 5, y - 5, 10, 10);
  labels.beside(named(anchor, isBeyond), { x, y }, 8, { rank: isName(anchor) ? "identifier" : "rest", colour: muted });
  return svg("g", { class: "lone" }, svg("path", { d: `M ${x} ${y - 5} l 5 5 l -5 5 l -5 -5 z`, fill: paper, stroke: muted }),
    svg("title", {}, named(anchor, true)));
}

function named(anchor, withDistance) {
  const text = textOf(anchor);
  return withDistance ? `${text}, ${Number(anchor.distance_m.toFixed(1))} m` : text;
}
