// Lists: the map's anchors (searched by the server) and keyframes, for those who look by name or use no pointer.

import { classAndState, stateWords } from "./viewer_anchor_words.js";
import { list, path } from "./viewer_api.js";
import { thumbOf } from "./viewer_crop.js";
import { longList } from "./viewer_tables.js";
import { Trajectory } from "./viewer_trajectory.js";
import { byName, count, debounced, el, fill, number, sign } from "./dom.js";
import { ANCHOR_STATES } from "./words.js";

const SEARCH_WAIT_MS = 250;
const FILTER_WAIT_MS = 120;
const TEXT_CHARACTERS = 4096;
/** Among the states: what a plan says, whatever its state. */
const PLANNED = "prior";

/** The tab of anchors: a search box, a class, a state, and what they find. The box finds keyframes by their ids as well. */
export class AnchorList {
  /** `found(anchors, keyframes)` hears the ids of what a search found, `null` when none is on. */
  constructor(place, world, refs, found) {
    Object.assign(this, { place, world, refs, found, turn: new AbortController(), filters: { text: "", class: "", state: "" } });
    const later = debounced(() => this.search(), SEARCH_WAIT_MS);
    this.text = searchBox("Text of a sign, or id of a keyframe", later);
    this.text.addEventListener("keydown", (event) => this.pressed(event));
    this.classes = el("select", { "aria-label": "Class", change: () => this.search() });
    this.states = el("select", { "aria-label": "State", change: () => this.search() },
      el("option", { value: "" }, "every state"), el("option", { value: PLANNED }, "on a plan"),
      ANCHOR_STATES.map((state) => el("option", { value: state }, stateWords(state))));
    this.results = el("div", {});
    fill(place, el("div", { class: "filters" }, this.text, el("div", { class: "row" }, this.classes, this.states)), this.results);
  }

  /** The keyboard goes to the search box. */
  focus() {
    this.text.focus();
    this.text.select();
  }

  /** Enter and the arrow down lead into what was found, Escape takes the search off. */
  pressed(event) {
    if (event.key === "Enter" || event.key === "ArrowDown") {
      const first = this.results.querySelector("button.ref");
      if (!first) return;
      event.preventDefault();
      if (event.key === "Enter") first.click();
      else first.focus();
    } else if (event.key === "Escape" && this.text.value !== "") {
      event.preventDefault();
      this.text.value = "";
      this.search();
    }
  }

  /** Another map: no search is on. */
  reset() {
    this.text.value = this.states.value = "";
    this.known = null;
    fill(this.classes);
    this.found(null);
  }

  /** The map has changed; the search stays. */
  refresh() {
    const { classes } = this.world.scene();
    const known = classes.map(({ name }) => name).join("\n");
    if (known !== this.known) {
      const chosen = this.classes.value;
      const options = classes.map(({ name }) => el("option", { value: name }, name));
      fill(this.classes, el("option", { value: "" }, "every class"), options);
      this.classes.value = classes.some(({ name }) => name === chosen) ? chosen : "";
      this.known = known;
    }
    this.search();
  }

  async search() {
    this.turn.abort();
    this.turn = new AbortController();
    const { signal } = this.turn;
    const wanted = { text: this.text.value.trim(), class: this.classes.value, state: this.states.value };
    if (wanted.state === PLANNED) Object.assign(wanted, { state: "", prior: "true" });
    const parameters = Object.fromEntries(Object.entries(wanted).filter(([, value]) => value !== ""));
    if (Object.keys(parameters).length === 0) {
      this.found(null);
      this.show([...this.world.scene().anchors.values()]);
      return;
    }
    const keyframes = wanted.text === "" ? [] : this.keyframesLike(wanted.text);
    try {
      const { items } = await list(path("maps", this.world.map(), "anchors"), { signal, parameters });
      // Whoever looks for a keyframe still wants to see the signs around it.
      const isKeyframe = items.length === 0 && keyframes.length > 0;
      this.found(isKeyframe ? null : new Set(items.map(({ id }) => id)), keyframes.map(({ id }) => id));
      this.show(items, parameters, keyframes);
    } catch (error) {
      if (!signal.aborted) fill(this.results, el("p", { class: "fault", role: "alert" }, error.message));
    }
  }

  /** The keyframe of that id first, then those whose ids hold the text. */
  keyframesLike(text) {
    const wanted = text.toLowerCase();
    const is = ({ id }) => (id.toLowerCase() === wanted ? 0 : 1);
    return [...this.world.scene().keyframes.values()].filter(({ id }) => id.toLowerCase().includes(wanted))
      .sort((a, b) => is(a) - is(b) || byName(a.id, b.id));
  }

  /** What was found by `parameters`, or all anchors. */
  show(anchors, parameters = null, keyframes = []) {
    const found = [
      keyframes.length > 0 && [status(`${count(keyframes.length, "keyframe")} found`),
        longList(keyframes, "flow", ({ id }) => this.refs.keyframe(id))],
      anchors.length > 0 && [status(`${count(anchors.length, "anchor")}${parameters ? " found" : ""}`),
        longList(anchors, "lines", (anchor) => this.line(anchor))],
    ].filter(Boolean);
    fill(this.results, found.length > 0 ? found : el("p", { class: "hint", role: "status" }, nothing(parameters)));
  }

  line(anchor) {
    const text = anchor.description ? sign(anchor.description) : el("span", { class: "muted" }, "not described yet");
    const thumb = anchor.has_crop && thumbOf(path("maps", this.world.map(), "anchors", anchor.id, "crop"), this.turn.signal);
    return [el("div", {}, this.refs.anchor(anchor.id), " ", text, thumb),
      el("div", { class: "muted small" }, classAndState(anchor),
        anchor.matches_total > 0 && `, matches ${anchor.matches_total}`)];
  }
}

/** Why there is nothing to list. */
function nothing(parameters) {
  if (!parameters) return "No anchors yet. They come from the detections of keyframes: a class, a box, a text, and map points or a position.";
  const { text, ...others } = parameters;
  const none = Object.keys(others).length > 0 ? "No sign of this choice" : "No sign";
  return text === undefined ? `${none} is in the map.` : [none, " reads like ", sign(`“${text}”`), ", and no keyframe has such an id."];
}

/** The tab of keyframes, filtered by name here, and the trajectory that they make. */
export class KeyframeList {
  constructor(place, world, refs) {
    Object.assign(this, { place, world, refs });
    this.text = searchBox("Filter by id or session", debounced(() => this.refresh(), FILTER_WAIT_MS));
    this.results = el("div", {});
    const trajectory = el("div", { class: "row small" });
    this.trajectory = new Trajectory(trajectory, world);
    fill(place, el("div", { class: "filters" }, this.text, trajectory), this.results);
  }

  reset() {
    this.text.value = "";
  }

  refresh() {
    this.trajectory.refresh();
    const wanted = this.text.value.trim().toLowerCase();
    const all = [...this.world.scene().keyframes.values()];
    const keyframes = all.filter(({ id, session }) => `${id}\n${session}`.toLowerCase().includes(wanted))
      .sort((a, b) => byName(a.id, b.id));
    fill(this.results, status(`${wanted ? `${number(keyframes.length, 0)} of ` : ""}${count(all.length, "keyframe")}`),
      longList(keyframes, "lines", (keyframe) => [
        this.refs.keyframe(keyframe.id),
        el("span", { class: "muted small" }, " ", sign(keyframe.session),
          `, ${keyframe.covisible} covisible, ${count(keyframe.anchors.length, "anchor")}`)]));
  }
}

function searchBox(hint, input) {
  return el("input", { type: "search", placeholder: hint, "aria-label": hint, maxlength: TEXT_CHARACTERS, input });
}

function status(text) {
  return el("p", { class: "muted small", role: "status" }, text);
}
