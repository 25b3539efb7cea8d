// Verdicts: the tab of the loop queries that were answered, rejections first, and why.

import { get, path } from "./viewer_api.js";
import { moment } from "./viewer_time.js";
import { chipOf } from "./viewer_verdict.js";
import { el, fill, sign } from "./dom.js";
import { REASONS } from "./words.js";

const PAGE = 200;
/** So many lines are enough to begin with, and so many parts of the list are read for them. */
const ENOUGH = 50;
const PARTS = 5;
/** No new loop, because the return is closed: that is no rejection. */
const CLOSED = "already_closed";
/** The choices, and what each asks for. */
const ANSWERS = {
  rejected: { verdict: "no_loop" }, loop: { verdict: "loop" }, undecided: { verdict: "undecided" },
  "closed already": { verdict: "no_loop", reason: CLOSED }, "every verdict": {},
};

/** The tab. `world` gives `map()` and `scene()`; `open(line)` hears which one was chosen. */
export class Verdicts {
  constructor(place, world, open) {
    Object.assign(this, { world, open, turn: new AbortController() });
    const choice = (name, options) => el("select", { "aria-label": name, change: () => this.refresh() }, options);
    this.verdict = choice("Verdict", Object.keys(ANSWERS).map((words) => el("option", {}, words)));
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
    this.verdict.selectedIndex = 0;
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
    try {
      const lines = await this.lines(signal);
      if (signal.aborted) return;
      if (isFirst) fill(this.list);
      this.list.append(...lines.map((line) => this.row(line)));
      this.more.hidden = this.cursor === null;
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

  /** The lines from the cursor on. The server knows no question for rejections alone: what is closed already is left out here. */
  async lines(signal) {
    const choice = this.verdict.value;
    const wanted = { session: this.session.value, reason: this.reason.value, ...ANSWERS[choice] };
    const isShown = ({ reason }) => choice !== "rejected" || wanted.reason === CLOSED || reason !== CLOSED;
    const lines = [];
    let cursor = this.cursor;
    for (let parts = 0; parts < PARTS && lines.length < ENOUGH; parts += 1) {
      const asked = Object.entries({ ...wanted, cursor: cursor ?? "", limit: PAGE }).filter(([, value]) => value !== "");
      const part = await get(`${path("maps", this.world.map(), "loop-queries")}?${new URLSearchParams(asked)}`, signal);
      lines.push(...part.items.filter(isShown));
      cursor = part.next_cursor;
      if (cursor === null) break;
    }
    if (!signal.aborted) this.cursor = cursor;
    return lines;
  }

  row(line) {
    const { keyframe, candidate, session, time, verdict, reason, why } = line;
    return el("li", {}, el("button", { type: "button", class: "verdict-line", click: () => this.open(line) },
      el("span", { class: "muted small" }, moment(time), session && [", ", sign(session)]),
      el("span", {}, el("code", {}, keyframe ?? "not stored"), candidate && [" at ", el("code", {}, candidate)], " ",
        reason === CLOSED ? el("span", { class: "chip" }, "closed already") : chipOf(verdict)),
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
