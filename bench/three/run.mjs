#!/usr/bin/env node
// How long three.js takes for a frame in headless Chromium without a GPU, on the view of
// `candela render MODEL.glb --env ENV.hdr --eye EYE --target 0,0,0 --fov 45deg`.
//
//     cd bench/three && npm install && node run.mjs MODEL.glb ENV.hdr [EYE] [WxH] [CHROMIUM]
//
// Prints the median of ten frames, each read back, without and with multisampling.
import http from "node:http";
import fs from "node:fs";
import path from "node:path";
import puppeteer from "puppeteer-core";

const [model, env, eye = "1,0.66,1.5", size = "1280x720", chromium = "/usr/bin/chromium"] = process.argv.slice(2);
if (!env) {
  console.error("usage: node run.mjs MODEL.glb ENV.hdr [EYE] [WxH] [CHROMIUM]");
  process.exit(2);
}
const [width, height] = size.split("x").map(Number);
const here = path.dirname(new URL(import.meta.url).pathname);

const page = (antialias) => `<!doctype html><meta charset="utf-8"><body style="margin:0"><script type="importmap">
{"imports": {"three": "/three/build/three.module.js", "three/addons/": "/three/examples/jsm/"}}</script>
<script type="module">
import * as THREE from "three";
import { GLTFLoader } from "three/addons/loaders/GLTFLoader.js";
import { RGBELoader } from "three/addons/loaders/RGBELoader.js";
const start = performance.now();
const renderer = new THREE.WebGLRenderer({ antialias: ${antialias}, preserveDrawingBuffer: true });
renderer.setSize(${width}, ${height});
renderer.toneMapping = THREE.NeutralToneMapping;
document.body.appendChild(renderer.domElement);
const scene = new THREE.Scene();
const hdr = await new RGBELoader().loadAsync("/env");
hdr.mapping = THREE.EquirectangularReflectionMapping;
scene.background = scene.environment = hdr;
scene.add((await new GLTFLoader().loadAsync("/model")).scene);
const camera = new THREE.PerspectiveCamera(45, ${width} / ${height}, 0.01, 100);
camera.position.set(${eye});
camera.lookAt(0, 0, 0);
const gl = renderer.getContext(), pixel = new Uint8Array(4);
const frame = () => {
  const t = performance.now();
  renderer.render(scene, camera);
  gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, pixel);
  return performance.now() - t;
};
frame();
const first = performance.now() - start;
const times = [];
for (let i = 0; i < 10; ++i) times.push(frame());
times.sort((x, y) => x - y);
window.result = { first, frame: times[5], name: gl.getParameter(gl.RENDERER) };
</script>`;

const send = (response, type, body) => response.writeHead(200, { "content-type": type }).end(body);
const server = http.createServer((request, response) => {
  if (request.url.startsWith("/page")) return send(response, "text/html", page(request.url.endsWith("aa")));
  if (request.url === "/model") return send(response, "model/gltf-binary", fs.readFileSync(model));
  if (request.url === "/env") return send(response, "application/octet-stream", fs.readFileSync(env));
  const file = path.join(here, "node_modules", path.normalize(request.url.split("?")[0]));
  if (!fs.existsSync(file)) return response.writeHead(404).end();
  send(response, "text/javascript", fs.readFileSync(file));
});
await new Promise((resolve) => server.listen(0, "127.0.0.1", resolve));
const address = `http://127.0.0.1:${server.address().port}`;
const browser = await puppeteer.launch({
  executablePath: chromium,
  args: ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", `--window-size=${width},${height + 100}`],
});
for (const kind of ["plain", "aa"]) {
  const tab = await browser.newPage();
  await tab.setViewport({ width, height });
  tab.on("pageerror", (error) => console.error(String(error)));
  await tab.goto(`${address}/page-${kind}`);
  await tab.waitForFunction("window.result", { timeout: 300000 });
  const { first, frame, name } = await tab.evaluate("window.result");
  console.log(`three.js ${kind === "aa" ? "multisampled" : "one sample"}: ${frame.toFixed(0)} ms per frame, first after ${(first / 1000).toFixed(1)} s (${name})`);
  if (process.env.SCREENSHOT) await tab.screenshot({ path: `${process.env.SCREENSHOT}-${kind}.png` });
  await tab.close();
}
await browser.close();
server.close();
