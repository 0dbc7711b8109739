#!/usr/bin/env python3
"""What it costs to divide a picture, and what a crash loses:

    bench/parts.py --candela build/release/bin/candela --model DamagedHelmet.glb --env potsdamer_platz_1k.hdr

- four parts, one after the other, and their merge, over one run, in CPU seconds;
- merge of eight parts of 1920x1080 with layers;
- samples that are there again with --resume after the program was killed, over those that it had taken.

CPU seconds of the program, and wall seconds; by turns, the least of --runs.
"""

import argparse
import json
import pathlib
import signal
import subprocess
import tempfile
import time

from sets import measure, measure_by_turns

PARTS = 4


def division(o, folder):
    one = [o.candela, "render", o.model, "--env", o.env, "--size", "640x480", "--spp", 256, "-q"]
    parts = [folder / f"{k}.part" for k in range(1, PARTS + 1)]
    rows = {
        "one run": [[*one, "-o", folder / "one.exr"]],
        "four parts": [[*one, "--part", f"{k + 1}/{PARTS}", "-o", part] for k, part in enumerate(parts)],
        "their merge": [[o.candela, "merge", *parts, "-o", folder / "merged.exr", "-q"]],
    }
    seconds = measure_by_turns(rows, o.runs)
    print("| | CPU s | wall s | CPU s over one run |\n|---|---|---|---|")
    for name, (cpu, wall) in seconds.items():
        print(f"| {name} | {cpu:.2f} | {wall:.2f} | {cpu / seconds['one run'][0]:.3f} |")
    same = (folder / "one.exr").read_bytes() == (folder / "merged.exr").read_bytes()
    print(f"the same bytes: {'yes' if same else 'NO'}\n")


def merge(o, folder):
    scene = [o.candela, "render", o.model, "--env", o.env, "--size", "1920x1080", "--spp", 128, "--aov", "albedo,normal,depth,instance", "-q"]
    parts = [folder / f"large-{k}.part" for k in range(1, 9)]
    for k, part in enumerate(parts):
        measure([[*scene, "--part", f"{k + 1}/8", "-o", part]])
    size = sum(part.stat().st_size for part in parts) / 8e6
    seconds = measure_by_turns({"merge": [[o.candela, "merge", *parts, "-o", folder / "large.exr", "-q"]]}, o.runs)
    print(f"merge of 8 parts of 1920x1080 with albedo, normal, depth, instance, {size:.0f} MB each: "
          f"{seconds['merge'][0]:.2f} CPU s, {seconds['merge'][1]:.2f} s\n")  # fmt: skip


def crash(o, folder):
    """Killed after 17 s; the statistics of one more sample tell what was kept."""
    kept, killed_s = folder / "kept", 17.0
    command = [o.candela, "render", o.model, "--env", o.env, "--size", "640x480", "--spp", 1 << 16, "-o", folder / "long.exr",
               "--checkpoint", kept, "--resume", "-q", "--stats", folder / "stats.json"]  # fmt: skip
    program = subprocess.Popen([str(word) for word in command])
    begin = time.monotonic()
    time.sleep(killed_s)
    program.send_signal(signal.SIGKILL)
    program.wait()
    age = time.time() - kept.stat().st_mtime
    program = subprocess.Popen([str(word) for word in command])
    time.sleep(2.0)
    program.send_signal(signal.SIGINT)
    program.wait()
    samples = json.loads((folder / "stats.json").read_text())["spp"]
    print(f"killed after {time.monotonic() - begin - 2:.0f} s: the last checkpoint was {age:.1f} s old, "
          f"{kept.stat().st_size / 1e6:.0f} MB; {samples:.0f} samples per pixel 2 s later")  # fmt: skip


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    for name in ("candela", "model", "env"):
        parser.add_argument(f"--{name}", required=True)
    parser.add_argument("--runs", type=int, default=3)
    o = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        for bench in (division, merge, crash):
            bench(o, folder)


if __name__ == "__main__":
    main()
