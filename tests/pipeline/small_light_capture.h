// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>

namespace lfm {

/// Writes a capture that varies in light into `folder`: 12 x 9 pixels of a matte, partly shadowed
/// bump under `lights` lights of a dome, every fourth held out when `held_out`.
enum class HeldOutLights { kNone, kEveryFourth };
void WriteSmallLightCapture(const std::filesystem::path& folder, int lights,
                            HeldOutLights held_out);

/// The same pictures with an .lp file instead of a manifest.
void WriteSmallLpCapture(const std::filesystem::path& folder, int lights);

}  // namespace lfm
