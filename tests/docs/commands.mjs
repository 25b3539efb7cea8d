// Prints each "Try it" of /docs as a line of JSON, in the page's order, made by the page's own scripts.
// node commands.mjs FOLDER BASE KEYED < openapi.json, where FOLDER holds the scripts as the server serves them.

import { readFileSync } from "node:fs";
import { pathToFileURL } from "node:url";

const [folder, base, keyed] = process.argv.slice(2);
const served = (name) => import(pathToFileURL(`${folder}/${name}`));
const { Commands, grouped } = await served("docs_try.js");
const { Schemas } = await served("docs_schema.js");
const { calls } = await served("docs_start.js");

const api = JSON.parse(readFileSync(0, "utf8"));
for (const { id, text } of calls({ base, keyed: keyed === "true" })) console.log(JSON.stringify({ id, text }));
const commands = new Commands(api, new Schemas(api), { base, keyed: keyed === "true" });
for (const { operations } of grouped(api)) {
  for (const { id } of operations) console.log(JSON.stringify({ id, ...commands.of(id) }));
}
