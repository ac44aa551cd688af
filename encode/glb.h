// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "encode/model.h"

namespace lfm {

/// A glTF 2.0 file with the extension LFM_surface_light_field (docs/formats.md): the plain mesh,
/// the mean view, all tables needed to show terms, then the terms one after the other.
std::string GlbBytes(const LightFieldModel& model);
/// Writes it, atomically. Returns its size in bytes.
int64_t WriteGlb(const LightFieldModel& model, const std::filesystem::path& file);

/// What of a file is read.
enum class GlbContent {
  kAll,
  /// Without a look into the pages of terms, which take most of the time: a model without terms
  /// that shows what the whole one shows with EvaluationOptions{.terms = 0}. Checked as kAll, but
  /// for what those pages hold and whether patches and tiles lie inside them.
  kMeanView,
};
/// Reads it back: maps, ranges and placements bit by bit, coordinates and frames as float32. Throws
/// Error on truncated, inconsistent or hostile content (sizes of pictures are checked before they
/// are decoded); never reads outside the file, and what it returns is safe to evaluate.
LightFieldModel ReadGlb(const std::filesystem::path& file, GlbContent content = GlbContent::kAll);
/// The same from bytes in memory; `name` stands for the file in messages.
LightFieldModel ReadGlbBytes(std::string_view bytes, const std::string& name,
                             GlbContent content = GlbContent::kAll);

}  // namespace lfm
