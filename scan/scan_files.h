// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <optional>

#include "scan/scan.h"

namespace lfm {

/// Writes `folder/rig.json`, `folder/scan_NN.ply` and `folder/points.ply`.
void SaveScan(const ScanResult& result, const std::filesystem::path& folder);
/// Reads rig and clouds back.
ScanResult LoadScan(const std::filesystem::path& folder);

/// The rig in the file that `options.rig` names: a rig.json, of which `camera`, `projector` (lens
/// terms that are 0 may be left out) and `projector_from_camera` are read. None when it names none.
/// Throws Error for missing, malformed and non-finite values.
std::optional<KnownRig> KnownRigOf(const ScanOptions& options);

}  // namespace lfm
