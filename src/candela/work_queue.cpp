#include "candela/work_queue.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <span>
#include <string_view>
#include <utility>

#include "base/error.h"
#include "base/file.h"

namespace candela {

namespace fs = std::filesystem;

namespace {

constexpr const char *kWaiting = "waiting", *kTaken = "taken", *kDone = "done", *kFailed = "failed",
                     *kWorkers = "workers", *kLogs = "logs", *kLists = "lists";

std::string name_of(const WorkLine& line) {
  return fmt::format("{}-{:06}.{}", line.stage + 1, line.number, line.attempt);
}

/// Without its command; empty for what is no line's name. A worker's name may follow an @.
std::optional<WorkLine> line_of(std::string_view name) {
  name = name.substr(0, name.find('@'));
  WorkLine line;
  const char *at = name.data(), *const end = at + name.size();
  const auto read = [&](auto& number, char mark) {
    const auto [next, code] = std::from_chars(at, end, number);
    const bool has_mark = mark == 0 ? next == end : next != end && *next == mark;
    if (code != std::errc() || !has_mark || number < 1) return false;
    at = next + (mark == 0 ? 0 : 1);
    return true;
  };
  if (!read(line.stage, '-') || !read(line.number, '.') || !read(line.attempt, '\0')) return std::nullopt;
  --line.stage;
  return line;
}

/// The lines' names in a folder, in their order.
std::vector<std::string> names_in(const fs::path& folder) {
  std::vector<std::string> names;
  std::error_code code;
  for (fs::directory_iterator i(folder, code), end; !code && i != end; i.increment(code)) {
    std::string name = i->path().filename().string();
    if (line_of(name)) names.push_back(std::move(name));
  }
  if (code) throw Error("cannot be read: " + code.message(), folder.string());
  std::sort(names.begin(), names.end());
  return names;
}

/// Whether it was this process that moved the file; false where it is not there any more.
bool move_file(const fs::path& from, const fs::path& to) {
  if (std::rename(from.c_str(), to.c_str()) == 0) return true;
  if (errno == ENOENT) return false;
  throw Error(std::string("cannot be renamed: ") + std::strerror(errno), from.string());
}

/// Gives a file the time that it is, by the clock of its file system. False where it is not there.
bool touch(const fs::path& path) { return ::utimensat(AT_FDCWD, path.c_str(), nullptr, 0) == 0; }

/// When a file was touched last, in seconds; opened, because a network file system may remember an older time.
std::optional<double> time_of(const fs::path& path) {
  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (file < 0) return std::nullopt;
  struct stat status {};
  const int result = ::fstat(file, &status);
  ::close(file);
  if (result != 0) return std::nullopt;
  return static_cast<double>(status.st_mtim.tv_sec) + 1e-9 * static_cast<double>(status.st_mtim.tv_nsec);
}

/// The commands of a list: its lines but for empty ones and remarks.
std::vector<std::string> commands_of(const fs::path& list) {
  const std::vector<std::byte> bytes = read_file(list);
  std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  std::vector<std::string> commands;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::string_view line = text.substr(0, end);
    const std::size_t begin = line.find_first_not_of(" \t\r");
    if (begin != std::string_view::npos && line[begin] != '#') commands.emplace_back(line);
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return commands;
}

}  // namespace

WorkQueue::WorkQueue(std::vector<fs::path> lists, std::string worker, double lease_s)
    : lists_(std::move(lists)), worker_(std::move(worker)), lease_s_(lease_s) {
  for (const fs::path& list : lists_) commands_.push_back(commands_of(list));
  folder_ = lists_[0];
  folder_ += ".work";
  std::error_code code;
  if (!fs::exists(folder_, code)) make_folder();
  const std::vector<std::byte> made_of = read_file(folder_ / kLists);
  if (std::string_view(reinterpret_cast<const char*>(made_of.data()), made_of.size()) != list_text()) {
    throw Error(fmt::format("is the work of other lines than {} has now: remove it to begin anew", lists_[0].string()),
                folder_.string());
  }
  write_file(folder_ / kWorkers / worker_, std::string());
}

WorkQueue::~WorkQueue() {
  std::error_code code;
  fs::remove(folder_ / kWorkers / worker_, code);
}

/// Of what lists a folder is.
std::string WorkQueue::list_text() const {
  std::string text;
  for (const std::vector<std::string>& commands : commands_) {
    std::uint64_t print = fingerprint({});
    for (const std::string& command : commands) print = fingerprint(std::as_bytes(std::span(command)), print);
    text += fmt::format("{} lines {:016x}\n", commands.size(), print);
  }
  return text;
}

/// Made beside and renamed, so that it is there as a whole; another worker's stands where that was faster.
void WorkQueue::make_folder() const {
  fs::path own = folder_;
  own += "." + worker_;
  try {
    for (const char* name : {kWaiting, kTaken, kDone, kFailed, kWorkers, kLogs}) fs::create_directories(own / name);
    write_file(own / kLists, list_text());
    for (std::size_t stage = 0; stage < commands_.size(); ++stage) {
      for (std::size_t i = 0; i < commands_[stage].size(); ++i) {
        write_file(own / kWaiting / name_of({.stage = stage, .number = i + 1}), std::string());
      }
    }
    fs::rename(own, folder_);
  } catch (const fs::filesystem_error& error) {
    std::error_code code;
    fs::remove_all(own, code);
    if (!fs::exists(folder_, code)) throw Error("cannot be made: " + error.code().message(), folder_.string());
  }
}

/// Lines of workers that are gone wait again; after the last attempt they have failed.
void WorkQueue::take_back_lost() {
  const fs::path clock = folder_ / kWorkers / worker_;
  const std::vector<std::string> taken = names_in(folder_ / kTaken);
  if (taken.empty()) return;
  if (!touch(clock)) write_file(clock, std::string());
  const std::optional<double> now = time_of(clock);
  for (const std::string& name : taken) {
    const std::optional<double> renewed = time_of(folder_ / kTaken / name);
    if (!now || !renewed || *now - *renewed < lease_s_) continue;
    WorkLine line = *line_of(name);
    const bool is_last = line.attempt >= kMostAttempts;
    if (!is_last) ++line.attempt;
    move_file(folder_ / kTaken / name, folder_ / (is_last ? kFailed : kWaiting) / name_of(line));
  }
}

/// The first whose lines have not all ended. Those that have are counted: of the others one may be on its way from one
/// folder to another while these are listed.
std::optional<std::size_t> WorkQueue::stage_at_hand() const {
  std::vector<std::size_t> ended(commands_.size());
  for (const char* folder : {kDone, kFailed}) {
    for (const std::string& name : names_in(folder_ / folder)) ++ended.at(line_of(name)->stage);
  }
  for (std::size_t stage = 0; stage < commands_.size(); ++stage) {
    if (ended[stage] < commands_[stage].size()) return stage;
  }
  return std::nullopt;
}

std::optional<WorkLine> WorkQueue::claim() {
  const std::optional<std::size_t> stage = stage_at_hand();
  if (!stage) return std::nullopt;
  for (int look = 0; look < 2; ++look) {
    for (const std::string& name : names_in(folder_ / kWaiting)) {
      WorkLine line = *line_of(name);
      if (line.stage > *stage) break;
      // Touched before: taken with an old time it would pass for lost.
      touch(folder_ / kWaiting / name);
      if (!move_file(folder_ / kWaiting / name, folder_ / kTaken / (name + "@" + worker_))) continue;
      line.command = commands_.at(line.stage).at(line.number - 1);
      return claimed_ = line;
    }
    if (look == 0) take_back_lost();
  }
  return std::nullopt;
}

bool WorkQueue::renew() { return touch(folder_ / kTaken / (name_of(*claimed_) + "@" + worker_)); }

/// Nothing where another worker has taken it over.
void WorkQueue::end(const fs::path& to) {
  move_file(folder_ / kTaken / (name_of(*claimed_) + "@" + worker_), to);
  claimed_.reset();
}

void WorkQueue::complete() { end(folder_ / kDone / name_of(*claimed_)); }

bool WorkQueue::fail() {
  WorkLine next = *claimed_;
  const bool is_last = next.attempt >= kMostAttempts;
  if (!is_last) ++next.attempt;
  end(folder_ / (is_last ? kFailed : kWaiting) / name_of(next));
  return !is_last;
}

void WorkQueue::give_back() { end(folder_ / kWaiting / name_of(*claimed_)); }

bool WorkQueue::is_finished() const { return !stage_at_hand(); }

WorkCounts WorkQueue::counts() const {
  return {.waiting = names_in(folder_ / kWaiting).size(),
          .taken = names_in(folder_ / kTaken).size(),
          .done = names_in(folder_ / kDone).size(),
          .failed = names_in(folder_ / kFailed).size()};
}

std::vector<WorkLine> WorkQueue::failed() const {
  std::vector<WorkLine> lines;
  for (const std::string& name : names_in(folder_ / kFailed)) {
    WorkLine line = *line_of(name);
    line.command = commands_.at(line.stage).at(line.number - 1);
    lines.push_back(std::move(line));
  }
  return lines;
}

void WorkQueue::retry_failed() {
  for (const std::string& name : names_in(folder_ / kFailed)) {
    WorkLine line = *line_of(name);
    line.attempt = 1;
    move_file(folder_ / kFailed / name, folder_ / kWaiting / name_of(line));
  }
}

fs::path WorkQueue::log_of(const WorkLine& line) const { return folder_ / kLogs / (name_of(line) + ".txt"); }

}  // namespace candela
