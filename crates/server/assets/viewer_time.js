// Time: moments of robots' clocks and of the server's, and the time between two of them.

import { count, el } from "./dom.js";

/** A robot's clock may count from 1970 or from its start. */
const CALENDAR = { from: 631152000, to: 7258118400 };
const UNITS = [[86400, "day"], [3600, "hour"], [60, "minute"], [1, "second"]];

/** A stamp for the details of a keyframe. */
export function time(stamp) {
  const { sec, nanosec } = stamp;
  const seconds = `${sec}.${String(nanosec).padStart(9, "0").replace(/0{1,6}$/, "")} s`;
  if (!isDate(stamp)) return [seconds, el("span", { class: "muted" }, " of the robot's clock")];
  return [moment(stamp), el("div", { class: "muted small" }, seconds)];
}

/** Does a stamp count from 1970? */
export function isDate({ sec }) {
  return sec > CALENDAR.from && sec < CALENDAR.to;
}

/** A stamp that counts from 1970, to the second. */
export function moment({ sec }) {
  return new Date(sec * 1000).toISOString().replace("T", " ").replace(".000Z", " UTC");
}

/** The time between two stamps of one clock, in its two largest units. */
export function between(a, b) {
  let left = Math.round(Math.abs(a.sec - b.sec + (a.nanosec - b.nanosec) / 1e9));
  const parts = [];
  for (const [length, name] of UNITS) {
    const times = Math.floor(left / length);
    left -= times * length;
    if (times > 0 || (length === 1 && parts.length === 0)) parts.push(count(times, name));
  }
  return parts.slice(0, 2).join(" ");
}
