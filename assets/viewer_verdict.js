// Verdict: the answer to a loop query, told as one person would tell another.

import { el, number, copyable, count, sign } from "./dom.js";

const TONES = { loop: "good", verified: "good", rejected: "bad", no_loop: "bad", failed: "bad", undecided: "open" };
const NAMES = { loop: "loop", no_loop: "no loop", undecided: "undecided", rejected: "rejected" };
const MARKS = { pass: "✓", fail: "✕", open: "?", none: "–" };
const SPOKEN = { pass: "passed", fail: "failed", open: "open", none: "not run" };

/** The colour in which a candidate's verdict is drawn. */
export function toneOf(verdict) {
  return TONES[verdict] ?? "muted";
}

/**
 * The whole answer. `refs` makes references to keyframes and anchors, `described(id)` gives an anchor's description;
 * `curl` is the request it answers.
 */
export function explain(answer, { refs, described, curl, version }) {
  const { candidates, excluded_covisible: excluded = 0 } = answer;
  const context = { refs, described };
  const stale = version > answer.map_version && `The map has moved on to version ${version} since.`;
  return el("section", { class: `verdict ${toneOf(answer.verdict)}` },
    el("h3", {}, headline(answer, refs)),
    answer.reason && el("p", {}, why(answer.reason)),
    closedLoops(answer.closed ?? [], refs),
    answer.verdict === "loop" && el("p", { class: "muted small" },
      "A verdict is not yet a closed loop: the client confirms it once it has closed it (POST …/loops)."),
    answer.degraded && el("p", { class: "small" }, "A language model was away: the built-in judge stood in for it."),
    el("p", { class: "muted small" },
      `${count(candidates.length, "candidate")} compared, at version ${answer.map_version} of the map. `,
      excluded > 0 && `${count(excluded, "keyframe")} left out because ${excluded === 1 ? "it sees" : "they see"} the same `,
      excluded > 0 && "points as this one: that is the present place, not a return. ",
      stale),
    el("ol", { class: "candidates" }, candidates.map((candidate, index) => card(candidate, index === 0, context))),
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
      el("span", { class: `chip ${toneOf(verdict)}` }, NAMES[verdict] ?? verdict), " ",
      el("span", { class: "muted small" }, brief(candidate))),
    el("p", {}, context.refs.keyframe(keyframe), ": ", reason ? why(reason) : "it passed every check that could run."),
    el("ol", { class: "checks" }, appearance(candidate), anchors(candidate, context), geometry(candidate))));
}

const BRIEF = {
  score_below_threshold: "signs differ",
  contradiction: "signs contradict",
  no_anchors: "nothing to compare",
  neighbours_vouch: "its neighbours return here",
  llm_pending: "descriptions pending",
  llm_unavailable: "model away",
  not_described: "signs not described",
  no_features: "no features",
  bow_below_reference: "looks differ",
  too_few_inliers: "geometry differs",
  anchors_disagree_with_transform: "signs misplaced",
  anchors_displaced: "signs in two places",
  odometry_disagrees_with_transform: "odometry differs",
  ambiguous_places: "looks like two places",
  twins_known: "this view exists twice",
  not_distinctive: "signs hang everywhere",
  tracked_only: "the same passage",
  no_witness: "signs alone are not enough",
  covisible: "same place as now",
};

/** What decided, in a few words and figures. */
function brief({ reason, anchors: figures, geometry: { status, inliers }, bow }) {
  if (reason) return BRIEF[reason.code] ?? reason.code;
  if (status === "verified" && inliers) return `${number(inliers, 0)} inliers`;
  return figures ? `S = ${number(figures.similarity)}` : `BoW ${number(bow.score, 3)}`;
}

const ADDS_DETAIL = ["no_anchors", "neighbours_vouch", "contradiction", "no_features", "llm_pending", "llm_unavailable",
  "not_described", "odometry_disagrees_with_transform", "not_distinctive", "no_witness"];

/** The reason for a person, with what was measured and asked. The server's own sentence follows where it adds to it. */
export function why({ code, measured, limit, detail }) {
  const [m, l] = [measured, limit].map((value) => (value === undefined || value === null ? "?" : number(value, 3)));
  const sentences = {
    already_closed: "The loop was confirmed before, and no other place is one.",
    no_candidates: "No keyframe shares a word with it, and none sees an anchor that it sees.",
    empty_bow: "It has no words (a blank wall?), and no anchor speaks for any place.",
    covisible: "It sees the same points as this keyframe: the present place, not a return.",
    bow_below_reference: `It looks less alike (${m}) than this map asks for (${l}).`,
    neighbours_vouch: `It is a loop: the anchors near it leave it open, but its neighbours return here, and geometry verifies the view with ${m} inliers.`,
    no_anchors: "There are no anchors to compare.",
    llm_pending: "Anchors are not described yet, and their descriptions could turn the answer. Ask again in a while.",
    llm_unavailable: "The language model is away, and its word could turn the answer. Ask again in a while.",
    not_described: "Nothing has described some of the anchors, and a description could turn the answer.",
    score_below_threshold: `The anchors around the two do not agree enough: S is ${m} and must exceed ${l}.`,
    contradiction: `Signs exclude each other. What contradicts weighs ${m}, what agrees ${l}.`,
    no_features: "Geometry was asked for, and it could not run.",
    too_few_inliers: `Too few features fit one transformation: ${m}, and ${l} are needed.`,
    anchors_disagree_with_transform:
      `Once geometry has aligned the two, the matched anchors lie apart: S is ${m} and must exceed ${l}.`,
    anchors_displaced:
      `Signs that hang once would hang in two places if this were a loop. They weigh ${m}, what agrees ${l}.`,
    odometry_disagrees_with_transform: "The robot knows from its own tracking that it is somewhere else.",
    ambiguous_places: `Geometry alone speaks for it, and nearly as much for another place: ${m} inliers, and ${l} are needed.`,
    twins_known: `Geometry alone speaks for it, with ${m} inliers, and this map has shown one view in two places: that proves nothing here.`,
    tracked_only: "Whatever agrees was seen in this same passage: it was tracked, and shows no return.",
    no_witness: "Whatever agrees are texts without an identifier, which may hang in many places: nothing else says that it is this one.",
    not_distinctive: "Whatever agrees hangs in several places: it could be any of them.",
  };
  const own = sentences[code];
  if (!own) return [`${code}: ${m} against ${l}. `, detail && sign(detail)];
  return [own, ADDS_DETAIL.includes(code) && detail && [" ", el("span", { class: "muted" }, "(", sign(detail), ")")]];
}

function check(state, title, figure, ...body) {
  return el("li", { class: `check ${state}` },
    el("span", { class: "mark", role: "img", "aria-label": SPOKEN[state] }, MARKS[state]),
    el("div", {}, el("h4", {}, title, el("span", { class: "figure" }, figure)), body));
}

function appearance({ bow: { score, common_words: words, reference_score: reference }, reason }) {
  const state = reason?.code === "bow_below_reference" ? "fail" : words === 0 ? "none" : "pass";
  const neighbours = reference > 0
    && ` This keyframe's own covisible neighbours score ${number(reference, 3)} or more.`;
  const text = words === 0
    ? "The two share no word; an anchor seen before proposed this candidate."
    : [`${count(words, "word")} in common.`, neighbours];
  return check(state, "Appearance (bag of words)", number(score, 3), el("p", {}, text));
}

const STOPPED_BY_ANCHORS = {
  score_below_threshold: "fail", contradiction: "fail", anchors_disagree_with_transform: "fail",
  anchors_displaced: "fail", not_distinctive: "open", no_witness: "open", tracked_only: "open", no_anchors: "open", llm_pending: "open", llm_unavailable: "open",
  not_described: "open",
};

const NOT_COUNTED = {
  not_sure: "it may be misread",
  another_place: "they stand at different places",
  known_elsewhere: "the other map knows it, elsewhere",
  no_conflict: "the two do not exclude each other",
  paired_otherwise: "one of them contradicts another sign already",
  outweighed: "what agrees weighs no less",
  veto_off: "this map leaves contradictions out",
};

function anchors({ anchors: figures, reason }, { refs, described }) {
  const title = "Anchors around the two";
  if (!figures) return check("none", title, "", el("p", {}, "Not reached."));
  const { similarity, threshold, in_query: here, in_candidate: there, pending, matches, contradictions } = figures;
  const differences = figures.differences ?? [];
  const empty = here === 0 || there === 0;
  const state = STOPPED_BY_ANCHORS[reason?.code] ?? (similarity > threshold ? "pass" : empty ? "none" : "open");
  const named = (id) => [refs.anchor(id), described(id) && [" ", sign(`“${described(id)}”`)]];
  const degrees = (radians) => number(radians * 180 / Math.PI, 0);
  return check(state, title, empty ? "" : `S = ${number(similarity)}`,
    empty ? null : bar(similarity, threshold),
    el("p", {}, `${count(here, "described anchor")} here, ${there} there`, pending > 0 && `, ${pending} not described yet`,
      empty ? "." : ["; S must exceed ", number(threshold), "."]),
    el("ul", { class: "pairs" },
      matches.map((pair) => el("li", { class: "agrees" },
        el("div", {}, named(pair.query_anchor), " is like ", named(pair.candidate_anchor)),
        el("div", { class: "muted small" }, `level ${pair.level} of 5, ${judge(pair.source)}; from here and there `,
          `${degrees(pair.angle_difference_rad)}° and ${number(pair.distance_difference_m)} m apart; `,
          `weight ${number(pair.weight)}`))),
      contradictions.map((pair) => el("li", { class: "contradicts" },
        el("div", {}, sign(pair.reason)),
        el("div", { class: "muted small" }, named(pair.query_anchor), " against ", named(pair.candidate_anchor),
          pair.weight !== undefined && `; weight ${number(pair.weight)}`)))),
    differences.length > 0 && [el("p", { class: "small" }, "What differs, and why it did not count:"),
      el("ul", { class: "pairs" }, differences.map((pair) => el("li", {},
        el("div", {}, sign(pair.query_identifier), " here, ", sign(pair.candidate_identifier), " there: ",
          NOT_COUNTED[pair.reason] ?? pair.reason.replaceAll("_", " ")),
        el("div", { class: "muted small" }, named(pair.query_anchor), " against ", named(pair.candidate_anchor),
          "; ", sign(pair.detail)))))],
    contradictions.length > 0 && reason?.code !== "contradiction"
      && el("p", { class: "muted small" }, "What contradicts does not outweigh what agrees."));
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
    skipped: "It did not run",
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
