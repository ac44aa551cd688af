// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>

#include "encode/encode.h"
#include "encode/light_field_source.h"

namespace lfm {

/// The most terms that a vertex may get.
int MostTerms(const EncodeOptions& options);

/// What Encode takes at most beside the light field, in bytes: the 8-bit maps of all terms that may
/// be chosen, as often as they are held, and tables a triangle and vertex.
int64_t EncodeBytes(const LightFieldSource& source, std::span<const int> edge_samples,
                    const EncodeOptions& options);

/// How much of the light field's file may be resident (LightField::Open) under
/// options.memory_mib: an eighth of it, 1 GiB at most.
int64_t ResidentFileBytes(const EncodeOptions& options);

/// Throws Error when EncodeBytes and that part of the file are more than options.memory_mib leaves:
/// before anything is factorised.
void RequireMemory(const LightFieldSource& source, std::span<const int> edge_samples,
                   const EncodeOptions& options);

}  // namespace lfm
