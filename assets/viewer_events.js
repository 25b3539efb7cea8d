// Events: the map's server-sent events as they come, and their list.

import { key, path, send } from "./viewer_api.js";
import { el, fill, sign } from "./dom.js";
import { EVENTS } from "./words.js";

const SHOWN = 200;
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
    this.tab.textContent = "Events";
    this.list = el("ol", { class: "events" });
    const hint = "Nothing has happened yet. Described anchors, matches, merges and loops appear here as they happen.";
    fill(this.place, this.list, el("p", { class: "hint" }, hint));
  }

  add(event) {
    this.total += 1;
    this.fresh.push(event);
    if (this.fresh.length > SHOWN) this.fresh.shift();
    if (this.drawing) return;
    this.drawing = true;
    requestAnimationFrame(() => this.draw());
  }

  draw() {
    this.drawing = false;
    this.tab.textContent = `Events ${this.total}`;
    this.place.querySelector(".hint")?.remove();
    this.list.prepend(...this.fresh.reverse().map((event) => this.line(event)));
    this.fresh = [];
    while (this.list.childElementCount > SHOWN) this.list.lastElementChild.remove();
  }

  line(event) {
    const about = event.event.startsWith("loop") ? "loop" : "anchor";
    return el("li", { class: about }, el("span", { class: "seq" }, event.seq), el("div", {}, this.sentence(event)));
  }

  sentence(event) {
    const { anchor, keyframe, query } = this.refs;
    const [a, b] = [event.anchor, event.other].map((id) => (id ? anchor(id) : "?"));
    const [from, to] = [event.keyframe, event.candidate].map((id) => (id ? keyframe(id) : "?"));
    const text = event.detail ? sign(event.detail) : null;
    switch (event.event) {
      case "anchor_described": return text ? [a, " reads ", text] : [a, " has a new description"];
      case "anchors_matched": return [a, " was seen before, as ", b, text && [": ", text]];
      case "anchors_merged": return [b, " became one with ", a, text && el("p", { class: "muted small" }, text)];
      case "anchor_retired":
        return [a, " hangs there no longer", event.other && ["; in its place ", b], text && el("p", { class: "muted small" }, text)];
      case "loop_found":
        return ["Loop found: ", from, " is back at ", to, event.query && [" (", query(event.query, event.keyframe), ")"]];
      case "loop_confirmed": return ["Loop ", named(event), " closed: ", from, " with ", to];
      case "loop_revoked": return ["Loop ", named(event), " revoked: ", from, " with ", to];
      default: return [event.event, text && [": ", text]];
    }
  }
}

function named(event) {
  return el("code", {}, event.loop ?? "");
}
