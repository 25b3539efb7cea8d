// Loops: the tab of confirmed loops: which signs join the two passages, how far apart they were, and when.

import { path, remove } from "./viewer_api.js";
import { isName } from "./viewer_labels.js";
import { presentName } from "./viewer_pairs.js";
import { moved } from "./viewer_scene.js";
import { longList } from "./viewer_tables.js";
import { between, isDate, moment } from "./viewer_time.js";
import { byName, count, el, fill, number, sign } from "./dom.js";

/** Fills the list, those that contradict the others first. `revoked()` hears when one was revoked. */
export function fillLoops(place, world, refs, revoked) {
  const { loops, suspects } = world.scene();
  if (loops.length === 0) {
    fill(place, el("p", { class: "hint" }, "No loop is confirmed yet. A client confirms one with ",
      el("code", {}, `POST /v1/maps/${world.map()}/loops`), " once its optimisation has closed it."));
    return;
  }
  const doubt = ({ id }) => (suspects.has(id) ? 0 : 1);
  const sorted = loops.toSorted((a, b) => doubt(a) - doubt(b) || byName(a.id, b.id));
  fill(place, el("p", { class: "muted small" }, count(loops.length, "confirmed loop"),
    suspects.size > 0 && `, of which ${number(suspects.size, 0)} contradict the others`),
  longList(sorted, "lines", (loop) => [
    el("div", {}, refs.keyframe(loop.keyframe), " back at ", refs.keyframe(loop.candidate), " ",
      el("span", { class: "muted small" }, loop.id, loop.query && [" ", refs.query(loop.query, loop.keyframe)])),
    suspects.has(loop.id) && el("div", { class: "small fault" }, contradiction(suspects.get(loop.id))),
    el("div", {}, joined(loop, world.scene())),
    el("div", { class: "muted small" }, apart(loop, world.scene())),
    revocation(world.map(), loop, revoked)]));
}

/** The signs that both passages saw, names first. */
function joined({ keyframe, candidate, merged }, scene) {
  const seen = (id) => scene.keyframes.get(id)?.anchors ?? [];
  const both = seen(keyframe).filter((anchor) => seen(candidate).includes(anchor));
  const ids = new Set([...merged.map(({ into }) => presentName(into, scene)), ...both]);
  const signs = [...ids].map((id) => scene.anchors.get(id)).filter((anchor) => anchor?.description);
  if (signs.length === 0) return el("span", { class: "muted" }, "no sign that both see joins them");
  signs.sort((a, b) => isName(b) - isName(a) || byName(a.description, b.description));
  const texts = [...new Set(signs.map(({ description }) => description))];
  return ["joined by ", texts.map((text, index) => [index > 0 && ", ", sign(text)])];
}

/** How far apart the passages are on the map, and when they were. */
function apart({ keyframe, candidate }, { keyframes, sessions }) {
  const [now, then] = [keyframe, candidate].map((id) => keyframes.get(id));
  if (!now || !then) return "one of the two is not in the map any more";
  const isOne = now.session === then.session;
  const places = [now, then].map(({ session, place }) => {
    const { placed } = sessions.find(({ name }) => name === session) ?? {};
    return isOne ? place : placed && moved(placed, place);
  });
  const metres = places.every(Boolean) && Math.hypot(...places[0].map((at, axis) => at - places[1][axis]));
  const far = metres === false ? "in frames that nothing joins" : `${number(metres, 1)} m apart on the map`;
  const when = isDate(now.stamp) && isDate(then.stamp) ? `, ${between(now.stamp, then.stamp)} between them, the later at ${moment(later(now, then))}`
    : isOne ? `, ${between(now.stamp, then.stamp)} between them` : "";
  return [far, when, !isOne && [", ", sign(now.session), " and ", sign(then.session)]];
}

function later(a, b) {
  return a.stamp.sec > b.stamp.sec ? a.stamp : b.stamp;
}

/** By how much a loop contradicts which others. */
function contradiction({ cycle, residual, residual_rad: turn }) {
  const off = `${number(residual, 1)} m and ${number((turn * 180) / Math.PI, 0)}° off from `;
  return cycle.length === 0 ? `${off}the robot's own tracking` : `${off}${cycle.join(", ")}`;
}

/** A button that asks once more before it revokes a loop, and says what parts. */
function revocation(map, { id, merged }, revoked) {
  const place = el("div", { class: "small" });
  const ask = () => fill(place, el("button", { type: "button", click: sure }, "Revoke…"));
  const sure = () => {
    const parts = merged.length === 0 ? "No anchors part." : `${count(merged.length, "pair")} of anchors part again.`;
    const yes = el("button", { type: "button", click: revoke }, "Revoke the loop");
    fill(place, `${parts} `, yes, " ", el("button", { type: "button", click: ask }, "Keep it"));
    yes.focus();
  };
  const revoke = async () => {
    try {
      await remove(path("maps", map, "loops", id));
      fill(place, "revoked");
      revoked();
    } catch (error) {
      fill(place, el("span", { class: "fault", role: "alert" }, error.message));
    }
  };
  ask();
  return place;
}
