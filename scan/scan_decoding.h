// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "calib/calib.h"
#include "core/capture.h"
#include "core/progress.h"
#include "scan/decode.h"
#include "scan/patterns.h"
#include "scan/plate_correspondences.h"
#include "scan/scan.h"

namespace lfm {

/// What a set is decoded by.
struct DecodingTask {
  const Board& board;
  const CalibResult& calib;
  const Camera& camera;                      ///< its size is required
  const std::vector<Eigen::Vector2d>& rays;  ///< of the camera's pixels
  const ImageLoader& load_image;
  const ScanOptions& options;
  const PatternSequence* sequence = nullptr;
  int plate_points = 0;  ///< correspondences wanted of a set
};

/// One decoded set of frames, or why there is none.
struct DecodedSet {
  std::string id;
  std::string reason;  ///< why it cannot be used; empty when it can
  PlatePlacement platform;
  /// The columns alone: position, sigma, confidence; the rest is gone to save memory.
  DecodedPixels pixels;
  std::vector<PlateCorrespondence> plate;  ///< placement 0
  bool Usable() const { return reason.empty(); }
};

/// Decodes sets in parallel, and takes from each what the platform shows. What a set lacks is its
/// own misfortune (`reason`), an interrupt everybody's.
std::vector<DecodedSet> DecodeSets(const std::vector<ScanSet>& sets,
                                   const std::vector<PosedImage>& poses, const DecodingTask& task,
                                   Progress& progress);

/// The sequence that roles name. Throws Error, naming the manifest's `key`, when Decode does not
/// read it or it has no column patterns.
PatternSequence RequireColumns(const Capture& capture, const std::vector<std::string>& roles,
                               const char* key);

/// Throws Error, naming both sizes, unless the scanner's camera was calibrated for pictures of the
/// size that the capture's have.
void RequireSameSize(const Capture& capture, const Camera& calibrated);

}  // namespace lfm
