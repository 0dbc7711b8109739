"""examples/farm with the real schedulers: a plan's lines make the pictures of one run, though a process is killed on the way.

Each test skips where its scheduler is absent (Debian: parallel, openmpi-bin, slurm-wlm and munge)."""

import os
import pathlib
import shutil
import signal
import socket
import subprocess
import time

import candela
from candela import CliTest

FARM = candela.ROOT / "examples/farm"
SCENE = ("demo:spheres", "--size", "96x72", "--env", "sky", "--spp", "96", "--exposure", "0", "--threads", "1", "--views", "front,iso,left")


class Farm(CliTest):
    def setUp(self):
        super().setUp()
        self.slurm_conf = None
        self.path = f"{pathlib.Path(candela.PROGRAM).resolve().parent}:/usr/sbin:{os.environ['PATH']}"

    def needs(self, *programs):
        for program in programs:
            if not shutil.which(program, path=self.path):
                self.skipTest(f"{program} is absent")

    def plan(self):
        """Parts of pictures, and their merges."""
        self.succeeds("render", *SCENE, "-o", "whole/{view}.exr")
        self.succeeds("plan", "-o", "work.txt", "--picture-time", "9min", "--", *SCENE, "-o", "out/{view}.exr")
        self.count = len((self.folder / "work.txt").read_text().splitlines())
        self.assertEqual(self.count, 6)

    def start(self, *command, **options):
        return subprocess.Popen([str(word) for word in command], cwd=self.folder, env=self.environment(), stdin=subprocess.DEVNULL,
                                stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, **options)  # fmt: skip

    def run_here(self, *command, code=0, **options):
        done = subprocess.run([str(word) for word in command], cwd=self.folder, env=self.environment(), stdin=subprocess.DEVNULL, text=True,
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, timeout=300, check=False, **options)  # fmt: skip
        if code is not None:
            self.assertEqual(done.returncode, code, done.stdout)
        return done.stdout

    def processes(self, words):
        """The processes of this program with these words, started in or for this test's folder."""
        found = []
        for folder in pathlib.Path("/proc").glob("[0-9]*"):
            try:
                command = (folder / "cmdline").read_bytes().split(b"\0")
                is_ours = (folder / "cwd").resolve() == self.folder.resolve()
            except OSError:
                continue
            if is_ours and pathlib.Path(command[0].decode()).name == "candela" and all(word.encode() in command for word in words):
                found.append(int(folder.name))
        return found

    def kill_one(self, *words):
        for _ in range(3000):
            if found := self.processes(words):
                os.kill(found[0], signal.SIGKILL)
                return
            time.sleep(0.01)
        self.fail(f"no process of {words}")

    def check_pictures(self):
        for view in ("front", "iso", "left"):
            self.assertEqual((self.folder / f"out/{view}.exr").read_bytes(), (self.folder / f"whole/{view}.exr").read_bytes(), view)

    def test_gnu_parallel(self):
        self.needs("parallel")
        self.plan()
        running = self.start(FARM / "gnu_parallel.sh", "work.txt", "--jobs", "2")
        self.kill_one("render")
        text = running.communicate(timeout=300)[0]
        self.assertEqual(running.returncode, 0, text)
        self.check_pictures()

    def test_workers_of_open_mpi(self):
        self.needs("mpirun")
        self.plan()
        running = self.start("mpirun", "--oversubscribe", "--bind-to", "none", "--enable-recovery", "-n", "3", "candela", "worker", "work.txt", "--lease", "2s")
        self.kill_one("worker")
        running.communicate(timeout=300)
        self.assertIn(f"{self.count + 3} of {self.count + 3} lines done", self.succeeds("worker", "work.txt", "--status").out)
        self.check_pictures()
        self.run_here(FARM / "open_mpi.sh", "work.txt")  # nothing is left to do

    def start_daemon(self, *command):
        process = self.start(*command)
        self.addCleanup(self.end, process)
        return process

    @staticmethod
    def port():
        with socket.socket() as probe:
            probe.bind(("127.0.0.1", 0))
            return probe.getsockname()[1]

    def start_slurm(self):
        """One node with four slots, whatever the machine has."""
        self.needs("slurmctld", "slurmd", "sbatch", "munged")
        if os.getuid() != 0:
            self.skipTest("slurmd starts as root")
        slurm, host = self.folder / "slurm", socket.gethostname().split(".")[0]
        for name in ("state", "spool"):
            (slurm / name).mkdir(parents=True)
        (slurm / "key").write_bytes(os.urandom(1024))
        (slurm / "key").chmod(0o400)
        files = [f"--{name}={slurm}/munge.{name}" for name in ("socket", "pid-file", "log-file", "seed-file")]
        self.start_daemon("munged", "--foreground", "--force", f"--key-file={slurm}/key", *files)
        (slurm / "slurm.conf").write_text(f"""
ClusterName=test
SlurmctldHost={host}(127.0.0.1)
SlurmctldPort={self.port()}
SlurmdPort={self.port()}
SlurmUser=root
AuthInfo=socket={slurm}/munge.socket
StateSaveLocation={slurm}/state
SlurmdSpoolDir={slurm}/spool
SlurmctldPidFile={slurm}/slurmctld.pid
SlurmdPidFile={slurm}/slurmd.pid
ProctrackType=proctrack/pgid
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SlurmdParameters=config_overrides
SchedulerParameters=sched_interval=1,requeue_delay=1
MinJobAge=300
ReturnToService=2
NodeName={host} NodeAddr=127.0.0.1 CPUs=4 State=UNKNOWN
PartitionName=all Nodes=ALL Default=YES MaxTime=INFINITE State=UP
""")
        self.slurm_conf = slurm / "slurm.conf"
        self.start_daemon("slurmctld", "-D", "-f", self.slurm_conf)
        self.start_daemon("slurmd", "-D", "-f", self.slurm_conf)
        for _ in range(300):
            if "idle" in self.run_here("sinfo", code=None):
                return
            time.sleep(0.2)
        self.fail(self.run_here("sinfo", "-R", code=None))

    def environment(self):
        conf = {"SLURM_CONF": str(self.slurm_conf)} if self.slurm_conf else {}
        return {**os.environ, "PATH": self.path, "OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1", **conf}

    def wait_for_slurm(self):
        for _ in range(600):
            if not self.run_here("squeue", "-h"):
                return
            time.sleep(0.5)
        self.fail(self.run_here("squeue"))

    def test_an_array_of_slurm(self):
        self.start_slurm()
        self.plan()
        self.run_here(FARM / "slurm.sh", "work.txt", "--output", "/dev/null")
        self.kill_one("render")
        self.wait_for_slurm()
        self.check_pictures()

    def test_workers_of_slurm(self):
        self.start_slurm()
        self.plan()
        self.run_here("sbatch", "--array=1-3", "--output", "/dev/null", "--wrap", "candela worker work.txt --lease 2s")
        self.kill_one("worker")
        self.wait_for_slurm()
        self.check_pictures()


if __name__ == "__main__":
    candela.main()
