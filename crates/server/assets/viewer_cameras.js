// Cameras: the places of an answer to "where am I?" on the canvas, and the signs that would tell them apart.

const LOOKS_ALONG = 0.2;

/** Draws the worst place first, so that the best one lies on top. */
export function drawPlaces(brush) {
  const { marks: { places, signs } } = brush.map;
  for (const sign of signs) drawSign(brush, sign);
  for (const place of places.toReversed()) (place.ahead ? drawCamera : drawRing)(brush, place);
}

function drawCamera({ map, context, theme, labels }, place) {
  const { x, y } = map.onScreen(place);
  const colour = theme[place.tone];
  const radius = place.radius_m * map.view.scale;
  context.strokeStyle = context.fillStyle = colour;
  context.lineWidth = place.best ? 2 : 1.2;
  context.beginPath();
  context.arc(x, y, radius, 0, 2 * Math.PI);
  context.globalAlpha = 0.14;
  context.fill();
  context.globalAlpha = 1;
  context.setLineDash(place.assumed ? [4, 4] : []);
  context.stroke();
  context.setLineDash([]);
  arrow(context, { x, y }, place, colour, theme.ground);
  label(labels, theme, place, { x, y });
}

/** An arrow the way the camera looks; a dot if it looks along the line of sight of the page. */
function arrow(context, { x, y }, { ahead: [u, v], best }, colour, ground) {
  const length = Math.hypot(u, v);
  const size = best ? 15 : 10;
  context.beginPath();
  if (length < LOOKS_ALONG) {
    context.arc(x, y, size / 2.5, 0, 2 * Math.PI);
  } else {
    const [dx, dy] = [size * u / length, -size * v / length];
    context.moveTo(x + dx, y + dy);
    context.lineTo(x - 0.7 * dx - 0.65 * dy, y - 0.7 * dy + 0.65 * dx);
    context.lineTo(x - 0.3 * dx, y - 0.3 * dy);
    context.lineTo(x - 0.7 * dx + 0.65 * dy, y - 0.7 * dy - 0.65 * dx);
    context.closePath();
  }
  context.lineWidth = best ? 2 : 1.8;
  context.fillStyle = best ? colour : ground;
  context.strokeStyle = best ? ground : colour;
  context.fill();
  context.stroke();
}

/** A place without a pose: its keyframe. */
function drawRing({ map, context, theme, labels }, place) {
  const { x, y } = map.onScreen(place);
  context.strokeStyle = theme[place.tone];
  context.lineWidth = place.best ? 3 : 1.6;
  context.beginPath();
  context.arc(x, y, place.best ? 10 : 8, 0, 2 * Math.PI);
  context.stroke();
  label(labels, theme, place, { x, y });
}

function drawSign({ map, context, theme, labels }, { text, ...point }) {
  const { x, y } = map.onScreen(point);
  context.strokeStyle = theme.accent;
  context.lineWidth = 2.2;
  context.setLineDash([5, 3]);
  context.beginPath();
  context.arc(x, y, 11, 0, 2 * Math.PI);
  context.stroke();
  context.setLineDash([]);
  labels.beside(`look for ${text}`, { x, y }, 14, { rank: "marked", colour: theme.accent, halo: theme.ground, bold: true });
}

function label(labels, theme, { text, tone, best }, { x, y }) {
  labels.beside(text, { x, y }, 16, { rank: best ? "marked" : "identifier", colour: theme[tone], halo: theme.ground, bold: best });
}
