// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/patch_sizes.h"
#include "core/triangle_mesh.h"
#include "resample/direction_map.h"

namespace lfm {

/// Surface samples of a triangle patch: a triangular grid with `n` samples an edge, corners and
/// edges included, n (n + 1) / 2 in all. Sample (i, j), i + j < n, lies at barycentric weights
/// (1 - (i + j) / (n - 1), i / (n - 1), j / (n - 1)) of corners 0, 1, 2; its index runs j outer,
/// i inner. n >= 2.
inline constexpr int kMaxEdgeSamples = 257;  ///< of any light field file
int PatchSampleIndex(int n, int i, int j);
Eigen::Vector3d PatchSampleWeights(int n, int i, int j);

/// The visible views of one triangle, normalised to one shape: the block P of DESIGN 4.
///
/// `values[(sample * 3 + channel) * photos.size() + view]` is sRGB-coded radiance times
/// `LightField::kOne`: 8-bit photographs use [0, kOne]; imputed values of saturated pixels may
/// exceed kOne.
struct TrianglePatch {
  int edge_samples = 0;              ///< n
  std::span<const uint16_t> photos;  ///< indices into LightField::photo_ids, ascending
  std::span<const uint16_t> values;
};

/// Delaunay view weights of one triangle corner: the block W of DESIGN 4. Grid entry q is the sum
/// of weight[3 q + k] times view view[3 q + k] (an index into TrianglePatch::photos), k = 0, 1, 2;
/// weights are >= 0 and sum to one; no view at all (a triangle seen by nobody) gives empty spans.
struct ViewWeights {
  std::span<const uint16_t> view;
  std::span<const float> weight;
  /// 1 where the grid direction lies inside the convex hull of the seen ones, 0 where guessed.
  std::span<const uint8_t> seen;
};

/// The resampled light field, F_i = P_i W_i for every triangle i, never multiplied out.
///
/// Read-only and memory-mapped (`resample/light_field.lfs`, docs/formats.md); safe to read from
/// many threads. Weights of a triangle are decoded on request into the caller's buffer.
class LightField {
 public:
  static constexpr int kOne = 32768;  ///< the stored value of sRGB-coded 1.0

  /// Throws Error when the file is missing, truncated, of another version, or fails its checksums.
  ///
  /// Every byte is checked here, once (in parallel; about 10 GB/s from memory), so that reading a
  /// triangle needs no check and cannot fail. Of a larger file about `most_resident_bytes` are
  /// resident at a time, however much of it is read; beside them its mesh, and 24 bytes a triangle.
  static LightField Open(const std::filesystem::path& file,
                         int64_t most_resident_bytes = int64_t{1} << 30);
  /// The same from bytes in memory; `name` stands for the file in messages.
  static LightField FromMemory(std::vector<std::byte> bytes, const std::string& name);
  ~LightField();
  LightField(LightField&&) noexcept;
  LightField& operator=(LightField&&) noexcept;

  const std::string& name() const;   ///< for messages: the file's
  const TriangleMesh& mesh() const;  ///< the decimated mesh, with normals
  const std::vector<Eigen::Matrix3d>& vertex_frames() const;
  const std::vector<std::string>& photo_ids() const;
  DirectionMap direction_map() const;
  int grid() const;  ///< view grid is grid x grid
  int triangle_count() const;
  /// Valid while the light field lives. `triangle` in [0, triangle_count()), corner in [0, 3).
  TrianglePatch Patch(int triangle) const;
  struct WeightBuffer {
    std::vector<uint16_t> view;
    std::vector<float> weight;
    std::vector<uint8_t> seen;
  };
  ViewWeights Weights(int triangle, int corner, WeightBuffer& buffer) const;

  /// 3 bytes x samples x grid^2, over all triangles: what the literature counts ratios against.
  int64_t DenseBytes() const;

 private:
  struct State;
  explicit LightField(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

/// Writes a light field chunk by chunk: triangles in ascending order, from one thread.
///
/// Content is written to `.NAME.partial` beside the file, which a later run overwrites. Throws
/// Error (kSystem) when the disk is full or the folder not writable, and when the caller's data do
/// not fit together (lengths, indices, the number of triangles).
class LightFieldWriter {
 public:
  struct Header {
    TriangleMesh mesh;
    std::vector<Eigen::Matrix3d> vertex_frames;
    std::vector<std::string> photo_ids;
    DirectionMap direction_map = DirectionMap::kHemiOctahedral;
    int grid = 32;
  };
  /// One triangle as it is written; weights of the three corners as in ViewWeights.
  struct Triangle {
    int edge_samples = 2;
    std::vector<uint16_t> photos;
    std::vector<uint16_t> values;
    std::array<LightField::WeightBuffer, 3> weights;
  };
  /// The file appears under its name only when Finish() has run.
  LightFieldWriter(const std::filesystem::path& file, const Header& header);
  ~LightFieldWriter();
  void Write(const Triangle& triangle);
  void Finish();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace lfm
