// Asked: the keyframes of a file or of a pasted text, as `POST /v1/locate` takes them.

const MIB = 1024 * 1024;
const FILE_MIB = 256;
const KEYFRAMES = 10000;
/** The first bytes of what `zstd` and `gzip` write. */
const COMPRESSED = { "28b52ffd": "zstd -d", "1f8b": "gunzip" };

/** Fields that place a keyframe in a map, or that only answers have. A question has none of them. */
const PLACED = ["id", "session", "observes", "observes_i64", "covisible", "covisible_total", "map_version"];
/** The same of a detection. */
const STORED = ["has_crop", "anchor", "outcome", "reason", "state"];

/** Reads a file: a keyframe, a line of a recording, or a whole recording. */
export async function keyframesOfFile(file) {
  if (file.size > FILE_MIB * MIB) throw new Error(`It has more than ${FILE_MIB} MiB.`);
  const start = [...new Uint8Array(await file.slice(0, 4).arrayBuffer())];
  const digits = start.map((byte) => byte.toString(16).padStart(2, "0")).join("");
  const packed = Object.keys(COMPRESSED).find((magic) => digits.startsWith(magic));
  if (packed) throw new Error(`It is compressed. Unpack it first: ${COMPRESSED[packed]} ${file.name}`);
  return keyframesOf(await file.text());
}

/**
 * Reads a text. Each keyframe has its `id` and `session` where they are known, and `body()`. A recording is kept as
 * text, because its parsed numbers would take several times the memory. `more` counts keyframes beyond the limit.
 */
export function keyframesOf(text) {
  let whole;
  try {
    whole = JSON.parse(text);
  } catch (error) {
    return keyframesOfLines(text, error);
  }
  return { keyframes: [keyframe(whole, "It") ?? lacks()], more: 0 };
}

/** Wraps a keyframe as the server answers it. Its words are the map's, which only the map says: `client` names none. */
export function stored(view, vocabulary) {
  const isNamed = view.bow && vocabulary && vocabulary !== "client";
  return keyframe(isNamed ? { ...view, bow: { ...view.bow, vocabulary } } : view, "It");
}

/** The keyframe of a question: nothing in it says where it is. */
export function unplaced(body) {
  const kept = without(body, PLACED);
  if (Array.isArray(kept.detections)) {
    kept.detections = kept.detections.map((one) => (isObject(one) ? without(one, STORED) : one));
  }
  return kept;
}

function keyframesOfLines(text, fault) {
  const lines = text.split("\n").map((line, index) => ({ line, where: `Line ${index + 1}` }))
    .filter(({ line }) => line.trim() !== "");
  const isRecording = lines.length > 1 && isJson(lines[0].line);
  if (!isRecording) throw new Error(lines.length === 0 ? "It is empty." : `It is not JSON: ${fault.message}`);
  const keyframes = [];
  let more = 0;
  for (const { line, where } of lines) {
    const found = keyframe(parsed(line, where), where);
    if (!found) continue;
    if (keyframes.length === KEYFRAMES) more += 1;
    else keyframes.push({ ...found, body: () => keyframe(JSON.parse(line), where).body() });
  }
  if (keyframes.length === 0) lacks();
  return { keyframes, more };
}

function isJson(line) {
  try {
    JSON.parse(line);
    return true;
  } catch {
    return false;
  }
}

function parsed(line, where) {
  try {
    return JSON.parse(line);
  } catch (error) {
    throw new Error(`${where} is not JSON: ${error.message}`, { cause: error });
  }
}

/** The keyframe of a line, or of a body; null for a line of a recording about something else. */
function keyframe(value, where) {
  if (!isObject(value)) throw new Error(`${where} is not a JSON object.`);
  if ("op" in value && value.op !== "keyframe") return null;
  const body = "op" in value ? value.body : value;
  if (!isObject(body)) throw new Error(`${where} has no "body".`);
  const name = (one) => (typeof one === "string" ? one : null);
  return { id: name(value.id), session: name(body.session), body: () => body };
}

function lacks() {
  throw new Error("It has no keyframe: a JSON object, or lines with \"op\":\"keyframe\".");
}

function isObject(value) {
  return typeof value === "object" && value !== null && !Array.isArray(value);
}

function without(object, fields) {
  return Object.fromEntries(Object.entries(object).filter(([name]) => !fields.includes(name)));
}
