// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "resample/light_field.h"

namespace lfm {

/// One triangle of a light field file, in place.
struct LightFieldRecord {
  int edge_samples = 0;
  std::span<const uint16_t> photos, values;
  std::array<std::span<const std::byte>, 3> weights;  ///< encoded (weight_codec.h)
};

/// A light field file taken apart; spans point into its bytes.
struct LightFieldContent {
  TriangleMesh mesh;
  std::vector<Eigen::Matrix3d> vertex_frames;
  std::vector<std::string> photo_ids;
  DirectionMap direction_map = DirectionMap::kHemiOctahedral;
  int grid = 0;
  std::vector<LightFieldRecord> records;
};

/// Takes the bytes of a light field file apart and checks all of them: magic, version, lengths,
/// checksums, and every index that a reader follows, so that content which is hostile in spite of
/// right checksums is refused too. `bytes` must begin at a multiple of 8. Throws Error with `name`
/// in front.
LightFieldContent ParseLightField(std::span<const std::byte> bytes, const std::string& name);

}  // namespace lfm
