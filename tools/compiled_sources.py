#!/usr/bin/env python3
"""Of the files named on standard input, print those that the compilation database given as argument compiles."""

import json
import os
import sys

with open(sys.argv[1], encoding="utf-8") as database:
    compiled = {os.path.realpath(os.path.join(entry["directory"], entry["file"])) for entry in json.load(database)}
for line in sys.stdin:
    if os.path.realpath(line.strip()) in compiled:
        print(line.strip())
