// Releases: a map that goes on after it was published; and what other clients write appears by itself.

import assert from "node:assert/strict";
import { open, serve } from "./browser.mjs";

const BURST = 3000;

/** Keyframes in a row, without signs. */
function row(count, begins = 0) {
  return Array.from({ length: count }, (_, index) => ({
    id: `kf-${begins + index}`,
    body: {
      session: "robot-1", stamp: { sec: begins + index, nanosec: 0 },
      pose: { translation: { x: (begins + index) * 0.5, y: 0, z: 0 }, rotation: { x: 0, y: 0, z: 0, w: 1 } },
    },
  }));
}

const figures = (page, words) => page.waitForFunction((wanted) => document.getElementById("figures").textContent.includes(wanted), words, { timeout: 20_000 });

export const following = {
  async "keyframes that other clients store, correct and remove appear by themselves, and a burst is read once or twice"() {
    const server = await serve("follow");
    await server.ask("PUT", "/v1/maps/m", {});
    const page = await open(`${server.url}/?map=m`);
    await page.waitForSelector("#live[data-state=live]");
    let readings = 0;
    let looks = 0;
    page.on("request", (request) => {
      if (request.url().endsWith("/v1/maps/m/frames")) readings += 1;
      if (request.url().endsWith("/v1/maps/m")) looks += 1;
    });
    // A map that was empty, and one that was not.
    for (const [index, words] of ["1 keyframe", "2 keyframes"].entries()) {
      const [{ id, body }] = row(1, index);
      await server.ask("PUT", `/v1/maps/m/keyframes/${id}`, body);
      await figures(page, words);
    }
    await page.click("#tab-keyframes");
    assert.deepEqual(await page.locator("#keyframes .ref").allTextContents(), ["kf-0", "kf-1"]);
    await page.click("#keyframes .ref >> text=kf-1");
    await page.waitForSelector("#details >> text=0.5, 0, 0 m");
    const moved = { translation: { x: 7.25, y: 0, z: 0 }, rotation: { x: 0, y: 0, z: 0, w: 1 } };
    await server.ask("POST", "/v1/maps/m/poses", { session: "robot-1", keyframes: { ids: ["kf-1"], poses: [moved] } });
    await page.click("#tab-events");
    await page.waitForSelector("#events >> text=The client of robot-1 corrected poses: 1 keyframe");
    await page.waitForFunction(() => document.getElementById("figures").textContent.includes("version 4"));
    await page.click("#tab-keyframes");
    await page.click("#keyframes .ref >> text=kf-1");
    await page.waitForSelector("#details >> text=7.25, 0, 0 m");
    assert.equal((await fetch(`${server.url}/v1/maps/m/keyframes/kf-0`, { method: "DELETE" })).ok, true);
    await figures(page, "1 keyframe");
    const before = readings;
    await server.send("m", row(BURST, 10));
    await figures(page, "3,001 keyframes");
    await page.waitForTimeout(1500);
    assert.ok(readings - before <= 3, `${readings - before} readings of a burst of ${BURST}`);
    // Each reading reads the map itself; nobody asks for it in between.
    assert.equal(looks, readings, "no polling while events come");
    await page.click("#tab-events");
    const lines = await page.locator("#events li > div").allTextContents();
    assert.match(lines[0], /^3,000 keyframes of robot-1 stored, the last kf-3009$/);
    assert.match(lines[1], /^Keyframe kf-0 removed$/);
    assert.match(lines[3], /^2 keyframes of robot-1 stored, the last kf-1$/);
    await page.close();
    await server.stop();
  },
};
