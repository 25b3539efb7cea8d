// Steps: which keyframe follows another one.

/** Among all that are shown, round and round; at first, the first or the last. Null where none is shown. */
export function nextOfAll({ keyframes: shown }, id, by) {
  if (shown.length === 0) return null;
  const now = shown.findIndex((point) => point.id === id);
  const next = now < 0 ? (by > 0 ? 0 : shown.length - 1) : (now + by + shown.length) % shown.length;
  return shown[next].id;
}

/** Within the session of a keyframe, up to its ends; at first, as among all. */
export function nextInSession(canvas, id, by) {
  const session = id !== null && canvas.point("keyframe", id)?.session;
  if (!session) return nextOfAll(canvas, id, by);
  const points = canvas.bySession.get(session);
  return points[points.findIndex((point) => point.id === id) + by]?.id ?? null;
}
