// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/normal_estimation.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <tuple>
#include <vector>

#include "core/disjoint_sets.h"
#include "core/parallel.h"
#include "mesh/nearest_points.h"

namespace lfm {
namespace {

constexpr int kNeighbors = 16;
constexpr size_t kFewestPoints = 4;

struct Link {
  float cost = 0;
  int from = 0, to = 0;
  bool operator<(const Link& other) const {
    return std::tie(cost, from, to) < std::tie(other.cost, other.from, other.to);
  }
};

Eigen::Vector3d LeastSpread(const std::vector<Eigen::Vector3d>& points,
                            const std::vector<NearPoint>& near) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const NearPoint& n : near) mean += points[n.index];
  mean /= static_cast<double>(near.size());
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (const NearPoint& n : near) {
    const Eigen::Vector3d d = points[n.index] - mean;
    scatter += d * d.transpose();
  }
  if (!(scatter.trace() > 0)) return Eigen::Vector3d::Zero();
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(scatter).eigenvectors().col(0);
}

// Branches of the cheapest spanning forest, as neighbours of each point.
std::vector<std::vector<int>> SpanningForest(std::vector<Link> links, size_t count) {
  std::sort(links.begin(), links.end());
  DisjointSets pieces(count);
  std::vector<std::vector<int>> branches(count);
  for (const Link& link : links) {
    if (pieces.Find(link.from) == pieces.Find(link.to)) continue;
    pieces.Unite(link.from, link.to);
    branches[link.from].push_back(link.to);
    branches[link.to].push_back(link.from);
  }
  return branches;
}

void MakeSignsAgree(const std::vector<Eigen::Vector3d>& points,
                    const std::vector<std::vector<int>>& branches,
                    std::vector<Eigen::Vector3d>& normals) {
  std::vector<int> from_the_top(points.size());
  for (size_t i = 0; i < points.size(); ++i) from_the_top[i] = static_cast<int>(i);
  std::stable_sort(from_the_top.begin(), from_the_top.end(),
                   [&](int a, int b) { return points[a].z() > points[b].z(); });
  std::vector<char> done(points.size(), 0);
  std::vector<int> open;
  for (const int top : from_the_top) {
    if (done[top]) continue;
    if (normals[top].z() < 0) normals[top] = -normals[top];
    done[top] = 1;
    open.push_back(top);
    while (!open.empty()) {
      const int at = open.back();
      open.pop_back();
      for (const int next : branches[at]) {
        if (done[next]) continue;
        if (normals[next].dot(normals[at]) < 0) normals[next] = -normals[next];
        done[next] = 1;
        open.push_back(next);
      }
    }
  }
}

}  // namespace

PointCloud EstimateNormals(const PointCloud& cloud) {
  PointCloud result = cloud;
  const size_t all = cloud.points.size();
  result.normals.assign(all, Eigen::Vector3d::Zero());
  if (result.confidence.empty()) result.confidence.assign(all, 1);
  std::vector<Eigen::Vector3d> points;
  std::vector<size_t> places;
  for (size_t i = 0; i < all; ++i) {
    if (!cloud.points[i].allFinite()) continue;
    points.push_back(cloud.points[i]);
    places.push_back(i);
  }
  if (points.size() < kFewestPoints) return result;
  const NearestPoints index(points);
  std::vector<Eigen::Vector3d> normals(points.size());
  std::vector<std::array<int, kNeighbors>> neighbors(points.size());
  ParallelFor(
      0, static_cast<int64_t>(points.size()),
      [&](int64_t i) {
        const std::vector<NearPoint> near = index.Find(points[i], kNeighbors + 1);
        normals[i] = LeastSpread(points, near);
        neighbors[i].fill(-1);
        int used = 0;
        for (const NearPoint& n : near) {
          if (n.index != i && used < kNeighbors) neighbors[i][used++] = n.index;
        }
      },
      256);
  std::vector<Link> links;
  for (size_t i = 0; i < points.size(); ++i) {
    for (const int n : neighbors[i]) {
      if (n < 0) continue;
      const double likeness = std::abs(normals[i].dot(normals[n]));
      links.push_back({static_cast<float>(1 - likeness), static_cast<int>(i), n});
    }
  }
  MakeSignsAgree(points, SpanningForest(std::move(links), points.size()), normals);
  for (size_t k = 0; k < points.size(); ++k) result.normals[places[k]] = normals[k];
  return result;
}

}  // namespace lfm
