// SPDX-License-Identifier: BSD-3-Clause
#include "scan/cell_edges.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <vector>

namespace lfm {
namespace {

/// A line of pixels through the picture.
struct Line {
  size_t begin = 0, step = 1;
  int count = 0;
  size_t operator[](int i) const { return begin + step * static_cast<size_t>(i); }
};

/// Where a stripe's edge crosses a line, between two neighbouring pixels.
struct Edge {
  int left = 0;                            ///< the pixel before it
  double from_left = 0, from_right = 0;    ///< distances to it, cells, as the pixels say
  double sigma_left = 0, sigma_right = 0;  ///< of these
  double column = 0;                       ///< projector coordinate
  double place = 0, sigma_px = 0;          ///< along the line, pixels
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
  Edge edge;
  edge.left = left;
  edge.from_left = std::abs(border - xa);
  edge.from_right = std::abs(border - xb);
  edge.sigma_left = c.sigma[a] / cell_px;
  edge.sigma_right = c.sigma[b] / cell_px;
  edge.column = border * cell_px - 0.5;
  edge.place = left + edge.from_left / std::max(1e-6, edge.from_left + edge.from_right);
  return edge;
}

/// With `cells_per_px` known, the pixel that the edge cuts says where it is; between two that see
/// none of it, it may be anywhere.
void Locate(double cells_per_px, Edge& edge) {
  const double per_cell = 1 / std::max(1e-6, cells_per_px);
  const bool left = edge.sigma_left < edge.sigma_right;
  const double sigma = per_cell * (left ? edge.sigma_left : edge.sigma_right);
  edge.sigma_px = std::min(sigma, 1 / std::sqrt(12.0));
  const double place = left ? edge.from_left * per_cell : 1 - edge.from_right * per_cell;
  edge.place = edge.left + (sigma < 1 / std::sqrt(12.0) ? std::clamp(place, 0.0, 1.0) : 0.5);
}

/// Sharpens the places of a run of edges by how far apart they lie.
void LocateAll(float cell_px, std::vector<Edge>& edges) {
  std::vector<double> places;
  for (const Edge& e : edges) places.push_back(e.place);
  for (size_t i = 0; i < edges.size(); ++i) {
    const size_t a = i > 0 ? i - 1 : i, b = std::min(i + 1, edges.size() - 1);
    const double way = places[b] - places[a];
    const double cells = std::abs(edges[b].column - edges[a].column) / cell_px;
    if (way > 0 && cells > 0) Locate(cells / way, edges[i]);
  }
}

void InterpolateCell(const Line& line, const Edge& from, const Edge& to, AxisCoordinates& c) {
  const double length = std::max(1e-6, to.place - from.place);
  const double per_px = (to.column - from.column) / length;
  for (int i = from.left + 1; i <= to.left; ++i) {
    const size_t p = line[i];
    const double share = std::clamp((i - from.place) / length, 0.0, 1.0);
    // Edges of one surface are off alike.
    const double sigma = std::abs(per_px) * ((1 - share) * from.sigma_px + share * to.sigma_px);
    if (!(sigma < c.sigma[p])) continue;
    c.position[p] = static_cast<float>(from.column + share * (to.column - from.column));
    c.sigma[p] = static_cast<float>(sigma);
  }
}

/// Interpolates one surface's edges along a line, and forgets them.
void FinishRun(const Line& line, float cell_px, std::vector<Edge>& edges, AxisCoordinates& c) {
  if (edges.size() > 1) LocateAll(cell_px, edges);
  for (size_t i = 0; i + 1 < edges.size(); ++i) {
    // Two edges of one value are where the surface turns back.
    if (edges[i].column != edges[i + 1].column) InterpolateCell(line, edges[i], edges[i + 1], c);
  }
  edges.clear();
}

}  // namespace

void InterpolateBetweenEdges(int width, int height, float cell_px, PatternAxis axis,
                             AxisCoordinates& coordinates) {
  AxisCoordinates& c = coordinates;
  std::vector<Edge> run;
  for (const Line& line : LinesAcross(width, height, cell_px, axis, c)) {
    for (int i = 0; i + 1 < line.count; ++i) {
      if (const std::optional<Edge> edge = FindEdge(line, i, cell_px, c)) {
        run.push_back(*edge);
        continue;
      }
      // A gap or a jump ends the surface.
      const size_t a = line[i], b = line[i + 1];
      const bool goes_on = c.confidence[a] > 0 && c.confidence[b] > 0 &&
                           std::abs(c.position[a] - c.position[b]) < cell_px;
      if (!goes_on) FinishRun(line, cell_px, run, c);
    }
    FinishRun(line, cell_px, run, c);
  }
}

}  // namespace lfm
