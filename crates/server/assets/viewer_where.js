// Where: the tab that asks "where am I?" about a keyframe of a file, of a pasted text, or of the map.

import { keyframesOf, keyframesOfFile, stored, unplaced } from "./viewer_asked.js";
import { get, key, path, post } from "./viewer_api.js";
import { tellPlaces } from "./viewer_place.js";
import { count, debounced, el, fill, number, sign } from "./dom.js";

const ADDRESS = "v1/locate";
const WAIT_MS = 300;
const CAN_PASTE = "input, textarea, select";

/** The tab. A newer question wins over the answers to older ones. */
export class Where {
  /** `world` gives `map()`, `scene()` and `vocabulary()`; `opened()` hears that there is something to show, `answered(answer)` what to draw. */
  constructor(place, world, refs, { opened, answered }) {
    Object.assign(this, { place, world, refs, opened, answered, asked: [], from: null, turn: new AbortController() });
    const ask = () => this.ask();
    this.file = el("input", { type: "file", change: () => this.take([...this.file.files]) });
    this.text = el("textarea", {
      rows: 2, spellcheck: "false", placeholder: "or paste its JSON here", "aria-label": "A keyframe as JSON",
      input: debounced(() => this.typed(), WAIT_MS),
    });
    this.maps = el("select", { "aria-label": "Which maps to ask", change: ask });
    this.choice = el("select", { "aria-label": "Which keyframe to ask about", change: debounced(() => this.chosen(), WAIT_MS) });
    this.own = el("input", { type: "checkbox", change: ask });
    this.ownName = el("span", {});
    this.again = el("button", { type: "button", class: "main", click: ask }, "Ask again");
    this.forget = el("button", { type: "button", click: () => this.clear() }, "Clear");
    this.about = el("p", { class: "muted small" });
    this.controls = el("div", { class: "filters", hidden: true }, this.about, this.choice,
      el("label", { class: "tick" }, this.own, this.ownName), el("div", { class: "row" }, this.again, this.forget));
    this.spoken = el("p", { class: "offscreen", role: "status" });
    this.answer = el("div", {});
    fill(place, el("div", { class: "filters" },
      el("p", { class: "hint" }, "Drop a keyframe on this page to ask where its camera stands: the body of a keyframe as JSON, "
        + "a line of a recording, or a recording (.ndjson). It is compared with the maps and not stored."),
      el("label", { class: "file" }, el("span", {}, "Keyframe or recording"), this.file), this.text, this.maps),
    this.controls, this.spoken, this.answer);
    this.refresh();
    this.listen();
  }

  /** The shown map may be another one. */
  refresh() {
    const { value } = this.maps;
    const shown = `ask this map (${this.world.map() ?? "none"})`;
    if (this.maps.options[0]?.textContent === shown) return;
    fill(this.maps, el("option", { value: "this" }, shown),
      el("option", { value: "every" }, "ask every map that may be queried"));
    this.maps.value = value || "this";
  }

  /** A file may be dropped anywhere, and a keyframe pasted wherever there is no field for text. */
  listen() {
    const hasFiles = (event) => [...(event.dataTransfer?.types ?? [])].includes("Files");
    const over = (shown) => document.body.classList.toggle("dropping", shown && !isCovered());
    const listen = (name, hear) => addEventListener(name, (event) => hasFiles(event) && hear(event));
    // Without this the browser would leave the page for the file.
    listen("dragover", (event) => { event.preventDefault(); over(true); });
    listen("dragleave", ({ relatedTarget }) => relatedTarget === null && over(false));
    listen("drop", (event) => {
      event.preventDefault();
      over(false);
      this.take([...event.dataTransfer.files]);
    });
    document.addEventListener("paste", (event) => {
      if (event.target.closest?.(CAN_PASTE)) return;
      const [files, text] = [[...event.clipboardData.files], event.clipboardData.getData("text").trim()];
      if (files.length > 0) this.take(files);
      else if (text.startsWith("{")) this.read("the pasted text", () => keyframesOf(text));
    });
  }

  typed() {
    const text = this.text.value.trim();
    if (text !== "") this.read("the pasted text", () => keyframesOf(text));
  }

  /** One file is asked about; of several, the first. */
  take([file]) {
    if (file) this.read(file.name, () => keyframesOfFile(file));
  }

  /** Asks about a keyframe of the shown map, without its own session. */
  async ofMap(id) {
    const map = this.world.map();
    const address = path("maps", map, "keyframes", id);
    const read = this.read(`map ${map}`, async () => ({ keyframes: [stored(await get(address), this.world.vocabulary())], more: 0 }));
    // The button that was pressed is hidden now.
    this.place.focus();
    await read;
  }

  async read(from, keyframes) {
    if (isCovered()) return;
    const signal = this.begin();
    this.opened();
    this.forgetAnswer("Reading …");
    this.controls.hidden = true;
    this.asked = [];
    try {
      const { keyframes: asked, more } = await keyframes();
      if (signal.aborted) return;
      Object.assign(this, { asked, from, more });
      this.list();
      await this.chosen();
    } catch (error) {
      if (!signal.aborted) this.failed(error, [sign(from), ": "]);
    } finally {
      // The same file may be chosen again once it is mended.
      if (!signal.aborted) this.file.value = "";
    }
  }

  list() {
    const named = ({ id, session }, index) => [id ?? `keyframe ${index + 1}`, session].filter(Boolean).join(", ");
    fill(this.choice, this.asked.map((one, index) => el("option", { value: index }, named(one, index))));
    this.choice.hidden = this.asked.length < 2;
    const one = this.asked[0].id ? ["Keyframe ", el("code", {}, this.asked[0].id)] : "The keyframe";
    fill(this.about, this.asked.length < 2 ? one : count(this.asked.length, "keyframe"), " of ", sign(this.from),
      this.more > 0 && `; ${number(this.more, 0)} more are not listed`);
    this.controls.hidden = false;
  }

  get one() {
    return this.asked[Number(this.choice.value)];
  }

  /** A keyframe that the map has would find itself, and those beside it: its session is left out at first. */
  chosen() {
    const { id, session } = this.one;
    this.own.parentElement.hidden = session === null;
    this.own.checked = session !== null && this.world.scene().keyframes.get(id)?.session === session;
    fill(this.ownName, "Leave out its session ", sign(session ?? ""));
    return this.ask();
  }

  question() {
    const { session, body } = this.one;
    const question = { keyframe: unplaced(body()) };
    if (this.maps.value === "this" && this.world.map() !== null) question.maps = [this.world.map()];
    if (session !== null && this.own.checked) question.exclude = { sessions: [session] };
    return question;
  }

  async ask() {
    if (this.asked.length === 0) return;
    const signal = this.begin();
    this.forgetAnswer("Asking …");
    try {
      const question = this.question();
      const answer = await post(ADDRESS, question, signal);
      if (signal.aborted) return;
      const { refs, world } = this;
      fill(this.answer, tellPlaces(answer, { refs, map: world.map(), scene: world.scene(), curl: () => curlOf(question) }));
      this.spoken.textContent = this.answer.querySelector("h3").textContent;
      this.answered(answer);
    } catch (error) {
      if (!signal.aborted) this.failed(error);
    }
  }

  begin() {
    this.turn.abort();
    this.turn = new AbortController();
    return this.turn.signal;
  }

  failed(error, from) {
    this.forgetAnswer();
    fill(this.answer, refusal(error, from));
  }

  forgetAnswer(instead = "") {
    fill(this.answer, instead && el("p", { class: "muted" }, instead));
    this.spoken.textContent = "";
    this.answered(null);
  }

  clear() {
    this.begin();
    Object.assign(this, { asked: [], from: null });
    this.text.value = this.file.value = "";
    this.controls.hidden = true;
    this.forgetAnswer();
    this.file.focus();
  }
}

/** Nothing is asked while the page says that there is no map, or wants a key. */
function isCovered() {
  return document.body.classList.contains("covered");
}

/** Why there is no answer, with each fault of the question at its place. */
function refusal({ message, told, faults = [] }, from) {
  if (faults.length === 0) return el("p", { class: "fault", role: "alert" }, from, message);
  return el("div", { class: "fault", role: "alert" }, el("p", {}, from, told),
    el("ul", { class: "lines" }, faults.map(({ pointer, detail, got, limit }) => el("li", {},
      el("div", {}, el("code", {}, pointer || "/"), " ", detail),
      el("div", { class: "muted small" }, got && ["got ", sign(got)], got && limit && "; ", limit && `allowed: ${limit}`)))));
}

/** The question from standard input: a keyframe is longer than an argument may be, and a sign may hold any quote. */
function curlOf(question) {
  const url = new URL(ADDRESS, document.baseURI).href;
  const keyed = key() ? " \\\n  -H \"authorization: Bearer $REVISIT_KEY\"" : "";
  return `curl -X POST ${url}${keyed} \\\n  -H 'content-type: application/json' \\\n  --data-binary @- <<'END'\n${JSON.stringify(question)}\nEND`;
}
