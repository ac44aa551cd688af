// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "encode/model.h"

namespace lfm {

/// A glTF 2.0 file with the extension LFM_surface_light_field (docs/formats.md): the plain mesh, the
/// mean view, all tables needed to show terms, then the terms one after the other.
std::string GlbBytes(const LightFieldModel& model);
/// Writes it, atomically. Returns its size in bytes.
int64_t WriteGlb(const LightFieldModel& model, const std::filesystem::path& file);
/// Reads it back: maps, ranges and placements bit by bit, coordinates and frames as float32. Throws
/// Error on truncated, inconsistent or hostile content (sizes of pictures are checked before they
/// are decoded); never reads outside the file, and what it returns is safe to evaluate.
LightFieldModel ReadGlb(const std::filesystem::path& file);
/// The same from bytes in memory; `name` stands for the file in messages.
LightFieldModel ReadGlbBytes(std::string_view bytes, const std::string& name);

}  // namespace lfm
