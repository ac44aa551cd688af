// SPDX-License-Identifier: BSD-3-Clause
// Gray code of a real projector on a real chessboard, made by others
// (kamino410/procam-calibration).
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "core/image.h"
#include "scan/decode.h"

namespace lfm {
namespace {

/// Frames in OpenCV's order: column pairs, row pairs, white, black.
PatternSequence OpenCvOrder() {
  PatternSequence sequence;
  sequence.projector_width = 1024;
  sequence.projector_height = 768;
  for (const PatternAxis axis : {PatternAxis::kColumn, PatternAxis::kRow}) {
    for (int bit = 0; bit < 10; ++bit) {
      sequence.patterns.push_back({PatternKind::kGray, axis, bit});
      sequence.patterns.push_back({PatternKind::kGrayInverse, axis, bit});
    }
  }
  sequence.patterns.push_back({PatternKind::kWhite});
  sequence.patterns.push_back({PatternKind::kBlack});
  return sequence;
}

/// Root mean square of column - (a + b x + c y) over windows of a plane, where a projective map is
/// all but affine; median of the windows.
double MedianPlaneError(const DecodedPixels& decoded, int window, int& windows) {
  std::vector<double> errors;
  for (int y0 = 0; y0 + window <= decoded.height; y0 += window) {
    for (int x0 = 0; x0 + window <= decoded.width; x0 += window) {
      std::vector<Eigen::Vector4d> seen;
      for (int y = y0; y < y0 + window; ++y) {
        for (int x = x0; x < x0 + window; ++x) {
          const size_t p = static_cast<size_t>(y) * decoded.width + x;
          if (decoded.column.confidence[p] <= 0) continue;
          seen.emplace_back(1, x - x0, y - y0, decoded.column.position[p]);
        }
      }
      if (seen.size() < static_cast<size_t>(window * window * 9 / 10)) continue;
      Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
      Eigen::Vector3d right = Eigen::Vector3d::Zero();
      for (const Eigen::Vector4d& s : seen) {
        normal += s.head<3>() * s.head<3>().transpose();
        right += s.head<3>() * s(3);
      }
      const Eigen::Vector3d fit = normal.ldlt().solve(right);
      double sum = 0;
      for (const Eigen::Vector4d& s : seen) sum += std::pow(s(3) - fit.dot(s.head<3>()), 2);
      errors.push_back(std::sqrt(sum / static_cast<double>(seen.size())));
    }
  }
  windows = static_cast<int>(errors.size());
  if (errors.empty()) return 1e9;
  const auto middle = errors.begin() + static_cast<std::ptrdiff_t>(errors.size() / 2);
  std::nth_element(errors.begin(), middle, errors.end());
  return *middle;
}

TEST(RealScan, GrayCodeOnAChessboardIsFlatToAFractionOfAPixel) {
  const char* folder = std::getenv("LFM_REAL_DATA");
  if (folder == nullptr) GTEST_SKIP() << "LFM_REAL_DATA names no folder of real captures";
  const PatternSequence sequence = OpenCvOrder();
  for (const char* capture : {"capture_0", "capture_2", "capture_4"}) {
    const std::filesystem::path place = std::filesystem::path(folder) / "procam_graycode" / capture;
    const FrameLoader load = [&](int index) {
      char name[32];
      std::snprintf(name, sizeof name, "graycode_%02d.png", index);
      return ReadImage(place / name);
    };
    const DecodedPixels decoded = Decode(sequence, load, {});
    int windows = 0;
    const double error = MedianPlaneError(decoded, 12, windows);
    std::printf("%s: %d windows, %.3f px\n", capture, windows, error);
    EXPECT_GT(windows, 500) << capture;
    EXPECT_LT(error, 0.25) << capture;  // whole pixels: 0.29
  }
}

}  // namespace
}  // namespace lfm
