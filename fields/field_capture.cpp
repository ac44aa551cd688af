// SPDX-License-Identifier: BSD-3-Clause
#include "fields/field_capture.h"

#include <algorithm>
#include <string>
#include <vector>

#include "core/error.h"
#include "fields/diligent_capture.h"
#include "fields/lit_pictures.h"
#include "fields/rti_capture.h"

namespace lfm {
namespace {

namespace fs = std::filesystem;

constexpr const char* kManifest = "capture.json";
constexpr const char* kAssembly = "assembly-files";

Capture OpenManifest(const fs::path& folder) {
  Capture capture = LoadCapture(folder);
  if (!capture.reflectance_field && !capture.transport) {
    throw Error((folder / kManifest).string() +
                ": has neither \"reflectance_field\" nor \"transport\"; there is no field to read");
  }
  return capture;
}

Capture OpenFolder(const fs::path& folder, const FieldCaptureOptions& options, Progress& progress) {
  std::error_code error;
  if (fs::exists(folder / kManifest, error)) return OpenManifest(folder);
  if (IsDiligentFolder(folder)) return OpenDiligentCapture(folder, options, progress);
  std::vector<fs::path> files = LpFilesIn(folder);
  if (files.empty()) files = LpFilesIn(folder / kAssembly);
  if (files.empty()) {
    throw Error(folder.string() + ": holds no field: neither " + kManifest +
                ", nor one .lp file, nor filenames.txt with light_directions.txt");
  }
  if (files.size() > 1) {
    std::vector<std::string> names;
    for (const fs::path& file : files) names.push_back(file.filename().string());
    throw Error(folder.string() + ": holds several .lp files (" + SomeNames(names) +
                "); name one of them instead of the folder");
  }
  return OpenLpCapture(files.front(), options, progress);
}

}  // namespace

bool IsLpFile(const fs::path& file) {
  std::string ending = file.extension().string();
  for (char& c : ending) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  }
  std::error_code error;
  return ending == ".lp" && fs::is_regular_file(file, error);
}

std::vector<fs::path> LpFilesIn(const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code error;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    if (IsLpFile(it->path())) files.push_back(it->path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

Capture OpenFieldCapture(const fs::path& path, const FieldCaptureOptions& options,
                         Progress& progress) {
  std::error_code error;
  if (fs::is_directory(path, error)) return OpenFolder(path, options, progress);
  if (!fs::exists(path, error)) {
    throw Error(path.string() + ": no such file or folder; name a folder with " + kManifest +
                ", an .lp file, or a folder in DiLiGenT's layout");
  }
  if (path.filename() == kManifest) {
    return OpenManifest(path.has_parent_path() ? path.parent_path() : fs::path("."));
  }
  if (IsLpFile(path)) return OpenLpCapture(path, options, progress);
  throw Error(path.string() + ": is neither a folder nor an .lp file; name a folder with " +
              kManifest + ", an .lp file, or a folder in DiLiGenT's layout");
}

}  // namespace lfm
