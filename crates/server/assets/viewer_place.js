// Place: the answer to "where am I?", told in words.

import { bars, percent } from "./viewer_evidence.js";
import { bearingFrom } from "./viewer_scene.js";
import { copyable, count, el, number, sign } from "./dom.js";
import { why } from "./viewer_verdict.js";

const TONES = { located: "good", ambiguous: "open", unknown: "" };
const SOURCES = { views: "from the geometry of both views", anchors: "from the signs that agree" };
const ASSUMED = { upright: "both cameras are equally upright" };
/** Directions seen from above, an eighth of a turn each, from straight ahead to the right. */
const DIRECTIONS = ["ahead", "ahead on the right", "on the right", "behind on the right",
  "behind", "behind on the left", "on the left", "ahead on the left"];

/** The colour in which a place is drawn, by its verdict. */
export function toneOfPlace(verdict) {
  return TONES[verdict] || "muted";
}

/** The signs to look for, each once: a sign that its map has as several anchors is listed for each of them. */
export function distinctSigns(signs) {
  const named = signs.map((one) => [JSON.stringify([one.map, one.session, one.class, one.description]), one]);
  return [...new Map(named.reverse()).values()].reverse();
}

/** The whole answer. `map` and `scene` are those on the page; `curl()` gives the request it answers. */
export function tellPlaces(answer, { refs, map, scene, curl }) {
  const { verdict, why: sentence, places } = answer;
  const signs = distinctSigns(answer.look_for);
  return el("section", { class: `verdict ${TONES[verdict] ?? ""}` },
    el("h3", {}, headline(answer)),
    el("p", {}, sign(sentence)),
    signs.length > 0 && [el("h4", {}, "What would tell the places apart"),
      el("ul", { class: "lines" }, signs.map((one) => el("li", {}, lookFor(one, places, map, scene))))],
    el("ol", { class: "candidates" }, places.map((place, index) => card(place, index, { refs, map }))),
    places.some((place) => place.map === map) && el("p", { class: "muted small" },
      "On the map: an arrow is a camera, the circle around it one standard deviation of its position. A place without a pose "
      + "has a ring around its keyframe, and a sign to look for a dashed one."),
    el("p", { class: "muted small" }, asked(answer.maps)),
    later("The same with curl", curl),
    later("The answer as JSON", () => JSON.stringify(answer, null, 2)));
}

function headline({ verdict, places }) {
  const [best] = places;
  if (verdict === "located") return ["Located in ", sign(best.map), best.keyframe && [", at ", el("code", {}, best.keyframe)]];
  const rivals = places.filter((place) => place.verdict === "ambiguous").length;
  if (verdict === "ambiguous") return rivals > 1 ? `Ambiguous: ${rivals} places fit` : "Ambiguous: several places fit";
  return places.length === 0 ? "Unknown: nothing in the maps is like it" : "Unknown: the places are guesses";
}

function card(place, index, { refs, map }) {
  const { verdict, confidence, keyframe } = place;
  return el("li", { class: "candidate" },
    el("div", {}, el("b", {}, `${index + 1}. `), keyframe ? refs.place(place.map, keyframe) : "a plan's signs", " ",
      el("span", { class: `chip ${TONES[verdict] ?? ""}` }, verdict), " ", percent(confidence)),
    el("div", { class: "muted small" }, "map ", sign(place.map), place.map !== map && " (not the one shown)",
      ", session ", sign(place.session)),
    el("ul", { class: "pairs small" }, evidence(place).map(([tone, ...text]) => el("li", { class: tone }, text))),
    bars(place.evidence),
    el("p", { class: "small" }, pose(place)));
}

/** What speaks for the place and against it, each with the class of its line. */
function evidence({ signs, verified_views: views, geometry, reason }) {
  const { agreeing, contradicting } = signs;
  const lines = [];
  const named = agreeing.map((text, index) => [index > 0 && ", ", sign(text)]);
  if (agreeing.length > 0) lines.push(["agrees", `${agreeing.length === 1 ? "A sign agrees" : "Signs agree"}: `, named]);
  if (contradicting > 0) lines.push(["contradicts", `${count(contradicting, "pair")} of signs exclude each other`]);
  if (geometry?.status === "verified") lines.push(["agrees", verified(geometry, views)]);
  else if (geometry?.status === "failed") lines.push(["contradicts", "The views do not fit", geometry.reason && [": ", sign(geometry.reason)]]);
  else if (geometry?.reason && !reason) lines.push(["open", "Geometry did not run: ", sign(geometry.reason)]);
  if (reason) lines.push(["open", "As a loop it would stop here: ", why(reason)]);
  return lines;
}

function verified({ inliers }, views) {
  return ["The views fit", typeof inliers === "number" && `: ${count(inliers, "inlier")}`, views > 1 && `, in ${count(views, "view")}`];
}

function pose(place) {
  const { map_from_camera: camera, uncertainty, session, assumed = [], plan, plan_from_camera: inPlan } = place;
  if (!camera) return el("span", { class: "muted" }, "The evidence gives no pose.");
  const degrees = uncertainty && number(uncertainty.rotation_rad * 180 / Math.PI, 1);
  return [`Camera at ${position(camera.translation)} m in `, sign(session),
    uncertainty && `, ± ${number(uncertainty.translation_m, 2)} m and ${degrees}°`,
    `, ${SOURCES[place.pose_source] ?? place.pose_source}`,
    assumed.length > 0 && `, if ${assumed.map((one) => ASSUMED[one] ?? one).join(" and ")}`,
    inPlan && [`; at ${position(inPlan.translation)} m in the plan `, sign(plan)], "."];
}

function position({ x, y, z }) {
  // Zero is added because a millimetre to the left would else read as -0.
  return [x, y, z].map((metres) => number(Math.round(metres * 100) / 100 + 0, 2)).join(", ");
}

/** A sentence: the sign, what it hangs near, the way to turn to see it, and the place that it would speak for. */
function lookFor(one, places, map, scene) {
  const index = places.findIndex((place) => place.map === one.map && place.session === one.session);
  const camera = places[index]?.map_from_camera;
  const near = one.map === map && nearest(scene, one);
  const [x, y, z] = one.position;
  return ["Look for ", el("b", {}, sign(one.description)), ` (${one.class}) near `,
    near ? el("code", {}, near) : [`${position({ x, y, z })} m in `, sign(one.session)], camera && `, ${direction(camera, one.position)}`,
    ". Seeing it speaks for ", index >= 0 && `place ${index + 1}, in `, "map ", sign(one.map), "."];
}

function nearest(scene, { session, position: at }) {
  const keyframes = scene.sessions.find(({ name }) => name === session)?.keyframes ?? [];
  const far = ({ place }) => Math.hypot(...place.map((metres, axis) => metres - at[axis]));
  return keyframes.reduce((best, one) => (best === null || far(one) < far(best) ? one : best), null)?.id;
}

function direction(camera, at) {
  const [right, down, ahead] = bearingFrom(camera, at);
  const eighth = Math.round(Math.atan2(right, ahead) / (Math.PI / 4));
  return `${number(Math.hypot(right, down, ahead), 1)} m away, ${DIRECTIONS[(eighth + 8) % 8]}`;
}

function asked(maps) {
  const unlike = maps.filter((one) => !one.words_compared);
  const named = ({ map, map_version: version }) => [sign(map), ` (version ${version})`];
  const joined = maps.map((one, index) => [index > 0 && ", ", named(one)]);
  return [maps.length === 0 ? "No map was asked" : `${count(maps.length, "map")} asked: `, joined, ". ",
    unlike.length > 0 && ["Words of another vocabulary were not compared with ",
      unlike.map(({ map }, index) => [index > 0 && ", ", sign(map)]), "."]];
}

/** Made when it is opened: a keyframe may have hundreds of kilobytes. */
function later(title, text) {
  const toggle = ({ target }) => target.open && target.childElementCount === 1 && target.append(copyable(text()));
  return el("details", { class: "small", toggle }, el("summary", {}, title));
}
