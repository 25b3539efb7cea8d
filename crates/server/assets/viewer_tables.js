// Tables: facts, tables, and lists that may be long.

import { el, number } from "./dom.js";

const LISTED = 60;

/** Names and what is known of them; what is not known is left out. */
export function facts(...rows) {
  const said = rows.filter(([, value]) => value !== null && value !== undefined && value !== false && value !== "");
  return el("dl", { class: "facts" }, said.map(([name, value]) => [el("dt", {}, name), el("dd", {}, value)]));
}

/** A table with a head. */
export function table(heads, rows) {
  return el("table", {}, el("thead", {}, el("tr", {}, heads.map((head) => el("th", { scope: "col" }, head)))),
    el("tbody", {}, rows.map((cells) => el("tr", {}, cells.map((cell) => el("td", {}, cell))))));
}

/** A list that shows its first items, and the rest when asked. */
export function longList(items, kind, line) {
  const list = el("ul", { class: kind }, items.slice(0, LISTED).map((item) => el("li", {}, line(item))));
  if (items.length <= LISTED) return list;
  let from = LISTED;
  const more = el("button", { type: "button", click: () => {
    list.append(...items.slice(from, from + 500).map((item) => el("li", {}, line(item))));
    from += 500;
    more.remove();
    if (from < items.length) list.after(more);
    more.textContent = `${number(items.length - from, 0)} more`;
  } }, `${number(items.length - LISTED, 0)} more`);
  return el("div", {}, list, more);
}
