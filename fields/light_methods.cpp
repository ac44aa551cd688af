// SPDX-License-Identifier: BSD-3-Clause
#include "fields/light_methods.h"

#include <algorithm>

#include "core/error.h"
#include "core/parallel.h"
#include "fields/light_triangulation.h"

namespace lfm {
namespace {

constexpr int64_t kRowsAtOnce = 512;

int64_t ValuesOf(const Field& field) { return field.functions.rows * field.functions.columns; }

std::vector<float> WeightedColumns(const Field& field, const LightShares& shares) {
  std::vector<float> shown(static_cast<size_t>(field.functions.rows));
  ParallelChunks(field.functions.rows, kRowsAtOnce, [&](int64_t begin, int64_t end, int64_t) {
    for (int64_t r = begin; r < end; ++r) {
      double sum = 0;
      for (int i = 0; i < 3; ++i) sum += shares.share[i] * field.functions.Row(r)[shares.light[i]];
      shown[r] = static_cast<float>(std::max(0.0, sum));
    }
  });
  return shown;
}

}  // namespace

int NearestLight(const std::vector<Eigen::Vector3d>& to_lights, const Eigen::Vector3d& to_light) {
  if (to_lights.empty()) throw Error("nearest light: there is none");
  const auto nearest = std::min_element(
      to_lights.begin(), to_lights.end(), [&](const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
        return (a - to_light).squaredNorm() < (b - to_light).squaredNorm();
      });
  return static_cast<int>(nearest - to_lights.begin());
}

LightMethod NearestPicture(const Field& train) {
  return {"nearest light", "pictures", ValuesOf(train), [&train](const Eigen::Vector3d& to_light) {
            return WeightedColumns(train,
                                   {{NearestLight(train.directions, to_light), 0, 0}, {1, 0, 0}});
          }};
}

LightMethod InterpolatedPictures(const Field& train) {
  return {"interpolated pictures", "pictures", ValuesOf(train),
          [&train, lights = TriangulateLights(train.directions)](const Eigen::Vector3d& to_light) {
            return WeightedColumns(train, InterpolateLights(lights, to_light));
          }};
}

ClassicFits FitClassics(const Field& train, const LightFrame& frame) {
  ClassicFits result;
  if (train.channels == 3) {
    result.fits.push_back(
        QuantizeFit(FitLuminance(train, frame, LightBasis::kPolynomial, FitSpace::kDisplay)));
    result.names.emplace_back("PTM, luminance");
  }
  for (const LightFit& fit : FitLights(train.functions.View(), train.directions, frame,
                                       {LightBasis::kPolynomial, LightBasis::kHarmonics4,
                                        LightBasis::kHarmonics9, LightBasis::kHarmonics16},
                                       FitSpace::kDisplay)) {
    result.fits.push_back(QuantizeFit(fit, train.channels));
    result.names.emplace_back(LightBasisName(fit.basis));
  }
  return result;
}

std::vector<LightMethod> ClassicMethods(const ClassicFits& fits, const Field& train) {
  std::vector<LightMethod> methods;
  for (size_t i = 0; i < fits.fits.size(); ++i) {
    const QuantizedFit& fit = fits.fits[i];
    const char* family = fit.basis == LightBasis::kPolynomial ? "PTM" : "HSH";
    methods.push_back({fits.names[i], family, fit.Bytes(),
                       [&fit, channels = train.channels](const Eigen::Vector3d& to_light) {
                         return EvaluateQuantizedFit(fit, channels, to_light);
                       }});
  }
  return methods;
}

}  // namespace lfm
