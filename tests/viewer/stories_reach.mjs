// Reaching: the keyboard, the phone, and eyes that need contrast.

import assert from "node:assert/strict";
import { labels, open, serve } from "./browser.mjs";
import { tower } from "./world.mjs";

const PANELS = ["details", "anchors", "keyframes", "verdicts", "loops", "events", "where", "releases"];
const LEAST_CONTRAST = 4.5;

/** How many texts the page shows, and those whose contrast with what is behind them is too low. */
const faint = (page) => page.evaluate((least) => {
  const paint = document.createElement("canvas").getContext("2d", { willReadFrequently: true });
  const channels = (colour) => {
    paint.clearRect(0, 0, 1, 1);
    paint.fillStyle = colour;
    paint.fillRect(0, 0, 1, 1);
    const [r, g, b, a] = paint.getImageData(0, 0, 1, 1).data;
    return [r, g, b, a / 255];
  };
  const over = ([r, g, b, a], [r2, g2, b2]) => [r, g, b].map((one, index) => one * a + [r2, g2, b2][index] * (1 - a));
  const behind = (element) => {
    if (!element) return channels(getComputedStyle(document.documentElement).getPropertyValue("--ground"));
    const own = channels(getComputedStyle(element).backgroundColor);
    return own[3] === 1 ? own : over(own, behind(element.parentElement));
  };
  const luminance = (colour) => {
    const [r, g, b] = colour.slice(0, 3).map((one) => (one / 255 <= 0.04045 ? one / 255 / 12.92 : ((one / 255 + 0.055) / 1.055) ** 2.4));
    return 0.2126 * r + 0.7152 * g + 0.0722 * b;
  };
  const found = [];
  let looked = 0;
  const walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
  while (walker.nextNode()) {
    const { parentElement: element, textContent } = walker.currentNode;
    if (textContent.trim() === "" || !element.checkVisibility({ opacityProperty: true, visibilityProperty: true })) continue;
    if (element.closest("script, noscript, option, :disabled, .offscreen, .keys")) continue;
    looked += 1;
    const style = getComputedStyle(element);
    const drawn = element.closest("svg");
    const number = element.classList.contains("number") && element.parentElement.querySelector("circle");
    const ground = number ? channels(number.getAttribute("fill")) : behind(drawn ?? element);
    const text = over(channels(drawn ? element.getAttribute("fill") ?? style.fill : style.color), ground);
    const [light, dark] = [luminance(text), luminance(ground)].sort((a, b) => b - a);
    const contrast = (light + 0.05) / (dark + 0.05);
    if (contrast < least) found.push(`${contrast.toFixed(2)}: ${textContent.trim().slice(0, 40)} (${element.tagName} ${element.className?.baseVal ?? element.className})`);
  }
  return { looked, found };
}, LEAST_CONTRAST);

/** Asks about the keyframe that the address names. */
async function asked(page) {
  await page.click("text=Is it a loop?");
  await page.waitForSelector(".candidates");
}

/** Publishes the tower, and closes a loop and stores a keyframe in it afterwards. */
async function goOn(server) {
  await server.ask("PUT", "/v1/maps/tower/releases/2026-10", { description: "after the survey" });
  await server.ask("POST", "/v1/maps/tower/loops", { id: "loop-1", keyframe: "robot-2-1", candidate: "robot-1-1" });
  const pose = { translation: { x: 3, y: 0, z: 1.2 }, rotation: { x: 0, y: 0, z: 0, w: 1 } };
  await server.ask("PUT", "/v1/maps/tower/keyframes/late", { session: "robot-1", stamp: { sec: 50, nanosec: 0 }, pose });
}

/** Compares a release with the map. */
async function openChanges(page) {
  await page.click("#tab-releases");
  await page.click("#releases >> text=Compare…");
  await page.waitForSelector("#releases .counts");
}

async function openCompare(page) {
  await page.click(".candidate[open] .compare-it");
  await page.waitForSelector("dialog[open] svg.views");
}

export const reaching = {
  async "the slash finds a sign from anywhere, and shows it on the map"() {
    const server = await tower(await serve("find"));
    const page = await open(`${server.url}/?map=tower`);
    await page.waitForSelector("#live[data-state=live]");
    await page.keyboard.press("/");
    assert.equal(await page.evaluate(() => document.activeElement.type), "search");
    await page.keyboard.type("930");
    await page.waitForFunction(() => document.getElementById("anchors").textContent.includes("1 anchor found"));
    // In a field it is a sign like any other.
    await page.keyboard.press("/");
    assert.equal(await page.inputValue("#anchors input"), "930/");
    await page.keyboard.press("Backspace");
    await page.waitForFunction(() => document.getElementById("anchors").textContent.includes("1 anchor found"));
    await page.keyboard.press("Enter");
    await page.waitForFunction(() => document.querySelector("#details .reads")?.textContent === "930");
    assert.match(page.url(), /anchor=a-\d+/);
    // Only what was found keeps its label.
    const shown = (await labels(page)).map(({ text }) => text);
    assert.ok(shown.includes("930") && !shown.includes("905"), shown.join());
    // Once more, and away from it.
    await page.keyboard.press("/");
    await page.keyboard.press("Escape");
    await page.waitForFunction(() => document.querySelector("#anchors input").value === "" && !/found/.test(document.getElementById("anchors").textContent));
    await page.close();
    await server.stop();
  },

  async "a keyframe is found by its id, and what is nowhere is said so"() {
    const server = await tower(await serve("find-keyframe"));
    const page = await open(`${server.url}/?map=tower`);
    await page.waitForSelector("#live[data-state=live]");
    await page.keyboard.press("/");
    await page.keyboard.type("Robot-2-1");
    await page.waitForFunction(() => document.getElementById("anchors").textContent.includes("1 keyframe found"));
    await page.keyboard.press("Enter");
    await page.waitForSelector("#details h2:has-text('Keyframe robot-2-1')");
    assert.match(page.url(), /keyframe=robot-2-1/);
    // Part of an id finds several.
    await page.keyboard.press("/");
    await page.keyboard.type("robot-3");
    await page.waitForFunction(() => document.getElementById("anchors").textContent.includes("7 keyframes found"));
    await page.keyboard.press("/");
    await page.fill("#anchors input", "kf-9999");
    await page.waitForSelector("#anchors .hint >> text=No sign reads like “kf-9999”, and no keyframe has such an id.");
    await page.close();
    await server.stop();
  },

  async "the arrows step through the session of a keyframe, and stop at its ends"() {
    const server = await tower(await serve("arrows"));
    const page = await open(`${server.url}/?map=tower&keyframe=robot-2-1`);
    await page.waitForSelector("#details h2:has-text('robot-2-1')");
    await page.focus("#canvas");
    const press = async (key, then) => {
      await page.keyboard.press(key);
      await page.waitForSelector(`#details h2:has-text('${then}')`);
    };
    await press("ArrowRight", "robot-2-2");
    await press("ArrowLeft", "robot-2-1");
    await press("ArrowLeft", "robot-2-0");
    await press("ArrowLeft", "robot-2-0");
    await press("ArrowDown", "robot-2-1");
    // With Shift they move the map, and what is selected stays.
    await press("Shift+ArrowRight", "robot-2-1");
    await press("p", "robot-2-0");
    // Over all that is shown, sessions follow one another.
    await press("p", "robot-1-6");
    await page.close();
    await server.stop();
  },

  async "the Tab key reaches every control, and each one shows that it is reached"() {
    const server = await tower(await serve("tab"));
    const page = await open(`${server.url}/?map=tower&keyframe=robot-2-1`);
    await page.waitForSelector("#details h2");
    await asked(page);
    const all = await page.evaluate(() => {
      const controls = [...document.querySelectorAll("a[href], button, input, select, textarea, summary, [tabindex]")];
      const shown = controls.filter((one) => one.checkVisibility() && one.tabIndex >= 0 && !one.disabled);
      shown.forEach((one, index) => { one.dataset.reach = index; });
      document.activeElement.blur();
      return shown.length;
    });
    const reached = new Set();
    for (let times = 0; times < 3 * all && reached.size < all; times += 1) {
      await page.keyboard.press("Tab");
      const { index, isMarked, name } = await page.evaluate(() => {
        const { activeElement: one } = document;
        const { outlineStyle, outlineWidth } = getComputedStyle(one);
        return { index: one.dataset.reach, isMarked: outlineStyle !== "none" && parseFloat(outlineWidth) > 0, name: one.outerHTML.slice(0, 80) };
      });
      if (index === undefined) continue;
      assert.ok(isMarked, `no focus is seen on ${name}`);
      reached.add(index);
    }
    assert.equal(reached.size, all);
    await page.close();
    await server.stop();
  },

  async "a telephone shows everything without scrolling sideways"() {
    const server = await tower(await serve("phone"));
    await goOn(server);
    const page = await open(`${server.url}/?map=tower&keyframe=robot-2-2`, { width: 360, height: 740 });
    const fits = async (what) => {
      const width = await page.evaluate(() => Math.max(document.documentElement.scrollWidth, document.querySelector("dialog").scrollWidth));
      assert.ok(width <= 360, `${what} is ${width} pixels wide`);
    };
    await page.waitForSelector("#details h2");
    await asked(page);
    await fits("a verdict");
    await openCompare(page);
    await fits("a comparison");
    await page.keyboard.press("Escape");
    await page.click("text=Floor plan");
    await fits("the form of the floor plan");
    for (const panel of PANELS) {
      await page.click(`#tab-${panel}`);
      await fits(panel);
    }
    await openChanges(page);
    await fits("what changed since a release");
    await server.ask("PUT", "/v1/maps/empty", {});
    await page.goto(`${server.url}/?map=empty`);
    await page.waitForSelector("#empty:not([hidden])");
    await fits("an empty map");
    await page.close();
    await server.stop();
  },

  async "every text can be told from its ground, by day and by night, and nothing moves for those who want rest"() {
    const server = await tower(await serve("contrast"));
    await goOn(server);
    for (const scheme of ["light", "dark"]) {
      const page = await open(`${server.url}/?map=tower&keyframe=robot-2-2`, { scheme });
      const clear = async (what) => {
        const { looked, found } = await faint(page);
        assert.ok(looked > 15, `${looked} texts are seen in ${what}`);
        assert.deepEqual(found, [], `${scheme}: ${what}`);
      };
      await page.emulateMedia({ reducedMotion: "reduce" });
      await page.waitForSelector("#details h2");
      await asked(page);
      await page.$$eval(".candidate", (cards) => cards.forEach((card) => { card.open = true; }));
      await clear("a verdict");
      await page.locator(".compare-it").last().click();
      await page.waitForSelector("dialog[open] svg.views");
      await clear("a comparison");
      await page.keyboard.press("Escape");
      await page.click("text=Floor plan");
      for (const panel of PANELS) {
        await page.click(`#tab-${panel}`);
        await clear(panel);
      }
      await openChanges(page);
      await clear("what changed since a release");
      assert.equal(await page.evaluate(() => document.getAnimations().length), 0);
      await page.close();
    }
    await server.ask("POST", "/v1/keys", { name: "page", actions: ["read", "admin"], maps: ["*"] });
    for (const scheme of ["light", "dark"]) {
      const page = await open(`${server.url}/?map=tower`, { scheme, expected: /401/ });
      await page.fill("#empty input", "revisit_nonsense");
      await page.keyboard.press("Enter");
      await page.waitForSelector("#empty [role=alert]");
      assert.deepEqual((await faint(page)).found, [], `${scheme}: a refused key`);
      await page.close();
    }
    await server.stop();
  },
};
