// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "resample/light_field.h"

namespace lfm {

/// Where one triangle of a light field file lies: 24 bytes, for there may be millions.
struct LightFieldRecord {
  uint64_t offset = 0;                       ///< in the data
  std::array<uint32_t, 3> weights_at8 = {};  ///< of each corner, from `offset`, in units of 8 bytes
  uint16_t edge_samples = 0, views = 0;
};

/// A light field file taken apart; `data` points into its bytes.
struct LightFieldContent {
  TriangleMesh mesh;
  std::vector<Eigen::Matrix3d> vertex_frames;
  std::vector<std::string> photo_ids;
  DirectionMap direction_map = DirectionMap::kHemiOctahedral;
  int grid = 0;
  std::span<const std::byte> data;
  std::vector<LightFieldRecord> records;

  std::span<const uint16_t> Photos(const LightFieldRecord& record) const;
  std::span<const uint16_t> Values(const LightFieldRecord& record) const;
  /// Encoded (weight_codec.h), and what follows; of a record with views.
  std::span<const std::byte> Weights(const LightFieldRecord& record, int corner) const;
};

/// Called with parts of the file that have been read and are not needed for now.
using PartRead = std::function<void(std::span<const std::byte> part)>;

/// Takes the bytes of a light field file apart and checks all of them: magic, version, lengths,
/// checksums, and every index that a reader follows, so that content which is hostile in spite of
/// right checksums is refused too. `bytes` must begin at a multiple of 8. `part_read` is called
/// from several threads. Throws Error with `name` in front.
LightFieldContent ParseLightField(std::span<const std::byte> bytes, const std::string& name,
                                  const PartRead& part_read);

}  // namespace lfm
