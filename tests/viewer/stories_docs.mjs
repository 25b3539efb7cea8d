// Docs: the reference beside the viewer.

import assert from "node:assert/strict";
import { open, serve } from "./browser.mjs";
import { drive } from "./world.mjs";

/** Runs an example, which may ask once more before it writes, and gives its answer. */
async function run(page, id) {
  await page.click(`#${id} .run >> text="Run"`);
  const again = page.locator(`#${id} .run >> text="Run it"`);
  if (await again.count() > 0) await again.click();
  await page.waitForSelector(`#${id} .result .status`);
  return page.textContent(`#${id} .result`);
}

export const docs = {
  async "the examples of the reference run where they stand, ask before they write, and wait for a key"() {
    const server = await serve("docs");
    const page = await open(`${server.url}/docs`, { expected: /401/ });
    await page.waitForSelector("#start_ask .run");
    await page.click('#start_map .run >> text="Run"');
    assert.match(await page.textContent("#start_map .run"), /It writes to this server/);
    await page.click('#start_map .run >> text="Leave it"');
    assert.deepEqual((await server.ask("GET", "/v1/maps")).items, []);
    for (const call of ["start_map", "start_keyframe"]) assert.match(await run(page, call), /^201/);
    assert.match(await run(page, "start_ask"), /"verdict": "loop"/);
    // What an earlier answer says goes into the next request.
    await server.ask("PUT", "/v1/maps/tower", {});
    const [{ body }] = drive("robot-1", { steps: 1, reads: (index) => String(901 + index) });
    await server.ask("PUT", "/v1/maps/tower/keyframes/kf-120", body);
    assert.match(await run(page, "get_loop_query"), /^200.*"keyframe": "kf-120"/s);
    // A stream is read for a moment.
    assert.match(await run(page, "listen"), /^200.*keyframe_stored.*the stream goes on/s);
    const { secret } = await server.ask("POST", "/v1/keys", { name: "page", actions: ["read", "admin"], maps: ["*"] });
    await page.click('#list_maps .run >> text="Run"');
    await page.fill("#list_maps .result input", secret);
    await page.keyboard.press("Enter");
    await page.waitForSelector('#list_maps .result >> text=/"id": "hotel"/');
    await page.close();
    await server.stop();
  },
};
