// Problems: the meaning of each kind of error, and what a client does about it. The document names the kinds; this explains them.

import { copyable, el } from "./dom.js";
import { inline, pretty } from "./docs_prose.js";

const EXPLAINED = {
  syntax: "The body could not be parsed. `errors` says where. Sending it again as it is will not help.",
  bad_request: "The path, a parameter, a header or the body's encoding is malformed.",
  unauthorized: "The request has no API key, or one that is unknown, expired or revoked. Send `authorization: Bearer <key>`.",
  forbidden: "The key is valid but does not have the action that this operation needs.",
  not_found: "The map, keyframe, anchor, loop or query does not exist, or is outside the maps of the key.",
  method_not_allowed: "The path exists but does not support this method. The header `allow` lists those that it supports.",
  timeout: "The body stopped arriving. Send it again: a write by id can be repeated safely.",
  conflict: "The id is taken by another body, or stored data does not allow the change. `code` says which: `map_exists`, "
    + "`keyframe_exists`, `loop_exists` (another body was sent under this id before; choose another id, or read what is there), "
    + "`anchor_merged` (the anchor goes by another one's name; address that one), `first_key_must_administer` (make the "
    + "administrator's key first) or `last_admin_key` (make another one first, or say `?last_admin=true`).",
  gone: "The map was deleted and made again, or the events after the named one are no longer kept. "
    + "Read the map again, and listen with `since=0`.",
  precondition_failed: "`if-match` named a version that is not the current one. "
    + "Read the anchor again, and repeat the change with the new `etag`.",
  too_large: "The body or a line of it exceeds its limit; `detail` says which. Send less at once.",
  unsupported_media_type: "The `content-type` is not one that this operation accepts, or the `content-encoding` is not gzip or zstd.",
  invalid: "The body is JSON, but a field is missing or has an invalid value. `errors` lists every fault, each with a JSON pointer into the body, "
    + "what was sent (`got`) and what would have been allowed (`limit`).",
  precondition_required: "Changing an anchor needs `if-match` with the `etag` that you read, or `*` for any version.",
  too_many_requests: "The key exceeds one of its limits; `detail` says which. Wait for the seconds in `retry-after`, then send the request again.",
  internal: "An error of the server. Its log has the cause under the `request_id`.",
  map_damaged: "Stored data of the map fails a check; `detail` names the row. Other maps are not affected. Restore a backup, or delete the map and send it again.",
  backup_not_verified: "The backup was made, but the check of it found faults; `detail` lists them. Do not rely on this copy; earlier backups stay.",
  unavailable: "The server is starting, stopping or overloaded. Wait for the seconds in `retry-after`, then send the request again.",
  map_full: "The map has reached the limit that the operator set. Reading and deleting still work: delete part of it, or ask for a higher limit.",
  disk_full: "Nothing was written. Reading and deleting still work. Free some space, then send the request again.",
  other: "Any error that an operation does not list: from a proxy, because of a header that is too long, or of the server.",
};

const ABOUT = "Every answer of 400 and above is `application/problem+json` (RFC 9457). Its `type` links "
  + "to this page, its `code` is for programs, its `detail` for people. `errors` lists all faults of the request.";

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
