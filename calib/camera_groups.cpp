// SPDX-License-Identifier: BSD-3-Clause
#include "calib/camera_groups.h"

#include <algorithm>
#include <cstdio>

namespace lfm {
namespace {

constexpr size_t kLeastPictures = 3;

std::string SizeText(int width, int height) {
  return std::to_string(width) + "x" + std::to_string(height);
}

// What two pictures of one camera share; people read it too.
std::string Describe(const ExifCamera& exif, int width, int height) {
  char focal[32] = "";
  if (exif.focal_mm > 0) std::snprintf(focal, sizeof focal, ", %.3g mm", exif.focal_mm);
  const std::string name =
      exif.make + (exif.make.empty() || exif.model.empty() ? "" : " ") + exif.model;
  return (name.empty() ? "unnamed" : name) + focal + ", " + SizeText(width, height);
}

struct Part {
  std::string description;
  int width = 0, height = 0;
  std::vector<size_t> pictures;
  size_t training = 0;
};

void SetAsideOtherSizes(std::vector<CalibPicture>& pictures, const std::string& name,
                        const CaptureCamera& camera, bool in_use) {
  for (CalibPicture& picture : pictures) {
    if (picture.InUse() != in_use || picture.camera != name || picture.width == 0) continue;
    if (picture.width == camera.width && picture.height == camera.height) continue;
    picture.rejected = "is " + SizeText(picture.width, picture.height) + ", but camera \"" + name +
                       "\" is " + SizeText(camera.width, camera.height);
  }
}

std::vector<Part> PartsOf(std::vector<CalibPicture>& pictures, const std::string& name,
                          const CaptureCamera& camera, const ExifReader& read_exif) {
  std::vector<Part> parts;
  for (size_t i = 0; i < pictures.size(); ++i) {
    CalibPicture& picture = pictures[i];
    if (!picture.InUse() || picture.camera != name) continue;
    const std::optional<ExifCamera> exif = read_exif(picture.file);
    if (!exif) continue;
    const std::string text = Describe(*exif, picture.width, picture.height);
    auto part = std::find_if(parts.begin(), parts.end(),
                             [&](const Part& p) { return p.description == text; });
    if (part == parts.end()) {
      parts.push_back({text, picture.width, picture.height, {}, 0});
      part = parts.end() - 1;
    }
    part->pictures.push_back(i);
    part->training += picture.split == PhotoSplit::kTrain;
  }
  // The one that keeps the name comes first.
  std::stable_sort(parts.begin(), parts.end(), [&](const Part& a, const Part& b) {
    const auto fits = [&](const Part& p) {
      return p.width == camera.width && p.height == camera.height;
    };
    if (fits(a) != fits(b)) return fits(a);
    return a.training > b.training;
  });
  return parts;
}

}  // namespace

CameraGroups GroupByExif(std::vector<CalibPicture> pictures, const Capture& capture,
                         const ExifReader& read_exif) {
  CameraGroups groups{capture.cameras, std::move(pictures)};
  for (const auto& [name, camera] : capture.cameras) {
    // Whatever else was found wrong with it, another size comes first.
    SetAsideOtherSizes(groups.pictures, name, camera, false);
    const bool parted = !camera.intrinsics && !(capture.scanner && capture.scanner->camera == name);
    const std::vector<Part> parts =
        parted ? PartsOf(groups.pictures, name, camera, read_exif) : std::vector<Part>();
    const bool first_fits =
        !parts.empty() && parts[0].width == camera.width && parts[0].height == camera.height;
    int number = 1;
    for (size_t p = first_fits ? 1 : 0; p < parts.size(); ++p) {
      const Part& part = parts[p];
      std::string part_name;
      do {
        part_name = name + "-" + std::to_string(++number);
      } while (groups.cameras.contains(part_name));
      CaptureCamera of_part = camera;
      of_part.width = part.width, of_part.height = part.height;
      const bool enough = part.training >= kLeastPictures;
      if (enough) groups.cameras[part_name] = of_part;
      for (const size_t i : part.pictures) {
        CalibPicture& picture = groups.pictures[i];
        if (enough) {
          picture.camera = part_name;
        } else {
          picture.rejected = "taken by another camera (" + part.description +
                             ") than the others of \"" + name +
                             "\", of which at least three training pictures are needed";
        }
      }
    }
    SetAsideOtherSizes(groups.pictures, name, camera, true);
  }
  return groups;
}

}  // namespace lfm
