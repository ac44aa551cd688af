// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/manifold_repair.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <tuple>
#include <utility>

#include "core/disjoint_sets.h"
#include "core/error.h"
#include "core/half_edges.h"

namespace lfm {
namespace {

constexpr double kSmallestVolume = 0.02;
constexpr size_t kLargestHole = 32;  // edges

// Triangles with three different corners; of each set with the same corners, as many as are left
// when opposite ones have cancelled, at most one.
std::vector<Eigen::Vector3i> CancelDuplicates(const std::vector<Eigen::Vector3i>& triangles) {
  struct Entry {
    std::array<int, 3> corners;
    int triangle, sign;
  };
  std::vector<Entry> entries;
  for (size_t t = 0; t < triangles.size(); ++t) {
    std::array<int, 3> c = {triangles[t][0], triangles[t][1], triangles[t][2]};
    std::rotate(c.begin(), std::min_element(c.begin(), c.end()), c.end());
    if (c[0] == c[1] || c[1] == c[2] || c[2] == c[0]) continue;
    const int sign = c[1] < c[2] ? 1 : -1;
    std::sort(c.begin(), c.end());
    entries.push_back({c, static_cast<int>(t), sign});
  }
  std::sort(entries.begin(), entries.end(), [](const Entry& a, const Entry& b) {
    return std::tie(a.corners, a.triangle) < std::tie(b.corners, b.triangle);
  });
  std::vector<int> kept;
  for (size_t i = 0; i < entries.size();) {
    size_t end = i;
    int sum = 0;
    while (end < entries.size() && entries[end].corners == entries[i].corners) {
      sum += entries[end++].sign;
    }
    for (size_t k = i; k < end && sum != 0; ++k) {
      if ((entries[k].sign > 0) != (sum > 0)) continue;
      kept.push_back(entries[k].triangle);
      break;
    }
    i = end;
  }
  std::sort(kept.begin(), kept.end());
  std::vector<Eigen::Vector3i> result;
  for (const int t : kept) result.push_back(triangles[t]);
  return result;
}

// The edges that lack a triangle, in the direction in which it would run through them: for each
// vertex where they lead.
std::map<int, std::vector<int>> FindOpenEdges(const std::vector<Eigen::Vector3i>& triangles) {
  std::vector<std::array<int, 3>> edges;  // low, high, direction
  edges.reserve(3 * triangles.size());
  for (const Eigen::Vector3i& t : triangles) {
    for (int k = 0; k < 3; ++k) {
      const int a = t[k], b = t[(k + 1) % 3];
      edges.push_back({std::min(a, b), std::max(a, b), a < b ? 1 : -1});
    }
  }
  std::sort(edges.begin(), edges.end());
  std::map<int, std::vector<int>> open;
  for (size_t i = 0; i < edges.size();) {
    size_t end = i;
    int surplus = 0;
    while (end < edges.size() && edges[end][0] == edges[i][0] && edges[end][1] == edges[i][1]) {
      surplus += edges[end++][2];
    }
    for (; surplus > 0; --surplus) open[edges[i][1]].push_back(edges[i][0]);
    for (; surplus < 0; ++surplus) open[edges[i][0]].push_back(edges[i][1]);
    i = end;
  }
  return open;
}

// Triangles are cycles of edges, so what they leave open at a vertex leads away as often as towards
// it: the open edges make closed walks, which are cut into simple cycles here.
std::vector<std::vector<int>> TraceHoles(std::map<int, std::vector<int>> open) {
  std::vector<std::vector<int>> holes;
  while (!open.empty()) {
    std::vector<int> walk = {open.begin()->first};
    while (true) {
      const auto from = open.find(walk.back());
      const int to = from->second.back();
      from->second.pop_back();
      if (from->second.empty()) open.erase(from);
      const auto before = std::find(walk.begin(), walk.end(), to);
      if (before == walk.end()) {
        walk.push_back(to);
        continue;
      }
      holes.emplace_back(before, walk.end());
      walk.erase(before + 1, walk.end());
      if (walk.size() == 1) break;
    }
  }
  return holes;
}

void FillHoles(TriangleMesh& mesh) {
  for (const std::vector<int>& hole : TraceHoles(FindOpenEdges(mesh.triangles))) {
    if (hole.size() > kLargestHole) {
      throw Error("reconstruction: the surface has a hole that could not be closed");
    }
    if (hole.size() == 3) {
      mesh.triangles.emplace_back(hole[0], hole[1], hole[2]);
      continue;
    }
    const int middle = static_cast<int>(mesh.vertices.size());
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (size_t k = 0; k < hole.size(); ++k) {
      sum += mesh.vertices[hole[k]];
      mesh.triangles.emplace_back(hole[k], hole[(k + 1) % hole.size()], middle);
    }
    mesh.vertices.push_back(sum / static_cast<double>(hole.size()));
  }
}

// Around an edge from low to high, the angle at which a triangle leaves it, in [0, 2 pi).
double AngleAround(const TriangleMesh& mesh, const HalfEdge& half_edge,
                   const Eigen::Vector3d& reference) {
  const Eigen::Vector3d origin = mesh.vertices[half_edge.Low()];
  const Eigen::Vector3d axis = (mesh.vertices[half_edge.High()] - origin).normalized();
  const int apex = mesh.triangles[half_edge.Corner() / 3][(half_edge.Corner() % 3 + 2) % 3];
  const Eigen::Vector3d arm = mesh.vertices[apex] - origin;
  const double angle = std::atan2(axis.dot(reference.cross(arm)),
                                  arm.dot(reference) - axis.dot(reference) * axis.dot(arm));
  return angle < 0 ? angle + 2 * M_PI : angle;
}

// Pairs of half-edges of one edge that bound the same wedge of solid. Counter-clockwise about the
// edge (low to high), a forward triangle has the outside behind its right-hand normal, the inside
// before it: the solid lies between it and the next backward one clockwise.
std::vector<std::pair<int, int>> PairAroundEdge(const TriangleMesh& mesh,
                                                const std::vector<HalfEdge>& fan) {
  const auto forward = std::count_if(fan.begin(), fan.end(), [](auto& h) { return h.Forward(); });
  if (2 * forward != static_cast<int64_t>(fan.size())) {
    throw Error("reconstruction: the surface has a hole that could not be closed");
  }
  if (fan.size() == 2) return {{fan[0].Corner(), fan[1].Corner()}};
  const int apex = mesh.triangles[fan[0].Corner() / 3][(fan[0].Corner() % 3 + 2) % 3];
  const Eigen::Vector3d reference = mesh.vertices[apex] - mesh.vertices[fan[0].Low()];
  std::vector<std::pair<double, size_t>> order;
  for (size_t i = 0; i < fan.size(); ++i) {
    order.emplace_back(AngleAround(mesh, fan[i], reference), i);
  }
  std::sort(order.begin(), order.end());
  std::vector<std::pair<int, int>> pairs;
  std::vector<char> used(fan.size());
  for (size_t i = 0; i < order.size(); ++i) {
    if (!fan[order[i].second].Forward()) continue;
    for (size_t step = 1; step < order.size(); ++step) {
      const size_t other = order[(i + order.size() - step) % order.size()].second;
      if (fan[other].Forward() || used[other]) continue;
      used[other] = 1;
      pairs.emplace_back(fan[order[i].second].Corner(), fan[other].Corner());
      break;
    }
  }
  return pairs;
}

// Every fan of triangles that hang together over edges gets its own vertex.
TriangleMesh SplitFans(const TriangleMesh& mesh, std::vector<int>& piece_of_triangle) {
  const std::vector<HalfEdge> half_edges = SortedHalfEdges(mesh);
  DisjointSets corners(3 * mesh.triangles.size()), pieces(mesh.triangles.size());
  for (size_t i = 0; i < half_edges.size();) {
    size_t end = i;
    while (end < half_edges.size() && SameEdge(half_edges[end], half_edges[i])) ++end;
    const std::vector<HalfEdge> fan(half_edges.begin() + i, half_edges.begin() + end);
    for (const auto& [a, b] : PairAroundEdge(mesh, fan)) {
      const auto next = [](int corner) { return corner / 3 * 3 + (corner % 3 + 1) % 3; };
      corners.Unite(a, next(b));
      corners.Unite(next(a), b);
      pieces.Unite(a / 3, b / 3);
    }
    i = end;
  }
  TriangleMesh split;
  std::vector<int> vertex_of_set(3 * mesh.triangles.size(), -1);
  for (size_t t = 0; t < mesh.triangles.size(); ++t) {
    Eigen::Vector3i triangle;
    for (int k = 0; k < 3; ++k) {
      int& vertex = vertex_of_set[corners.Find(static_cast<int>(3 * t) + k)];
      if (vertex < 0) {
        vertex = static_cast<int>(split.vertices.size());
        split.vertices.push_back(mesh.vertices[mesh.triangles[t][k]]);
      }
      triangle[k] = vertex;
    }
    split.triangles.push_back(triangle);
    piece_of_triangle.push_back(pieces.Find(static_cast<int>(t)));
  }
  return split;
}

}  // namespace

TriangleMesh SelectTriangles(const TriangleMesh& mesh, const std::vector<char>& keep) {
  TriangleMesh selected;
  std::vector<int> new_index(mesh.vertices.size(), -1);
  for (size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (!keep[t]) continue;
    Eigen::Vector3i triangle;
    for (int k = 0; k < 3; ++k) {
      const int old_index = mesh.triangles[t][k];
      if (new_index[old_index] < 0) {
        new_index[old_index] = static_cast<int>(selected.vertices.size());
        selected.vertices.push_back(mesh.vertices[old_index]);
        if (!mesh.normals.empty()) selected.normals.push_back(mesh.normals[old_index]);
        if (!mesh.confidence.empty()) selected.confidence.push_back(mesh.confidence[old_index]);
        if (!mesh.colors.empty()) selected.colors.push_back(mesh.colors[old_index]);
      }
      triangle[k] = new_index[old_index];
    }
    selected.triangles.push_back(triangle);
  }
  return selected;
}

TriangleMesh RepairToClosedManifold(const TriangleMesh& mesh) {
  ValidateMesh(mesh, "reconstruction");
  TriangleMesh cleaned;
  cleaned.vertices = mesh.vertices;
  cleaned.triangles = CancelDuplicates(mesh.triangles);
  FillHoles(cleaned);
  cleaned.triangles = CancelDuplicates(cleaned.triangles);
  if (SignedVolume(cleaned) < 0) {
    for (Eigen::Vector3i& t : cleaned.triangles) std::swap(t[1], t[2]);
  }
  std::vector<int> pieces;
  const TriangleMesh split = SplitFans(cleaned, pieces);

  std::vector<double> volumes(split.triangles.size());
  const Eigen::Vector3d origin =
      split.vertices.empty() ? Eigen::Vector3d::Zero().eval() : split.vertices.front();
  for (size_t t = 0; t < split.triangles.size(); ++t) {
    const Eigen::Vector3i& c = split.triangles[t];
    const Eigen::Vector3d a = split.vertices[c[0]] - origin, b = split.vertices[c[1]] - origin;
    volumes[pieces[t]] += a.dot(b.cross(split.vertices[c[2]] - origin)) / 6;
  }
  const double largest = volumes.empty() ? 0 : *std::max_element(volumes.begin(), volumes.end());
  if (!(largest > 0)) throw Error("reconstruction: the surface bounds no volume");
  std::vector<char> keep(split.triangles.size());
  for (size_t t = 0; t < keep.size(); ++t) keep[t] = volumes[pieces[t]] > kSmallestVolume * largest;
  TriangleMesh repaired = SelectTriangles(split, keep);
  const MeshTopology topology = ExamineTopology(repaired);
  if (!topology.closed || !topology.manifold) {
    throw Error("reconstruction: the surface could not be made closed and manifold");
  }
  return repaired;
}

}  // namespace lfm
