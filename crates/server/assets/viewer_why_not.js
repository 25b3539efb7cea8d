// Why not: the candidates of an answer by the reason that stopped them, those first that only just failed.

import { REASONS } from "./words.js";
import { el, number } from "./dom.js";

const ENOUGH = 3;

/**
 * A choice among the reasons of the candidates that are no loop, which hides the cards of the others. `cards` are in the order of the
 * candidates, and stand in one list. Null where there are too few to choose from.
 */
export function whyNot(candidates, cards) {
  const stopped = candidates.filter(({ reason }) => reason);
  if (stopped.length < ENOUGH) return null;
  const codes = new Map();
  for (const { reason: { code } } of stopped) codes.set(code, (codes.get(code) ?? 0) + 1);
  const option = ([code, n]) => el("option", { value: code }, `${REASONS[code]?.title ?? code} (${number(n, 0)})`);
  const choose = ({ target: { value } }) => {
    const order = candidates.map((candidate, index) => ({ candidate, card: cards[index] }));
    if (value !== "") order.sort((a, b) => shortfall(a.candidate) - shortfall(b.candidate));
    for (const { candidate, card } of order) {
      card.hidden = value !== "" && !(candidate.reason && (value === "near" || candidate.reason.code === value));
      card.parentElement?.append(card);
    }
  };
  return el("label", { class: "row why-not" }, el("span", { class: "small" }, "Why not?"),
    el("select", { change: choose }, el("option", { value: "" }, "every candidate"),
      el("option", { value: "near" }, "no loop, near misses first"), [...codes].map(option)));
}

/** By what share of its limit a candidate failed; what has no figures comes last. */
export function shortfall({ reason }) {
  const { measured, limit } = reason ?? {};
  if (typeof measured !== "number" || typeof limit !== "number") return Infinity;
  const most = Math.max(Math.abs(measured), Math.abs(limit));
  return most === 0 ? 0 : Math.abs(measured - limit) / most;
}
