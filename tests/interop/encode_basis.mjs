// encode_basis.mjs IN.gltf|IN.glb OUT.glb etc1s|uastc: the same scene with its pictures as KTX 2, by npm's Basis encoder.
import fs from "node:fs";
import path from "node:path";
import { createRequire } from "node:module";
import { pathToFileURL } from "node:url";

const modules = process.env.CANDELA_NODE_MODULES;
const require = createRequire(modules + "/");
const own = (name) => import(pathToFileURL(path.join(modules, "ktx2-encoder/dist", name)));
const [input, output, kind] = process.argv.slice(2);
const { encodeWithModule } = await own("encodeCore.js");
const { NodeBasisEncoder } = await own("node/index.js");
const { NodeIO } = require("@gltf-transform/core");
const { ALL_EXTENSIONS, KHRTextureBasisu } = require("@gltf-transform/extensions");
const sharp = require("sharp");

const say = console.log;
console.log = () => {}; // the encoder is talkative
const basis = await new NodeBasisEncoder().init({});
const io = new NodeIO().registerExtensions(ALL_EXTENSIONS);
const document = await io.read(input);
document.createExtension(KHRTextureBasisu).setRequired(true);
const options = kind === "uastc" ? { isUASTC: true, needSupercompression: true, uastcLDRQualityLevel: 2 } : { isUASTC: false, qualityLevel: 192 };
for (const texture of document.getRoot().listTextures()) {
  const { data, info } = await sharp(texture.getImage()).ensureAlpha().raw().toBuffer({ resolveWithObject: true });
  const imageDecoder = async () => ({ data: new Uint8Array(data), width: info.width, height: info.height });
  const ktx2 = await encodeWithModule(basis, new Uint8Array(4), { imageDecoder, generateMipmap: false, ...options });
  texture.setImage(new Uint8Array(ktx2)).setMimeType("image/ktx2").setURI("");
}
await io.write(output, document);
console.log = say;
process.exit(0);
