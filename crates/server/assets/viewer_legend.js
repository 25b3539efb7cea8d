// Legend: what is on the canvas, in words: the choice of sessions, the colours, and the thing under the pointer.

import { classAndState } from "./viewer_anchor_words.js";
import { classColour, sessionColour, theme } from "./viewer_colours.js";
import { count, el, number, sign } from "./dom.js";

const SESSIONS = 6;
const CLASSES = 8;

/** The choices of sessions: all of them, in up to three ways, or one by its name. */
export function sessionOptions({ sessions, plans, joined }) {
  const one = sessions.map(({ name, keyframes: { length } }) => el("option", { value: `=${name}` }, `${name} (${length})`));
  const planned = plans.map(({ name, anchors: { length } }) =>
    el("option", { value: `=${name}` }, `${name} (${count(length, "sign")})`));
  const ofPlans = plans.length > 0 && el("optgroup", { label: "One plan" }, planned);
  if (sessions.length === 0) return planned;
  if (sessions.length === 1) return [one, ofPlans];
  return [joined > 1 && el("option", { value: "fleet" }, joined === sessions.length ? `${joined} sessions, in one frame`
    : `${joined} of ${sessions.length} sessions in one frame`), el("option", { value: "apart" }, `${sessions.length} sessions, side by side`),
    el("option", { value: "over" }, `${sessions.length} sessions, overlaid`), el("optgroup", { label: "One session" }, one), ofPlans];
}

/** The glyphs that are on the canvas, in the colours in which they are drawn. */
export function legend({ classes, sessions, plans, loops, suspects, anchors: all }, changes = null) {
  const tones = theme();
  const glyph = (kind, colour) => {
    const mark = el("span", { class: `glyph ${kind}` });
    mark.style.color = colour;
    return mark;
  };
  const pending = [...all.values()].filter((anchor) => anchor.state === "pending");
  const assumed = sessions.flatMap(({ anchors }) => anchors).filter((anchor) => anchor.assumed).length;
  const ofPending = classes.find(({ name }) => name === pending[0]?.class)?.index ?? 0;
  const signs = plans.reduce((sum, { anchors }) => sum + anchors.length, 0);
  return [
    changes && changed(changes).map(([kind, tone, text]) => el("div", {}, glyph(kind, tones[tone]), text)),
    sessions.length <= SESSIONS
      && sessions.map(({ name, index }) => el("div", {}, glyph("round", sessionColour(index)), sign(name))),
    classes.slice(0, CLASSES).map(({ name, size, index }) =>
      el("div", {}, glyph("", classColour(index)), sign(name), ` ${number(size, 0)}`)),
    classes.length > CLASSES && el("div", {}, `and ${count(classes.length - CLASSES, "more class", "more classes")}`),
    pending.length > 0 && el("div", {}, glyph("hollow", classColour(ofPending)), `not described yet ${number(pending.length, 0)}`),
    assumed > 0 && el("div", {}, glyph("ring broken", tones.muted), `distance assumed ${number(assumed, 0)}`),
    signs > 0 && el("div", {}, glyph("square", tones["strong-line"]), `sign of a plan ${number(signs, 0)}`),
    loops.length > suspects.size && el("div", {}, glyph("dash", tones.good), "confirmed loop"),
    suspects.size > 0 && el("div", {}, glyph("dash suspect", tones.bad), `loop that contradicts the others ${number(suspects.size, 0)}`),
  ];
}

/** What a comparison marks on the map. */
function changed({ keyframes, anchors }) {
  const marks = [...keyframes.values(), ...[...anchors.values()].map(({ tone }) => tone)];
  const kinds = [["cross", "bad", "hangs there no longer"], ["ring", "open", "moved or read otherwise since the release"],
    ["ring", "good", "new or back since"]];
  return kinds.filter(([, tone]) => marks.includes(tone));
}

/** A keyframe or an anchor in two lines. */
export function inBrief({ kind, id }, { keyframes, anchors }) {
  if (kind === "keyframe") {
    const { session, covisible, anchors: seen } = keyframes.get(id);
    return [el("div", { class: "mono" }, id), el("div", { class: "muted" }, sign(session)),
      el("div", { class: "muted" }, `${covisible} covisible, ${count(seen.length, "anchor")}`)];
  }
  const anchor = anchors.get(id);
  return [el("div", {}, el("span", { class: "mono" }, id), " ", anchor.description && sign(anchor.description)),
    el("div", { class: "muted" }, sign(classAndState(anchor)))];
}
