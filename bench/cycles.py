#!/usr/bin/env python3
"""Candela beside Blender's Cycles on one view: CPU seconds, wall time, memory, and error against each one's own reference.

    bench/cycles.py --candela build/release/bin/candela --exr-error build/release/bin/exr_error \\
                    --peer render_cycles.py --model helmet.glb --env street.hdr -o build/cycles

`--peer` is a script for Blender's Python that takes --gltf --env --out --w --h --spp --eye --target --vfov --seed --bounces
and renders the same picture with a box filter, no clamping and no denoising. Reference pictures are kept in the output
folder and rendered once.
"""
import argparse
import os
import pathlib
import subprocess
import sys
import time

EYE, TARGET, FOV, BOUNCES = "1.8,0.9,2.6", "0,0,0", "40", "8"


def measure(command, output):
    """(user + system seconds, wall seconds, peak MB) of one run that writes `output`."""
    output.unlink(missing_ok=True)
    # Blender takes the first Python on the path for its own; the system's has the modules it was built with.
    environment = dict(os.environ, PATH="/usr/sbin:/usr/bin:/sbin:/bin")
    start = time.monotonic()
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, env=environment)
    _, status, usage = os.wait4(process.pid, 0)
    wall = time.monotonic() - start
    if status != 0 or not output.exists():
        sys.exit(f"{command[0]} failed: {' '.join(command)}")
    return usage.ru_utime + usage.ru_stime, wall, usage.ru_maxrss / 1024


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    for name in ("candela", "exr-error", "peer", "model", "env"):
        parser.add_argument(f"--{name}", required=True)
    parser.add_argument("-o", "--output", type=pathlib.Path, required=True)
    parser.add_argument("--reference-spp", type=int, default=2048)
    options = parser.parse_args()
    options.output.mkdir(parents=True, exist_ok=True)

    def candela(out, width, height, spp, seed=1):
        return [options.candela, "render", options.model, "-o", str(out), "--size", f"{width}x{height}", "--spp", str(spp),
                "--eye", EYE, "--target", TARGET, "--fov", FOV, "--bounces", BOUNCES, "--env", options.env, "--seed",
                str(seed), "--quiet"]

    def cycles(out, width, height, spp, seed=1):
        return ["blender", "-b", "--factory-startup", "-noaudio", "--python-exit-code", "1", "-P", options.peer, "--", "--gltf", options.model,
                "--env", options.env, "--out", str(out), "--w", str(width), "--h", str(height), "--spp", str(spp), f"--eye={EYE}",
                f"--target={TARGET}", "--vfov", FOV, "--seed", str(seed), "--bounces", BOUNCES]

    print("| picture | renderer | CPU s | wall s | peak MB |\n|---|---|---|---|---|")
    for width, height, spp in ((1280, 720, 1), (1280, 720, 64)):
        rows = {}
        for name, command in (("Cycles", cycles), ("Candela", candela)):
            picture = options.output / f"{name}_{width}_{spp}.exr"
            rows[name] = measure(command(picture, width, height, spp), picture)
            cpu, wall, memory = rows[name]
            print(f"| {width}x{height}, {spp} spp | {name} | {cpu:.2f} | {wall:.2f} | {memory:.0f} |", flush=True)
        ratio = [a / b for a, b in zip(rows["Candela"], rows["Cycles"])]
        print(f"| | ratio | {ratio[0]:.3f} | {ratio[1]:.3f} | {ratio[2]:.3f} |", flush=True)

    print("\nError at 480x270, 64 spp, against the renderer's own reference of "
          f"{options.reference_spp} spp with another seed:")
    for name, command in (("Cycles", cycles), ("Candela", candela)):
        reference = options.output / f"{name}_reference.exr"
        if not reference.exists():
            measure(command(reference, 480, 270, options.reference_spp, seed=77), reference)
        picture = options.output / f"{name}_480.exr"
        measure(command(picture, 480, 270, 64), picture)
        error = subprocess.run([options.exr_error, str(picture), str(reference)], capture_output=True, text=True, check=True)
        print(f"{name}: {error.stdout.strip()}", flush=True)


if __name__ == "__main__":
    main()
