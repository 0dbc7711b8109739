"""candela worker: every line of a list is done, once, whatever happens to workers."""

import os
import pathlib
import signal
import time

import candela
from candela import CliTest


class Worker(CliTest):
    def write(self, name, *lines):
        (self.folder / name).write_text("".join(f"cd {self.folder} && {line}\n" for line in lines))

    def wait_for(self, holds, seconds=60):
        for _ in range(seconds * 50):
            if holds():
                return
            time.sleep(0.02)
        self.fail("did not come to pass")

    def exists(self, name):
        return lambda: (self.folder / name).exists()

    def ends(self, process, code=0):
        out, err = process.communicate(timeout=120)
        self.assertEqual(process.returncode, code, err.decode())
        return err.decode()

    def test_several_do_each_line_once(self):
        self.write("jobs.txt", *(f"echo {i} >> seen-{i}; sleep 0.05" for i in range(30)))
        workers = [self.start_candela("worker", ".") for _ in range(4)]
        for worker in workers:
            self.ends(worker)
        for i in range(30):
            self.assertEqual((self.folder / f"seen-{i}").read_text(), f"{i}\n")
        self.assertEqual(self.succeeds("worker", "jobs.txt", "--status").out, "30 of 30 lines done, 0 running, 0 waiting, 0 failed\n")
        self.succeeds("worker", "jobs.txt")  # nothing left to do

    def test_merges_come_after_all_other_lines(self):
        self.write("work.txt", *(f"sleep 0.{i} && touch part-{i}" for i in range(4)))
        self.write("work-merge.txt", "ls part-* > merged")
        for worker in [self.start_candela("worker", "work.txt") for _ in range(3)]:
            self.ends(worker)
        self.assertEqual((self.folder / "merged").read_text().split(), [f"part-{i}" for i in range(4)])

    def test_lines_of_a_killed_worker_return(self):
        self.write("jobs.txt", "if mkdir first; then echo $$ > running; exec sleep 100; else touch second; fi")
        lost = self.start_candela("worker", ".", "--lease", "2s")
        self.wait_for(self.exists("running"))
        lost.send_signal(signal.SIGKILL)
        lost.wait()
        line = pathlib.Path("/proc") / (self.folder / "running").read_text().strip()
        self.wait_for(lambda: not line.exists())  # its line ends with it
        self.assertIn("1 running", self.succeeds("worker", ".", "--status").out)
        self.ends(self.start_candela("worker", ".", "--lease", "2s"))
        self.assertTrue((self.folder / "second").exists())

    def test_a_worker_that_was_away_leaves_its_line_to_another(self):
        self.write("jobs.txt", "if mkdir first; then touch running; sleep 100; else touch second; fi")
        away = self.start_candela("worker", ".", "--lease", "1s")
        self.wait_for(self.exists("running"))
        away.send_signal(signal.SIGSTOP)
        self.ends(self.start_candela("worker", ".", "--lease", "1s"))
        self.assertTrue((self.folder / "second").exists())
        away.send_signal(signal.SIGCONT)
        self.assertIn("taken over by another worker", self.ends(away))

    def test_a_stopped_worker_gives_its_line_back(self):
        for stop in (signal.SIGINT, signal.SIGTERM):
            name = f"work-{stop.value}.txt"
            self.write(name, f"if mkdir first-{stop.value}; then touch running-{stop.value}; sleep 100; fi")
            worker = self.start_candela("worker", name)
            self.wait_for(self.exists(f"running-{stop.value}"))
            worker.send_signal(stop)
            self.assertIn("line 1 waits again", self.ends(worker, 130))
            self.assertIn("0 running, 1 waiting", self.succeeds("worker", name, "--status").out)
            self.ends(self.start_candela("worker", name))

    def test_a_line_that_fails_is_tried_three_times_and_named(self):
        self.write("jobs.txt", "echo again >> tried; echo no such thing >&2; exit 3", "touch other")
        failed = self.run_candela("worker", ".")
        self.assertEqual(failed.code, 1)
        self.assertIn("exit code 3, will be tried again", failed.err)
        self.assertRegex(failed.err.splitlines()[-1], "candela: .*jobs.txt: 1 of 2 lines failed")
        self.assertEqual((self.folder / "tried").read_text().count("again"), 3)
        self.assertTrue((self.folder / "other").exists())
        status = self.succeeds("worker", ".", "--status").out
        self.assertIn("failed: cd", status)
        log = self.folder / status.splitlines()[-1].rsplit("(", 1)[1].rstrip(")")
        self.assertEqual(log.read_text(), "no such thing\n")
        self.assertEqual(self.run_candela("worker", ".", "--retry", "-q").code, 1)
        self.assertEqual((self.folder / "tried").read_text().count("again"), 6)

    def test_a_line_that_a_signal_ends_is_told(self):
        self.write("jobs.txt", "kill -9 $$")
        self.assertIn("ended by signal 9, given up", self.run_candela("worker", ".").err)

    def test_lines_find_this_program(self):
        self.write("jobs.txt", "candela --version > version", "candela render demo:spheres --size 8x8 --spp 1 -o ball.png -q")
        empty = {**os.environ, "PATH": "/usr/bin:/bin"}
        self.succeeds("worker", ".", env=empty)
        self.assertTrue((self.folder / "ball.png").is_file())

    def test_what_is_no_work_is_an_error(self):
        self.fails("worker", "absent.txt", says="absent.txt: no such file")
        self.fails("worker", ".", says="jobs.txt: no such file")
        self.refuses("worker", says="DIR is missing")
        self.write("jobs.txt", "true")
        self.succeeds("worker", ".")
        self.write("jobs.txt", "false")
        self.fails("worker", ".", says="jobs.txt.work: is the work of other lines")


if __name__ == "__main__":
    candela.main()
