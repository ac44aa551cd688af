// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "resample/light_field.h"

namespace lfm {

/// Appends the compact form of one corner's view weights to `bytes`: a table of the different
/// (views, seen) and, an entry, a number in that table with two weights in units of 1/65535; the
/// third weight is the rest. 6 bytes an entry and 8 a table row, padded to 8 bytes
/// (docs/formats.md). Weights change by at most 1/65535 and sum to one exactly in those units.
/// Throws Error (kSystem) when the buffer's arrays disagree in length, a view is not below
/// `view_count`, or a weight is negative or not finite.
void AppendWeights(const LightField::WeightBuffer& weights, size_t view_count,
                   std::vector<std::byte>& bytes);

/// Length in bytes of the encoded weights at the start of `bytes`, every field checked:
/// DecodeWeights needs no further check. Throws Error with `where` in front.
size_t CheckWeights(std::span<const std::byte> bytes, size_t entry_count, size_t view_count,
                    const std::string& where);

/// The inverse of AppendWeights, for bytes that CheckWeights has accepted.
void DecodeWeights(std::span<const std::byte> bytes, LightField::WeightBuffer& buffer);

}  // namespace lfm
