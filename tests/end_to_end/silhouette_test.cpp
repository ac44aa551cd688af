// SPDX-License-Identifier: BSD-3-Clause
// Photographs and scans share one frame: what was scanned covers, in the photographs, what is
// covered in truth.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <string>

#include "calib/calib_files.h"
#include "core/capture.h"
#include "core/image.h"
#include "core/ply.h"
#include "core/ray_scene.h"
#include "mesh/mesh_files.h"
#include "tests/end_to_end/small_capture.h"
#include "viewer/reference_renderer.h"

namespace lfm {
namespace {

// Of a 480 x 360 photograph; 0.5 mm on the object is one pixel there.
constexpr double kContourOff_px = 0.6, kContourBias_px = 0.35;

bool Covered(const Image& mask, int x, int y) {
  return x >= 0 && y >= 0 && x < mask.width() && y < mask.height() && mask.At<uint8_t>(x, y) >= 128;
}

/// How two silhouettes differ: pixels covered in one alone, and the length of the true contour.
struct Difference {
  double only_found = 0, only_true = 0, contour_px = 0;
  void Add(const Image& found, const Image& truth) {
    for (int y = 0; y < truth.height(); ++y) {
      for (int x = 0; x < truth.width(); ++x) {
        const bool f = Covered(found, x, y), t = Covered(truth, x, y);
        only_found += f && !t ? 1 : 0;
        only_true += t && !f ? 1 : 0;
        // Crossings of rows and columns count 4 / pi times the length of a contour (Cauchy).
        contour_px += (t != Covered(truth, x + 1, y) ? 1 : 0) * M_PI / 4;
        contour_px += (t != Covered(truth, x, y + 1) ? 1 : 0) * M_PI / 4;
      }
    }
  }
  double MeanOff() const { return (only_found + only_true) / contour_px; }
  double Bias() const { return (only_found - only_true) / contour_px; }
};

/// True when a pixel of the mask within one of this place is covered.
bool NearMask(const Image& mask, const Eigen::Vector2d& pixel) {
  const int x = static_cast<int>(std::lround(pixel.x()));
  const int y = static_cast<int>(std::lround(pixel.y()));
  for (int dy = -1; dy <= 1; ++dy) {
    for (int dx = -1; dx <= 1; ++dx) {
      if (Covered(mask, x + dx, y + dy)) return true;
    }
  }
  return false;
}

TEST(Silhouettes, OfScannedPointsAndSurfaceAgreeWithThePhotographs) {
  const SmallCapture small;
  small.BeginAfter({"calib", "scan"});
  const CommandOutcome outcome = RunCommand(
      {SmallCapture::Command("lfm-mesh"), small.capture().string(), small.work().string(), "-q"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const CalibResult calib = LoadCalib(small.work() / "calib");
  const RayScene surface(LoadMesh(small.work() / "mesh").surface);
  const PointCloud cloud = ReadPlyCloud(small.work() / "scan" / "points.ply");
  const Capture truth = LoadCapture(small.capture() / "ground_truth");
  std::map<std::string, Image> masks;
  for (const Photo& photo : truth.photos) {
    if (!photo.mask.empty()) masks[photo.id] = ReadImage(truth.folder / photo.mask);
  }
  Difference difference;
  double outside = 0, points = 0;
  for (const PosedImage& photo : calib.photos) {
    ASSERT_TRUE(masks.contains(photo.id));
    const Image& mask = masks[photo.id];
    const Camera& camera = calib.cameras.at(photo.camera);
    difference.Add(RenderSilhouette(surface, camera, photo.camera_from_world), mask);
    for (size_t i = 0; i < cloud.points.size(); i += 7) {
      const auto pixel = Project(camera, photo.camera_from_world * cloud.points[i]);
      if (!pixel || !camera.Contains(*pixel)) continue;
      points += 1;
      outside += NearMask(mask, *pixel) ? 0 : 1;
    }
  }
  RecordProperty("contour_off_px", std::to_string(difference.MeanOff()));
  RecordProperty("contour_bias_px", std::to_string(difference.Bias()));
  RecordProperty("points_outside_share", std::to_string(outside / points));
  EXPECT_GT(difference.contour_px, 5000);
  EXPECT_LT(difference.MeanOff(), kContourOff_px);
  EXPECT_LT(std::abs(difference.Bias()), kContourBias_px);
  EXPECT_GT(points, 10000);
  EXPECT_LT(outside / points, 0.002);
}

}  // namespace
}  // namespace lfm
