// babylon_export.mjs IN.glb OUT.glb: read and written by Babylon without a GPU, which has no textures then.
import fs from "node:fs";
import { createRequire } from "node:module";
const require = createRequire(process.env.CANDELA_NODE_MODULES + "/");
const { NullEngine, Scene, SceneLoader } = require("@babylonjs/core");
require("@babylonjs/loaders");
const { GLTF2Export } = require("@babylonjs/serializers");
globalThis.XMLHttpRequest ??= class {};
const scene = new Scene(new NullEngine());
const data = "data:model/gltf-binary;base64," + fs.readFileSync(process.argv[2]).toString("base64");
await SceneLoader.AppendAsync("", data, scene, undefined, ".glb");
const written = await GLTF2Export.GLBAsync(scene, "out");
fs.writeFileSync(process.argv[3], Buffer.from(await written.files["out.glb"].arrayBuffer()));
process.exit(0);
