// Event list: the tab of what has happened, newest first.

import { moment } from "./viewer_time.js";
import { brief, el, fill, number, sign } from "./dom.js";

const SHOWN = 200;
/** A filter looks among so many. */
const KEPT = 20_000;
const SESSIONS = 3;
/** Events that come in runs, and what they say of their keyframes. */
const RUNS = { keyframe_stored: "stored", keyframe_removed: "removed" };
/** What an event is about, by the beginning of its name. */
const KINDS = {
  loops: ["loop_"], signs: ["anchor"], keyframes: ["keyframe_", "poses_"], "sessions and releases": ["sessions_", "merge_", "release_"],
};

/** The list of events, newest first. A long history comes in one gush: it is drawn once for each frame. */
export class EventList {
  constructor(place, tab, refs) {
    Object.assign(this, { place, tab, refs, total: 0, fresh: [], drawing: false });
    this.kind = el("select", { "aria-label": "Kind of event", change: () => this.filter() },
      el("option", { value: "" }, "everything"), Object.keys(KINDS).map((kind) => el("option", {}, kind)));
    this.reset();
  }

  /** Another map. */
  reset() {
    this.total = 0;
    this.kept = [];
    this.kind.value = "";
    this.tab.textContent = "Events";
    this.begin("Nothing has happened yet. Keyframes, described anchors, matches, merges and loops appear here as they happen.");
  }

  /** An empty list. */
  begin(hint) {
    this.fresh = [];
    this.run = null;
    this.list = el("ol", { class: "events" });
    fill(this.place, el("div", { class: "filters" }, this.kind), this.list, el("p", { class: "hint" }, hint));
  }

  /** Lists those of the chosen kind. */
  filter() {
    this.begin("Nothing of this kind has happened.");
    for (const event of this.kept) this.take(event);
  }

  add(event) {
    this.total += 1;
    this.kept.push(event);
    if (this.kept.length > 2 * KEPT) this.kept = this.kept.slice(-KEPT);
    this.take(event);
  }

  /** Keyframes that come or go one after the other are one line. */
  take(event) {
    const wanted = KINDS[this.kind.value];
    if (wanted?.some((start) => event.event.startsWith(start)) === false) return;
    if (RUNS[event.event] && this.run?.kind === event.event) {
      lengthen(this.run, event);
      if (!this.fresh.includes(this.run)) this.fresh.push(this.run);
    } else {
      this.run = RUNS[event.event] ? lengthen({ kind: event.event, keyframes: 0, sessions: new Set(), line: null }, event) : null;
      this.fresh.push(this.run ?? event);
    }
    if (this.fresh.length > SHOWN) this.fresh.shift();
    if (this.drawing) return;
    this.drawing = true;
    requestAnimationFrame(() => this.draw());
  }

  draw() {
    this.drawing = false;
    this.tab.textContent = `Events ${brief(this.total)}`;
    this.place.querySelector(".hint")?.remove();
    for (const one of this.fresh) {
      if (one.keyframes === undefined) this.list.prepend(this.line(one));
      else this.drawRun(one);
    }
    this.fresh = [];
    while (this.list.childElementCount > SHOWN) this.list.lastElementChild.remove();
  }

  drawRun(run) {
    const line = el("li", {}, el("span", { class: "seq" }, run.seq), el("div", {}, this.sentenceOfRun(run)), when(run));
    if (run.line?.isConnected) run.line.replaceWith(line);
    else this.list.prepend(line);
    run.line = line;
  }

  sentenceOfRun({ kind, keyframes, sessions, keyframe }) {
    const last = keyframe ? this.refs.keyframe(keyframe) : "?";
    const names = [...sessions].map((name, index) => [index > 0 && ", ", sign(name)]);
    const of = sessions.size > 0 && [" of ", sessions.size > SESSIONS ? `${sessions.size} sessions` : names];
    if (keyframes === 1) return ["Keyframe ", last, of, ` ${RUNS[kind]}`];
    return [`${number(keyframes, 0)} keyframes`, of, ` ${RUNS[kind]}, the last `, last];
  }

  line(event) {
    const about = event.event.startsWith("loop") ? "loop" : "anchor";
    return el("li", { class: about }, el("span", { class: "seq" }, event.seq), el("div", {}, this.sentence(event)), when(event));
  }

  sentence(event) {
    const { anchor, keyframe, query } = this.refs;
    const [a, b] = [event.anchor, event.other].map((id) => (id ? anchor(id) : "?"));
    const [from, to] = [event.keyframe, event.candidate].map((id) => (id ? keyframe(id) : "?"));
    const [session, into] = [event.session, event.into].map((name) => sign(name ?? "?"));
    const text = event.detail ? sign(event.detail) : null;
    const beneath = text && el("p", { class: "muted small" }, text);
    switch (event.event) {
      case "poses_corrected": return ["The client of ", session, " corrected poses", text && [": ", text]];
      case "anchor_described": return text ? [a, " reads ", text] : [a, " has a new description"];
      case "anchors_matched": return [a, " was seen before, as ", b, text && [": ", text]];
      case "anchors_merged": return [b, " became one with ", a, beneath];
      case "anchor_retired":
        return [a, " hangs there no longer", event.other && ["; in its place ", b], beneath];
      case "loop_found":
        return ["Loop found: ", from, " is back at ", to, event.query && [" ", query(event.query, event.keyframe)]];
      case "loop_confirmed": return ["Loop ", named(event), " closed: ", from, " with ", to];
      case "loop_revoked": return ["Loop ", named(event), " revoked: ", from, " with ", to];
      case "loop_suspected": return ["Loop ", named(event), " contradicts the others", beneath];
      case "sessions_merged": return ["Session ", session, " became one with ", into];
      case "merge_revoked": return ["Sessions ", session, " and ", into, " are two again"];
      case "release_published": return ["Published: ", text ?? "a release"];
      default: return [event.event, text && [": ", text]];
    }
  }
}

function lengthen(run, { seq, keyframe, session, time }) {
  if (session) run.sessions.add(session);
  return Object.assign(run, { seq, keyframe, time, keyframes: run.keyframes + 1 });
}

/** When it happened, by the server's clock. Events of earlier servers have no time. */
function when({ time }) {
  return time && el("time", { class: "muted small" }, moment(time));
}

function named(event) {
  return el("code", {}, event.loop ?? "");
}
