// Trajectory: downloads the poses in the formats that SLAM tools read.

import { path, send } from "./viewer_api.js";
import { el, fill } from "./dom.js";

const FORMATS = [["tum", "TUM"], ["kitti", "KITTI"], ["g2o", "g2o"]];
/** All sessions in one frame, among the names of sessions. */
const FLEET = "";

/** A choice of sessions and a button for each format. `world` gives `map()` and `scene()`. */
export class Trajectory {
  constructor(place, world) {
    Object.assign(this, { place, world });
    this.session = el("select", { "aria-label": "Session of the trajectory" });
    this.fault = el("span", { class: "fault", role: "alert" });
    fill(place, el("span", { class: "muted" }, "Trajectory"), this.session,
      FORMATS.map(([format, name]) => el("button", { type: "button", click: () => this.download(format) }, name)), this.fault);
  }

  /** The sessions may be others. */
  refresh() {
    const { sessions, joined } = this.world.scene();
    const { value } = this.session;
    this.place.hidden = sessions.length === 0;
    this.session.hidden = sessions.length < 2;
    fill(this.session, joined > 1 && el("option", { value: FLEET }, `${joined} sessions, in one frame`),
      sessions.map(({ name }) => el("option", { value: name }, name)));
    if (sessions.some(({ name }) => name === value)) this.session.value = value;
  }

  /** Read rather than linked, so that a key can be sent along. */
  async download(format) {
    const [map, session] = [this.world.map(), this.session.value];
    const query = new URLSearchParams({ format, ...(session === FLEET ? { frame: "fleet" } : { session }) });
    this.fault.textContent = "";
    try {
      const answer = await send(`${path("maps", map, "trajectory")}?${query}`);
      const address = URL.createObjectURL(await answer.blob());
      el("a", { href: address, download: [map, session, format].filter(Boolean).join(".") }).click();
      setTimeout(() => URL.revokeObjectURL(address), 60_000);
    } catch (error) {
      this.fault.textContent = error.message;
    }
  }
}
