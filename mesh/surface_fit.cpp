// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/surface_fit.h"

#include <Eigen/Geometry>
#include <Eigen/IterativeLinearSolvers>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>
#include <vector>

#include "core/parallel.h"
#include "core/ray_scene.h"
#include "mesh/vertex_moves.h"

namespace lfm {
namespace {

constexpr double kSameSideCosine = 0.5;
// Weight of staying, in samples.
constexpr double kInertia = 0.05;

struct Equation {
  bool used = false;
  Eigen::Vector3i vertices = Eigen::Vector3i::Zero();
  Eigen::Vector3d factors = Eigen::Vector3d::Zero();
  double offset = 0;
};

Eigen::Vector3d Barycentric(const TriangleMesh& mesh, int triangle, const Eigen::Vector3d& p) {
  const Eigen::Vector3i& c = mesh.triangles[triangle];
  const Eigen::Vector3d e1 = mesh.vertices[c[1]] - mesh.vertices[c[0]];
  const Eigen::Vector3d e2 = mesh.vertices[c[2]] - mesh.vertices[c[0]];
  const Eigen::Vector3d d = p - mesh.vertices[c[0]];
  const double a = e1.dot(e1), b = e1.dot(e2), f = e2.dot(e2);
  const double determinant = a * f - b * b;
  if (!(determinant > 0)) return {1, 0, 0};
  const double u = (f * e1.dot(d) - b * e2.dot(d)) / determinant;
  const double v = (a * e2.dot(d) - b * e1.dot(d)) / determinant;
  const Eigen::Vector3d weights = Eigen::Vector3d(1 - u - v, u, v).cwiseMax(0);
  return weights / weights.sum();
}

std::vector<Equation> MakeEquations(const TriangleMesh& mesh,
                                    const std::vector<Eigen::Vector3d>& directions,
                                    const SurfaceSamples& samples) {
  const RayScene scene(mesh);
  std::vector<Equation> equations(samples.points.size());
  ParallelFor(
      0, static_cast<int64_t>(equations.size()),
      [&](int64_t k) {
        const auto closest = scene.Closest(samples.points[k]);
        if (!closest) return;
        const Eigen::Vector3d normal = TriangleNormal(mesh, closest->triangle);
        if (normal.dot(samples.normals[k]) < kSameSideCosine) return;
        Equation& equation = equations[k];
        equation.used = true;
        equation.vertices = mesh.triangles[closest->triangle];
        equation.offset = normal.dot(samples.points[k] - closest->point);
        const Eigen::Vector3d weights = Barycentric(mesh, closest->triangle, closest->point);
        for (int j = 0; j < 3; ++j) {
          equation.factors[j] = weights[j] * normal.dot(directions[equation.vertices[j]]);
        }
      },
      256);
  return equations;
}

Eigen::VectorXd SolveMoves(const std::vector<Equation>& equations, const std::vector<char>& fixed,
                           size_t vertices) {
  std::vector<Eigen::Triplet<double>> entries;
  Eigen::VectorXd right = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(vertices));
  for (size_t v = 0; v < vertices; ++v) {
    entries.emplace_back(static_cast<int>(v), static_cast<int>(v), kInertia);
  }
  const auto is_free = [&](int v) { return fixed.empty() || !fixed[v]; };
  for (const Equation& equation : equations) {
    if (!equation.used) continue;
    for (int i = 0; i < 3; ++i) {
      if (!is_free(equation.vertices[i])) continue;
      right[equation.vertices[i]] += equation.factors[i] * equation.offset;
      for (int j = 0; j < 3; ++j) {
        if (!is_free(equation.vertices[j])) continue;
        entries.emplace_back(equation.vertices[i], equation.vertices[j],
                             equation.factors[i] * equation.factors[j]);
      }
    }
  }
  Eigen::SparseMatrix<double> normal_matrix(static_cast<Eigen::Index>(vertices),
                                            static_cast<Eigen::Index>(vertices));
  normal_matrix.setFromTriplets(entries.begin(), entries.end());
  Eigen::ConjugateGradient<Eigen::SparseMatrix<double>, Eigen::Lower> solver;
  solver.setTolerance(1e-6);
  solver.setMaxIterations(200);
  solver.compute(normal_matrix);
  Eigen::VectorXd moves = solver.solve(right);
  if (!moves.allFinite()) moves.setZero();
  return moves;
}

}  // namespace

TriangleMesh FitToSurface(const TriangleMesh& mesh, const SurfaceSamples& samples,
                          const std::vector<char>& fixed) {
  TriangleMesh fitted;
  fitted.triangles = mesh.triangles;
  const std::vector<Eigen::Vector3d> directions = ComputeVertexNormals(mesh);
  const auto equations = MakeEquations(mesh, directions, samples);
  fitted.vertices =
      MoveWithoutFlips(mesh, directions, SolveMoves(equations, fixed, mesh.vertices.size()));
  return fitted;
}

}  // namespace lfm
