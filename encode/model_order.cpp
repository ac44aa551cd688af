// SPDX-License-Identifier: BSD-3-Clause
#include "encode/model_order.h"

#include <algorithm>
#include <array>
#include <numeric>

#include "core/error.h"
#include "core/parallel.h"
#include "encode/gutters.h"
#include "encode/model_layout.h"
#include "resample/light_field.h"

namespace lfm {
namespace {

std::vector<int> InversePermutation(const std::vector<int>& old_index) {
  std::vector<int> new_index(old_index.size());
  for (size_t i = 0; i < old_index.size(); ++i) new_index[old_index[i]] = static_cast<int>(i);
  return new_index;
}

template <typename T>
std::vector<T> Permuted(const std::vector<T>& values, const std::vector<int>& old_index) {
  std::vector<T> result;
  if (values.empty()) return result;
  result.reserve(old_index.size());
  for (const int old : old_index) result.push_back(values[old]);
  return result;
}

TriangleMesh ReorderMesh(const TriangleMesh& mesh, const MeshOrder& order) {
  TriangleMesh result{Permuted(mesh.vertices, order.vertices),
                      {},
                      Permuted(mesh.normals, order.vertices),
                      Permuted(mesh.confidence, order.vertices),
                      Permuted(mesh.colors, order.vertices)};
  const std::vector<int> new_vertex = InversePermutation(order.vertices);
  for (size_t t = 0; t < order.triangles.size(); ++t) {
    const Eigen::Vector3i& old = mesh.triangles[order.triangles[t]];
    Eigen::Vector3i& corners = result.triangles.emplace_back();
    for (int c = 0; c < 3; ++c) corners[c] = new_vertex[old[(c + order.turns[t]) % 3]];
  }
  return result;
}

// The patches of a ring, one after the other, each turned.
std::vector<uint8_t> TurnRing(std::span<const int> ring, const MeshOrder& order,
                              const LightFieldModel& target, const std::vector<uint8_t>& codes) {
  std::vector<uint8_t> turned;
  auto patch = codes.begin();
  for (const int triangle : ring) {
    const int n = target.placements[triangle].edge_samples;
    const auto end = patch + PatchSampleCount(n);
    const std::vector<uint8_t> own =
        TurnPatch(n, order.turns[triangle], 1, std::vector<uint8_t>(patch, end));
    turned.insert(turned.end(), own.begin(), own.end());
    patch = end;
  }
  return turned;
}

void CopyVertex(const LightFieldModel& model, const MeshOrder& order, std::span<const int> ring,
                int vertex, LightFieldModel& target) {
  std::vector<int> old_ring;
  for (const int triangle : ring) old_ring.push_back(order.triangles[triangle]);
  std::vector<TermMaps> terms;
  for (int k = 0; k < target.vertex_terms[vertex]; ++k) {
    terms.push_back(ReadVertexTerm(model, old_ring, order.vertices[vertex], k));
    terms.back().surface_codes = TurnRing(ring, order, target, terms.back().surface_codes);
  }
  WriteVertexTerms(ring, terms, vertex, target);
}

}  // namespace

MeshOrder KeptOrder(const TriangleMesh& mesh) {
  MeshOrder order{std::vector<int>(mesh.vertices.size()), std::vector<int>(mesh.triangles.size()),
                  std::vector<int>(mesh.triangles.size(), 0)};
  std::iota(order.vertices.begin(), order.vertices.end(), 0);
  std::iota(order.triangles.begin(), order.triangles.end(), 0);
  return order;
}

MeshOrder Inverse(const MeshOrder& order) {
  MeshOrder inverse{InversePermutation(order.vertices), InversePermutation(order.triangles), {}};
  for (const int t : inverse.triangles) inverse.turns.push_back((3 - order.turns[t]) % 3);
  return inverse;
}

std::vector<uint8_t> TurnPatch(int edge_samples, int turn, int channels,
                               const std::vector<uint8_t>& values) {
  const int n = edge_samples;
  std::vector<uint8_t> turned(values.size());
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i + j < n; ++i) {
      const std::array<int, 3> weights = {n - 1 - i - j, i, j};
      std::array<int, 3> old{};
      for (int c = 0; c < 3; ++c) old[(c + turn) % 3] = weights[c];
      std::copy_n(values.data() + size_t{1} * PatchSampleIndex(n, old[1], old[2]) * channels,
                  channels, turned.data() + size_t{1} * PatchSampleIndex(n, i, j) * channels);
    }
  }
  return turned;
}

LightFieldModel ReorderModel(const LightFieldModel& model, const MeshOrder& order) {
  if (order.vertices.size() != model.mesh.vertices.size() ||
      order.triangles.size() != model.mesh.triangles.size() ||
      order.turns.size() != model.mesh.triangles.size()) {
    throw Error("model order: it is not of this mesh", ErrorKind::kSystem);
  }
  const TriangleMesh mesh = ReorderMesh(model.mesh, order);
  const std::vector<Eigen::Matrix3d> frames = Permuted(model.vertex_frames, order.vertices);
  std::vector<int> edge_samples;
  for (const int t : order.triangles) edge_samples.push_back(model.placements[t].edge_samples);
  LightFieldModel result =
      LayOutModel({mesh, frames, model.direction_map, model.grid, {}, {}, 0}, edge_samples,
                  Permuted(model.vertex_terms, order.vertices), LargestPageSide(model));
  result.mean_in_terms = model.mean_in_terms;
  for (size_t t = 0; t < edge_samples.size(); ++t) {
    WriteMean(TurnPatch(edge_samples[t], order.turns[t], 3, ReadMean(model, order.triangles[t])),
              static_cast<int>(t), result);
  }
  const VertexRings rings = ComputeVertexRings(mesh);
  ParallelFor(0, static_cast<int64_t>(frames.size()), [&](int64_t v) {
    const auto ring = rings.Ring(v);
    CopyVertex(model, order, ring, static_cast<int>(v), result);
  });
  return FillGutters(std::move(result));
}

int LargestPageSide(const LightFieldModel& model) {
  int largest = 256;
  const auto include = [&largest](const std::vector<Image>& pages) {
    for (const Image& page : pages) largest = std::max({largest, page.width(), page.height()});
  };
  include(model.mean_pages);
  for (const auto& pages : model.view_pages) include(pages);
  return largest;
}

}  // namespace lfm
