#include <fcntl.h>
#include <fmt/format.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <memory>
#include <optional>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "base/error.h"
#include "base/stopwatch.h"
#include "candela/work_queue.h"
#include "cli/interrupt.h"
#include "cli/option.h"
#include "cli/plan.h"
#include "cli/progress.h"
#include "cli/values.h"
#include "cli/verbs.h"

namespace candela::cli {

namespace fs = std::filesystem;

namespace {

constexpr double kLeaseS = 60.0;
constexpr double kRenewalsPerLease = 6.0;

struct WorkerOptions {
  std::string list;
  double lease_s = kLeaseS;
  bool shows_status = false, retries = false, quiet = false;
};

/// Of this process alone, whatever machine it is on.
std::string worker_name() {
  std::array<char, 256> host{};
  ::gethostname(host.data(), host.size() - 1);
  std::string name = host.data();
  for (char& c : name) {
    if (c == '/' || c == '@') c = '-';
  }
  return fmt::format("{}-{}-{:04x}", name, ::getpid(), std::random_device{}() & 0xffffu);
}

/// Lines begin with `candela`, which is this program.
void put_program_into_path() {
  std::error_code code;
  const fs::path program = fs::read_symlink("/proc/self/exe", code);
  if (code || program.filename() != "candela") return;
  const char* path = std::getenv("PATH");
  setenv("PATH", (program.parent_path().string() + (path != nullptr ? std::string(":") + path : "")).c_str(), 1);
}

/// A command that runs, with what it says in a file; it ends with this process.
class RunningLine {
 public:
  RunningLine(const std::string& command, const fs::path& log) {
    const int out = ::open(log.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
    if (out < 0) throw Error(std::string("cannot be written: ") + std::strerror(errno), log.string());
    const int in = ::open("/dev/null", O_RDONLY | O_CLOEXEC);
    const pid_t parent = ::getpid();
    process_ = ::fork();
    if (process_ == 0) {
      ::setpgid(0, 0);  // Ctrl-C is for the worker
      ::prctl(PR_SET_PDEATHSIG, SIGTERM);
      if (::getppid() != parent) ::_exit(1);
      ::dup2(in, STDIN_FILENO);
      ::dup2(out, STDOUT_FILENO);
      ::dup2(out, STDERR_FILENO);
      ::execl("/bin/sh", "sh", "-c", command.c_str(), nullptr);
      ::_exit(127);
    }
    ::close(out);
    ::close(in);
    if (process_ < 0) throw Error(std::string("cannot be started: ") + std::strerror(errno), "/bin/sh");
    ::setpgid(process_, process_);  // whichever of the two is first
  }
  ~RunningLine() {
    if (status_) return;
    constexpr double kPatienceS = 10.0;
    ::kill(-process_, SIGTERM);
    for (const Stopwatch watch; !poll() && watch.seconds() < kPatienceS;) sleep();
    if (!poll()) ::kill(-process_, SIGKILL);
    while (!poll()) sleep();
  }
  RunningLine(const RunningLine&) = delete;
  RunningLine& operator=(const RunningLine&) = delete;

  /// Its status once it has ended, as waitpid() has it.
  std::optional<int> poll() {
    int status = 0;
    if (!status_ && ::waitpid(process_, &status, WNOHANG) == process_) status_ = status;
    return status_;
  }
  static void sleep() {
    constexpr std::chrono::milliseconds kPause(20);
    std::this_thread::sleep_for(kPause);
  }

 private:
  pid_t process_ = -1;
  std::optional<int> status_;
};

std::string status_text(int status) {
  if (WIFSIGNALED(status)) return fmt::format("ended by signal {}", WTERMSIG(status));
  return fmt::format("exit code {}", WEXITSTATUS(status));
}

/// Runs a line that was claimed. Throws Interrupted after a stop, with the line given back.
void run_line(WorkQueue& queue, const WorkLine& line, double lease_s, ProgressLine& progress) {
  const std::string name = fmt::format("{} {}", line.stage > 0 ? "merge" : "line", line.number);
  progress.phase(name + ": " + line.command);
  const Stopwatch total;
  Stopwatch renewed;
  RunningLine running(line.command, queue.log_of(line));
  while (!running.poll()) {
    if (Interrupt::requested()) {
      queue.give_back();
      throw Interrupted(name + " waits again");
    }
    if (renewed.seconds() > lease_s / kRenewalsPerLease) {
      renewed = {};
      if (!queue.renew()) return progress.line(name + ": taken over by another worker, as this one was too long away");
    }
    RunningLine::sleep();
  }
  const int status = *running.poll();
  if (status == 0) {
    queue.complete();
    return progress.line(fmt::format("{} done in {}", name, duration_text(total.seconds())));
  }
  if (Interrupt::requested()) {  // a scheduler ends both
    queue.give_back();
    throw Interrupted(name + " waits again");
  }
  const bool is_tried_again = queue.fail();
  progress.failed({fmt::format("{}: {}, {}; see {}", name, status_text(status),
                               is_tried_again ? "will be tried again" : "given up", queue.log_of(line).string()),
                   ""});
}

std::string counts_text(const WorkCounts& counts) {
  return fmt::format("{} of {} lines done, {} running, {} waiting, {} failed", counts.done, counts.all(), counts.taken,
                     counts.waiting, counts.failed);
}

void run_worker(const WorkerOptions& o) {
  if (o.list.empty()) throw UsageError("DIR is missing: the folder or the list of candela plan");
  const fs::path list = fs::is_directory(o.list) ? fs::path(o.list) / kJobList : fs::path(o.list);
  std::vector<fs::path> lists = {list};
  if (fs::exists(merge_list_of(list))) lists.push_back(merge_list_of(list));
  WorkQueue queue(lists, worker_name(), o.lease_s);
  if (o.retries) queue.retry_failed();
  if (o.shows_status) {
    print(counts_text(queue.counts()) + "\n");
    for (const WorkLine& line : queue.failed()) {
      print(fmt::format("failed: {} ({})\n", line.command, queue.log_of(line).string()));
    }
    return;
  }
  put_program_into_path();
  ProgressLine progress(o.quiet);
  const Interrupt interrupt;
  const double pause_s = std::min(1.0, o.lease_s / kRenewalsPerLease);
  while (!queue.is_finished()) {
    if (Interrupt::requested()) throw Interrupted(counts_text(queue.counts()));
    if (const std::optional<WorkLine> line = queue.claim()) {
      run_line(queue, *line, o.lease_s, progress);
    } else {
      progress.phase("waiting for other workers: " + counts_text(queue.counts()));
      std::this_thread::sleep_for(std::chrono::duration<double>(pause_s));
    }
  }
  const WorkCounts counts = queue.counts();
  if (counts.failed > 0) {
    throw Error(fmt::format("{} of {} lines failed: --status names them, --retry tries them again", counts.failed,
                            counts.all()),
                list.string());
  }
  progress.line(counts_text(counts));
}

}  // namespace

Verb add_worker(Command& command) {
  const auto options = std::make_shared<WorkerOptions>();
  WorkerOptions& o = *options;
  command.text("DIR", o.list, "The folder, or the list, of candela plan; any list of shell commands will do");
  add_value(command, "--lease", "60s", o.lease_s, parse_duration,
            "A worker that does not renew its line for so long is gone, and the line waits again [60s]");
  command.flag("--status", o.shows_status, "Say how far the work is, and do none");
  command.flag("--retry", o.retries, "Lines that were given up wait again");
  command.flag("-q,--quiet", o.quiet, "Nothing on standard error but errors");
  command.help();
  command.footer(
      "Any number of workers, on any machines that share the folder, run each line once: start one per machine, by\n"
      "hand, by mpirun, by a scheduler. A line is tried three times. Workers end when all lines have. What lines say\n"
      "is in LIST.work/logs. A stopped worker gives its line back.\n\n"
      "Examples:\n"
      "  candela plan -o city/ -- city.glb --spp 4096 --turntable 48 -o frames/%03d.exr\n"
      "  candela worker city/\n"
      "  mpirun -n 8 --map-by node candela worker city/\n"
      "  candela worker city/ --status\n");
  return [options] { run_worker(*options); };
}

}  // namespace candela::cli
