// Events: the map's server-sent events as they come.

import { key, path, send } from "./viewer_api.js";
import { EVENTS } from "./words.js";

const RETRY_MS = 4000;

/** Listens to a map from its first event on; `stop()` ends it. */
export function listen(map, { event, state }) {
  const address = `${path("maps", map, "events")}?since=0`;
  return key() ? listenWithKey(address, event, state) : listenOpenly(address, event, state);
}

function listenOpenly(address, event, state) {
  let source = null;
  let retry = null;
  let last = 0;
  const take = (message) => {
    const told = JSON.parse(message.data);
    // After a retry of ours the stream starts anew.
    if (told.seq <= last) return;
    last = told.seq;
    event(told);
  };
  const open = () => {
    source = new EventSource(address);
    source.addEventListener("open", () => state("live"));
    source.addEventListener("error", () => {
      state("away");
      // The browser comes back by itself unless the answer was no stream.
      if (source.readyState === EventSource.CLOSED) retry = setTimeout(open, RETRY_MS);
    });
    for (const name of EVENTS) source.addEventListener(name, take);
  };
  open();
  return { stop() { clearTimeout(retry); source.close(); } };
}

/** EventSource sends no key, so this reads the stream by hand. */
function listenWithKey(address, event, state) {
  const stopped = new AbortController();
  let last = 0;
  const read = async () => {
    const headers = last ? { "last-event-id": String(last) } : {};
    const response = await send(address, { signal: stopped.signal, headers });
    state("live");
    const reader = response.body.pipeThrough(new TextDecoderStream()).getReader();
    for (let rest = ""; ;) {
      const { value, done } = await reader.read();
      if (done) return;
      const blocks = (rest + value).split("\n\n");
      rest = blocks.pop();
      for (const block of blocks) {
        const data = block.split("\n").filter((line) => line.startsWith("data:")).map((line) => line.slice(5)).join("\n");
        if (!data) continue;
        const told = JSON.parse(data);
        last = told.seq;
        event(told);
      }
    }
  };
  (async () => {
    while (!stopped.signal.aborted) {
      await read().catch(() => {});
      state("away");
      await new Promise((resume) => { setTimeout(resume, RETRY_MS); });
    }
  })();
  return { stop() { stopped.abort(); } };
}
