// decode_plain.mjs IN.gltf|IN.glb FOLDER: FOLDER/plain.gltf is the same scene without meshopt, Draco and Basis Universal, unpacked by the
// decoders of npm: meshoptimizer, draco3dgltf, and three's Basis transcoder.
import fs from "node:fs";
import path from "node:path";
import { createRequire } from "node:module";

const modules = process.env.CANDELA_NODE_MODULES;
const require = createRequire(modules + "/");
const [input, folder] = process.argv.slice(2);
const BASIS_RGBA32 = 13;

function read(file) {
  const bytes = fs.readFileSync(file);
  if (bytes.toString("latin1", 0, 4) !== "glTF") return [JSON.parse(bytes), undefined];
  const size = bytes.readUInt32LE(12);
  return [JSON.parse(bytes.subarray(20, 20 + size)), bytes.subarray(28 + size)];
}

const [gltf, chunk] = read(input);
const beside = (uri) => fs.readFileSync(path.join(path.dirname(input), decodeURIComponent(uri)));
const buffers = gltf.buffers.map((buffer) => {
  if (buffer.uri?.startsWith("data:")) return Buffer.from(buffer.uri.split(",")[1], "base64");
  if (buffer.uri) return beside(buffer.uri);
  const packed = Object.values(buffer.extensions ?? {}).some((e) => e.fallback);
  return packed ? Buffer.alloc(buffer.byteLength) : chunk;
});

async function view_bytes(view) {
  const packed = view.extensions?.EXT_meshopt_compression ?? view.extensions?.KHR_meshopt_compression;
  const { buffer, byteOffset = 0, byteLength } = packed ?? view;
  const bytes = buffers[buffer].subarray(byteOffset, byteOffset + byteLength);
  if (!packed) return bytes;
  const { MeshoptDecoder } = require("meshoptimizer");
  await MeshoptDecoder.ready;
  const unpacked = new Uint8Array(packed.count * packed.byteStride);
  MeshoptDecoder.decodeGltfBuffer(unpacked, packed.count, packed.byteStride, bytes, packed.mode, packed.filter);
  return Buffer.from(unpacked);
}

const parts = [];
let length = 0;
function append(bytes) {
  const padding = Buffer.alloc(-bytes.length & 3);
  parts.push(bytes, padding);
  const at = length;
  length += bytes.length + padding.length;
  return { buffer: 0, byteOffset: at, byteLength: bytes.length };
}

const ARRAYS = { 5120: Int8Array, 5121: Uint8Array, 5122: Int16Array, 5123: Uint16Array, 5125: Uint32Array, 5126: Float32Array };

async function unpack_draco(primitive, packed) {
  const draco = await require("draco3dgltf").createDecoderModule({});
  const decoder = new draco.Decoder();
  const bytes = await view_bytes(gltf.bufferViews[packed.bufferView]);
  const mesh = new draco.Mesh();
  const status = decoder.DecodeArrayToMesh(new Int8Array(bytes), bytes.length, mesh);
  if (!status.ok()) throw new Error(status.error_msg());
  const types = {
    5120: draco.DT_INT8, 5121: draco.DT_UINT8, 5122: draco.DT_INT16, 5123: draco.DT_UINT16, 5125: draco.DT_UINT32, 5126: draco.DT_FLOAT32,
  };
  function values(index, count, size, take) {
    const accessor = gltf.accessors[index];
    const at = draco._malloc(size);
    take(at);
    accessor.bufferView = gltf.bufferViews.push(append(Buffer.from(draco.HEAPU8.slice(at, at + size)))) - 1;
    accessor.byteOffset = 0;
    accessor.count = count;
    draco._free(at);
  }
  for (const [name, id] of Object.entries(packed.attributes)) {
    const attribute = decoder.GetAttributeByUniqueId(mesh, id);
    const { componentType } = gltf.accessors[primitive.attributes[name]];
    const size = mesh.num_points() * attribute.num_components() * ARRAYS[componentType].BYTES_PER_ELEMENT;
    values(primitive.attributes[name], mesh.num_points(), size, (at) =>
      decoder.GetAttributeDataArrayForAllPoints(mesh, attribute, types[componentType], size, at));
  }
  gltf.accessors[primitive.indices].componentType = 5125;
  const corners = mesh.num_faces() * 3;
  values(primitive.indices, corners, corners * 4, (at) => decoder.GetTrianglesUInt32Array(mesh, corners * 4, at));
}

async function transcoder() {
  const own = path.join(modules, "three/examples/jsm/libs/basis");
  const source = fs.readFileSync(path.join(own, "basis_transcoder.js"), "utf8") + ";return BASIS;";
  const create = new Function("module", "exports", "require", "__dirname", source)({ exports: {} }, {}, require, own);
  const basis = await create({ wasmBinary: fs.readFileSync(path.join(own, "basis_transcoder.wasm")) });
  basis.initializeBasis();
  return basis;
}

async function unpack_image(index) {
  const image = gltf.images[index];
  const bytes = image.uri ? beside(image.uri) : await view_bytes(gltf.bufferViews[image.bufferView]);
  const file = new (await transcoder()).KTX2File(new Uint8Array(bytes));
  if (!file.startTranscoding()) throw new Error(`image ${index} is not transcoded`);
  const rgba = new Uint8Array(file.getImageTranscodedSizeInBytes(0, 0, 0, BASIS_RGBA32));
  file.transcodeImage(rgba, 0, 0, 0, BASIS_RGBA32, 0, -1, -1);
  const raw = { width: file.getWidth(), height: file.getHeight(), channels: 4 };
  const name = `image${index}.png`;
  await require("sharp")(Buffer.from(rgba), { raw }).png().toFile(path.join(folder, name));
  gltf.images[index] = { uri: name, mimeType: "image/png" };
}

const views = [];
for (const view of gltf.bufferViews) {
  const bytes = await view_bytes(view);
  const { extensions, ...rest } = view;
  views.push({ ...rest, ...append(bytes) });
}
const packed_views = gltf.bufferViews;
for (const mesh of gltf.meshes) {
  for (const primitive of mesh.primitives) {
    const packed = primitive.extensions?.KHR_draco_mesh_compression;
    if (packed) await unpack_draco(primitive, packed);
    delete primitive.extensions?.KHR_draco_mesh_compression;
  }
}
for (const texture of gltf.textures ?? []) {
  const basis = texture.extensions?.KHR_texture_basisu;
  if (!basis) continue;
  if (gltf.images[basis.source].mimeType !== "image/png") await unpack_image(basis.source);
  texture.source = basis.source;
  delete texture.extensions;
}
gltf.bufferViews = [...views, ...packed_views.slice(views.length)];
gltf.buffers = [{ uri: "plain.bin", byteLength: length }];
for (const list of ["extensionsUsed", "extensionsRequired"]) {
  gltf[list] = gltf[list]?.filter((name) => !/meshopt|draco|basisu/.test(name));
  if (!gltf[list]?.length) delete gltf[list];
}
for (const image of gltf.images ?? []) {
  const file = image.uri && path.join(path.dirname(input), decodeURIComponent(image.uri));
  if (file && fs.existsSync(file)) fs.copyFileSync(file, path.join(folder, image.uri));
}
fs.writeFileSync(path.join(folder, "plain.bin"), Buffer.concat(parts));
fs.writeFileSync(path.join(folder, "plain.gltf"), JSON.stringify(gltf));
