#!/usr/bin/env python3
"""Print one line, `N passed, N failed[, N skipped]`, for the JUnit files that ctest wrote; exit 1 unless all is well."""

import sys
import xml.etree.ElementTree as xml


def outcome(case):
    """ "passed", "failed", "skipped" or "disabled", of one <testcase>. A test that could not be started has failed."""
    status = case.get("status")
    if status == "run":
        return "passed"
    if status == "disabled":
        return "disabled"
    skipped = case.find("skipped")
    if status == "notrun" and skipped is not None and skipped.get("message", "").startswith("SKIP_"):
        return "skipped"
    return "failed"


def summary(paths):
    counts = {"passed": 0, "failed": 0, "skipped": 0, "disabled": 0}
    for path in paths:
        for case in xml.parse(path).getroot().iter("testcase"):
            counts[outcome(case)] += 1
    line = f"{counts['passed']} passed, {counts['failed']} failed"
    if counts["skipped"]:
        line += f", {counts['skipped']} skipped"
    return line, counts["failed"] == 0 and counts["passed"] > 0


def main():
    try:
        line, good = summary(sys.argv[1:])
    except (OSError, xml.ParseError) as error:
        sys.exit(f"no test results: {error}")
    print(line)
    sys.exit(0 if good else 1)


if __name__ == "__main__":
    main()
