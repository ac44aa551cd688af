// SPDX-License-Identifier: BSD-3-Clause
#include <set>
#include <system_error>

#include "core/atomic_file.h"
#include "encode/afx.h"

namespace lfm {
namespace {

constexpr const char* kFile = "model.wrl";
constexpr const char* kFolder = "model_afx";

// Removes what is in the folder of pictures but for those named; what cannot go does no harm.
void RemoveOthers(const std::filesystem::path& folder, const std::set<std::string>& names) {
  std::error_code ignored;
  std::vector<std::filesystem::path> others;
  for (const auto& entry : std::filesystem::directory_iterator(folder / kFolder, ignored)) {
    if (!names.contains(std::string(kFolder) + "/" + entry.path().filename().string())) {
      others.push_back(entry.path());
    }
  }
  for (const auto& other : others) std::filesystem::remove(other, ignored);
}

}  // namespace

int64_t SaveAfx(const AfxFiles& files, const std::filesystem::path& folder) {
  int64_t bytes = 0;
  std::set<std::string> names;
  for (const AfxFiles::Picture& picture : files.pictures) {
    if (!names.insert(picture.name).second) continue;
    const auto* data = reinterpret_cast<const char*>(picture.png.data());
    WriteFileAtomically(folder / picture.name, std::string_view(data, picture.png.size()));
    bytes += static_cast<int64_t>(picture.png.size());
  }
  WriteFileAtomically(folder / kFile, files.wrl);
  RemoveOthers(folder, names);
  return bytes + static_cast<int64_t>(files.wrl.size());
}

void RemoveAfx(const std::filesystem::path& folder) {
  std::error_code ignored;
  std::filesystem::remove(folder / kFile, ignored);
  RemoveOthers(folder, {});
  std::filesystem::remove(folder / kFolder, ignored);
}

}  // namespace lfm
