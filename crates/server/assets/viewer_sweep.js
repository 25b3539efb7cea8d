// Sweep: asks about every keyframe of a session, and lists by their reasons those that are no loop, near misses first.

import { path, post } from "./viewer_api.js";
import { longList } from "./viewer_tables.js";
import { why } from "./viewer_verdict.js";
import { shortfall } from "./viewer_why_not.js";
import { REASONS } from "./words.js";
import { count, el, fill, number } from "./dom.js";

/** More would keep a server busy that has robots to serve. */
const MOST = 500;

/** A form and its list. `world` gives `map()` and `scene()`; `refs` makes references to keyframes and queries. */
export class Sweep {
  constructor(place, world, refs) {
    Object.assign(this, { world, refs, found: [], turn: null });
    this.session = el("select", { "aria-label": "Session to ask about" });
    this.button = el("button", { type: "button", click: () => (this.turn ? this.stop() : this.ask()) });
    this.reason = el("select", { "aria-label": "Reason", change: () => this.list() });
    this.status = el("p", { class: "muted small", role: "status" });
    this.results = el("div", {});
    fill(place, el("h3", {}, "Why not?"), el("p", { class: "muted small" },
      "Asks about each keyframe of a session, and lists those that are no loop by what stopped their best candidate."),
    el("div", { class: "filters" }, el("div", { class: "row" }, this.session, this.button), this.reason), this.status, this.results);
    this.reset();
  }

  /** Another map: nothing has been asked. */
  reset() {
    this.stop();
    this.found = [];
    this.known = null;
    this.status.textContent = "";
    this.list();
  }

  /** The sessions may be others. */
  refresh() {
    const names = this.world.scene().sessions.map(({ name }) => name);
    if (names.join("\n") === this.known) return;
    this.known = names.join("\n");
    const { value } = this.session;
    fill(this.session, names.map((name) => el("option", { value: name }, name)));
    if (names.includes(value)) this.session.value = value;
  }

  stop() {
    this.turn?.abort();
    this.turn = null;
    this.button.textContent = "Ask about them";
  }

  /** One question at a time. */
  async ask() {
    const session = this.world.scene().sessions.find(({ name }) => name === this.session.value);
    if (!session) return;
    const { signal } = this.turn = new AbortController();
    this.button.textContent = "Stop";
    this.found = [];
    this.list();
    const asked = session.keyframes.slice(0, MOST);
    let loops = 0;
    try {
      for (const [index, { id }] of asked.entries()) {
        const answer = await post(path("maps", this.world.map(), "loop-queries"), { keyframe: id }, signal);
        if (signal.aborted) return;
        if (answer.verdict === "loop") loops += 1;
        else this.found.push({ keyframe: id, query: answer.id, ...nearest(answer) });
        this.status.textContent = `${number(index + 1, 0)} of ${count(asked.length, "keyframe")} asked about, `
          + `${count(loops, "loop")}${session.keyframes.length > MOST ? `; the session has ${number(session.keyframes.length, 0)}` : ""}`;
      }
    } catch (error) {
      if (!signal.aborted) fill(this.status, el("span", { class: "fault" }, error.message));
    } finally {
      if (!signal.aborted) {
        this.stop();
        this.list();
      }
    }
  }

  list() {
    const codes = new Map();
    for (const { reason } of this.found) codes.set(reason?.code, (codes.get(reason?.code) ?? 0) + 1);
    const { value } = this.reason;
    fill(this.reason, el("option", { value: "" }, `every reason (${number(this.found.length, 0)})`),
      [...codes].map(([code, n]) => el("option", { value: code ?? "none" }, `${REASONS[code]?.title ?? "no reason"} (${number(n, 0)})`)));
    this.reason.value = codes.has(value) ? value : "";
    this.reason.hidden = this.found.length === 0;
    const shown = this.found.filter(({ reason }) => this.reason.value === "" || reason?.code === this.reason.value)
      .toSorted((a, b) => shortfall(a) - shortfall(b) || 0);
    fill(this.results, shown.length > 0 && longList(shown, "lines", ({ keyframe, candidate, query, reason }) => [
      el("div", {}, this.refs.keyframe(keyframe), candidate && [" against ", this.refs.keyframe(candidate)],
        " ", this.refs.query(query, keyframe)),
      reason && el("div", { class: "muted small" }, why(reason))]));
  }
}

/** The candidate that failed by least, and its reason; without one, the reason of the whole answer. */
function nearest({ candidates, reason }) {
  const [best] = candidates.filter((one) => one.reason).sort((a, b) => (shortfall(a) - shortfall(b)) || 0);
  return best && reason === undefined ? { candidate: best.keyframe, reason: best.reason } : { reason };
}
