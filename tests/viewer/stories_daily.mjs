// Daily: a keyframe, a loop, a key, a server that goes away, and a large map.

import assert from "node:assert/strict";
import { open, serve } from "./browser.mjs";
import { drive, tower } from "./world.mjs";

const MANY = 10_000;

function keyframe(session, number, text) {
  return {
    session, stamp: { sec: number, nanosec: 0 }, bow: { words: [number % 7, 10 + number % 5], weights: [0.5, 0.5] },
    pose: { translation: { x: (number % 100) * 0.5, y: Math.floor(number / 100) * 0.5, z: 0 }, rotation: { x: 0, y: 0, z: 0, w: 1 } },
    detections: text ? [{ class: "door_number", confidence: 0.9, box: [0, 0, 20, 10], text, position: [(number % 100) * 0.5, Math.floor(number / 100) * 0.5, 2] }] : [],
  };
}

/** What a mapper does from day to day. */
export const daily = {
  async "a keyframe is found, selected and shown, and names are in the order of their numbers"() {
    const server = await serve("select");
    await server.ask("PUT", "/v1/maps/m", {});
    for (const number of [10, 2, 1]) await server.ask("PUT", `/v1/maps/m/keyframes/kf-${number}`, keyframe("robot-1", number, `90${number}`));
    const page = await open(`${server.url}/?map=m`);
    await page.click("#tab-keyframes");
    await page.waitForSelector("#keyframes .ref");
    assert.deepEqual(await page.locator("#keyframes .ref").allTextContents(), ["kf-1", "kf-2", "kf-10"]);
    await page.click("#keyframes .ref >> text=kf-10");
    await page.waitForSelector("#details:not([hidden]) >> text=kf-10");
    assert.match(page.url(), /keyframe=kf-10/);
    // By the keyboard alone: the next one.
    await page.focus("#canvas");
    await page.keyboard.press("n");
    await page.waitForFunction(() => !location.search.includes("kf-10"));
    await page.close();
    await server.stop();
  },

  async "a loop appears by itself, is revoked from the page after a second question, and is gone"() {
    const server = await serve("revoke");
    await server.ask("PUT", "/v1/maps/m", {});
    await server.ask("PUT", "/v1/maps/m/keyframes/a", keyframe("robot-1", 1, "901"));
    await server.ask("PUT", "/v1/maps/m/keyframes/b", keyframe("robot-2", 2, "901"));
    const page = await open(`${server.url}/?map=m`, { scheme: "dark" });
    await page.waitForSelector("#live[data-state=live]");
    await server.ask("POST", "/v1/maps/m/loops", { id: "loop-1", keyframe: "b", candidate: "a" });
    await page.waitForFunction(() => document.getElementById("tab-loops").textContent === "Loops 1");
    await page.click("#tab-loops");
    await page.click("#loops >> text=Revoke…");
    assert.match(await page.textContent("#loops"), /1 pair of anchors parts? again|No anchors part/);
    await page.click("#loops >> text=Keep it");
    assert.equal((await server.ask("GET", "/v1/maps/m/loops")).items.length, 1);
    await page.click("#loops >> text=Revoke…");
    await page.click("#loops >> text=Revoke the loop");
    await page.waitForFunction(() => document.getElementById("tab-loops").textContent === "Loops");
    assert.equal((await server.ask("GET", "/v1/maps/m/loops")).items.length, 0);
    await page.close();
    await server.stop();
  },

  async "a server that wants a key asks for it, refuses a wrong one in place, and shows the map with the right one"() {
    const server = await serve("key");
    await server.ask("PUT", "/v1/maps/m", {});
    await server.ask("PUT", "/v1/maps/m/keyframes/a", keyframe("robot-1", 1, "901"));
    const { secret } = await server.ask("POST", "/v1/keys", { name: "page", actions: ["read", "admin"], maps: ["*"] });
    const page = await open(`${server.url}/?map=m`, { expected: /401/ });
    await page.waitForSelector("#empty form");
    // What this is, and where to read on, needs no key.
    assert.match(await page.textContent("#empty"), /maps of robots.*API reference/s);
    assert.equal(await page.getAttribute("#empty a", "href"), "docs");
    assert.equal((await fetch(`${server.url}/docs`)).status, 200);
    await page.fill("#empty input", "revisit_nonsense");
    await page.keyboard.press("Enter");
    assert.match(await page.textContent("#empty [role=alert]"), /does not open it/);
    // The keyboard is still in the field.
    await page.waitForFunction(() => document.activeElement?.matches("#empty input[aria-invalid=true]"));
    await page.keyboard.type(secret);
    await page.keyboard.press("Enter");
    await page.waitForFunction(() => document.getElementById("figures").textContent.includes("1 keyframe"));
    await page.close();
    await server.stop();
  },

  async "a loop that was found is confirmed from the page, and only by a key that may write"() {
    const server = await tower(await serve("confirm"));
    const page = await open(`${server.url}/?map=tower&keyframe=robot-2-1`, { expected: /40[13]/ });
    await page.click("text=Is it a loop?");
    await page.click("text=Confirm the loop");
    await page.waitForSelector("#details >> text=/Confirmed as loop-q-/");
    await page.waitForFunction(() => document.getElementById("tab-loops").textContent === "Loops 1");
    const { items: [{ id, keyframe, candidate }] } = await server.ask("GET", "/v1/maps/tower/loops");
    assert.equal(keyframe, "robot-2-1");
    await page.click("#tab-loops");
    await page.click("#loop-list >> text=why");
    await page.waitForSelector("#details >> text=/Confirmed as loop-q-.*The tab Loops revokes it/");
    assert.ok(candidate.startsWith("robot-1"));
    await server.ask("DELETE", `/v1/maps/tower/loops/${id}`);
    const { secret } = await server.ask("POST", "/v1/keys", { name: "reader", actions: ["read", "query", "admin"], maps: ["*"] });
    await page.evaluate((key) => sessionStorage.setItem("revisit.key", key), secret);
    await page.goto(`${server.url}/?map=tower&keyframe=robot-2-1`);
    await page.click("text=Is it a loop?");
    await page.waitForSelector("#details >> text=A verdict is not yet a closed loop");
    await page.waitForTimeout(300);
    assert.equal(await page.locator("text=Confirm the loop").count(), 0);
    await page.close();
    await server.stop();
  },

  async "a loop says which signs join the two passages, how far apart they are and when they were; an assumed distance looks assumed"() {
    const server = await serve("joined");
    await server.ask("PUT", "/v1/maps/m", {});
    const seen = (sec, x, more) => {
      const one = keyframe("robot-1", 1, "901");
      const pose = { ...one.pose, translation: { x, y: 0, z: 0 } };
      return { ...one, pose, stamp: { sec, nanosec: 0 }, detections: [{ ...one.detections[0], position: [x, 0, 2], ...more }] };
    };
    await server.ask("PUT", "/v1/maps/m/keyframes/a", seen(1_795_000_000, 0, {}));
    await server.ask("PUT", "/v1/maps/m/keyframes/b", seen(1_795_003_725, 3, { range: "assumed" }));
    await server.ask("PUT", "/v1/maps/m/keyframes/c", { ...seen(1_795_003_800, 4, {}), detections: [] });
    await server.ask("POST", "/v1/maps/m/loops", { id: "loop-1", keyframe: "b", candidate: "a" });
    await server.ask("POST", "/v1/maps/m/loops", { id: "loop-2", keyframe: "c", candidate: "a" });
    const page = await open(`${server.url}/?map=m`);
    await page.waitForSelector("#live[data-state=live]");
    await page.click("#tab-loops");
    const [first, second] = await page.locator("#loop-list li").allTextContents();
    assert.match(await page.textContent("#legend"), /distance assumed 1/);
    assert.match(first, /^b back at a.*joined by 901.*3 m apart on the map, 1 hour 2 minutes between them, the later at 2026-11-18 /s);
    assert.match(second, /^c back at a.*no sign that both see joins them/s);
    await page.click("#loop-list .ref >> nth=0");
    await page.click("text=Its detections and features");
    assert.equal(await page.textContent("#details .assumed"), "about 2 m away, assumed");
    await page.close();
    await server.stop();
  },

  async "a key that may ask twice a second opens the page, which asks for little and waits where it is told to"() {
    const server = await tower(await serve("slow"));
    await server.ask("POST", "/v1/maps/tower/loops", { id: "loop-1", keyframe: "robot-2-1", candidate: "robot-1-1" });
    const { secret } = await server.ask("POST", "/v1/keys", { name: "page", actions: ["read", "query", "admin"], maps: ["*"], rate_per_s: 2 });
    const page = await open(`${server.url}/docs`, { expected: /401|429/ });
    await page.waitForSelector("#calls .call");
    await page.evaluate((key) => sessionStorage.setItem("revisit.key", key), secret);
    const asked = new Set();
    const answers = [];
    page.on("request", (request) => request.url().includes("/v1/") && asked.add(request.url()));
    page.on("response", (response) => response.url().includes("/v1/") && answers.push(response.status()));
    await page.goto(`${server.url}/?map=tower&keyframe=robot-2-1`);
    await page.waitForSelector("#live[data-state=live]");
    assert.match(await page.textContent("#figures"), /21 keyframes.*1 loop/s);
    // Seven for the map, and two for the keyframe; the pictures of its signs come as they are seen.
    const needed = [...asked].filter((url) => !url.endsWith("/crop"));
    assert.ok(needed.length <= 9, needed.join());
    await page.waitForSelector("#details table");
    await page.click("text=Is it a loop?");
    await page.waitForSelector(".candidates");
    assert.ok(answers.includes(429), `${answers}`);
    assert.equal(await page.locator(".fault:visible").count(), 0);
    await page.close();
    await server.stop();
  },

  async "where a keyframe of the map stands is asked in the words of the map's vocabulary"() {
    const server = await serve("where");
    await server.ask("PUT", "/v1/maps/m", {});
    const worded = ({ id, body }) => ({ id, body: { ...body, bow: { ...body.bow, vocabulary: "orb-1" } } });
    for (const robot of ["robot-1", "robot-2"]) await server.send("m", drive(robot, { reads: () => null }).map(worded));
    const page = await open(`${server.url}/?map=m&keyframe=robot-2-1`);
    await page.click("text=Where am I?");
    await page.waitForSelector("#where .verdict");
    assert.match(await page.locator("#where .candidate").first().textContent(), /1\. robot-1-1/);
    assert.doesNotMatch(await page.textContent("#where"), /another vocabulary/);
    await page.close();
    await server.stop();
  },

  async "a server without a map is connected, and says how to make one"() {
    const server = await serve("none");
    const page = await open(server.url, { expected: /401/ });
    await page.waitForSelector("#empty >> text=No maps yet");
    assert.equal(await page.textContent("#live"), "connected");
    await server.ask("PUT", "/v1/maps/m", {});
    await page.waitForSelector("#live >> text=live");
    // One that has maps, and none for this key.
    await server.ask("POST", "/v1/keys", { name: "all", actions: ["read", "admin"], maps: ["*"] }).then(async ({ secret }) => {
      const headers = { "content-type": "application/json", authorization: `Bearer ${secret}` };
      const body = JSON.stringify({ name: "few", actions: ["read"], maps: ["hotel-*"] });
      const few = await (await fetch(`${server.url}/v1/keys`, { method: "POST", headers, body })).json();
      await page.evaluate((key) => sessionStorage.setItem("revisit.key", key), few.secret);
    });
    await page.goto(server.url);
    await page.waitForSelector("#empty >> text=This key covers maps named hotel-*");
    await page.close();
    await server.stop();
  },

  async "a server that goes away is said, and what was read stays"() {
    const server = await serve("gone");
    await server.ask("PUT", "/v1/maps/m", {});
    await server.ask("PUT", "/v1/maps/m/keyframes/a", keyframe("robot-1", 1, "901"));
    const page = await open(`${server.url}/?map=m`, { expected: /ERR_|Failed to load/ });
    await page.waitForSelector("#live[data-state=live]");
    await server.stop();
    await page.waitForSelector("#live[data-state=away]", { timeout: 60_000 });
    assert.match(await page.textContent("#figures"), /1 keyframe/);
    await page.close();
  },

  async "ten thousand keyframes"() {
    const server = await serve("many");
    await server.ask("PUT", "/v1/maps/m", {});
    const robot = (number) => `robot-${Math.floor(number / 2500)}`;
    await server.send("m", Array.from({ length: MANY }, (_, number) => ({ id: `kf-${number}`, body: keyframe(robot(number), number) })));
    const begun = Date.now();
    const page = await open(`${server.url}/?map=m`);
    await page.waitForFunction((many) => document.getElementById("figures").textContent.replace(/\D*keyframe.*/s, "").replace(/\D/g, "") === String(many), MANY, { timeout: 60_000 });
    const shown = Date.now() - begun;
    const { frames, long } = await page.evaluate(async () => {
      let long = 0;
      new PerformanceObserver((list) => { long += list.getEntries().length; }).observe({ type: "longtask" });
      const canvas = document.getElementById("canvas");
      canvas.focus();
      let frames = 0;
      const until = performance.now() + 3000;
      while (performance.now() < until) {
        canvas.dispatchEvent(new KeyboardEvent("keydown", { key: frames % 2 ? "ArrowLeft" : "ArrowRight", shiftKey: true, bubbles: true }));
        await new Promise(requestAnimationFrame);
        frames += 1;
      }
      return { frames, long };
    });
    console.log(`   ${MANY} keyframes: shown after ${shown} ms, ${(frames / 3).toFixed(0)} frames a second while panning, ${long} long tasks in 3 s`);
    await page.close();
    await server.stop();
  },
};
