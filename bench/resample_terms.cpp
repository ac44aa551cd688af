// SPDX-License-Identifier: BSD-3-Clause
// How many terms vertex rings need.
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cstdio>

#include "core/image.h"
#include "core/parallel.h"
#include "core/triangle_mesh.h"
#include "resample/resample.h"
#include "resample/view_weights.h"
#include "resample_views.h"

namespace lfm::bench {
namespace {

/// How the matrix of a vertex is laid out and factorised.
enum class Frame { kVertex, kReflected, kVertexLinear };
constexpr std::array<Frame, 3> kFrames = {Frame::kVertex, Frame::kReflected, Frame::kVertexLinear};
constexpr std::array<const char*, 3> kFrameNames = {
    "of the vertex", "reflected in each sample's normal", "of the vertex, linear values"};

/// What is left after 0, 1, 2, ... terms beside the mean view, of sRGB-coded values.
constexpr int kMostTerms = 8;
using Rest = std::array<SquaredError, kMostTerms + 1>;

Eigen::Vector3d InterpolatedNormal(const TriangleMesh& mesh, const Eigen::Vector3i& corners,
                                   const Eigen::Vector3d& weights) {
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
  for (int c = 0; c < 3; ++c) normal += weights[c] * mesh.normals[static_cast<size_t>(corners[c])];
  return normal.normalized();
}

/// Rows: samples of the ring; columns: directions, channel by channel; sRGB-coded. `hats` are the
/// samples' weights at the vertex.
struct RingMatrix {
  Eigen::MatrixXd values;
  Eigen::VectorXd hats;
};

/// A triangle's rows. With Frame::kReflected the directions of a sample are those mirrored in its
/// own interpolated normal.
void AppendRows(const Object& object, int vertex, int triangle, Frame kind,
                std::vector<Eigen::VectorXd>& rows, std::vector<double>& hats) {
  constexpr int kGrid = 16;
  constexpr auto kMap = DirectionMap::kHemiOctahedral;
  const std::vector<Eigen::Vector2d> grid = GridInPlane(kMap, kGrid);
  const Eigen::Matrix3d& frame = object.field.vertex_frames()[static_cast<size_t>(vertex)];
  const Views views = ViewsOf(object, triangle);
  if (views.patch.photos.size() < kLeastViews) return;
  const Eigen::Vector3i& corners = object.field.mesh().triangles[static_cast<size_t>(triangle)];
  const int corner = corners[0] == vertex ? 0 : corners[1] == vertex ? 1 : 2;
  const int n = views.patch.edge_samples, step = (n - 1) / 3;
  std::vector<size_t> all(views.to_eye.size());
  for (size_t v = 0; v < all.size(); ++v) all[v] = v;
  std::vector<Mix> mixes;
  for (int j = 0; j < n; j += step) {
    for (int i = 0; i + j < n; i += step) {
      const Eigen::Vector3d weights = PatchSampleWeights(n, i, j);
      if (weights[corner] <= 0) continue;
      if (kind == Frame::kReflected || mixes.empty()) {
        const Eigen::Vector3d normal = InterpolatedNormal(object.field.mesh(), corners, weights);
        std::vector<Eigen::Vector2d> plane;
        for (const Eigen::Vector3d& d : views.to_eye) {
          const Eigen::Vector3d placed =
              kind == Frame::kReflected ? Eigen::Vector3d(2 * normal.dot(d) * normal - d) : d;
          plane.push_back(PlaneFromDirection(kMap, frame.transpose() * placed));
        }
        mixes = MixesOf(plane, all, grid, ResampleOptions{}.hull_margin);
      }
      const auto sample = static_cast<size_t>(PatchSampleIndex(n, i, j));
      Eigen::VectorXd row(3 * kGrid * kGrid);
      for (size_t k = 0; k < 3 * grid.size(); ++k) {
        row[static_cast<Eigen::Index>(k)] =
            Coded(views, 3 * sample + k / grid.size(), mixes[k % grid.size()]);
      }
      rows.push_back(std::move(row));
      hats.push_back(weights[corner]);
    }
  }
}

/// Principal terms of hat-weighted rows without their mean view, and how far they are from `truth`.
Rest FitTerms(const RingMatrix& ring, Frame kind) {
  Rest rest;
  const Eigen::Index rows = ring.values.rows(), columns = ring.values.cols() / 3;
  if (rows == 0) return rest;
  const bool linear = kind == Frame::kVertexLinear;
  Eigen::MatrixXd matrix = ring.values;
  if (linear) {
    matrix =
        matrix.unaryExpr([](double x) -> double { return LinearFromSrgb(static_cast<float>(x)); });
  }
  Eigen::MatrixXd mean(rows, 3);
  for (Eigen::Index c = 0; c < 3; ++c) {
    auto part = matrix.middleCols(c * columns, columns);
    mean.col(c) = part.rowwise().mean();
    part.colwise() -= mean.col(c);
  }
  matrix = ring.hats.asDiagonal() * matrix;
  const Eigen::MatrixXd gram = matrix * matrix.transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(gram);
  Eigen::MatrixXd fit = Eigen::MatrixXd::Zero(rows, matrix.cols());
  for (int k = 0; k <= kMostTerms; ++k) {
    for (Eigen::Index r = 0; r < rows; ++r) {
      for (Eigen::Index q = 0; q < fit.cols(); ++q) {
        const double shown = mean(r, q / columns) + fit(r, q) / ring.hats[r];
        const double coded =
            linear ? SrgbFromLinear(static_cast<float>(std::max(0.0, shown))) : shown;
        rest[static_cast<size_t>(k)].Add(ring.hats[r] * (coded - ring.values(r, q)));
      }
    }
    if (k >= rows) continue;
    const Eigen::VectorXd u = solver.eigenvectors().col(rows - 1 - k);
    fit += u * (u.transpose() * matrix);
  }
  return rest;
}

Rest RestOfVertex(const Object& object, int vertex, std::span<const int> ring, Frame kind) {
  std::vector<Eigen::VectorXd> rows;
  std::vector<double> hats;
  for (const int t : ring) AppendRows(object, vertex, t, kind, rows, hats);
  RingMatrix matrix;
  if (!rows.empty()) matrix.values.resize(static_cast<Eigen::Index>(rows.size()), rows[0].size());
  for (size_t r = 0; r < rows.size(); ++r) {
    matrix.values.row(static_cast<Eigen::Index>(r)) = rows[r];
  }
  matrix.hats =
      Eigen::Map<const Eigen::VectorXd>(hats.data(), static_cast<Eigen::Index>(hats.size()));
  return FitTerms(matrix, kind);
}

}  // namespace

void PrintTerms(const Object& object) {
  constexpr int kVertexStride = 40;
  const VertexRings rings = ComputeVertexRings(object.field.mesh());
  std::printf("\n| frame of view maps (grid 16) |");
  for (int k = 0; k <= kMostTerms; ++k) std::printf(" %d terms |", k);
  std::printf("\n|---|");
  for (int k = 0; k <= kMostTerms; ++k) std::printf("---|");
  std::printf("\n");
  for (size_t kind = 0; kind < kFrames.size(); ++kind) {
    const int64_t count = static_cast<int64_t>(rings.offsets.size() - 1) / kVertexStride;
    std::vector<Rest> rests(static_cast<size_t>(count));
    ParallelFor(0, count, [&](int64_t i) {
      const auto v = static_cast<size_t>(i * kVertexStride);
      const auto ring = rings.Ring(v);
      rests[static_cast<size_t>(i)] =
          RestOfVertex(object, static_cast<int>(v), ring, kFrames[kind]);
    });
    std::printf("| %s |", kFrameNames[kind]);
    for (size_t k = 0; k <= kMostTerms; ++k) {
      SquaredError error;
      for (const Rest& rest : rests) error.Add(rest[k]);
      std::printf(" %.2f |", error.PsnrDb());
    }
    std::printf("\n");
    std::fflush(stdout);
  }
}

}  // namespace lfm::bench
