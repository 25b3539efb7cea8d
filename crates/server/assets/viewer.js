// Viewer: one map on one page. This file holds what is chosen and ties the parts together.

import { addressed, remember } from "./viewer_address.js";
import { MapCanvas } from "./viewer_canvas.js";
import { onChange } from "./viewer_colours.js";
import { Compare } from "./viewer_compare.js";
import { Details } from "./viewer_details.js";
import { EventList } from "./viewer_event_list.js";
import { showConnection, showFigures } from "./viewer_header.js";
import { listenToKeys } from "./viewer_keys.js";
import { legend, sessionOptions } from "./viewer_legend.js";
import { AnchorList, KeyframeList } from "./viewer_lists.js";
import { fillLoops } from "./viewer_loops.js";
import { marksOf, marksOfAnswer } from "./viewer_marks.js";
import { PictureForm } from "./viewer_picture.js";
import { Reader } from "./viewer_reader.js";
import { Releases } from "./viewer_releases.js";
import { AXES, PLANES, arrange, buildScene, widestPlane } from "./viewer_scene.js";
import { nextInSession, nextOfAll } from "./viewer_steps.js";
import { Sweep } from "./viewer_sweep.js";
import { BELOW, tabList } from "./viewer_tabs.js";
import { showTip } from "./viewer_tip.js";
import { Until } from "./viewer_until.js";
import { Verdicts } from "./viewer_verdicts.js";
import { Where } from "./viewer_where.js";
import { brief, debounced, el, fill } from "./dom.js";

const PUBLISHED_WAIT_MS = 300;

const NOTHING = buildScene({ keyframes: [], anchors: [], loops: [] });
const at = (id) => document.getElementById(id);
/** What is known and chosen when a map is opened: nothing. */
const FRESH = {
  map: null, scene: NOTHING,
  choice: null, apart: true, fleet: true, plane: null, selection: null, marks: {}, found: null, changes: null,
};
/** The answer to "where am I?" stays: its places lead from map to map. */
const state = { ...FRESH, answer: null };

const refs = {
  keyframe: (id) => ref(id, () => select("keyframe", id)),
  // An anchor of a keyframe that was asked about and not stored has no page.
  anchor: (id) => (id.startsWith("inline-") ? el("code", {}, id) : ref(id, () => select("anchor", id))),
  query: (id, keyframe) => ref("why", () => readQuery({ query: id, keyframe })),
  place: (map, id) => ref(id, () => (map === state.map ? select("keyframe", id) : open(map, { kind: "keyframe", id }, true))),
};
const world = {
  map: () => state.map, scene: () => state.scene, version: () => reader.meta?.map_version ?? 0, settings: () => reader.meta?.settings ?? {},
  vocabulary: () => reader.meta?.vocabulary, plane: () => canvas.layout.plane, mark, locate, compare: (answer, candidate) => compare.open(answer, candidate),
};
const canvas = new MapCanvas(at("canvas"), {
  pick: (hit) => (hit ? select(hit.kind, hit.id, false) : letGo()), hover: (hit, x, y) => showTip(at("tip"), hit, { x, y }, state.scene, canvas.size),
});
const details = new Details(at("details"), world, refs);
const compare = new Compare(world, refs);
const picture = new PictureForm(at("picture"), world, (one) => canvas.showPicture(one));
const anchors = new AnchorList(at("anchors"), world, refs, foundOnMap);
const keyframes = new KeyframeList(at("keyframes"), world, refs);
const events = new EventList(at("events"), at("tab-events"), refs);
const reader = new Reader({
  start, maps: showMaps, read, event: happened, cover, connected: (how) => showConnection(at("live"), how),
  open: (map, meta) => open(map, map === state.map ? state.selection : null, false, meta),
  isTyping: () => !at("empty").hidden && at("empty").querySelector("form") !== null,
});
const sweep = new Sweep(at("sweep"), world, refs);
const releases = new Releases(at("releases"), world, refs, changedOnMap);
const until = new Until(at("until"), lay);
const verdicts = new Verdicts(at("verdicts"), world, readQuery);
const where = new Where(at("where"), world, refs, { opened: () => openTab("where"), answered });

function ref(id, click) {
  return el("button", { type: "button", class: "ref", click }, id);
}

// --- What is selected -------------------------------------------------------------------------------------------------

function select(kind, id, reveal = true) {
  choose({ kind, id }, reveal);
  openTab("details");
  details[kind](id);
  showDetails();
}

/** On a phone the details are below the map: both come into view, the map at the top. */
function showDetails() {
  const [sheet, tabs, shown] = [at("canvas").parentElement, at("tab-details").parentElement, at("details")]
    .map((element) => element.getBoundingClientRect().top);
  if (BELOW.matches && (sheet > 0 || shown < tabs)) at("canvas").parentElement.scrollIntoView();
}

/** Selects on the map, and brings it into view; its session too if another one is shown. */
function choose(selection, reveal = true) {
  state.selection = selection;
  state.marks = {};
  remark();
  if (selection && reveal && !canvas.reveal(selection.kind, selection.id) && (state.choice !== null || until.isOn)) {
    showAll();
    canvas.reveal(selection.kind, selection.id);
  }
  remember(state);
}

function showAll() {
  until.reset();
  Object.assign(state, { choice: null, apart: true, fleet: true });
  lay();
  canvas.fit();
}

function locate(id) {
  where.ofMap(id);
}

/** Draws an answer to "where am I?" (`null` draws none), and brings the best place of the shown map into view. */
function answered(answer) {
  state.answer = answer;
  const best = answer?.places.find((place) => place.map === state.map);
  if (best && state.choice !== null && best.session !== state.choice) showAll();
  else remark();
  if (best && canvas.marks.places.length > 0) canvas.bring(canvas.marks.places[0]);
}

/** Shows what a search found, all of it if nothing of it is in view. */
function foundOnMap(anchorIds, keyframeIds = []) {
  state.found = anchorIds;
  remark();
  const points = [...canvas.anchors.filter(({ id }) => anchorIds?.has(id)), ...keyframeIds.map((id) => canvas.point("keyframe", id))];
  canvas.bringAll(points.filter(Boolean));
}

/** Marks what a comparison of releases found, all of it if nothing of it is in view. */
function changedOnMap(changes) {
  if (state.changes === changes) return;
  state.changes = changes;
  remark();
  fill(at("legend"), legend(state.scene, changes));
  if (!changes) return;
  const changed = (kind) => canvas[kind].filter(({ id }) => changes[kind].has(id));
  canvas.bringAll([...changed("anchors"), ...changed("keyframes")]);
}

/** Finds signs by their text and keyframes by their ids, from wherever one is. */
function find() {
  if (document.body.classList.contains("covered")) return;
  openTab("anchors");
  anchors.focus();
}

/** Shows the answer to a loop query, and on the map what was asked about. `line` is what a list tells of it. */
function readQuery({ query, keyframe, ...line }) {
  choose(keyframe ? { kind: "keyframe", id: keyframe } : null);
  openTab("details");
  details.query(query, { keyframe, ...line });
  showDetails();
}

function letGo() {
  choose(null);
  details.clear();
}

/** More is known about the selected thing. */
function mark(kind, id, more) {
  if (state.selection?.kind !== kind || state.selection.id !== id) return;
  Object.assign(state.marks, more);
  remark();
}

function remark() {
  canvas.mark({ ...marksOf(canvas, state), ...marksOfAnswer(canvas, state), found: state.found, changes: state.changes });
}

/** Steps to the keyframe that follows the selected one. */
function step(next, by) {
  const id = next(canvas, state.selection?.kind === "keyframe" ? state.selection.id : null, by);
  if (id !== null) select("keyframe", id);
}

// --- The map and its data ---------------------------------------------------------------------------------------------

async function open(map, selection = null, push = false, meta = null) {
  reader.leave(map);
  Object.assign(state, { ...FRESH, map, selection });
  lay();
  document.title = `${map} – Revisit`;
  at("maps").value = map;
  remember(state, push);
  canvas.moved = false;
  for (const part of [anchors, keyframes, events, sweep, releases, until, verdicts]) part.reset();
  where.refresh();
  details.clear();
  if (await reader.open(meta) && selection) select(selection.kind, selection.id);
}

function happened(event) {
  events.add(event);
  // Others change no version: a release, and a loop that a reading of the frames found.
  if (event.map_version < reader.version) return;
  if (event.event === "release_published") published();
  else if (event.event === "loop_suspected" && !state.scene.suspects.has(event.loop)) reader.soon();
}

function showMaps(known) {
  const ids = state.map === null || known.includes(state.map) ? known : [state.map, ...known];
  const shown = [...at("maps").options].map(({ value }) => value);
  if (ids.join("\n") !== shown.join("\n")) fill(at("maps"), ids.map((id) => el("option", { value: id }, id)));
  at("maps").parentElement.hidden = ids.length === 0;
  if (state.map !== null) at("maps").value = state.map;
}

/** Opens what the address names. */
function start() {
  Object.assign(state, addressed());
  reader.start(state.map);
}

// --- What is on the page ----------------------------------------------------------------------------------------------

function cover(content) {
  at("empty").hidden = content === null;
  document.body.classList.toggle("covered", content !== null);
  fill(at("empty"), content);
  if (content === null) canvas.resize();
}

/** The map was read. */
function read({ meta, ...all }) {
  const scene = buildScene(all);
  state.scene = scene;
  showFigures(at("figures"), meta, scene);
  fill(at("sessions"), sessionOptions(scene));
  lay();
  fill(at("legend"), legend(scene, state.changes));
  picture.refresh();
  Object.keys(lists).forEach(refreshList);
  at("tab-loops").textContent = meta.loops > 0 ? `Loops ${brief(meta.loops)}` : "Loops";
}

/** Lays the chosen sessions out in the chosen plane. */
function lay() {
  const { scene, choice, apart } = state;
  const fleet = state.fleet && scene.joined > 1;
  if (choice !== null && ![...scene.sessions, ...scene.plans].some(({ name }) => name === choice)) state.choice = null;
  const plane = state.plane ?? widestPlane(scene, fleet);
  until.refresh(scene.sessions.filter(({ name }) => state.choice === null || name === state.choice));
  const { width, height } = canvas.size;
  canvas.show(scene, arrange(scene, { plane, choice: state.choice, apart, fleet, aspect: width / height }), until.shown());
  const value = state.choice !== null ? `=${state.choice}` : fleet ? "fleet" : apart ? "apart" : "over";
  at("sessions").value = value;
  if (at("sessions").selectedIndex < 0) at("sessions").selectedIndex = 0;
  fill(at("planes"), PLANES.map((each) => el("button", {
    type: "button", "aria-pressed": String(each.join() === plane.join()),
    click: () => { state.plane = each; canvas.moved = false; lay(); at("planes").children[PLANES.indexOf(each)].focus(); },
  }, each.map((axis) => AXES[axis]).join("–"))));
  remark();
}

/** Filled when they are opened, and again when the map changes, unless somebody is in the middle of one. */
const lists = {
  anchors: () => anchors.refresh(),
  keyframes: () => keyframes.refresh(),
  loops: () => { fillLoops(at("loop-list"), world, refs, () => reader.soon()); sweep.refresh(); },
  verdicts: () => verdicts.refresh(),
  where: () => where.refresh(),
  releases: () => releases.refresh(),
};
const published = debounced(() => refreshList("releases"), PUBLISHED_WAIT_MS);

function refreshList(panel) {
  if (!at(panel).hidden && !isRead(at(panel))) lists[panel]();
}

function isRead(panel) {
  return panel.scrollTop > 40 || panel.getBoundingClientRect().top < 0 || Boolean(document.activeElement?.closest("aside li"));
}

const openTab = tabList([...document.querySelectorAll("[role=tab]")], (panel) => lists[panel]?.());

listenToKeys(canvas, { step: (by) => step(nextInSession, by), stepAll: (by) => step(nextOfAll, by), letGo, find });
at("in").addEventListener("click", () => canvas.zoom(1.4));
at("out").addEventListener("click", () => canvas.zoom(1 / 1.4));
at("fit").addEventListener("click", () => canvas.fit());
at("find").addEventListener("click", find);
onChange(() => fill(at("legend"), legend(state.scene, state.changes)));
at("labels").addEventListener("change", ({ target }) => canvas.showLabels(target.checked));
at("maps").addEventListener("change", ({ target }) => open(target.value, null, true));
at("sessions").addEventListener("change", ({ target: { value } }) => {
  Object.assign(state, { choice: value.startsWith("=") ? value.slice(1) : null, apart: value !== "over", fleet: value === "fleet" });
  canvas.moved = false;
  until.reset();
  lay();
});
addEventListener("popstate", start);
start();
