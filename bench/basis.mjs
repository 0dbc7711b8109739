// Basis Universal to RGBA, here and by three's transcoder (WebAssembly), in one run: milliseconds, the best of several,
// one thread each, container and Zstandard included.
//
//   npm install three@0.187.0 ktx2-encoder@0.6.0      in a folder of your own
//   node bench/basis.mjs THAT_FOLDER build/release/bin/basis_time [FILE.ktx2...]
//
// Without files it encodes a picture of 2048 x 2048 as ETC1S and as UASTC, plain and under Zstandard.

import {execFileSync} from 'node:child_process';
import {mkdtempSync, readFileSync, rmSync, writeFileSync} from 'node:fs';
import {createRequire} from 'node:module';
import {tmpdir} from 'node:os';
import {basename, join, resolve} from 'node:path';
import {pathToFileURL} from 'node:url';

const packages = resolve(process.argv[2], 'node_modules');
const program = resolve(process.argv[3]);
const kRuns = 15;

async function transcoder() {
  const folder = join(packages, 'three/examples/jsm/libs/basis');
  const source = readFileSync(join(folder, 'basis_transcoder.js'), 'utf8') + ';return BASIS;';
  const require = createRequire(import.meta.url);
  const create = new Function('module', 'exports', 'require', '__dirname', source)({exports: {}}, {}, require, folder);
  const module = await create({wasmBinary: readFileSync(join(folder, 'basis_transcoder.wasm'))});
  module.initializeBasis();
  return module;
}

/** Milliseconds and texels of the largest image. */
function time_of_three(module, bytes) {
  const kRgba32 = 13;
  let best = Infinity, texels = 0;
  for (let run = 0; run < kRuns; ++run) {
    const start = performance.now();
    const file = new module.KTX2File(new Uint8Array(bytes));
    if (!file.isValid() || !file.startTranscoding()) throw new Error('not transcoded');
    const rgba = new Uint8Array(file.getImageTranscodedSizeInBytes(0, 0, 0, kRgba32));
    if (!file.transcodeImage(rgba, 0, 0, 0, kRgba32, 0, -1, -1)) throw new Error('not transcoded');
    best = Math.min(best, performance.now() - start);
    texels = rgba.length / 4;
    file.close();
    file.delete();
  }
  return {best, texels};
}

/** Slopes, waves, some noise and alpha: blocks of all kinds. */
function picture(size) {
  const data = new Uint8Array(size * size * 4);
  let state = 1;
  for (let y = 0; y < size; ++y) {
    for (let x = 0; x < size; ++x) {
      state = (Math.imul(state, 1664525) + 1013904223) >>> 0;
      const noise = (state >>> 24) / 16 - 8, at = (y * size + x) * 4;
      const wave = Math.sin(x / 17) * Math.cos(y / 23) + Math.sin((x + y) / 5) / 3;
      data[at] = Math.max(0, Math.min(255, 128 + 90 * wave + noise));
      data[at + 1] = Math.max(0, Math.min(255, 255 * x / size + noise));
      data[at + 2] = Math.max(0, Math.min(255, 255 * y / size + 40 * wave));
      data[at + 3] = (x >> 6) + (y >> 6) & 1 ? 255 : 128 + 80 * wave;
    }
  }
  return {data, width: size, height: size};
}

async function make_files(folder) {
  const core = await import(pathToFileURL(join(packages, 'ktx2-encoder/dist/encodeCore.js')));
  const {NodeBasisEncoder} = await import(pathToFileURL(join(packages, 'ktx2-encoder/dist/node/index.js')));
  const basis = await new NodeBasisEncoder().init({});
  const image = picture(2048);
  const kinds = {
    'etc1s.ktx2': {isUASTC: false, qualityLevel: 128, compressionLevel: 1},
    'uastc.ktx2': {isUASTC: true, needSupercompression: false, uastcLDRQualityLevel: 1},
    'uastc_zstd.ktx2': {isUASTC: true, needSupercompression: true, uastcLDRQualityLevel: 1},
  };
  const files = [];
  const log = console.log;
  console.log = () => {};  // the encoder is talkative
  for (const [name, options] of Object.entries(kinds)) {
    files.push(join(folder, name));
    const bytes = await core.encodeWithModule(
        basis, new Uint8Array(4), {imageDecoder: async () => image, generateMipmap: false, ...options});
    writeFileSync(files.at(-1), bytes);
  }
  console.log = log;
  return files;
}

const folder = mkdtempSync(join(tmpdir(), 'candela-basis-'));
try {
  const files = process.argv.length > 4 ? process.argv.slice(4) : await make_files(folder);
  const module = await transcoder();
  const here = execFileSync(program, files, {encoding: 'utf8'}).trim().split('\n').map(Number);
  console.log('| file | texels | here, ms | MPix/s | three, ms | MPix/s | ratio |\n|---|---|---|---|---|---|---|');
  files.forEach((file, i) => {
    const three = time_of_three(module, readFileSync(file));
    const speed = (ms) => (three.texels / ms / 1000).toFixed(0);
    console.log(`| ${basename(file)} | ${three.texels} | ${here[i].toFixed(2)} | ${speed(here[i])} | ` +
                `${three.best.toFixed(2)} | ${speed(three.best)} | ${(three.best / here[i]).toFixed(2)} |`);
  });
} finally {
  rmSync(folder, {recursive: true});
}
