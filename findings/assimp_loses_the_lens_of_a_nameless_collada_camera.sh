#!/usr/bin/env bash
# Assimp, COLLADA: a <camera> that has an id and no name loses its lens. `name` is optional in the schema (1.4.1 and 1.5), and
# nothing refers to it; yet without it an angle of 60 degrees, the aspect and the far plane become 0.0137 rad, 0 and 1000.
# (0.0137 rad is pi/4 taken for degrees.) Seen with assimpjs 0.0.10 (npm, Assimp as WebAssembly), and with 5.2.5 and 5.4 of
# Debian 12 and 13.
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
const collada = (name) => `<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit name="meter" meter="1"/><up_axis>Y_UP</up_axis></asset>
<library_cameras><camera id="lens" ${name}><optics><technique_common><perspective>
<yfov>60</yfov><aspect_ratio>1</aspect_ratio><znear>0.1</znear><zfar>100</zfar>
</perspective></technique_common></optics></camera></library_cameras>
<library_geometries><geometry id="g"><mesh><source id="p"><float_array id="pa" count="9">0 0 0 1 0 0 0 1 0</float_array>
<technique_common><accessor source="#pa" count="3" stride="3"><param name="X" type="float"/><param name="Y" type="float"/>
<param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<triangles count="1"><input semantic="VERTEX" source="#v" offset="0"/><p>0 1 2</p></triangles></mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="s"><node id="eye"><translate>0 0 3</translate><instance_camera url="#lens"/></node>
<node id="thing"><instance_geometry url="#g"/></node></visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#s"/></scene></COLLADA>`;
const lens = (name) => {
  const camera = convert({ 'a.dae': collada(name) }, 'assjson').cameras[0];
  return [camera.horizontalfov.toFixed(4), camera.aspect, camera.clipplanefar].join(' ');
};
const named = lens('name="lens"'), nameless = lens('');
console.log(`angle, aspect, far plane: ${named} with a name, ${nameless} without`);
if (named !== '1.0472 1 100' || nameless !== '0.0137 0 1000') throw new Error('the package behaves otherwise now');
TEXT
node try.mjs
