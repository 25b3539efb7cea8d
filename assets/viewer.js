// Viewer: one map on one page. This file holds what is chosen and ties the parts together.

import { everything, get, key, list, path } from "./viewer_api.js";
import { MapCanvas } from "./viewer_canvas.js";
import { onChange } from "./viewer_colours.js";
import { Compare } from "./viewer_compare.js";
import { Details } from "./viewer_details.js";
import { keyWanted, noKeyframes, noMaps, noSuchMap, unreachable } from "./viewer_empty.js";
import { EventList } from "./viewer_event_list.js";
import { listen } from "./viewer_events.js";
import { Follower } from "./viewer_follow.js";
import { showConnection, showFigures } from "./viewer_header.js";
import { listenToKeys } from "./viewer_keys.js";
import { inBrief, legend, sessionOptions } from "./viewer_legend.js";
import { AnchorList, KeyframeList } from "./viewer_lists.js";
import { fillLoops } from "./viewer_loops.js";
import { marksOf, marksOfAnswer } from "./viewer_marks.js";
import { PictureForm } from "./viewer_picture.js";
import { Releases } from "./viewer_releases.js";
import { AXES, PLANES, arrange, buildScene, widestPlane } from "./viewer_scene.js";
import { Sweep } from "./viewer_sweep.js";
import { tabList } from "./viewer_tabs.js";
import { Until } from "./viewer_until.js";
import { Verdicts } from "./viewer_verdicts.js";
import { Where } from "./viewer_where.js";
import { brief, debounced, el, fill } from "./dom.js";

const LOOK_AGAIN_MS = 4000;
const SELDOM = 8;
const PUBLISHED_WAIT_MS = 300;
/** The panel is below the map, as the style has it. */
const BELOW = matchMedia("(max-width: 60rem)");

const NOTHING = buildScene({ keyframes: [], anchors: [], loops: [] });
const at = (id) => document.getElementById(id);
/** What is known and chosen when a map is opened: nothing. */
const FRESH = {
  map: null, meta: null, version: 0, scene: NOTHING,
  choice: null, apart: true, fleet: true, plane: null, selection: null, marks: {}, found: null, changes: null,
};
/** The answer to "where am I?" stays: its places lead from map to map. */
const state = { ...FRESH, answer: null };
let stream = null;
let loading = null;
let looks = 0;

const refs = {
  keyframe: (id) => ref(id, () => select("keyframe", id)),
  // An anchor of a keyframe that was asked about and not stored has no page.
  anchor: (id) => (id.startsWith("inline-") ? el("code", {}, id) : ref(id, () => select("anchor", id))),
  query: (id, keyframe) => ref("why", () => readQuery({ query: id, keyframe })),
  place: (map, id) => ref(id, () => (map === state.map ? select("keyframe", id) : open(map, { kind: "keyframe", id }, true))),
};
const world = {
  map: () => state.map, scene: () => state.scene, version: () => state.meta?.map_version ?? 0, settings: () => state.meta?.settings ?? {},
  plane: () => canvas.layout.plane, mark, locate, compare: (answer, candidate) => compare.open(answer, candidate),
};
const canvas = new MapCanvas(at("canvas"), { pick: (hit) => (hit ? select(hit.kind, hit.id, false) : letGo()), hover });
const details = new Details(at("details"), world, refs);
const compare = new Compare(world, refs);
const picture = new PictureForm(at("picture"), world, (one) => canvas.showPicture(one));
const anchors = new AnchorList(at("anchors"), world, refs, foundOnMap);
const keyframes = new KeyframeList(at("keyframes"), world, refs);
const events = new EventList(at("events"), at("tab-events"), refs);
const follower = new Follower({ version: () => state.version, isReading: () => loading !== null, read: () => load() });
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
  remember();
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

/** The address names the map and the selection, so that it can be sent to somebody. */
function remember(push = false) {
  const query = new URLSearchParams();
  if (state.map) query.set("map", state.map);
  if (state.selection) query.set(state.selection.kind, state.selection.id);
  const address = query.size > 0 ? `?${query}` : location.pathname;
  if (push) history.pushState(null, "", address);
  else history.replaceState(null, "", address);
}

function step(by) {
  const shown = canvas.keyframes;
  if (shown.length === 0) return;
  const now = shown.findIndex(({ id }) => state.selection?.kind === "keyframe" && id === state.selection.id);
  const next = now < 0 ? (by > 0 ? 0 : shown.length - 1) : (now + by + shown.length) % shown.length;
  select("keyframe", shown[next].id);
}

/** Steps within the session of the selected keyframe, and stops at its ends; at first, to the first keyframe. */
function stepInSession(by) {
  const { selection } = state;
  const session = selection?.kind === "keyframe" && canvas.point("keyframe", selection.id)?.session;
  if (!session) {
    step(by);
    return;
  }
  const points = canvas.bySession.get(session);
  const next = points[points.findIndex(({ id }) => id === selection.id) + by];
  if (next) select("keyframe", next.id);
}

// --- The map and its data ---------------------------------------------------------------------------------------------

async function open(map, selection = null, push = false, meta = null) {
  stream?.stop();
  loading?.abort();
  loading = null;
  follower.stop();
  Object.assign(state, { ...FRESH, map, selection });
  lay();
  document.title = `${map} – Revisit`;
  at("maps").value = map;
  remember(push);
  canvas.moved = false;
  events.clear();
  anchors.reset();
  keyframes.reset();
  sweep.reset();
  releases.reset();
  until.reset();
  verdicts.reset();
  where.refresh();
  details.clear();
  if (!await load(meta)) return;
  stream = listen(map, { event: happened, state: connected });
  if (selection) select(selection.kind, selection.id);
}

/** Reads the map again, but for what `meta` says; false if that failed or another map was opened meanwhile. */
async function load(meta = null) {
  loading?.abort();
  const turn = new AbortController();
  loading = turn;
  const begun = performance.now();
  try {
    const all = await everything(state.map, turn.signal, meta);
    if (turn.signal.aborted) return false;
    Object.assign(state, { meta: all.meta, version: all.version, scene: buildScene(all) });
    cover(all.keyframes.length + all.anchors.length === 0 ? noKeyframes(state.map) : null);
    redraw();
    return true;
  } catch (error) {
    if (!turn.signal.aborted) failed(error);
    return false;
  } finally {
    if (loading === turn) {
      follower.ranFor(performance.now() - begun);
      loading = null;
    }
  }
}

function failed(error) {
  if (error.status === 401) cover(keyWanted(start, key() && error.message));
  // A key without `read` cannot show anything: another one may.
  else if (error.status === 403 && state.meta === null) cover(keyWanted(start, error.message));
  else if (error.status === 404 && state.map !== null) gone();
  // What was read before stays on the page while the server is away.
  else if (state.meta === null) cover(unreachable(error.message));
  connected(error.status < 500 ? "reached" : "away");
}

/** The map is not there (any more); it may come. */
function gone() {
  stream?.stop();
  stream = null;
  state.meta = null;
  cover(noSuchMap(state.map));
}

/** An event: history is only listed, news also refresh the map. */
function happened(event) {
  events.add(event);
  follower.told(event.map_version);
  // The others change no version: a release, and a loop that a reading of the frames found.
  if (event.map_version < state.version) return;
  if (event.event === "release_published") published();
  else if (event.event === "loop_suspected" && !state.scene.suspects.has(event.loop)) follower.soon();
}

/** Maps come and go, and settings change without an event: look now and then; often only while no events come. */
async function lookAgain() {
  // Whoever types a key is not disturbed; an old one would be refused again and again.
  if (document.hidden || loading !== null || (!at("empty").hidden && at("empty").querySelector("form"))) return;
  looks += 1;
  const isTime = looks % SELDOM === 0;
  if (isLive() && !isTime) return;
  try {
    if (state.map === null || isTime) await readMaps();
    if (state.map === null) return;
    const meta = await get(path("maps", state.map));
    if (meta.id !== state.map) return;
    if (stream === null || state.meta === null) await open(state.map, state.selection);
    else follower.told(meta.map_version);
  } catch (error) {
    failed(error);
  }
}

/** Reads the list of maps, and gives it. */
async function readMaps() {
  const { items } = await list("v1/maps");
  const ids = items.map(({ id }) => id);
  if (state.map !== null && !ids.includes(state.map)) ids.unshift(state.map);
  const shown = [...at("maps").options].map(({ value }) => value);
  if (ids.join("\n") !== shown.join("\n")) fill(at("maps"), ids.map((id) => el("option", { value: id }, id)));
  at("maps").parentElement.hidden = ids.length === 0;
  if (state.map !== null) at("maps").value = state.map;
  else if (ids.length > 0) await open(ids[0], null, false, items[0]);
  else {
    cover(noMaps());
    connected("reached");
  }
  return items;
}

async function start() {
  const query = new URLSearchParams(location.search);
  const kind = ["keyframe", "anchor"].find((name) => query.has(name));
  state.map = query.get("map") || null;
  try {
    const maps = await readMaps();
    const map = query.get("map");
    if (map) await open(map, kind ? { kind, id: query.get(kind) } : null, false, maps.find(({ id }) => id === map));
  } catch (error) {
    failed(error);
  }
}

function isLive() {
  return at("live").dataset.state === "live";
}

function connected(how) {
  showConnection(at("live"), how);
}

// --- What is on the page ----------------------------------------------------------------------------------------------

function cover(content) {
  at("empty").hidden = content === null;
  document.body.classList.toggle("covered", content !== null);
  fill(at("empty"), content);
  if (content === null) canvas.resize();
}

function redraw() {
  const { meta, scene } = state;
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

function hover(hit, x, y) {
  const tip = at("tip");
  tip.hidden = hit === null;
  if (hit === null) return;
  fill(tip, inBrief(hit, state.scene));
  const { width, height } = canvas.size;
  const left = x + 14 + tip.offsetWidth > width ? x - 10 - tip.offsetWidth : x + 14;
  const top = y + 14 + tip.offsetHeight > height ? y - 10 - tip.offsetHeight : y + 14;
  tip.style.transform = `translate(${Math.max(left, 2)}px, ${Math.max(top, 2)}px)`;
}

/** Filled when they are opened, and again when the map changes, unless somebody is in the middle of one. */
const lists = {
  anchors: () => anchors.refresh(),
  keyframes: () => keyframes.refresh(),
  loops: () => { fillLoops(at("loop-list"), world, refs, () => follower.soon()); sweep.refresh(); },
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

listenToKeys(canvas, { step: stepInSession, stepAll: step, letGo, find });
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
setInterval(lookAgain, LOOK_AGAIN_MS);
document.addEventListener("visibilitychange", lookAgain);
start();
