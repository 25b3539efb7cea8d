// Docs: the API document as a page to read.

import { problems } from "./docs_problems.js";
import { inline, pretty, prose } from "./docs_prose.js";
import { Schemas, parameters } from "./docs_schema.js";
import { copyable, debounced, el, fill } from "./dom.js";

const METHODS = ["put", "post", "get", "patch", "delete"];
/** What the examples of the document speak of. */
const SAMPLES = { map: "tower", keyframe: "kf-120", anchor: "a-7", loop: "loop-1", query: "q-2f6f6d0a4c1b", id: "key-1" };

const at = (id) => document.getElementById(id);

async function start() {
  try {
    const answer = await fetch("openapi.json");
    if (!answer.ok) throw new Error(`HTTP ${answer.status}`);
    render(await answer.json());
  } catch (error) {
    fill(at("reference"), el("p", { class: "fault", role: "alert" }, `openapi.json cannot be read: ${error.message}`));
  }
}

function render(api) {
  const schemas = new Schemas(api);
  const groups = grouped(api);
  fill(at("reference"),
    el("section", { class: "intro" }, prose(api.info.description),
      el("p", { class: "muted" }, `Version ${api.info.version}, ${api.info.license?.name ?? ""}`)),
    groups.map(({ name, description, operations }) => el("section", { id: `tag-${name}`, class: "tag" },
      el("h2", {}, el("a", { href: `#tag-${name}`, class: "self" }, name)), prose(description),
      operations.map((operation) => article(operation, api, schemas)))),
    problems(api, schemas));
  fill(at("contents"), groups.map(({ name, operations }) => el("section", {},
    el("h2", {}, el("a", { href: `#tag-${name}` }, name)),
    el("ul", {}, operations.map(({ id, method, summary }) => el("li", { "data-for": id },
      el("a", { href: `#${id}` }, el("span", { class: `method ${method}` }, method), el("span", {}, summary))))))),
  el("section", {}, el("h2", { "data-for": "problems" }, el("a", { href: "#problems" }, "problems"))));
  at("filter").addEventListener("input", debounced(filter, 80));
  addEventListener("hashchange", reach);
  reach();
}

/** The operations by tag, in the document's order of tags and paths. */
function grouped(api) {
  const operations = Object.entries(api.paths).flatMap(([path, item]) => METHODS.filter((method) => item[method])
    .map((method) => ({ ...item[method], path, method, id: item[method].operationId, tag: item[method].tags?.[0] ?? "other" })));
  const tags = [...(api.tags ?? [])];
  for (const { tag } of operations) if (!tags.some(({ name }) => name === tag)) tags.push({ name: tag, description: "" });
  return tags.map(({ name, description }) => ({ name, description, operations: operations.filter(({ tag }) => tag === name) }))
    .filter((group) => group.operations.length > 0);
}

function article(operation, api, schemas) {
  const { id, method, path, summary, description, parameters: given = [], requestBody } = operation;
  const [type, body] = Object.entries(requestBody?.content ?? {})[0] ?? [];
  return el("article", { id, class: "operation", "data-words": words(operation, schemas) },
    el("h3", {}, el("a", { href: `#${id}`, class: "self" }, summary)),
    el("p", { class: "address" }, el("span", { class: `method ${method}` }, method), " ", el("code", {}, route(path))),
    prose(description),
    el("h4", {}, "Try it"), copyable(curl(operation, type, body, schemas)),
    given.length > 0 && [el("h4", {}, "Parameters"), parameters(given, schemas)],
    body && [el("h4", {}, "Body ", el("code", { class: "muted" }, type)), schemas.fields(body.schema)],
    el("h4", {}, "Answers"), answers(operation, api, schemas));
}

/** What the filter looks at: not the examples, in which everything stands. */
function words({ id, tag, method, path, summary, description, parameters: given = [], requestBody, responses }, schemas) {
  const fields = ({ schema }) => Object.keys(schemas.inside(schema).inner?.properties ?? {});
  const bodies = Object.values(requestBody?.content ?? {}).flatMap(fields);
  const names = given.map(({ name }) => name);
  return [id, tag, method, path, summary, description, ...names, ...bodies, ...Object.keys(responses)].join(" ").toLowerCase();
}

/** The path, which may break after a slash. */
function route(path) {
  return path.split(/(?=\/)/).map((part) => [part.startsWith("/{") ? el("span", { class: "variable" }, part) : part, el("wbr")]);
}

function answers({ responses }, api, schemas) {
  const entries = Object.entries(responses);
  const refused = entries.filter(([, { $ref }]) => $ref);
  const told = entries.filter(([, { $ref }]) => !$ref);
  const code = ({ $ref }) => $ref.split("/").at(-1);
  return [
    told.map(([status, response]) => answer(status, response, api, schemas, told[0][0] === status)),
    refused.length > 0 && el("p", { class: "refusals" }, "Refusals: ", refused.map(([status, response]) =>
      el("a", { href: `#problem-${code(response)}` }, status !== "default" && `${status} `, code(response).replaceAll("_", " ")))),
  ];
}

function answer(status, { description, content = {}, headers = {} }, api, schemas, first) {
  const bodies = Object.entries(content);
  const head = [el("span", { class: `status ${status < "400" ? "good" : "bad"}` }, status), " ", inline(description)];
  if (bodies.length === 0 && Object.keys(headers).length === 0) return el("p", { class: "answer" }, head);
  return el("details", { class: "answer", open: first }, el("summary", {}, head),
    Object.entries(headers).map(([name, header]) => el("p", {}, "Header ", el("code", {}, name), ": ", inline(header.description))),
    bodies.map(([type, media]) =>
      [el("p", {}, el("code", { class: "muted" }, type)), example(media, schemas), shape(type, media, api, schemas)]));
}

function example({ example: given, schema }, schemas) {
  if (given === undefined) return null;
  return copyable(typeof given === "string" ? given.trimEnd() : pretty(schemas.ordered(given, schema)));
}

function shape(type, { schema }, api, schemas) {
  if (type === "text/event-stream" && api.components.schemas.Event) {
    const fields = schemas.fields({ $ref: "#/components/schemas/Event" });
    return el("details", {}, el("summary", {}, "Fields of ", el("code", {}, "data")), fields);
  }
  if (!type.endsWith("json")) return null;
  const { inner } = schemas.inside(schema);
  return inner && el("details", {}, el("summary", {}, "Fields"), schemas.fields(schema));
}

/** One line for a shell. Values come from the document's examples. */
function curl({ method, path, parameters: given = [], responses }, type, body, schemas) {
  const value = ({ name, example: sample, schema }) => sample ?? schema?.example ?? SAMPLES[name] ?? name;
  const inPath = (name) => given.find((one) => one.name === name && one.in === "path") ?? { name };
  const filled = path.replace(/\{(\w+)\}/g, (_, name) => encodeURIComponent(value(inPath(name))));
  const asked = given.filter((one) => one.in === "query" && one.required && one.schema?.default === undefined);
  const query = asked.map((one) => `${one.name}=${encodeURIComponent(value(one))}`).join("&");
  const address = new URL(filled.slice(1), new URL(".", document.baseURI)).href + (query && `?${query}`);
  const answerTypes = Object.values(responses).flatMap(({ content }) => Object.keys(content ?? {}));
  const parts = ["curl"];
  if (answerTypes.includes("text/event-stream")) parts.push("-N");
  if (answerTypes.some((kind) => kind.startsWith("image/"))) parts.push("-O");
  if (method !== "get") parts.push(`-X ${method.toUpperCase()}`);
  parts.push(quoted(address));
  const lines = [parts.join(" ")];
  for (const one of given) if (one.in === "header" && one.required) lines.push(`-H ${quoted(`${one.name}: ${value(one)}`)}`);
  if (body) {
    lines.push(`-H 'content-type: ${type}'`);
    const sample = schemas.ordered(body.example ?? {}, body.schema);
    const oneLine = type === "application/x-ndjson";
    lines.push(oneLine ? `--data-binary ${quoted(JSON.stringify(sample))}` : `-d ${quoted(pretty(sample, "  "))}`);
  }
  return lines.join(" \\\n  ");
}

function quoted(text) {
  return /^[\w:/.,@-]+$/.test(text) ? text : `'${text.replaceAll("'", "'\\''")}'`;
}

/** Hides what does not have every word. */
function filter() {
  const wanted = at("filter").value.toLowerCase().split(/\s+/).filter(Boolean);
  const has = (element) => wanted.every((word) => (element.dataset.words ?? element.textContent.toLowerCase()).includes(word));
  for (const tag of document.querySelectorAll("#reference > .tag")) {
    const named = wanted.length > 0 && has(tag.querySelector("h2"));
    const items = [...tag.querySelectorAll(".operation, .problem")];
    for (const item of items) item.hidden = !named && !has(item);
    tag.hidden = items.every((item) => item.hidden);
  }
  document.querySelector(".intro").hidden = wanted.length > 0;
  for (const item of document.querySelectorAll("#contents [data-for]")) item.hidden = at(item.dataset.for).hidden;
  for (const section of document.querySelectorAll("#contents > section")) {
    const items = [...section.querySelectorAll("[data-for]")];
    section.hidden = items.length > 0 && items.every((item) => item.hidden);
  }
  const none = [...document.querySelectorAll("#reference > .tag")].every((tag) => tag.hidden);
  scrollTo(0, 0);
  at("none")?.remove();
  if (none) at("reference").append(el("p", { id: "none", role: "status" }, "Nothing has all of these words."));
}

/** Goes where the address points: the page did not exist yet when the browser looked. */
function reach() {
  const target = location.hash.length > 1 && at(decodeURIComponent(location.hash.slice(1)));
  if (!target) return;
  if (target.closest("[hidden]")) {
    at("filter").value = "";
    filter();
  }
  target.scrollIntoView();
  document.querySelector("[aria-current]")?.removeAttribute("aria-current");
  document.querySelector(`#contents a[href="#${CSS.escape(target.id)}"]`)?.setAttribute("aria-current", "true");
}

addEventListener("keydown", (event) => {
  const typing = event.target.matches("input");
  if (event.key === "/" && !typing) {
    event.preventDefault();
    at("filter").focus();
  } else if (event.key === "Escape" && typing) {
    at("filter").value = "";
    filter();
  }
});
start();
