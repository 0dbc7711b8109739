#!/usr/bin/env python3
"""Scenes of other formats: told apart by content, and drawn as the same scene of glTF is."""

import base64
import json
import struct
import unittest
import zipfile
import zlib

from candela import CliTest, main, png_pixels

# A tetrahedron whose three edges from its corner differ: 1 m along x, 2 m along y, 0.5 m along z.
CORNERS = ((0, 0, 0), (1, 0, 0), (0, 2, 0), (0, 0, 0.5))
FACES = ((0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3))
COLORS = ((255, 0, 0), (0, 255, 0), (0, 0, 255), (255, 188, 0))
CLAY = {"pbrMetallicRoughness": {"baseColorFactor": [0.8, 0.8, 0.8, 1], "metallicFactor": 0, "roughnessFactor": 0.5}}
VIEW = ("--size", "48x36", "--eye", "2,2.5,3", "--target", "0.3,0.8,0.2", "--fov", "40deg", "--env", "studio", "--threads", "2")


def linear(code):
    v = code / 255
    return v / 12.92 if v <= 0.04045 else ((v + 0.055) / 1.055) ** 2.4


def gltf(material, corners=CORNERS, colors=None, uvs=None, image=None):
    """The tetrahedron as others see it: corners of their own for each face, so that it is flat."""
    flat = [c for face in FACES for c in face]
    views, accessors, data = [], [], b""

    def add(values, kind):
        nonlocal data
        views.append({"buffer": 0, "byteOffset": len(data), "byteLength": 4 * sum(map(len, values))})
        accessors.append({"bufferView": len(views) - 1, "componentType": 5126, "count": len(values), "type": kind})
        data += b"".join(struct.pack(f"<{len(v)}f", *v) for v in values)
        return len(accessors) - 1

    attributes = {"POSITION": add([corners[i] for i in flat], "VEC3")}
    if colors:
        attributes["COLOR_0"] = add([[linear(c) for c in colors[i]] + [1] for i in flat], "VEC4")
    if uvs:
        attributes["TEXCOORD_0"] = add([uvs[i] for i in flat], "VEC2")
    scene = {
        "asset": {"version": "2.0"},
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": attributes, "material": 0}]}],
        "materials": [{"doubleSided": True, **material}],
        "accessors": accessors,
        "bufferViews": views,
        "buffers": [
            {"byteLength": len(data), "uri": "data:application/octet-stream;base64," + base64.b64encode(data).decode()}
        ],
    }
    if image:
        scene["images"], scene["textures"] = [{"uri": image}], [{"source": 0}]
    scene["extensionsUsed"] = sorted(material.get("extensions", {}))
    return json.dumps({k: v for k, v in scene.items() if v})


def obj(material=None, library="a.mtl", uvs=None, corners=CORNERS):
    lines = [f"mtllib {library}"] if material else []
    lines += ["# a comment", "o thing"] + ["v %g %g %g" % c for c in corners] + ["vt %g %g" % t for t in uvs or ()]
    lines += [f"usemtl {material}"] if material else []
    lines += ["f " + " ".join(f"{i + 1}/{i + 1}" if uvs else f"{i + 1}" for i in face) for face in FACES]
    return "\n".join(lines) + "\n"


def stl_text():
    lines = ["solid thing"]
    for face in FACES:
        lines += ["facet normal 0 0 0", "outer loop", *("vertex %g %g %g" % CORNERS[i] for i in face), "endloop", "endfacet"]
    return "\n".join(lines + ["endsolid thing"]) + "\n"


def stl_bytes(title=b"solid, as a text would begin", corners=CORNERS):
    body = b"".join(struct.pack("<12fH", 0, 0, 0, *(x for i in face for x in corners[i]), 0) for face in FACES)
    return title.ljust(80, b" ") + struct.pack("<I", len(FACES)) + body


def ply(colors=None, corners=CORNERS):
    lines = ["ply", "format ascii 1.0", f"element vertex {len(CORNERS)}"] + [f"property float {a}" for a in "xyz"]
    lines += [f"property uchar {c}" for c in ("red", "green", "blue")] if colors else []
    lines += [f"element face {len(FACES)}", "property list uchar int vertex_indices", "end_header"]
    lines += [" ".join(map(str, (*c, *(colors[i] if colors else ())))) for i, c in enumerate(corners)]
    return "\n".join(lines + ["3 %d %d %d" % face for face in FACES]) + "\n"


def dae(unit=1.0, up="Y_UP", corners=CORNERS, camera=""):
    numbers = " ".join("%g" % x for c in corners for x in c)
    indices = " ".join(str(i) for face in FACES for i in face)
    return f"""<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit name="u" meter="{unit}"/><up_axis>{up}</up_axis></asset>
<library_cameras>{camera}</library_cameras>
<library_effects><effect id="e"><profile_COMMON><technique sid="c"><lambert>
<diffuse><color>0.8 0.2 0.1 1</color></diffuse></lambert></technique></profile_COMMON></effect></library_effects>
<library_materials><material id="m" name="red"><instance_effect url="#e"/></material></library_materials>
<library_geometries><geometry id="g"><mesh>
<source id="p"><float_array id="pa" count="12">{numbers}</float_array><technique_common>
<accessor source="#pa" count="4" stride="3"><param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/>
</accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<triangles count="4" material="mm"><input semantic="VERTEX" source="#v" offset="0"/><p>{indices}</p></triangles></mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="s"><node id="n" name="thing"><instance_geometry url="#g"><bind_material><technique_common>
<instance_material symbol="mm" target="#m"/></technique_common></bind_material></instance_geometry></node>
{'<node id="eye" name="eye"><translate>0 0 9</translate><instance_camera url="#lens"/></node>' if camera else ''}
</visual_scene></library_visual_scenes><scene><instance_visual_scene url="#s"/></scene></COLLADA>
"""


def fbx(unit=1.0, up=1, corners=CORNERS):
    """FBX 7 as text; `unit` is in centimetres. Of z-up files -y is the front."""
    front, sign = (2, 1) if up == 1 else (1, -1)
    axes = [("UpAxis", up), ("UpAxisSign", 1), ("FrontAxis", front), ("FrontAxisSign", sign), ("CoordAxis", 0), ("CoordAxisSign", 1)]
    numbers = ",".join("%g" % x for c in corners for x in c)
    indices = ",".join(f"{a},{b},{-c - 1}" for a, b, c in FACES)
    settings = "\n".join(f'P: "{name}", "int", "Integer", "",{value}' for name, value in axes)
    return f"""; FBX 7.4.0 project file
FBXHeaderExtension:  {{
 FBXHeaderVersion: 1003
 FBXVersion: 7400
}}
GlobalSettings:  {{
 Version: 1000
 Properties70:  {{
{settings}
P: "UnitScaleFactor", "double", "Number", "",{unit}
 }}
}}
Objects:  {{
 Geometry: 11, "Geometry::thing", "Mesh" {{
  Vertices: *12 {{
   a: {numbers}
  }}
  PolygonVertexIndex: *12 {{
   a: {indices}
  }}
  LayerElementMaterial: 0 {{
   Version: 101
   Name: ""
   MappingInformationType: "AllSame"
   ReferenceInformationType: "IndexToDirect"
   Materials: *1 {{
    a: 0
   }}
  }}
  Layer: 0 {{
   Version: 100
   LayerElement:  {{
    Type: "LayerElementMaterial"
    TypedIndex: 0
   }}
  }}
 }}
 Model: 12, "Model::thing", "Mesh" {{
  Version: 232
 }}
 Material: 13, "Material::red", "" {{
  Version: 102
  ShadingModel: "lambert"
  Properties70:  {{
   P: "DiffuseColor", "Color", "", "A",0.8,0.2,0.1
  }}
 }}
}}
Connections:  {{
 C: "OO",12,0
 C: "OO",11,12
 C: "OO",13,12
}}
"""


def max_3ds(corners=CORNERS):
    def chunk(kind, body):
        return struct.pack("<HI", kind, 6 + len(body)) + body

    points = struct.pack("<H", 4) + b"".join(struct.pack("<3f", *c) for c in corners)
    faces = struct.pack("<H", 4) + b"".join(struct.pack("<4H", *face, 0) for face in FACES)
    mesh = chunk(0x4100, chunk(0x4110, points) + chunk(0x4120, faces))
    return chunk(0x4D4D, chunk(0x0002, struct.pack("<I", 3)) + chunk(0x3D3D, chunk(0x4000, b"thing\0" + mesh)))


def write_3mf(path, corners, unit=""):
    points = "".join('<vertex x="%g" y="%g" z="%g"/>' % c for c in corners)
    faces = "".join('<triangle v1="%d" v2="%d" v3="%d"/>' % face for face in FACES)
    space = "http://schemas.microsoft.com/3dmanufacturing/core/2015/02"
    relations = "http://schemas.openxmlformats.org/package/2006/relationships"
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as package:
        package.writestr("[Content_Types].xml", '<Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types"/>')
        package.writestr(
            "_rels/.rels",
            f'<?xml version="1.0"?><Relationships xmlns="{relations}"><Relationship Target="/3D/3dmodel.model" Id="r" '
            'Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/></Relationships>',
        )
        package.writestr(
            "3D/3dmodel.model",
            f'<?xml version="1.0"?><model {unit} xmlns="{space}"><resources><object id="1" type="model"><mesh>'
            f"<vertices>{points}</vertices><triangles>{faces}</triangles></mesh></object></resources>"
            '<build><item objectid="1"/></build></model>',
        )


def z_up(corners, scale):
    """The same corners in a file whose z is up, in a unit of which a metre has `scale`."""
    return tuple((x * scale, -z * scale, y * scale) for x, y, z in corners)


def png(width, height, texel):
    rows = b"".join(b"\0" + b"".join(bytes(texel(x, y)) for x in range(width)) for y in range(height))

    def chunk(kind, body):
        return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))

    header = struct.pack(">IIBBBBB", width, height, 8, 6, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b"")


class ForeignTest(CliTest):
    def write(self, name, content):
        path = self.folder / name
        path.parent.mkdir(exist_ok=True)
        path.write_bytes(content if isinstance(content, bytes) else content.encode())

    def info(self, name):
        return json.loads(self.succeeds("info", name, "--json").out)

    def difference(self, name, reference, engine):
        """Mean difference of two pictures, in codes."""
        rows = []
        for scene, picture in ((name, "a.png"), (reference, "b.png")):
            samples = ("--spp", "64") if engine == "path" else ()
            self.succeeds("render", scene, "-o", picture, "--engine", engine, "-q", *VIEW, *samples)
            rows.append(b"".join(png_pixels(self.folder / picture)[3]))
        self.assertEqual(len(rows[0]), len(rows[1]))
        self.assertGreater(max(rows[1]) - min(rows[1]), 40, "an empty picture proves nothing")
        return sum(abs(a - b) for a, b in zip(*rows)) / len(rows[0])

    def agrees(self, name, reference):
        self.write("reference.gltf", reference)
        for engine in ("path", "raster"):
            with self.subTest(name=name, engine=engine):
                self.assertLess(self.difference(name, "reference.gltf", engine), 0.3)


class Pictures(ForeignTest):
    RED = {"pbrMetallicRoughness": {"baseColorFactor": [0.8, 0.2, 0.1, 1], "metallicFactor": 0, "roughnessFactor": 1},
           "extensions": {"KHR_materials_specular": {"specularFactor": 0}}}

    def test_stl_as_text_and_as_bytes(self):
        self.write("a.stl", stl_text())
        self.write("b.stl", stl_bytes())
        self.agrees("a.stl", gltf(CLAY))
        self.agrees("b.stl", gltf(CLAY))

    def test_ply_with_and_without_colours(self):
        self.write("a.ply", ply())
        self.agrees("a.ply", gltf(CLAY))
        self.write("b.ply", ply(COLORS))
        white = {"pbrMetallicRoughness": {"metallicFactor": 0, "roughnessFactor": 0.5}}
        self.agrees("b.ply", gltf(white, colors=COLORS))

    def test_obj_with_physical_statements(self):
        self.write("a.mtl", "newmtl gold\nKd 0.9 0.6 0.2\nPr 0.3\nPm 0.9\nPc 0.5\nPcr 0.1\naniso 0.2\nNi 1.5\n")
        self.write("a.obj", obj("gold"))
        pbr = {"baseColorFactor": [0.9, 0.6, 0.2, 1], "metallicFactor": 0.9, "roughnessFactor": 0.3}
        coat = {"clearcoatFactor": 0.5, "clearcoatRoughnessFactor": 0.1}
        layers = {"KHR_materials_clearcoat": coat, "KHR_materials_anisotropy": {"anisotropyStrength": 0.2}}
        self.agrees("a.obj", gltf({"pbrMetallicRoughness": pbr, "extensions": layers}))

    def test_obj_of_phong(self):
        self.write("a.mtl", "newmtl shiny\nKd 0.2 0.4 0.7\nKs 0.5 0.5 0.5\nNs 30\nNi 1\nillum 2\n")
        self.write("a.obj", obj("shiny"))
        roughness = (2 / 32) ** 0.25
        pbr = {"baseColorFactor": [0.2, 0.4, 0.7, 1], "metallicFactor": 0, "roughnessFactor": roughness}
        self.agrees("a.obj", gltf({"pbrMetallicRoughness": pbr}))

    def test_obj_with_textures(self):
        # v points up in OBJ. The texture repeats twice along u and once along v, a quarter of it further up.
        self.write("maps/wood grain.png", png(8, 8, lambda x, y: (30 * x, 255 - 30 * y, 90, 255)))
        self.write("maps/rough.png", png(2, 2, lambda x, y: (60 + 150 * x,) * 3 + (255,)))
        self.write("maps/metal.png", png(4, 4, lambda x, y: (80 * (y % 4),) * 3 + (255,)))
        self.write("a.mtl", "newmtl w\nKd 1 1 1\nmap_Kd -s 2 1 1 -o 0 0.25 maps\\wood grain.png\nmap_Pr maps/rough.png\nmap_Pm maps/metal.png\n")
        uvs = ((0, 0), (1, 0), (0, 1), (0.7, 0.3))
        self.write("a.obj", obj("w", uvs=uvs))
        packed = png(4, 4, lambda x, y: (255, 60 + 150 * (x // 2), 80 * (y % 4), 255))
        down = tuple((u, 1 - v) for u, v in uvs)
        shift = {"KHR_texture_transform": {"scale": [2, 1], "offset": [0, -0.25]}}
        pbr = {"baseColorTexture": {"index": 0, "extensions": shift}, "metallicRoughnessTexture": {"index": 1}}
        scene = json.loads(gltf({"pbrMetallicRoughness": pbr}, uvs=down))
        self.write("packed.png", packed)
        scene["images"] = [{"uri": "maps/wood%20grain.png"}, {"uri": "packed.png"}]
        scene["textures"] = [{"source": 0}, {"source": 1}]
        scene["extensionsUsed"] = ["KHR_texture_transform"]
        self.agrees("a.obj", json.dumps(scene))

    def test_units_and_axes(self):
        red = gltf(self.RED)
        self.write("a.dae", dae())
        self.agrees("a.dae", red)
        self.write("b.dae", dae(0.01, "Z_UP", z_up(CORNERS, 100)))
        self.agrees("b.dae", red)
        self.write("a.fbx", fbx(1.0, 1, tuple(tuple(100 * x for x in c) for c in CORNERS)))
        self.write("b.fbx", fbx(2.54, 2, z_up(CORNERS, 100 / 2.54)))
        matte = gltf({"pbrMetallicRoughness": self.RED["pbrMetallicRoughness"]})
        self.agrees("a.fbx", matte)
        self.agrees("b.fbx", matte)
        write_3mf(self.folder / "a.3mf", z_up(CORNERS, 1000))
        self.agrees("a.3mf", gltf(CLAY))
        write_3mf(self.folder / "b.3mf", z_up(CORNERS, 100 / 2.54), 'unit="inch"')
        self.agrees("b.3mf", gltf(CLAY))
        self.write("a.3ds", max_3ds(z_up(CORNERS, 1)))
        self.agrees("a.3ds", gltf(CLAY))


class Places(ForeignTest):
    def bounds(self, name):
        found = self.info(name)["bounds"]
        return [*found["lower"], *found["upper"]] if isinstance(found, dict) else [x for v in found for x in v]

    def test_metres_and_y_up_whatever_the_file_says(self):
        self.write("y.obj", obj())
        self.write("y.stl", stl_bytes())
        self.write("y.ply", ply())
        self.write("cm.dae", dae(0.01, "Z_UP", z_up(CORNERS, 100)))
        self.write("x.dae", dae(1, "Z_UP", z_up(CORNERS, 1)))
        self.write("cm.fbx", fbx(1.0, 1, tuple(tuple(100 * x for x in c) for c in CORNERS)))
        self.write("inch.fbx", fbx(2.54, 2, z_up(CORNERS, 100 / 2.54)))
        self.write("z.3ds", max_3ds(z_up(CORNERS, 1)))
        write_3mf(self.folder / "mm.3mf", z_up(CORNERS, 1000))
        for unit, scale in (("inch", 1 / 0.0254), ("foot", 1 / 0.3048), ("meter", 1), ("micron", 1e6), ("centimeter", 100)):
            write_3mf(self.folder / f"{unit}.3mf", z_up(CORNERS, scale), f'unit="{unit}"')
        for name in self.files():
            with self.subTest(name=name):
                for found, expected in zip(self.bounds(name), (0, 0, 0, 1, 2, 0.5)):
                    self.assertAlmostEqual(found, expected, delta=1e-5)

    def test_the_user_says_unit_and_axis_where_the_file_does_not(self):
        inches = tuple(tuple(x / 0.0254 for x in c) for c in z_up(CORNERS, 1))
        self.write("a.obj", obj(corners=inches))
        self.write("a.stl", stl_bytes(corners=inches))
        self.write("a.ply", ply(corners=inches))
        for name in self.files():
            for verb in ("info", "check"):
                self.succeeds(verb, name, "--unit", "in", "--up", "z")
            found = json.loads(self.succeeds("info", name, "--unit", "in", "--up", "z", "--json").out)
            for value, expected in zip([*found["bounds"]["lower"], *found["bounds"]["upper"]], (0, 0, 0, 1, 2, 0.5)):
                self.assertAlmostEqual(value, expected, delta=1e-5, msg=name)
            self.assertEqual(found["notes"], [])
            (told,) = json.loads(self.succeeds("info", name, "--unit", "cm", "--json").out)["notes"]
            self.assertIn("says no upward axis: +y is taken", told)
            self.succeeds("render", name, "-o", "z.png", "--unit", "in", "--up", "z", "--size", "24x16", "--spp", "1")
        self.write("a.glb", gltf(CLAY))
        self.write("a.dae", dae())
        self.fails("render", "a.glb", "--unit", "mm", says="a.glb: a unit is given, but glTF says its own; OBJ, STL and PLY do not")
        self.fails("info", "a.dae", "--up", "z", says="an upward axis is given, but COLLADA says its own")
        self.fails("render", "demo:spheres", "--up", "z", says="a built-in scene is in metres with [+]y up")

    def test_camera_without_a_name(self):
        lens = (
            '<camera id="lens"><optics><technique_common><perspective><xfov>60</xfov><aspect_ratio>1.5</aspect_ratio>'
            "<znear>0.1</znear><zfar>100</zfar></perspective></technique_common></optics></camera>"
        )
        self.write("a.dae", dae(camera=lens))
        camera = self.info("a.dae")["cameras"][0]
        self.assertAlmostEqual(camera["yfov_deg"], 42.1034, delta=1e-3)


class Content(ForeignTest):
    def test_names_do_not_matter(self):
        self.write("a.glb.obj", gltf(CLAY))
        self.write("b.txt", obj())
        self.write("c.gltf", obj())
        self.write("d.glb", stl_bytes())
        self.write("e", ply())
        self.write("f.obj", dae())
        self.write("g.dae", fbx())
        self.write("h.ply", max_3ds())
        write_3mf(self.folder / "i.zip", CORNERS)
        kinds = ("glTF", "OBJ", "OBJ", "STL", "PLY", "COLLADA", "FBX", "3DS", "3MF")
        self.assertEqual(tuple(self.info(name)["format"] for name in self.files()), kinds)

    def test_what_nothing_knows_is_refused_in_one_line(self):
        self.write("a.obj", "Dear reader,\nthis is a letter.\n")
        self.write("b.stl", b"\x89PNG\r\n\x1a\n")
        self.write("c.fbx", b"BLENDER-v304")
        self.write("d.ply", b"")
        for verb in ("info", "render"):
            self.fails(verb, "a.obj", says=r"a\.obj: its content is unknown: no scene of a known format \(glTF, OBJ")
            self.fails(verb, "c.fbx", says="a Blender file; export it as glTF")
            self.fails(verb, "d.ply", says="empty")
        self.fails("render", "b.stl", says="a PNG image: no scene")
        self.write("e.gltf", "nothing")
        self.fails("render", "e.gltf", says="e.gltf: .*JSON|e.gltf: ")

    def test_check_and_bake_read_them_too(self):
        self.write("below/a.obj", obj())
        found = json.loads(self.succeeds("check", "below", "--json").out)
        self.assertEqual([asset["readable"] for asset in found["assets"]], [True])


class Damage(ForeignTest):
    def test_broken_files_are_one_line(self):
        self.write("claims.ply", ply().replace("element vertex 4", "element vertex 4000000000"))
        self.fails("info", "claims.ply", says="claims 4000000000 elements")
        self.write("cut.fbx", b"Kaydara FBX Binary  \0\x1a\0" + struct.pack("<I", 7400) + b"\xff" * 40)
        self.write("cut.dae", dae()[:700])
        self.write("cut.3ds", max_3ds()[:40])
        for name in ("cut.fbx", "cut.dae"):
            self.fails("info", name, says=name)
        self.assertIn(self.run_candela("info", "cut.3ds").code, (0, 1))

    def test_a_package_that_claims_too_much(self):
        write_3mf(self.folder / "a.3mf", CORNERS)
        data = bytearray((self.folder / "a.3mf").read_bytes())
        at = data.rfind(b"PK\1\2")
        data[at + 24 : at + 28] = b"\xf0\xff\xff\xff"
        self.write("bomb.3mf", bytes(data))
        self.fails("info", "bomb.3mf", says="unpacks to")

    def test_textures_in_tga_and_bmp_are_those_in_png(self):
        # A column of red and one of blue, two rows; rows of a BMP end at four bytes, and both formats begin below.
        rows = b"\0\0\xff\xff\0\0"
        tga = struct.pack("<BBBHHBHHHHBB", 0, 0, 2, 0, 0, 0, 0, 0, 2, 2, 24, 0) + 2 * rows
        bmp = struct.pack("<2sIIIIiiHHIIiiII", b"BM", 70, 0, 54, 40, 2, 2, 1, 24, 0, 16, 0, 0, 0, 0) + 2 * (rows + b"\0\0")
        files = {"w.png": png(2, 2, lambda x, y: ((255, 0, 0, 255), (0, 0, 255, 255))[x]), "w.tga": tga, "w.bmp": bmp}
        pictures = {}
        for name, content in files.items():
            self.write(name, content)
            self.write("a.mtl", f"newmtl w\nmap_Kd {name}\nmap_Pr {name}\nmap_Pm {name}\n")
            self.write("a.obj", obj("w", uvs=((0, 0), (1, 0), (0, 1), (1, 1))))
            self.assertEqual(self.info("a.obj")["warnings"], [], name)
            self.succeeds("render", "a.obj", "-o", "a.png", "--size", "24x16", "--spp", "16")
            pictures[name] = (self.folder / "a.png").read_bytes()
        self.assertEqual(pictures["w.tga"], pictures["w.png"])
        self.assertEqual(pictures["w.bmp"], pictures["w.png"])
        self.write("w.tga", tga[:-1])
        self.write("a.mtl", "newmtl w\nmap_Kd w.tga\n")
        (told,) = self.info("a.obj")["warnings"]
        self.assertEqual(told, "w.tga: a TGA that is cut short; shown without it")
        self.assertEqual(self.run_candela("render", "a.obj", "-o", "b.png", "--size", "4x4", "--strict").code, 1)

    def test_missing_materials_and_textures_are_warned_of(self):
        self.write("a.obj", obj("gold"))
        told = " ".join(self.info("a.obj")["warnings"])
        self.assertIn("the materials of a.mtl are missing", told)
        self.write("a.mtl", "newmtl gold\nmap_Kd C:\\Users\\me\\wood.png\ndisp d.png\n")
        told = " ".join(self.info("a.obj")["warnings"])
        self.assertIn("wood.png", told)
        self.assertIn("disp is not carried over", told)


class Files(ForeignTest):
    def test_what_a_scene_reads_is_never_overwritten(self):
        self.write("a.mtl", "newmtl w\nmap_Kd wood.png\nmap_Pr rough.png\nmap_Pm metal.png\n")
        self.write("a.obj", obj("w", uvs=((0, 0), (1, 0), (0, 1), (1, 1))))
        for name in ("wood.png", "rough.png", "metal.png"):
            self.write(name, png(1, 1, lambda x, y: (9, 9, 9, 255)))
        before = {name: (self.folder / name).read_bytes() for name in self.files()}
        for name in ("wood.png", "rough.png", "metal.png"):
            self.fails("render", "a.obj", "-o", name, "--size", "4x4", says="is an input and would be overwritten")
        self.assertEqual({name: (self.folder / name).read_bytes() for name in self.files()}, before)

    def test_what_a_scene_names_to_no_effect_is_not_overwritten_either(self):
        grey = png(1, 1, lambda x, y: (9, 9, 9, 255))
        names = {"shine.png": "map_Ns shine.png", "relief.png": "disp -bm 2 relief.png", "a b.png": "refl a b.png"}
        self.write("a.mtl", "newmtl w\nKd 1 1 1\n" + "\n".join(names.values()) + "\nnewmtl unused\nmap_Kd spare.png\n")
        self.write("a.obj", obj("w"))
        self.write("b.ply", "ply\nformat ascii 1.0\ncomment TextureFile shine.png\nelement vertex 3\nproperty float x\nproperty float y\n"
                            "property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
                            "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n")  # fmt: skip
        for name in (*names, "spare.png", "not-spare.png"):
            self.write(name, grey)
        for scene, name in (*(("a.obj", n) for n in (*names, "spare.png")), ("b.ply", "shine.png")):
            self.fails("render", scene, "-o", name, "--size", "4x4", "-q", says="is an input and would be overwritten")
        # A longer name that ends alike is another.
        self.succeeds("render", "a.obj", "-o", "not-spare.png", "--size", "4x4", "--spp", "1", "-q")

    def test_library_in_another_folder_finds_its_own_maps(self):
        self.write("maps/w.mtl", "newmtl w\nmap_Kd wood.png\n")
        self.write("maps/wood.png", png(1, 1, lambda x, y: (9, 9, 9, 255)))
        self.write("a.obj", obj("w", library="maps/w.mtl", uvs=((0, 0), (1, 0), (0, 1), (1, 1))))
        self.assertEqual(self.info("a.obj")["warnings"], [])

    def test_archive_with_one_scene_and_its_maps(self):
        library = "newmtl w\nmap_Kd ..\\..\\elsewhere\\wood.png\n"
        wood = png(1, 1, lambda x, y: (9, 9, 9, 255))
        with zipfile.ZipFile(self.folder / "a.zip", "w") as archive:
            archive.writestr("model/a.obj", obj("w", uvs=((0, 0), (1, 0), (0, 1), (1, 1))))
            archive.writestr("model/a.mtl", library)
            archive.writestr("model/wood.png", wood)
        found = self.info("a.zip")
        self.assertEqual((found["format"], found["archive_entry"], found["warnings"]), ("OBJ", "model/a.obj", []))

    def test_root_holds_for_libraries_and_maps(self):
        self.write("secret.mtl", "newmtl w\nKd 1 0 0\n")
        self.write("secret.png", png(1, 1, lambda x, y: (9, 9, 9, 255)))
        self.write("in/a.obj", obj("w", library="../secret.mtl"))
        told = " ".join(self.info("in/a.obj")["warnings"])
        self.assertEqual(told, "")
        self.assertEqual(json.loads(self.succeeds("info", "in/a.obj", "--json").out)["materials"][0]["name"], "w")
        result = self.succeeds("info", "in/a.obj", "--json", "--root", "in")
        self.assertIn("are missing", " ".join(json.loads(result.out)["warnings"]))
        self.write("in/a.mtl", "newmtl w\nmap_Kd ../secret.png\n")
        self.write("in/b.obj", obj("w", uvs=((0, 0), (1, 0), (0, 1), (1, 1))))
        self.succeeds("info", "in/b.obj")
        self.fails("info", "in/b.obj", "--root", "in", says="leads out of")


if __name__ == "__main__":
    main()
