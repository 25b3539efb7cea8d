// Prose: descriptions as the API document writes them, and JSON as people write it.

import { el } from "./dom.js";

const LINE = 76;

/** Paragraphs and lists, with `code` in backticks: all of Markdown that the document uses. */
export function prose(text) {
  return (text ?? "").split(/\n{2,}/).filter((block) => block.trim()).map((block) => {
    const lines = block.split("\n");
    if (lines.every((line) => /^[-*] /.test(line))) {
      return el("ul", { class: "bullets" }, lines.map((line) => el("li", {}, inline(line.slice(2)))));
    }
    return el("p", {}, inline(lines.join(" ")));
  });
}

/** One line of prose. */
export function inline(text) {
  const isCode = (part) => part.startsWith("`") && part.length > 2;
  return (text ?? "").split(/(`[^`]+`)/).map((part) => (isCode(part) ? el("code", {}, part.slice(1, -1)) : part));
}

/** JSON that keeps on one line what fits there. */
export function pretty(value, indent = "") {
  const whole = spaced(value);
  if (whole.length + indent.length <= LINE || value === null || typeof value !== "object") return whole;
  const deeper = `${indent}  `;
  if (Array.isArray(value)) return `[\n${value.map((item) => deeper + pretty(item, deeper)).join(",\n")}\n${indent}]`;
  const members = Object.entries(value).map(([name, item]) => `${deeper}${JSON.stringify(name)}: ${pretty(item, deeper)}`);
  return `{\n${members.join(",\n")}\n${indent}}`;
}

function spaced(value) {
  if (Array.isArray(value)) return `[${value.map(spaced).join(", ")}]`;
  if (value === null || typeof value !== "object") return JSON.stringify(value);
  return `{${Object.entries(value).map(([name, item]) => `${JSON.stringify(name)}: ${spaced(item)}`).join(", ")}}`;
}
