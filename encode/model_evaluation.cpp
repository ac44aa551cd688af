// SPDX-License-Identifier: BSD-3-Clause
#include "encode/model_evaluation.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "encode/quantization.h"

namespace lfm {
namespace {

// Four texels and their bilinear weights; offsets are bytes into an RGB page.
struct Tap {
  std::array<ptrdiff_t, 4> offset;
  Eigen::Vector4f weight;
};

Tap MakeTap(ptrdiff_t texel, ptrdiff_t step_x, ptrdiff_t step_y, float fx, float fy) {
  return {{3 * texel, 3 * (texel + step_x), 3 * (texel + step_y), 3 * (texel + step_x + step_y)},
          {(1 - fx) * (1 - fy), fx * (1 - fy), (1 - fx) * fy, fx * fy}};
}

inline Eigen::Vector3f Sample(const Image& page, const Tap& tap) {
  const auto* data = reinterpret_cast<const uint8_t*>(page.Bytes().data());
  float r = 0, g = 0, b = 0;
  for (int k = 0; k < 4; ++k) {
    const uint8_t* texel = data + tap.offset[k];
    r += tap.weight[k] * texel[0];
    g += tap.weight[k] * texel[1];
    b += tap.weight[k] * texel[2];
  }
  return {r, g, b};
}

// Coordinates of a surface point in the patch grid, split into cell and fraction.
Tap SurfaceTap(const PatchPlacement& placement, int page_width, const Eigen::Vector3d& weights) {
  const double last = placement.edge_samples - 1;
  const double x = std::clamp(weights[1], 0.0, 1.0) * last;
  const double y = std::min(std::clamp(weights[2], 0.0, 1.0) * last, last - x);
  const int i = std::min(static_cast<int>(x), placement.edge_samples - 2);
  const int j = std::min(static_cast<int>(y), placement.edge_samples - 2);
  const ptrdiff_t sign = placement.flipped ? -1 : 1;
  const ptrdiff_t texel =
      (placement.origin.y() + sign * j) * ptrdiff_t{page_width} + placement.origin.x() + sign * i;
  const auto fx = static_cast<float>(x - i), fy = static_cast<float>(y - j);
  Tap tap = MakeTap(texel, sign, sign * page_width, fx, fy);
  // What the gutter's b + c - a gives, also where no code could hold it.
  if (i + j == placement.edge_samples - 2) tap.weight = {1 - fx - fy, fx, fy, 0};
  return tap;
}

Tap ViewTap(const LightFieldModel::TilePosition& tile, int page_width,
            const Eigen::Vector2d& square) {
  const int grid = tile.grid;
  const double x = std::clamp(square.x(), 0.0, 1.0) * (grid - 1);
  const double y = std::clamp(square.y(), 0.0, 1.0) * (grid - 1);
  const int i = std::min(static_cast<int>(x), grid - 2);
  const int j = std::min(static_cast<int>(y), grid - 2);
  const ptrdiff_t texel = (tile.y + j) * ptrdiff_t{page_width} + tile.x + i;
  return MakeTap(texel, 1, page_width, static_cast<float>(x - i), static_cast<float>(y - j));
}

// How much of the mean view is shown beside the terms.
float MeanShare(const LightFieldModel& model, int triangle, const Eigen::Vector3d& weights,
                const EvaluationOptions& options) {
  if (!model.mean_in_terms || options.terms <= 0) return 1;
  const double w1 = std::clamp(weights[1], 0.0, 1.0), w2 = std::clamp(weights[2], 0.0, 1 - w1);
  const Eigen::Vector3d clamped(1 - w1 - w2, w1, w2);
  double share = 0;
  for (int c = 0; c < 3; ++c) {
    if (model.vertex_terms[model.mesh.triangles[triangle][c]] == 0) share += clamped[c];
  }
  return static_cast<float>(share);
}

}  // namespace

Eigen::Vector3f EvaluateUnclamped(const LightFieldModel& model, int triangle,
                                  const Eigen::Vector3d& weights, const Eigen::Vector3d& to_eye,
                                  const EvaluationOptions& options) {
  const PatchPlacement& placement = model.placements[triangle];
  const Image& mean_page = model.mean_pages[placement.page];
  const Tap surface = SurfaceTap(placement, mean_page.width(), weights);
  Eigen::Vector3f color = Eigen::Vector3f::Constant(model.mean_in_terms ? 0.f : 0.5f);
  if (options.term_alone < 0) {
    color = Sample(mean_page, surface) * (MeanShare(model, triangle, weights, options) / 255);
  }

  const Eigen::Vector3i& corners = model.mesh.triangles[triangle];
  const int first = options.FirstTerm();
  const int wanted = std::min(options.EndOfTerms(), model.TriangleTerms(triangle));
  std::array<Eigen::Vector3f, 16> surface_codes;
  const int shared = std::min<int>(wanted, surface_codes.size());
  for (int k = first; k < shared; ++k) {
    const PatchPlacement& own = model.SurfacePlacement(k, triangle);
    const Image& page = model.surface_pages[k][own.page];
    surface_codes[k] = model.surface_placements.empty()
                           ? Sample(page, surface)
                           : Sample(page, SurfaceTap(own, page.width(), weights));
  }
  const size_t vertices = model.vertex_frames.size();
  for (int c = 0; c < 3; ++c) {
    const int vertex = corners[c];
    const int terms = std::min(shared, model.vertex_terms[vertex]);
    if (terms <= first) continue;
    const Eigen::Vector2d square =
        SquareFromDirection(model.direction_map, model.vertex_frames[vertex].transpose() * to_eye);
    for (int k = first; k < terms; ++k) {
      const size_t range = k * vertices + vertex;
      const LightFieldModel::TilePosition tile = model.ViewTile(k, vertex);
      const Image& page = model.view_pages[k][tile.page];
      const float g = DecodeValue(model.surface_ranges[range], surface_codes[k][c]);
      const Eigen::Vector3f h = Sample(page, ViewTap(tile, page.width(), square));
      const MapRange& view_range = model.view_ranges[range];
      color.array() += g * (view_range.scale / 255 * h.array() + view_range.bias);
    }
  }
  return color;
}

Eigen::Vector3f EvaluateModel(const LightFieldModel& model, int triangle,
                              const Eigen::Vector3d& weights, const Eigen::Vector3d& to_eye,
                              const EvaluationOptions& options) {
  return EvaluateUnclamped(model, triangle, weights, to_eye, options).cwiseMax(0.f).cwiseMin(1.f);
}

}  // namespace lfm
