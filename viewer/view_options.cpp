// SPDX-License-Identifier: BSD-3-Clause
#include "viewer/view_options.h"

#include <algorithm>
#include <charconv>
#include <numbers>

#include "core/error.h"

namespace lfm {
namespace {

constexpr int kMaxSide = 16384;
constexpr double kRadiansPerDegree = std::numbers::pi / 180;

}  // namespace

PictureSize ParsePictureSize(const std::string& text) {
  const auto fail = [&]() -> PictureSize {
    throw Error("--size: '" + text +
                "' is no picture size; write WIDTHxHEIGHT with sides of 1 to " +
                std::to_string(kMaxSide) + ", as 960x720");
  };
  PictureSize size;
  const char* const end = text.data() + text.size();
  const auto width = std::from_chars(text.data(), end, size.width);
  if (width.ec != std::errc() || width.ptr == end || *width.ptr != 'x') return fail();
  const auto height = std::from_chars(width.ptr + 1, end, size.height);
  if (height.ec != std::errc() || height.ptr != end) return fail();
  if (std::min(size.width, size.height) < 1 || std::max(size.width, size.height) > kMaxSide) {
    return fail();
  }
  return size;
}

Eigen::Vector3f ParseColor(const std::string& text) {
  const std::string digits = text.starts_with('#') ? text.substr(1) : text;
  uint32_t rgb = 0;
  const char* const end = digits.data() + digits.size();
  if (digits.size() == 6) {
    const auto parsed = std::from_chars(digits.data(), end, rgb, 16);
    if (parsed.ec == std::errc() && parsed.ptr == end) {
      return Eigen::Vector3f(rgb >> 16 & 255, rgb >> 8 & 255, rgb & 255) / 255.0f;
    }
  }
  throw Error("--background: '" + text + "' is no colour; write rrggbb in hexadecimal, as 181a1f");
}

Tone MakeTone(const ViewOptions& options) { return {options.exposure, options.tone}; }

EvaluationOptions MakeEvaluationOptions(const ViewOptions& options) {
  EvaluationOptions evaluation;
  evaluation.terms = options.mean_only ? 0 : options.terms;
  if (!options.mean_only) evaluation.term_alone = options.term_alone - 1;
  return evaluation;
}

OrbitCamera MakeOrbitCamera(const TriangleMesh& mesh, const ViewOptions& options) {
  const PictureSize size = ParsePictureSize(options.size);
  OrbitCamera camera = FrameMesh(mesh, options.fov * kRadiansPerDegree,
                                 static_cast<double>(size.width) / size.height);
  camera.azimuth = camera.elevation = 0;
  camera =
      Orbit(camera, options.azimuth * kRadiansPerDegree, options.elevation * kRadiansPerDegree);
  if (options.distance > 0) {
    camera.distance = options.distance;
    camera.min_distance = std::min(camera.min_distance, options.distance);
    camera.max_distance = std::max(camera.max_distance, options.distance);
  }
  return camera;
}

}  // namespace lfm
