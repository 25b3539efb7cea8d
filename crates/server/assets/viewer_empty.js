// Empty: what to do when there is nothing to show.

import { setKey } from "./viewer_api.js";
import { copyable, el } from "./dom.js";

/** This server, as a client on this machine would name it. */
function server() {
  return new URL(".", document.baseURI).href.replace(/\/$/, "");
}

function putting(what, body) {
  return `curl -X PUT ${server()}/v1/maps/${what} \\\n  -H 'content-type: application/json' \\\n  -d '${body}'`;
}

function reference() {
  return el("a", { href: "docs" }, "The API reference");
}

/** No map at all, or none that the key covers: `covered` has the patterns of those that it would. */
export function noMaps(covered = null) {
  return el("div", { class: "empty" },
    el("h2", {}, covered ? "No map that this key covers" : "No maps yet"),
    covered && el("p", {}, "There may be others. This key covers maps named ",
      covered.map((pattern, index) => [index > 0 && ", ", el("code", {}, pattern)]), ", where * is any text."),
    el("p", {}, "A map holds the keyframes of your robots and the signs they have seen. Make one:"),
    copyable(putting("my-map", `{"description":"Ninth floor"}`)),
    el("p", {}, "or play a recording and watch it arrive here:"),
    copyable(`revisit replay FILE.ndjson.zst --server ${server()}`),
    el("p", { class: "muted" }, "This page looks again every few seconds. ", reference(), " tells the rest."));
}

/** A map without keyframes. */
export function noKeyframes(map) {
  const body = `{"session":"robot-7","stamp":{"sec":1,"nanosec":0},
       "pose":{"translation":{"x":0,"y":0,"z":0},"rotation":{"x":0,"y":0,"z":0,"w":1}},
       "detections":[{"class":"door_number","confidence":0.9,"box":[300,180,340,220],
                      "position":[0.5,0,2],"text":"901"}]}`;
  return el("div", { class: "empty" },
    el("h2", {}, "No keyframes in this map yet"),
    el("p", {}, "Send one; it appears here by itself:"),
    copyable(putting(`${encodeURIComponent(map)}/keyframes/kf-1`, body)),
    el("p", { class: "muted" }, "Only the stamp and the pose are required. ", reference(), " tells what else helps."));
}

/** A map that the address names and the server has not. */
export function noSuchMap(map) {
  return el("div", { class: "empty" }, el("h2", {}, "There is no map ", el("code", {}, map)),
    el("p", {}, "Choose another one above, or make it:"),
    copyable(putting(encodeURIComponent(map), "{}")));
}

/** The server cannot be read. */
export function unreachable(message) {
  return el("div", { class: "empty" }, el("h2", {}, "The map cannot be read"),
    el("p", { class: "fault" }, message), el("p", { class: "muted" }, "This page tries again every few seconds."));
}

/** What this server is, for somebody who comes to it without a key. */
function introduction() {
  return el("p", {}, "Revisit keeps the maps of robots and answers one question about each picture: has this place been seen before? "
    + "This page shows the maps, and why an answer was given. ", el("a", { href: "docs" }, "The API reference"), " needs no key.");
}

/** The server wants a key, or another one: `refused` is its answer to the present one. */
export function keyWanted(retry, refused = null) {
  const input = el("input", {
    type: "password", autocomplete: "off", "aria-label": "API key", required: true,
    "aria-invalid": refused ? "true" : null, "aria-describedby": refused ? "key-fault" : null,
  });
  const submit = (event) => {
    event.preventDefault();
    setKey(input.value.trim());
    retry();
  };
  // The form that was submitted is gone: the keyboard stays where somebody was typing.
  if (refused) requestAnimationFrame(() => input.focus());
  return el("div", { class: "empty" },
    el("h2", {}, "This server wants an API key"),
    introduction(),
    el("form", { class: "row", submit }, input, el("button", { type: "submit", class: "main" }, "Use it")),
    refused && el("p", { class: "fault", id: "key-fault", role: "alert" }, "This key does not open it: ", refused),
    el("p", {}, "It must be good for ", el("code", {}, "read"), ", and for ", el("code", {}, "query"),
      " to ask about loops. It is kept in this browser tab only."),
    el("p", {}, "No key at hand? On the server's machine, whoever may open its database makes one at any time, without "
      + "stopping the server:"),
    copyable("revisit keys create --name viewer --actions read,query --database sqlite://revisit.db"),
    el("p", { class: "muted" }, "Name the database that the server was started with. Every request has needed a key since the "
      + "database got its first one. If no key that may administer is left, ", el("code", {}, "--actions read,write,query,admin"),
      " makes one."));
}
