// A page with the element in headless Chromium, from a server of this process.
//
// Of the environment: CANDELA_SITE, the folder that `./dev web` makes; CANDELA_ASSETS, that of the models; CANDELA_MODULES, a
// node_modules with playwright-core; CANDELA_CHROMIUM, the browser.

import { createReadStream } from "node:fs";
import { stat } from "node:fs/promises";
import { createServer } from "node:http";
import { createRequire } from "node:module";
import path from "node:path";

const site = process.env.CANDELA_SITE;
export const assets = process.env.CANDELA_ASSETS ?? "";
const { chromium } = createRequire(path.join(process.env.CANDELA_MODULES, "x.js"))("playwright-core");

const kTypes = { ".html": "text/html", ".js": "text/javascript", ".css": "text/css", ".wasm": "application/wasm", ".json": "application/json" };

const kEmpty = `<!doctype html><html lang="en"><title>test</title><body style="margin:0"><script type="module" src="/viewer.js"></script></body>`;

/** A cube with one red, one green and one blue pair of sides, its numbers in a file beside it. */
const kCube = (() => {
  const positions = [];
  const indices = [[], [], []];
  for (let axis = 0; axis < 3; ++axis) {
    for (const side of [-1, 1]) {
      const first = positions.length / 3;
      for (const [a, b] of [[-1, -1], [1, -1], [1, 1], [-1, 1]]) {
        const corner = [0, 0, 0];
        corner[axis] = side;
        corner[(axis + 1) % 3] = a * side;
        corner[(axis + 2) % 3] = b;
        positions.push(...corner);
      }
      indices[axis].push(...[0, 1, 2, 0, 2, 3].map((i) => first + i));
    }
  }
  const numbers = Buffer.concat([Buffer.from(new Float32Array(positions).buffer), Buffer.from(new Uint16Array(indices.flat()).buffer)]);
  const bytes = positions.length * 4;
  const accessors = [{ bufferView: 0, componentType: 5126, count: 24, type: "VEC3", min: [-1, -1, -1], max: [1, 1, 1] }];
  for (let axis = 0; axis < 3; ++axis) accessors.push({ bufferView: 1, byteOffset: axis * 24, componentType: 5123, count: 12, type: "SCALAR" });
  const document = {
    asset: { version: "2.0" },
    scenes: [{ nodes: [0] }],
    nodes: [{ mesh: 0 }],
    meshes: [{ primitives: [0, 1, 2].map((axis) => ({ attributes: { POSITION: 0 }, indices: axis + 1, material: axis })) }],
    materials: [0, 1, 2].map((axis) => ({ pbrMetallicRoughness: { metallicFactor: 0, baseColorFactor: [...[0, 1, 2].map((c) => (c === axis ? 0.7 : 0.05)), 1] } })),
    accessors,
    bufferViews: [{ buffer: 0, byteLength: bytes }, { buffer: 0, byteOffset: bytes, byteLength: numbers.length - bytes }],
    buffers: [{ uri: "cube%20numbers.bin", byteLength: numbers.length }],
  };
  return { document: JSON.stringify(document), numbers };
})();

/** Answers that no file gives. */
const kMade = {
  "/cube.gltf": (response) => response.writeHead(200).end(kCube.document),
  "/cube numbers.bin": (response) => response.writeHead(200).end(kCube.numbers),
  "/empty.html": (response) => response.writeHead(200, { "content-type": "text/html" }).end(kEmpty),
  "/broken.glb": (response) => response.writeHead(200).end(Buffer.from("glTF\u0002\0\0\0\u0040\0\0\0 no chunk")),
  "/text.glb": (response) => response.writeHead(200).end("this is no model"),
  // Says that it is large, and sends little of it.
  "/large.glb": (response) => {
    response.writeHead(200, { "content-length": String(2 ** 31) });
    response.write(Buffer.alloc(65536));
  },
};

export async function startServer() {
  const counts = new Map();
  const server = createServer(async (request, response) => {
    const name = decodeURIComponent(new URL(request.url, "http://localhost").pathname);
    counts.set(name, (counts.get(name) ?? 0) + 1);
    if (Object.hasOwn(kMade, name)) return void kMade[name](response);
    const [root, rest] = name.startsWith("/assets/") ? [assets, name.slice("/assets".length)] : [site, name === "/" ? "/index.html" : name];
    const file = path.join(root, path.normalize(rest));
    try {
      const { size } = await stat(file);
      response.writeHead(200, { "content-type": kTypes[path.extname(file)] ?? "application/octet-stream", "content-length": size });
      createReadStream(file).pipe(response);
    } catch {
      response.writeHead(404).end();
    }
  });
  await new Promise((resolve) => server.listen(0, "127.0.0.1", resolve));
  const { port } = server.address();
  return { url: `http://127.0.0.1:${port}`, counts, close: () => new Promise((resolve) => (server.closeAllConnections(), server.close(resolve))) };
}

/** WebGL by SwiftShader: on a processor, the same everywhere. */
export function startBrowser() {
  return chromium.launch({
    executablePath: process.env.CANDELA_CHROMIUM,
    args: ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist"],
  });
}

/** A page that fails the test when something is thrown into it. */
export async function openPage(browser, url, options = {}) {
  const context = await browser.newContext(options);
  const page = await context.newPage();
  page.setDefaultTimeout(120_000);
  page.thrown = [];
  page.on("pageerror", (error) => page.thrown.push(String(error)));
  await page.goto(url);
  return page;
}

/** An element in an empty page, once it has said `event`; returns what the event told. */
export async function addViewer(page, attributes, event = "load") {
  return page.evaluate(
    ({ attributes, event }) =>
      new Promise((resolve) => {
        const viewer = document.createElement("candela-viewer");
        for (const [name, value] of Object.entries(attributes)) viewer.setAttribute(name, value);
        viewer.style.cssText = "width:256px;height:256px";
        viewer.addEventListener(event, ({ detail }) => resolve(detail));
        viewer.addEventListener("error", ({ detail }) => resolve({ error: detail }));
        document.body.replaceChildren(viewer);
      }),
    { attributes, event },
  );
}

/** What the element shows, as numbers: mean and spread of its colours. */
export async function shownColors(page) {
  const png = await page.locator("candela-viewer").screenshot();
  return page.evaluate(async (bytes) => {
    const picture = await createImageBitmap(new Blob([new Uint8Array(bytes)], { type: "image/png" }));
    const canvas = new OffscreenCanvas(picture.width, picture.height);
    const context = canvas.getContext("2d");
    context.drawImage(picture, 0, 0);
    const { data } = context.getImageData(0, 0, picture.width, picture.height);
    let sum = 0;
    let squares = 0;
    for (let i = 0; i < data.length; i += 4) {
      const value = (data[i] + data[i + 1] + data[i + 2]) / 3;
      sum += value;
      squares += value * value;
    }
    const count = data.length / 4;
    return { mean: sum / count, deviation: Math.sqrt(Math.max(0, squares / count - (sum / count) ** 2)) };
  }, [...png]);
}
