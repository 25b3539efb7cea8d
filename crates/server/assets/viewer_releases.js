// Releases: named versions of the map: their list, publishing one, and deleting one.

import { list, path, put, remove, whyNotWrite } from "./viewer_api.js";
import { Changes } from "./viewer_changes.js";
import { count, el, fill, number, sign } from "./dom.js";

const NAME = /^(?!\.\.?$)[A-Za-z0-9._:-]{1,128}$/;
const DESCRIPTION_CHARACTERS = 4096;
const ASKERS = 3;
const UNITS = ["bytes", "kB", "MB", "GB", "TB"];

/** The tab of releases. */
export class Releases {
  /**
   * `world` gives `map()` and `version()`, `refs` makes references, and `marked(changes)` hears what to mark on the map: `null`,
   * nothing.
   */
  constructor(place, world, refs, marked) {
    Object.assign(this, { place, world, turn: new AbortController(), items: [], barred: null });
    this.form = this.publication();
    this.told = el("p", { role: "status" });
    this.list = el("div", {});
    const hint = "A release is the map as it stood, under a name. A loop query that names it is answered from it, whatever robots "
      + "write to the map.";
    this.overview = el("div", {}, el("p", { class: "hint" }, hint), this.form, this.told, this.list);
    this.changes = new Changes(world, refs, { marked, back: (name) => this.back(name) });
    fill(place, this.overview, this.changes.place);
  }

  /** Another map. */
  reset() {
    this.turn.abort();
    Object.assign(this, { items: [], barred: null });
    this.name.value = this.description.value = "";
    this.tell(null);
    this.fault(null);
    fill(this.list);
    this.changes.close();
    this.overview.hidden = false;
  }

  /** Reads the list again; what somebody is typing or comparing stays. */
  async refresh() {
    this.turn.abort();
    this.turn = new AbortController();
    const { signal } = this.turn;
    const map = this.world.map();
    this.changes.refresh();
    if (!this.button.disabled) this.button.textContent = `Publish version ${this.world.version()}`;
    try {
      const [{ items }, barred] = await Promise.all([list(path("maps", map, "releases"), { signal }), whyNotWrite(map)]);
      if (signal.aborted) return;
      this.items = items.sort((a, b) => b.published.sec - a.published.sec || b.published.nanosec - a.published.nanosec);
      this.barred = barred;
      this.bar();
      this.draw();
      this.changes.offer(this.items);
    } catch (error) {
      if (!signal.aborted) fill(this.list, el("p", { class: "fault", role: "alert" }, error.message));
    }
  }

  publication() {
    this.name = el("input", { autocomplete: "off", spellcheck: "false", placeholder: "2026-11", "aria-label": "Name of the release" });
    this.description = el("input", {
      autocomplete: "off", placeholder: "after the survey", maxlength: DESCRIPTION_CHARACTERS, "aria-label": "Description of the release",
    });
    this.button = el("button", { type: "submit", class: "main" }, "Publish");
    this.faultText = el("p", { class: "fault", id: "publish-fault", role: "alert", hidden: true });
    this.barredText = el("p", { class: "hint small", hidden: true });
    this.fields = el("fieldset", { class: "publish" },
      el("legend", {}, "Publish the map as it stands"),
      el("label", {}, el("span", {}, "Name"), this.name), el("label", {}, el("span", {}, "Description"), this.description),
      el("div", { class: "row" }, this.button));
    const submit = (event) => {
      event.preventDefault();
      this.publish();
    };
    return el("form", { submit, novalidate: true }, this.fields, this.faultText, this.barredText);
  }

  /** Nothing is offered that the key would be refused. */
  bar() {
    this.fields.disabled = this.barred !== null;
    this.barredText.hidden = this.barred === null;
    fill(this.barredText, "This key may read the releases, and neither publish nor delete one: ", this.barred);
  }

  async publish() {
    const name = this.name.value.trim();
    if (!NAME.test(name)) {
      this.fault(name === "" ? "It needs a name." : "A name has at most 128 of A–Z, a–z, 0–9 and . _ : -");
      return;
    }
    const map = this.world.map();
    this.fault(null);
    this.tell(null);
    this.button.disabled = true;
    this.button.textContent = "Publishing …";
    try {
      const description = this.description.value.trim();
      const { created, value } = await put(path("maps", map, "releases", name), { description });
      if (map !== this.world.map()) return;
      this.tell([el("code", {}, name), created ? " is published: " : " was published before: ", `version ${value.map_version}.`]);
      this.name.value = this.description.value = "";
    } catch (error) {
      if (map !== this.world.map()) return;
      const taken = "There is a release of this name already, and a release cannot be changed. Choose another name.";
      this.fault(error.code === "release_exists" ? taken : error.message);
    } finally {
      this.button.disabled = false;
      if (document.activeElement === document.body) this.button.focus();
      await this.refresh();
    }
  }

  fault(message) {
    this.faultText.hidden = message === null;
    fill(this.faultText, message);
    for (const [name, value] of [["aria-invalid", "true"], ["aria-describedby", "publish-fault"]]) {
      if (message === null) this.name.removeAttribute(name);
      else this.name.setAttribute(name, value);
    }
    if (message !== null) this.name.focus();
  }

  tell(words) {
    fill(this.told, words);
    this.told.hidden = words === null;
  }

  draw() {
    const lines = () => el("ul", { class: "lines releases" }, this.items.map((one) => this.line(one)));
    if (this.items.length === 0) fill(this.list, el("p", { class: "hint" }, "No release is published yet."));
    else fill(this.list, el("h3", {}, count(this.items.length, "release")), lines());
  }

  line(release) {
    const { name, description, map_version: version, erasures } = release;
    const isLatest = version === this.world.version();
    const sizes = [count(release.keyframes, "keyframe"), count(release.anchors, "anchor"), count(release.sessions, "session"),
      count(release.loops, "loop"), inUnits(release.bytes)];
    const erased = `Something was erased from it ${erasures === 1 ? "once" : `${number(erasures, 0)} times`}.`;
    return el("li", {},
      el("div", {}, el("b", { class: "mono" }, name), ` version ${number(version, 0)} `,
        isLatest && el("span", { class: "chip good" }, "as the map stands")),
      description && el("div", {}, sign(description)),
      el("div", { class: "muted small" }, `published ${day(release.published)}; `, sizes.join(", ")),
      erasures > 0 && el("div", { class: "muted small" }, erased),
      this.askers(release), this.acts(release));
  }

  askers({ asked_by: askers }) {
    if (askers.length === 0) return el("div", { class: "small muted" }, "No robot has asked it.");
    const one = ({ session, queries, last }) =>
      el("li", {}, sign(session), `: ${count(queries, "query", "queries")}, the last ${day(last)}`);
    return el("div", { class: "small" }, "Asked by", el("ul", { class: "askers" }, askers.slice(0, ASKERS).map(one)),
      askers.length > ASKERS && el("details", {}, el("summary", {}, `${number(askers.length - ASKERS, 0)} more`),
        el("ul", { class: "askers" }, askers.slice(ASKERS).map(one))));
  }

  /** Compare, and delete after a second question. */
  acts({ name, asked_by: askers }) {
    const place = el("div", { class: "row small" });
    const compare = el("button", {
      type: "button", "data-compare": name, "aria-label": `Compare ${name}`, click: () => this.compare(name),
    }, "Compare…");
    const first = () => {
      const isBarred = this.barred !== null;
      const ask = el("button", { type: "button", disabled: isBarred, "aria-label": `Delete ${name}`, click: sure }, "Delete…");
      fill(place, compare, ask);
      return ask;
    };
    const sure = () => {
      const robots = askers.length === 0 ? "No robot has asked it; one that does hears that it is not there (404)."
        : `${count(askers.length, "robot has", "robots have")} asked it, the last on ${day(askers[0].last)}. `
          + "From then on they hear that it is not there (404).";
      const keep = el("button", { type: "button", click: () => first().focus() }, "Keep it");
      fill(place, el("span", {}, "Nothing brings it back. ", robots),
        el("button", { type: "button", class: "danger", click: () => this.remove(name, place) }, "Delete the release"), keep);
      keep.focus();
    };
    first();
    return place;
  }

  async remove(name, place) {
    const map = this.world.map();
    fill(place, el("span", { class: "muted" }, "Deleting …"));
    try {
      await remove(path("maps", map, "releases", name));
    } catch (error) {
      fill(place, el("span", { class: "fault", role: "alert" }, error.message));
      return;
    }
    if (map !== this.world.map()) return;
    this.tell([el("code", {}, name), " is deleted."]);
    this.place.focus();
    await this.refresh();
  }

  compare(name) {
    this.overview.hidden = true;
    this.place.scrollTop = 0;
    this.changes.open(name, this.items);
  }

  /** From a comparison to the list, and to the button that led there. */
  back(name) {
    this.overview.hidden = false;
    const buttons = [...this.list.querySelectorAll("[data-compare]")];
    (buttons.find(({ dataset }) => dataset.compare === name) ?? this.name).focus();
  }
}

/** A moment of the server's clock. */
function day({ sec }) {
  return `${new Date(sec * 1000).toISOString().slice(0, 16).replace("T", " ")} UTC`;
}

function inUnits(bytes) {
  let [size, unit] = [bytes, 0];
  while (size >= 1000 && unit < UNITS.length - 1) [size, unit] = [size / 1000, unit + 1];
  return `${number(size, size < 10 && unit > 0 ? 1 : 0)} ${UNITS[unit]}`;
}
