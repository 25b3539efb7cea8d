// Details: all that is known about the selected keyframe or anchor.

import { get, key, path, post } from "./viewer_api.js";
import { confirmation } from "./viewer_confirm.js";
import { cropOf, thumbOf } from "./viewer_crop.js";
import { copyable, count, el, fill, number, sign } from "./dom.js";
import { stateTone, stateWords, tells } from "./viewer_anchor_words.js";
import { facts, longList, table } from "./viewer_tables.js";
import { time } from "./viewer_time.js";
import { explain, judge } from "./viewer_verdict.js";
import { lineOnly } from "./viewer_verdicts.js";

const QUESTION = "Is it a loop?";

/** Fills a place with what is selected. A newer selection wins over the answers to an older one. */
export class Details {
  /**
   * `world` gives `map()`, `scene()`, `version()` and `settings()`, and hears `mark(kind, id, marks)`, `locate(id)` and
   * `compare(answer, candidate)`; `refs` makes references.
   */
  constructor(place, world, refs) {
    Object.assign(this, { place, world, refs, turn: new AbortController() });
  }

  /** What to do, while nothing is selected. */
  clear() {
    this.begin();
    fill(this.place, el("p", { class: "hint" },
      "Choose a keyframe (a dot; its line is where the camera looks) or an anchor (a diamond) on the map, or one in the lists."));
  }

  begin() {
    this.turn.abort();
    this.turn = new AbortController();
    return this.turn.signal;
  }

  address(...parts) {
    return path("maps", this.world.map(), ...parts);
  }

  keyframe(id) {
    const signal = this.begin();
    const line = this.world.scene().keyframes.get(id);
    if (!line) {
      fill(this.place, el("h2", {}, "Keyframe ", el("code", {}, id)), el("p", {}, "It is not in the map (any more)."));
      return;
    }
    const neighbours = el("div", {}, el("p", { class: "muted" }, "Reading …"));
    const around = el("div", {}, el("p", { class: "muted" }, "Reading …"));
    const place = line.place.map((metres) => number(metres, 2)).join(", ");
    fill(this.place,
      el("h2", {}, "Keyframe ", el("code", {}, id)),
      facts(["Session", sign(line.session)], ["Time", time(line.stamp)], ["Position", `${place} m`],
        ["Loops", this.loopsOf(id)]),
      this.question(id, signal),
      el("h3", {}, "Anchors around it"), around,
      el("h3", {}, "Covisible keyframes"), neighbours,
      this.detections(id, signal), this.erasing(id, line.session));
    this.neighbours(id, neighbours, signal);
    this.around(id, around, signal);
  }

  loopsOf(id) {
    const loops = this.world.scene().loops.filter(({ keyframe, candidate }) => keyframe === id || candidate === id);
    if (loops.length === 0) return null;
    const other = ({ keyframe, candidate }) => (keyframe === id ? candidate : keyframe);
    return loops.map((loop) => el("div", {}, "closed with ", this.refs.keyframe(other(loop)),
      el("span", { class: "muted" }, ` (${loop.id})`)));
  }

  /** The button and the answer. */
  question(id, signal) {
    const answer = el("div", {});
    const spoken = el("p", { class: "offscreen", role: "status" });
    const verify = el("select", { "aria-label": "Which checks must run" },
      el("option", { value: "auto" }, "geometry if possible"), el("option", { value: "anchors" }, "anchors only"),
      el("option", { value: "geometry" }, "geometry must verify"));
    const ask = async () => {
      button.disabled = true;
      button.textContent = "Asking …";
      const body = { keyframe: id, verify: verify.value };
      const address = this.address("loop-queries");
      await shown(answer, signal, async () => {
        const verdict = await post(address, body);
        return this.verdict(id, verdict, curlOf(address, body));
      });
      spoken.textContent = answer.querySelector("h3, .fault")?.textContent ?? "";
      button.textContent = QUESTION;
      button.disabled = false;
    };
    const button = el("button", { type: "button", class: "main", click: ask }, QUESTION);
    const where = el("button", {
      type: "button", title: "Asks where its camera stands, with its own session left out", click: () => this.world.locate(id),
    }, "Where am I?");
    return el("div", { class: "question" }, el("div", { class: "row" }, button, verify, where), spoken, answer);
  }

  verdict(id, verdict, curl) {
    this.world.mark("keyframe", id, { verdict });
    const described = (anchor) => this.world.scene().anchors.get(anchor)?.description;
    const compare = (candidate) => this.world.compare(verdict, candidate);
    const isThis = ({ keyframe, candidate }) => keyframe === id && candidate === verdict.best;
    const confirm = (answer) => confirmation(this.world.map(), answer, this.world.scene().loops.find(isThis));
    return explain(verdict, { refs: this.refs, described, curl, version: this.world.version(), compare, confirm });
  }

  /** A verdict that was kept. `line` is what the list of verdicts tells of it. */
  query(query, line = null) {
    const signal = this.begin();
    const answer = el("div", {});
    fill(this.place, el("h2", {}, "Loop query ", el("code", {}, query)), answer);
    shown(answer, signal, async () => {
      if (line?.is_whole === false) return lineOnly(line, this.refs);
      const verdict = await get(this.address("loop-queries", query), signal);
      const asked = verdict.keyframe ?? null;
      return [el("p", {}, asked ? ["Asked about ", this.refs.keyframe(asked)] : "Asked about a keyframe that is not stored."),
        this.verdict(asked, verdict)];
    });
  }

  neighbours(id, place, signal) {
    return shown(place, signal, async () => {
      const { items } = await get(this.address("keyframes", id, "covisible"), signal);
      this.world.mark("keyframe", id, { covisible: items.map(({ keyframe }) => keyframe) });
      if (items.length === 0) return el("p", { class: "muted" }, "None: it shares too few points with any other.");
      const most = items.slice().sort((a, b) => b.shared - a.shared);
      return longList(most, "flow", ({ keyframe, shared }) =>
        [this.refs.keyframe(keyframe), el("span", { class: "muted small", title: "shared map points" }, ` ${shared}`)]);
    });
  }

  around(id, place, signal) {
    return shown(place, signal, async () => {
      const { anchors } = await get(this.address("keyframes", id, "local-anchor-map"), signal);
      this.world.mark("keyframe", id, { around: anchors });
      if (anchors.length === 0) return el("p", { class: "muted" }, "None: neither it nor a covisible keyframe sees an anchor.");
      const near = anchors.slice().sort((a, b) => a.distance_m - b.distance_m);
      return table(["Anchor", "Reads", "Distance", "Weight"], near.map((anchor) => [
        this.refs.anchor(anchor.anchor),
        [anchor.description ? sign(anchor.description) : stateChip(anchor.state), this.thumb(anchor.anchor, signal)],
        `${number(anchor.distance_m)} m`, anchor.state === "valid" ? number(anchor.weight) : "–",
      ]));
    });
  }

  thumb(anchor, signal) {
    return this.world.scene().anchors.get(anchor)?.has_crop && thumbOf(this.address("anchors", anchor, "crop"), signal);
  }

  /** Read only when it is opened: the answer carries every feature of the keyframe. */
  detections(id, signal) {
    const place = el("div", {});
    const { keep_crops: keepsCrops } = this.world.settings();
    const read = () => shown(place, signal, async () => {
      const { detections, observes, features, pose } = await get(this.address("keyframes", id), signal);
      const line = (detection) => el("li", {},
        el("div", {}, detection.class, " ", chip(detection.outcome, { created: "good", observed: "good" }), " ",
          detection.anchor && this.refs.anchor(detection.anchor)),
        (detection.description ?? detection.text) && el("div", {}, sign(detection.description ?? detection.text)),
        el("div", { class: "muted small" }, `confidence ${number(detection.confidence)}`, distance(detection, pose),
          detection.reason && `, ignored: ${detection.reason.replaceAll("_", " ")}`,
          detection.has_crop ? ", with a picture" : keepsCrops === false && ", no picture: this map keeps none"));
      const both = `${count(detections.length, "detection")}; it observes ${count(observes.length, "map point")}.`;
      return [el("p", { class: "muted" }, both), el("p", { class: "muted" }, this.features(features)),
        el("ul", { class: "lines" }, detections.map(line))];
    });
    return el("details", { toggle: ({ target }) => target.open && place.childElementCount === 0 && read() },
      el("summary", {}, "Its detections and features"), place);
  }

  /** A map may let go of features, and then what it cannot do is said. */
  features(features) {
    if (features) return `It has ${count(features.keypoints.length, "feature")}.`;
    const { keep_descriptors_days: days } = this.world.settings();
    const kept = days > 0 ? `: this map keeps them for ${count(days, "day")}` : "";
    return `It has no features${kept}. Geometry is not verified with it; its words and anchors still find it.`;
  }

  /** Told, and not offered: nothing brings back what was erased. */
  erasing(keyframe, session) {
    const address = this.address("erase");
    return el("details", {}, el("summary", {}, "How to erase it for good"),
      el("p", { class: "small" }, "With a key for ", el("code", {}, "admin"),
        ". It goes from the map, its releases and the database's file, and nothing brings it back. ",
        "The answer names a job; ", el("code", {}, `GET ${address}/ID`), " tells when it is done, and which backups still hold it."),
      el("h4", {}, "This keyframe"), copyable(curlOf(address, { keyframes: [keyframe] })),
      el("h4", {}, "Its whole session"), copyable(curlOf(address, { sessions: [session] })));
  }

  anchor(id) {
    const signal = this.begin();
    const place = el("div", {}, el("p", { class: "muted" }, "Reading …"));
    fill(this.place, el("h2", {}, "Anchor ", el("code", {}, id)), place);
    this.world.mark("anchor", id, {});
    shown(place, signal, async () => {
      const anchor = await get(this.address("anchors", id), signal);
      this.world.mark("anchor", id, { keyframes: anchor.keyframes, matches: anchor.matches.map((match) => match.anchor) });
      return this.anchorView(anchor, signal);
    });
  }

  anchorView(anchor, signal) {
    const { refs } = this;
    const votes = anchor.readings.reduce((sum, { weight }) => sum + weight, 0);
    const sources = { operator: "by hand", plan: `by a plan${anchor.prior?.source ? ` (${anchor.prior.source})` : ""}` };
    const source = sources[anchor.description_source] ?? "by the vote over its readings";
    const places = anchor.frames.map(({ session, center }) =>
      el("div", {}, center.map((metres) => number(metres, 2)).join(", "), " m in ", sign(session)));
    const { plan_position: inPlan } = anchor;
    const planPlace = inPlan && el("div", {}, inPlan.position.map((metres) => number(metres, 2)).join(", "), " m in ",
      sign(inPlan.frame), inPlan.session && [", to which ", sign(inPlan.session), " is aligned"]);
    return [
      el("p", { class: "reads" }, anchor.description ? sign(anchor.description) : "not described yet"),
      el("p", {}, el("span", { class: "chip" }, anchor.class), " ", stateChip(anchor.state)),
      anchor.has_crop ? el("figure", {}, cropOf(this.address("anchors", anchor.id, "crop"), signal))
        : this.world.settings().keep_crops === false && el("p", { class: "muted small" }, "No picture: this map keeps none."),
      facts(["Described", anchor.description && source],
        ["Identifiers", anchor.identifiers.length > 0 && anchor.identifiers.map((text) => [sign(text), " "])],
        ["Kind", anchor.kind?.replaceAll("_", " ")],
        ["Tells", anchor.description && tells(anchor)],
        ["Stands at", places.length > 0 ? places : "not known yet"], ["In the plan", planPlace],
        ["Map points", number(anchor.map_points, 0)],
        ["In its place", anchor.replaced_by && refs.anchor(anchor.replaced_by)],
        ["Goes by", anchor.merged_into && refs.anchor(anchor.merged_into)],
        ["Also", anchor.merged_from.length > 0 && anchor.merged_from.map((id) => [refs.anchor(id), " "])]),
      el("h3", {}, "Readings"),
      anchor.readings.length === 0 ? el("p", { class: "muted" }, "Nothing has been read yet.")
        : table(["Text", "Votes", "Weight", "Share"], anchor.readings.map(({ text, weight, count: n }) =>
          [sign(text), number(n, 0), number(weight), votes > 0 ? `${number(100 * weight / votes, 0)} %` : "–"])),
      el("h3", {}, "Matching anchors"),
      anchor.matches.length === 0 ? el("p", { class: "muted" }, "None.") : longList(anchor.matches, "lines", (match) => [
        el("div", {}, refs.anchor(match.anchor), " ", this.reads(match.anchor), " ",
          chip(match.kind === "revisit" ? "seen before" : "covisible", { "seen before": "good" })),
        el("div", { class: "muted small" }, `alike ${match.level} of 5, ${judge(match.source)}: `, sign(match.reason))]),
      anchor.matches_total > anchor.matches.length
        && el("p", { class: "muted" }, `${count(anchor.matches_total, "match", "matches")} in all; these are the oldest.`),
      el("h3", {}, "Seen by"),
      longList(anchor.keyframes, "flow", (keyframe) => refs.keyframe(keyframe)),
    ];
  }

  reads(id) {
    const text = this.world.scene().anchors.get(id)?.description;
    return text ? sign(`“${text}”`) : "";
  }
}

/** Puts what was read in its place, or why it could not be read. */
async function shown(place, signal, read) {
  try {
    const children = await read();
    if (!signal.aborted) fill(place, children);
  } catch (error) {
    if (!signal.aborted) fill(place, el("p", { class: "fault", role: "alert" }, error.message));
  }
}

/** How far a detection was; a distance that the client assumed looks it. */
function distance({ position, range }, { translation: { x, y, z } }) {
  if (!position) return null;
  const metres = `${number(Math.hypot(position[0] - x, position[1] - y, position[2] - z), 1)} m away`;
  if (range !== "assumed") return `, ${metres}`;
  return [", ", el("span", { class: "assumed", title: "The client measured the direction, and assumed the distance" }, `about ${metres}, assumed`)];
}

function stateChip(state) {
  return el("span", { class: `chip ${stateTone(state)}` }, stateWords(state));
}

function chip(state, tones) {
  return el("span", { class: `chip ${tones[state] ?? ""}` }, state);
}

function curlOf(address, body) {
  const url = new URL(address, document.baseURI).href;
  const withKey = key() ? " \\\n  -H \"authorization: Bearer $REVISIT_KEY\"" : "";
  return `curl -X POST ${url}${withKey} \\\n  -H 'content-type: application/json' \\\n  -d '${JSON.stringify(body)}'`;
}
