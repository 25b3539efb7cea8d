// Verdict: the answer to a loop query, told as one person would tell another.

import { el, number, copyable, count, sign } from "./dom.js";
import { bars, percent } from "./viewer_evidence.js";
import { whyNot } from "./viewer_why_not.js";
import { REASONS } from "./words.js";

const TONES = { loop: "good", verified: "good", rejected: "bad", no_loop: "bad", failed: "bad", undecided: "open" };
const NAMES = { loop: "loop", no_loop: "no loop", undecided: "undecided", rejected: "rejected" };
const MARKS = { pass: "✓", fail: "✕", open: "?", none: "–" };
const SPOKEN = { pass: "passed", fail: "failed", open: "open", none: "not run" };

/** A candidate's verdict in its colour. */
export function chipOf(verdict) {
  return el("span", { class: `chip ${toneOf(verdict)}` }, NAMES[verdict] ?? verdict);
}

/** The colour in which a candidate's verdict is drawn. */
export function toneOf(verdict) {
  return TONES[verdict] ?? "muted";
}

/**
 * The whole answer. `refs` makes references to keyframes and anchors, `described(id)` gives an anchor's description;
 * `curl` is the request it answers, `compare(candidate)` sets one beside the query, `confirm(answer)` gives what closes a loop.
 */
export function explain(answer, { refs, described, curl, version, compare, confirm }) {
  const { candidates, excluded_covisible: excluded = 0 } = answer;
  const context = { refs, described, compare };
  const cards = candidates.map((candidate, index) => card(candidate, index === 0, context));
  const stale = version > answer.map_version && `The map has moved on to version ${version} since.`;
  // A return that is closed already is no rejection.
  const tone = answer.reason?.code === "already_closed" ? "" : toneOf(answer.verdict);
  return el("section", { class: `verdict ${tone}` },
    el("h3", {}, headline(answer, refs)),
    el("p", {}, answer.why ? sign(answer.why) : answer.reason && why(answer.reason)),
    closedLoops(answer.closed ?? [], refs),
    answer.verdict === "loop" && confirm(answer),
    answer.degraded && el("p", { class: "small" }, "A language model was away: the built-in judge stood in for it."),
    el("p", { class: "muted small" },
      `${count(candidates.length, "candidate")} compared, at version ${answer.map_version} of the map. `,
      excluded > 0 && `${count(excluded, "keyframe")} left out because ${excluded === 1 ? "it sees" : "they see"} the same `,
      excluded > 0 && "points as this one: that is the present place, not a return. ",
      stale),
    whyNot(candidates, cards),
    el("ol", { class: "candidates" }, cards),
    curl && el("details", { class: "small" }, el("summary", {}, "The same with curl"), copyable(curl)),
    el("details", { class: "small" }, el("summary", {}, "The answer as JSON"), copyable(JSON.stringify(answer, null, 2))));
}

function headline({ verdict, best, candidates, reason }, refs) {
  if (verdict === "loop") return ["Yes, it is a loop: back at ", refs.keyframe(best)];
  if (reason?.code === "already_closed") return "Its loop is closed already";
  if (verdict === "undecided") return "It cannot be told yet";
  return candidates.length === 0 ? "No: nothing in this map is like it" : "No: places are like it, none is the same";
}

/** The loops of this keyframe that are confirmed. */
function closedLoops(closed, refs) {
  if (closed.length === 0) return null;
  return el("p", { class: "small" }, "Closed already: ",
    closed.map(({ loop, keyframe }, index) => [index > 0 && ", ", refs.keyframe(keyframe), ` (${loop})`]), ".");
}

function card(candidate, open, context) {
  const { keyframe, verdict, reason } = candidate;
  return el("li", {}, el("details", { class: "candidate", open },
    el("summary", {}, el("code", {}, keyframe), " ",
      chipOf(verdict), " ", el("span", { class: "muted small" }, brief(candidate))),
    el("button", { type: "button", class: "compare-it", click: () => context.compare(candidate) }, "Compare side by side"),
    el("p", {}, context.refs.keyframe(keyframe), ": ", reason ? why(reason) : "it passed every check that could run."),
    el("ol", { class: "checks" }, appearance(candidate), anchors(candidate, context), geometry(candidate), sum(candidate))));
}

/** What decided, in a few words and figures. */
function brief({ reason, anchors: figures, geometry: { status, inliers }, bow, global }) {
  if (reason) return REASONS[reason.code]?.title ?? reason.code;
  if (status === "verified" && inliers) return `${number(inliers, 0)} inliers`;
  if (figures) return `S = ${number(figures.similarity)}`;
  return bow ? `BoW ${number(bow.score, 3)}` : `cosine ${number(global?.similarity ?? 0, 3)}`;
}

/** The reason for a person, with what was measured and asked. The server's own sentence follows where it adds to it. */
export function why({ code, measured, limit, detail }) {
  const [m, l] = [measured, limit].map((value) => (value === undefined || value === null ? "?" : number(value, 3)));
  const fields = { "{measured}": m, "{limit}": l, "{detail}": detail && el("span", { class: "muted" }, "(", sign(detail), ")") };
  const own = REASONS[code]?.sentence;
  if (!own) return [`${code}: ${m} against ${l}. `, detail && sign(detail)];
  return own.split(/(\{\w+\})/).map((part) => (part in fields ? fields[part] : part));
}

function check(state, title, figure, ...body) {
  return el("li", { class: `check ${state}` },
    el("span", { class: "mark", role: "img", "aria-label": SPOKEN[state] }, MARKS[state]),
    el("div", {}, el("h4", {}, title, el("span", { class: "figure" }, figure)), body));
}

function appearance({ bow, global, reason }) {
  const cosine = global && `The two images as a whole: cosine ${number(global.similarity, 3)}.`;
  if (!bow) {
    return check("pass", "Appearance (global descriptor)", number(global?.similarity ?? 0, 3),
      el("p", {}, "The two images are alike as a whole; neither words nor an anchor seen before proposed this candidate."));
  }
  const { score, common_words: words, reference_score: reference } = bow;
  const state = REASONS[reason?.code]?.check === "words" ? "fail" : words === 0 ? "none" : "pass";
  const neighbours = reference > 0
    && ` This keyframe's own covisible neighbours score ${number(reference, 3)} or more.`;
  const text = words === 0
    ? ["The two share no word; an anchor seen before proposed this candidate. ", cosine]
    : [`${count(words, "word")} in common.`, neighbours, cosine && " ", cosine];
  return check(state, "Appearance (bag of words)", number(score, 3), el("p", {}, text));
}

/** How the anchors stand where they decided. */
function stoppedByAnchors(reason) {
  const { check: by, class: effect } = REASONS[reason?.code] ?? {};
  if (by !== "anchors") return null;
  return effect === "rejects" ? "fail" : "open";
}

function anchors({ anchors: figures, confidence, reason }, { refs, described }) {
  const title = "Anchors around the two";
  if (!figures) return check("none", title, "", el("p", {}, "Not reached."));
  const { similarity, threshold, in_query: here, in_candidate: there, pending, matches, contradictions } = figures;
  const empty = here === 0 || there === 0;
  // S decides under the paper's method alone, which has no sum.
  const decides = confidence === undefined && !empty;
  const agrees = decides ? similarity > threshold : matches.length > 0;
  const state = stoppedByAnchors(reason) ?? (agrees ? "pass" : empty ? "none" : "open");
  const named = (id) => [refs.anchor(id), described(id) && [" ", sign(`“${described(id)}”`)]];
  const degrees = (radians) => number(radians * 180 / Math.PI, 0);
  return check(state, title, decides ? `S = ${number(similarity)}` : "",
    decides && bar(similarity, threshold),
    el("p", {}, `${count(here, "described anchor")} here, ${there} there`, pending > 0 && `, ${pending} not described yet`,
      decides ? ["; S must exceed ", number(threshold), "."] : "."),
    el("ul", { class: "pairs" },
      matches.map((pair) => el("li", { class: "agrees" },
        el("div", {}, named(pair.query_anchor), " is like ", named(pair.candidate_anchor)),
        el("div", { class: "muted small" }, `alike ${pair.level} of 5, ${judge(pair.source)}; from here and there `,
          `${degrees(pair.angle_difference_rad)}° and ${number(pair.distance_difference_m)} m apart; `,
          `weight ${number(pair.weight)}`))),
      contradictions.map((pair) => el("li", { class: "contradicts" },
        el("div", {}, sign(pair.reason)),
        el("div", { class: "muted small" }, named(pair.query_anchor), " against ", named(pair.candidate_anchor),
          pair.weight !== undefined && `; weight ${number(pair.weight)}`)))),
  );
}

/** What all of it comes to; absent under the paper's method. */
function sum({ verdict, confidence, evidence = [] }) {
  if (confidence === undefined) return null;
  const state = { loop: "pass", rejected: "fail" }[verdict] ?? "open";
  return check(state, "Sum of the evidence", percent(confidence),
    evidence.length > 0 && el("p", { class: "muted small" }, "For this place to the right (+), against it to the left (−); 5 is about 150 to 1."),
    bars(evidence) ?? el("p", {}, "Nothing speaks for this place, and nothing against it."));
}

/** Who judged two descriptions, within a sentence. */
export function judge(source) {
  const known = {
    identical: "identical texts", identifiers: "judged by identifiers", lexical: "judged by words", operator: "judged by an operator",
  };
  return known[source] ?? (source.startsWith("model:") ? `judged by ${source.slice(6)}` : source);
}

/** A bar of S from 0 to 1, with a line at what it must exceed. */
function bar(similarity, threshold) {
  const filled = el("span", { class: "filled" });
  const line = el("span", { class: "limit" });
  filled.style.width = `${Math.min(Math.max(similarity, 0), 1) * 100}%`;
  line.style.left = `${Math.min(Math.max(threshold, 0), 1) * 100}%`;
  filled.classList.toggle("enough", similarity > threshold);
  return el("div", { class: "bar", "aria-hidden": "true" }, filled, line);
}

function geometry({ geometry: { status, reason, matches, inliers, mean_reprojection_error_px: error, candidate_from_query: transform } }) {
  const state = { verified: "pass", failed: "fail" }[status] ?? "none";
  const said = {
    verified: "The features of both images fit one transformation",
    failed: "The features do not fit one transformation",
    skipped: reason ? "It did not run" : "It did not run: a check before it decided",
  };
  const known = (value) => value !== undefined && value !== null;
  const shift = transform && Math.hypot(...["x", "y", "z"].map((axis) => transform.translation[axis]));
  return check(state, "Geometry", known(inliers) ? count(inliers, "inlier") : "",
    el("p", {}, said[status] ?? status, reason && [": ", sign(reason)], "."),
    el("p", { class: "muted small" },
      known(matches) && `${count(matches, "feature")} alike. `,
      known(error) && `The inliers' mean error is ${number(error, 1)} px. `,
      transform && `The two cameras stand ${number(shift)} m apart. `,
      transform && Math.abs(transform.scale - 1) > 1e-6 && `The scale between them is ${number(transform.scale, 3)}.`));
}
