// Canvas: the top view. It knows points on a page and what is marked among them; what they mean is the panel's affair.

import { onChange } from "./viewer_colours.js";
import { planPoints } from "./viewer_plans.js";
import { moved, shifted, turned } from "./viewer_scene.js";
import { drawScene } from "./viewer_draw.js";

const PICK_PX = 9;
const TICK_PX = 13;
const MARGIN_PX = 36;
const EDGE_PX = 28;
const FRAME_PX = 220;

/** Nothing is marked. `lines` are drawn from place to place, `rings` around keyframes, `places` and `signs` are an answer's, `changes` a comparison's. */
export const NO_MARKS = { keyframe: null, anchor: null, rings: new Map(), lines: [], found: null, places: [], signs: [], changes: null };

/** Draws a scene, moves over it, and tells what is under the pointer. */
export class MapCanvas {
  /** `on.pick({kind,id}|null)` after a click, `on.hover(hit|null, x, y)` under the pointer. */
  constructor(canvas, on) {
    Object.assign(this, { canvas, on, scene: null, layout: null, marks: NO_MARKS, labels: true, step: 0 });
    this.view = { u: 0, v: 0, scale: 1 };
    this.picture = null;
    this.moved = false;
    this.keyframes = [];
    this.anchors = [];
    this.byId = new Map();
    this.bySession = new Map();
    this.pointers = new Map();
    this.size = { width: 1, height: 1 };
    new ResizeObserver(() => this.resize()).observe(canvas);
    onChange(() => this.draw());
    this.listen();
  }

  /** A new scene or another layout of it, and of its keyframes those `shown` (null: all); the view stays where somebody has moved it. */
  show(scene, layout, shown = null) {
    Object.assign(this, { scene, layout });
    const [u, v] = layout.plane;
    const isShown = (id) => shown === null || shown.has(id);
    const isSeen = ({ anchor }) => shown === null || anchor.keyframes.some(isShown);
    this.bySession = new Map();
    this.anchors = [];
    for (const { session, placed, du, dv } of layout.groups.filter((group) => !group.session.isPlan)) {
      this.bySession.set(session, session.keyframes.filter(({ id }) => isShown(id)).map(({ id, place, forward }) => {
        const [at, ahead] = [moved(placed, place), turned(placed, forward)];
        return { kind: "keyframe", id, u: at[u] + du, v: at[v] + dv, ahead: [ahead[u], ahead[v]], session };
      }));
      for (const { anchor, place, assumed } of session.anchors.filter(isSeen)) {
        const at = moved(placed, place);
        this.anchors.push({ kind: "anchor", id: anchor.id, u: at[u] + du, v: at[v] + dv, anchor, session, assumed });
      }
    }
    this.anchors.push(...planPoints(layout));
    this.keyframes = [...this.bySession.values()].flat();
    this.byId = new Map(this.keyframes.map((point) => [point.id, point]));
    this.step = usualStep([...this.bySession.values()]);
    if (this.moved) this.draw();
    else this.fit();
  }

  /** Marks what is selected and what belongs to it. */
  mark(marks) {
    this.marks = { ...NO_MARKS, ...marks };
    this.draw();
  }

  /** Lays a picture under everything; `null` takes it away. */
  showPicture(picture) {
    this.picture = picture;
    this.draw();
  }

  showLabels(labels) {
    this.labels = labels;
    this.draw();
  }

  /** Where a place of a session's frame is on the page; null if that session is not shown. */
  project(sessionName, place) {
    return this.framesOf(sessionName)[0]?.(place) ?? null;
  }

  /** Ways from a session's or a plan's frame to the page; a plan may lie under several sessions. */
  framesOf(name) {
    const { groups, beneath, plane: [u, v] } = this.layout ?? { groups: [], beneath: [], plane: [0, 1] };
    const under = beneath.filter(({ plan }) => plan.name === name).map(({ placed, group }) => ({ ...group, placed }));
    const all = under.length > 0 ? under : groups.filter(({ session }) => session.name === name);
    return all.map(({ placed, du, dv, session }) => (place) => {
      const at = moved(placed, place);
      return { u: at[u] + du, v: at[v] + dv, session };
    });
  }

  /** Shows everything. */
  fit() {
    this.moved = false;
    if (!this.layout) return;
    const { u0, u1, v0, v1 } = this.layout.bounds;
    const { width, height } = this.size;
    const room = (pixels, length) => Math.max(pixels - 2 * MARGIN_PX, 40) / Math.max(length, 1e-9);
    const scale = Math.min(room(width, u1 - u0), room(height, v1 - v0));
    this.view = { u: (u0 + u1) / 2, v: (v0 + v1) / 2, scale: Math.min(scale, 400) };
    this.draw();
  }

  /** Brings a thing into view, and near enough to tell it from its neighbours. */
  reveal(kind, id) {
    const point = this.point(kind, id);
    if (point) this.bring(point);
    return Boolean(point);
  }

  /** Brings a point of a session into view. */
  bring(point) {
    const { width, height } = this.size;
    const frame = this.layout.framed && this.layout.frames.find(({ members }) => members.includes(point.session));
    if (frame) {
      const { u0, u1, v0, v1 } = shifted(frame);
      const side = Math.max(u1 - u0, v1 - v0);
      if (side * this.view.scale < FRAME_PX / 4) {
        this.view = { u: point.u, v: point.v, scale: FRAME_PX / side };
        this.moved = true;
      }
    }
    const { x, y } = this.onScreen(point);
    const outside = (at, most) => Math.max(EDGE_PX - at, 0) - Math.max(at - most + EDGE_PX, 0);
    const [dx, dy] = [outside(x, width), outside(y, height)];
    if (dx !== 0 || dy !== 0) this.pan(dx, dy);
    this.draw();
  }

  /** Shows all of some points, unless one of them is in view already. */
  bringAll(points) {
    const { width, height } = this.size;
    const isInView = (point) => {
      const { x, y } = this.onScreen(point);
      return x > 0 && y > 0 && x < width && y < height;
    };
    if (points.length === 0 || points.some(isInView)) return;
    const [us, vs] = [points.map(({ u }) => u), points.map(({ v }) => v)];
    const [u0, u1, v0, v1] = [Math.min(...us), Math.max(...us), Math.min(...vs), Math.max(...vs)];
    const room = (pixels, length) => Math.max(pixels - 2 * MARGIN_PX, 40) / Math.max(length, 1e-9);
    const scale = Math.min(room(width, u1 - u0), room(height, v1 - v0), this.view.scale);
    this.view = { u: (u0 + u1) / 2, v: (v0 + v1) / 2, scale };
    this.moved = true;
    this.draw();
  }

  /** Where a thing is shown; an anchor may be shown in several frames, and the first counts. */
  point(kind, id) {
    return kind === "keyframe" ? this.byId.get(id) : this.anchors.find((anchor) => anchor.id === id);
  }

  pan(dx, dy) {
    this.moved = true;
    this.view.u -= dx / this.view.scale;
    this.view.v += dy / this.view.scale;
    this.draw();
  }

  /** Zooms by a factor and leaves one point of the screen where it is. */
  zoom(factor, x = this.size.width / 2, y = this.size.height / 2) {
    this.moved = true;
    const before = this.onPage(x, y);
    this.view.scale = Math.min(Math.max(this.view.scale * factor, 1e-6), 1e5);
    const after = this.onPage(x, y);
    this.view.u += before.u - after.u;
    this.view.v += before.v - after.v;
    this.draw();
  }

  onScreen({ u, v }) {
    const { width, height } = this.size;
    return { x: (u - this.view.u) * this.view.scale + width / 2, y: height / 2 - (v - this.view.v) * this.view.scale };
  }

  onPage(x, y) {
    const { width, height } = this.size;
    return { u: (x - width / 2) / this.view.scale + this.view.u, v: (height / 2 - y) / this.view.scale + this.view.v };
  }

  /** How long the line that shows where a keyframe looks is, in pixels: shorter where they stand close, none where dense. */
  tickLength() {
    const apart = this.step === 0 ? TICK_PX : this.step * this.view.scale;
    return apart < 3 ? 0 : Math.min(TICK_PX, Math.max(5, 1.5 * apart));
  }

  /** What lies at a point of the screen, nearest first. A keyframe is its dot and its line of sight. */
  hits(x, y) {
    const hits = [];
    const length = this.tickLength();
    for (const point of this.anchors) {
      const at = this.onScreen(point);
      const distance = Math.hypot(at.x - x, at.y - y) - 2;
      if (distance < PICK_PX) hits.push({ distance, point });
    }
    for (const point of this.keyframes) {
      const at = this.onScreen(point);
      if (Math.abs(at.x - x) > PICK_PX + TICK_PX || Math.abs(at.y - y) > PICK_PX + TICK_PX) continue;
      const distance = toSegment(x - at.x, y - at.y, point.ahead[0] * length, -point.ahead[1] * length);
      if (distance < PICK_PX) hits.push({ distance, point });
    }
    return hits.sort((a, b) => a.distance - b.distance).map(({ point }) => point);
  }

  /** A click takes the nearest thing; another click at the same place takes the next one. */
  pick(x, y) {
    const hits = this.hits(x, y);
    const selected = hits.findIndex(({ kind, id }) => this.marks[kind] === id);
    const hit = hits.length ? hits[(selected + 1) % hits.length] : null;
    this.on.pick(hit && { kind: hit.kind, id: hit.id });
  }

  resize() {
    const { clientWidth: width, clientHeight: height } = this.canvas;
    this.size = { width: Math.max(width, 1), height: Math.max(height, 1) };
    const ratio = window.devicePixelRatio || 1;
    this.canvas.width = Math.round(width * ratio);
    this.canvas.height = Math.round(height * ratio);
    if (!this.moved) this.fit();
    this.drawNow();
  }

  /** Draws once before the next frame, however often it is called. */
  draw() {
    this.waiting ??= requestAnimationFrame(() => this.drawNow());
  }

  drawNow() {
    cancelAnimationFrame(this.waiting);
    this.waiting = null;
    if (!this.layout) return;
    const labels = drawScene(this);
    this.canvas.dispatchEvent(new CustomEvent("drawn", { detail: { labels } }));
  }

  listen() {
    const { canvas } = this;
    const at = (event) => {
      const box = canvas.getBoundingClientRect();
      return { x: event.clientX - box.left, y: event.clientY - box.top };
    };
    canvas.addEventListener("wheel", (event) => {
      event.preventDefault();
      const { x, y } = at(event);
      const lines = event.deltaMode === WheelEvent.DOM_DELTA_LINE ? 16 : 1;
      this.zoom(Math.exp(-event.deltaY * lines * (event.ctrlKey ? 0.01 : 0.0016)), x, y);
    }, { passive: false });
    canvas.addEventListener("pointerdown", (event) => {
      canvas.setPointerCapture(event.pointerId);
      this.pointers.set(event.pointerId, { ...at(event), moved: 0 });
    });
    canvas.addEventListener("pointermove", (event) => this.dragged(event, at(event)));
    canvas.addEventListener("pointerup", (event) => {
      const pointer = this.pointers.get(event.pointerId);
      this.pointers.delete(event.pointerId);
      if (pointer && pointer.moved < 5 && this.pointers.size === 0) this.pick(pointer.x, pointer.y);
    });
    canvas.addEventListener("pointercancel", (event) => this.pointers.delete(event.pointerId));
    canvas.addEventListener("pointerleave", () => this.on.hover(null, 0, 0));
    canvas.addEventListener("dblclick", (event) => this.zoom(2, at(event).x, at(event).y));
  }

  dragged(event, now) {
    const pointer = this.pointers.get(event.pointerId);
    if (!pointer) {
      const [hit] = this.hits(now.x, now.y);
      this.canvas.classList.toggle("on-thing", Boolean(hit));
      this.on.hover(hit ?? null, now.x, now.y);
      return;
    }
    const other = [...this.pointers.entries()].find(([id]) => id !== event.pointerId)?.[1];
    if (other) {
      const spread = (a) => Math.max(Math.hypot(a.x - other.x, a.y - other.y), 1);
      this.pan((now.x - pointer.x) / 2, (now.y - pointer.y) / 2);
      this.zoom(spread(now) / spread(pointer), (now.x + other.x) / 2, (now.y + other.y) / 2);
      other.moved = Infinity;
    } else if (pointer.moved + Math.hypot(now.x - pointer.x, now.y - pointer.y) >= 5) {
      this.pan(now.x - pointer.x, now.y - pointer.y);
      this.on.hover(null, 0, 0);
    }
    pointer.moved += Math.hypot(now.x - pointer.x, now.y - pointer.y);
    Object.assign(pointer, now);
  }
}

/** The usual way from one keyframe to the next; 0 if all stand still. */
function usualStep(paths) {
  const steps = paths.flatMap((path) => path.slice(1).map((to, index) => Math.hypot(to.u - path[index].u, to.v - path[index].v)));
  const moving = steps.filter((step) => step > 1e-6).sort((a, b) => a - b);
  return moving.length > 0 ? moving[Math.floor(moving.length / 2)] : 0;
}

function toSegment(x, y, dx, dy) {
  const squared = dx * dx + dy * dy;
  const along = squared > 0 ? Math.min(Math.max((x * dx + y * dy) / squared, 0), 1) : 0;
  return Math.hypot(x - along * dx, y - along * dy);
}
