// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>

#include "encode/encode.h"
#include "encode/light_field_source.h"

namespace lfm {

/// Pages of the light field's file may take one part in so many of the memory allowed.
constexpr int kFileShare = 8;

/// The most terms that a vertex may get.
int MostTerms(const EncodeOptions& options);

/// What Encode takes at most beside the light field, in bytes: the 8-bit maps of all terms that may
/// be chosen, as often as they are held, and tables a triangle and vertex.
int64_t EncodeBytes(const LightFieldSource& source, std::span<const int> edge_samples,
                    const EncodeOptions& options);

/// Throws Error when that is more than options.memory_mib leaves: before anything is factorised.
void RequireMemory(const LightFieldSource& source, std::span<const int> edge_samples,
                   const EncodeOptions& options);

}  // namespace lfm
