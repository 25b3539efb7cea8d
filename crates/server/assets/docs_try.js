// Try: each operation as commands for a shell. In the page's order they work on a fresh server; a test runs them.

import { pretty } from "./docs_prose.js";

const METHODS = ["put", "post", "get", "patch", "delete"];
/** The variable that holds the key's secret. */
const KEY = "REVISIT_KEY";
/** The tag of the operations that make and need keys. */
const KEYS = "keys";

/** What the examples of the document speak of. */
const SAMPLES = { map: "tower", keyframe: "kf-120", anchor: "a-1", loop: "loop-1", release: "2026-11", erasure: "e-1", id: "key-2", query: "$QUERY" };
/** What is deleted is made for it, so that the rest of the page still finds what it speaks of. */
const OWN_SAMPLES = {
  delete_map: { map: "annex" },
  delete_backup: { id: "before-the-upgrade" },
  delete_keyframe: { keyframe: "kf-121" },
  delete_release: { release: "2026-10" },
  get_changes: { since: "2026-11" },
  // A client names what a plan shows; `a-1` is a name that the server gives.
  put_prior_anchor: { anchor: "plan-901" },
  delete_anchor: { anchor: "plan-901" },
  merge_sessions: { session: "robot-9" },
  revoke_merge: { session: "robot-8" },
  get_judgement: { id: "prompts-2" },
  stop_judgement: { id: "prompts-2" },
};
/** A robot's keyframe in a session of its own, which can merge. */
const driven = (session) => ({
  operation: "put_keyframe", samples: { keyframe: `${session}-1` }, body: (operations) => ({ ...smallest(operations), session }),
});
const judged = [{ operation: "judge_again", body: { id: "prompts-2", asks: "texts" } }];

/** What has to be there first: operations with bodies of their own. `keep` names the variable that keeps a member of the answer. */
const BEFORE = {
  delete_map: [{ operation: "put_map", samples: { map: "annex" }, body: {} }],
  delete_keyframe: [{ operation: "put_keyframe", samples: { keyframe: "kf-121" }, body: smallest }],
  delete_release: [{ operation: "publish_release", samples: { release: "2026-10" }, body: {} }],
  merge_sessions: [driven("robot-9")],
  revoke_merge: [driven("robot-8"), { operation: "merge_sessions", samples: { session: "robot-8" } }],
  get_judgement: judged,
  stop_judgement: judged,
  get_loop_query: [{ operation: "query_loop", body: { keyframe: "kf-120" }, keep: { QUERY: "id" } }],
  revoke_key: [{ operation: "create_key", body: { name: "robots", actions: ["read", "write", "query"], maps: ["tower*"] } }],
};

/** What a reader must know. `status` is what a server answers that was started without options, where it is no success. */
const NOTES = {
  take_backup: { text: "Needs a server that was started with `--backups FOLDER`; any other answers 409.", status: 409 },
  delete_backup: { text: "A server without `--backups FOLDER` has none and answers 404.", status: 404 },
  listen: { text: "The stream goes on until you stop it (Ctrl-C)." },
  create_key: {
    text: `Keep the secret of the answer: \`export ${KEY}=revisit_…\`. The commands below send it, and those above need it from now on.`,
  },
};

function smallest({ put_keyframe: { body } }) {
  const { session, stamp, pose } = body.example;
  return { session, stamp, pose };
}

/** The operations by tag, in the page's order: the document's, with what deletes at the end of its tag. */
export function grouped(api) {
  const operations = Object.entries(api.paths).flatMap(([path, item]) => METHODS.filter((method) => item[method])
    .map((method) => ({ ...item[method], path, method, id: item[method].operationId, tag: item[method].tags?.[0] ?? "other" })));
  const tags = [...(api.tags ?? [])];
  for (const { tag } of operations) if (!tags.some(({ name }) => name === tag)) tags.push({ name: tag, description: "" });
  const ends = ({ method }) => (method === "delete" ? 1 : 0);
  const starts = ({ method, path }) => (method === "put" && !path.includes("keyframes") ? 0 : 1);
  return tags.map(({ name, description }) => ({
    name, description,
    operations: operations.filter(({ tag }) => tag === name).sort((a, b) => ends(a) - ends(b) || starts(a) - starts(b)),
  })).filter((group) => group.operations.length > 0);
}

/** Makes commands. `base` is the server's address with a slash at its end; `keyed` if it wants a key already. */
export class Commands {
  constructor(api, schemas, { base, keyed = false }) {
    Object.assign(this, { schemas, base, keyed });
    this.operations = Object.fromEntries(grouped(api).flatMap(({ operations }) => operations).map((operation) => {
      const [type, body] = Object.entries(operation.requestBody?.content ?? {})[0] ?? [];
      return [operation.id, { ...operation, type, body }];
    }));
  }

  /**
   * The commands of an operation, the requests that they make, what to know about them, and the status that a plain server answers
   * where it is a refusal.
   */
  of(id) {
    const before = (BEFORE[id] ?? []).map(({ operation, samples, body, keep }) =>
      this.request(operation, samples, typeof body === "function" ? body(this.operations) : body, keep));
    const steps = [...before, this.request(id)];
    return { text: steps.map(curl).join("\n"), steps, note: NOTES[id]?.text ?? null, status: NOTES[id]?.status ?? null };
  }

  /** A request: `url` may hold variables, `$NAME`, which earlier answers fill (`keep`). `types` are those of its answers. */
  request(id, samples = OWN_SAMPLES[id], sent = undefined, keep = null) {
    const { method, path, tag, security, parameters: given = [], responses, type, body } = this.operations[id];
    const value = ({ name, example: sample, schema }) =>
      samples?.[name] ?? sample ?? schema?.example ?? SAMPLES[name] ?? name;
    const inPath = (name) => given.find((one) => one.name === name && one.in === "path") ?? { name };
    const encoded = (text) => (text.startsWith("$") ? text : encodeURIComponent(text));
    const filled = path.replace(/\{(\w+)\}/g, (_, name) => encoded(value(inPath(name))));
    const asked = given.filter((one) => one.in === "query" && (one.required || one.example !== undefined) && one.schema?.default === undefined);
    const query = asked.map((one) => `${one.name}=${encodeURIComponent(value(one))}`).join("&");
    const headers = given.filter((one) => one.in === "header" && one.required).map((one) => [one.name, value(one)]);
    if (body) headers.push(["content-type", type]);
    const needsKey = (security ?? []).some((one) => Object.keys(one).length > 0);
    // The first key cannot be asked for with a key, and is there afterwards.
    const isFirstKey = id === "create_key" && sent === undefined;
    return {
      id, method: method.toUpperCase(), url: this.base + filled.slice(1) + (query && `?${query}`), headers, keep,
      isKeyed: needsKey && (this.keyed || (tag === KEYS && !isFirstKey)),
      body: body ? this.bodyOf(sent ?? body.example ?? {}, body.schema) : null,
      types: Object.values(responses).flatMap(({ content }) => Object.keys(content ?? {})),
    };
  }

  /** A text is sent as it stands, JSON in the order of its schema. */
  bodyOf(sample, schema) {
    const ordered = typeof sample === "string" ? sample.trimEnd() : this.schemas.ordered(sample, schema);
    return typeof ordered === "string" ? { text: ordered, isText: true } : { text: pretty(ordered, "  "), isText: false };
  }
}

function curl({ method, url, headers, isKeyed, body, types, keep }) {
  const parts = ["curl"];
  if (keep) parts.push("-s");
  if (types.includes("text/event-stream")) parts.push("-N");
  if (types.some((kind) => kind.startsWith("image/"))) parts.push("-O");
  if (method !== "GET") parts.push(`-X ${method}`);
  parts.push(quoted(url));
  const lines = [parts.join(" ")];
  if (isKeyed) lines.push(`-H "authorization: Bearer $${KEY}"`);
  for (const [name, text] of headers) lines.push(`-H ${name === "content-type" ? `'${name}: ${text}'` : quoted(`${name}: ${text}`)}`);
  if (body) lines.push(`${body.isText ? "--data-binary" : "-d"} ${quoted(body.text)}`);
  return kept(lines.join(" \\\n  "), keep);
}

/** A command whose answer's member is kept in a variable. */
function kept(command, keep) {
  if (!keep) return command;
  const [[variable, member]] = Object.entries(keep);
  return `${variable}=$(${command} | sed -n 's/^{"${member}":"\\([^"]*\\)".*/\\1/p')`;
}

function quoted(text) {
  return /^[\w:/.,@$-]+$/.test(text) ? text : `'${text.replaceAll("'", "'\\''")}'`;
}
