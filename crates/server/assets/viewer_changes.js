// Changes: what a map has that a release has not, or another release: in words, as lists, and marked on the map.

import { get, path } from "./viewer_api.js";
import { longList } from "./viewer_tables.js";
import { count, el, fill, number, sign } from "./dom.js";

const LISTED = 1000;
/** The map as it stands, among the names of releases, none of which is empty. */
const NOW = "";

/** Kinds of changes, in the order of what they mean to a robot: as a count, and as the title of a list. */
const SIGNS = [
  ["retired", "sign hangs there no longer", "signs hang there no longer", "Signs that hang there no longer"],
  ["described", "sign reads otherwise", "signs read otherwise", "Signs that read otherwise"],
  ["returned", "sign hangs there again", "signs hang there again", "Signs that hang there again"],
  ["added", "anchor is new", "anchors are new", "New anchors"],
  ["removed", "anchor is gone", "anchors are gone", "Anchors that are gone"],
];
const KEYFRAMES = [
  ["added", "keyframe was added", "keyframes were added", "Keyframes that were added"],
  ["removed", "keyframe was removed", "keyframes were removed", "Keyframes that were removed"],
  ["moved", "keyframe has another pose", "keyframes have another pose", "Keyframes that have another pose"],
];

/** A comparison in the tab of releases. */
export class Changes {
  /** `on.marked(changes)` hears what to mark on the map, and `on.back(release)` that the comparison is over. */
  constructor(world, refs, on) {
    Object.assign(this, { world, refs, on, since: null, turn: new AbortController(), known: 0 });
    this.choices = ["Compare", "With"].map((name) => el("select", { "aria-label": name, change: () => this.chosen() }));
    const [from, to] = this.choices;
    this.title = el("h2", { tabindex: "-1" }, "What changed");
    const back = el("button", { type: "button", click: () => this.leave() }, "Back to the releases");
    this.result = el("div", {});
    this.place = el("div", { hidden: true },
      el("div", { class: "row" }, this.title, back),
      el("div", { class: "row sides" }, el("label", {}, "from ", from), el("label", {}, "to ", to)), this.result);
  }

  open(release, releases) {
    Object.assign(this, { since: release, until: NOW });
    this.place.hidden = false;
    this.offer(releases);
    this.title.focus();
    this.read();
  }

  close() {
    this.turn.abort();
    this.since = null;
    this.place.hidden = true;
    fill(this.result);
    this.on.marked(null);
  }

  leave() {
    const { since } = this;
    this.close();
    this.on.back(since);
  }

  /** The releases that there are now; whoever compared one that is gone goes back to the list. */
  offer(releases) {
    if (this.since === null) return;
    const names = releases.map(({ name }) => name);
    if ([this.since, this.until].some((name) => name !== NOW && !names.includes(name))) {
      this.leave();
      return;
    }
    this.versions = new Map(releases.map(({ name, map_version: version }) => [name, version]));
    this.choices.forEach((choice, side) => fill(choice, side === 1 && el("option", { value: NOW }, "the map as it stands"),
      releases.map(({ name, map_version: version }) => el("option", { value: name }, `${name} (version ${version})`))));
    this.show();
  }

  show() {
    const [from, to] = this.choices;
    [from.value, to.value] = [this.since, this.until];
  }

  /** Time runs forward: two releases that were chosen the other way round change sides. */
  chosen() {
    [this.since, this.until] = this.choices.map(({ value }) => value);
    if (this.until !== NOW && this.versions.get(this.until) < this.versions.get(this.since)) {
      [this.since, this.until] = [this.until, this.since];
    }
    this.show();
    this.read();
  }

  /** The map has changed: so has what a release is compared with. */
  refresh() {
    if (this.since !== null && this.until === NOW && this.known < this.world.version()) this.read();
  }

  async read() {
    this.turn.abort();
    this.turn = new AbortController();
    const { signal } = this.turn;
    const query = new URLSearchParams({ since: this.since, limit: String(LISTED), ...(this.until !== NOW && { until: this.until }) });
    if (this.result.childElementCount === 0) fill(this.result, el("p", { class: "muted" }, "Comparing …"));
    try {
      const changes = await get(`${path("maps", this.world.map(), "changes")}?${query}`, signal);
      if (signal.aborted) return;
      this.known = changes.until_version;
      this.draw(changes);
      this.on.marked(marksOfChanges(changes));
    } catch (error) {
      if (signal.aborted) return;
      fill(this.result, el("p", { class: "fault", role: "alert" }, error.message));
      this.on.marked(null);
    }
  }

  draw(changes) {
    const { since_version: since, until_version: until } = changes;
    const words = [...sentences(changes, "anchors", SIGNS), ...sentences(changes, "keyframes", KEYFRAMES)];
    fill(this.result,
      el("p", { class: "muted small" }, `From version ${number(since, 0)} to version ${number(until, 0)}`,
        this.until === NOW && ", as the map stands", "."),
      words.length === 0
        ? el("p", { class: "counts", role: "status" }, "Nothing changed: keyframes, anchors and what the signs read are the same.")
        : el("ul", { class: "counts", role: "status" }, words.map((one) => el("li", {}, one))),
      SIGNS.map((kind) => this.listed(changes, "anchors", kind, (one) => this.anchor(one))),
      KEYFRAMES.map((kind) => this.listed(changes, "keyframes", kind, (one) => this.keyframe(one))));
  }

  listed(changes, of, [kind, , , title], line) {
    const items = changes[of].filter(({ change }) => change === kind);
    if (items.length === 0) return null;
    if (kind === "moved") items.sort((a, b) => b.moved_m - a.moved_m);
    const all = changes[`${of}_${kind}`];
    return el("section", { "data-change": `${of}-${kind}` },
      el("h3", {}, title),
      all > items.length && el("p", { class: "muted small" }, `The first ${number(items.length, 0)} of ${number(all, 0)}.`),
      longList(items, kind === "added" && of === "keyframes" ? "flow" : "lines", line));
  }

  anchor({ change, anchor, class: name, before, after }) {
    const is = this.world.scene().anchors.has(anchor) ? this.refs.anchor(anchor) : el("code", {}, anchor);
    const text = (one) => (one === undefined ? el("span", { class: "muted" }, "not described") : sign(one));
    const reads = change === "described" ? [text(before), " → ", text(after)] : text(after ?? before);
    return [is, " ", reads, el("span", { class: "muted small" }, ` ${name}`)];
  }

  keyframe({ keyframe, moved_m: moved }) {
    const is = this.world.scene().keyframes.has(keyframe) ? this.refs.keyframe(keyframe) : el("code", {}, keyframe);
    return [is, moved !== undefined && el("span", { class: "muted small" }, moved < 0.005 ? " turned" : ` by ${number(moved, 2)} m`)];
  }
}

function sentences(changes, of, kinds) {
  return kinds.filter(([kind]) => changes[`${of}_${kind}`] > 0).map(([kind, one, many]) => count(changes[`${of}_${kind}`], one, many));
}

/** What to mark: the tone of each keyframe and anchor, and whether it is crossed out. An anchor with two changes has the graver one. */
function marksOfChanges({ keyframes, anchors }) {
  const tones = { added: "good", returned: "good", moved: "open", described: "open", retired: "bad" };
  const order = SIGNS.map(([kind]) => kind);
  const graver = anchors.toSorted((a, b) => order.indexOf(b.change) - order.indexOf(a.change));
  return {
    keyframes: new Map(keyframes.filter(({ change }) => tones[change]).map(({ keyframe, change }) => [keyframe, tones[change]])),
    anchors: new Map(graver.filter(({ change }) => tones[change]).map(({ anchor, change, before, after }) =>
      [anchor, { tone: tones[change], isCrossed: change === "retired", text: after ?? before ?? "" }])),
  };
}
