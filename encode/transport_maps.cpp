// SPDX-License-Identifier: BSD-3-Clause
#include "encode/transport_maps.h"

#include <algorithm>
#include <cmath>

#include "encode/model_layout.h"
#include "resample/light_field.h"

namespace lfm::transport {
namespace {

std::vector<float> Decoded(const MapRange& range, const std::vector<uint8_t>& codes) {
  std::vector<float> values(codes.size());
  for (size_t i = 0; i < codes.size(); ++i) values[i] = DecodeValue(range, codes[i]);
  return values;
}

double SquaredNorm(const std::vector<float>& values) {
  double sum = 0;
  for (const float value : values) sum += static_cast<double>(value) * value;
  return sum;
}

using RgbRows = Eigen::Map<const Eigen::Matrix<float, Eigen::Dynamic, 3, Eigen::RowMajor>>;

}  // namespace

std::optional<TermCoefficients> CoefficientsOfTerm(const LightFieldModel& model,
                                                   const MapTransform& transform, const Ring& ring,
                                                   int vertex, int term) {
  const TermMaps maps = ReadVertexTerm(model, ring.triangles, vertex, term);
  std::vector<float> surface = Decoded(maps.surface_range, maps.surface_codes);
  const std::vector<float> view = Decoded(maps.view_range, maps.view_codes);
  const double surface_norm = std::sqrt(SquaredNorm(surface));
  const double view_norm = std::sqrt(SquaredNorm(view));
  if (!(surface_norm > 0) || !(view_norm > 0)) return std::nullopt;
  TermCoefficients out;
  out.sigma = std::clamp(
      static_cast<int>(std::lround(kSigmasAnOctave * std::log2(surface_norm * view_norm))),
      -kMostSigma, kMostSigma);
  const auto scale = static_cast<float>(SigmaOf(out.sigma) / surface_norm);
  for (float& value : surface) value *= scale;
  const float* patch = surface.data();
  for (const int n : ring.edge_samples) {
    const auto count = static_cast<size_t>(PatchSampleCount(n));
    out.surface.push_back(transform.ToTriangle(n, std::span(patch, count)));
    patch += count;
  }
  const Eigen::MatrixXf opponent =
      RgbRows(view.data(), static_cast<Eigen::Index>(view.size() / 3), 3) * OpponentColors() *
      static_cast<float>(surface_norm);
  for (int c = 0; c < 3; ++c) {
    out.view[c] =
        transform.ToSquare(opponent.col(c).reshaped(model.grid, model.grid).transpose().eval());
  }
  return out;
}

std::array<Eigen::MatrixXf, 3> CoefficientsOfMean(const LightFieldModel& model,
                                                  const MapTransform& transform, int triangle,
                                                  const Eigen::Vector3f& predicted) {
  const std::vector<float> values = Decoded({1, 0}, ReadMean(model, triangle));
  const Eigen::MatrixXf opponent =
      (RgbRows(values.data(), static_cast<Eigen::Index>(values.size() / 3), 3).rowwise() -
       predicted.transpose()) *
      OpponentColors();
  std::array<Eigen::MatrixXf, 3> out;
  for (int c = 0; c < 3; ++c) {
    const Eigen::VectorXf channel = opponent.col(c);
    out[c] = transform.ToTriangle(model.placements[triangle].edge_samples,
                                  std::span(channel.data(), static_cast<size_t>(channel.size())));
  }
  return out;
}

}  // namespace lfm::transport
