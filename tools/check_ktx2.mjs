// An independent reading of KTX 2 files: ktx-parse takes the container apart, zstddec unpacks the levels, the texels are
// decoded here. Prints the luminance of each level as `candela info` does, least, most and mean over the sphere; exits 1
// where the file contradicts itself.   npm install ktx-parse zstddec && node tools/check_ktx2.mjs FILE...
import { readFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { pathToFileURL } from 'node:url';

// The packages lie where the command is run, not beside this file.
const here = createRequire(process.cwd() + '/');
const load = async (name) => {
  const main = here.resolve(name);
  return { ...(await import(pathToFileURL(main))), ...here(name) };
};
const { read, KHR_SUPERCOMPRESSION_NONE, KHR_SUPERCOMPRESSION_ZSTD } = await load('ktx-parse');
const { ZSTDDecoder } = await load('zstddec');
const zstd = new ZSTDDecoder();
await zstd.init();

const small = (code, bits) => {
  const exponent = code >> bits, mantissa = code & ((1 << bits) - 1);
  return exponent === 0 ? mantissa * 2 ** (-14 - bits) : (1 + mantissa / 2 ** bits) * 2 ** (exponent - 15);
};
const half = (code) => (code >> 15 ? -1 : 1) * small(code & 0x7fff, 10);
const floats = (channels) => (view, i) =>
  Array.from({ length: Math.min(channels, 3) }, (_, c) => view.getFloat32(4 * (channels * i + c), true));
const halves = (channels) => (view, i) =>
  Array.from({ length: Math.min(channels, 3) }, (_, c) => half(view.getUint16(2 * (channels * i + c), true)));
// By VkFormat.
const decoders = {
  76: halves(1), 83: halves(2), 90: halves(3), 97: halves(4),
  100: floats(1), 103: floats(2), 106: floats(3), 109: floats(4),
  122: (view, i) => {
    const word = view.getUint32(4 * i, true);
    return [small(word & 2047, 6), small((word >>> 11) & 2047, 6), small(word >>> 22, 5)];
  },
  123: (view, i) => {
    const word = view.getUint32(4 * i, true), scale = 2 ** ((word >>> 27) - 24);
    return [0, 9, 18].map((shift) => ((word >>> shift) & 511) * scale);
  },
};

// Solid angle of a texel of a cube's face; texels of a table count alike.
const corner = (s, t) => Math.atan2(s * t, Math.sqrt(s * s + t * t + 1));
function weight(file, size, x, y) {
  if (file.faceCount !== 6) return 1;
  const [s0, t0, step] = [(2 * x) / size - 1, (2 * y) / size - 1, 2 / size];
  return corner(s0 + step, t0 + step) - corner(s0, t0 + step) - corner(s0 + step, t0) + corner(s0, t0);
}

function levelLuminance(file, level, number) {
  const texelBytes = file.dataFormatDescriptor[0].bytesPlane[0];
  const side = (size) => Math.max(1, size >> number);
  const [width, height] = [side(file.pixelWidth), side(file.pixelHeight)];
  const texels = width * height * file.faceCount;
  let data = level.levelData;
  if (file.supercompressionScheme === KHR_SUPERCOMPRESSION_ZSTD)
    data = zstd.decode(data, level.uncompressedByteLength);
  else if (file.supercompressionScheme !== KHR_SUPERCOMPRESSION_NONE) throw new Error('other supercompression');
  if (data.byteLength !== level.uncompressedByteLength || data.byteLength !== texels * texelBytes)
    throw new Error(`level ${number} has ${data.byteLength} bytes, not ${texels * texelBytes}`);
  const decode = decoders[file.vkFormat];
  if (!decode) throw new Error(`VkFormat ${file.vkFormat}`);
  const view = new DataView(data.buffer, data.byteOffset, data.byteLength);
  let [least, most, sum, weights] = [Infinity, -Infinity, 0, 0];
  for (let i = 0; i < texels; ++i) {
    const [r, g, b] = decode(view, i);
    const value = g === undefined ? r : 0.2126 * r + 0.7152 * g + 0.0722 * (b ?? 0);
    const w = weight(file, width, i % width, Math.floor(i / width) % height);
    [least, most, sum, weights] = [Math.min(least, value), Math.max(most, value), sum + w * value, weights + w];
  }
  return [least, most, sum / weights].map((value) => value.toPrecision(6)).join(' ');
}

for (const name of process.argv.slice(2)) {
  try {
    const file = read(new Uint8Array(readFileSync(name)));
    const light = file.levels.map((level, number) => levelLuminance(file, level, number));
    console.log(`${name}: VkFormat ${file.vkFormat}, ${file.pixelWidth} x ${file.pixelHeight}, ${file.faceCount} faces, ` +
      `scheme ${file.supercompressionScheme}, ${file.dataFormatDescriptor[0].samples.length} samples; ${light.join(' | ')}`);
  } catch (error) {
    console.error(`${name}: ${error.message}`);
    process.exitCode = 1;
  }
}
