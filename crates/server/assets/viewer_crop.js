// Crop: an anchor's best image, large, or small beside its text.

import { send } from "./viewer_api.js";
import { el, fill } from "./dom.js";

/** The image, or a sentence in its place. */
export function cropOf(address, signal) {
  const figure = el("div", { class: "crop" });
  draw(figure, address, signal).catch(({ status }) => fill(figure, el("p", { class: "muted small" },
    status === 404 ? "The image is gone: the map keeps none, or it was erased." : "The image cannot be shown.")));
  return figure;
}

/** What is read once it is seen: each image is a request. */
const waiting = new WeakMap();
const inView = new IntersectionObserver((entries) => {
  for (const { target, isIntersecting } of entries) {
    if (!isIntersecting) continue;
    inView.unobserve(target);
    waiting.get(target)();
  }
});

/** The image in a line of text; nothing where there is none. */
export function thumbOf(address, signal) {
  const figure = el("span", { class: "thumb" });
  waiting.set(figure, () => draw(figure, address, signal).catch(() => figure.remove()));
  inView.observe(figure);
  return figure;
}

/** Drawn on a canvas rather than linked, so that a key can be sent along. */
async function draw(figure, address, signal) {
  const response = await send(address, { signal });
  const image = await createImageBitmap(await response.blob());
  const { width, height } = image;
  const canvas = el("canvas", { width, height, role: "img", "aria-label": "The best image of the anchor" });
  canvas.getContext("2d").drawImage(image, 0, 0);
  figure.append(canvas);
}
