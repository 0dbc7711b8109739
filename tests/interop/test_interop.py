#!/usr/bin/env python3
"""What real tools write of six small scenes is drawn as the scenes themselves are, by both engines.

    test_interop.py [--table] [TOOL...]

The tools of npm are looked for in the folder that CANDELA_NODE_MODULES names (install.sh makes one), `assimp`, `blender` and `node` on PATH.
What is absent is skipped with a message; where all are, the exit code is 77. --table prints the table of docs/formats.md.
"""

import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent / "cli")]

from candela import PROGRAM, SKIPPED, png_pixels  # noqa: E402
from sources import SOURCES  # noqa: E402

MODULES = os.environ.get("CANDELA_NODE_MODULES", "")
VIEW = ("--size", "72x54", "--eye", "1.5,1.2,3.2", "--target", "0,0,0", "--fov", "40deg", "--env", "studio", "-q")
# Mean difference in codes. Lossless writers leave noise and rounding, lossy ones what their codecs lose.
EXACT, LOSSY, TEXTURE = 0.7, 1.5, 4.0
TEXTURES = {"textured", "alpha"}


def npm(name):
    path = pathlib.Path(MODULES) / ".bin" / name
    return [str(path)] if MODULES and path.exists() else None


def script(name):
    return ["node", str(HERE / name)] if MODULES and shutil.which("node") else None


def on_path(*command):
    return list(command) if shutil.which(command[0]) else None


class Tool:
    """`command` with IN and OUT put in; `shape`: the format has none of glTF's surfaces, so that outlines alone are compared;
    `lacks`: sources that the tool itself cannot carry, and why."""

    def __init__(self, name, command, most, out="out.glb", shape=False, lacks=None, both=("path", "raster")):
        self.name, self.command, self.most, self.out, self.shape, self.both = name, command, most, out, shape, both
        self.lacks = lacks or {}


def tools():
    optimize, pack, assimp = npm("gltf-transform"), npm("gltfpack"), on_path("assimp", "export")
    blender = on_path("blender", "-b", "--factory-startup", "-noaudio", "-P", str(HERE / "blender_export.py"), "--")
    no_textures = dict.fromkeys(TEXTURES, "no textures under node")

    def with_args(command, *arguments):
        return command and [*command, *arguments]

    all_tools = [Tool("gltf-transform optimize", with_args(optimize, "optimize", "IN", "OUT"), TEXTURE)]
    for codec in ("draco", "meshopt", "quantize"):
        command = with_args(optimize, "optimize", "IN", "OUT", "--compress", codec, "--texture-compress", "false")
        all_tools.append(Tool(f"gltf-transform optimize --compress {codec}", command, LOSSY))
    for codec in ("webp", "avif"):
        command = with_args(optimize, "optimize", "IN", "OUT", "--compress", "false", "--texture-compress", codec)
        all_tools.append(Tool(f"gltf-transform optimize --texture-compress {codec}", command, TEXTURE))
    if shutil.which("toktx") or shutil.which("ktx"):
        for codec in ("etc1s", "uastc"):
            all_tools.append(Tool(f"gltf-transform {codec}", with_args(optimize, codec, "IN", "OUT"), TEXTURE))
    for option in ("-noq", "-c", "-cc", "-tc"):
        command = with_args(pack, "-i", "IN", "-o", "OUT", option)
        all_tools.append(Tool(f"gltfpack {option}", command, TEXTURE if option == "-tc" else LOSSY))
    all_tools.append(Tool("three GLTFExporter", with_args(script("three_export.mjs"), "IN", "OUT"), EXACT, lacks=no_textures))
    all_tools.append(Tool("Babylon GLTF2Export", with_args(script("babylon_export.mjs"), "IN", "OUT"), EXACT))
    for kind in ("glb2", "gltf2", "obj", "stl", "ply", "dae", "3ds", "fbx"):
        is_gltf = kind in ("glb2", "gltf2")
        lacks = {"alpha": "writes opacity squared", "morphed": "drops the weights"}
        if not is_gltf:
            lacks.update({"skinned": "written unbent", "alpha": "no coverage"})
        if kind == "fbx":
            lacks = dict.fromkeys(SOURCES, "Assimp does not read its own FBX")
        if kind == "3ds":
            lacks = dict.fromkeys(SOURCES, "written with y up into a format of z up")
        out = {"glb2": "out.glb", "gltf2": "out.gltf"}.get(kind, f"out.{kind}")
        command = with_args(assimp, "IN", "OUT", f"-f{kind}")
        all_tools.append(Tool(f"Assimp {kind}", command, EXACT if is_gltf else LOSSY, out, shape=not is_gltf, lacks=lacks))
    for kind in ("glb", "fbx", "obj", "stl", "ply", "dae"):
        lacks = {} if kind == "glb" else {"alpha": "no coverage"}
        if kind == "dae":
            lacks["skinned"] = "Blender does not read its own"
        command = with_args(blender, "IN", "OUT")
        all_tools.append(Tool(f"Blender {kind}", command, EXACT, f"out.{kind}", shape=kind != "glb", lacks=lacks))
    return all_tools


def picture(scene, engine, shape, folder):
    """The codes of its picture, or what went wrong."""
    out = folder / f"{engine}.png"
    options = ["--spp", "64"] if engine == "path" else []
    if shape:
        options += ["--background", "transparent"]
    done = subprocess.run([PROGRAM, "render", scene, "-o", out, "--engine", engine, *VIEW, *options], capture_output=True, check=False)
    if done.returncode != 0:
        return done.stderr.decode().strip()
    _, _, channels, rows = png_pixels(out)
    data = b"".join(rows)
    if not shape:
        return [v for i, v in enumerate(data) if channels == 3 or i % 4 < 3]
    return list(data[3::4]) if channels == 4 else [255] * (len(data) // channels)


def difference(a, b):
    return sum(abs(x - y) for x, y in zip(a, b)) / len(a)


def judge(tool, name, source, references, folder):
    """A cell of the table, and whether it is a failure."""
    if name in tool.lacks:
        return f"– ({tool.lacks[name]})", False
    result = folder / tool.out
    command = [{"IN": str(source), "OUT": str(result)}.get(word, word) for word in tool.command]
    try:
        done = subprocess.run(command, capture_output=True, check=False, timeout=300, cwd=folder)
    except subprocess.TimeoutExpired:
        return "– (the tool takes too long)", False
    if not result.exists():
        said = (done.stderr or done.stdout).decode(errors="replace").strip().splitlines()
        return f"– (the tool writes nothing: {said[-1][:60] if said else 'silence'})", False
    cells, failed = [], False
    for engine in tool.both:
        key = (name, engine, tool.shape)
        if key not in references:
            references[key] = picture(source, engine, tool.shape, folder)
        found = picture(result, engine, tool.shape, folder)
        if isinstance(found, str):
            return f"refused: {found}", True
        value = difference(found, references[key])
        failed |= value > tool.most
        cells.append(f"{value:.2f}")
    return " / ".join(cells), failed


def main():
    wanted = [a for a in sys.argv[1:] if not a.startswith("--")]
    present = [t for t in tools() if t.command and (not wanted or any(w in t.name for w in wanted))]
    for tool in tools():
        if tool.command is None:
            print(f"skipped: {tool.name} is absent", file=sys.stderr)
    if not present:
        print("skipped: none of the tools is here (see tests/interop/install.sh)", file=sys.stderr)
        return SKIPPED
    failures, references = 0, {}
    with tempfile.TemporaryDirectory(prefix="candela-interop-") as top:
        folder = pathlib.Path(top)
        files = {}
        for name, make in SOURCES.items():
            files[name] = folder / f"{name}.glb"
            files[name].write_bytes(make())
        print("| writer | " + " | ".join(SOURCES) + " |\n|" + "---|" * (len(SOURCES) + 1))
        for index, tool in enumerate(present):
            cells = []
            for name, source in files.items():
                own = folder / f"{index}-{name}"
                own.mkdir()
                cell, failed = judge(tool, name, source, references, own)
                failures += failed
                cells.append(f"**{cell}**" if failed else cell)
            print(f"| {tool.name}{' (outline)' if tool.shape else ''} | " + " | ".join(cells) + " |", flush=True)
    if failures:
        print(f"{failures} results differ or are refused (in bold)", file=sys.stderr)
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
