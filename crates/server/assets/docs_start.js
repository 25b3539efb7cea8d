// Start: the three calls of the first hour, as commands for a shell. A test runs them before all others of the page.

import { pretty } from "./docs_prose.js";

/** The plate of a door, two metres ahead of a camera that stands at `x`. */
const keyframe = (sec, x, text) => ({
  stamp: { sec, nanosec: 0 },
  pose: { translation: { x, y: 0, z: 0 }, rotation: { x: 0, y: 0, z: 0, w: 1 } },
  bow: { words: [3, 17, 42], weights: [1, 1, 1] },
  detections: [{ class: "door_number", confidence: 0.9, box: [300, 200, 340, 220], position: [x, 0, 2], text }],
});

const CALLS = [
  {
    id: "start_map", title: "Make a map", path: "v1/maps/hotel", body: {},
    about: "A map holds what your robots see in one building.",
  },
  {
    id: "start_keyframe", title: "Send a keyframe", path: "v1/maps/hotel/keyframes/kf-1", body: keyframe(1, 0, "901"),
    about: "A pose, three visual words, and a door plate that reads 901, two metres ahead.",
  },
  {
    id: "start_ask", title: "Ask", path: "v1/maps/hotel/keyframes/kf-2?query=loop", body: keyframe(90, 5, "Room 901"),
    about: "Drift has moved the pose by five metres, and the same plate is read again. `query=loop` asks in the same request. "
      + "The answer says `\"verdict\":\"loop\"` and `\"best\":\"kf-1\"`: the plates agree. It has no transformation: "
      + "no features were sent, so anchors alone decided. With `features` and `camera`, geometry runs too, and a loop that it verifies "
      + "has `candidate_from_query`.",
  },
];

/** The calls, each with its command. `base` is the server's address with a slash at its end; `keyed` if it wants a key. */
export function calls({ base, keyed = false }) {
  const key = keyed ? ` -H "authorization: Bearer $REVISIT_KEY"` : "";
  const needed = keyed ? " This server requires an API key: first `export REVISIT_KEY=SECRET`." : "";
  return CALLS.map(({ id, title, about, path, body }, number) => ({
    id, title, about: number === 0 ? about + needed : about,
    text: `curl -X PUT '${base}${path}'${key} \\\n  -H 'content-type: application/json' \\\n  -d '${pretty(body, "  ")}'`,
    steps: [{ id, method: "PUT", url: base + path, headers: [["content-type", "application/json"]], body: { text: pretty(body, "  ") }, types: ["application/json"] }],
  }));
}
