// Makes the .ktx2 files beside this script, and what they must decode to: expected.txt, a line for each image of each
// file with the hash (FNV-1a, 64 bits) of its RGBA texels as three's Basis transcoder has them, and a line for each mode
// of UASTC with that of random blocks, which the test makes by itself.
//
//   npm install three@0.187.0 ktx2-encoder@0.6.0      in a folder of your own
//   node make_fixtures.mjs THAT_FOLDER
//   node make_fixtures.mjs THAT_FOLDER FILE...        only prints the lines of these files

import {createRequire} from 'node:module';
import {readFileSync, writeFileSync} from 'node:fs';
import {basename, dirname, join, resolve} from 'node:path';
import {fileURLToPath, pathToFileURL} from 'node:url';

const packages = resolve(process.argv[2], 'node_modules');
const here = dirname(fileURLToPath(import.meta.url));

// ----- the oracle

async function transcoder() {
  const folder = join(packages, 'three/examples/jsm/libs/basis');
  const source = readFileSync(join(folder, 'basis_transcoder.js'), 'utf8') + ';return BASIS;';
  const require = createRequire(import.meta.url);
  const create = new Function('module', 'exports', 'require', '__dirname', source)({exports: {}}, {}, require, folder);
  const module = await create({wasmBinary: readFileSync(join(folder, 'basis_transcoder.wasm'))});
  module.initializeBasis();
  return module;
}

function hash(bytes) {
  let h = 0xcbf29ce484222325n;
  for (const byte of bytes) h = ((h ^ BigInt(byte)) * 0x100000001b3n) & 0xffffffffffffffffn;
  return h.toString(16).padStart(16, '0');
}

/** Images of a file: {level, face, width, height, rgba}. */
function transcode(module, bytes) {
  const kRgba32 = 13;
  const file = new module.KTX2File(new Uint8Array(bytes));
  if (!file.isValid() || !file.startTranscoding()) throw new Error('not transcoded');
  const images = [];
  for (let level = 0; level < file.getLevels(); ++level) {
    for (let face = 0; face < file.getFaces(); ++face) {
      const info = file.getImageLevelInfo(level, 0, face);
      const rgba = new Uint8Array(file.getImageTranscodedSizeInBytes(level, 0, face, kRgba32));
      if (!file.transcodeImage(rgba, level, 0, face, kRgba32, 0, -1, -1)) throw new Error('not transcoded');
      images.push({level, face, width: info.origWidth, height: info.origHeight, rgba});
    }
  }
  file.close();
  file.delete();
  return images;
}

function lines_of(module, name, bytes) {
  return transcode(module, bytes).map((i) => `${name} ${i.level} ${i.face} ${i.width} ${i.height} ${hash(i.rgba)}`);
}

// ----- pictures

/** xorshift32, as in the test. */
function random(seed) {
  let state = seed;
  return () => {
    state ^= state << 13;
    state ^= state >>> 17;
    state ^= state << 5;
    return state >>> 0;
  };
}

/** Slopes with noise: all kinds of blocks. `alpha`, `grey` and `noise` as they say. */
function picture(width, height, {alpha = false, grey = false, noise = 40, seed = 1} = {}) {
  const next = random(seed);
  const data = new Uint8Array(width * height * 4);
  for (let y = 0; y < height; ++y) {
    for (let x = 0; x < width; ++x) {
      const at = (y * width + x) * 4;
      const slope = [255 * x / width, 255 * y / height, 128 + 127 * Math.sin(x * y / 9)];
      for (let c = 0; c < 3; ++c)
        data[at + c] = Math.max(0, Math.min(255, slope[grey ? 0 : c] + (next() % 256 - 128) * noise / 128));
      if (grey) data[at + 1] = data[at + 2] = data[at];
      data[at + 3] = alpha ? (x ^ y) & 4 ? 255 : next() % 256 : 255;
    }
  }
  return {data, width, height};
}

async function make_files(module) {
  const core = await import(pathToFileURL(join(packages, 'ktx2-encoder/dist/encodeCore.js')));
  const {NodeBasisEncoder} = await import(pathToFileURL(join(packages, 'ktx2-encoder/dist/node/index.js')));
  const basis = await new NodeBasisEncoder().init({});
  const encode = (pictures, options) => core.encodeWithModule(
      basis, pictures.length === 1 ? new Uint8Array(4) : pictures.map(() => new Uint8Array(4)),
      {imageDecoder: async () => pictures.shift(), isSetKTX2SRGBTransferFunc: false, ...options});
  const etc1s = {isUASTC: false, generateMipmap: true, qualityLevel: 200};
  const uastc = {isUASTC: true, generateMipmap: true, needSupercompression: false, uastcLDRQualityLevel: 3};
  const faces = [1, 2, 3, 4, 5, 6].map((seed) => picture(8, 8, {seed}));
  const files = {
    'etc1s.ktx2': await encode([picture(37, 22)], {...etc1s, isSetKTX2SRGBTransferFunc: true}),
    'etc1s_alpha.ktx2': await encode([picture(24, 44, {alpha: true})], etc1s),
    'etc1s_grey.ktx2': await encode([picture(20, 20, {grey: true})], {...etc1s, generateMipmap: false, qualityLevel: 10}),
    'etc1s_flat.ktx2': await encode([picture(64, 64, {noise: 1})], {...etc1s, generateMipmap: false, qualityLevel: 1}),
    'etc1s_cube.ktx2': await encode([...faces], {...etc1s, isSetKTX2SRGBTransferFunc: true}),
    'uastc.ktx2': await encode([picture(17, 13)], uastc),
    'uastc_alpha_zstd.ktx2': await encode([picture(20, 16, {alpha: true})], {...uastc, needSupercompression: true}),
    'uastc_cube.ktx2': await encode([...faces], {...uastc, generateMipmap: false}),
  };
  for (const [name, bytes] of Object.entries(files)) writeFileSync(join(here, name), bytes);
  return files;
}

// ----- random blocks of UASTC

const kModeBits = [[0x01, 4], [0x35, 6], [0x1d, 5], [0x03, 5], [0x13, 5], [0x0b, 5], [0x1b, 5], [0x07, 5], [0x17, 5],
                   [0x0f, 5], [0x02, 3], [0x00, 2], [0x06, 3], [0x1f, 5], [0x0d, 5], [0x05, 7], [0x15, 6], [0x25, 6],
                   [0x09, 4]];
// Where PAT lies, of how many bits, and how many patterns there are; where ETC2M lies, which is not 0.
const kPatterns = {2: [20, 5, 30], 3: [20, 4, 11], 4: [20, 5, 30], 7: [20, 5, 19], 9: [28, 5, 30], 16: [29, 5, 30]};
const kEtc2m = {9: 24, 10: 16, 11: 15, 12: 16, 13: 24, 14: 24, 15: 26, 16: 25, 17: 25};

function put_bits(block, at, count, value) {
  for (let i = 0; i < count; ++i, ++at)
    block[at >> 3] = (block[at >> 3] & ~(1 << (at & 7))) | ((value >> i & 1) << (at & 7));
}

/** A row of `count` blocks of one mode, all patterns in turn. */
function random_blocks(mode, count) {
  const next = random(mode + 1);
  const blocks = new Uint8Array(16 * count);
  for (let i = 0; i < count; ++i) {
    const block = blocks.subarray(16 * i, 16 * i + 16);
    for (let k = 0; k < 16; ++k) block[k] = next() >>> 24;
    put_bits(block, 0, kModeBits[mode][1], kModeBits[mode][0]);
    if (kPatterns[mode]) put_bits(block, kPatterns[mode][0], kPatterns[mode][1], i % kPatterns[mode][2]);
    if (kEtc2m[mode]) put_bits(block, kEtc2m[mode], 4, 1 + i % 15);
  }
  return blocks;
}

/** UASTC of one level in a KTX 2. */
function container(width, height, blocks) {
  const descriptor = Buffer.alloc(44);
  descriptor.writeUInt32LE(44, 0);
  descriptor.writeUInt32LE(2 | 40 << 16, 8);
  descriptor.set([166, 1, 1, 0, 3, 3, 0, 0, 16], 12);
  descriptor.set([0, 0, 127, 3], 28);
  descriptor.writeUInt32LE(0xffffffff, 40);
  const header = Buffer.alloc(104);
  header.set(Buffer.from('ab4b5458203230bb0d0a1a0a', 'hex'));
  [0, 1, width, height, 0, 0, 1, 1, 0, 104, 44, 0, 0].forEach((value, i) => header.writeUInt32LE(value, 12 + 4 * i));
  header.writeBigUInt64LE(BigInt(160), 80);
  header.writeBigUInt64LE(BigInt(blocks.length), 88);
  header.writeBigUInt64LE(BigInt(blocks.length), 96);
  return Buffer.concat([header, descriptor, Buffer.alloc(12), blocks]);
}

const module = await transcoder();
if (process.argv.length > 3) {
  for (const file of process.argv.slice(3))
    for (const line of lines_of(module, basename(file), readFileSync(file))) console.log(line);
} else {
  const lines = [];
  for (const [name, bytes] of Object.entries(await make_files(module))) lines.push(...lines_of(module, name, bytes));
  const kBlocks = 256;
  for (let mode = 0; mode < 19; ++mode) {
    const file = container(4 * kBlocks, 4, random_blocks(mode, kBlocks));
    lines.push(...lines_of(module, `mode_${mode}`, file));
  }
  writeFileSync(join(here, 'expected.txt'), lines.join('\n') + '\n');
}
