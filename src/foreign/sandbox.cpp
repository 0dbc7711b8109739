#include "foreign/sandbox.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstring>
#include <ctime>
#include <fstream>
#include <new>

#include "base/error.h"
#include "base/parallel.h"

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define CANDELA_SHADOW_MEMORY 1
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer) || __has_feature(memory_sanitizer)
#define CANDELA_SHADOW_MEMORY 1
#endif
#endif

namespace candela::foreign {

namespace {

enum ExitCode : int { exit_done = 0, exit_failed = 3, exit_out_of_memory = 4, exit_cannot_write = 5 };

/// A file descriptor that closes itself.
class Descriptor {
 public:
  explicit Descriptor(int fd) : fd_(fd) {}
  ~Descriptor() {
    if (fd_ >= 0) ::close(fd_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  int get() const { return fd_; }

 private:
  int fd_;
};

bool write_all(int fd, std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(fd, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return false;
    bytes = bytes.subspan(static_cast<std::size_t>(written));
  }
  return true;
}

void limit(int resource, std::uint64_t value) {
  const rlimit both{value, value};
  // Where it cannot be lowered the work runs without that limit.
  (void)setrlimit(static_cast<__rlimit_resource_t>(resource), &both);
}

/// The address space that the process has now, which a limit counts too.
[[maybe_unused]] std::uint64_t address_space() {
  std::ifstream file("/proc/self/statm");
  std::uint64_t pages = 0;
  file >> pages;
  return pages * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
}

[[noreturn]] void work_in_child(const std::function<std::vector<std::byte>()>& work, const SandboxLimits& limits,
                                int out) {
  for (const int signal : {SIGINT, SIGTERM, SIGSEGV, SIGABRT, SIGFPE, SIGBUS, SIGILL}) std::signal(signal, SIG_DFL);
#ifndef CANDELA_SHADOW_MEMORY
  // What the runtime says of an uncaught exception or a broken heap is not for the user, who gets one line.
  if (const int null = ::open("/dev/null", O_WRONLY); null >= 0) ::dup2(null, STDERR_FILENO);
#endif
  limit(RLIMIT_CORE, 0);
  limit(RLIMIT_CPU, limits.cpu_seconds);
#ifndef CANDELA_SHADOW_MEMORY
  if (const std::uint64_t now = address_space(); now > 0) limit(RLIMIT_AS, now + limits.memory_bytes);
#endif
  int code = exit_done;
  try {
    if (!write_all(out, work())) code = exit_cannot_write;
  } catch (const std::bad_alloc&) {
    code = exit_out_of_memory;
  } catch (const std::exception& error) {
    const std::string_view text = error.what();
    write_all(out, std::as_bytes(std::span(text)));
    code = exit_failed;
  } catch (...) {
    code = exit_failed;
  }
  ::_exit(code);  // what the parent would do at its end is not the child's
}

/// Waits for the child, and ends it where the caller is to stop.
int wait_for(pid_t child) {
  int status = 0;
  try {
    timespec pause{0, 500'000};
    for (pid_t ended = 0; (ended = ::waitpid(child, &status, WNOHANG)) != child;) {
      if (ended < 0 && errno != EINTR) throw Error("the process that reads it is lost");
      StopScope::check();
      ::nanosleep(&pause, nullptr);
      if (pause.tv_nsec < 10'000'000) pause.tv_nsec *= 2;
    }
  } catch (...) {
    ::kill(child, SIGKILL);
    ::waitpid(child, &status, 0);
    throw;
  }
  return status;
}

std::vector<std::byte> content(int fd, const std::string& where) {
  struct stat status {};
  if (::fstat(fd, &status) != 0) throw Error(std::strerror(errno), where);
  std::vector<std::byte> bytes(static_cast<std::size_t>(status.st_size));
  std::size_t done = 0;
  while (done < bytes.size()) {
    const ssize_t count = ::pread(fd, bytes.data() + done, bytes.size() - done, static_cast<off_t>(done));
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) throw Error("cannot be read back", where);
    done += static_cast<std::size_t>(count);
  }
  return bytes;
}

}  // namespace

std::vector<std::byte> run_apart(const std::function<std::vector<std::byte>()>& work, const SandboxLimits& limits,
                                 const std::string& where) {
  const Descriptor out(::memfd_create("candela", MFD_CLOEXEC));
  if (out.get() < 0) throw Error(std::string("no memory to read it: ") + std::strerror(errno), where);
  const pid_t child = ::fork();
  if (child < 0) throw Error(std::string("no process to read it: ") + std::strerror(errno), where);
  if (child == 0) work_in_child(work, limits, out.get());
  const int status = wait_for(child);
  if (WIFSIGNALED(status)) {
    const int signal = WTERMSIG(status);
    if (signal == SIGXCPU || signal == SIGKILL) throw Error("reading it takes too long or too much memory", where);
    throw Error(std::string("damaged: its reader ended by ") + strsignal(signal), where);
  }
  std::vector<std::byte> bytes = content(out.get(), where);
  switch (WEXITSTATUS(status)) {
    case exit_done:
      return bytes;
    case exit_failed:
      throw Error(std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size()), where);
    case exit_out_of_memory:
      throw Error("reading it takes too much memory", where);
    default:
      throw Error("damaged: its reader gave up", where);
  }
}

}  // namespace candela::foreign
