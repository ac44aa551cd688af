// SPDX-License-Identifier: BSD-3-Clause
#include "encode/transport_stream.h"

namespace lfm::transport {

Ring MakeRing(const TriangleMesh& mesh, const VertexRings& rings,
              const std::vector<int>& edge_samples, int vertex) {
  Ring ring;
  std::vector<Eigen::Vector3i> corners;
  for (int e = rings.offsets[vertex]; e < rings.offsets[vertex + 1]; ++e) {
    const int triangle = rings.triangles[e];
    ring.triangles.push_back(triangle);
    ring.edge_samples.push_back(edge_samples[triangle]);
    ring.corners.push_back(CornerOf(mesh.triangles[triangle], vertex));
    ring.samples += PatchSampleCount(edge_samples[triangle]);
    corners.push_back(mesh.triangles[triangle]);
  }
  ring.shared = FindSharedSamples(corners, ring.edge_samples);
  return ring;
}

MapTransform MakeTransform(const std::vector<int>& edge_samples, int grid) {
  std::vector<int> sides = edge_samples;
  sides.push_back(grid);
  return MapTransform(sides);
}

Eigen::Vector3f PredictMean(const Eigen::Vector3i& neighbors, int triangle,
                            const std::vector<Eigen::Vector3f>& colors) {
  Eigen::Vector3f sum = Eigen::Vector3f::Zero();
  int count = 0;
  for (const int neighbor : neighbors) {
    if (neighbor < 0 || neighbor >= triangle) continue;
    sum += colors[neighbor];
    ++count;
  }
  if (count > 0) return sum / static_cast<float>(count);
  return triangle > 0 ? colors[triangle - 1] : Eigen::Vector3f(0.5F, 0.5F, 0.5F);
}

Eigen::Vector3f MeanOffset(const CoefficientBlock& block, float step) {
  const Eigen::Vector3f constant(static_cast<float>(block.At(0, 0, 0)),
                                 static_cast<float>(block.At(1, 0, 0)),
                                 static_cast<float>(block.At(2, 0, 0)));
  return OpponentColors() * constant * (step * std::sqrt(2.F) / static_cast<float>(block.side));
}

}  // namespace lfm::transport
