#!/usr/bin/env bash
# KHR_meshopt_compression, appendix A (release candidate, January 2026), channel mode 2: "4-byte XOR deltas" are said to be
# computed with "an additional rotation r", and rotate(v, r) is printed as a turn to the left. All else in the appendix is
# what a decoder does; this is what an encoder did. A decoder that turns to the left gets other numbers: it has to turn
# to the right. Seen with npm's meshoptimizer 1.3.0 (encoder and decoder) on 64 floats of a sine, whose bit pattern it
# packs with r = 1: words 1 to 63 are wrong to the left, none to the right.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
npm init -y >/dev/null
npm install --silent --no-audit --no-fund meshoptimizer@1.3.0
cat >try.mjs <<'TEXT'
import { MeshoptEncoder as encoder, MeshoptDecoder as decoder } from 'meshoptimizer';
await encoder.ready;
await decoder.ready;
const count = 64;
const words = new Uint32Array(Float32Array.from({ length: count }, (_, i) => 100 * Math.sin(2 * i)).buffer);
const packed = encoder.encodeVertexBufferLevel(new Uint8Array(words.buffer), count, 4, 3, 1);
const mode = packed[packed.length - 1]; // of the only channel: the last byte of the tail
const turn = mode >> 4;
if (packed[0] !== 0xa1 || (mode & 15) !== 2 || turn === 0) throw new Error(`another mode than before: ${mode}`);

// The deltas, by the package's own decoder: the same stream with mode 2 and no rotation sums up what is stored.
const stored = new Uint32Array(count);
const plain = packed.slice();
plain[plain.length - 1] = 2;
decoder.decodeGltfBuffer(new Uint8Array(stored.buffer), count, 4, plain, 'ATTRIBUTES', 'NONE');
const wrong = (rotate) => {
  let bad = 0, value = words[0];
  for (let i = 1; i < count; ++i) {
    value = (value ^ rotate((stored[i] ^ stored[i - 1]) >>> 0)) >>> 0;
    if (value !== words[i]) ++bad;
  }
  return bad;
};
const left = wrong((v) => ((v << turn) | (v >>> (32 - turn))) >>> 0);
const right = wrong((v) => ((v >>> turn) | (v << (32 - turn))) >>> 0);
console.log(`mode 2, r = ${turn}: ${left} of ${count - 1} words wrong turned left as printed, ${right} turned right`);
if (left === 0 || right !== 0) throw new Error('the package behaves otherwise now');
TEXT
node try.mjs
