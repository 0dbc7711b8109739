#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace candela::viewer {

class App;

/// Input that is played in place of a user's: a text file with one step a line, as docs/viewer.md lists them.
class Script {
 public:
  /// Reads and checks all of it. Throws Error, whose `where` is file and line.
  explicit Script(const std::filesystem::path& file);

  /// Does the next step if its time has come; returns whether it did something. Throws Error where a wait has not been
  /// answered in time.
  bool play(App& app);
  bool has_ended() const { return next_ == steps_.size(); }

 private:
  struct Step {
    std::size_t line = 0;
    std::vector<std::string> words;
  };
  bool play_step(App& app, const Step& step);
  bool wait(const App& app, const Step& step);
  std::string where(const Step& step) const;

  std::filesystem::path file_;
  std::vector<Step> steps_;
  std::size_t next_ = 0;
  double since_s_ = -1.0;  ///< when the step at hand was first looked at
  int stage_ = 0;          ///< of a step that takes several frames
};

}  // namespace candela::viewer
