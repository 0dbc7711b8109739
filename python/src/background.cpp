#include "background.h"

#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

#include "base/error.h"

namespace candela::python {

namespace {

/// One piece of work, as its own thread and the one that waits for it see it.
struct Work {
  std::mutex mutex;
  std::condition_variable changed;
  bool is_done = false;
  std::optional<Progress> news;
  std::exception_ptr error;
  std::atomic<bool> stop{false};
};

/// What runs. Python's end has to know, and only one process can.
struct Running {
  std::vector<Work*> all;  ///< guarded by Python's lock
  bool is_ending = false;
  std::thread::id ends;  ///< the thread that ends Python
  pid_t process = 0;
};
Running& running() {
  static Running* const the_only_one = new Running;  // outlives every static object
  return *the_only_one;
}

/// Whether Python is ending and this thread, a daemon, is to be left where it is: the interpreter may go away under
/// whatever it would do next, and an error that it printed would be of work that nobody waits for.
bool is_left_behind() { return running().is_ending && std::this_thread::get_id() != running().ends; }

void stay() {
  const nb::gil_scoped_release released;
  while (true) std::this_thread::sleep_for(std::chrono::hours(1));
}

class Registered {
 public:
  explicit Registered(Work& work) : work_(&work) {
    refuse_after_the_end();
    Running& all = running();
    if (all.process == 0) all.process = ::getpid();
    if (all.process != ::getpid()) {
      throw Error(
          "this process was forked from one that has used candela, and has none of its threads; start workers "
          "with multiprocessing's method \"spawn\"");
    }
    all.all.push_back(work_);
  }
  ~Registered() {
    std::erase(running().all, work_);
    if (is_left_behind()) stay();
  }
  Registered(const Registered&) = delete;
  Registered& operator=(const Registered&) = delete;

 private:
  Work* work_;
};

constexpr auto kLookEvery = std::chrono::milliseconds(50);  // for Ctrl-C

/// Waits for news, or the end, without Python's lock. Whether it has ended.
bool wait_for(Work& work, std::optional<Progress>& news) {
  const nb::gil_scoped_release released;
  std::unique_lock lock(work.mutex);
  work.changed.wait_for(lock, kLookEvery, [&] { return work.is_done || work.news; });
  news = std::move(work.news);
  work.news.reset();
  return work.is_done;
}

nb::handle g_category;  // of warnings; the module keeps it

}  // namespace

void run_in_background(const nb::object& progress, const std::function<void(const Job&)>& work) {
  Work state;
  const Registered registered(state);
  Job job;
  job.stop = &state.stop;
  if (!progress.is_none()) {
    job.progress = [&](const Progress& news) {
      const std::lock_guard lock(state.mutex);
      state.news = news;
      state.changed.notify_one();
    };
  }
  std::thread thread([&] {
    std::exception_ptr error;
    try {
      work(job);
    } catch (...) {
      error = std::current_exception();
    }
    const std::lock_guard lock(state.mutex);
    state.error = error;
    state.is_done = true;
    state.changed.notify_one();
  });
  std::optional<nb::python_error> raised;
  std::optional<Progress> news;
  bool is_done = false;
  while (!is_done) {
    is_done = wait_for(state, news);
    if (raised) continue;
    try {
      if (!is_done && PyErr_CheckSignals() != 0) nb::raise_python_error();
      if (news && progress(*news).is(nb::handle(Py_False))) state.stop = true;
    } catch (nb::python_error& error) {
      state.stop = true;
      raised.emplace(std::move(error));
    }
  }
  thread.join();
  if (raised) throw nb::python_error(std::move(*raised));
  if (state.error) std::rethrow_exception(state.error);
}

void run_without_lock(const std::function<void()>& work) {
  Work state;
  const Registered registered(state);  // and gone only when the lock is held again
  const nb::gil_scoped_release released;
  work();
}

void refuse_after_the_end() {
  if (is_left_behind()) stay();
  if (running().is_ending) throw Error("Python is ending");
}

void stop_all_background() {
  Running& all = running();
  all.is_ending = true;
  all.ends = std::this_thread::get_id();
  for (Work* work : all.all) work->stop = true;
  while (!all.all.empty()) {
    const nb::gil_scoped_release released;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
}

void set_warning_category(nb::handle category) { g_category = category; }

void tell_warnings(const Diagnostics& diagnostics) {
  constexpr int kCallerOfThePackage = 2;
  for (const Diagnostic& warning : diagnostics.warnings()) {
    if (PyErr_WarnEx(g_category.ptr(), warning.text().c_str(), kCallerOfThePackage) != 0) nb::raise_python_error();
  }
}

void bind_background(nb::module_& module) {
  nb::class_<Progress>(module, "Progress", "How far a long piece of work is.")
      .def_ro("fraction", &Progress::fraction, "Of the work; estimated where time or noise ends it.")
      .def_ro("seconds", &Progress::seconds, "Since it began.")
      .def_ro("remaining", &Progress::remaining_s, "Seconds, where they can be estimated, else None.")
      .def_ro("what", &Progress::what, "The current step, in a few words; may be empty.")
      .def_ro("samples_per_pixel", &Progress::samples_per_pixel, "Of the picture so far, where one is path traced.")
      .def("__repr__", [](const Progress& p) {
        return "Progress(fraction=" + std::to_string(p.fraction) + ", seconds=" + std::to_string(p.seconds) + ")";
      });
}

}  // namespace candela::python
