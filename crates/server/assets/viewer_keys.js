// Keys: what the keyboard does on the map, and the one key that works everywhere.

const PAN_PX = 60;
const ZOOM = 1.4;
const TYPING = "input, textarea, select, [contenteditable], dialog";

/** `does` has `step(by)` within the session, `stepAll(by)` over all that is shown, `letGo()` and `find()`. */
export function listenToKeys(canvas, { step, stepAll, letGo, find }) {
  const plain = {
    ArrowLeft: () => step(-1), ArrowUp: () => step(-1), ArrowRight: () => step(1), ArrowDown: () => step(1),
    "+": () => canvas.zoom(ZOOM), "=": () => canvas.zoom(ZOOM), "-": () => canvas.zoom(1 / ZOOM), 0: () => canvas.fit(),
    n: () => stepAll(1), p: () => stepAll(-1), Escape: letGo,
  };
  const shifted = {
    ...plain, ArrowLeft: () => canvas.pan(PAN_PX, 0), ArrowRight: () => canvas.pan(-PAN_PX, 0),
    ArrowUp: () => canvas.pan(0, PAN_PX), ArrowDown: () => canvas.pan(0, -PAN_PX),
  };
  canvas.canvas.addEventListener("keydown", (event) => {
    const act = (event.shiftKey ? shifted : plain)[event.key];
    if (isCommand(event) || !act) return;
    event.preventDefault();
    act();
  });
  document.addEventListener("keydown", (event) => {
    if (event.key !== "/" || isCommand(event) || event.target.closest?.(TYPING)) return;
    event.preventDefault();
    find();
  });
}

function isCommand({ ctrlKey, metaKey, altKey }) {
  return ctrlKey || metaKey || altKey;
}
