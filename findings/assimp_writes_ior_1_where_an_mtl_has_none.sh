#!/usr/bin/env bash
# Assimp, OBJ to glTF: a material whose MTL says nothing of an index of refraction (no Ni) is written with KHR_materials_ior
# of 1, so that it reflects nothing at its boundary, where glTF without the extension means 1.5 (F0 0.04). A reader that
# knows the extension draws plastic as matte chalk; one that does not draws it as plastic. Seen with assimpjs 0.0.10 (npm,
# Assimp as WebAssembly).
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
const material = (line) => convert({
  'a.obj': 'mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl m\nf 1 2 3\n',
  'a.mtl': `newmtl m\nKd 0.5 0.5 0.5\n${line}\n`,
}, 'gltf2').materials.find((m) => m.name === 'm').extensions?.KHR_materials_ior?.ior;
const without = material(''), with_it = material('Ni 1.45');
console.log(`KHR_materials_ior: ${without} without Ni, ${with_it?.toFixed(2)} with Ni 1.45`);
if (without !== 1 || with_it?.toFixed(2) !== '1.45') throw new Error('the package behaves otherwise now');
TEXT
node try.mjs
