// SPDX-License-Identifier: BSD-3-Clause
#include "fields/luminance_fit.h"

#include <algorithm>
#include <array>

#include "core/image.h"
#include "core/parallel.h"

namespace lfm {
namespace {

constexpr int64_t kPointsAtOnce = 512;
constexpr std::array<double, 3> kLuminance = {0.2126, 0.7152, 0.0722};

}  // namespace

LuminanceFit FitLuminance(const Field& field, const LightFrame& frame, LightBasis basis,
                          FitSpace space) {
  const int lights = field.functions.columns;
  RequireFinite(field.functions.View(), "light fit");
  // Linear again, so that FitLights codes it as it codes everything.
  FunctionRows luminance = MakeFunctionRows(field.points, lights);
  LuminanceFit fit;
  fit.chroma.assign(static_cast<size_t>(field.points) * 3, 0);
  const auto coded = [space](float value) -> double {
    return space == FitSpace::kDisplay ? SrgbFromLinear(value) : value;
  };
  ParallelChunks(field.points, kPointsAtOnce, [&](int64_t begin, int64_t end, int64_t) {
    for (int64_t point = begin; point < end; ++point) {
      std::array<double, 3> with_luminance = {};
      double energy = 0, largest = 0;
      for (int j = 0; j < lights; ++j) {
        std::array<double, 3> color;
        double y = 0;
        for (int c = 0; c < 3; ++c) {
          const int64_t row = field.RowOf(point, std::min(c, field.channels - 1));
          color[c] = coded(field.functions.Row(row)[j]);
          y += kLuminance[c] * color[c];
        }
        for (int c = 0; c < 3; ++c) with_luminance[c] += color[c] * y;
        energy += y * y;
        const auto value = static_cast<float>(y);
        luminance.Row(point)[j] = space == FitSpace::kDisplay ? LinearFromSrgb(value) : value;
      }
      if (!(energy > 0)) continue;
      for (double& c : with_luminance) {
        c = std::max(0.0, c / energy);
        largest = std::max(largest, c);
      }
      if (!(largest > 0)) continue;
      for (int c = 0; c < 3; ++c) {
        fit.chroma[point * 3 + c] = static_cast<float>(with_luminance[c] / largest);
      }
      for (int j = 0; j < lights; ++j) {
        float& value = luminance.Row(point)[j];
        const auto scaled = static_cast<float>(coded(value) * largest);
        value = space == FitSpace::kDisplay ? LinearFromSrgb(scaled) : scaled;
      }
    }
  });
  fit.luminance = FitLights(luminance.View(), field.directions, frame, basis, space);
  return fit;
}

std::vector<float> EvaluateLuminanceFit(const LuminanceFit& fit, int channels,
                                        const Eigen::Vector3d& to_light) {
  const std::vector<float> brightest = EvaluateFit(fit.luminance, to_light);
  const auto points = static_cast<int64_t>(brightest.size());
  const bool display = fit.luminance.space == FitSpace::kDisplay;
  std::vector<float> shown(static_cast<size_t>(points * channels));
  ParallelChunks(points, kPointsAtOnce, [&](int64_t begin, int64_t end, int64_t) {
    for (int64_t point = begin; point < end; ++point) {
      for (int c = 0; c < channels; ++c) {
        const float chroma = fit.chroma[point * 3 + c];
        shown[c * points + point] = display
                                        ? LinearFromSrgb(SrgbFromLinear(brightest[point]) * chroma)
                                        : brightest[point] * chroma;
      }
    }
  });
  return shown;
}

}  // namespace lfm
