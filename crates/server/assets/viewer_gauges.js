// Gauges: measured figures against their limits, as bars.

import { REASONS } from "./words.js";
import { count, el, number } from "./dom.js";

/** How much more than the limit a bar has room for. */
const ROOM = 1.5;
/** log10 of the number of false alarms that is significant at most, as the API document says. */
const SIGNIFICANT = -6;

/** A bar of what must stay below its limit. */
export function gauge(name, measured, limit, format) {
  return row(name, measured, limit, measured < limit, `${format(measured)} of ${format(limit)}`);
}

/** A bar of what must exceed its limit, or reach it. */
function least(name, measured, limit, isEnough, words) {
  return row(name, measured, limit, isEnough, words);
}

function row(name, measured, limit, isWell, words) {
  const end = Math.max(limit * ROOM, measured, 1e-9);
  const filled = el("span", { class: isWell ? "filled enough" : "filled over" });
  const line = el("span", { class: "limit" });
  filled.style.width = `${(measured / end) * 100}%`;
  line.style.left = `${(limit / end) * 100}%`;
  return el("div", { class: isWell ? "gauge" : "gauge off" }, el("span", {}, name), el("b", {}, isWell ? "" : "✕ ", words),
    el("div", { class: "bar", "aria-hidden": "true" }, filled, line));
}

/** The checks of a candidate in figures. Where a sum of evidence decides, S does not, and the confidence stands in its place. */
export function checksInFigures({ bow, global, anchors, geometry, reason, confidence }, settings) {
  const decided = typeof confidence === "number" ? sure(confidence, settings) : similarity(anchors);
  return el("div", { class: "gauges figures-of" },
    appearance(bow, global, settings), decided, inliers(geometry, reason, settings));
}

function sure(confidence, { loop_min_confidence: needed }) {
  return least("confidence", confidence, needed, confidence >= needed, `${number(confidence, 3)}, ${number(needed, 3)} needed`);
}

function plain(name, words) {
  return el("div", { class: "gauge" }, el("span", {}, name), el("b", {}, words));
}

function appearance(bow, global, { candidates_min_score_ratio: ratio }) {
  if (!bow) return plain("looks alike", `cosine ${number(global?.similarity ?? 0, 3)}`);
  const limit = ratio * bow.reference_score;
  if (limit === 0) return plain("looks alike", number(bow.score, 3));
  return least("looks alike", bow.score, limit, bow.score >= limit, `${number(bow.score, 3)}, ${number(limit, 3)} needed`);
}

function similarity(anchors) {
  if (!anchors) return plain("anchors, S", "not reached");
  const { similarity: measured, threshold, in_query: here, in_candidate: there } = anchors;
  if (here === 0 || there === 0) return plain("anchors, S", "nothing to compare");
  return least("anchors, S", measured, threshold, measured > threshold, `${number(measured)}, more than ${number(threshold)} needed`);
}

function inliers({ status, reason: skipped, inliers: found, log10_false_alarms: alarms }, reason, settings) {
  if (status === "skipped") return plain("geometry", `did not run${skipped ? `: ${skipped}` : ""}`);
  if (typeof found !== "number") return plain("geometry", status);
  const isJudged = REASONS[reason?.code]?.check === "geometry" && typeof reason.limit === "number" && reason.measured === found;
  if (isJudged) return least("inliers", found, reason.limit, found >= reason.limit, `${found}, ${number(reason.limit, 0)} needed`);
  if (settings.geometry_acceptance === "significance" && typeof alarms === "number") {
    return least(count(found, "inlier"), -alarms, -SIGNIFICANT, alarms <= SIGNIFICANT, byChance(alarms));
  }
  const needed = settings.geometry_min_inliers;
  return least("inliers", found, needed, status === "verified", `${found}, ${needed} needed`);
}

/** How often so many would fit by chance. */
function byChance(alarms) {
  if (alarms <= SIGNIFICANT) return "by chance less than once in a million";
  const often = alarms < 0 ? `once in ${number(10 ** -alarms, 0)}` : "every time";
  return `by chance ${often}; less than once in a million needed`;
}
