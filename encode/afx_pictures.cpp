// SPDX-License-Identifier: BSD-3-Clause
#include "encode/afx_pictures.h"

#include "core/hash.h"

namespace lfm::afx {
namespace {

constexpr size_t kHashDigits = 12;
constexpr std::string_view kEnding = ".png";

}  // namespace

std::string PictureFile(const std::string& kind, std::string_view png) {
  return kind + "-" + Hasher().Add(png).HexDigest().substr(0, kHashDigits) + std::string(kEnding);
}

bool IsPictureFile(std::string_view file) {
  if (file.size() < kHashDigits + 1 + kEnding.size() || !file.ends_with(kEnding)) return false;
  const size_t hash = file.size() - kEnding.size() - kHashDigits;
  const bool hashed = file[hash - 1] == '-' &&
                      file.find_first_not_of("0123456789abcdef", hash) == hash + kHashDigits;
  return hashed &&
         (file.starts_with("mean-") || file.starts_with("surface-") || file.starts_with("view-"));
}

bool FitsItsName(const std::string& path, std::string_view png) {
  const std::string file = path.substr(path.rfind('/') + 1);  // all of it without a slash
  if (!IsPictureFile(file)) return true;
  return file == PictureFile(file.substr(0, file.size() - kEnding.size() - kHashDigits - 1), png);
}

}  // namespace lfm::afx
