// Confirm: closes a loop that a verdict found.

import { path, post, whyNotWrite } from "./viewer_api.js";
import { el, fill } from "./dom.js";

/** What closes the loop of an answer: a button, where the keyframe is stored and the key may write. `closed` is the loop that did it already. */
export function confirmation(map, { id, keyframe, best }, closed) {
  if (closed) return el("p", { class: "small" }, `Confirmed as ${closed.id}. The tab Loops revokes it.`);
  const place = el("div", { class: "row small" });
  const confirm = async () => {
    button.disabled = true;
    try {
      const loop = await post(path("maps", map, "loops"), { id: `loop-${id}`, keyframe, candidate: best, query: id });
      const warnings = (loop.warnings ?? []).map(({ detail }) => ` ${detail}`);
      fill(place, el("span", { role: "status" }, `Confirmed as ${loop.id}.${warnings.join("")} The tab Loops revokes it.`));
    } catch (error) {
      button.disabled = false;
      fill(place, button, el("span", { class: "fault", role: "alert" }, error.message));
    }
  };
  const button = el("button", { type: "button", click: confirm }, "Confirm the loop");
  if (keyframe) whyNotWrite(map).then((barred) => barred === null && fill(place, button));
  return [el("p", { class: "muted small" }, "A verdict is not yet a closed loop: it is confirmed once the client has closed it in its own map."), place];
}
