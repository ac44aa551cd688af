// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>

#include "encode/model.h"

namespace lfm {

/// Writes `model.glb` (glTF 2.0, extension LFM_surface_light_field, docs/formats.md), atomically.
/// Returns its size in bytes.
int64_t WriteGlb(const LightFieldModel& model, const std::filesystem::path& file);
/// Reads it back. Throws Error on truncated, inconsistent or hostile content; never reads outside
/// the file.
LightFieldModel ReadGlb(const std::filesystem::path& file);

}  // namespace lfm
