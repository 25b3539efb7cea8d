// Legend: what is on the canvas, in words: the choice of sessions, the colours, and the thing under the pointer.

import { classColour, sessionColour } from "./viewer_draw.js";
import { count, el, number, sign } from "./dom.js";

const SESSIONS = 6;
const CLASSES = 8;

/** The choices of sessions: all of them, in up to three ways, or one by its name. */
export function sessionOptions({ sessions, joined }) {
  const one = sessions.map(({ name, keyframes: { length } }) => el("option", { value: `=${name}` }, `${name} (${length})`));
  if (sessions.length < 2) return one;
  return [joined > 1 && el("option", { value: "fleet" }, joined === sessions.length ? `${joined} sessions, in one frame`
    : `${joined} of ${sessions.length} sessions in one frame`), el("option", { value: "apart" }, `${sessions.length} sessions, side by side`),
    el("option", { value: "over" }, `${sessions.length} sessions, overlaid`), el("optgroup", { label: "One session" }, one)];
}

/** The colours and glyphs that are on the canvas. */
export function legend({ classes, sessions, loops, suspects, anchors: all }) {
  const glyph = (kind, colour) => {
    const mark = el("span", { class: `glyph ${kind}` });
    if (colour) mark.style.background = colour;
    return mark;
  };
  const pending = [...all.values()].filter((anchor) => anchor.state === "pending").length;
  return [
    sessions.length <= SESSIONS
      && sessions.map(({ name, index }) => el("div", {}, glyph("round", sessionColour(index)), sign(name))),
    classes.slice(0, CLASSES).map(({ name, size, index }) =>
      el("div", {}, glyph("", classColour(index)), sign(name), ` ${number(size, 0)}`)),
    classes.length > CLASSES && el("div", {}, `and ${count(classes.length - CLASSES, "more class", "more classes")}`),
    pending > 0 && el("div", {}, glyph("hollow"), `not described yet ${number(pending, 0)}`),
    loops.length > suspects.size && el("div", {}, glyph("dash"), "confirmed loop"),
    suspects.size > 0 && el("div", {}, glyph("dash suspect"), `loop that contradicts the others ${number(suspects.size, 0)}`),
  ];
}

/** A keyframe or an anchor in two lines. */
export function inBrief({ kind, id }, { keyframes, anchors }) {
  if (kind === "keyframe") {
    const { session, covisible, anchors: seen } = keyframes.get(id);
    return [el("div", { class: "mono" }, id), el("div", { class: "muted" }, sign(session)),
      el("div", { class: "muted" }, `${covisible} covisible, ${count(seen.length, "anchor")}`)];
  }
  const { description, class: name, state, keyframes: seen } = anchors.get(id);
  return [el("div", {}, el("span", { class: "mono" }, id), " ", description && sign(description)),
    el("div", { class: "muted" }, sign(name), `, ${state}, seen by ${seen.length}`)];
}
