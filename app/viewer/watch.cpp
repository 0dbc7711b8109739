#include "viewer/watch.h"

#include <system_error>
#include <utility>

namespace candela::viewer {

namespace fs = std::filesystem;

FileWatch::Times FileWatch::look() const {
  Times times;
  std::error_code code;
  const auto add = [&](const fs::path& path) {
    const fs::file_time_type time = fs::last_write_time(path, code);
    if (!code) times[path] = {time, fs::file_size(path, code)};
  };
  for (const fs::path& path : paths_) {
    if (!fs::is_directory(path, code)) {
      add(path);
      continue;
    }
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(path, code)) {
      if (entry.is_regular_file(code)) add(entry.path());
    }
  }
  return times;
}

void FileWatch::set(std::vector<fs::path> paths) {
  paths_ = std::move(paths);
  known_ = last_ = look();
}

bool FileWatch::has_changed(double now_s) {
  constexpr double kEvery = 0.25;  // seconds
  if (paths_.empty() || now_s < next_s_) return false;
  next_s_ = now_s + kEvery;
  Times now = look();
  const bool is_still = now == last_;
  last_ = std::move(now);
  if (!is_still || last_ == known_) return false;
  known_ = last_;
  return true;
}

}  // namespace candela::viewer
