// Header: what the map holds and has learned, in figures, and whether the page hears of changes.

import { el, fill, number, sign } from "./dom.js";

const CONNECTIONS = { live: "live", reached: "connected", away: "connection lost" };

/** Whether events come (`live`), the server answers without them (`reached`), or it does not answer (`away`). */
export function showConnection(place, how) {
  place.dataset.state = how;
  place.lastElementChild.textContent = CONNECTIONS[how];
}

/** The figures of a map. */
export function showFigures(place, meta, scene) {
  const { plans } = scene;
  const counts = [[meta.keyframes, "keyframe"], [meta.anchors, "anchor"], [meta.sessions - plans.length, "session"], [meta.loops, "loop"]];
  if (plans.length > 0) counts.splice(3, 0, [plans.length, "plan"]);
  fill(place, counts.map(([n, one]) => el("span", {}, el("b", {}, number(n, 0)), ` ${n === 1 ? one : `${one}s`}`)),
    el("span", {}, "version ", el("b", {}, meta.map_version)), numbered(meta, scene), twins(meta));
  place.title = meta.description;
}

/** How the building writes its numbers, by an example. */
function numbered({ numbering }, { anchors }) {
  return Object.entries(numbering).map(([kind, formats]) => {
    const signs = [...anchors.values()].filter((anchor) => anchor.class === kind && anchor.kind === "name");
    const example = signs.map(({ description }) => description).sort()[0] ?? formats.join(", ");
    const plain = kind.replaceAll("_", " ");
    return el("span", { title: `Learned from the signs: the building writes its ${plain} as ${formats.join(" or ")}, where # is any number` },
      `${plain} like `, el("b", {}, sign(example)));
  });
}

/** The views that the map has twice. */
function twins({ twins: pairs }) {
  if (pairs.length === 0) return null;
  const named = pairs.map(({ keyframe, candidate }) => `${keyframe} and ${candidate}`).join("; ");
  return el("span", { title: `Different signs hang around places that look the same: ${named}. Looks alone close no loop here` },
    el("b", {}, number(pairs.length, 0)), pairs.length === 1 ? " view in two places" : " views in two places");
}
