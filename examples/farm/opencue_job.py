#!/usr/bin/env python3
"""The lines of `candela plan` as a layer of an OpenCue job, its merges as a layer that depends on it.

    opencue_job.py LIST.txt          needs PyPI's opencue_pyoutline
"""

import pathlib
import sys

import outline.cuerun
from outline.modules.shell import ShellSequence


def layer(name, lines):
    # A text of its own would be started without a shell.
    return ShellSequence(name, commands=[["sh", "-c", line] for line in lines.read_text().splitlines()])


plan = pathlib.Path(sys.argv[1]).resolve()
merges = plan.with_name(f"{plan.stem}-merge{plan.suffix}")
job = outline.Outline(plan.stem)
job.add_layer(layer("lines", plan))
if merges.exists():
    job.add_layer(layer("merges", merges))
    job.get_layer("merges").depend_all("lines")
outline.cuerun.launch(job)
