// SPDX-License-Identifier: BSD-3-Clause
#include "calib/tag_detection.h"

#include <apriltag/apriltag.h>

#include <algorithm>
#include <tuple>

#include "calib/tag_family.h"

namespace lfm {
namespace {

constexpr int kMinPictureSize = 16;
// The library's counter-clockwise order starts at the bottom left of the printed tag.
constexpr std::array<int, 4> kLibraryCorner = {3, 2, 1, 0};
constexpr double kLibraryPixelCenter = 0.5;

using Detections = std::unique_ptr<zarray_t, void (*)(zarray_t*)>;

}  // namespace

struct TagDetector::State {
  State(const std::string& family_name, int border_cells)
      : family(family_name, border_cells, "tag detector"),
        detector(apriltag_detector_create(), apriltag_detector_destroy) {
    apriltag_detector_add_family_bits(detector.get(), family.get(), family.correctable_bits());
    detector->nthreads = 1;
    // Oblique tags are a few pixels high: decimation loses them.
    detector->quad_decimate = 1;
  }
  ~State() { apriltag_detector_clear_families(detector.get()); }

  TagFamily family;
  std::unique_ptr<apriltag_detector_t, void (*)(apriltag_detector_t*)> detector;
};

TagDetector::TagDetector(const std::string& family, int border_cells)
    : state_(std::make_unique<State>(family, border_cells)) {}
TagDetector::~TagDetector() = default;
TagDetector::TagDetector(TagDetector&&) noexcept = default;
TagDetector& TagDetector::operator=(TagDetector&&) noexcept = default;

std::vector<TagDetection> TagDetector::Detect(const Image& picture) {
  if (picture.width() < kMinPictureSize || picture.height() < kMinPictureSize) return {};
  Image gray = ToGray(ToSrgb8(picture));
  image_u8_t view = {gray.width(), gray.height(), gray.width(), gray.Data<uint8_t>()};
  const Detections found(apriltag_detector_detect(state_->detector.get(), &view),
                         apriltag_detections_destroy);
  std::vector<TagDetection> tags;
  for (int i = 0; i < zarray_size(found.get()); ++i) {
    apriltag_detection_t* detection = nullptr;
    zarray_get(found.get(), i, &detection);
    TagDetection tag;
    tag.id = detection->id;
    for (int c = 0; c < 4; ++c) {
      const double* p = detection->p[kLibraryCorner[c]];
      tag.corners[c] = {p[0] - kLibraryPixelCenter, p[1] - kLibraryPixelCenter};
    }
    tags.push_back(tag);
  }
  std::sort(tags.begin(), tags.end(), [](const TagDetection& a, const TagDetection& b) {
    const auto key = [](const TagDetection& t) {
      return std::tuple(t.id, t.corners[0].x(), t.corners[0].y());
    };
    return key(a) < key(b);
  });
  return tags;
}

}  // namespace lfm
