#include <fmt/format.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <utility>
#include <vector>

#include "base/error.h"
#include "base/file.h"
#include "base/text.h"
#include "image/movie.h"

namespace candela::movie {

namespace {

namespace fs = std::filesystem;

class Descriptor {
 public:
  explicit Descriptor(int value = -1) : value_(value) {}
  ~Descriptor() { close(); }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;

  int get() const { return value_; }
  void set(int value) { close(), value_ = value; }
  void close() {
    if (value_ >= 0) ::close(value_);
    value_ = -1;
  }

 private:
  int value_;
};

struct FileCloser {
  void operator()(std::FILE* file) const { std::fclose(file); }
};

bool is_in_path(const std::string& program) {
  const char* folders = std::getenv("PATH");
  std::string rest = folders != nullptr ? folders : "";
  while (!rest.empty()) {
    const std::size_t colon = std::min(rest.find(':'), rest.size());
    const fs::path file = fs::path(rest.substr(0, colon)) / program;
    std::error_code code;
    if (fs::is_regular_file(file, code) && access(file.c_str(), X_OK) == 0) return true;
    rest.erase(0, colon + 1);
  }
  return false;
}

/// What is piped in is sRGB, of which a film has every second row and column of its colours, as all players want it.
std::vector<std::string> arguments_for(const fs::path& path, const fs::path& temp, const MovieSettings& settings) {
  std::vector<std::string> list = {"ffmpeg",
                                   "-hide_banner",
                                   "-nostdin",
                                   "-loglevel",
                                   "error",
                                   "-y",
                                   "-f",
                                   "rawvideo",
                                   "-pix_fmt",
                                   "rgba",
                                   "-s",
                                   fmt::format("{}x{}", settings.size.x, settings.size.y),
                                   "-r",
                                   fmt::format("{:.6g}", settings.frame_rate),
                                   "-i",
                                   "pipe:0",
                                   "-an",
                                   "-vf",
                                   "crop=trunc(iw/2)*2:trunc(ih/2)*2,scale=out_color_matrix=bt709:out_range=tv"};
  const auto add = [&](std::initializer_list<const char*> more) { list.insert(list.end(), more.begin(), more.end()); };
  if (lower_extension(path) == ".webm") {
    add({"-c:v", "libvpx-vp9", "-crf", "18", "-b:v", "0", "-row-mt", "1", "-pix_fmt"});
    add({settings.has_alpha ? "yuva420p" : "yuv420p"});
  } else {
    add({"-c:v", "libx264", "-crf", "16", "-preset", "slow", "-pix_fmt", "yuv420p", "-movflags", "+faststart"});
  }
  add({"-colorspace", "bt709", "-color_primaries", "bt709", "-color_trc", "iec61966-2-1", "-color_range", "tv"});
  add({"-f", lower_extension(path) == ".webm" ? "webm" : "mp4"});
  list.push_back(temp.string());
  return list;
}

class FfmpegWriter : public MovieWriter {
 public:
  FfmpegWriter(const fs::path& path, const MovieSettings& settings)
      : path_(path), settings_(settings), file_(path), messages_(std::tmpfile()) {
    if (is_device(path)) throw Error("a film is written to a file", path.string());
    if (messages_ == nullptr) throw Error("cannot make a temporary file: " + reason(errno), path.string());
    start();
  }
  ~FfmpegWriter() override {
    if (child_ <= 0) return;
    input_.close();
    kill(child_, SIGKILL);
    waitpid(child_, nullptr, 0);
  }

  void add(const DisplayImage& picture) override;
  void finish() override;

 private:
  static std::string reason(int code) { return std::strerror(code); }
  void start();
  bool is_done(std::string& why);
  std::string last_message();

  fs::path path_;
  MovieSettings settings_;
  AtomicFile file_;
  std::unique_ptr<std::FILE, FileCloser> messages_;  ///< what ffmpeg has to say
  Descriptor input_;
  pid_t child_ = -1;
  std::vector<std::uint8_t> over_black_;
  std::size_t count_ = 0;
};

/// A socket in place of a pipe: writing to an ffmpeg that is gone is an error then, and no signal.
void FfmpegWriter::start() {
  int ends[2];
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0) {
    throw Error("cannot start ffmpeg: " + reason(errno), path_.string());
  }
  input_.set(ends[0]);
  const Descriptor theirs(ends[1]);
  std::vector<std::string> arguments = arguments_for(path_, file_.temp_path(), settings_);
  std::vector<char*> pointers;
  pointers.reserve(arguments.size() + 1);
  for (std::string& argument : arguments) pointers.push_back(argument.data());
  pointers.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, theirs.get(), STDIN_FILENO);
  posix_spawn_file_actions_adddup2(&actions, fileno(messages_.get()), STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&actions, fileno(messages_.get()), STDERR_FILENO);
  // In a group of its own: Ctrl-C is for this program, which ends the film.
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
  posix_spawnattr_setpgroup(&attributes, 0);
  const int code = posix_spawnp(&child_, "ffmpeg", &actions, &attributes, pointers.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  posix_spawnattr_destroy(&attributes);
  if (code == 0) return;
  child_ = -1;
  throw Error("cannot start ffmpeg: " + reason(code), path_.string());
}

void FfmpegWriter::add(const DisplayImage& picture) {
  if (ivec2(picture.width, picture.height) != settings_.size) throw Error("a picture has another size", path_.string());
  const std::vector<std::uint8_t>* bytes = &picture.rgba;
  if (lower_extension(path_) == ".mp4") {
    over_black_ = picture.rgba;
    for (std::size_t i = 0; i < over_black_.size(); ++i) {
      over_black_[i] = static_cast<std::uint8_t>((picture.rgba[i] * picture.rgba[i | 3] + 127) / 255);
    }
    bytes = &over_black_;
  }
  for (std::size_t sent = 0; sent < bytes->size();) {
    const ssize_t more = send(input_.get(), bytes->data() + sent, bytes->size() - sent, MSG_NOSIGNAL);
    if (more < 0 && errno == EINTR) continue;
    if (more <= 0) {
      std::string why;
      is_done(why);
      throw Error(why, path_.string());
    }
    sent += static_cast<std::size_t>(more);
  }
  ++count_;
}

std::string FfmpegWriter::last_message() {
  std::rewind(messages_.get());
  std::string text, line;
  for (int c = std::fgetc(messages_.get()); c != EOF; c = std::fgetc(messages_.get())) {
    if (c != '\n') {
      line += static_cast<char>(c);
      continue;
    }
    if (!line.empty()) text = line;
    line.clear();
  }
  return line.empty() ? text : line;
}

/// Waits for ffmpeg to end; whether it says that all is well.
bool FfmpegWriter::is_done(std::string& why) {
  input_.close();
  int status = 0;
  const pid_t child = std::exchange(child_, -1);
  while (waitpid(child, &status, 0) < 0) {
    if (errno != EINTR) throw Error("ffmpeg is lost: " + reason(errno), path_.string());
  }
  const std::string message = last_message();
  why = WIFSIGNALED(status) ? fmt::format("ffmpeg has failed (signal {})", WTERMSIG(status))
                            : fmt::format("ffmpeg has failed (exit code {})", WEXITSTATUS(status));
  if (!message.empty()) why += ": " + message;
  std::error_code code;
  // Some versions report a full disk in words alone.
  return WIFEXITED(status) && WEXITSTATUS(status) == 0 && message.find("No space left") == std::string::npos &&
         fs::file_size(file_.temp_path(), code) > 0 && !code;
}

void FfmpegWriter::finish() {
  if (count_ == 0) throw Error("there is no picture for the film", path_.string());
  std::string why;
  if (!is_done(why)) throw Error(why, path_.string());
  file_.commit();
}

}  // namespace

void check_ffmpeg(const fs::path& path) {
  if (is_in_path("ffmpeg")) return;
  throw Error("ffmpeg, which writes it, is not installed; a .webp or .gif needs nothing", path.string());
}

std::unique_ptr<MovieWriter> open_ffmpeg(const fs::path& path, const MovieSettings& settings) {
  return std::make_unique<FfmpegWriter>(path, settings);
}

}  // namespace candela::movie
