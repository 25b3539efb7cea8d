// Api: what the viewer asks of the server. Addresses are relative, so that the page also works behind a path of a proxy.

import { fetchInTurn } from "./viewer_turns.js";

const PAGE = 1000;
const KEY = "revisit.key";

/** A refusal, with the server's problem document where there is one. */
export class Refusal extends Error {
  constructor(status, problem) {
    const faults = (problem.errors ?? []).map((fault) => `${fault.pointer} ${fault.detail}`);
    super([problem.detail || problem.title || `HTTP ${status}`, ...faults].join("; "));
    this.status = status;
    this.told = problem.detail || problem.title;
    this.faults = problem.errors ?? [];
    this.code = problem.code ?? "";
  }
}

/** An address below `v1/`, each part encoded. */
export function path(...parts) {
  return ["v1", ...parts.map(encodeURIComponent)].join("/");
}

/** The API key of this browser tab, if the server wants one. */
export function key() {
  return sessionStorage.getItem(KEY);
}

/** Keeps the key until the tab is closed. */
export function setKey(secret) {
  sessionStorage.setItem(KEY, secret);
}

/** Sends a request; anything but a success is thrown. */
export async function send(address, options = {}) {
  const headers = { ...options.headers };
  if (key()) headers.authorization = `Bearer ${key()}`;
  const response = await fetchInTurn(address, { ...options, headers });
  if (response.ok) return response;
  const problem = await response.json().catch(() => ({}));
  throw new Refusal(response.status, problem);
}

/** Reads JSON. */
export async function get(address, signal) {
  return (await send(address, { signal })).json();
}

/** Posts JSON and reads the answer. */
export async function post(address, body, signal) {
  const headers = { "content-type": "application/json" };
  return (await send(address, { method: "POST", headers, body: JSON.stringify(body), signal })).json();
}

/** Puts JSON; `created` is false where this very request was sent before. */
export async function put(address, body) {
  const headers = { "content-type": "application/json" };
  const response = await send(address, { method: "PUT", headers, body: JSON.stringify(body) });
  return { created: response.status === 201, value: await response.json() };
}

/** Deletes something; null where that leaves nothing to tell. */
export async function remove(address) {
  const response = await send(address, { method: "DELETE" });
  return response.status === 204 ? null : response.json();
}

/** What each key may do, once it was asked. */
const rights = new Map();

/** Why the key of this tab may not write to a map; null if it may. */
export async function whyNotWrite(map) {
  if (!key()) return null;
  if (!rights.has(key())) rights.set(key(), get(path("keys", "me")));
  try {
    const { actions, maps } = await rights.get(key());
    if (!actions.includes("write")) return "it lacks the action write.";
    return maps.some((pattern) => covers(pattern, map)) ? null : "it does not cover this map.";
  } catch {
    // The server refuses what is offered in vain.
    rights.delete(key());
    return null;
  }
}

/** `*` stands for any characters. */
function covers(pattern, map) {
  const parts = pattern.split("*").map((part) => part.replace(/[.]/g, "\\."));
  return new RegExp(`^${parts.join(".*")}$`).test(map);
}

/** A whole list, part by part. `version` is the map's when the first part was read. */
export async function list(address, { signal, most = Infinity, parameters = {} } = {}) {
  const items = [];
  let version = 0;
  let cursor = null;
  do {
    const query = new URLSearchParams({ ...parameters, limit: String(PAGE) });
    if (cursor !== null) query.set("cursor", cursor);
    const part = await get(`${address}?${query}`, signal);
    version ||= part.map_version ?? 0;
    for (const item of part.items) items.push(item);
    cursor = part.next_cursor;
  } while (cursor !== null && items.length < most);
  return { items, version, more: cursor !== null };
}

/** Everything that the top view shows of a map. Where the map itself was read just now, `known`, what it has none of is not asked for. */
export async function everything(map, signal, known = null) {
  const hasLoops = known === null || known.loops > 0;
  // One session alone has one frame, its own.
  const hasFrames = known === null || known.sessions > 1;
  const none = { items: [], version: Infinity };
  const [meta, keyframes, anchors, loops, sessions, frames] = await Promise.all([
    known ?? get(path("maps", map), signal),
    list(path("maps", map, "keyframes"), { signal }),
    list(path("maps", map, "anchors"), { signal }),
    hasLoops ? list(path("maps", map, "loops"), { signal }) : none,
    hasFrames ? list(path("maps", map, "sessions"), { signal }) : none,
    // Without them each session stands in its own frame.
    hasLoops || hasFrames ? get(path("maps", map, "frames"), signal).catch(() => null) : null,
  ]);
  const version = Math.min(meta.map_version, keyframes.version, anchors.version, loops.version);
  return {
    meta, version, keyframes: keyframes.items, anchors: anchors.items, loops: loops.items, sessions: sessions.items, frames,
  };
}
