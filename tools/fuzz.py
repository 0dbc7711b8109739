#!/usr/bin/env python3
"""Runs the fuzz targets of a build, each for some minutes of processor time, from the seeds that their makers write.

    tools/fuzz.py BUILD MINUTES [KIND…]     KIND as in the test names fuzz.KIND; without one, all of them

Inputs that reach new code stay in BUILD/tests/fuzz/corpus/KIND, so that the next run goes on from there. A finding
stands in BUILD/tests/fuzz/findings/KIND-…; the exit code is then 1.
"""

import json
import pathlib
import resource
import subprocess
import sys

SLICE_S = 120  # of wall time between two looks at the processor's


def commands_of(build):
    """The commands of the tests fuzz.* whose programs are built, by their kind."""
    shown = subprocess.run(["ctest", "--test-dir", build, "-R", r"^fuzz\.", "--show-only=json-v1"],
                           check=True, capture_output=True, text=True)
    tests = json.loads(shown.stdout)["tests"]
    return {test["name"].removeprefix("fuzz."): test["command"] for test in tests if "command" in test}


def cpu_s():
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def executions_of(log):
    """From libFuzzer's last line, "Done 123 runs in 4 second(s)"."""
    words = [line.split() for line in log.splitlines() if line.startswith("Done ")]
    return int(words[-1][1]) if words else 0


def fuzz(kind, command, minutes, findings):
    """Whether the target stood it; prints one line."""
    kept = [word for word in command if not word.startswith("-max_total_time")]
    begin, executions = cpu_s(), 0
    while cpu_s() - begin < 60 * minutes:
        left = max(1, min(SLICE_S, int(60 * minutes - (cpu_s() - begin))))
        run = subprocess.run([kept[0], f"-max_total_time={left}", f"-artifact_prefix={findings}/{kind}-", *kept[1:]],
                             stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, errors="replace")
        executions += executions_of(run.stderr)
        if run.returncode != 0:
            print(f"{kind}: FOUND something\n{run.stderr[-3000:]}", flush=True)
            return False
    print(f"{kind}: {(cpu_s() - begin) / 60:.1f} min of processor time, {executions} inputs, nothing found", flush=True)
    return True


def main():
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    build, minutes, wanted = pathlib.Path(sys.argv[1]), float(sys.argv[2]), sys.argv[3:]
    commands = commands_of(build)
    makers = {kind: command for kind, command in commands.items() if kind.endswith("_corpus")}
    targets = {kind: command for kind, command in commands.items() if kind not in makers}
    unknown = [kind for kind in wanted if kind not in targets]
    if unknown or not targets:
        sys.exit(f"fuzz: no target {', '.join(unknown)}; there are {', '.join(sorted(targets))}")
    findings = build / "tests" / "fuzz" / "findings"
    findings.mkdir(parents=True, exist_ok=True)
    stood = True
    for kind in wanted or sorted(targets):
        subprocess.run(makers[kind + "_corpus"], check=True, stdout=subprocess.DEVNULL)
        stood = fuzz(kind, targets[kind], minutes, findings) and stood
    sys.exit(0 if stood else 1)


if __name__ == "__main__":
    main()
