// Releases: a map that goes on after it was published; and what other clients write appears by itself.

import assert from "node:assert/strict";
import { open, serve } from "./browser.mjs";
import { drive } from "./world.mjs";

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
    assert.match(await page.textContent("#events time"), /^20\d\d-\d\d-\d\d \d\d:\d\d:\d\d UTC$/);
    // Of one kind alone, also of what comes.
    await page.selectOption("#events [aria-label='Kind of event']", "loops");
    await page.waitForSelector("#events >> text=Nothing of this kind has happened.");
    await server.ask("POST", "/v1/maps/m/loops", { id: "loop-1", keyframe: "kf-3009", candidate: "kf-10" });
    await page.waitForSelector("#events >> text=Loop loop-1 closed: kf-3009 with kf-10");
    assert.equal(await page.locator("#events li").count(), 1);
    await page.selectOption("#events [aria-label='Kind of event']", "everything");
    await page.waitForSelector("#events li:nth-child(5)");
    await page.close();
    await server.stop();
  },
};

const MAP = "/v1/maps/m";

/** A map of two robots in one corridor, published as `2026-10` and asked by one of them. */
async function published(server) {
  await server.ask("PUT", MAP, {});
  await server.send("m", [
    ...drive("robot-1", { reads: (index) => String(901 + index), crops: true }),
    ...drive("robot-2", { reads: (index) => String(901 + index), begins: 1000 }),
  ]);
  await server.ask("PUT", `${MAP}/releases/2026-10`, { description: "after the survey" });
}

/** Changes of the map: a keyframe comes, one goes, one moves, and a sign reads otherwise. */
async function livedOn(server) {
  const [first] = drive("robot-9", { steps: 1, begins: 3000, offset: [0, 0, 0], reads: () => null });
  await server.ask("PUT", `${MAP}/keyframes/late`, first.body);
  assert.equal((await fetch(`${server.url}${MAP}/keyframes/robot-2-6`, { method: "DELETE" })).ok, true);
  const moved = { translation: { x: 3, y: 0.75, z: 1.2 }, rotation: { x: -0.5, y: 0.5, z: -0.5, w: 0.5 } };
  await server.ask("POST", `${MAP}/poses`, { session: "robot-1", keyframes: { ids: ["robot-1-3"], poses: [moved] } });
  const { items } = await server.ask("GET", `${MAP}/anchors`);
  const renamed = items.find(({ description }) => description === "903").id;
  const headers = { "content-type": "application/json", "if-match": "*" };
  const described = { method: "PATCH", headers, body: JSON.stringify({ description: "Nurse Joy" }) };
  assert.equal((await fetch(`${server.url}${MAP}/anchors/${renamed}`, described)).ok, true);
  return renamed;
}

/** A lap past one door, which reads so (null: nothing hangs there): two views of it, and four from where it is far behind. Tracking knows its points on every lap. */
async function lap(server, number, text) {
  const points = Array.from({ length: 30 }, (_, index) => [0.3 + (index % 6) * 0.08, (index % 5) * 0.1 - 0.2, 2.8 + (index % 7) * 0.06]);
  const ids = points.map((_, index) => 1000 + index);
  for (const [stand, x] of [0, 0.1, 4.5, 4.6, 4.7, 4.8].entries()) {
    const step = 6 * number + stand;
    const sees = stand < 2;
    await server.ask("PUT", `${MAP}/keyframes/lap-${number}-${stand}`, {
      session: "robot-1", stamp: { sec: step, nanosec: 0 }, bow: { words: [1, 2], weights: [0.5, 0.5] },
      pose: { translation: { x, y: 0, z: 0 }, rotation: { x: 0, y: 0, z: 0, w: 1 } },
      camera: { fx: 525, fy: 525, cx: 320, cy: 240, width: 640, height: 480 },
      observes: [...(sees ? ids : []), ...Array.from({ length: 60 }, (_, index) => 1_000_000 + 20 * step + index)],
      ...(number === 0 && stand === 0 ? { map_points: { ids, positions: points } } : {}),
      detections: sees && text ? [{ class: "door_number", confidence: 0.9, box: [0, 0, 10, 10], text, position: [0.5, 0, 3] }] : [],
    });
  }
}

/** The tab of releases, once its list was read. */
async function releasesOf(page) {
  await page.click("#tab-releases");
  await page.waitForSelector("#releases >> text=/^\\d+ releases?$|^No release is published yet/");
}

export const releasing = {
  async "the map is published from the page, refused in place where it cannot be, and another client's release appears"() {
    const server = await serve("publish");
    await server.ask("PUT", MAP, {});
    await server.send("m", row(3));
    const page = await open(`${server.url}/?map=m`, { expected: /409/ });
    await page.waitForSelector("#live[data-state=live]");
    await releasesOf(page);
    // What would be published is said before.
    await page.click("#releases >> text=Publish version 4");
    assert.equal(await page.textContent("#publish-fault"), "It needs a name.");
    await page.fill("[aria-label='Name of the release']", "to day");
    await page.keyboard.press("Enter");
    assert.match(await page.textContent("#publish-fault"), /at most 128 of A–Z/);
    assert.equal(await page.evaluate(() => document.activeElement.getAttribute("aria-describedby")), "publish-fault");
    await page.fill("[aria-label='Name of the release']", "2026-11");
    await page.fill("[aria-label='Description of the release']", "three in a row");
    await page.keyboard.press("Enter");
    await page.waitForSelector("#releases >> text=2026-11 is published: version 4.");
    assert.ok(await page.isHidden("#publish-fault"));
    const line = await page.textContent("#releases .releases > li");
    assert.match(line, /^2026-11 version 4 as the map stands.*three in a row.*published 2.*UTC; 3 keyframes, 0 anchors, 1 session, 0 loops, .*kB|bytes/s);
    assert.match(line, /No robot has asked it/);
    assert.equal((await server.ask("GET", `${MAP}/releases/2026-11`)).description, "three in a row");
    // The name is taken.
    await page.fill("[aria-label='Name of the release']", "2026-11");
    await page.keyboard.press("Enter");
    await page.waitForSelector("#publish-fault >> text=There is a release of this name already");
    assert.equal(await page.inputValue("[aria-label='Name of the release']"), "2026-11");
    await server.ask("PUT", `${MAP}/releases/other`, {});
    await page.waitForSelector("#releases .releases > li:nth-child(2)");
    assert.match(await page.locator("#releases .releases > li").first().textContent(), /^other/);
    await page.click("#tab-events");
    await page.waitForSelector("#events >> text=Published: release other of version 4");
    await page.close();
    await server.stop();
  },

  async "a release says who asked it, and is deleted after a second question"() {
    const server = await serve("asked");
    await published(server);
    for (const keyframe of ["robot-2-1", "robot-2-2"]) await server.ask("POST", `${MAP}/loop-queries`, { keyframe, release: "2026-10" });
    for (let asked = []; asked[0]?.queries !== 2; [{ asked_by: asked }] = (await server.ask("GET", `${MAP}/releases`)).items);
    const page = await open(`${server.url}/?map=m`);
    await releasesOf(page);
    assert.match(await page.textContent("#releases .releases > li"), /Asked byrobot-2: 2 queries, the last 20.*UTC/);
    await page.click("#releases >> text=Delete…");
    assert.match(await page.textContent("#releases .releases > li"), /Nothing brings it back\. 1 robot has asked it, the last on 20.*404/);
    // The harmless answer has the keyboard.
    await page.keyboard.press("Enter");
    assert.equal((await server.ask("GET", `${MAP}/releases`)).items.length, 1);
    await page.click("#releases >> text=Delete…");
    await page.click("#releases >> text=Delete the release");
    await page.waitForSelector("#releases >> text=2026-10 is deleted.");
    await page.waitForSelector("#releases >> text=No release is published yet.");
    assert.equal((await server.ask("GET", `${MAP}/releases`)).items.length, 0);
    await page.close();
    await server.stop();
  },

  async "a release is compared with the map and with another one: counts, lists that lead to the map, and marks on it"() {
    const server = await serve("changes");
    await published(server);
    const renamed = await livedOn(server);
    await server.ask("PUT", `${MAP}/releases/2026-11`, {});
    await server.ask("PUT", `${MAP}/keyframes/latest`, row(1)[0].body);
    const page = await open(`${server.url}/?map=m`);
    await releasesOf(page);
    await page.click("[aria-label='Compare 2026-10']");
    await page.waitForSelector("#releases .counts");
    assert.deepEqual(await page.locator("#releases .counts li").allTextContents(),
      ["1 sign reads otherwise", "2 keyframes were added", "1 keyframe was removed", "1 keyframe has another pose"]);
    const listed = async (kind) => (await page.locator(`#releases [data-change=${kind}] li`).allTextContents()).join("; ");
    assert.equal(await listed("anchors-described"), `${renamed} 903 → Nurse Joy door_number`);
    assert.equal(await listed("keyframes-added"), "late; latest");
    assert.equal(await listed("keyframes-moved"), "robot-1-3 by 0.75 m");
    // What is gone leads nowhere.
    assert.equal(await listed("keyframes-removed"), "robot-2-6");
    assert.equal(await page.locator("#releases [data-change=keyframes-removed] button").count(), 0);
    assert.match(await page.textContent("#legend"), /moved or read otherwise since the release.*new or back since/);
    await page.click("#releases [data-change=keyframes-added] >> text=latest");
    await page.waitForSelector("#details h2 >> text=latest");
    // The comparison waits where it was left, and follows the map.
    await page.click("#tab-releases");
    await server.ask("PUT", `${MAP}/keyframes/last`, row(1, 1)[0].body);
    await page.waitForSelector("#releases .counts >> text=3 keyframes were added");
    // Chosen the other way round, time still runs forward.
    await page.selectOption("#releases .sides select >> nth=1", "2026-11");
    await page.waitForSelector("#releases .counts >> text=1 keyframe was added");
    await page.selectOption("#releases .sides select >> nth=0", "2026-11");
    await page.waitForSelector("#releases .counts >> text=Nothing changed");
    assert.ok(!/since/.test(await page.textContent("#legend")), "nothing is marked");
    await page.selectOption("#releases .sides select >> nth=1", "2026-10");
    await page.waitForSelector("#releases .counts >> text=1 keyframe was removed");
    assert.equal(await page.inputValue("#releases .sides select >> nth=0"), "2026-10");
    await page.click("#releases >> text=Back to the releases");
    assert.equal(await page.evaluate(() => document.activeElement.dataset.compare), "2026-10");
    assert.ok(!/since/.test(await page.textContent("#legend")), "the marks are gone");
    await page.close();
    await server.stop();
  },

  async "a sign that hangs there no longer is listed first, and crossed out on the map"() {
    const server = await serve("retired");
    await server.ask("PUT", MAP, {});
    await lap(server, 0, "901");
    await server.ask("PUT", `${MAP}/releases/2026-10`, {});
    for (const number of [1, 2, 3]) await lap(server, number, null);
    const page = await open(`${server.url}/?map=m`, { scheme: "dark", expected: /willReadFrequently/ });
    await releasesOf(page);
    const red = () => page.evaluate(() => {
      const canvas = document.getElementById("canvas");
      const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
      const wanted = getComputedStyle(document.documentElement).getPropertyValue("--bad").trim().match(/[0-9a-f]{2}/gi).map((byte) => parseInt(byte, 16));
      let found = 0;
      for (let at = 0; at < data.length; at += 4) if (wanted.every((byte, index) => data[at + index] === byte)) found += 1;
      return found;
    });
    assert.equal(await red(), 0);
    await page.click("[aria-label='Compare 2026-10']");
    await page.waitForSelector("#legend >> text=hangs there no longer");
    assert.equal(await page.locator("#releases .counts li").first().textContent(), "1 sign hangs there no longer");
    assert.equal(await page.locator("#releases section li").first().textContent(), "a-0 901 door_number");
    assert.ok(await red() > 40, "a cross is drawn");
    await page.close();
    await server.stop();
  },

  async "a key that may not write sees the releases, and why it cannot publish or delete one"() {
    const server = await serve("readers");
    await published(server);
    const admin = await server.ask("POST", "/v1/keys", { name: "admin", actions: ["read", "admin"], maps: ["*"] });
    const page = await open(server.url, { expected: /40[13]/ });
    await page.evaluate((secret) => sessionStorage.setItem("revisit.key", secret), admin.secret);
    await page.goto(`${server.url}/?map=m`);
    await releasesOf(page);
    await page.waitForSelector("#releases >> text=/This key may read the releases.*the action write/");
    assert.ok(await page.isDisabled("#releases button.main") && await page.isDisabled("[aria-label='Delete 2026-10']"));
    await page.click("[aria-label='Compare 2026-10']");
    await page.waitForSelector("#releases .counts >> text=Nothing changed");
    await page.close();
    await server.stop();
  },

  async "a keyframe says which features and pictures its map let go of, and how it is erased"() {
    const server = await serve("kept", "--retention-every-s", "1");
    await server.ask("PUT", MAP, { settings: { keep_crops: false, keep_descriptors_days: 30 } });
    await server.send("m", drive("robot-1", { steps: 2, reads: (index) => String(901 + index), crops: true }));
    while ((await server.ask("GET", `${MAP}/anchors`)).items.some(({ has_crop: has }) => has)) await new Promise((resume) => { setTimeout(resume, 100); });
    const page = await open(`${server.url}/?map=m&keyframe=robot-1-1`);
    await page.click("#details >> text=Its detections and features");
    await page.waitForSelector("#details >> text=It has no features: this map keeps them for 30 days.");
    await page.waitForSelector("#details li >> text=no picture: this map keeps none");
    await page.click("#details >> text=How to erase it for good");
    const commands = await page.locator("#details pre").allTextContents();
    assert.match(commands[0], new RegExp(`POST ${server.url}${MAP}/erase .*'{"keyframes":\\["robot-1-1"\\]}'`, "s"));
    assert.match(commands[1], /'{"sessions":\["robot-1"\]}'/);
    await page.goto(`${server.url}/?map=m&anchor=a-0`);
    await page.waitForSelector("#details >> text=No picture: this map keeps none.");
    await page.close();
    await server.stop();
  },
};
