// Pairs: the anchors of two local maps set against each other: which agree, which contradict, and by how much they are apart.

import { pairColour, theme } from "./viewer_colours.js";

/** The kinds of evidence that set two signs against each other. */
const DIFFER = {
  other_name: "another name at the same spot", strange_names: "names that exclude each other", displaced_name: "one name at two spots",
};

/**
 * The pairs of a candidate, each with a number and a colour, `query` and `candidate` as in their local maps (null: not in it), and
 * `angle` and `distance`, by which they are apart. `scene` knows anchors by their present names.
 */
export function pairsOf({ anchors: figures, evidence = [] }, [here, there], scene) {
  const { matches = [], contradictions = [] } = figures ?? {};
  const at = (map, id) => map?.get(presentName(id, scene)) ?? null;
  const taken = new Set();
  const pair = (kind, one, more) => {
    const key = `${one.query_anchor} ${one.candidate_anchor}`;
    if (taken.has(key)) return null;
    taken.add(key);
    const [query, candidate] = [at(here, one.query_anchor), at(there, one.candidate_anchor)];
    return { kind, ids: [one.query_anchor, one.candidate_anchor], query, candidate, ...apart(query, candidate), ...more };
  };
  const contradicting = contradictions.map((one) => pair("contradicts", one, { note: one.reason }));
  const agreeing = matches.map((one) => pair("agrees", one, {
    angle: one.angle_difference_rad, distance: one.distance_difference_m, note: `alike ${one.level} of 5`,
  }));
  const differing = evidence.filter(({ kind }) => DIFFER[kind]).flatMap(({ kind, query_anchors: own, candidate_anchors: other }) =>
    (own ?? []).map((query_anchor, at) => pair("differs", { query_anchor, candidate_anchor: other[at] }, { note: DIFFER[kind] })));
  const found = [...contradicting, ...agreeing, ...differing].filter(Boolean);
  const all = [...found, ...alikeElsewhere(found, here, there)];
  let agreed = 0;
  return all.map((one, index) => ({
    ...one, number: index + 1, colour: one.kind === "agrees" ? pairColour(agreed++) : theme()[one.kind === "contradicts" ? "bad" : "open"],
  }));
}

/** An anchor that became one with another goes by that one's name. */
export function presentName(id, scene) {
  if (scene.anchors.has(id)) return id;
  return [...scene.anchors.values()].find(({ merged_from: former }) => former.includes(id))?.id ?? id;
}

/** The anchors of a local map that no pair has. */
export function unpaired(map, pairs, side) {
  const taken = new Set(pairs.map((pair) => pair[side]?.anchor));
  return [...(map?.values() ?? [])].filter(({ anchor }) => !taken.has(anchor));
}

/** What reads alike on both sides and is no pair, because it stands elsewhere: the nearest of each. */
function alikeElsewhere(pairs, here, there) {
  const left = unpaired(there, pairs, "candidate");
  const found = [];
  for (const query of unpaired(here, pairs, "query").filter(({ description }) => description)) {
    const alike = left.filter((one) => one.class === query.class && one.description === query.description)
      .map((candidate) => ({ kind: "elsewhere", ids: [query.anchor, candidate.anchor], query, candidate, ...apart(query, candidate) }))
      .sort((a, b) => a.distance + a.angle - b.distance - b.angle)[0];
    if (!alike) continue;
    left.splice(left.indexOf(alike.candidate), 1);
    found.push({ ...alike, note: "reads alike, and stands elsewhere" });
  }
  return found;
}

function apart(query, candidate) {
  if (!query || !candidate) return { angle: null, distance: null };
  const cosine = query.bearing.reduce((sum, part, axis) => sum + part * candidate.bearing[axis], 0);
  return { angle: Math.acos(Math.min(Math.max(cosine, -1), 1)), distance: Math.abs(query.distance_m - candidate.distance_m) };
}
