// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>

#include "sample_data/studio.h"

namespace lfm {

/// Writes what went wrong in a capture into its ground truth `folder` (docs/formats.md):
/// trouble.json (all knobs, and the conditions of each photograph), board.json (the board as
/// printed) and platform.json (where everything printed truly is). Writes nothing, and removes such
/// files of an earlier run, when every knob of trouble is at its default.
void WriteTrouble(const StudioOptions& options, const StudioResult& result,
                  const std::filesystem::path& folder);

}  // namespace lfm
