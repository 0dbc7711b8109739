#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

/// Commands that any number of processes do between them, on machines that share nothing but a folder.
namespace candela {

/// One command of a list.
struct WorkLine {
  std::size_t stage = 0;   ///< whose lines begin when all of the stage before have ended
  std::size_t number = 0;  ///< in its list, from 1
  int attempt = 1;
  std::string command = {};
};

struct WorkCounts {
  std::size_t waiting = 0, taken = 0, done = 0, failed = 0;
  std::size_t all() const { return waiting + taken + done + failed; }
};

/// The state of the lines of LIST is kept in the folder LIST.work: each has an empty file there, which goes from one
/// subfolder to the next by a rename. A rename is of one process alone, on network file systems too, so that no line is
/// taken twice. Whoever has a line renews its time; one whose time was not renewed for a while belongs to a process
/// that is gone, and goes back. Times are those of the file system, whatever the machines' clocks say.
class WorkQueue {
 public:
  /// `lists`: of each stage. Makes the folder unless it is there. Throws Error for lists that cannot be read and for a
  /// folder that was made of others.
  WorkQueue(std::vector<std::filesystem::path> lists, std::string worker, double lease_s);
  ~WorkQueue();
  WorkQueue(const WorkQueue&) = delete;
  WorkQueue& operator=(const WorkQueue&) = delete;

  /// A line for this worker, which has none. Empty where all lines are done, failed or taken by others.
  std::optional<WorkLine> claim();
  /// Keeps the claimed line; call it several times per lease. False where another worker has taken it over.
  bool renew();
  void complete();
  /// To be tried again, or counted as failed after the last attempt; returns whether it is tried again.
  bool fail();
  /// As if it had not been claimed.
  void give_back();

  /// Whether no line is waiting or taken.
  bool is_finished() const;
  WorkCounts counts() const;
  std::vector<WorkLine> failed() const;
  /// Lines that failed are waiting again.
  void retry_failed();
  /// Where what a line says goes.
  std::filesystem::path log_of(const WorkLine& line) const;

  static constexpr int kMostAttempts = 3;

 private:
  void make_folder() const;
  std::string list_text() const;
  void take_back_lost();
  std::optional<std::size_t> stage_at_hand() const;
  void end(const std::filesystem::path& to);

  std::vector<std::filesystem::path> lists_;
  std::vector<std::vector<std::string>> commands_;  ///< of each stage
  std::filesystem::path folder_;
  std::string worker_;
  double lease_s_;
  std::optional<WorkLine> claimed_;
};

}  // namespace candela
