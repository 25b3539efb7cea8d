// Address: names the map and the selection, so that it can be sent to somebody.

const KINDS = ["keyframe", "anchor"];

/** What the address names: `{ map, selection }`, each null where it names none. */
export function addressed() {
  const query = new URLSearchParams(location.search);
  const kind = KINDS.find((name) => query.has(name));
  return { map: query.get("map") || null, selection: kind ? { kind, id: query.get(kind) } : null };
}

/** Writes it; `push` makes it a step to come back from. */
export function remember({ map, selection }, push = false) {
  const query = new URLSearchParams();
  if (map) query.set("map", map);
  if (selection) query.set(selection.kind, selection.id);
  const address = query.size > 0 ? `?${query}` : location.pathname;
  if (push) history.pushState(null, "", address);
  else history.replaceState(null, "", address);
}
