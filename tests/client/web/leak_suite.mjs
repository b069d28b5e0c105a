// What a long visit leaves behind: nothing.

import assert from "node:assert/strict";
import { describe, it } from "node:test";

import { openTorus } from "./support/shared_server.mjs";

const updates = 500;
const fewListeners = 20; // rows of the list of sessions change now and then
const fewPrograms = 16; // a handful of materials, with and without what some views need (ends of discs, quick pictures)
const maxGrowth = 2 << 20; // bytes of JavaScript's heap; statistics keep some history

/// So many views, one degree apart, each awaited.
const orbit = async (c, count) => {
  const frame = () => new Promise(requestAnimationFrame);
  const { eye, ...rest } = c.view.camera;
  const target = rest.target;
  const [x, z] = [eye[0] - target[0], eye[2] - target[2]];
  for (let i = 1; i <= count; ++i) {
    const angle = (i * Math.PI) / 180;
    const look = c.look;
    c.view.camera = {
      ...rest,
      eye: [target[0] + x * Math.cos(angle) - z * Math.sin(angle), eye[1], target[2] + x * Math.sin(angle) + z * Math.cos(angle)],
    };
    while (c.look === look || c.statistics.last.sequence !== c.look) await frame();
  }
  c.view.camera = { ...rest, eye };
};

/// What there is after a garbage collection, once a picture has been drawn. Programs are made when a view first needs them, and kept.
async function inventory(page, session) {
  await page.settled();
  await page.evaluate(({ view }) => view.screenshot().then(() => {}));
  await session.send("HeapProfiler.collectGarbage");
  const { metrics } = await session.send("Performance.getMetrics");
  const metric = (name) => metrics.find((each) => each.name === name).value;
  const { programs, ...drawing } = await page.evaluate(({ view }) => view.resources);
  return { heap: metric("JSHeapUsedSize"), listeners: metric("JSEventListeners"), drawing, programs };
}

describe("a long visit", () => {
  it("leaves no buffers, listeners and memory behind", async () => {
    const torus = await openTorus("points=1000", { viewport: { width: 200, height: 150 } });
    const session = await torus.context.newCDPSession(torus.page);
    await session.send("Performance.enable");
    const toggleSplit = async () => {
      await torus.page.keyboard.press("v");
      await torus.until((c) => c.uniformStore !== null && c.uniformStore.count === c.store.count);
      await torus.page.keyboard.press("v");
      await torus.until((c) => c.uniformStore === null);
    };
    const toggleWireframe = async () => {
      await torus.page.keyboard.press("t");
      await torus.until((c) => c.mesh !== null && c.isMeshCurrent);
      await torus.page.keyboard.press("t");
      await torus.until((c) => c.mesh === null);
    };
    await toggleSplit();
    await toggleWireframe();
    await torus.evaluate(orbit, 60);
    const before = await inventory(torus, session);
    await torus.evaluate(orbit, updates);
    for (let i = 0; i < 5; ++i) await toggleSplit();
    for (let i = 0; i < 5; ++i) await toggleWireframe();
    const after = await inventory(torus, session);
    assert.deepEqual(after.drawing, before.drawing);
    assert.ok(after.programs <= fewPrograms, `${after.programs} programs`);
    assert.ok(after.listeners < before.listeners + fewListeners, `${after.listeners} listeners, ${before.listeners} before`);
    assert.ok(after.heap - before.heap < maxGrowth, `${updates} views have left ${after.heap - before.heap} bytes behind`);
    assert.ok((await torus.evaluate((c) => c.statistics.frames)) > updates);
    assert.equal(await torus.evaluate((c) => c.store.count), 1000);
    await torus.close();
  });
});
