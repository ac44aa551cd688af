// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/capture.h"
#include "core/image.h"
#include "scan/decode.h"
#include "scan/scan.h"

namespace lfm {

/// Pictures that show how one scan decoded, 8-bit sRGB RGB of the camera's size; undecoded pixels
/// are dark gray shades of the all-white picture.
struct ScanPictures {
  Image columns;     ///< projector column, from blue (first) through green to red (last)
  Image phase;       ///< hue once round a fringe period: breaks in the rainbow are wrong periods
  Image confidence;  ///< black (rejected) through orange to white (certain)
};

/// Draws decoded pixels. Throws Error (kSystem) when nothing was decoded along the columns.
ScanPictures DrawDecoded(const DecodedPixels& decoded, const PatternSequence& sequence);

/// Decodes scan `index` of the capture again and draws it. Throws Error when the capture has no
/// such scan or a frame is unreadable.
ScanPictures DrawScan(const Capture& capture, int index, const ImageLoader& load_image,
                      const ScanOptions& options);

}  // namespace lfm
