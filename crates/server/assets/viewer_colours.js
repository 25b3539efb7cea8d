// Colours: what sessions, classes, pairs and tones look like, by day and by night. Canvas, legend and drawings take them from here.

const CLASS_HUES = [45, 330, 110, 200, 285, 10, 150, 240];
const PAIR_HUES = [250, 150, 300, 200, 95, 340];
const FAR_HUE = 137.508;
const TONES = ["ground", "panel", "line", "strong-line", "text", "muted", "accent", "good", "bad", "open"];

/** The colours of the page's style, as they are now: day and night change them. */
export function theme() {
  const style = getComputedStyle(document.documentElement);
  return Object.fromEntries(TONES.map((name) => [name, style.getPropertyValue(`--${name}`).trim()]));
}

/** Runs something whenever day and night change. */
export function onChange(run) {
  night.addEventListener("change", run);
}

/** A session's colour: neighbours in the list get hues far apart. */
export function sessionColour(index) {
  return srgb(night.matches ? 0.72 : 0.58, 0.12, (250 + index * FAR_HUE) % 360);
}

/** The colour of a class of anchors. */
export function classColour(index) {
  return srgb(night.matches ? 0.8 : 0.52, 0.17, CLASS_HUES[index % CLASS_HUES.length]);
}

/** The colour of a pair of anchors that match; none of them is the red of a contradiction. */
export function pairColour(index) {
  return srgb(night.matches ? 0.8 : 0.48, 0.14, PAIR_HUES[index % PAIR_HUES.length]);
}

const night = matchMedia("(prefers-color-scheme: dark)");
const known = new Map();

/**
 * An OKLCH colour as whole sRGB numbers, with less chroma where the screen could not show it. A canvas and an element would
 * otherwise fit such a colour into sRGB each in its own way.
 */
function srgb(lightness, chroma, hue) {
  const name = `${lightness} ${hue}`;
  if (!known.has(name)) {
    let channels = linear(lightness, chroma, hue);
    for (let less = chroma; channels.some((one) => one < 0 || one > 1) && less > 0; less -= 0.005) channels = linear(lightness, less, hue);
    known.set(name, `rgb(${channels.map(encoded).join(", ")})`);
  }
  return known.get(name);
}

function linear(lightness, chroma, hue) {
  const turn = (hue * Math.PI) / 180;
  const [a, b] = [chroma * Math.cos(turn), chroma * Math.sin(turn)];
  const [l, m, s] = [0.3963377774 * a + 0.2158037573 * b, -0.1055613458 * a - 0.0638541728 * b, -0.0894841775 * a - 1.291485548 * b]
    .map((part) => (lightness + part) ** 3);
  return [4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s, -1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s,
    -0.0041960863 * l - 0.7034186147 * m + 1.707614701 * s];
}

function encoded(value) {
  const within = Math.min(Math.max(value, 0), 1);
  return Math.round(255 * (within <= 0.0031308 ? 12.92 * within : 1.055 * within ** (1 / 2.4) - 0.055));
}
