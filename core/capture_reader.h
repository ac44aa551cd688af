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

/// One named number of a Camera, as files write it.
struct CameraTerm {
  const char* key;
  double Camera::*value;
};
inline constexpr CameraTerm kPinholeTerms[] = {
    {"fx", &Camera::fx}, {"fy", &Camera::fy}, {"cx", &Camera::cx}, {"cy", &Camera::cy}};
inline constexpr CameraTerm kDistortionTerms[] = {{"k1", &Camera::k1},
                                                  {"k2", &Camera::k2},
                                                  {"k3", &Camera::k3},
                                                  {"p1", &Camera::p1},
                                                  {"p2", &Camera::p2}};

/// Why `file` may not be named by a manifest in `folder`; empty when it may.
std::string CapturePathProblem(const std::filesystem::path& folder, const std::string& file);

/// The manifest that `root` holds, with paths inside `folder`. Throws Error as LoadCapture says.
Capture ReadCaptureManifest(JsonReader& root, const std::filesystem::path& folder);

}  // namespace lfm
