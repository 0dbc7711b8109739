#!/usr/bin/env python3
"""How soon packed files are there: bench/packed.py CANDELA NODE_MODULES KTX2.gltf MODEL.glb

NODE_MODULES is the folder of tests/interop/install.sh; KTX2.gltf a model with textures in KTX 2, which is also drawn with PNG in their
place; MODEL.glb a textured one of some megabytes, which is packed. The least of ten runs by turns, milliseconds of wall time and of CPU.
"""

import json
import math
import os
import pathlib
import resource
import struct
import subprocess
import sys
import tempfile
import time

TURNS = 10
TESTS = pathlib.Path(__file__).resolve().parents[1] / "tests"
sys.path[:0] = [str(TESTS / "interop"), str(TESTS / "cli")]

from sources import Glb  # noqa: E402


def timed(*command, **environment):
    """Seconds of wall time and of CPU."""
    before, begin = resource.getrusage(resource.RUSAGE_CHILDREN), time.monotonic()
    subprocess.run([*map(str, command)], check=True, stdout=subprocess.DEVNULL, env={**os.environ, **environment})
    wall, after = time.monotonic() - begin, resource.getrusage(resource.RUSAGE_CHILDREN)
    return wall, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def by_turns(runs):
    """The least of each of `runs`, by column."""
    found = {name: [] for name in runs}
    for _ in range(TURNS):
        for name, run in runs.items():
            found[name].append(run())
    return {name: [1000 * min(column) for column in zip(*rows)] for name, rows in found.items()}


def hills(side, phase):
    """A wavy sheet: positions, normals, coordinates, triangles."""
    positions, normals, uvs, triangles = [], [], [], []
    for y in range(side):
        for x in range(side):
            u, v = x / (side - 1), y / (side - 1)
            a, b = 11 * u + phase, 7 * v - phase
            slope = (0.55 * math.cos(a) * math.cos(b), -0.35 * math.sin(a) * math.sin(b))
            length = math.sqrt(1 + slope[0] ** 2 + slope[1] ** 2)
            positions.append((u, 0.05 * math.sin(a) * math.cos(b), v + 1.1 * phase))
            normals.append((-slope[0] / length, 1 / length, -slope[1] / length))
            uvs.append((u, v))
            if x and y:
                i = y * side + x
                triangles += [i - side - 1, i - 1, i, i - side - 1, i, i - side]
    return positions, normals, uvs, triangles


def hilly_scene(sheets, side):
    glb = Glb()
    for k in range(sheets):
        positions, normals, uvs, triangles = hills(side, k)
        attributes = {"POSITION": glb.floats(positions, bounds=True), "NORMAL": glb.floats(normals), "TEXCOORD_0": glb.floats(uvs)}
        primitive = {"attributes": attributes, "indices": glb.integers(triangles, 5125, "I")}
        glb.json["scenes"][0]["nodes"].append(glb.add("nodes", {"mesh": glb.add("meshes", {"primitives": [primitive]})}))
    text = json.dumps({**glb.json, "buffers": [{"byteLength": len(glb.data)}]}).encode()
    text += b" " * (-len(text) % 4)
    data = glb.data + b"\0" * (-len(glb.data) % 4)
    chunks = struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(data), b"BIN\0") + data
    return b"glTF" + struct.pack("<II", 2, 12 + len(chunks)) + chunks


def first_pictures(program, modules, ktx2, folder):
    twin = folder / "twin"
    twin.mkdir()
    subprocess.run(["node", TESTS / "interop/decode_plain.mjs", ktx2, twin], check=True, env={**os.environ, "CANDELA_NODE_MODULES": modules})
    caches = [0]

    def draw(scene, cold):
        caches[0] += 1
        cache = str(folder / (f"cache{caches[0]}" if cold else "cache"))
        size = ("--engine", "raster", "--size", "1280x720", "--env", "studio", "-q", "-o", folder / "a.png")
        return timed(program, "render", scene, *size, XDG_CACHE_HOME=cache, MESA_SHADER_CACHE_DIR=cache)

    scenes = {"KTX 2": ktx2, "PNG": twin / "plain.gltf"}
    for cold in (True, False):
        draw(ktx2, False)
        found = by_turns({name: lambda scene=scene: draw(scene, cold) for name, scene in scenes.items()})
        for name, (wall, cpu) in found.items():
            print(f"| first picture, {name}, {'nothing' if cold else 'environment and shaders'} cached | {wall:.0f} | {cpu:.0f} |")


def packed(modules, plain, folder):
    """`plain` by Draco and by meshopt."""
    tools = pathlib.Path(modules) / ".bin"
    files = {kind: folder / f"{plain.stem}-{kind}.glb" for kind in ("Draco", "meshopt")}
    quiet = {"check": True, "stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    subprocess.run([tools / "gltf-transform", "draco", plain, files["Draco"]], **quiet)
    subprocess.run([tools / "gltfpack", "-i", plain, "-o", files["meshopt"], "-c"], **quiet)
    return files


def with_basis(modules, plain, folder):
    """`plain` with its textures in KTX 2."""
    file = folder / f"{plain.stem}-ktx2.glb"
    command = ["node", TESTS / "interop/encode_basis.mjs", plain, file, "etc1s"]
    subprocess.run(command, check=True, env={**os.environ, "CANDELA_NODE_MODULES": modules})
    return file


def draco_on_cores(program, file, folder):
    def load(threads):
        options = ("--size", "16x16", "--spp", "1", "--threads", threads, "-q", "-o", folder / "b.png", "--stats", folder / "s.json")
        _, cpu = timed(program, "render", file, *options)
        return json.loads((folder / "s.json").read_text())["load_s"], cpu

    for threads, (wall, _) in by_turns({n: lambda n=n: load(n) for n in (1, 2)}).items():
        print(f"| loading {file.stat().st_size / 1e6:.1f} MB of Draco, `--threads {threads}` | {wall:.0f} | |")


def main():
    program, modules, ktx2, model = sys.argv[1:]
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        print("| | wall ms | CPU ms |\n|---|---|---|")
        first_pictures(program, modules, pathlib.Path(ktx2).resolve(), folder)
        (folder / "hills.glb").write_bytes(hilly_scene(16, 160))
        hills_of = packed(modules, folder / "hills.glb", folder)
        draco_on_cores(program, hills_of["Draco"], folder)
        model = pathlib.Path(model)
        files = {f"geometry alone, {kind}": file for kind, file in hills_of.items()}
        (folder / "large.glb").write_bytes(hilly_scene(64, 160))
        files["four times as much, Draco"] = packed(modules, folder / "large.glb", folder)["Draco"]
        files.update({f"{model.stem}, {kind}": file for kind, file in packed(modules, model, folder).items()})
        files[f"{model.stem}, ETC1S"] = with_basis(modules, model, folder)
        for kind, (wall, cpu) in by_turns({kind: lambda f=file: timed(program, "info", f) for kind, file in files.items()}).items():
            print(f"| `info` of {files[kind].stat().st_size / 1e6:.1f} MB: {kind} | {wall:.0f} | {cpu:.0f} |")


if __name__ == "__main__":
    main()
