// Picture: a floor plan's picture from a file of the user's, laid under the map. It stays in this tab and is sent to nobody.

import { el, fill } from "./dom.js";
import { AXES } from "./viewer_scene.js";

/** A canvas keeps four bytes for each pixel: a larger picture is made smaller. */
const MOST_PIXELS = 16e6;
const SETTLED = { metresPerPixel: 0.05, right: 0, up: 0, degrees: 0, shade: 50 };

/** Draws the picture, once for each frame in which its frame is shown, and only in the plane that it lies in. */
export function drawPicture({ map, context }) {
  const { picture, layout: { plane } } = map;
  if (!picture || picture.plane.join() !== plane.join()) return;
  const { image, frame, metresPerPixel, right, up, degrees, shade, shrunk } = picture;
  const turn = (degrees * Math.PI) / 180;
  const [cos, sin] = [Math.cos(turn), Math.sin(turn)];
  const metres = metresPerPixel * shrunk;
  const place = (across, above) => {
    const at = [0, 0, 0];
    at[plane[0]] = right + cos * across - sin * above;
    at[plane[1]] = up + sin * across + cos * above;
    return at;
  };
  for (const onPage of map.framesOf(frame)) {
    const [corner, across, down] = [[0, image.height], [1, image.height], [0, image.height - 1]]
      .map(([i, j]) => map.onScreen(onPage(place(i * metres, j * metres))));
    context.save();
    context.globalAlpha = shade / 100;
    context.transform(across.x - corner.x, across.y - corner.y, down.x - corner.x, down.y - corner.y, corner.x, corner.y);
    context.drawImage(image, 0, 0);
    context.restore();
  }
}

/** The form that lays a picture under the map. Each map of this tab has its own. */
export class PictureForm {
  /** `world` gives `map()`, `scene()` and `plane()`; `changed(picture)` hears what to draw. */
  constructor(place, world, changed) {
    Object.assign(this, { world, changed, pictures: new Map() });
    this.file = el("input", { type: "file", accept: "image/*", change: () => this.read(this.file.files[0]) });
    this.frame = el("select", { change: () => this.edit({ frame: this.frame.value }) });
    this.fields = ["metresPerPixel", "right", "up", "degrees"].map((name) => el("input", {
      type: "number", step: "any", "data-field": name, min: name === "metresPerPixel" ? "0.0001" : null, input: () => this.typed(),
    }));
    this.shade = el("input", { type: "range", min: 5, max: 100, "data-field": "shade", input: () => this.typed() });
    this.names = ["Metres per pixel", "", "", "Turned left by, degrees"].map((text) => el("span", {}, text));
    const field = (input, name) => el("label", { class: "file" }, name, input);
    this.settled = el("div", { class: "filters", hidden: true },
      field(this.frame, el("span", {}, "In the frame of")),
      this.fields.map((input, index) => field(input, this.names[index])),
      field(this.shade, el("span", {}, "Strength")),
      el("button", { type: "button", click: () => this.remove() }, "Take it away"));
    this.fault = el("p", { class: "fault", role: "alert", hidden: true });
    const panel = place.closest("details");
    panel.addEventListener("keydown", ({ key }) => {
      if (key !== "Escape") return;
      panel.open = false;
      panel.querySelector("summary").focus();
    });
    fill(place,
      el("p", { class: "muted small" }, "Lays a picture of a floor plan under the map. It stays in this tab and is not uploaded."),
      field(this.file, el("span", {}, "Picture")), this.fault, this.settled);
  }

  /** Another map, or another state of it. */
  refresh() {
    const { sessions, plans } = this.world.scene();
    const names = [...plans, ...sessions].map(({ name }) => name);
    if (names.join("\n") !== this.known) {
      this.known = names.join("\n");
      fill(this.frame, names.map((name) => el("option", { value: name }, name)));
    }
    this.show();
  }

  get picture() {
    return this.pictures.get(this.world.map()) ?? null;
  }

  async read(file) {
    if (!file) return;
    this.fault.hidden = true;
    const map = this.world.map();
    try {
      const { image, shrunk } = await decoded(file);
      this.pictures.set(map, {
        ...SETTLED, ...this.pictures.get(map), image, shrunk, frame: this.frame.value, plane: this.world.plane(),
      });
      this.show();
    } catch {
      this.fault.hidden = false;
      fill(this.fault, "The browser cannot read this file as a picture.");
    }
  }

  typed() {
    const values = [...this.fields, this.shade].map((input) => [input.dataset.field, input.valueAsNumber]);
    const isReal = ([name, value]) => Number.isFinite(value) && (name !== "metresPerPixel" || value > 0);
    this.edit(Object.fromEntries(values.filter(isReal)));
  }

  edit(more) {
    if (!this.picture) return;
    Object.assign(this.picture, more);
    this.changed(this.picture);
  }

  remove() {
    this.pictures.delete(this.world.map());
    this.file.value = "";
    this.show();
    this.file.focus();
  }

  show() {
    const { picture } = this;
    this.settled.hidden = picture === null;
    if (picture) {
      this.frame.value = picture.frame;
      for (const input of [...this.fields, this.shade]) if (document.activeElement !== input) input.value = picture[input.dataset.field];
      const [right, up] = picture.plane.map((axis) => AXES[axis]);
      this.names[1].textContent = `Lower left corner at ${right}, metres`;
      this.names[2].textContent = `and at ${up}, metres`;
    }
    this.changed(picture);
  }
}

async function decoded(file) {
  const address = URL.createObjectURL(file);
  try {
    const image = new Image();
    image.src = address;
    await image.decode();
    const { naturalWidth: width, naturalHeight: height } = image;
    if (width * height === 0) throw new Error("no size");
    const shrunk = Math.max(Math.sqrt((width * height) / MOST_PIXELS), 1);
    const canvas = el("canvas", { width: Math.round(width / shrunk), height: Math.round(height / shrunk) });
    canvas.getContext("2d").drawImage(image, 0, 0, canvas.width, canvas.height);
    return { image: canvas, shrunk };
  } finally {
    URL.revokeObjectURL(address);
  }
}
