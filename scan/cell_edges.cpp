// SPDX-License-Identifier: BSD-3-Clause
#include "scan/cell_edges.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>

namespace lfm {
namespace {

/// A line of pixels through the picture.
struct Line {
  size_t begin = 0, step = 1;
  int count = 0;
  size_t operator[](int i) const { return begin + step * static_cast<size_t>(i); }
};

/// Where a stripe's edge crosses a line.
struct Edge {
  int left = 0;       ///< the pixel before it
  double place = 0;   ///< along the line, pixels
  double column = 0;  ///< projector coordinate
  double sigma_px = 0;  ///< of `place`
};

double MeanStep(const Line& line, const AxisCoordinates& c, double max_step, double& count) {
  double sum = 0;
  for (int i = 0; i + 1 < line.count; ++i) {
    const size_t a = line[i], b = line[i + 1];
    if (c.confidence[a] <= 0 || c.confidence[b] <= 0) continue;
    const double step = std::abs(c.position[a] - c.position[b]);
    if (step > max_step) continue;
    sum += step;
    count += 1;
  }
  return sum;
}

std::vector<Line> Rows(int width, int height) {
  std::vector<Line> lines;
  for (int y = 0; y < height; ++y) lines.push_back({static_cast<size_t>(y) * width, 1, width});
  return lines;
}

std::vector<Line> Columns(int width, int height) {
  std::vector<Line> lines;
  for (int x = 0; x < width; ++x) {
    lines.push_back({static_cast<size_t>(x), static_cast<size_t>(width), height});
  }
  return lines;
}

/// Rows or columns, whichever crosses more of the projector's.
std::vector<Line> LinesAcross(int width, int height, float cell_px, PatternAxis axis,
                              const AxisCoordinates& c) {
  std::vector<Line> best, other;
  const bool columns = axis == PatternAxis::kColumn;
  best = columns ? Rows(width, height) : Columns(width, height);
  other = columns ? Columns(width, height) : Rows(width, height);
  const auto mean = [&](const std::vector<Line>& lines) {
    double sum = 0, count = 0;
    for (const Line& line : lines) sum += MeanStep(line, c, 2.0 * cell_px, count);
    return count > 0 ? sum / count : 0;
  };
  return mean(other) > mean(best) ? other : best;
}

std::optional<Edge> FindEdge(const Line& line, int left, float cell_px, const AxisCoordinates& c) {
  const size_t a = line[left], b = line[left + 1];
  if (c.confidence[a] <= 0 || c.confidence[b] <= 0) return std::nullopt;
  const double xa = (c.position[a] + 0.5) / cell_px, xb = (c.position[b] + 0.5) / cell_px;
  const double ka = std::floor(xa), kb = std::floor(xb);
  if (std::abs(ka - kb) != 1) return std::nullopt;
  const double border = std::max(ka, kb);
  const double from_a = std::abs(border - xa), from_b = std::abs(border - xb);
  const double way = std::max(1e-6, from_a + from_b);
  Edge edge;
  edge.left = left;
  edge.place = left + from_a / way;
  edge.column = border * cell_px - 0.5;
  // A pixel that the edge cuts knows where; between two that see none, it may be anywhere.
  const double sharper = std::min(c.sigma[a], c.sigma[b]) / cell_px / way;
  edge.sigma_px = std::min(sharper, 1 / std::sqrt(12.0));
  return edge;
}

void InterpolateCell(const Line& line, const Edge& from, const Edge& to, AxisCoordinates& c) {
  const double length = std::max(1e-6, to.place - from.place);
  const double per_px = (to.column - from.column) / length;
  for (int i = from.left + 1; i <= to.left; ++i) {
    const size_t p = line[i];
    const double share = std::clamp((i - from.place) / length, 0.0, 1.0);
    const double sigma =
        std::abs(per_px) * std::hypot((1 - share) * from.sigma_px, share * to.sigma_px);
    if (!(sigma < c.sigma[p])) continue;
    c.position[p] = static_cast<float>(from.column + share * (to.column - from.column));
    c.sigma[p] = static_cast<float>(sigma);
  }
}

}  // namespace

void InterpolateBetweenEdges(int width, int height, float cell_px, PatternAxis axis,
                             AxisCoordinates& coordinates) {
  for (const Line& line : LinesAcross(width, height, cell_px, axis, coordinates)) {
    std::optional<Edge> before;
    AxisCoordinates& c = coordinates;
    for (int i = 0; i + 1 < line.count; ++i) {
      const std::optional<Edge> edge = FindEdge(line, i, cell_px, c);
      if (!edge) {
        const size_t a = line[i], b = line[i + 1];
        // A gap or a jump ends the surface.
        const bool goes_on = c.confidence[a] > 0 && c.confidence[b] > 0 &&
                             std::abs(c.position[a] - c.position[b]) < cell_px;
        if (!goes_on) before.reset();
        continue;
      }
      // Two edges of one value are a stripe's turning back, not a slope.
      if (before && before->column != edge->column) InterpolateCell(line, *before, *edge, c);
      before = edge;
    }
  }
}

}  // namespace lfm
