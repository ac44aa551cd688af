// SPDX-License-Identifier: BSD-3-Clause
#include "fields/rti_capture.h"

#include <map>
#include <string>
#include <vector>

#include "core/error.h"
#include "fields/lit_pictures.h"
#include "fields/lp_file.h"
#include "fields/picture_search.h"
#include "fields/text_lines.h"

namespace lfm {
namespace {

// RTIBuilder keeps a project as assembly-files/*.lp beside jpeg-exports/.
std::filesystem::path FolderOfPictures(const std::filesystem::path& file) {
  std::filesystem::path folder = std::filesystem::absolute(file).lexically_normal().parent_path();
  if (folder.filename() == "assembly-files") folder = folder.parent_path();
  return folder;
}

std::string PictureOfLight(const FileNames& names, const LpLight& light, const std::string& list) {
  const std::vector<std::string> found = FindPicture(names, light.picture);
  if (found.size() > 1) {
    throw Error(LinePlace(list, light.line) + "the picture could be any of " + SomeNames(found) +
                "; write its path relative to " + names.folder.string());
  }
  return found.empty() ? "" : found.front();
}

}  // namespace

Capture OpenLpCapture(const std::filesystem::path& file, const FieldCaptureOptions& options,
                      Progress& progress) {
  constexpr int kLevels = 3;
  const std::string list = file.string();
  const LpFile lp = ReadLpFile(file);
  const FileNames names = ListFileNames(FolderOfPictures(file), kLevels);
  std::vector<LitPicture> pictures;
  std::vector<std::string> missing;
  std::map<std::string, int> line_of;
  for (const LpLight& light : lp.lights) {
    LitPicture picture;
    picture.file = PictureOfLight(names, light, list);
    picture.to_light = light.to_light;
    if (picture.file.empty()) {
      missing.push_back(light.picture);
      continue;
    }
    const auto [first, is_new] = line_of.emplace(picture.file, light.line);
    if (!is_new) {
      throw Error(LinePlace(list, light.line) + "leads to " + Quoted(picture.file) + ", as line " +
                  std::to_string(first->second) + " does; every light has a picture of its own");
    }
    pictures.push_back(std::move(picture));
  }
  if (!missing.empty()) {
    throw Error(list + ": pictures are missing: " + SomeNames(missing) + "; put them into " +
                names.folder.string() + " or a folder in it");
  }
  if (lp.not_unit > 0) {
    progress.Note(list + ": " + std::to_string(lp.not_unit) + " of " +
                  std::to_string(lp.lights.size()) +
                  " lights are no unit vectors; the directions towards them count");
  }
  return CaptureOfLitPictures(names.folder, file.stem().string(), list, std::move(pictures),
                              options.encoding, options);
}

}  // namespace lfm
