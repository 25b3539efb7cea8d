// Verdicts: the tab of the loop queries that were answered, rejections first, and why.

import { get, path } from "./viewer_api.js";
import { moment } from "./viewer_time.js";
import { chipOf } from "./viewer_verdict.js";
import { el, fill, sign } from "./dom.js";
import { REASONS } from "./words.js";

const PAGE = 100;
const ANSWERS = [["no_loop", "rejected"], ["loop", "loop"], ["undecided", "undecided"], ["", "every verdict"]];

/** The tab. `world` gives `map()` and `scene()`; `open(line)` hears which one was chosen. */
export class Verdicts {
  constructor(place, world, open) {
    Object.assign(this, { world, open, turn: new AbortController() });
    const choice = (name, options) => el("select", { "aria-label": name, change: () => this.refresh() }, options);
    this.verdict = choice("Verdict", ANSWERS.map(([value, words]) => el("option", { value }, words)));
    this.session = choice("Session");
    const titles = Object.entries(REASONS).map(([code, { title }]) => el("option", { value: code }, title));
    this.reason = choice("Reason", [el("option", { value: "" }, "every reason"), titles]);
    const again = el("button", { type: "button", click: () => this.refresh() }, "Read again");
    this.list = el("ul", { class: "lines" });
    this.more = el("button", { type: "button", hidden: true, click: () => this.read() }, "Older ones");
    this.said = el("p", { class: "hint", role: "status" });
    fill(place, el("div", { class: "filters" },
      el("div", { class: "row" }, this.verdict, this.session), el("div", { class: "row" }, this.reason, again)),
    this.said, this.list, this.more);
    this.reset();
  }

  /** Another map. */
  reset() {
    this.turn.abort();
    this.verdict.value = ANSWERS[0][0];
    this.reason.value = "";
    fill(this.session, el("option", { value: "" }, "every session"));
    fill(this.list);
  }

  /** Reads the newest ones; the choice stays. */
  refresh() {
    const { value } = this.session;
    const names = this.world.scene().sessions.map(({ name }) => name);
    fill(this.session, el("option", { value: "" }, "every session"), names.map((name) => el("option", { value: name }, name)));
    this.session.value = names.includes(value) ? value : "";
    this.cursor = null;
    return this.read();
  }

  async read() {
    this.turn.abort();
    this.turn = new AbortController();
    const { signal } = this.turn;
    const isFirst = this.cursor === null;
    const wanted = { verdict: this.verdict.value, session: this.session.value, reason: this.reason.value, cursor: this.cursor ?? "" };
    const query = new URLSearchParams({ ...Object.fromEntries(Object.entries(wanted).filter(([, value]) => value !== "")), limit: PAGE });
    try {
      const { items, next_cursor: cursor } = await get(`${path("maps", this.world.map(), "loop-queries")}?${query}`, signal);
      if (signal.aborted) return;
      if (isFirst) fill(this.list);
      this.list.append(...items.map((line) => this.row(line)));
      this.cursor = cursor;
      this.more.hidden = cursor === null;
      this.said.className = "hint";
      this.said.textContent = this.list.childElementCount > 0 ? "" : "No loop query has been answered so. A robot asks with POST …/loop-queries, "
        + "and the button “Is it a loop?” of a keyframe asks here.";
      this.said.hidden = this.list.childElementCount > 0;
    } catch (error) {
      if (signal.aborted) return;
      this.said.hidden = false;
      this.said.className = "fault";
      this.said.textContent = error.message;
    }
  }

  row(line) {
    const { keyframe, candidate, session, time, verdict, why } = line;
    return el("li", {}, el("button", { type: "button", class: "verdict-line", click: () => this.open(line) },
      el("span", { class: "muted small" }, moment(time), session && [", ", sign(session)]),
      el("span", {}, el("code", {}, keyframe ?? "not stored"), candidate && [" at ", el("code", {}, candidate)], " ", chipOf(verdict)),
      el("span", {}, sign(why))));
  }
}

/** What is known of an answer whose whole is no longer recorded. */
export function lineOnly({ keyframe, candidate, verdict, why }, refs) {
  return [el("p", {}, keyframe ? refs.keyframe(keyframe) : "A keyframe that is not stored",
    candidate && [" at ", refs.keyframe(candidate)], " ", chipOf(verdict)),
  el("p", {}, sign(why)),
  el("p", { class: "muted" }, "The whole answer is no longer recorded. The keyframe can be asked about again.")];
}
