// Pictures of the page and of the native rasterizer, from the same sources and the same view. CANDELA_PROGRAM is the program.

import assert from "node:assert/strict";
import { execFile } from "node:child_process";
import { existsSync } from "node:fs";
import { mkdtemp, readdir, rm, writeFile } from "node:fs/promises";
import os from "node:os";
import path from "node:path";
import { after, before, test } from "node:test";
import { promisify } from "node:util";

import { addViewer, assets, openPage, startBrowser, startServer } from "./browser.mjs";

const run = promisify(execFile);
const program = process.env.CANDELA_PROGRAM;
const size = 256;
const frames = 16;
/** Drivers round, sample edges and filter textures each in their own way: Mesa's llvmpipe there, SwiftShader here. */
const kMostFlip = 0.02;

/** The first .glb or .gltf of each model's folder. */
async function modelsOf(folder) {
  const models = [];
  for (const name of (await readdir(folder)).sort()) {
    for (const kind of ["glTF-Binary", "glTF", "."]) {
      const inner = path.join(folder, name, kind);
      const file = existsSync(inner) ? (await readdir(inner)).find((one) => /\.(glb|gltf)$/.test(one)) : undefined;
      if (file === undefined) continue;
      models.push(path.join(name, kind, file));
      break;
    }
  }
  return models;
}

const wanted = process.env.CANDELA_MODELS?.split(",");
const models = assets !== "" && existsSync(path.join(assets, "models")) ? await modelsOf(path.join(assets, "models")) : [];

let server;
let browser;
let folder;
before(async () => {
  server = await startServer();
  browser = await startBrowser();
  folder = await mkdtemp(path.join(os.tmpdir(), "candela-web-"));
});
after(async () => {
  await browser?.close();
  await server?.close();
  if (folder !== undefined) await rm(folder, { recursive: true });
});

if (models.length === 0) test("web.pictures_are_those_of_the_native_rasterizer", { skip: "CANDELA_ASSETS has no models" }, () => {});

for (const model of models) {
  const name = model.split(path.sep)[0];
  if (wanted !== undefined && !wanted.includes(name)) continue;
  test(`web.the_picture_is_that_of_the_native_rasterizer.${name}`, async (t) => {
    const page = await openPage(browser, `${server.url}/empty.html`);
    try {
      const src = `/assets/models/${model.split(path.sep).map(encodeURIComponent).join("/")}`;
      const told = await addViewer(page, { src, exposure: "1" });
      assert.equal(told.error, undefined, JSON.stringify(told.error));
      const png = await page.locator("candela-viewer").evaluate(async (viewer, { size, frames }) => {
        const picture = await viewer.render({ width: size, height: size, frames });
        const canvas = document.createElement("canvas");
        canvas.width = canvas.height = size;
        canvas.getContext("bitmaprenderer").transferFromImageBitmap(picture);
        const blob = await new Promise((resolve) => canvas.toBlob(resolve, "image/png"));
        return [...new Uint8Array(await blob.arrayBuffer())];
      }, { size, frames });
      const shown = path.join(folder, `${name}-page.png`);
      const native = path.join(folder, `${name}-native.png`);
      await writeFile(shown, Buffer.from(png));
      await run(program, ["render", path.join(assets, "models", model), "-o", native, "--engine", "raster", "--size", `${size}x${size}`, "--spp", String(frames), "--exposure", "0", "-q"]);
      const { stdout } = await run(program, ["diff", native, shown, "--json", "-q"]);
      const { flip } = JSON.parse(stdout).pairs[0];
      t.diagnostic(`FLIP ${flip.toFixed(4)} ${name}`);
      if (process.env.CANDELA_KEEP) await run("cp", [shown, native, process.env.CANDELA_KEEP]);
      assert.ok(flip <= kMostFlip, `FLIP ${flip} of ${name}`);
      assert.deepEqual(page.thrown, []);
    } finally {
      await page.context().close();
    }
  });
}
