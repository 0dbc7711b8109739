#!/usr/bin/env python3
"""Keeps the links of docs/tour.md true: [`name`](../file#L12) must lead to a line of the file that declares or defines it.

    tools/check_tour.py [--fix]      exit 1 and one line per link that leads elsewhere; --fix writes the right numbers
"""

import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
LINK = re.compile(r"\[`([\w:]+)`\]\(\.\./([^)#]+)#L(\d+)\)")


def line_of(name, lines):
    """The line, counted from 1, where `name` is defined, else declared: not called, not named in a comment."""
    declared = None
    word = re.compile(rf"(?<![\w.>]){re.escape(name)}\b")
    for number, line in enumerate(lines, 1):
        found = word.search(line)
        if not found or line.lstrip().startswith("//"):
            continue
        before, after = line[: found.start()].strip(), line[found.end() :]
        is_type = re.search(r"(struct|class|enum class)$", before) and not after.startswith(";")
        is_function = after.startswith("(") and re.fullmatch(r"[\w:&*<>, ]+", before) and before != "return"
        is_member = after.startswith("(") and "::" in name
        is_constant = before.startswith("inline constexpr")
        if not (is_type or is_function or is_member or is_constant):
            continue
        rest = " ".join([after, *lines[number : number + 4]])
        if "{" in rest.split(";")[0]:
            return number
        declared = declared or number
    return declared


def main():
    page = ROOT / "docs" / "tour.md"
    text = page.read_text(encoding="utf-8")
    wrong = []

    def mended(match):
        name, file, number = match.groups()
        path = ROOT / file
        lines = path.read_text(encoding="utf-8").splitlines() if path.is_file() else []
        found = line_of(name, lines)
        if found != int(number):
            place = f"docs/tour.md:{text.count(chr(10), 0, match.start()) + 1}"
            wrong.append(f"{place}: {name} stands in {file}:{found}" if found else f"{place}: no {name} in {file}")
        return f"[`{name}`](../{file}#L{found or number})"

    fixed = LINK.sub(mended, text)
    if "--fix" in sys.argv[1:]:
        page.write_text(fixed, encoding="utf-8")
        wrong = [line for line in wrong if ": no " in line]
    for line in wrong:
        print(line)
    sys.exit(1 if wrong else 0)


if __name__ == "__main__":
    main()
