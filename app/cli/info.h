#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

namespace candela::cli {

/// What `candela info` says: the same facts for a reader and for a machine.
struct Report {
  std::string text;
  std::string json;
};

bool is_image_file(const std::filesystem::path& path);
Report image_report(const std::filesystem::path& path);
Report scene_report(const std::string& scene);

/// Name and value in two columns, one line each.
class Table {
 public:
  void row(const std::string& name, const std::string& value);
  void item(const std::string& value);  ///< one more line under the last name
  const std::string& text() const { return text_; }

 private:
  std::string text_;
};

std::string bytes_text(std::size_t bytes);

}  // namespace candela::cli
