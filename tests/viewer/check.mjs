// The viewer in a real browser: what a mapper does, and what must not happen. Takes the server's program and, if it is not
// /usr/bin/chromium, the browser's; further words choose the stories whose names hold them. Figures of speed are printed, and judge nothing.

import assert from "node:assert/strict";
import { finish, said } from "./browser.mjs";
import { comparing } from "./stories_compare.mjs";
import { daily } from "./stories_daily.mjs";
import { docs } from "./stories_docs.mjs";
import { layout } from "./stories_layout.mjs";
import { map } from "./stories_map.mjs";
import { reaching } from "./stories_reach.mjs";
import { following, releasing } from "./stories_releases.mjs";
import { verdicts } from "./stories_verdicts.mjs";

const [, , ...chosen] = process.argv.slice(2);
const stories = Object.entries({ ...daily, ...comparing, ...map, ...layout, ...reaching, ...following, ...releasing, ...verdicts, ...docs });

try {
  for (const [name, story] of stories.filter(([name]) => chosen.length === 0 || chosen.some((word) => name.includes(word)))) {
    try {
      await story();
    } catch (error) {
      error.message = `${name}: ${error.message}`;
      throw error;
    }
    assert.deepEqual(said, [], `${name}: the console says nothing`);
    console.log(`ok ${name}`);
  }
} finally {
  await finish();
}
