// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

#include "fields/relightable_model.h"

namespace lfm {

/// Bytes of a .lfr file by what they hold; indices count (Yamada 2009 leaves them out of its
/// ratios).
struct RelightableBytes {
  int64_t header = 0;            ///< with the name
  int64_t directions = 0;        ///< with the column basis
  int64_t geometry = 0;          ///< positions and triangles
  int64_t bases = 0;             ///< F of all clusters, with their numbers of terms
  int64_t clusters = 0;          ///< a number a row
  int64_t weights = 0;           ///< W
  int64_t residual_indices = 0;  ///< how many a row has, and in which columns
  int64_t residual_values = 0;

  int64_t Total() const {
    return header + directions + geometry + bases + clusters + weights + residual_indices +
           residual_values;
  }
};
/// Of the file that EncodeRelightable would make, to the byte.
RelightableBytes CountBytes(const RelightableModel& relightable);

/// A .lfr file's bytes (docs/formats.md): bases, weights and residual values as float16 with a
/// power of two in common (fields/half_floats.h; a basis function each has its own), residual
/// columns in 8 bits up to 256 columns, else in 16. The same model gives the same bytes. Throws
/// Error when CheckRelightable does.
std::string EncodeRelightable(const RelightableModel& relightable);
/// Throws Error, `name` in front, when the bytes are no .lfr file, of another version, cut short,
/// longer than they say, damaged, or contradict themselves. Safe on hostile bytes: takes memory in
/// proportion to `bytes`, whatever they promise.
RelightableModel DecodeRelightable(std::span<const std::byte> bytes, const std::string& name);

/// What comes back from the file of this model: its numbers rounded to what the file holds. An
/// encoder that computes the residual against stored bases and weights loses nothing to rounding.
RelightableModel AsStored(const RelightableModel& relightable);

void WriteRelightable(const RelightableModel& relightable, const std::filesystem::path& file);
/// Also throws Error when the file is missing.
RelightableModel ReadRelightable(const std::filesystem::path& file);

}  // namespace lfm
