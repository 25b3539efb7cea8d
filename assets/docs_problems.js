// Problems: what each kind of refusal means, and what a client does about it. The document names the kinds; this explains them.

import { copyable, el } from "./dom.js";
import { inline, pretty } from "./docs_prose.js";

const EXPLAINED = {
  syntax: "The body could not be parsed. `errors` says where. Sending it again as it is will not help.",
  bad_request: "The path, a parameter, a header or the body's encoding is malformed.",
  unauthorized: "No API key, or one that is not known (any more). Send `authorization: Bearer <key>`.",
  forbidden: "The key is good, and may not do this.",
  not_found: "The map, keyframe, anchor, loop or query is not there; it may also lie outside what the key may see.",
  method_not_allowed: "The path is there, the method is not. The header `allow` says what it takes.",
  timeout: "The body stopped arriving. Send it again: a write by id can be repeated without harm.",
  conflict: "The id is taken by another body, or what is stored does not allow the change. `code` says which: `map_exists`, "
    + "`keyframe_exists`, `loop_exists` (another body was sent under this id before; choose another id, or read what is there), "
    + "`anchor_merged` (the anchor goes by another one's name; address that one), `first_key_must_administer` (make the "
    + "administrator's key first) or `last_admin_key` (make another one first, or say `?last_admin=true`).",
  gone: "What the request continues is not there any more: the map was deleted and made again, or the events after the named one "
    + "are too old to be kept. Read the map anew, and listen with `since=0`.",
  precondition_failed: "`if-match` named a version that is not the present one. "
    + "Read the anchor again, decide again, send the new `etag`.",
  too_large: "The body, a line or the map is beyond its limit; `detail` says which. Send less at once.",
  unsupported_media_type: "The body is neither JSON nor what this operation takes, "
    + "or is compressed in a way that is not known: gzip and zstd are.",
  invalid: "The body was read, and cannot be meant so. `errors` lists every fault at once, each with a JSON pointer into the body, "
    + "what was sent (`got`) and what would have been allowed (`limit`).",
  precondition_required: "Changing an anchor needs `if-match` with the `etag` that was seen, or `*` for whatever is there.",
  too_many_requests: "Wait for as long as `retry-after` says, then send it again.",
  internal: "A fault of the server. Its log tells more under the `request_id`.",
  unavailable: "Not now: the server starts, stops or is busy. Wait for as long as `retry-after` says, then send it again.",
  map_full: "The map holds as much as the operator allows. Reading and deleting go on; delete some of it, or ask for more.",
  disk_full: "Nothing was written. Reading and deleting go on; free some space and send it again.",
  other: "Any refusal that an operation does not list: of a proxy, of a header that is too long, or a failure of the server.",
};

const ABOUT = "Every answer of 400 and above is `application/problem+json` (RFC 9457), from whichever layer it comes. Its `type` leads "
  + "to this page, its `code` is for programs, its `detail` for people. All faults of a request are told at once.";

/** The section on refusals: the form they share, and each kind. */
export function problems(api, schemas) {
  const kinds = Object.entries(api.components?.responses ?? {}).map(([code, response]) => {
    const [media] = Object.values(response.content ?? {});
    return { code, title: response.description, status: code === "other" ? null : media?.example?.status, media };
  }).sort((a, b) => (a.status ?? 999) - (b.status ?? 999) || a.code.localeCompare(b.code));
  const schema = { $ref: "#/components/schemas/Problem" };
  return el("section", { id: "problems", class: "tag" },
    el("h2", {}, el("a", { href: "#problems", class: "self" }, "Problems")),
    el("p", {}, inline(ABOUT)),
    el("details", {}, el("summary", {}, "Its fields"), schemas.fields(schema)),
    kinds.map(({ code, title, status, media }) => el("article", { id: `problem-${code}`, class: "problem" },
      el("h3", {}, el("a", { href: `#problem-${code}`, class: "self" },
        status && el("span", { class: "status bad" }, status), " ", el("code", {}, code)), " ", title),
      el("p", {}, inline(EXPLAINED[code])),
      media?.example && code !== "other"
        && el("details", {}, el("summary", {}, "Example"), copyable(pretty(schemas.ordered(media.example, schema)))))));
}
