#!/usr/bin/env bash
# Assimp, glTF in and glTF out: a baseColorFactor whose alpha is 0.4 comes out with 0.16. The importer keeps alpha twice,
# in the colour and as an opacity, and the exporter multiplies both. What has an opacity alone, as an OBJ with `d 0.4`, keeps
# its 0.4. Seen with assimpjs 0.0.10 (npm, Assimp as WebAssembly), and with Debian 12's assimp-utils 5.2.5.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
npm init -y >/dev/null
npm install --silent --no-audit --no-fund assimpjs@0.0.10
cat >try.mjs <<'TEXT'
import assimpjs from 'assimpjs';
const assimp = await assimpjs();
function convert(files, format) {
  const list = new assimp.FileList();
  for (const [name, text] of Object.entries(files)) list.AddFile(name, new TextEncoder().encode(text));
  const result = assimp.ConvertFileList(list, format);
  if (!result.IsSuccess()) throw new Error(result.GetErrorCode());
  return JSON.parse(new TextDecoder().decode(result.GetFile(0).GetContent()));
}
const triangle = Buffer.from(new Float32Array([0, 0, 0, 1, 0, 0, 0, 1, 0]).buffer).toString('base64');
const gltf = {
  asset: { version: '2.0' }, scene: 0, scenes: [{ nodes: [0] }], nodes: [{ mesh: 0 }],
  meshes: [{ primitives: [{ attributes: { POSITION: 0 }, material: 0 }] }],
  materials: [{ name: 'm', alphaMode: 'BLEND', pbrMetallicRoughness: { baseColorFactor: [0.5, 0.5, 0.5, 0.4] } }],
  accessors: [{ bufferView: 0, componentType: 5126, count: 3, type: 'VEC3', min: [0, 0, 0], max: [1, 1, 0] }],
  bufferViews: [{ buffer: 0, byteLength: 36 }],
  buffers: [{ byteLength: 36, uri: 'data:application/octet-stream;base64,' + triangle }],
};
const obj = { 'a.obj': 'mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl m\nf 1 2 3\n',
              'a.mtl': 'newmtl m\nKd 0.5 0.5 0.5\nd 0.4\n' };
const alpha = (files) => convert(files, 'gltf2').materials.find((m) => m.name === 'm')
    .pbrMetallicRoughness.baseColorFactor[3].toFixed(2);
const of_gltf = alpha({ 'a.gltf': JSON.stringify(gltf) }), of_obj = alpha(obj);
console.log(`alpha 0.4 becomes ${of_gltf} from glTF, ${of_obj} from OBJ`);
if (of_gltf !== '0.16' || of_obj !== '0.40') throw new Error('the package behaves otherwise now');
TEXT
node try.mjs
