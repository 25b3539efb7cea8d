// Marks: what of the map belongs to the selection, as rings and lines on the canvas.

import { lookingAlong, placeOfBearing } from "./viewer_scene.js";
import { number } from "./dom.js";
import { percent } from "./viewer_evidence.js";
import { distinctSigns, toneOfPlace } from "./viewer_place.js";
import { toneOf } from "./viewer_verdict.js";

const MATCH_LINES = 40;

/** The marks of the selected keyframe or anchor. */
export function marksOf(canvas, { selection, marks, scene }) {
  if (selection?.kind === "keyframe") return ofKeyframe(canvas, scene, selection.id, marks);
  if (selection?.kind === "anchor") return ofAnchor(canvas, selection.id, marks);
  return {};
}

/** Rings around the covisible keyframes and the candidates of a verdict; lines to the anchors around it and to the candidates. */
function ofKeyframe(canvas, scene, id, { covisible = [], around = [], verdict }) {
  const keyframe = scene.keyframes.get(id);
  const from = canvas.point("keyframe", id);
  const rings = new Map(covisible.map((other) => [other, "accent"]));
  const lines = [];
  if (keyframe && from) {
    for (const { bearing, distance_m: distance } of around) {
      const to = canvas.project(keyframe.session, placeOfBearing(keyframe, bearing, distance));
      lines.push({ from, to, tone: "accent", text: `${number(distance, 1)} m` });
    }
  }
  (verdict?.candidates ?? []).forEach((candidate, index) => {
    const tone = toneOf(candidate.verdict);
    rings.set(candidate.keyframe, tone);
    const loop = candidate.verdict === "loop";
    // Of those that are no loop a line leads to the best only: twenty lines tell nothing.
    if (loop || index === 0) lines.push({ from, to: canvas.point("keyframe", candidate.keyframe), tone, dashed: !loop });
  });
  return { keyframe: id, rings, lines };
}

/** Rings around the keyframes that saw it, lines to them in the same frame, and to the anchors that match it. */
function ofAnchor(canvas, id, { keyframes = [], matches = [] }) {
  const lines = [];
  const places = canvas.anchors.filter((point) => point.id === id);
  for (const keyframe of keyframes) {
    const to = canvas.point("keyframe", keyframe);
    const from = places.find(({ session }) => session === to?.session);
    if (from) lines.push({ from, to, tone: "accent", dashed: true });
  }
  for (const match of matches.slice(0, MATCH_LINES)) {
    lines.push({ from: places[0], to: canvas.point("anchor", match), tone: "good" });
  }
  return { anchor: id, rings: new Map(keyframes.map((keyframe) => [keyframe, "accent"])), lines };
}

/**
 * The marks of an answer to "where am I?" on the shown map: a camera for each place with a pose, else its keyframe, and
 * the signs to look for.
 */
export function marksOfAnswer(canvas, { answer, map }) {
  if (!answer) return {};
  const [u, v] = canvas.layout.plane;
  const places = answer.places.map((place, index) => {
    const { map_from_camera: camera, uncertainty, assumed = [] } = place;
    const mark = {
      best: index === 0, tone: toneOfPlace(place.verdict), text: `${index + 1}: ${percent(place.confidence)}`, map: place.map,
    };
    if (!camera) return { ...mark, at: canvas.point("keyframe", place.keyframe) };
    const { x, y, z } = camera.translation;
    const forward = lookingAlong(camera.rotation);
    return {
      ...mark, at: canvas.project(place.session, [x, y, z]), ahead: [forward[u], forward[v]],
      radius_m: uncertainty?.translation_m ?? 0, assumed: assumed.length > 0,
    };
  });
  const signs = distinctSigns(answer.look_for).map(({ description, position, session, map: its }) =>
    ({ text: description, map: its, at: canvas.project(session, position) }));
  const shown = (marks) => marks.filter((mark) => mark.map === map && mark.at)
    .map(({ at: { u: right, v: up, session }, ...mark }) => ({ ...mark, u: right, v: up, session }));
  return { places: shown(places), signs: shown(signs) };
}
