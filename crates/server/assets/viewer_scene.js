// Scene: the lists of the API as points in frames, and how the frames of several sessions are laid out on the page.

import { count } from "./dom.js";

export const AXES = ["x", "y", "z"];
/** The planes one can look at, as pairs of axes: to the right, and up. */
export const PLANES = [[0, 1], [0, 2], [1, 2]];

/**
 * Keyframes, anchors and loops, ordered by session. Each session is a frame of its own, and may have a place in that of the fleet.
 * Plans are frames too, with signs that nobody needs to have seen.
 */
export function buildScene({ keyframes, anchors, loops, sessions = [], frames = null }) {
  const scene = { sessions: [], plans: [], keyframes: new Map(), anchors: new Map(), loops, classes: [], suspects: new Map() };
  const named = new Map();
  const planned = new Set(anchors.filter(({ prior }) => prior).map(({ prior }) => prior.frame));
  const session = (name) => {
    if (!named.has(name)) {
      const list = planned.has(name) ? scene.plans : scene.sessions;
      named.set(name, { name, index: list.length, keyframes: [], anchors: [], isPlan: planned.has(name) });
      list.push(named.get(name));
    }
    return named.get(name);
  };
  for (const line of keyframes) {
    const { x, y, z } = line.pose.translation;
    const place = [x, y, z];
    const keyframe = { ...line, place, forward: lookingAlong(line.pose.rotation) };
    scene.keyframes.set(line.id, keyframe);
    session(line.session).keyframes.push(keyframe);
  }
  for (const anchor of anchors) {
    scene.anchors.set(anchor.id, anchor);
    for (const frame of anchor.frames) session(frame.session).anchors.push({ anchor, place: frame.center, assumed: frame.range === "assumed" });
  }
  for (const { session: name, reference_from_session: placed } of frames?.frames ?? []) {
    if (placed && named.has(name)) named.get(name).placed = placed;
  }
  for (const { session: name, frame, plan_from_session: planFromSession, inliers } of sessions) {
    if (frame && named.has(name)) named.get(name).aligned = { plan: named.get(frame), planFromSession, inliers };
  }
  scene.joined = scene.sessions.filter(({ placed }) => placed).length;
  for (const suspect of frames?.suspects ?? []) scene.suspects.set(suspect.loop, suspect);
  const classes = new Map();
  for (const anchor of anchors) classes.set(anchor.class, (classes.get(anchor.class) ?? 0) + 1);
  scene.classes = [...classes].sort().map(([name, size], index) => ({ name, size, index }));
  return scene;
}

/** Where a local anchor map's bearing and distance lead from its keyframe, in its session's frame. */
export function placeOfBearing(keyframe, bearing, distance) {
  const direction = rotated(keyframe.pose.rotation, bearing);
  return keyframe.place.map((start, axis) => start + direction[axis] * distance);
}

/** Where a place lies, seen from a camera at `map_from_camera`: to the right, down and ahead, in metres. */
export function bearingFrom({ translation, rotation: { x, y, z, w } }, place) {
  const from = [translation.x, translation.y, translation.z];
  return rotated({ x: -x, y: -y, z: -z, w }, place.map((metres, axis) => metres - from[axis]));
}

/** The direction in which a camera of this rotation looks. */
export function lookingAlong(rotation) {
  return rotated(rotation, [0, 0, 1]);
}

function rotated({ x, y, z, w }, [a, b, c]) {
  const [u, v, t] = [2 * (y * c - z * b), 2 * (z * a - x * c), 2 * (x * b - y * a)];
  return [a + w * u + y * t - z * v, b + w * v + z * u - x * t, c + w * t + x * v - y * u];
}

/** A place of a session where its frame lies in the fleet's; `null` is its own frame. */
export function moved(placed, place) {
  if (!placed) return place;
  const { translation: { x, y, z }, rotation } = placed;
  return rotated(rotation, place).map((metres, axis) => metres + [x, y, z][axis]);
}

/** The other way round: where a place of the outer frame lies in the inner one. */
export function inverse({ translation: { x, y, z }, rotation }) {
  const back = { x: -rotation.x, y: -rotation.y, z: -rotation.z, w: rotation.w };
  const [a, b, c] = rotated(back, [-x, -y, -z]);
  return { translation: { x: a, y: b, z: c }, rotation: back };
}

/** A direction, likewise. */
export function turned(placed, direction) {
  return placed ? rotated(placed.rotation, direction) : direction;
}

/** The plane along which things are spread most: the floor, whatever the frame calls it. */
export function widestPlane(scene, fleet = false) {
  const spread = [0, 0, 0];
  for (const { keyframes, anchors, placed } of scene.sessions.length > 0 ? scene.sessions : scene.plans) {
    const places = [...keyframes, ...anchors].map(({ place }) => moved(fleet ? placed : null, place));
    for (const axis of [0, 1, 2]) {
      const [least, most] = range(places.map((place) => place[axis]));
      spread[axis] += most - least;
    }
  }
  const flattest = spread.indexOf(Math.min(...spread));
  // In a tie, as when nothing is there, x-y.
  return spread[2] === spread[flattest] ? PLANES[0] : PLANES.find((plane) => !plane.includes(flattest));
}

/**
 * Which sessions are shown, where, and by how much each is shifted. `choice` is a session's name, or `null` for all of them: in the
 * `fleet`'s frame where one is known, the others `apart` beside it and each other, else each at its own origin.
 */
export function arrange(scene, { plane, choice, apart, fleet, aspect }) {
  const shown = [...scene.sessions, ...scene.plans].filter((session) => choice === null || session.name === choice);
  const all = shown.map((session) => {
    const placed = fleet && choice === null ? session.placed ?? null : null;
    return { session, placed, du: 0, dv: 0, box: boxOf(session, plane, placed) };
  });
  const { groups, beneath } = layPlans(all, apart || choice !== null);
  const isWhole = groups.length === 1;
  for (const { plan, placed, group } of isWhole ? beneath : []) group.box = union([group.box, boxOf(plan, plane, placed)]);
  const joined = groups.filter(({ placed }) => placed);
  const alone = groups.filter(({ placed }) => !placed);
  const one = ({ session, box }) => ({ title: session.name, members: [session], du: 0, dv: 0, box });
  const together = {
    title: `${count(joined.filter(({ session }) => !session.isPlan).length, "session")} in one frame`,
    members: joined.map(({ session }) => session), du: 0, dv: 0,
    box: union(joined.map(({ box }) => box)),
  };
  const frames = joined.length > 0 ? [together, ...alone.map(one)] : alone.map(one);
  const framed = (apart || joined.length > 0) && frames.length > 1;
  if (framed) shelveBest(frames, aspect);
  for (const group of groups) {
    const { du, dv } = frames.find(({ members }) => members.includes(group.session));
    Object.assign(group, { du, dv });
  }
  return { plane, groups, beneath, frames, framed, bounds: union(frames.map(shifted)) };
}

/**
 * Which plans lie beneath which groups, and where. `beneath` has `placed`, from the plan's frame to the group's. In the fleet's frame
 * a plan is a group like a session; a plan that lies under a session needs no group of its own.
 */
function layPlans(all, mayLieUnder) {
  const beneath = [];
  const isUnder = new Set();
  for (const group of all) {
    const { session: { isPlan, aligned }, placed } = group;
    if (isPlan || placed || !aligned?.plan || !mayLieUnder) continue;
    beneath.push({ plan: aligned.plan, placed: inverse(aligned.planFromSession), group });
    isUnder.add(aligned.plan);
  }
  const groups = all.filter(({ session, placed }) => !session.isPlan || placed || !isUnder.has(session));
  for (const group of groups.filter(({ session }) => session.isPlan)) beneath.push({ plan: group.session, placed: group.placed, group });
  return { groups, beneath };
}

/** A group's box where it stands on the page. */
export function shifted({ box, du, dv }) {
  return { u0: box.u0 + du, u1: box.u1 + du, v0: box.v0 + dv, v1: box.v1 + dv };
}

function boxOf(session, [u, v], placed) {
  const [keyframes, anchors] = [session.keyframes, session.anchors].map((all) => all.map(({ place }) => moved(placed, place)));
  const own = boxAround(keyframes, u, v);
  const reach = 20 + 3 * Math.max(own.u1 - own.u0, own.v1 - own.v0);
  // An anchor placed kilometres away by one bad point must not shrink everything else to a dot.
  const near = anchors.filter((place) =>
    place[u] > own.u0 - reach && place[u] < own.u1 + reach && place[v] > own.v0 - reach && place[v] < own.v1 + reach);
  return boxAround([...keyframes, ...(keyframes.length ? near : anchors)], u, v);
}

function boxAround(places, u, v) {
  const [u0, u1] = range(places.map((place) => place[u]));
  const [v0, v1] = range(places.map((place) => place[v]));
  return { u0, u1, v0, v1 };
}

function range(numbers) {
  if (numbers.length === 0) return [0, 0];
  let [least, most] = [Infinity, -Infinity];
  for (const n of numbers) {
    if (n < least) least = n;
    if (n > most) most = n;
  }
  return [least, most];
}

function union(boxes) {
  if (boxes.length === 0) return { u0: -1, u1: 1, v0: -1, v1: 1 };
  const side = (name, pick) => pick(...boxes.map((box) => box[name]));
  return { u0: side("u0", Math.min), u1: side("u1", Math.max), v0: side("v0", Math.min), v1: side("v1", Math.max) };
}

/** Puts the groups on shelves, in their order, of the width that shows them largest on a page of this shape. */
function shelveBest(groups, aspect) {
  const sides = groups.flatMap(({ box }) => [box.u1 - box.u0, box.v1 - box.v0]).sort((a, b) => a - b);
  const usual = Math.max(sides[Math.floor(sides.length * 0.75)], sides.at(-1) * 0.3, 0.5);
  for (const group of groups) group.box = roomy(group.box, usual * 0.3, usual * 0.12);
  const widths = groups.map(({ box }) => box.u1 - box.u0);
  const [widest, all] = [Math.max(...widths), widths.reduce((sum, width) => sum + 2 * width, 0)];
  let best = { size: Infinity, width: widest };
  for (let width = widest; width <= all; width *= 1.08) {
    const { u0, u1, v0, v1 } = shelve(groups, width, usual);
    const size = Math.max(u1 - u0, (v1 - v0) * aspect);
    if (size < best.size) best = { size, width };
  }
  shelve(groups, best.width, usual);
}

/** One try; gives the box around all. Above each shelf there is room for titles. */
function shelve(groups, width, usual) {
  const gap = usual * 0.12;
  let [u, v, tallest] = [0, 0, 0];
  for (const group of groups) {
    const [w, h] = [group.box.u1 - group.box.u0, group.box.v1 - group.box.v0];
    if (u > 0 && u + w > width) [u, v, tallest] = [0, v - tallest - 2.5 * gap, 0];
    group.du = u - group.box.u0;
    group.dv = v - group.box.v1;
    u += w + gap;
    tallest = Math.max(tallest, h);
  }
  return union(groups.map(shifted));
}

function roomy({ u0, u1, v0, v1 }, least, margin) {
  const grow = (a, b) => Math.max(0, least - (b - a)) / 2 + margin;
  const [du, dv] = [grow(u0, u1), grow(v0, v1)];
  return { u0: u0 - du, u1: u1 + du, v0: v0 - dv, v1: v1 + dv };
}
