// Run: sends the requests of an example to this server, and shows the answer beneath.

import { key, setKey } from "./viewer_api.js";
import { fetchInTurn } from "./viewer_turns.js";
import { pretty } from "./docs_prose.js";
import { copyable, el, fill } from "./dom.js";

const SHOWN = 20_000;
/** A stream never ends: so long it is read. */
const STREAM_MS = 2000;
/** Questions that are posted and write nothing. */
const READS = /^(query_loop|locate|similarity|information|merge_text)$/;

/** The commands, a button that runs them, and the place of the answer. */
export function runnable(text, steps) {
  const place = el("div", { class: "result", role: "status" });
  const buttons = el("div", { class: "run" });
  const writes = steps.some(({ id, method }) => method !== "GET" && !READS.test(id));
  const first = () => {
    const button = el("button", { type: "button", click: () => (writes ? sure() : run()) }, "Run");
    fill(buttons, button);
    return button;
  };
  const sure = () => {
    const yes = el("button", { type: "button", class: "main", click: () => run() }, "Run it");
    fill(buttons, el("span", { class: "muted" }, "It writes to this server. "), yes,
      el("button", { type: "button", click: () => first().focus() }, "Leave it"));
    yes.focus();
  };
  const run = async () => {
    const button = first();
    button.disabled = true;
    fill(place, el("p", { class: "muted" }, "Running …"));
    fill(place, await answered(steps, run));
    button.disabled = false;
    if (document.activeElement === document.body) button.focus();
  };
  first();
  return [copyable(text), buttons, place];
}

/** What the last of some requests answers, or the first that is refused. */
async function answered(steps, again) {
  const variables = {};
  try {
    for (const [index, step] of steps.entries()) {
      const { response, body } = await send(step, variables);
      if (response.status === 401) return keyWanted(again);
      if (!response.ok || index === steps.length - 1) return shown(step, response, body);
      for (const [variable, member] of Object.entries(step.keep ?? {})) variables[variable] = JSON.parse(body)[member];
    }
  } catch (error) {
    return el("p", { class: "fault", role: "alert" }, error.message);
  }
}

async function send({ id, method, url, headers, body, types }, variables) {
  const filled = url.replace(/\$(\w+)/g, (_, name) => encodeURIComponent(variables[name] ?? name));
  const all = new Headers(headers);
  if (key()) all.set("authorization", `Bearer ${key()}`);
  const response = await fetchInTurn(filled, { method, headers: all, body: body?.text });
  if (!response.ok) return { response, body: await response.text() };
  if (types.includes("text/event-stream")) return { response, body: await beginning(response) };
  if (!/^text\/|json/.test(response.headers.get("content-type") ?? "text/")) return { response, body: await response.blob() };
  const text = await response.text();
  // From its first key on, a server wants one: the page goes on with it.
  if (id === "create_key" && !key()) setKey(JSON.parse(text).secret);
  return { response, body: text };
}

/** What a stream says in its first moments. */
async function beginning(response) {
  const reader = response.body.pipeThrough(new TextDecoderStream()).getReader();
  const timer = setTimeout(() => reader.cancel(), STREAM_MS);
  let text = "";
  for (;;) {
    const { value, done } = await reader.read();
    if (done) break;
    text += value;
  }
  clearTimeout(timer);
  return `${text}… the stream goes on`;
}

function shown({ url }, { status, statusText, ok }, body) {
  const head = el("p", {}, el("span", { class: `status ${ok ? "good" : "bad"}` }, status), ` ${statusText}`);
  if (body instanceof Blob) {
    const isImage = body.type.startsWith("image/");
    return [head, isImage ? el("img", { src: URL.createObjectURL(body), alt: `The answer of ${url}` }) : el("p", {}, `${body.size} bytes of ${body.type}`)];
  }
  if (body === "") return head;
  const text = indented(body);
  return [head, copyable(text.length > SHOWN ? `${text.slice(0, SHOWN)}\n… ${text.length - SHOWN} characters more` : text)];
}

function indented(text) {
  try {
    return pretty(JSON.parse(text));
  } catch {
    return text.trimEnd();
  }
}

/** The server wants a key: it is kept in this browser tab, as the viewer keeps it. */
function keyWanted(again) {
  const input = el("input", { type: "password", autocomplete: "off", required: true, "aria-label": "API key" });
  const submit = (event) => {
    event.preventDefault();
    setKey(input.value.trim());
    again();
  };
  return el("form", { class: "run", submit }, el("span", {}, key() ? "This key does not open it. Another one: " : "This server wants an API key: "), input,
    el("button", { type: "submit", class: "main" }, "Use it"));
}
