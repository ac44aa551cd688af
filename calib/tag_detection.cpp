// SPDX-License-Identifier: BSD-3-Clause
#include "calib/tag_detection.h"

#include <apriltag/apriltag.h>

#include <algorithm>
#include <cmath>
#include <tuple>

#include "calib/tag_family.h"

namespace lfm {
namespace {

constexpr int kMinPictureSize = 16;
// The library's counter-clockwise order starts at the bottom left of the printed tag.
constexpr std::array<int, 4> kLibraryCorner = {3, 2, 1, 0};
constexpr double kLibraryPixelCenter = 0.5;
// A picture has 65536 pixels a side at most.
constexpr int kMaxEnlarged = 32768;

// The tags of Kalibr's boards touch black squares at their corners. Where that is blurred, the
// white along each side is a region of its own, and the library sees no tag. Twice as large and
// with black a pixel thinner all round, tags stand alone.
Image PartTouchingCorners(const Image& gray) {
  const int width = gray.width(), height = gray.height();
  Image large(2 * width, 2 * height, 1, PixelType::kUint8, gray.encoding());
  for (int y = 0; y < 2 * height; ++y) {
    // A large pixel's centre lies a quarter of a small one from the nearest small centre.
    const int y0 = y / 2, y1 = std::clamp(y % 2 == 0 ? y0 - 1 : y0 + 1, 0, height - 1);
    for (int x = 0; x < 2 * width; ++x) {
      const int x0 = x / 2, x1 = std::clamp(x % 2 == 0 ? x0 - 1 : x0 + 1, 0, width - 1);
      const auto at = [&](int px, int py) { return static_cast<int>(gray.At<uint8_t>(px, py)); };
      large.At<uint8_t>(x, y) = static_cast<uint8_t>(
          (9 * at(x0, y0) + 3 * at(x1, y0) + 3 * at(x0, y1) + at(x1, y1) + 8) / 16);
    }
  }
  Image thin = large;
  for (int y = 1; y + 1 < 2 * height; ++y) {
    for (int x = 1; x + 1 < 2 * width; ++x) {
      uint8_t brightest = 0;
      for (int i = 0; i < 9; ++i) {
        brightest = std::max(brightest, large.At<uint8_t>(x + i % 3 - 1, y + i / 3 - 1));
      }
      thin.At<uint8_t>(x, y) = brightest;
    }
  }
  return thin;
}

// Corners found by the library in such a picture, in the original: half as large, and every side
// where it was before it was moved in by a pixel.
std::array<Eigen::Vector2d, 4> OfOriginal(const std::array<Eigen::Vector2d, 4>& corners) {
  std::array<Eigen::Vector2d, 4> original;
  for (int c = 0; c < 4; ++c) {
    const Eigen::Vector2d& here = corners[c];
    const Eigen::Vector2d to_next = (corners[(c + 1) % 4] - here).normalized();
    const Eigen::Vector2d to_last = (corners[(c + 3) % 4] - here).normalized();
    // Moving both sides out by one moves their corner by this along either.
    const double sine = std::abs(to_next.x() * to_last.y() - to_next.y() * to_last.x());
    original[c] = (here - (to_next + to_last) / std::max(sine, 0.2)) / 2;
  }
  return original;
}

using Detections = std::unique_ptr<zarray_t, void (*)(zarray_t*)>;

}  // namespace

struct TagDetector::State {
  State(const std::string& family_name, int cells)
      : border_cells(cells),
        family(family_name, cells, "tag detector"),
        detector(apriltag_detector_create(), apriltag_detector_destroy) {
    apriltag_detector_add_family_bits(detector.get(), family.get(), family.correctable_bits());
    detector->nthreads = 1;
    // Oblique tags are a few pixels high: decimation loses them.
    detector->quad_decimate = 1;
  }
  ~State() { apriltag_detector_clear_families(detector.get()); }

  int border_cells;
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
  const bool touching =
      state_->border_cells > 1 && std::max(gray.width(), gray.height()) <= kMaxEnlarged;
  if (touching) gray = PartTouchingCorners(gray);
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
      tag.corners[c] = {p[0], p[1]};
    }
    if (touching) tag.corners = OfOriginal(tag.corners);
    for (Eigen::Vector2d& corner : tag.corners) corner.array() -= kLibraryPixelCenter;
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
