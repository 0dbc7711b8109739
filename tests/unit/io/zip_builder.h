#pragma once

#include <zip.h>

#include <cstddef>
#include <cstring>
#include <map>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

namespace candela::io::test {

/// An archive of these files, deflated or stored.
inline std::vector<std::byte> zip_of(const std::map<std::string, std::vector<std::byte>>& files, bool deflates = true) {
  const auto must = [](bool is_done) {
    if (!is_done) throw std::runtime_error("the archive cannot be made");
  };
  zip_error_t error;
  zip_error_init(&error);
  zip_source_t* memory = zip_source_buffer_create(nullptr, 0, 0, &error);
  must(memory != nullptr);
  zip_source_keep(memory);
  zip_t* archive = zip_open_from_source(memory, ZIP_TRUNCATE, &error);
  must(archive != nullptr);
  for (const auto& [name, bytes] : files) {
    const zip_int64_t index =
        zip_file_add(archive, name.c_str(), zip_source_buffer(archive, bytes.data(), bytes.size(), 0), 0);
    must(index >= 0);
    zip_set_file_compression(archive, static_cast<zip_uint64_t>(index), deflates ? ZIP_CM_DEFLATE : ZIP_CM_STORE, 9);
  }
  must(zip_close(archive) == 0);
  must(zip_source_open(memory) == 0);
  zip_stat_t stat;
  must(zip_source_stat(memory, &stat) == 0);
  std::vector<std::byte> result(static_cast<std::size_t>(stat.size));
  must(zip_source_read(memory, result.data(), result.size()) == static_cast<zip_int64_t>(result.size()));
  zip_source_close(memory);
  zip_source_free(memory);
  zip_error_fini(&error);
  return result;
}

}  // namespace candela::io::test
