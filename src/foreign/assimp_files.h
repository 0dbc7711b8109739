#pragma once

#include <assimp/IOStream.hpp>
#include <assimp/IOSystem.hpp>
#include <string>
#include <vector>

#include "foreign/draft.h"

namespace candela::foreign {

/// The only files that Assimp sees: the scene, as `kMainFile` with the ending of its format, and what `around` lets it
/// read. Writing is refused, and so are material libraries, which read_mtl reads.
class AssimpFiles : public Assimp::IOSystem {
 public:
  AssimpFiles(std::string main_name, std::span<const std::byte> main, const Surroundings& around)
      : main_name_(std::move(main_name)), main_(main), around_(around) {}

  bool Exists(const char* name) const override;
  char getOsSeparator() const override { return '/'; }
  Assimp::IOStream* Open(const char* name, const char* mode) override;
  void Close(Assimp::IOStream* stream) override { delete stream; }

  /// Names of what it opened beside the scene.
  const std::vector<std::string>& opened() const { return opened_; }

 private:
  std::string main_name_;
  std::span<const std::byte> main_;
  const Surroundings& around_;
  std::vector<std::string> opened_;
};

}  // namespace candela::foreign
