// Events: the map's server-sent events as they come, and their list.

import { key, path, send } from "./viewer_api.js";
import { brief, el, fill, number, sign } from "./dom.js";
import { EVENTS } from "./words.js";

const SHOWN = 200;
const SESSIONS = 3;
/** Events that come in runs, and what they say of their keyframes. */
const RUNS = { keyframe_stored: "stored", keyframe_removed: "removed" };
const RETRY_MS = 4000;

/** Listens to a map from its first event on; `stop()` ends it. */
export function listen(map, { event, state }) {
  const address = `${path("maps", map, "events")}?since=0`;
  return key() ? listenWithKey(address, event, state) : listenOpenly(address, event, state);
}

function listenOpenly(address, event, state) {
  let source = null;
  let retry = null;
  let last = 0;
  const take = (message) => {
    const told = JSON.parse(message.data);
    // After a retry of ours the stream starts anew.
    if (told.seq <= last) return;
    last = told.seq;
    event(told);
  };
  const open = () => {
    source = new EventSource(address);
    source.addEventListener("open", () => state("live"));
    source.addEventListener("error", () => {
      state("away");
      // The browser comes back by itself unless the answer was no stream.
      if (source.readyState === EventSource.CLOSED) retry = setTimeout(open, RETRY_MS);
    });
    for (const name of EVENTS) source.addEventListener(name, take);
  };
  open();
  return { stop() { clearTimeout(retry); source.close(); } };
}

/** EventSource sends no key, so this reads the stream by hand. */
function listenWithKey(address, event, state) {
  const stopped = new AbortController();
  let last = 0;
  const read = async () => {
    const headers = last ? { "last-event-id": String(last) } : {};
    const response = await send(address, { signal: stopped.signal, headers });
    state("live");
    const reader = response.body.pipeThrough(new TextDecoderStream()).getReader();
    for (let rest = ""; ;) {
      const { value, done } = await reader.read();
      if (done) return;
      const blocks = (rest + value).split("\n\n");
      rest = blocks.pop();
      for (const block of blocks) {
        const data = block.split("\n").filter((line) => line.startsWith("data:")).map((line) => line.slice(5)).join("\n");
        if (!data) continue;
        const told = JSON.parse(data);
        last = told.seq;
        event(told);
      }
    }
  };
  (async () => {
    while (!stopped.signal.aborted) {
      await read().catch(() => {});
      state("away");
      await new Promise((resume) => { setTimeout(resume, RETRY_MS); });
    }
  })();
  return { stop() { stopped.abort(); } };
}

/** The list of events, newest first. A long history comes in one gush: it is drawn once for each frame. */
export class EventList {
  constructor(place, tab, refs) {
    Object.assign(this, { place, tab, refs, total: 0, fresh: [], drawing: false });
    this.clear();
  }

  clear() {
    this.total = 0;
    this.fresh = [];
    this.run = null;
    this.tab.textContent = "Events";
    this.list = el("ol", { class: "events" });
    const hint = "Nothing has happened yet. Keyframes, described anchors, matches, merges and loops appear here as they happen.";
    fill(this.place, this.list, el("p", { class: "hint" }, hint));
  }

  /** Keyframes that come or go one after the other are one line. */
  add(event) {
    this.total += 1;
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
    const line = el("li", {}, el("span", { class: "seq" }, run.seq), el("div", {}, this.sentenceOfRun(run)));
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
    return el("li", { class: about }, el("span", { class: "seq" }, event.seq), el("div", {}, this.sentence(event)));
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
        return ["Loop found: ", from, " is back at ", to, event.query && [" (", query(event.query, event.keyframe), ")"]];
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

function lengthen(run, { seq, keyframe, session }) {
  if (session) run.sessions.add(session);
  return Object.assign(run, { seq, keyframe, keyframes: run.keyframes + 1 });
}

function named(event) {
  return el("code", {}, event.loop ?? "");
}
