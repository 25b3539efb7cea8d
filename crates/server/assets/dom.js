// Dom: making elements. What comes from the server becomes a text node and nothing else: a sign on a wall is anybody's input.

/** An element with attributes (functions become listeners, `false` and `null` leave one out) and children. */
export function el(tag, attributes = {}, ...children) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (value === null || value === undefined || value === false) continue;
    if (typeof value === "function") element.addEventListener(name, value);
    else element.setAttribute(name, value === true ? "" : String(value));
  }
  append(element, children);
  return element;
}

/** An element of a drawing. */
export function svg(tag, attributes = {}, ...children) {
  const element = document.createElementNS("http://www.w3.org/2000/svg", tag);
  for (const [name, value] of Object.entries(attributes)) if (value !== null) element.setAttribute(name, String(value));
  append(element, children);
  return element;
}

function append(element, children) {
  for (const child of children.flat(Infinity)) {
    if (child === null || child === undefined || child === false) continue;
    element.append(child instanceof Node ? child : document.createTextNode(String(child)));
  }
}

/** Puts new children in the place of the old ones. */
export function fill(element, ...children) {
  element.replaceChildren();
  append(element, children);
  return element;
}

/** Text that somebody wrote on a wall: set apart, so that its writing direction stays its own affair. */
export function sign(text) {
  return el("bdi", { class: "sign" }, text);
}

/** A block of text with a button that copies it. */
export function copyable(text, label = "Copy") {
  const button = el("button", { type: "button", click: () => copy(text, button, label) }, label);
  return el("div", { class: "copyable" }, el("pre", { tabindex: "0" }, el("code", {}, text)), button);
}

async function copy(text, button, label) {
  const done = await copied(text);
  button.textContent = done ? "Copied" : "Select it";
  setTimeout(() => { button.textContent = label; }, 1500);
}

/** The clipboard is there on https and localhost only; elsewhere the old way serves. */
async function copied(text) {
  try {
    await navigator.clipboard.writeText(text);
    return true;
  } catch {
    const area = el("textarea", { class: "offscreen", "aria-hidden": "true" });
    area.value = text;
    document.body.append(area);
    area.select();
    const done = document.execCommand("copy");
    area.remove();
    return done;
  }
}

/** Runs something once the calls for it have paused; `wait` may be a function. */
export function debounced(run, wait) {
  let timer = null;
  return (...args) => {
    clearTimeout(timer);
    timer = setTimeout(() => run(...args), typeof wait === "function" ? wait() : wait);
  };
}

/** A number for people: at most so many decimals, none of them a trailing zero. */
export function number(value, decimals = 2) {
  return Number(value).toLocaleString("en", { maximumFractionDigits: decimals });
}

/** A number where there is little room: `1.2K`. */
export function brief(value) {
  return Number(value).toLocaleString("en", { notation: "compact", maximumFractionDigits: 1 });
}

/** `1 anchor`, `2 anchors`. */
export function count(n, one, many = `${one}s`) {
  return `${number(n, 0)} ${n === 1 ? one : many}`;
}

/** Orders names. Numbers in them count: kf-2 comes before kf-10. */
export const { compare: byName } = new Intl.Collator("en", { numeric: true });
