// SPDX-License-Identifier: BSD-3-Clause
#include "calib/calib_picture.h"

#include <algorithm>

#include "core/error.h"

namespace lfm {
namespace {

std::vector<CalibPicture> ListWhiteFrames(const Capture& capture, const std::vector<ScanSet>& sets,
                                          const std::vector<std::string>& roles,
                                          const std::string& roles_name, PictureKind kind) {
  if (sets.empty()) return {};
  const auto white = std::find(roles.begin(), roles.end(), "white");
  if (white == roles.end()) {
    throw Error((capture.folder / "capture.json").string() + ": scanner." + roles_name +
                ": no frame \"white\"; the platform is found in that picture");
  }
  std::vector<CalibPicture> pictures;
  const size_t frame = static_cast<size_t>(white - roles.begin());
  for (const ScanSet& set : sets) {
    CalibPicture picture;
    picture.kind = kind;
    picture.id = set.id;
    picture.camera = capture.scanner->camera;
    if (frame < set.frames.size()) {
      picture.file = set.frames[frame];
    } else {
      picture.rejected = "its white frame is missing";
    }
    pictures.push_back(picture);
  }
  return pictures;
}

}  // namespace

std::vector<CalibPicture> ListPictures(const Capture& capture) {
  std::vector<CalibPicture> pictures;
  for (const Photo& photo : capture.photos) {
    CalibPicture picture;
    picture.id = photo.id;
    picture.file = photo.file;
    picture.camera = photo.camera;
    picture.split = photo.split;
    pictures.push_back(picture);
  }
  if (capture.scanner) {
    const Scanner& scanner = *capture.scanner;
    for (const auto& frames : {ListWhiteFrames(capture, scanner.scans, scanner.scan_roles,
                                               "scan_roles", PictureKind::kScan),
                               ListWhiteFrames(capture, scanner.placements, scanner.placement_roles,
                                               "placement_roles", PictureKind::kPlacement)}) {
      pictures.insert(pictures.end(), frames.begin(), frames.end());
    }
  }
  return pictures;
}

}  // namespace lfm
