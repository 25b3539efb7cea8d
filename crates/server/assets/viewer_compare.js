// Compare: the keyframe that was asked about and one candidate side by side: what agrees, what failed, and by how much.

import { get, path } from "./viewer_api.js";
import { onChange } from "./viewer_colours.js";
import { cropOf } from "./viewer_crop.js";
import { pairsOf, presentName, unpaired } from "./viewer_pairs.js";
import { checksInFigures, gauge } from "./viewer_gauges.js";
import { chipOf, why } from "./viewer_verdict.js";
import { twoViews } from "./viewer_views.js";
import { el, fill, number, sign } from "./dom.js";

const KINDS = { agrees: "agrees", contradicts: "contradicts", differs: "differs", elsewhere: "stands elsewhere" };
const NARROW = matchMedia("(max-width: 44rem)");

/** A dialog over the page. `world` gives `map()`, `scene()` and `settings()`; `refs` makes references, which close it. */
export class Compare {
  constructor(world, refs) {
    Object.assign(this, { world, refs, shown: null, turn: new AbortController() });
    this.body = el("div", { class: "compare" });
    const close = el("button", { type: "button", "aria-label": "Close", click: () => this.dialog.close() }, "Close");
    this.title = el("h2", { id: "compare-title" });
    this.dialog = el("dialog", { "aria-labelledby": "compare-title", close: () => this.closed() },
      el("div", { class: "compare-head" }, this.title, close), this.body);
    // A reference leads back to the map.
    this.body.addEventListener("click", ({ target }) => target.closest("button.ref") && this.dialog.close());
    document.body.append(this.dialog);
    onChange(() => this.draw());
    NARROW.addEventListener("change", () => this.draw());
  }

  /** Opens it for a candidate of an answer. */
  async open(answer, candidate) {
    this.turn.abort();
    this.turn = new AbortController();
    const { signal } = this.turn;
    const { keyframe: query = null } = answer;
    const { refs } = this;
    fill(this.title, query ? ["Compare ", el("code", {}, query)] : "Compare the keyframe that was sent",
      " with ", el("code", {}, candidate.keyframe), " ", chipOf(candidate.verdict));
    fill(this.body, el("p", { class: "muted" }, "Reading …"));
    if (!this.dialog.open) this.dialog.showModal();
    try {
      const maps = await Promise.all([query && this.localMap(query, signal), this.localMap(candidate.keyframe, signal)]);
      if (signal.aborted) return;
      this.shown = { answer, candidate, query, maps, links: query ? [refs.keyframe(query), refs.keyframe(candidate.keyframe)] : [] };
      this.draw();
    } catch (error) {
      if (!signal.aborted) fill(this.body, el("p", { class: "fault", role: "alert" }, error.message));
    }
  }

  closed() {
    this.turn.abort();
    this.shown = null;
    fill(this.body);
  }

  /** The anchors around a keyframe, by their ids; null if it is gone. */
  async localMap(keyframe, signal) {
    try {
      const { anchors } = await get(path("maps", this.world.map(), "keyframes", keyframe, "local-anchor-map"), signal);
      return new Map(anchors.map((anchor) => [anchor.anchor, anchor]));
    } catch (error) {
      if (error.status === 404) return null;
      throw error;
    }
  }

  draw() {
    if (!this.shown) return;
    const { answer, candidate, query, maps } = this.shown;
    const [scene, settings] = [this.world.scene(), this.world.settings()];
    const pairs = pairsOf(candidate, maps, scene);
    const hasMoved = this.world.version() > answer.map_version;
    fill(this.body,
      el("p", {}, candidate.reason ? why(candidate.reason) : "It passed every check that could run."),
      checksInFigures(candidate, settings),
      twoViews(maps, [query ?? "not stored", candidate.keyframe], pairs, NARROW.matches),
      el("p", { class: "muted small" },
        "From above, ahead is up. Pairs have one number and one colour; a dashed ring in the candidate's view is where the query's ",
        "anchor would be if this were one place.",
        hasMoved && ` Drawn as the map is now, version ${this.world.version()}; the verdict is of version ${answer.map_version}.`),
      pairs.length === 0 && el("p", { class: "hint" }, "No anchor of the one is set against an anchor of the other."),
      el("ol", { class: "compared" }, pairs.map((pair) => this.pair(pair, settings, scene))),
      this.lone("Only here", unpaired(maps[0], pairs, "query")),
      this.lone("Only there", unpaired(maps[1], pairs, "candidate")));
  }

  pair({ kind, number: n, colour, ids, query, candidate, texts = [], angle, distance, note }, settings, scene) {
    const badge = el("span", { class: "badge" }, n);
    badge.style.background = colour;
    const { anchor_map_max_angle_difference_rad: mostAngle, anchor_map_max_distance_difference_m: mostDistance } = settings;
    const degrees = (radians) => `${number(radians * 180 / Math.PI, 0)}°`;
    return el("li", { class: kind, "data-kind": kind },
      el("div", { class: "compared-head" }, badge, el("b", {}, KINDS[kind]), el("span", { class: "muted small" }, sign(note))),
      el("div", { class: "plates" },
        this.plate(ids[0], query, texts[0], scene, "here"), this.plate(ids[1], candidate, texts[1], scene, "there")),
      angle === null || distance === null
        ? el("p", { class: "muted small" }, "Not both are around their keyframes now: nothing to measure.")
        : el("div", { class: "gauges" },
          gauge("angle apart", angle, mostAngle, degrees),
          gauge("distance apart", distance, mostDistance, (metres) => `${number(metres)} m`)));
  }

  /** The picture of an anchor where there is one, else its text as on a sign. */
  plate(id, inMap, text, scene, where) {
    const name = presentName(id, scene);
    const anchor = scene.anchors.get(name);
    const reads = inMap?.description ?? anchor?.description ?? text;
    const picture = anchor?.has_crop && cropOf(path("maps", this.world.map(), "anchors", name, "crop"), this.turn.signal);
    return el("figure", { class: "plate" }, picture, el("div", { class: "plate-text" }, reads ? sign(reads) : "not described"),
      el("figcaption", { class: "muted small" }, `${where}: `, this.refs.anchor(name)));
  }

  lone(title, anchors) {
    if (anchors.length === 0) return null;
    return el("p", { class: "small" }, el("b", {}, `${title}: `), anchors.map((anchor, index) =>
      [index > 0 && ", ", anchor.description ? sign(anchor.description) : anchor.anchor, ` (${number(anchor.distance_m, 1)} m)`]));
  }
}
