// three_export.mjs IN.glb OUT.glb: read by three's GLTFLoader, written by its GLTFExporter. Without a browser there are no textures.
import fs from "node:fs";
globalThis.self = globalThis;
globalThis.FileReader = class {
  readAsArrayBuffer(blob) {
    blob.arrayBuffer().then((buffer) => {
      this.result = buffer;
      this.onloadend();
    });
  }
};
const modules = process.env.CANDELA_NODE_MODULES;
const { GLTFLoader } = await import(`${modules}/three/examples/jsm/loaders/GLTFLoader.js`);
const { GLTFExporter } = await import(`${modules}/three/examples/jsm/exporters/GLTFExporter.js`);
const bytes = fs.readFileSync(process.argv[2]);
const gltf = await new GLTFLoader().parseAsync(bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.length), "");
const written = await new GLTFExporter().parseAsync(gltf.scene, { binary: true, animations: gltf.animations });
fs.writeFileSync(process.argv[3], Buffer.from(written));
