// Evidence: the sum by which a candidate is a loop or none (M64), as bars to either side of even odds.

import { el, number, sign } from "./dom.js";
import { EVIDENCE } from "./words.js";

/** A confidence, rounded down: 99.96 % is not a hundred. */
export function percent(confidence) {
  return `${number(Math.floor(confidence * 1000) / 10, 1)} %`;
}

/** The kinds of terms in plain words. */
const KINDS = {
  name: "the same name", shared_name: "a name that hangs in several places", other_name: "other names at one spot",
  displaced_name: "a name at another spot", strange_names: "names on one side only", absent: "signs not read there", texts: "the same texts",
  view: "the same view", copy: "may be a copy", no_view: "no common view", apart: "cameras apart", odometry: "the robot's own tracking",
  rival: "another place as likely", neighbour: "the place next to it", unread: "pictures not read yet",
};

/** A term of this weight or more fills its side. */
const WIDEST = 10;

/** The bars of the terms of a sum, the heaviest first; null where it has none. */
export function bars(evidence) {
  const heaviest = [...evidence].sort((a, b) => Math.abs(b.log_odds) - Math.abs(a.log_odds));
  return heaviest.length === 0 ? null : el("ul", { class: "odds" }, heaviest.map(term));
}

function term({ kind, about, log_odds: odds }) {
  const filled = el("span", { class: odds < 0 ? "against" : "for" });
  filled.style.width = `${Math.min(Math.abs(odds) / WIDEST, 1) * 50}%`;
  return el("li", { title: EVIDENCE[kind] ?? kind },
    el("span", {}, KINDS[kind] ?? kind.replaceAll("_", " "), about && [": ", sign(about)]),
    el("span", { class: "figure" }, `${odds > 0 ? "+" : ""}${number(odds, 1)}`),
    el("div", { class: "odds-bar", "aria-hidden": "true" }, filled));
}
