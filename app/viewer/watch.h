#pragma once

#include <filesystem>
#include <map>
#include <vector>

namespace candela::viewer {

/// Files, and whether they have changed since they were last looked at.
class FileWatch {
 public:
  /// Watches these from now on; of folders all that is below them.
  void set(std::vector<std::filesystem::path> paths);
  /// Whether something has changed and has now stood still for one look, so that no half of a file is read. At most a
  /// few looks a second at the disk are made, whenever it is called.
  bool has_changed(double now_s);

 private:
  using Times = std::map<std::filesystem::path, std::pair<std::filesystem::file_time_type, std::uintmax_t>>;
  Times look() const;

  std::vector<std::filesystem::path> paths_;
  Times known_, last_;
  double next_s_ = 0.0;
};

}  // namespace candela::viewer
