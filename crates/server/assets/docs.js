// Docs: the API document as a page to read.

import { problems } from "./docs_problems.js";
import { inline, pretty, prose } from "./docs_prose.js";
import { runnable } from "./docs_run.js";
import { Schemas, parameters } from "./docs_schema.js";
import { calls } from "./docs_start.js";
import { Commands, grouped } from "./docs_try.js";
import { copyable, debounced, el, fill } from "./dom.js";

const at = (id) => document.getElementById(id);

async function start() {
  try {
    const answer = await fetch("openapi.json");
    if (!answer.ok) throw new Error(`HTTP ${answer.status}`);
    render(await answer.json(), await wantsKey());
  } catch (error) {
    fill(at("reference"), el("p", { class: "fault", role: "alert" }, `openapi.json cannot be read: ${error.message}`));
  }
}

/** Does the server want a key? Then each command sends one. */
async function wantsKey() {
  const answer = await fetch("v1/maps?limit=1").catch(() => null);
  return answer?.status === 401;
}

function render(api, keyed) {
  const schemas = new Schemas(api);
  const server = { base: new URL(".", document.baseURI).href, keyed };
  const commands = new Commands(api, schemas, server);
  const steps = calls(server);
  fill(at("calls"), steps.map(({ id, title, about, text, steps: requests }, number) => el("section", { id, class: "call" },
    el("h3", {}, el("a", { href: `#${id}`, class: "self" }, `${number + 1}. ${title}`)), el("p", {}, inline(about)), runnable(text, requests))));
  const groups = grouped(api);
  fill(at("reference"),
    el("section", { class: "intro" }, prose(api.info.description),
      el("p", { class: "muted" }, `Version ${api.info.version}, ${api.info.license?.name ?? ""}`)),
    groups.map(({ name, description, operations }) => el("section", { id: `tag-${name}`, class: "tag" },
      el("h2", {}, el("a", { href: `#tag-${name}`, class: "self" }, name)), prose(description),
      operations.map((operation) => article(operation, api, schemas, commands)))),
    problems(api, schemas));
  const start = [...steps.map(({ id, title }) => [id, title]), ["frames", "Frames and units"], ["glossary", "Glossary"]];
  fill(at("contents"), el("section", {}, el("h2", {}, el("a", { href: "#start" }, "start")),
    el("ul", {}, start.map(([id, title]) => el("li", { "data-for": "start" }, el("a", { href: `#${id}`, class: "plain" }, title))))),
  groups.map(({ name, operations }) => el("section", {},
    el("h2", {}, el("a", { href: `#tag-${name}` }, name)),
    el("ul", {}, operations.map(({ id, method, summary }) => el("li", { "data-for": id },
      el("a", { href: `#${id}` }, el("span", { class: `method ${method}` }, method), el("span", {}, summary))))))),
  el("section", {}, el("h2", { "data-for": "problems" }, el("a", { href: "#problems" }, "problems"))));
  at("filter").addEventListener("input", debounced(filter, 80));
  addEventListener("hashchange", reach);
  foldMenu();
  reach();
}

/** On a narrow screen the contents are a menu: closed, and closed again by the choice of an entry. */
function foldMenu() {
  const narrow = matchMedia("(max-width: 52rem)");
  const fold = () => { at("menu").open = !narrow.matches; };
  narrow.addEventListener("change", fold);
  at("contents").addEventListener("click", ({ target }) => {
    if (target.closest("a")) fold();
  });
  fold();
}

function article(operation, api, schemas, commands) {
  const { id, method, path, summary, description, parameters: given = [], requestBody } = operation;
  const [type, body] = Object.entries(requestBody?.content ?? {})[0] ?? [];
  const { text, steps, note } = commands.of(id);
  return el("article", { id, class: "operation", "data-words": words(operation, schemas) },
    el("h3", {}, el("a", { href: `#${id}`, class: "self" }, summary)),
    el("p", { class: "address" }, el("span", { class: `method ${method}` }, method), " ", el("code", {}, route(path))),
    prose(description),
    el("h4", {}, "Try it"), runnable(text, steps), note && el("p", { class: "muted" }, inline(note)),
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
  for (const opening of [at("start"), document.querySelector(".intro")]) opening.hidden = wanted.length > 0;
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
