// Map: what is drawn on the canvas: plans, labels, and the colours of the legend.

import assert from "node:assert/strict";
import { labels, open, serve } from "./browser.mjs";
import { tower } from "./world.mjs";

const texts = (boxes) => boxes.map(({ text }) => text);

/** The colours of the legend's glyphs, and how many pixels of the canvas have exactly each of them. */
const legendOnCanvas = (page) => page.evaluate(() => {
  const canvas = document.getElementById("canvas");
  const copy = Object.assign(document.createElement("canvas"), { width: canvas.width, height: canvas.height });
  const context = copy.getContext("2d", { willReadFrequently: true });
  context.drawImage(canvas, 0, 0);
  const { data } = context.getImageData(0, 0, copy.width, copy.height);
  const drawn = new Map();
  for (let at = 0; at < data.length; at += 4) {
    if (data[at + 3] !== 255) continue;
    const colour = `rgb(${data[at]}, ${data[at + 1]}, ${data[at + 2]})`;
    drawn.set(colour, (drawn.get(colour) ?? 0) + 1);
  }
  return [...document.querySelectorAll("#legend .glyph")].map((glyph) => {
    const { color } = getComputedStyle(glyph);
    return { name: glyph.parentElement.textContent, colour: color, pixels: drawn.get(color) ?? 0 };
  });
});

/** Another layout, and what is drawn then. */
const chosen = (page, value) => labels(page, () => page.selectOption("#sessions", value));

export const map = {
  async "the signs of a plan lie beneath the sessions that are aligned to it, and nowhere else"() {
    const server = await tower(await serve("plans"));
    const page = await open(`${server.url}/?map=tower`);
    await page.waitForSelector("#live[data-state=live]");
    assert.match(await page.textContent("#figures"), /3 sessions\s*1 plan/);
    assert.match(await page.textContent("#legend"), /sign of a plan 8/);
    // In the frame of all: what the plan says beside what robot-2 misread there.
    const fleet = texts(await chosen(page, "fleet"));
    assert.ok(["930", "903", "801"].every((text) => fleet.includes(text)), fleet.join());
    // In robot-2's own frame the plan's 903 stands by its alignment.
    const own = await chosen(page, "=robot-2");
    const [misread, planned] = ["930", "903"].map((text) => own.find((label) => label.text === text));
    assert.ok(planned && Math.abs(misread.left - planned.left) < 80 && Math.abs(misread.top - planned.top) < 40, JSON.stringify(own));
    // robot-3 is on another floor, and the plan can be looked at alone.
    assert.ok(!texts(await chosen(page, "=robot-3")).some((text) => text.startsWith("90")));
    assert.equal(texts(await chosen(page, "=plan:9")).filter((text) => text.startsWith("90")).length, 8);
    await page.click("#tab-anchors");
    await page.selectOption("#anchors [aria-label=State]", "prior");
    await page.waitForFunction(() => document.getElementById("anchors").textContent.includes("8 anchors found"));
    await page.close();
    await server.stop();
  },

  async "a picture of a floor plan lies under the map, and leaves neither the tab nor its frame"() {
    const server = await tower(await serve("picture"));
    const page = await open(`${server.url}/?map=tower`);
    await page.waitForSelector("#live[data-state=live]");
    const sent = [];
    page.on("request", (request) => { if (request.method() !== "GET") sent.push(request.url()); });
    await chosen(page, "=robot-1");
    await page.click("text=Floor plan");
    const picture = '<svg xmlns="http://www.w3.org/2000/svg" width="80" height="40"><rect width="80" height="40" fill="#ff00ff"/></svg>';
    const upload = (buffer) => page.setInputFiles("#picture input[type=file]", { name: "plan.svg", mimeType: "image/svg+xml", buffer });
    await upload(Buffer.from("no picture"));
    await page.waitForSelector("#picture .fault:not([hidden])");
    await upload(Buffer.from(picture));
    await page.waitForSelector("#picture [data-field=right]");
    await labels(page, async () => {
      await page.fill("#picture [data-field=metresPerPixel]", "0.1");
      await page.fill("#picture [data-field=up]", "-2");
      await page.fill("#picture [data-field=shade]", "100");
    });
    // 8 m by 4 m in full colour, but for what is drawn on it.
    const pink = () => page.evaluate(() => {
      const canvas = document.getElementById("canvas");
      const copy = Object.assign(document.createElement("canvas"), { width: canvas.width, height: canvas.height });
      const context = copy.getContext("2d", { willReadFrequently: true });
      context.drawImage(canvas, 0, 0);
      const { data } = context.getImageData(0, 0, copy.width, copy.height);
      let [n, left, right] = [0, Infinity, -Infinity];
      for (let at = 0; at < data.length; at += 4) {
        if (data[at] !== 255 || data[at + 1] !== 0 || data[at + 2] !== 255) continue;
        n += 1;
        const x = (at / 4) % canvas.width;
        [left, right] = [Math.min(left, x), Math.max(right, x)];
      }
      return { n, across: right - left };
    });
    const flat = await pink();
    assert.ok(flat.n > 10_000, `${flat.n} pixels`);
    await labels(page, () => page.fill("#picture [data-field=degrees]", "90"));
    const turned = await pink();
    assert.ok(turned.across < 0.7 * flat.across, `${turned.across} of ${flat.across} pixels across`);
    await page.keyboard.press("Escape");
    assert.equal(await page.locator("#picture").isVisible(), false);
    // The plan's frame is not robot-3's.
    await chosen(page, "=robot-3");
    assert.equal((await pink()).n, 0);
    await chosen(page, "=robot-1");
    assert.ok((await pink()).n > 1000);
    await page.click("text=Floor plan");
    await labels(page, () => page.click("text=Take it away"));
    assert.equal((await pink()).n, 0);
    assert.deepEqual(sent, []);
    await page.close();
    await server.stop();
  },

  async "the map is shown as it was up to a moment, and whole again for what came later"() {
    const server = await tower(await serve("until"));
    const page = await open(`${server.url}/?map=tower`);
    await page.waitForSelector("#live[data-state=live]");
    await chosen(page, "=robot-3");
    const moved = async (to) => texts(await labels(page, () => page.locator("#until input").fill(to)));
    const keyframes = () => page.evaluate(() => document.querySelector("#until output").textContent);
    assert.equal(await keyframes(), "all 7 keyframes");
    const early = await moved("1");
    assert.equal(await keyframes(), "1 of 7, up to 2000 s");
    assert.ok(early.includes("801") && !early.includes("807"), early.join());
    await page.click("#tab-keyframes");
    await page.click("#keyframes .ref >> text=robot-3-6");
    await page.waitForSelector("#details h2 >> text=robot-3-6");
    assert.match(await keyframes(), /^all \d+ keyframes$/);
    assert.ok(texts(await labels(page)).includes("807"));
    await page.close();
    await server.stop();
  },

  async "a trajectory is downloaded, of one session or of all in one frame"() {
    const server = await tower(await serve("trajectory"));
    const page = await open(`${server.url}/?map=tower`);
    await page.waitForSelector("#live[data-state=live]");
    await page.click("#tab-keyframes");
    const download = async (session, format) => {
      await page.selectOption("[aria-label='Session of the trajectory']", session);
      const [file] = await Promise.all([page.waitForEvent("download"), page.click(`#keyframes button >> text=${format}`)]);
      const chunks = [];
      for await (const chunk of await file.createReadStream()) chunks.push(chunk);
      return { name: file.suggestedFilename(), lines: Buffer.concat(chunks).toString().trim().split("\n").filter((line) => !line.startsWith("#")) };
    };
    const one = await download("robot-2", "TUM");
    assert.equal(one.name, "tower.robot-2.tum");
    assert.equal(one.lines.length, 7);
    assert.ok(one.lines.every((line) => line.split(" ").length === 8));
    assert.equal((await download("", "KITTI")).lines.length, 14);
    assert.match((await download("robot-1", "g2o")).lines[0], /^VERTEX_SE3:QUAT /);
    await page.close();
    await server.stop();
  },

  async "the pictures of signs stand beside their texts, and are read when they come into view"() {
    const server = await tower(await serve("thumbs"));
    const page = await open(`${server.url}/?map=tower&keyframe=robot-1-1`, { height: 600 });
    await page.waitForSelector("#details table .thumb canvas");
    await page.click("#tab-anchors");
    await page.waitForSelector("#anchors li");
    const { items } = await server.ask("GET", "/v1/maps/tower/anchors");
    const pictured = items.filter(({ has_crop: has }) => has).map(({ id }) => id);
    assert.equal(await page.locator("#anchors .thumb").count(), pictured.length);
    const last = page.locator("#anchors li:has(.thumb)").last();
    assert.equal(await last.locator("canvas").count(), 0);
    await last.scrollIntoViewIfNeeded();
    await last.locator("canvas").waitFor();
    await page.close();
    await server.stop();
  },

  async "what the map has learned, and how much a sign tells, is said in plain words"() {
    const server = await tower(await serve("words"));
    const exit = { class: "exit_sign", confidence: 0.9, box: [0, 0, 9, 9], text: "EXIT", position: [2, 22, 2] };
    const pose = { translation: { x: 7, y: 21, z: 1 }, rotation: { x: 0, y: 0, z: 0, w: 1 } };
    await server.ask("PUT", "/v1/maps/tower/keyframes/robot-3-9", { session: "robot-3", stamp: { sec: 2100, nanosec: 0 }, pose, detections: [exit] });
    const { items } = await server.ask("GET", "/v1/maps/tower/anchors?class=exit_sign");
    const page = await open(`${server.url}/?map=tower&anchor=${items[0].id}`);
    await page.waitForSelector("#details .facts >> text=what many signs say (2 of 5)");
    assert.match(await page.textContent("#figures"), /door number like [89]\d\d/);
    await page.click("#tab-anchors");
    await page.selectOption("#anchors [aria-label=State]", { label: "says too little" });
    await page.waitForSelector("#anchors >> text=1 anchor found");
    assert.doesNotMatch(await page.textContent("body"), /uninformative|level \d of 5|numbers #/);
    await page.close();
    await server.stop();
  },

  async "labels never lie on one another, the selected one is there, and others come when there is room"() {
    const server = await serve("labels");
    await server.ask("PUT", "/v1/maps/m", {});
    const crowd = Array.from({ length: 240 }, (_, index) => ({
      class: index % 3 ? "door_number" : "poster", confidence: 0.9, box: [index, 0, index + 1, 10],
      text: index % 3 ? `${100 + index}` : `Poster of exhibition ${index}`, position: [(index % 16) * 0.8, Math.floor(index / 16) * 0.8, 2],
    }));
    const pose = { translation: { x: 5, y: 5, z: 0 }, rotation: { x: 0, y: 0, z: 0, w: 1 } };
    await server.ask("PUT", "/v1/maps/m/keyframes/kf-1", { stamp: { sec: 1, nanosec: 0 }, pose, detections: crowd });
    const page = await open(`${server.url}/?map=m`, { width: 900, height: 600 });
    await page.waitForSelector("#live[data-state=live]");
    const apart = (boxes) => {
      const meet = (a, b) => a.left < b.left + b.width && b.left < a.left + a.width && a.top < b.top + b.height && b.top < a.top + a.height;
      for (const [index, a] of boxes.entries()) for (const b of boxes.slice(index + 1)) assert.ok(!meet(a, b), `${a.text} lies on ${b.text}`);
    };
    const all = await labels(page);
    apart(all);
    assert.ok(all.length > 20 && all.length < 240, `${all.length} labels`);
    // Identifiers come before posters.
    const share = (boxes, isPoster) => boxes.filter(({ text }) => text.startsWith("Poster") === isPoster).length / (isPoster ? 80 : 160);
    assert.ok(share(all, false) > share(all, true), `${share(all, false)} of the numbers, ${share(all, true)} of the posters`);
    // One that has no place gets it when it is selected, and when there is room.
    const { items } = await server.ask("GET", "/v1/maps/m/anchors?limit=1000");
    const hidden = items.find(({ description }) => !texts(all).some((text) => description.startsWith(text.replace("…", ""))));
    await page.goto(`${server.url}/?map=m&anchor=${hidden.id}`);
    await page.waitForSelector("#details .reads");
    const selected = await labels(page);
    apart(selected);
    assert.ok(texts(selected).some((text) => hidden.description.startsWith(text.replace("…", ""))), hidden.description);
    await page.focus("#canvas");
    const near = await labels(page, async () => { for (let times = 0; times < 3; times += 1) await page.keyboard.press("+"); });
    apart(near);
    await page.close();
    await server.stop();
  },

  async "every colour of the legend is on the canvas, by day, by night, and when the one becomes the other"() {
    const server = await tower(await serve("legend"));
    const level = { x: -0.5, y: 0.5, z: -0.5, w: 0.5 };
    const unread = { class: "poster", confidence: 0.9, box: [0, 0, 9, 9], position: [2, 22, 2] };
    await server.ask("PUT", "/v1/maps/tower/keyframes/robot-3-9", {
      session: "robot-3", stamp: { sec: 2100, nanosec: 0 }, pose: { translation: { x: 7, y: 21, z: 1 }, rotation: level }, detections: [unread],
    });
    await server.ask("POST", "/v1/maps/tower/loops", { id: "loop-1", keyframe: "robot-2-1", candidate: "robot-1-1" });
    const page = await open(`${server.url}/?map=tower`);
    await page.waitForSelector("#live[data-state=live]");
    await page.uncheck("#labels");
    const seen = [];
    for (const scheme of ["light", "dark", "light"]) {
      await page.emulateMedia({ colorScheme: scheme });
      await chosen(page, "apart");
      const glyphs = await legendOnCanvas(page);
      assert.ok(glyphs.length >= 7, JSON.stringify(glyphs));
      for (const { name, colour, pixels } of glyphs) assert.ok(pixels > 0, `${scheme}: ${name} is ${colour} in the legend and not on the map`);
      seen.push(JSON.stringify(glyphs.map(({ colour }) => colour)));
    }
    assert.equal(seen[0], seen[2]);
    assert.notEqual(seen[0], seen[1]);
    await page.close();
    await server.stop();
  },
};
