// Until: a slider of time, which shows the keyframes up to a moment and the signs that they saw.

import { isDate, moment } from "./viewer_time.js";
import { count, el, fill, number } from "./dom.js";

/** The slider. `changed()` hears that other keyframes are shown. */
export class Until {
  constructor(place, changed) {
    Object.assign(this, { place, keyframes: [], isOn: false });
    this.slider = el("input", { type: "range", min: 1, "aria-label": "Show the keyframes up to a moment", input: () => this.moved(changed) });
    this.said = el("output", { class: "small" });
    fill(place, this.slider, this.said);
  }

  /** The keyframes of these sessions, in the order of their stamps. */
  refresh(sessions) {
    this.keyframes = sessions.flatMap(({ keyframes }) => keyframes)
      .sort(({ stamp: a }, { stamp: b }) => a.sec - b.sec || a.nanosec - b.nanosec);
    const { length } = this.keyframes;
    this.place.hidden = length < 2;
    this.slider.max = Math.max(length, 1);
    this.isOn &&= this.slider.valueAsNumber < length;
    if (!this.isOn) this.slider.value = length;
    this.tell();
  }

  /** Shows everything. */
  reset() {
    this.isOn = false;
    this.slider.value = this.slider.max;
    this.tell();
  }

  moved(changed) {
    this.isOn = this.slider.valueAsNumber < this.keyframes.length;
    this.tell();
    changed();
  }

  /** The ids of those that are shown; null: all of them. */
  shown() {
    return this.isOn ? new Set(this.keyframes.slice(0, this.slider.valueAsNumber).map(({ id }) => id)) : null;
  }

  tell() {
    const { length } = this.keyframes;
    const last = this.keyframes[this.slider.valueAsNumber - 1];
    if (!this.isOn || !last) this.said.textContent = `all ${count(length, "keyframe")}`;
    else this.said.textContent = `${number(this.slider.value, 0)} of ${number(length, 0)}, up to ${isDate(last.stamp) ? moment(last.stamp) : `${last.stamp.sec} s`}`;
    this.slider.setAttribute("aria-valuetext", this.said.textContent);
  }
}
