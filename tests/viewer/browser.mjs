// Browser: servers of their own and pages in a real browser, for the stories.

import assert from "node:assert/strict";
import { spawn } from "node:child_process";
import { mkdtempSync, readFileSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { createInterface } from "node:readline";
import { chromium } from "playwright-core";

const [program, executablePath = "/usr/bin/chromium"] = process.argv.slice(2);
/** A folder whose files stand in for those of the program: whoever works on the page need not build it each time. */
const { ASSETS } = process.env;
const PAGES = { "/": "viewer.html", "/docs": "docs.html" };
const KINDS = { html: "text/html", js: "text/javascript", css: "text/css", svg: "image/svg+xml" };
/** Servers that run: whatever becomes of a story, none is left behind. */
const servers = new Set();
const folder = mkdtempSync(join(tmpdir(), "viewer-"));

/** A server of its own, and how to ask it. */
export async function serve(name, ...options) {
  const server = spawn(program, ["serve", "--listen", "127.0.0.1:0", "--database", `sqlite://${join(folder, name)}.db`, "--log", "error", ...options],
    { stdio: ["ignore", "pipe", "inherit"] });
  servers.add(server);
  let url;
  for await (const line of createInterface({ input: server.stdout })) {
    url = line.match(/http:\/\/\S+/)?.[0].replace(/\/$/, "");
    if (url) break;
  }
  const ask = async (method, path, body) => {
    const answer = await fetch(`${url}${path}`, { method, body: JSON.stringify(body), headers: { "content-type": "application/json" } });
    assert.ok(answer.ok, `${method} ${path}: ${answer.status} ${await answer.clone().text()}`);
    return answer.json();
  };
  /** Many keyframes at once, each `{ id, body }`. */
  const send = async (map, keyframes) => {
    const body = keyframes.map(({ id, body: one }) => `${JSON.stringify({ id, ...one })}\n`).join("");
    const answer = await fetch(`${url}/v1/maps/${map}/keyframes`, { method: "POST", body, headers: { "content-type": "application/x-ndjson" } });
    assert.equal(answer.status, 200, await answer.text());
  };
  return { url, ask, send, stop: () => new Promise((gone) => { server.on("exit", gone); server.kill("SIGTERM"); }) };
}

const browser = await chromium.launch({ executablePath, args: ["--no-sandbox", "--disable-gpu"] });
/** What a page says on its console, which is nothing, but for refused requests that are part of the story. */
export const said = [];
export async function open(url, { scheme = "light", expected = /(?!)/, width = 1300, height = 850 } = {}) {
  const page = await browser.newPage({ viewport: { width, height }, colorScheme: scheme });
  page.on("console", (message) => { if (!expected.test(message.text())) said.push(message.text()); });
  page.on("pageerror", (error) => said.push(String(error)));
  if (ASSETS) await page.route(({ pathname }) => pathname in PAGES || /^\/assets\/(?!words)/.test(pathname), fromFolder);
  await page.goto(url);
  return page;
}

const policies = new Map();

/** The file of the folder, under the policy that the program gives its own. */
async function fromFolder(route) {
  const { pathname, origin } = new URL(route.request().url());
  const name = PAGES[pathname] ?? pathname.slice("/assets/".length);
  if (!policies.has(origin)) policies.set(origin, (await fetch(origin)).headers.get("content-security-policy"));
  const body = readFileSync(join(ASSETS, name));
  await route.fulfill({ body, headers: { "content-type": KINDS[name.split(".").pop()], "content-security-policy": policies.get(origin) } });
}

/** The boxes of the texts on the canvas, drawn once more after an act. */
export async function labels(page, act = () => {}) {
  await act();
  return page.evaluate(() => new Promise((resolve) => {
    document.getElementById("canvas").addEventListener("drawn", ({ detail }) => resolve(detail.labels), { once: true });
    for (let times = 0; times < 2; times += 1) document.getElementById("labels").click();
  }));
}

/** Leaves nothing behind. */
export async function finish() {
  for (const server of servers) server.kill("SIGKILL");
  await browser.close();
  rmSync(folder, { recursive: true, force: true });
}
