// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>

#include "calib/calib.h"

namespace lfm {

/// Writes `folder/cameras.json` and `folder/poses.json` (docs/formats.md).
void SaveCalib(const CalibResult& result, const std::filesystem::path& folder);
/// The inverse; throws Error on missing, malformed or non-finite content.
CalibResult LoadCalib(const std::filesystem::path& folder);

/// What the calibration stage does: takes the cameras and poses of a capture that brings its
/// geometry, with or without a board (what is given wins), and calibrates any other by its board.
/// Throws Error when it has neither.
CalibResult CalibrateCapture(const Capture& capture, const CalibOptions& options,
                             Progress& progress);
/// The calibration that a later stage works with, by the same rule: the capture's own when it
/// brings its geometry, else the one that was saved in `folder` (LoadCalibOf).
CalibResult CalibOfCapture(const Capture& capture, const std::filesystem::path& folder);
/// LoadCalib that also throws Error when a picture of `capture` is not the one that was calibrated
/// under its name (`PosedImage::fingerprint`). Pictures that are missing now are left to the stage
/// that reads them.
CalibResult LoadCalibOf(const Capture& capture, const std::filesystem::path& folder);
/// The calibration that a capture brings along (`Capture::BringsGeometry`): its intrinsics and
/// poses as they are, covariances and residuals zero, scans as far as their poses are given. Throws
/// Error when a camera's intrinsics or a photograph's pose is missing.
CalibResult CalibFromCapture(const Capture& capture);

}  // namespace lfm
