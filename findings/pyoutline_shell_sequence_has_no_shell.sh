#!/usr/bin/env bash
# OpenCue's job library: the commands of a ShellSequence ("a module for executing an array of shell commands") are divided into
# words and run without a shell, so that > is an argument and nothing is written; and %{FRAME}, which a Shell layer replaces by
# the frame's number, stays as it is. A command that needs a shell has to name it: ["sh", "-c", "..."]. Seen with
# opencue_pyoutline 1.37.0 (PyPI): "one > out.txt" and "%{FRAME}" are printed, only the file of sh -c is there.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install -q opencue_pyoutline==1.37.0
mkdir work
cat >try.py <<'TEXT'
import os
from outline.modules.shell import Shell, ShellSequence
os.chdir("work")
commands = ["echo one > out.txt", ["sh", "-c", "echo two > two.txt"], "echo %{FRAME}"]
sequence = ShellSequence("sequence", commands=commands)
for frame in (1, 2, 3):
    sequence._execute([frame])
Shell("shell", command=["echo", "%{FRAME}"], range="1-4")._execute([4])
TEXT
printed=$(venv/bin/python try.py)
written=$(ls work)
echo "printed: $printed"
echo "written: $written"
if [ "$printed" != $'one > out.txt\n%{FRAME}\n4' ] || [ "$written" != two.txt ]; then
  echo "no longer so" >&2
  exit 1
fi
