// Crop: an anchor's best image.

import { send } from "./viewer_api.js";
import { el, fill } from "./dom.js";

/** Drawn on a canvas rather than linked, so that a key can be sent along. */
export function cropOf(address, signal) {
  const figure = el("div", { class: "crop" });
  (async () => {
    const response = await send(address, { signal });
    const image = await createImageBitmap(await response.blob());
    const { width, height } = image;
    const canvas = el("canvas", { width, height, role: "img", "aria-label": "The best image of the anchor" });
    canvas.getContext("2d").drawImage(image, 0, 0);
    figure.append(canvas);
  })().catch(({ status }) => fill(figure, el("p", { class: "muted small" },
    status === 404 ? "The image is gone: the map keeps none, or it was erased." : "The image cannot be shown.")));
  return figure;
}
