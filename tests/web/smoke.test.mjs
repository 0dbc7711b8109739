// What has to be true of every build for browsers: it draws, it is turned, and whatever is wrong is one line.

import assert from "node:assert/strict";
import { after, before, test } from "node:test";

import { addViewer, openPage, shownColors, startBrowser, startServer } from "./browser.mjs";

let server;
let browser;
before(async () => {
  server = await startServer();
  browser = await startBrowser();
});
after(async () => {
  await browser?.close();
  await server?.close();
});

const empty = () => openPage(browser, `${server.url}/empty.html`);
const line = (page) => page.locator("candela-viewer").evaluate((viewer) => viewer.shadowRoot.querySelector("p").textContent);

test("web.a_model_is_drawn_and_keys_turn_it", async () => {
  const page = await empty();
  const told = await addViewer(page, { src: "/cube.gltf" });
  assert.equal(told.error, undefined, JSON.stringify(told));
  assert.equal(told.info.triangles, 12);
  const first = await shownColors(page);
  assert.ok(first.mean > 20 && first.deviation > 10, `a blank picture: ${JSON.stringify(first)}`);

  // What the frame after a key shows, which is no more than what was asked for.
  const orbitAfter = async (key) => {
    // The promise has to be there before the key is pressed.
    await page.evaluate(() => {
      const viewer = document.querySelector("candela-viewer");
      window.drawn = new Promise((resolve) => viewer.addEventListener("frame", () => resolve(viewer.cameraOrbit), { once: true }));
    });
    await page.keyboard.press(key);
    return page.evaluate(() => window.drawn);
  };
  const seen = await page.locator("candela-viewer").evaluate((viewer) => viewer.cameraOrbit);
  await page.keyboard.press("Tab"); // nothing else can have the focus
  const right = await orbitAfter("ArrowRight");
  assert.ok(right.azimuth > seen.azimuth && Math.abs(right.elevation - seen.elevation) < 1e-5, JSON.stringify([seen, right]));
  const up = await orbitAfter("ArrowUp");
  assert.ok(up.elevation > right.elevation + 0.1, JSON.stringify([right, up]));
  const near = await orbitAfter("+");
  assert.ok(near.scale < up.scale, JSON.stringify([up, near]));
  const turned = await shownColors(page);
  assert.notDeepEqual(turned, first);
  const home = await orbitAfter("Home");
  assert.ok(Math.abs(home.azimuth - seen.azimuth) < 1e-5 && home.scale === seen.scale, JSON.stringify([seen, home]));
  assert.deepEqual(page.thrown, []);
  await page.context().close();
});

test("web.a_picture_has_the_size_that_was_asked_for", async () => {
  const page = await empty();
  await addViewer(page, { src: "/cube.gltf" });
  const size = await page.locator("candela-viewer").evaluate(async (viewer) => {
    const picture = await viewer.render({ width: 96, height: 64, frames: 2 });
    return [picture.width, picture.height];
  });
  assert.deepEqual(size, [96, 64]);
  const refused = await page.locator("candela-viewer").evaluate((viewer) => viewer.render({ width: 0 }).catch((error) => error.message));
  assert.match(refused, /^render: width has to be a whole number/);
  await page.context().close();
});

for (const [law, attributes, message] of [
  ["a_missing_file", { src: "/missing.glb" }, /missing\.glb: cannot be fetched: 404/],
  ["a_broken_file", { src: "/broken.glb" }, /^broken\.glb: /],
  ["what_is_no_model", { src: "/text.glb" }, /^text\.glb: /],
  ["a_scene_that_is_not_built_in", { src: "demo:nothing" }, /nothing/],
  ["a_light_that_is_none", { env: "/text.glb", src: "/cube.gltf" }, /text\.glb/],
  ["a_word_that_is_no_exposure", { exposure: "bright", src: "/cube.gltf" }, /exposure="bright" is no positive number/],
  ["a_camera_orbit_without_units", { "camera-orbit": "45 70 2", src: "/cube.gltf" }, /camera-orbit="45 70 2"/],
  ["an_unknown_tone_curve", { tonemap: "sepia", src: "/cube.gltf" }, /sepia/],
]) {
  test(`web.${law}_is_one_line_in_the_page_and_an_error_event`, async () => {
    const page = await empty();
    const told = await addViewer(page, attributes, "error");
    const text = told.where === "" ? told.message : `${told.where}: ${told.message}`;
    assert.match(text, message);
    assert.ok(!text.includes("\n"), text);
    assert.equal(await line(page), text);
    assert.deepEqual(page.thrown, []);
    await page.context().close();
  });
}

test("web.a_file_of_two_gigabytes_is_refused_before_it_is_read", async () => {
  const page = await empty();
  const before = Date.now();
  const told = await addViewer(page, { src: "/large.glb" }, "error");
  assert.match(told.message, /2048 MiB are too many, a page reads at most 1024 MiB/);
  assert.ok(Date.now() - before < 60_000);
  await page.context().close();
});

test("web.what_was_shown_stays_when_another_file_is_broken", async () => {
  const page = await empty();
  await addViewer(page, { src: "/cube.gltf" });
  const message = await page.locator("candela-viewer").evaluate((viewer) => viewer.load("/broken.glb").catch((error) => error.message));
  assert.match(message, /^broken\.glb: /);
  const triangles = await page.locator("candela-viewer").evaluate((viewer) => viewer.info.triangles);
  assert.equal(triangles, 12);
  await page.context().close();
});

test("web.a_lost_context_comes_back_with_the_picture", async () => {
  const page = await empty();
  await addViewer(page, { src: "/cube.gltf" });
  const { mean } = await shownColors(page);
  await page.locator("candela-viewer").evaluate(
    (viewer) =>
      new Promise((resolve) => {
        viewer.addEventListener("contextrestored", () => viewer.addEventListener("frame", resolve, { once: true }), { once: true });
        void viewer.loseContext();
      }),
  );
  const again = await shownColors(page);
  assert.ok(Math.abs(again.mean - mean) < 2, `${mean} became ${again.mean}`);
  assert.deepEqual(page.thrown, []);
  await page.context().close();
});
