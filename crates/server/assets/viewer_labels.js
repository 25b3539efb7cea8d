// Labels: texts on the canvas where there is room, the most important first; none lies on another.

const MOST = 400;
const HEIGHT_PX = 14;
const APART_PX = 2;
/** Where several things of one text stand this close, one label serves them all. */
const SAME_PX = 14;
const CELL_PX = 64;
const CHARACTERS = 28;
const FAMILY = "12px system-ui, sans-serif";
/** Kinds of texts that name one place: they decide whether two places are one. */
const NAMES = ["name", "proper_name", "code"];
/** What is written first, and so has room before the others. */
const RANKS = ["selected", "marked", "identifier", "figure", "described", "rest", "plan"];

const KNOWN_WIDTHS = 20_000;
const widths = new Map();

/** Collects labels while the rest is drawn; `write()` finds places for them and writes them on top. */
export class Labels {
  constructor(context, { width, height }) {
    Object.assign(this, { context, width, height, wanted: [], placed: [], cells: new Map() });
  }

  /** A text beside a point with a mark of some size. `rank` is a name of `RANKS`; `colour` and `halo` are colours. */
  beside(text, { x, y }, gap, { rank, ...style }) {
    this.wanted.push({ text, x, y, gap, order: RANKS.indexOf(rank), ...style });
  }

  /** A text that is already written: nothing is put on it. */
  reserve(text, left, top, width, height) {
    this.take({ text, left, top, width, height });
  }

  /** A mark that no text may cover. Texts may stand as close to it as they like, and marks on one another. */
  keepFree(left, top, width, height) {
    this.block({ left, top, width, height });
  }

  /** Finds places: the labels that have one, each with its box. */
  arrange() {
    const chosen = this.wanted.sort((a, b) => a.order - b.order);
    const written = [];
    const byText = new Map();
    for (const label of chosen) {
      if (written.length >= MOST) break;
      const alike = byText.get(label.text) ?? [];
      if (alike.some(({ x, y }) => Math.hypot(x - label.x, y - label.y) < SAME_PX)) continue;
      const box = this.place(label, written.length === 0);
      if (!box) continue;
      this.take(box);
      written.push({ ...label, ...box });
      byText.set(label.text, [...alike, label]);
    }
    return written;
  }

  /** Writes the labels that have a place; gives the boxes of all texts. */
  write() {
    const { context } = this;
    const written = this.arrange();
    context.textBaseline = "middle";
    context.lineWidth = 3.5;
    for (const { text, left, top, bold, colour, halo } of written.reverse()) {
      context.font = font(bold);
      context.strokeStyle = halo;
      context.strokeText(text, left, top + HEIGHT_PX / 2);
      context.fillStyle = colour;
      context.fillText(text, left, top + HEIGHT_PX / 2);
    }
    return this.placed;
  }

  /** The first free place around the point. What is selected is written whatever happens, once. */
  place({ text, x, y, gap, bold, centred, order }, isFirst) {
    const width = this.widthOf(text, bold);
    const boxes = spots(x, y, width, gap, centred).map(([left, top]) => ({ text, left, top, width, height: HEIGHT_PX }));
    const free = boxes.find((box) => this.isInside(box) && !this.isTaken(box));
    if (free || order > 0 || !isFirst) return free ?? null;
    const [{ left, top }] = boxes;
    const within = (at, most) => Math.max(Math.min(at, most), 0);
    return { text, left: within(left, this.width - width), top: within(top, this.height - HEIGHT_PX), width, height: HEIGHT_PX };
  }

  /** Measured once: thousands of labels are looked at for each drawing. */
  widthOf(text, bold) {
    const key = `${bold ? "b" : ""} ${text}`;
    if (!widths.has(key)) {
      if (widths.size > KNOWN_WIDTHS) widths.clear();
      this.context.font = font(bold);
      widths.set(key, this.context.measureText(text).width);
    }
    return widths.get(key);
  }

  isInside({ left, top, width, height }) {
    return left >= 0 && top >= 0 && left + width <= this.width && top + height <= this.height;
  }

  isTaken(box) {
    return cellsOf(box).some((cell) => this.cells.get(cell)?.some((other) => overlap(box, other)));
  }

  take(box) {
    this.placed.push(box);
    this.block(box);
  }

  block(box) {
    for (const cell of cellsOf(box)) {
      if (!this.cells.has(cell)) this.cells.set(cell, []);
      this.cells.get(cell).push(box);
    }
  }
}

/** What is written beside an anchor, in one line. */
export function textOf({ description, state, class: name }) {
  const text = description ?? (state === "pending" ? "…" : name);
  const characters = [...text.replace(/[\p{C}\s]+/gu, " ").trim()];
  return characters.length > CHARACTERS ? `${characters.slice(0, CHARACTERS - 1).join("")}…` : characters.join("");
}

/** The rank of an anchor's text where nothing else marks it. */
export function rankOf({ kind, description }) {
  return isName({ kind }) ? "identifier" : description ? "described" : "rest";
}

/** Does it name one place, as a door number does? */
export function isName({ kind }) {
  return NAMES.includes(kind);
}

function font(bold) {
  return `${bold ? "600 " : ""}${FAMILY}`;
}

/** Right, left, above and below a mark; a centred text lies on its point. */
function spots(x, y, width, gap, centred) {
  const middle = y - HEIGHT_PX / 2;
  if (centred) return [[x - width / 2, middle]];
  return [[x + gap, middle], [x - gap - width, middle], [x - width / 2, y - gap - HEIGHT_PX], [x - width / 2, y + gap],
    [x + 0.7 * gap, y - 0.7 * gap - HEIGHT_PX], [x + 0.7 * gap, y + 0.7 * gap],
    [x - 0.7 * gap - width, y - 0.7 * gap - HEIGHT_PX], [x - 0.7 * gap - width, y + 0.7 * gap]];
}

function overlap(a, b) {
  return a.left < b.left + b.width + APART_PX && b.left < a.left + a.width + APART_PX
    && a.top < b.top + b.height && b.top < a.top + a.height;
}

function cellsOf({ left, top, width, height }) {
  const cells = [];
  for (let i = Math.floor((left - APART_PX) / CELL_PX); i <= Math.floor((left + width + APART_PX) / CELL_PX); i += 1) {
    for (let j = Math.floor(top / CELL_PX); j <= Math.floor((top + height) / CELL_PX); j += 1) cells.push(i * 4096 + j);
  }
  return cells;
}
