// SPDX-License-Identifier: BSD-3-Clause
#include <set>
#include <string_view>
#include <system_error>

#include "core/atomic_file.h"
#include "encode/afx.h"
#include "encode/afx_pictures.h"

namespace lfm {
namespace {

constexpr const char* kFile = "model.wrl";
using afx::kPictureFolder;

// Removes our pictures but for those named, nothing of anybody else's; what cannot go does no harm.
void RemoveOthers(const std::filesystem::path& folder, const std::set<std::string>& names) {
  std::error_code ignored;
  std::vector<std::filesystem::path> others;
  if (std::filesystem::is_symlink(folder / kPictureFolder, ignored)) return;
  for (const auto& entry : std::filesystem::directory_iterator(folder / kPictureFolder, ignored)) {
    const std::string name = entry.path().filename().string();
    if (afx::IsPictureFile(name) && !names.contains(std::string(kPictureFolder) + "/" + name)) {
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
  if (std::filesystem::is_symlink(folder / kPictureFolder, ignored)) return;
  std::filesystem::remove(folder / kPictureFolder, ignored);  // when it is empty
}

}  // namespace lfm
