// SPDX-License-Identifier: BSD-3-Clause
#include "encode/guessed_directions.h"

#include "core/parallel.h"

namespace lfm {

size_t GuessedBytes(int grid) { return (static_cast<size_t>(grid) * grid + 7) / 8; }

std::vector<uint8_t> FindGuessedDirections(const LightFieldSource& source) {
  const auto vertices = static_cast<int64_t>(source.mesh.vertices.size());
  const auto directions = static_cast<size_t>(source.grid) * source.grid;
  const size_t stride = GuessedBytes(source.grid);
  const VertexRings rings = ComputeVertexRings(source.mesh);
  std::vector<uint8_t> guessed(stride * static_cast<size_t>(vertices), 0);
  ParallelFor(
      0, vertices,
      [&](int64_t v) {
        uint8_t* mask = guessed.data() + stride * static_cast<size_t>(v);
        for (size_t q = 0; q < directions; ++q) {
          mask[q / 8] = static_cast<uint8_t>(mask[q / 8] | 1U << q % 8);
        }
        LightField::WeightBuffer buffer;
        for (int i = rings.offsets[v]; i < rings.offsets[v + 1]; ++i) {
          const int triangle = rings.triangles[i];
          const Eigen::Vector3i& corners = source.mesh.triangles[triangle];
          for (int corner = 0; corner < 3; ++corner) {
            if (corners[corner] != v) continue;
            const ViewWeights weights = source.weights(triangle, corner, buffer);
            for (size_t q = 0; q < weights.seen.size(); ++q) {
              if (weights.seen[q]) mask[q / 8] = static_cast<uint8_t>(mask[q / 8] & ~(1U << q % 8));
            }
          }
        }
      },
      64);
  return guessed;
}

}  // namespace lfm
