// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "encode/model.h"

namespace lfm::testing {

/// What docs/formats.md says that a model means, step by step and in float64; shares no code with
/// the evaluation that the renderers use.
inline Eigen::Vector3d SlowEvaluate(const LightFieldModel& model, int triangle,
                                    const Eigen::Vector3d& weights, const Eigen::Vector3d& to_eye,
                                    int terms) {
  const auto surface = [&](const std::vector<Image>& pages, const PatchPlacement& place,
                           int channel) {
    const double last = place.edge_samples - 1;
    const double x = weights[1] * last, y = weights[2] * last;
    const double i = std::min(std::floor(x), last - 1), j = std::min(std::floor(y), last - 1);
    double sum = 0;
    for (int dj = 0; dj < 2; ++dj) {
      for (int di = 0; di < 2; ++di) {
        double w = (di ? x - i : 1 - x + i) * (dj ? y - j : 1 - y + j);
        if (i + j == last - 1) {  // on the hypotenuse: the plane through the three samples
          w = di + dj == 0 ? 1 - (x - i) - (y - j) : di + dj == 2 ? 0 : di ? x - i : y - j;
        }
        if (i + j + di + dj > last) continue;  // beyond the hypotenuse there may be no texel
        const int sign = place.flipped ? -1 : 1;
        const int column = place.origin.x() + sign * static_cast<int>(i + di);
        const int row = place.origin.y() + sign * static_cast<int>(j + dj);
        sum += w * pages[place.page].At<uint8_t>(column, row, channel);
      }
    }
    return sum / 255;
  };
  Eigen::Vector3d color;
  for (int c = 0; c < 3; ++c) {
    color[c] = surface(model.mean_pages, model.placements[triangle], c);
  }
  const size_t vertices = model.vertex_frames.size();
  for (int corner = 0; corner < 3; ++corner) {
    const int vertex = model.mesh.triangles[triangle][corner];
    const Eigen::Vector3d direction = model.vertex_frames[vertex].transpose() * to_eye;
    for (int k = 0; k < std::min(terms, model.vertex_terms[vertex]); ++k) {
      const auto tile = model.ViewTile(k, vertex);
      const Eigen::Vector2d square =
          SquareFromDirection(model.direction_map, direction) * (tile.grid - 1);
      const Eigen::Vector2d cell = square.array().floor().max(0.0).min(tile.grid - 2.0);
      const MapRange& surface_range = model.surface_ranges[k * vertices + vertex];
      const MapRange& view_range = model.view_ranges[k * vertices + vertex];
      const double g = surface_range.scale * surface(model.surface_pages[k],
                                                     model.SurfacePlacement(k, triangle), corner) +
                       surface_range.bias;
      for (int c = 0; c < 3; ++c) {
        double h = 0;
        for (int dj = 0; dj < 2; ++dj) {
          for (int di = 0; di < 2; ++di) {
            const double w = (di ? square.x() - cell.x() : 1 - square.x() + cell.x()) *
                             (dj ? square.y() - cell.y() : 1 - square.y() + cell.y());
            h += w * model.view_pages[k][tile.page].At<uint8_t>(
                         tile.x + static_cast<int>(cell.x()) + di,
                         tile.y + static_cast<int>(cell.y()) + dj, c);
          }
        }
        color[c] += g * (view_range.scale * h / 255 + view_range.bias);
      }
    }
  }
  return color.cwiseMax(0).cwiseMin(1);
}

}  // namespace lfm::testing
