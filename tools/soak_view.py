#!/usr/bin/env python3
"""Load, switch and resize in the window for a long time, and see that its memory stays flat.

    tools/soak_view.py PROGRAM [--minutes 30] MODEL…

Needs Xvfb. Prints the resident memory every half minute; exit 1 where its last quarter is above its second by more than a tenth."""

import argparse
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import time

ROUNDS = 100000  # more than fit into any time


def steps(models):
    for i in range(ROUNDS):
        yield f'drop "{models[i % len(models)]}"'
        if i % 3:  # else the next action comes while it loads
            yield "wait loaded 0 10min\nwait drawn 1 10min"
        yield f"size {400 + 60 * (i % 5)}x{300 + 40 * (i % 3)}"
        yield "drag 60,60 160,90\nscroll 2 100,100\nkey F\nkey V\nkey L\nkey R\nkey T\nsleep 200ms\nkey T\nwait drawn 1 10min"


def resident_mb(process):
    return int(re.search(r"VmRSS:\s+([0-9]+)", pathlib.Path(f"/proc/{process.pid}/status").read_text())[1]) / 1024


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("program")
    parser.add_argument("models", nargs="+", type=pathlib.Path)
    parser.add_argument("--minutes", type=float, default=30.0)
    arguments = parser.parse_args()
    models = [model.resolve() for model in arguments.models]
    read, write = os.pipe()
    server = subprocess.Popen(["Xvfb", "-displayfd", str(write), "-screen", "0", "1024x768x24"], pass_fds=[write])
    os.close(write)
    with os.fdopen(read) as numbers, tempfile.NamedTemporaryFile("w", suffix=".txt") as script:
        script.write("\n".join(steps(models)) + "\n")
        script.flush()
        environment = {**os.environ, "DISPLAY": f":{numbers.readline().strip()}"}
        viewer = subprocess.Popen([arguments.program, "view", str(models[0]), "--size", "640x400", "--script", script.name],
                                  env=environment, stderr=subprocess.DEVNULL)  # fmt: skip
        begin, sizes = time.monotonic(), []
        while time.monotonic() - begin < 60.0 * arguments.minutes and viewer.poll() is None:
            time.sleep(min(30.0, 60.0 * arguments.minutes / 40.0))
            sizes.append(resident_mb(viewer))
            print(f"{(time.monotonic() - begin) / 60.0:6.1f} min  {sizes[-1]:8.1f} MB", flush=True)
        ended = viewer.poll()
        viewer.terminate()
        viewer.wait()
        server.terminate()
        server.wait()
    if ended is not None:
        sys.exit(f"the window ended by itself with {ended}")
    quarter = len(sizes) // 4
    early, late = max(sizes[quarter : 2 * quarter]), max(sizes[-quarter:])
    print(f"second quarter {early:.1f} MB, last {late:.1f} MB")
    sys.exit(1 if late > 1.1 * early else 0)


if __name__ == "__main__":
    main()
