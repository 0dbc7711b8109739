#!/usr/bin/env python3
"""How large a scene may be: bench/scale.py FOLDER CANDELA [CANDELA...] [--only WORD]

Makes the scenes in FOLDER where they are not there yet, then runs each program on each of them: seconds of wall time and of CPU, the
largest resident set, and what `--stats` says of loading and building. The least of TURNS runs, by turns.
"""

import argparse
import json
import math
import os
import pathlib
import struct
import subprocess
import tempfile
import time
import zlib
from array import array

TURNS = 3
TEXTURES = 200
TEXTURE_SIDE = 4096


def pad(data, fill):
    return data + fill * (-len(data) % 4)


def write_glb(path, document, chunks):
    """`chunks` are the binary's parts, each written where it lies."""
    size = sum(map(len, chunks))
    document["buffers"] = [{"byteLength": size}]
    text = pad(json.dumps(document, separators=(",", ":")).encode(), b" ")
    with open(path, "wb") as out:
        out.write(struct.pack("<4sII", b"glTF", 2, 12 + 8 + len(text) + 8 + size))
        out.write(struct.pack("<I4s", len(text), b"JSON") + text)
        out.write(struct.pack("<I4s", size, b"BIN\0"))
        for chunk in chunks:
            out.write(chunk)


def sheet(side, has_tangents):
    """A wavy sheet of 2 side² triangles: vertices are shared, as in models; what each attribute holds, and the indices."""
    positions, normals, uvs, tangents = array("f"), array("f"), array("f"), array("f")
    for y in range(side + 1):
        v = y / side
        for x in range(side + 1):
            u = x / side
            a, b = 40 * u, 30 * v
            height = 0.02 * math.sin(a) * math.cos(b)
            sx, sz = 0.8 * math.cos(a) * math.cos(b), -0.6 * math.sin(a) * math.sin(b)
            n = 1 / math.sqrt(1 + sx * sx + sz * sz)
            positions.extend((u, height, v))
            normals.extend((-sx * n, n, -sz * n))
            uvs.extend((u, v))
            if has_tangents:
                t = 1 / math.sqrt(1 + sx * sx)
                tangents.extend((t, sx * t, 0, 1))
    indices = array("I")
    for y in range(side):
        for x in range(side):
            i = y * (side + 1) + x
            indices.extend((i, i + side + 1, i + 1, i + 1, i + side + 1, i + side + 2))
    attributes = {"POSITION": (positions, 3), "NORMAL": (normals, 3), "TEXCOORD_0": (uvs, 2)}
    if has_tangents:
        attributes["TANGENT"] = (tangents, 4)
    return attributes, indices


class Model:
    def __init__(self):
        self.chunks, self.size = [], 0
        self.document = {"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": []}], "nodes": [], "meshes": [],
                         "accessors": [], "bufferViews": [], "materials": [{"doubleSided": True}]}  # fmt: skip

    def accessor(self, data, count, kind, component, **more):
        self.chunks.append(data)
        self.document["bufferViews"].append({"buffer": 0, "byteOffset": self.size, "byteLength": len(data)})
        self.size += len(data)
        self.document["accessors"].append({"bufferView": len(self.document["bufferViews"]) - 1, "count": count,
                                           "type": kind, "componentType": component, **more})  # fmt: skip
        return len(self.document["accessors"]) - 1

    def mesh(self, attributes, indices, material=0):
        kinds = {2: "VEC2", 3: "VEC3", 4: "VEC4"}
        bounds = {"min": [0, -0.02, 0], "max": [1, 0.02, 1]}
        found = {name: self.accessor(memoryview(data).cast("B"), len(data) // width, kinds[width], 5126,
                                     **(bounds if name == "POSITION" else {}))
                 for name, (data, width) in attributes.items()}  # fmt: skip
        primitive = {"attributes": found, "material": material,
                     "indices": self.accessor(memoryview(indices).cast("B"), len(indices), "SCALAR", 5125)}  # fmt: skip
        self.document["meshes"].append({"primitives": [primitive]})
        return len(self.document["meshes"]) - 1

    def node(self, **more):
        self.document["nodes"].append(more)
        self.document["scenes"][0]["nodes"].append(len(self.document["nodes"]) - 1)

    def write(self, path):
        write_glb(path, self.document, self.chunks)


def make_unique(path, triangles, meshes, has_tangents=False):
    """Sheets beside each other, each with bytes of its own."""
    attributes, indices = sheet(round(math.sqrt(triangles / meshes / 2)), has_tangents)
    columns = math.ceil(math.sqrt(meshes))
    model = Model()
    if has_tangents:
        model.document["images"] = [{"uri": "normal.png"}]
        model.document["textures"] = [{"source": 0}]
        model.document["materials"][0]["normalTexture"] = {"index": 0}
        (path.parent / "normal.png").write_bytes(png(256, 0x8080FF, 0x9080F8))
    for i in range(meshes):
        model.node(mesh=model.mesh(attributes, indices), translation=[1.05 * (i % columns), 0, 1.05 * (i // columns)])
    model.write(path)


def make_instanced(path, is_extension):
    """A thousand sheets of 100 000 triangles."""
    attributes, indices = sheet(round(math.sqrt(50_000)), False)
    places = [(1.05 * (i % 32), 0.0, 1.05 * (i // 32)) for i in range(1000)]
    model = Model()
    mesh = model.mesh(attributes, indices)
    if is_extension:
        data = array("f", [x for place in places for x in place])
        accessor = model.accessor(memoryview(data).cast("B"), len(places), "VEC3", 5126)
        model.node(mesh=mesh, extensions={"EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": accessor}}})
        model.document["extensionsUsed"] = ["EXT_mesh_gpu_instancing"]
    else:
        for place in places:
            model.node(mesh=mesh, translation=place)
    model.write(path)


def png(side, one, other, fine=3):
    """A chessboard of 64 texels with thin lines, which deflates well."""
    dark, light = one.to_bytes(3, "big"), other.to_bytes(3, "big")
    cells = side // 64
    rows = []
    for parity in (0, 1):
        row = b"".join((light if (x + parity) % 2 else dark) * (64 - fine) + b"\xff\xff\xff" * fine for x in range(cells))
        rows.append(b"\0" + row)
    deflate = zlib.compressobj(1)
    body = b"".join(deflate.compress(rows[y // 64 % 2]) for y in range(side)) + deflate.flush()

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    header = struct.pack(">IIBBBBB", side, side, 8, 2, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", body) + chunk(b"IEND", b"")


def make_textured(path):
    """As many small sheets as textures."""
    attributes, indices = sheet(16, False)
    model = Model()
    document = model.document
    document["materials"], document["images"], document["textures"] = [], [], []
    colors = [(37 * i % 256) << 16 | (101 * i % 256) << 8 | (59 * i % 256) for i in range(8)]
    files = [png(TEXTURE_SIDE, color, color ^ 0x7F7F7F) for color in colors]
    for i in range(TEXTURES):
        name = f"texture_{i}.png"
        (path.parent / name).write_bytes(files[i % len(files)])
        document["images"].append({"uri": name})
        document["textures"].append({"source": i})
        document["materials"].append({"pbrMetallicRoughness": {"baseColorTexture": {"index": i}}})
        model.node(mesh=model.mesh(attributes, indices, i), translation=[1.05 * (i % 15), 0, 1.05 * (i // 15)])
    model.write(path)


def measured(command):
    with tempfile.TemporaryDirectory() as folder:
        stats = pathlib.Path(folder) / "stats.json"
        is_render = command[1] == "render"
        extra = ["-q", "-o", f"{folder}/picture.exr", "--stats", stats] if is_render else []
        begin = time.monotonic()
        process = subprocess.Popen([*map(str, command), *map(str, extra)], stdout=subprocess.DEVNULL,
                                   stderr=subprocess.PIPE)  # fmt: skip
        error = process.stderr.read().decode()
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        if process.returncode:
            return error.strip()[-120:]
        row = {"wall": time.monotonic() - begin, "cpu": usage.ru_utime + usage.ru_stime, "mb": usage.ru_maxrss * 1024 / 1e6}
        if is_render:
            found = json.loads(stats.read_text())
            row |= {"load": found["load_s"], "build": found.get("build_s", 0)}
        return row


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("candela", nargs="+")
    parser.add_argument("--only", default="")
    parser.add_argument("--turns", type=int, default=TURNS)
    parser.add_argument("--verbs", nargs="+", default=["info", "path"], help="of info, path and raster, which a driver without a GPU takes minutes for")
    options = parser.parse_args()
    folder = options.folder
    folder.mkdir(parents=True, exist_ok=True)
    scenes = {
        "unique 1 M": ("unique1.glb", lambda p: make_unique(p, 1e6, 4)),
        "unique 10 M": ("unique10.glb", lambda p: make_unique(p, 1e7, 16)),
        "unique 10 M, 1000 meshes": ("many10.glb", lambda p: make_unique(p, 1e7, 1000)),
        "unique 10 M, tangents": ("tangents10.glb", lambda p: make_unique(p, 1e7, 16, True)),
        "100 M by EXT_mesh_gpu_instancing": ("instanced.glb", lambda p: make_instanced(p, True)),
        "100 M by nodes": ("nodes.glb", lambda p: make_instanced(p, False)),
        "200 textures": ("textured.glb", make_textured),
    }
    small = ["--size", "320x180", "--spp", "1"]
    for name, (file, make) in scenes.items():
        if options.only not in name:
            continue
        path = folder / file
        if not path.exists():
            make(path)
        limit = ["--texture-memory", "2GB"] if "textures" in name else []
        commands = {"info": ["info", path], "path": ["render", path, *small, *limit],
                    "raster": ["render", path, "--engine", "raster", *small, *limit]}  # fmt: skip
        for verb, command in commands.items():
            if verb not in options.verbs:
                continue
            runs = {program: [] for program in options.candela}
            for _ in range(options.turns):
                for program in options.candela:
                    runs[program].append(measured([program, *command]))
            for program, rows in runs.items():
                failed = [row for row in rows if isinstance(row, str)]
                text = failed[0] if failed else "  ".join(f"{key} {min(row[key] for row in rows):.2f}" for key in rows[0])
                print(f"{name:36}{verb:8}{text}   {program}", flush=True)


main()
