// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/error_bound.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstdint>

#include "core/parallel.h"

namespace lfm {
namespace {

constexpr double kSmallestPiece = 0.02;  // of the bound

using Piece = std::array<Eigen::Vector3d, 3>;

double DistanceToSegment(const Eigen::Vector3d& p, const Eigen::Vector3d& a,
                         const Eigen::Vector3d& b) {
  const Eigen::Vector3d along = b - a;
  const double square = along.squaredNorm();
  const double t = square > 0 ? std::clamp((p - a).dot(along) / square, 0.0, 1.0) : 0;
  return (p - a - t * along).norm();
}

class Prover {
 public:
  Prover(const TriangleMesh& other, const RayScene& scene, double max_mm)
      : other_(other), scene_(scene), max_mm_(max_mm) {}

  bool Proves(const Piece& piece) const {
    double longest = 0;
    for (int k = 0; k < 3; ++k) {
      longest = std::max(longest, (piece[k] - piece[(k + 1) % 3]).norm());
    }
    const Eigen::Vector3d middle = (piece[0] + piece[1] + piece[2]) / 3;
    for (int k = 0; k < 4; ++k) {
      const auto closest = scene_.Closest(k == 0 ? middle : piece[k - 1]);
      if (!closest || closest->distance > max_mm_) return false;
      if (NearWhole(piece, closest->triangle)) return true;
    }
    if (longest < kSmallestPiece * max_mm_) return false;
    const Eigen::Vector3d ab = 0.5 * (piece[0] + piece[1]), bc = 0.5 * (piece[1] + piece[2]),
                          ca = 0.5 * (piece[2] + piece[0]);
    return Proves({piece[0], ab, ca}) && Proves({ab, piece[1], bc}) && Proves({ca, bc, piece[2]}) &&
           Proves({ab, bc, ca});
  }

 private:
  bool NearWhole(const Piece& piece, int triangle) const {
    const Eigen::Vector3i& t = other_.triangles[triangle];
    return std::all_of(piece.begin(), piece.end(), [&](const Eigen::Vector3d& corner) {
      return DistanceToTriangle(corner, other_.vertices[t[0]], other_.vertices[t[1]],
                                other_.vertices[t[2]]) <= max_mm_;
    });
  }

  const TriangleMesh& other_;
  const RayScene& scene_;
  double max_mm_;
};

}  // namespace

double DistanceToTriangle(const Eigen::Vector3d& p, const Eigen::Vector3d& a,
                          const Eigen::Vector3d& b, const Eigen::Vector3d& c) {
  const Eigen::Vector3d normal = (b - a).cross(c - a);
  const double length = normal.norm();
  if (length > 0) {
    const bool inside = normal.dot((b - a).cross(p - a)) >= 0 &&
                        normal.dot((c - b).cross(p - b)) >= 0 &&
                        normal.dot((a - c).cross(p - c)) >= 0;
    if (inside) return std::abs(normal.dot(p - a)) / length;
  }
  return std::min(
      {DistanceToSegment(p, a, b), DistanceToSegment(p, b, c), DistanceToSegment(p, c, a)});
}

bool IsWithin(const TriangleMesh& mesh, const TriangleMesh& other, const RayScene& scene,
              double max_mm) {
  ValidateMesh(mesh, "error bound");
  ValidateMesh(other, "error bound");
  const Prover prover(other, scene, max_mm);
  std::atomic<bool> refuted = false;
  ParallelFor(
      0, static_cast<int64_t>(mesh.triangles.size()),
      [&](int64_t t) {
        if (refuted) return;
        const Eigen::Vector3i& c = mesh.triangles[t];
        if (!prover.Proves({mesh.vertices[c[0]], mesh.vertices[c[1]], mesh.vertices[c[2]]})) {
          refuted = true;
        }
      },
      64);
  return !refuted;
}

}  // namespace lfm
