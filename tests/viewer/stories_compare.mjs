// Comparing: the query and a candidate side by side.

import assert from "node:assert/strict";
import { open, serve } from "./browser.mjs";
import { drive, tower } from "./world.mjs";

const MISREAD = "robot-2-1";

/** Asks about a keyframe on the page, and opens a candidate's comparison. */
async function compared(page, candidate) {
  await page.click("text=Is it a loop?");
  await page.waitForSelector(".candidates");
  const card = page.locator(".candidate", { has: page.locator(`summary code:text-is("${candidate}")`) });
  if ((await card.getAttribute("open")) === null) await card.locator("summary").click();
  await card.locator("text=Compare side by side").click();
  await page.waitForSelector("dialog[open] svg.views");
}

const ask = (server, keyframe) => server.ask("POST", "/v1/maps/tower/loop-queries", { keyframe });

export const comparing = {
  async "a loop is compared: two views, a number and a colour for each pair, the limits, and both pictures"() {
    const server = await tower(await serve("compare"));
    const page = await open(`${server.url}/?map=tower&keyframe=${MISREAD}`);
    await compared(page, "robot-1-1");
    const { candidates } = await ask(server, MISREAD);
    const { anchors } = candidates.find(({ keyframe }) => keyframe === "robot-1-1");
    assert.ok(anchors.matches.length > 3 && anchors.contradictions.length === 1);
    // Each pair stands in both views, with one colour.
    const marks = await page.$$eval("svg.views [data-pair]", (all) => all.map((mark) => ({
      pair: mark.dataset.pair, kind: mark.dataset.kind, colour: mark.querySelector("circle").getAttribute("fill"),
    })));
    const agreeing = marks.filter(({ kind }) => kind === "agrees");
    assert.equal(agreeing.length, 2 * anchors.matches.length);
    for (const { pair, colour } of marks) assert.equal(marks.filter((one) => one.pair === pair && one.colour === colour).length, 2, `pair ${pair}`);
    // What contradicts is told first.
    const rows = await page.locator("dialog .compared > li").allTextContents();
    assert.match(rows[0], /contradicts.*930.*903/s);
    assert.match(rows[1], /agrees.*0° of 60°.*0 m of 1 m/s);
    assert.equal(await page.locator("dialog .compared > li").nth(1).locator(".crop canvas").count(), 2);
    assert.match(await page.textContent("dialog .figures-of"), /confidence.*0\.99 needed.*geometrydid not run/s);
    await page.keyboard.press("Escape");
    assert.equal(await page.locator("dialog[open]").count(), 0);
    // The keyboard is back where it was.
    assert.equal(await page.evaluate(() => document.activeElement.textContent), "Compare side by side");
    await page.close();
    await server.stop();
  },

  async "a rejected candidate is compared: contradictions are red, and what failed says by how much"() {
    const server = await tower(await serve("rejected"));
    for (const scheme of ["light", "dark"]) {
      const page = await open(`${server.url}/?map=tower&keyframe=${MISREAD}`, { scheme });
      await compared(page, "robot-1-3");
      const { red, marks } = await page.evaluate(() => ({
        red: getComputedStyle(document.documentElement).getPropertyValue("--bad").trim(),
        marks: [...document.querySelectorAll("svg.views [data-kind=contradicts] circle")].map((mark) => mark.getAttribute("fill")),
      }));
      assert.ok(marks.length >= 2 && marks.every((colour) => colour === red), `${marks} are ${red}`);
      assert.match(await page.textContent("dialog .figures-of .gauge.off"), /confidence✕ 0[.\d]*, 0\.99 needed/s);
      assert.match(await page.locator("dialog li.contradicts").first().textContent(), /reads 901 where 903 hung.*901.*903/s);
      // Something stands too far off to be one pair, and by how much is said.
      assert.match(await page.locator("dialog .compared .gauge.off").first().textContent(), /distance apart✕ [\d.]+ m of 1 m/);
      // Without pictures the signs' texts stand side by side.
      await page.keyboard.press("Escape");
      await compared(page, "robot-3-1");
      assert.deepEqual(await page.locator("dialog li.contradicts").first().locator(".plate-text").allTextContents(), ["902", "802"]);
      assert.equal(await page.locator("dialog li.contradicts").first().locator(".crop").count(), 1);
      await page.close();
    }
    await server.stop();
  },

  async "the inliers of geometry stand against what was needed"() {
    const server = await serve("inliers");
    const page = await open(`${server.url}/`);
    const figures = (geometry, reason, settings) => page.evaluate(async ([one, two, three]) => {
      const { checksInFigures } = await import(new URL("assets/viewer_gauges.js", document.baseURI).href);
      const shown = checksInFigures({ bow: { score: 0.2, reference_score: 0.3 }, geometry: one, reason: two }, three);
      return [...shown.children].map((row) => `${row.className}: ${[...row.children].map(({ textContent }) => textContent).join(" ").trim()}`);
    }, [geometry, reason, settings]);
    const [counted, significant] = ["count", "significance"].map((how) =>
      ({ geometry_acceptance: how, geometry_min_inliers: 20, candidates_min_score_ratio: 0.8 }));
    // The reason's own limit comes first, then the map's way to accept.
    const few = { code: "too_few_inliers", measured: 12, limit: 31 };
    assert.deepEqual(await figures({ status: "failed", inliers: 12, log10_false_alarms: -3 }, few, significant),
      ["gauge off: looks alike ✕ 0.2, 0.24 needed", "gauge: anchors, S not reached", "gauge off: inliers ✕ 12, 31 needed"]);
    assert.equal((await figures({ status: "verified", inliers: 143, log10_false_alarms: -80 }, undefined, significant)).at(-1),
      "gauge: 143 inliers by chance less than once in a million");
    assert.equal((await figures({ status: "failed", inliers: 12, log10_false_alarms: -3 }, undefined, significant)).at(-1),
      "gauge off: 12 inliers ✕ by chance once in 1,000; less than once in a million needed");
    assert.equal((await figures({ status: "verified", inliers: 25, log10_false_alarms: -8 }, undefined, counted)).at(-1), "gauge: inliers 25, 20 needed");
    assert.equal((await figures({ status: "skipped", reason: "no camera" }, undefined, counted)).at(-1), "gauge: geometry did not run: no camera");
    await page.close();
    await server.stop();
  },

  async "a query that was sent along and not stored shows what there is"() {
    const server = await tower(await serve("inline"));
    const { id, body } = drive("robot-9", { steps: 2, reads: (index) => String(901 + index) })[1];
    const answer = await server.ask("POST", "/v1/maps/tower/loop-queries", { inline: { ...body, covisible: [] } });
    assert.equal(answer.keyframe, undefined, id);
    await server.ask("POST", "/v1/maps/tower/loops", { id: "loop-1", keyframe: "robot-2-1", candidate: "robot-1-1", query: answer.id });
    const page = await open(`${server.url}/?map=tower`);
    await page.waitForSelector("#live[data-state=live]");
    await page.click("#tab-loops");
    await page.click("#loops >> text=why");
    assert.match(await page.locator("#details:has(.candidates)").textContent(), /a keyframe that is not stored/);
    await page.click("#details .compare-it >> nth=0");
    await page.waitForSelector("dialog[open] svg.views");
    assert.match(await page.textContent("dialog svg.views"), /and not stored/);
    assert.match(await page.locator("dialog .compared > li").first().textContent(), /agrees/);
    await page.close();
    await server.stop();
  },

  async "a session is asked why its keyframes are no loops, near misses first, and each answer can be read"() {
    const server = await tower(await serve("sweep"));
    const page = await open(`${server.url}/?map=tower`);
    await page.waitForSelector("#live[data-state=live]");
    await page.click("#tab-loops");
    await page.selectOption("#sweep [aria-label='Session to ask about']", "robot-3");
    await page.click("text=Ask about them");
    await page.waitForFunction(() => /^7 of 7 keyframes asked about/.test(document.querySelector("#sweep [role=status]").textContent)
      && document.querySelector("#sweep li"));
    const verdicts = await Promise.all(Array.from({ length: 7 }, (_, step) => ask(server, `robot-3-${step}`)));
    const stopped = verdicts.filter(({ verdict }) => verdict !== "loop");
    assert.ok(stopped.length > 0);
    assert.equal(await page.locator("#sweep li").count(), stopped.length);
    const [, code] = await page.$$eval("#sweep [aria-label=Reason] option", (options) => options.map(({ value }) => value));
    await page.selectOption("#sweep [aria-label=Reason]", code);
    const few = await page.locator("#sweep li").count();
    assert.ok(few > 0 && few <= stopped.length);
    await page.locator("#sweep li >> text=why").first().click();
    await page.waitForSelector("#details h2:has-text('Loop query')");
    // The sum by which the first candidate is none, each term with its bar.
    const sum = page.locator("#details .check:has(h4:has-text('Sum of the evidence'))").first();
    assert.match(await sum.textContent(), /evidence[\d.]+ %/);
    const weights = await sum.locator(".odds .figure").allTextContents();
    assert.ok(weights.length > 0 && weights.every((weight) => /^[+-]?\d/.test(weight.replace("−", "-"))), `${weights}`);
    await page.close();
    await server.stop();
  },

  async "candidates are chosen by the reason that stopped them"() {
    const server = await tower(await serve("why-not"));
    await server.send("tower", drive("robot-4", { reads: (index) => String(701 + index), begins: 4000 }));
    const page = await open(`${server.url}/?map=tower&keyframe=${MISREAD}`);
    await page.click("text=Is it a loop?");
    await page.waitForSelector(".why-not select");
    const { candidates } = await ask(server, MISREAD);
    const stopped = candidates.filter(({ reason }) => reason?.code === "contradiction");
    await page.selectOption(".why-not select", "contradiction");
    const shown = await page.$$eval(".candidates > li:not([hidden]) summary code", (all) => all.map(({ textContent }) => textContent));
    assert.deepEqual(shown.toSorted(), stopped.map(({ keyframe }) => keyframe).toSorted());
    // Near misses first.
    const miss = ({ keyframe }) => {
      const { measured, limit } = candidates.find((one) => one.keyframe === keyframe).reason;
      return Math.abs(measured - limit) / Math.max(Math.abs(measured), Math.abs(limit));
    };
    const misses = shown.map((keyframe) => miss({ keyframe }));
    assert.deepEqual(misses, misses.toSorted((a, b) => a - b));
    await page.selectOption(".why-not select", "");
    assert.equal(await page.locator(".candidates > li:not([hidden])").count(), candidates.length);
    await page.close();
    await server.stop();
  },
};
