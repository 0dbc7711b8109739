// Buffer views of EXT_ and KHR_meshopt_compression, here and by npm's decoder (WebAssembly), in one run: milliseconds,
// the best of several, one thread each, filters included. A mesh of a million vertices and two million triangles.
//
//   npm install meshoptimizer@1.3.0      in a folder of your own
//   node bench/meshopt.mjs THAT_FOLDER build/release/bin/meshopt_time

import {execFileSync} from 'node:child_process';
import {mkdtempSync, rmSync, writeFileSync} from 'node:fs';
import {tmpdir} from 'node:os';
import {join, resolve} from 'node:path';
import {pathToFileURL} from 'node:url';

const {MeshoptEncoder: encoder, MeshoptDecoder: decoder} =
    await import(pathToFileURL(resolve(process.argv[2], 'node_modules/meshoptimizer/index.js')));
await Promise.all([encoder.ready, decoder.ready]);

const kSide = 1000, kCount = kSide * kSide, kRuns = 15;

/** A sheet with waves: positions, normals, colours and tangent frames as a packer would have them. */
function views() {
  const positions = new Uint16Array(4 * kCount), normals = new Float32Array(4 * kCount);
  const colors = new Float32Array(4 * kCount), uvs = new Uint16Array(2 * kCount), points = new Float32Array(3 * kCount);
  for (let i = 0; i < kCount; ++i) {
    const x = i % kSide / kSide, y = Math.floor(i / kSide) / kSide;
    const z = 0.1 * Math.sin(31 * x) * Math.cos(17 * y) + 0.002 * Math.sin(977 * x + 1331 * y);
    const n = [-3.1 * Math.cos(31 * x) * Math.cos(17 * y), 1.7 * Math.sin(31 * x) * Math.sin(17 * y), 1];
    const length = Math.hypot(...n);
    positions.set([65535 * x, 65535 * y, 65535 * (z + 0.5), 0], 4 * i);
    normals.set([...n.map((c) => c / length), 1], 4 * i);
    colors.set([x, y, 0.5 + z, 1], 4 * i);
    uvs.set([65535 * x, 65535 * y], 2 * i);
    points.set([x, y, z], 3 * i);
  }
  const indices = new Uint32Array(6 * (kSide - 1) * (kSide - 1));
  for (let y = 0, k = 0; y + 1 < kSide; ++y) {
    for (let x = 0; x + 1 < kSide; ++x, k += 6) {
      const a = y * kSide + x;
      indices.set([a, a + 1, a + kSide, a + kSide, a + 1, a + kSide + 1], k);
    }
  }
  const exact = encoder.encodeFilterExp(points, kCount, 12, 15);
  return [
    ['positions, 16 bit', positions, kCount, 8, 'ATTRIBUTES', 'NONE'],
    ['uvs, 16 bit', uvs, kCount, 4, 'ATTRIBUTES', 'NONE'],
    ['positions, exponential', exact, kCount, 12, 'ATTRIBUTES', 'EXPONENTIAL'],
    ['normals, octahedral', encoder.encodeFilterOct(normals, kCount, 4, 8), kCount, 4, 'ATTRIBUTES', 'OCTAHEDRAL'],
    ['rotations, quaternion', encoder.encodeFilterQuat(normals, kCount, 8, 12), kCount, 8, 'ATTRIBUTES', 'QUATERNION'],
    ['colours', encoder.encodeFilterColor(colors, kCount, 4, 8), kCount, 4, 'ATTRIBUTES', 'COLOR'],
    ['triangles', indices, indices.length, 4, 'TRIANGLES', 'NONE'],
    ['indices of lines', indices, indices.length, 4, 'INDICES', 'NONE'],
  ];
}

function time_of_npm(packed, count, stride, mode, filter) {
  const target = new Uint8Array(count * stride);
  let best = Infinity;
  for (let run = 0; run < kRuns; ++run) {
    const start = performance.now();
    decoder.decodeGltfBuffer(target, count, stride, packed, mode, filter);
    best = Math.min(best, performance.now() - start);
  }
  return best;
}

const folder = mkdtempSync(join(tmpdir(), 'candela-meshopt-'));
try {
  const rows = [];
  for (const [name, view, count, stride, mode, filter] of views()) {
    const bytes = new Uint8Array(view.buffer, view.byteOffset, view.byteLength);
    for (const version of mode === 'ATTRIBUTES' ? [0, 1] : [1]) {
      const packed = encoder.encodeGltfBuffer(bytes, count, stride, mode, version);
      const file = join(folder, `${rows.length}.bin`);
      writeFileSync(file, packed);
      rows.push({label: name + (mode === 'ATTRIBUTES' ? `, v${version}` : ''), packed, count, stride, mode, filter, file});
    }
  }
  const here = execFileSync(resolve(process.argv[3]),
      rows.flatMap((r) => [r.file, r.mode, r.filter, String(r.count), String(r.stride)]), {encoding: 'utf8'})
      .trim().split('\n').map(Number);
  console.log('| view | decoded, MB | here, ms | GB/s | npm, ms | GB/s | ratio |\n|---|---|---|---|---|---|---|');
  let ours = 0, theirs = 0;
  rows.forEach((r, i) => {
    const npm = time_of_npm(r.packed, r.count, r.stride, r.mode, r.filter), size = r.count * r.stride;
    const speed = (ms) => (size / ms / 1e6).toFixed(2);
    ours += here[i], theirs += npm;
    console.log(`| ${r.label} | ${(size / 1e6).toFixed(1)} | ${here[i].toFixed(2)} | ${speed(here[i])} | ` +
                `${npm.toFixed(2)} | ${speed(npm)} | ${(npm / here[i]).toFixed(2)} |`);
  });
  console.log(`| all | | ${ours.toFixed(1)} | | ${theirs.toFixed(1)} | | ${(theirs / ours).toFixed(2)} |`);
} finally {
  rmSync(folder, {recursive: true});
}
