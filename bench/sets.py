#!/usr/bin/env python3
"""How fast sets of pictures are made, beside other programs:

    bench/sets.py --candela build/release/bin/candela --model DamagedHelmet.glb --env potsdamer_platz_1k.hdr --models MODELS
                  [--f3d-python PYTHON]

- 24 views with depth, normals and numbers by the rasterizer, beside F3D (24 programs, and one; beauty alone) and Blender's Cycles at one
  sample (one program, the same outputs);
- a thumbnail of each model below MODELS, at most 100, in one program, by either engine;
- a turntable of 48 pictures by the path tracer, beside the time of its samples alone.

CPU seconds of the program and all that it starts, and wall seconds; by turns, the least of --runs. PYTHON has `pip install f3d`.
"""

import argparse
import json
import os
import pathlib
import resource
import shutil
import subprocess
import sys
import tempfile
import time

PEERS = pathlib.Path(__file__).parent / "peers"
VIEWS, SIZE = 24, 512


def measure(commands):
    """CPU and wall seconds of commands, one after the other."""
    # Blender takes the first Python on the path for its own; the system's has the modules it was built with.
    environment = {**os.environ, "PATH": "/usr/sbin:/usr/bin:/sbin:/bin"}
    before, begin = resource.getrusage(resource.RUSAGE_CHILDREN), time.monotonic()
    for command in commands:
        done = subprocess.run([str(word) for word in command], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, env=environment)
        if done.returncode != 0:
            sys.exit(f"{' '.join(map(str, command))} failed:\n{done.stderr.decode()[-2000:]}")
    wall, after = time.monotonic() - begin, resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime, wall


def measure_by_turns(rows, runs):
    """The least CPU and wall seconds of each row's commands."""
    best = {}
    for _ in range(runs):
        for name, commands in rows.items():
            seconds = measure(commands)
            best[name] = tuple(map(min, zip(seconds, best.get(name, seconds))))
    return best


def views(o, folder):
    azimuths = [f"{360 * i / VIEWS:g}" for i in range(VIEWS)]
    ours = [o.candela, "render", o.model, "--engine", "raster", "--env", o.env, "--size", f"{SIZE}x{SIZE}", "--turntable", VIEWS,
            "--aov", "depth,normal,instance,material", "-o", folder / "candela%03d.exr", "-q"]  # fmt: skip
    rows = {"Candela, rasterizer": [ours], "Candela, one sample a pixel": [[*ours, "--msaa", 1]]}
    if o.f3d_python:
        peer = [o.f3d_python, PEERS / "f3d_views.py", o.model, SIZE]
        for what, light in (("its headlight", "-"), ("the same light", o.env)):
            rows[f"F3D, {VIEWS} programs, {what}"] = [[*peer, a, light, folder / f"f3d{i}_{{}}.png"] for i, a in enumerate(azimuths)]
            rows[f"F3D, one program, {what}"] = [[*peer, ",".join(azimuths), light, folder / "f3d_{}.png"]]
    if shutil.which("blender", path="/usr/bin"):
        rows["Cycles, 1 sample, one program"] = [["blender", "-b", "--factory-startup", "-noaudio", "--python-exit-code", 1, "-P",
                                                  PEERS / "cycles_views.py", "--", o.model, SIZE, ",".join(azimuths), o.env,
                                                  folder / "cycles"]]  # fmt: skip
    print(f"{VIEWS} views of {SIZE}x{SIZE}\n\n| | CPU s | wall s | pictures/s | Candela's CPU s over it |\n|---|---|---|---|---|")
    best = measure_by_turns(rows, o.runs)
    own = best["Candela, rasterizer"][0]
    for name, (cpu, wall) in best.items():
        print(f"| {name} | {cpu:.2f} | {wall:.2f} | {VIEWS / wall:.1f} | {own / cpu:.2f} |", flush=True)


def thumbnails(o, folder):
    models = sorted(path for path in o.models.rglob("*") if path.suffix in (".glb", ".gltf"))[:100]
    count = len(models)
    command = [o.candela, "render", *models, "-o", str(folder / "thumbnails") + "/", "--size", "256x256", "--background", "white", "-q"]
    rows = {
        "rasterizer": [[*command, "--engine", "raster"]],
        "path tracer, 4 samples, denoised": [[*command, "--spp", 4, "--denoise"]],
    }
    print(f"\n{count} thumbnails of 256x256\n\n| | CPU s | wall s | wall s each |\n|---|---|---|---|")
    for name, (cpu, wall) in measure_by_turns(rows, o.runs).items():
        print(f"| {name} | {cpu:.2f} | {wall:.2f} | {wall / count:.3f} |", flush=True)


def turntable(o, folder):
    print("\n48 pictures of a turntable, path traced\n\n| | all, wall s | samples alone | ratio |\n|---|---|---|---|")
    for size, samples in (("256x256", 16), ("512x512", 16)):
        best = None
        for _ in range(o.runs):
            stats = folder / "stats.json"
            command = [o.candela, "render", o.model, "--env", o.env, "--size", size, "--spp", samples, "--turntable", 48, "-o",
                       folder / "turn%03d.png", "-q", "--stats", stats]  # fmt: skip
            _, wall = measure([command])
            alone = json.loads(stats.read_text())["render_s"]
            if best is None or wall / alone < best[0] / best[1]:
                best = wall, alone
        print(f"| {size}, {samples} samples per pixel | {best[0]:.2f} | {best[1]:.2f} | {best[0] / best[1]:.2f} |", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    for name in ("candela", "model", "env"):
        parser.add_argument(f"--{name}", required=True)
    parser.add_argument("--models", type=pathlib.Path, required=True)
    parser.add_argument("--f3d-python")
    parser.add_argument("--runs", type=int, default=3)
    parser.add_argument("--only", choices=("views", "thumbnails", "turntable"))
    o = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        for part in (views, thumbnails, turntable):
            if o.only in (None, part.__name__):
                part(o, pathlib.Path(name))


if __name__ == "__main__":
    main()
