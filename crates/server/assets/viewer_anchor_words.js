// Anchor words: how far an anchor's description is, and how much it tells, in plain words.

/** What the states of the API mean; `valid` is the usual one. */
const STATES = { pending: "not read yet", valid: "tells places apart", uninformative: "says too little", retired: "hangs there no longer" };
const TONES = { pending: "open", valid: "good" };
/** By how much a text tells, from 1. */
const TELLS = ["nothing", "what many signs say", "a little", "which place it is", "which place it is"];

/** A state in words. */
export function stateWords(state) {
  return STATES[state] ?? state;
}

/** The colour of a state. */
export function stateTone(state) {
  return TONES[state] ?? "";
}

/** How much a description tells. */
export function tells({ information_level: level, information_reason: reason }) {
  return `${TELLS[level - 1] ?? level} (${level} of 5)${reason ? `: ${reason}` : ""}`;
}

/** An anchor's class, what is unusual of its state, and by how many it was seen. */
export function classAndState({ class: name, state, prior, keyframes }) {
  const seen = `seen by ${keyframes.length} ${keyframes.length === 1 ? "keyframe" : "keyframes"}`;
  return [name, state !== "valid" && stateWords(state), prior && "on a plan", seen].filter(Boolean).join(", ");
}
