#!/usr/bin/env python3
"""tools/test_summary.py: the last line of `./dev test`."""

import pathlib
import subprocess
import sys
import tempfile
import unittest

TOOL = pathlib.Path(__file__).resolve().parents[2] / "tools" / "test_summary.py"

PASSED = '<testcase name="a" status="run"/>'
FAILED = '<testcase name="b" status="fail"><failure message=""/></testcase>'
SKIPPED = '<testcase name="c" status="notrun"><skipped message="SKIP_RETURN_CODE=77"/></testcase>'
MISSING = '<testcase name="d" status="notrun"><skipped message="Unable to find executable"/></testcase>'


class Summary(unittest.TestCase):
    def judge(self, *suites):
        with tempfile.TemporaryDirectory() as folder:
            paths = []
            for number, cases in enumerate(suites):
                paths.append(pathlib.Path(folder) / f"{number}.xml")
                paths[-1].write_text(f"<testsuite>{cases}</testsuite>", encoding="utf-8")
            done = subprocess.run([sys.executable, TOOL, *paths], capture_output=True, text=True, check=False)
            return done.stdout, done.returncode

    def test_all_good(self):
        self.assertEqual(self.judge(PASSED * 3), ("3 passed, 0 failed\n", 0))

    def test_skipped_are_named(self):
        self.assertEqual(self.judge(PASSED + SKIPPED * 2), ("1 passed, 0 failed, 2 skipped\n", 0))

    def test_failures_and_missing_programs_fail(self):
        self.assertEqual(self.judge(PASSED + FAILED), ("1 passed, 1 failed\n", 1))
        self.assertEqual(self.judge(PASSED + MISSING), ("1 passed, 1 failed\n", 1))

    def test_several_files_add_up(self):
        self.assertEqual(self.judge(PASSED, PASSED + SKIPPED), ("2 passed, 0 failed, 1 skipped\n", 0))

    def test_nothing_ran(self):
        self.assertEqual(self.judge("")[1], 1)
        self.assertEqual(self.judge(SKIPPED)[1], 1)

    def test_no_result_file(self):
        done = subprocess.run([sys.executable, TOOL, "absent.xml"], capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 1)


if __name__ == "__main__":
    unittest.main()
