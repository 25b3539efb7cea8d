// Verdicts: the list of what robots asked and were answered.

import assert from "node:assert/strict";
import { open, serve } from "./browser.mjs";
import { tower } from "./world.mjs";

const MAP = "/v1/maps/tower";

/** The list is written behind: waits until it has so many lines. */
async function listed(server, many) {
  for (let items = []; items.length < many; { items } = await server.ask("GET", `${MAP}/loop-queries?limit=1000`));
}

/** The tab, once it was read. */
async function verdictsOf(page) {
  await page.click("#tab-verdicts");
  await page.waitForSelector("#verdicts li");
}

export const verdicts = {
  async "verdicts are listed with why, rejections first, and lead to the keyframe and the whole answer"() {
    const server = await tower(await serve("verdicts"));
    const answers = [];
    for (const robot of ["robot-2", "robot-3"]) {
      for (let step = 0; step < 7; step += 1) answers.push(await server.ask("POST", `${MAP}/loop-queries`, { keyframe: `${robot}-${step}` }));
    }
    await listed(server, answers.length);
    const of = (verdict) => answers.filter((answer) => answer.verdict === verdict);
    assert.ok(of("no_loop").length > 0 && of("loop").length > 0);
    // A return that is closed already is no rejection.
    const found = of("loop")[0];
    await server.ask("POST", `${MAP}/loops`, { id: "loop-1", keyframe: found.keyframe, candidate: found.best, query: found.id });
    const again = await server.ask("POST", `${MAP}/loop-queries`, { keyframe: found.keyframe });
    assert.equal(again.reason?.code, "already_closed");
    await listed(server, answers.length + 1);
    for (const width of [390, 1280, 1920]) {
      const page = await open(`${server.url}/?map=tower`, { width });
      await page.waitForSelector("#live[data-state=live]");
      await verdictsOf(page);
      const lines = () => page.locator("#verdicts li").allTextContents();
      assert.equal((await lines()).length, of("no_loop").length);
      const last = of("no_loop").at(-1);
      // The newest first: its time, its keyframe, the verdict and why.
      const [first] = await lines();
      assert.match(first, /^20\d\d-\d\d-\d\d \d\d:\d\d:\d\d UTC/);
      assert.ok(first.includes(last.keyframe) && first.includes("no loop") && first.includes(last.why), first);
      await page.selectOption("[aria-label=Verdict]", "loop");
      await page.waitForFunction((many) => document.querySelectorAll("#verdicts li").length === many, of("loop").length);
      await page.selectOption("[aria-label=Verdict]", "closed already");
      await page.waitForFunction(() => document.querySelectorAll("#verdicts li").length === 1);
      await page.selectOption("[aria-label=Verdict]", "every verdict");
      await page.selectOption("#verdicts [aria-label=Session]", "robot-3");
      await page.waitForFunction(() => document.querySelectorAll("#verdicts li").length === 7);
      await page.selectOption("#verdicts [aria-label=Session]", "");
      await page.selectOption("[aria-label=Verdict]", "loop");
      await page.waitForFunction((many) => document.querySelectorAll("#verdicts li").length === many, of("loop").length);
      await page.click("#verdicts li >> nth=0");
      await page.waitForSelector("#details .verdict h3 >> text=Yes, it is a loop");
      const { keyframe } = of("loop").at(-1);
      assert.ok(page.url().includes(`keyframe=${keyframe}`), page.url());
      assert.ok((await page.textContent("#details")).includes(`Asked about ${keyframe}`));
      await page.waitForSelector("#details >> text=Confirm the loop");
      assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth));
      await page.close();
    }
    await server.stop();
  },

  async "without a verdict, and of an answer that is no longer recorded, the page says so"() {
    const server = await tower(await serve("no-verdicts"));
    const page = await open(`${server.url}/?map=tower`);
    await page.waitForSelector("#live[data-state=live]");
    await page.click("#tab-verdicts");
    await page.waitForSelector("#verdicts .hint >> text=No loop query has been answered so.");
    const line = {
      query: "q-1", time: { sec: 1_795_842_000, nanosec: 0 }, keyframe: "robot-2-1", session: "robot-2", candidate: "robot-1-3", map_version: 1,
      verdict: "no_loop", reason: "contradiction", why: "Here it reads 930; at the same spot there it reads 903.", is_whole: false,
    };
    await page.route(/loop-queries\?/, (route) => route.fulfill({ json: { items: [line], next_cursor: null } }));
    await page.click("text=Read again");
    await page.click("#verdicts li");
    await page.waitForSelector("#details >> text=The whole answer is no longer recorded.");
    assert.match(await page.textContent("#details"), /robot-2-1 at robot-1-3 no loop.*reads 930/s);
    await page.close();
    await server.stop();
  },
};
