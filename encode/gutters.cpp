// SPDX-License-Identifier: BSD-3-Clause
#include "encode/gutters.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/parallel.h"
#include "encode/quantization.h"
#include "encode/tiling.h"

namespace lfm {
namespace {

using GridPoint = Eigen::Vector2i;  // (i, j) in a patch

// Where a leg's gutter texel takes its codes from.
struct Source {
  int triangle = 0;
  GridPoint sample = {0, 0};
};

// Leg 0 is edge 0 (j = 0), leg 2 is edge 2 (i = 0).
int EdgeIn(const Eigen::Vector3i& corners, int from, int to) {
  for (int e = 0; e < 3; ++e) {
    if (corners[e] == from && corners[(e + 1) % 3] == to) return e;
  }
  return -1;
}

// The neighbour's sample one row behind the shared edge, nearest to `along` in [0, 1], which runs
// from the neighbour's corner `edge`.
GridPoint SampleBehindEdge(int n, int edge, double along) {
  const int k = static_cast<int>(std::lround(along * (n - 2)));
  std::array<int, 3> barycentric{};
  barycentric[edge] = n - 2 - k;
  barycentric[(edge + 1) % 3] = k;
  barycentric[(edge + 2) % 3] = 1;
  return {barycentric[1], barycentric[2]};
}

Source LegSource(const LightFieldModel& model, const Eigen::Vector3i& neighbors, int triangle,
                 int edge, int index) {
  const int n = model.placements[triangle].edge_samples;
  const int clamped = std::clamp(index, 0, n - 1);
  const GridPoint own = edge == 0 ? GridPoint(clamped, 0) : GridPoint(0, clamped);
  const int neighbor = neighbors[edge];
  if (neighbor < 0) return {triangle, own};
  const Eigen::Vector3i& corners = model.mesh.triangles[triangle];
  const int their_edge =
      EdgeIn(model.mesh.triangles[neighbor], corners[(edge + 1) % 3], corners[edge]);
  if (their_edge < 0) return {triangle, own};
  // Both legs' indices start at corner 0; edge 2 runs towards it and is `reversed` by the
  // neighbour once more.
  const double from_corner0 = static_cast<double>(clamped) / (n - 1);
  const double along = edge == 0 ? 1 - from_corner0 : from_corner0;
  return {neighbor, SampleBehindEdge(model.placements[neighbor].edge_samples, their_edge, along)};
}

uint8_t* TexelAt(Image& page, const PatchPlacement& placement, const GridPoint& sample) {
  const Eigen::Vector2i texel = TexelOfSample(placement, sample.x(), sample.y());
  return &page.At<uint8_t>(texel.x(), texel.y());
}

// The codes at a source sample, channels arranged for `triangle`'s corners.
std::array<uint8_t, 3> SurfaceCodes(LightFieldModel& model, int term, int triangle,
                                    const Source& source) {
  const bool has_maps = term < model.TriangleTerms(source.triangle);
  const PatchPlacement& placement = model.placements[source.triangle];
  const uint8_t* texel =
      has_maps ? TexelAt(model.surface_pages[term][placement.page], placement, source.sample)
               : nullptr;
  std::array<uint8_t, 3> codes{};
  for (int c = 0; c < 3; ++c) {
    const int vertex = model.mesh.triangles[triangle][c];
    const Eigen::Vector3i& theirs = model.mesh.triangles[source.triangle];
    const int corner = theirs[0] == vertex   ? 0
                       : theirs[1] == vertex ? 1
                       : theirs[2] == vertex ? 2
                                             : -1;
    const size_t range = term * model.vertex_frames.size() + vertex;
    codes[c] = has_maps && corner >= 0 ? texel[corner] : ZeroCode(model.surface_ranges[range]);
  }
  return codes;
}

void CopyFromSource(LightFieldModel& model, int triangle, const GridPoint& gutter,
                    const Source& source) {
  const PatchPlacement& own = model.placements[triangle];
  const PatchPlacement& their = model.placements[source.triangle];
  std::copy_n(TexelAt(model.mean_pages[their.page], their, source.sample), 3,
              TexelAt(model.mean_pages[own.page], own, gutter));
  if (!model.surface_placements.empty()) return;
  for (int k = 0; k < model.TriangleTerms(triangle); ++k) {
    const std::array<uint8_t, 3> codes = SurfaceCodes(model, k, triangle, source);
    std::copy_n(codes.data(), 3, TexelAt(model.surface_pages[k][own.page], own, gutter));
  }
}

void FillTriangle(LightFieldModel& model, const Eigen::Vector3i& neighbors, int triangle) {
  const PatchPlacement& placement = model.placements[triangle];
  const int n = placement.edge_samples;
  for (int index = -1; index <= n; ++index) {
    CopyFromSource(model, triangle, {index, -1}, LegSource(model, neighbors, triangle, 0, index));
    if (index < 0) continue;
    CopyFromSource(model, triangle, {-1, index}, LegSource(model, neighbors, triangle, 2, index));
  }
  CopyFromSource(model, triangle, {n, 0}, {triangle, {n - 1, 0}});
  CopyFromSource(model, triangle, {0, n}, {triangle, {0, n - 1}});
  CompletePatch(model.mean_pages[placement.page], placement);
  for (int k = 0; k < model.TriangleTerms(triangle); ++k) {
    const PatchPlacement& own = model.SurfacePlacement(k, triangle);
    CompletePatch(model.surface_pages[k][own.page], own);
  }
}

}  // namespace

void CompletePatch(Image& page, const PatchPlacement& placement) {
  const int n = placement.edge_samples;
  for (int i = 1; i < n; ++i) {
    const uint8_t* a = TexelAt(page, placement, {i - 1, n - 1 - i});
    const uint8_t* b = TexelAt(page, placement, {i, n - 1 - i});
    const uint8_t* c = TexelAt(page, placement, {i - 1, n - i});
    uint8_t* d = TexelAt(page, placement, {i, n - i});
    for (int channel = 0; channel < 3; ++channel) {
      d[channel] = static_cast<uint8_t>(std::clamp(b[channel] + c[channel] - a[channel], 0, 255));
    }
  }
}

LightFieldModel FillGutters(LightFieldModel model) {
  const std::vector<Eigen::Vector3i> neighbors = ComputeTriangleNeighbors(model.mesh);
  ParallelFor(
      0, static_cast<int64_t>(model.placements.size()),
      [&](int64_t t) { FillTriangle(model, neighbors[t], static_cast<int>(t)); }, 16);
  return model;
}

}  // namespace lfm
