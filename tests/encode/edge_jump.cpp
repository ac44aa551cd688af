// SPDX-License-Identifier: BSD-3-Clause
#include "tests/encode/edge_jump.h"

#include <algorithm>
#include <cmath>
#include <random>

#include "encode/model_evaluation.h"

namespace lfm::testing {

EdgeJumps JumpsAcrossEdges(const LightFieldModel& model, int terms) {
  const auto neighbors = ComputeTriangleNeighbors(model.mesh);
  std::mt19937 random(2);
  double largest = 0, sum = 0;
  int64_t count = 0;
  for (int t = 0; t < static_cast<int>(neighbors.size()); ++t) {
    for (int e = 0; e < 3; ++e) {
      const int other = neighbors[t][e];
      if (other < t) continue;
      int other_edge = 0;
      while (model.mesh.triangles[other][other_edge] != model.mesh.triangles[t][(e + 1) % 3]) {
        ++other_edge;
      }
      std::normal_distribution<double> normal;
      const Eigen::Vector3d to_eye =
          (Eigen::Vector3d(normal(random), normal(random), normal(random)).normalized() +
           TriangleNormal(model.mesh, t))
              .normalized();
      for (double along = 0; along <= 1; along += 1.0 / 61) {
        Eigen::Vector3d own = Eigen::Vector3d::Zero(), their = Eigen::Vector3d::Zero();
        own[e] = their[(other_edge + 1) % 3] = 1 - along;
        own[(e + 1) % 3] = their[other_edge] = along;
        const Eigen::Vector3f a = EvaluateModel(model, t, own, to_eye, {terms});
        const Eigen::Vector3f b = EvaluateModel(model, other, their, to_eye, {terms});
        largest = std::max<double>(largest, (a - b).cwiseAbs().maxCoeff());
        sum += (a - b).squaredNorm();
        count += 3;
      }
    }
  }
  return {255 * largest, 255 * std::sqrt(sum / static_cast<double>(std::max<int64_t>(1, count)))};
}

double LargestJumpAcrossEdges(const LightFieldModel& model, int terms) {
  return JumpsAcrossEdges(model, terms).largest;
}

}  // namespace lfm::testing
