// Layout: what fits, what is in view, and which texts win where there is little room, from the phone to the wide screen.

import assert from "node:assert/strict";
import { labels, open, serve } from "./browser.mjs";
import { tower } from "./world.mjs";

const SCREENS = [{ width: 390, height: 844 }, { width: 1280, height: 850 }, { width: 1920, height: 1080 }];

const NAMED = ["401", "T-1", "402", "T-2", "403", "T-3", "404", "T-4"];
const THINGS = ["lighthouse", "windmill", "dragon", "sailor", "violin", "harvest", "castle", "orchard"];
const ROWS = [-1, -0.5, -0.25, 0.25, 0.5, 1];
const SCENES = ["meadow", "river", "tower", "storm"];

/** Doors and markers in a row, and paintings close around each of them, which have more to say. */
async function gallery(server) {
  const hung = (name, text, index, dy) => ({
    class: name, confidence: 0.9, box: [10 * index, 10, 10 * index + 8, 18], text, position: [index * 2, dy, 2],
  });
  const detections = NAMED.flatMap((text, index) => [
    ...ROWS.map((dy, row) => hung("painting", `a painting of a ${THINGS[index]} and a ${SCENES[row % 4]}, rain`, index, dy)),
    hung(text.startsWith("T") ? "marker" : "door_number", text, index, 0),
  ]);
  const pose = { translation: { x: 5, y: -2, z: 2 }, rotation: { x: 0, y: 0, z: 0, w: 1 } };
  await server.ask("PUT", "/v1/maps/gallery", { code_classes: ["marker"] });
  await server.ask("PUT", "/v1/maps/gallery/keyframes/kf-1", { stamp: { sec: 1, nanosec: 0 }, pose, detections });
}

export const layout = {
  async "the tabs fit their panel on every screen, however much there is to count"() {
    const server = await tower(await serve("tabs"));
    for (const screen of SCREENS) {
      const page = await open(`${server.url}/?map=tower`, screen);
      await page.waitForSelector("#live[data-state=live]");
      const { wide, tabs, panel } = await page.evaluate(() => {
        document.getElementById("tab-events").textContent = "Events 999.9K";
        document.getElementById("tab-loops").textContent = "Loops 999.9K";
        const box = (one) => { const { left, right, top } = one.getBoundingClientRect(); return { left, right, top }; };
        const all = [...document.querySelectorAll("[role=tab]")];
        return {
          wide: document.documentElement.scrollWidth, panel: box(document.querySelector("aside")),
          tabs: all.map((tab) => ({ name: tab.textContent, ...box(tab), clipped: tab.scrollWidth > tab.clientWidth })),
        };
      });
      assert.ok(wide <= screen.width, `${wide} of ${screen.width} pixels`);
      for (const { name, left, right, clipped } of tabs) {
        assert.ok(!clipped && left >= panel.left && right <= panel.right, `${name} at ${screen.width} pixels`);
      }
      assert.ok(new Set(tabs.map(({ top }) => top)).size <= 2, `${screen.width}: ${JSON.stringify(tabs)}`);
      await page.close();
    }
    await server.stop();
  },

  async "on a phone a tap brings what was tapped into view beside the map, and a tab its panel"() {
    const server = await tower(await serve("tap"));
    const page = await open(`${server.url}/?map=tower`, SCREENS[0]);
    await page.waitForSelector("#live[data-state=live]");
    const { left, top } = (await labels(page)).find(({ text }) => text === "905");
    const canvas = await page.locator("#canvas").boundingBox();
    // A label stands to the right of its anchor.
    await page.mouse.click(canvas.x + left - 9, canvas.y + top + 7);
    await page.waitForSelector("#details .reads");
    const seen = await page.evaluate(() => ["#details h2", "#details .reads", "#canvas"].map((one) => {
      const { top: start, bottom: end } = document.querySelector(one).getBoundingClientRect();
      return start >= 0 && end <= innerHeight;
    }));
    assert.deepEqual(seen, [true, true, true]);
    // A tab brings its panel to the top.
    await page.click("#tab-keyframes");
    await page.waitForFunction(() => document.getElementById("tab-keyframes").getBoundingClientRect().top < 60);
    await page.close();
    await server.stop();
  },

  async "where texts collide, what names a place is written: door numbers and codes before paintings"() {
    const server = await serve("names");
    await gallery(server);
    for (const screen of SCREENS) {
      const page = await open(`${server.url}/?map=gallery`, screen);
      await page.waitForSelector("#live[data-state=live]");
      const written = (await labels(page)).map(({ text }) => text);
      assert.deepEqual(NAMED.filter((text) => !written.includes(text)), [], `${screen.width}: ${written.join("; ")}`);
      assert.ok(written.filter((text) => text.startsWith("a painting")).length < ROWS.length * NAMED.length, `${screen.width}: nothing collides`);
      await page.close();
    }
    await server.stop();
  },
};
