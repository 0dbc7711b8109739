#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <nlohmann/json.hpp>
#include <set>
#include <system_error>

#include "base/error.h"
#include "base/file.h"
#include "base/parallel.h"
#include "cli/bake_output.h"
#include "cli/output.h"

namespace candela::cli {

namespace fs = std::filesystem;
using Json = nlohmann::json;

namespace {

constexpr const char* kManifest = "bake.json";

/// A folder that goes away with what is still in it.
class Workshop {
 public:
  explicit Workshop(const fs::path& beside)
      : path_(beside.parent_path() / fmt::format(".{}.{}", beside.filename().string(), ::getpid())) {
    std::error_code code;
    fs::create_directories(made(), code);
    if (!code) fs::create_directory(replaced(), code);
    if (code) throw Error("cannot make a folder: " + code.message(), beside.string());
  }
  ~Workshop() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  Workshop(const Workshop&) = delete;
  Workshop& operator=(const Workshop&) = delete;

  fs::path made() const { return path_ / "made"; }
  fs::path replaced() const { return path_ / "replaced"; }  ///< what was in the way, until all is done

 private:
  fs::path path_;
};

/// Ctrl-C waits while files change places.
class SignalsHeld {
 public:
  SignalsHeld() {
    sigset_t held;
    sigemptyset(&held);
    sigaddset(&held, SIGINT);
    sigaddset(&held, SIGTERM);
    pthread_sigmask(SIG_BLOCK, &held, &before_);
  }
  ~SignalsHeld() { pthread_sigmask(SIG_SETMASK, &before_, nullptr); }
  SignalsHeld(const SignalsHeld&) = delete;
  SignalsHeld& operator=(const SignalsHeld&) = delete;

 private:
  sigset_t before_{};
};

BakeFile describe(const fs::path& path) {
  const std::vector<std::byte> bytes = read_file(path);
  return {path.filename().string(), bytes.size(), fingerprint(bytes)};
}

/// A name in the folder itself: a manifest may say anything.
bool is_plain_name(const std::string& name) {
  return !name.empty() && name != "." && name != ".." && name != kManifest && name.find('/') == std::string::npos &&
         name.find('\0') == std::string::npos;
}

/// What an earlier bake wrote into the folder and is still as it wrote it.
std::vector<BakeFile> earlier_files(const fs::path& folder, std::vector<Diagnostic>& warnings) {
  std::vector<BakeFile> result;
  std::error_code code;
  if (!fs::is_regular_file(folder / kManifest, code)) return result;
  Json manifest;
  try {
    const std::vector<std::byte> bytes = read_file(folder / kManifest);
    manifest = Json::parse(reinterpret_cast<const char*>(bytes.data()),
                           reinterpret_cast<const char*>(bytes.data()) + bytes.size(), nullptr, false);
  } catch (const Error&) {
    // As if there were none.
  }
  const auto files = manifest.is_object() ? manifest.find("files") : manifest.end();
  if (!manifest.is_object() || files == manifest.end() || !files->is_array()) {
    warnings.push_back({"does not say which files an earlier bake wrote: they stay", (folder / kManifest).string()});
    return result;
  }
  for (const Json& entry : *files) {
    if (!entry.is_object() || !entry.contains("name") || !entry["name"].is_string()) continue;
    const std::string name = entry["name"];
    const fs::path path = folder / name;
    if (!is_plain_name(name) || fs::is_symlink(path, code) || !fs::is_regular_file(path, code)) continue;
    try {
      BakeFile now = describe(path);
      const bool is_ours = entry.value("bytes", Json()) == now.bytes &&
                           entry.value("fingerprint", Json()) == fmt::format("{:016x}", now.fingerprint);
      if (is_ours) result.push_back(std::move(now));
    } catch (const Error&) {
      // What cannot be read cannot be known to be ours.
    }
  }
  return result;
}

/// Moves files and can undo it.
class Moves {
 public:
  ~Moves() {
    std::error_code ignored;
    if (!is_kept_) {
      for (auto done = done_.rbegin(); done != done_.rend(); ++done) fs::rename(done->second, done->first, ignored);
    }
  }
  Moves() = default;
  Moves(const Moves&) = delete;
  Moves& operator=(const Moves&) = delete;

  void move(const fs::path& from, const fs::path& to, const fs::path& blamed) {
    std::error_code code;
    fs::rename(from, to, code);
    if (code) throw Error("cannot write: " + code.message(), blamed.string());
    done_.emplace_back(from, to);
  }
  void keep() { is_kept_ = true; }

 private:
  std::vector<std::pair<fs::path, fs::path>> done_;
  bool is_kept_ = false;
};

void check_target(const fs::path& path, const Inputs& inputs, const fs::path& report) {
  inputs.refuse(path);
  std::error_code code;
  if (fs::is_directory(path, code)) throw Error("is a folder, not a file", path.string());
  if (!report.empty() && file_identity(report) == file_identity(path)) {
    throw Error("is a file of the bake: give the report another name", report.string());
  }
}

}  // namespace

std::vector<BakeFile> write_bake(const fs::path& folder, const Inputs& inputs, const fs::path& report,
                                 BakeResult& result) {
  const fs::path whole = folder.has_filename() ? folder : folder.parent_path();
  const FolderFor parent(whole);
  const Workshop workshop(fs::absolute(whole));
  write_bake_files(workshop.made(), result);
  std::vector<BakeFile> files;

  std::set<std::string> names;
  for (const fs::directory_entry& file : fs::directory_iterator(workshop.made())) {
    names.insert(file.path().filename().string());
  }
  for (const std::string& name : names) {
    files.push_back(describe(workshop.made() / name));
    check_target(whole / name, inputs, report);
  }
  check_target(whole / kManifest, inputs, report);

  std::vector<std::string> leftovers;
  for (BakeFile& file : earlier_files(whole, result.warnings)) {
    if (names.contains(file.name)) continue;
    if (!inputs.contains(whole / file.name)) {
      leftovers.push_back(file.name);
      continue;
    }
    result.warnings.push_back({"is of an earlier bake and stays, for this one read it", (whole / file.name).string()});
    files.push_back(std::move(file));
  }
  write_file(workshop.made() / kManifest, bake_json(result, files));
  names.insert(kManifest);

  StopScope::check();
  const SignalsHeld held;
  std::error_code code;
  const bool is_new = fs::create_directory(whole, code);
  if (code) throw Error("cannot make the folder: " + code.message(), whole.string());
  try {
    Moves moves;
    for (const std::string& name : names) {
      if (fs::exists(fs::symlink_status(whole / name, code)))
        moves.move(whole / name, workshop.replaced() / name, whole / name);
    }
    for (const std::string& name : leftovers) moves.move(whole / name, workshop.replaced() / name, whole / name);
    for (const std::string& name : names) moves.move(workshop.made() / name, whole / name, whole / name);
    moves.keep();
  } catch (const Error&) {
    if (is_new) fs::remove(whole, code);
    throw;
  }
  return files;
}

}  // namespace candela::cli
