// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>

#include "core/capture.h"
#include "core/json_reader.h"

// The reading half of capture.json. Private to core; use core/capture.h.

namespace lfm {

inline constexpr int kCaptureVersion = 1;
inline constexpr const char* kCaptureFormat = "lfm-capture";

/// The manifest that `root` holds, with paths inside `folder`. Throws Error as LoadCapture says.
Capture ReadCaptureManifest(JsonReader& root, const std::filesystem::path& folder);

}  // namespace lfm
