// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "core/image.h"

namespace lfm::bench {

/// Whether channels go together as colours or each as a gray picture of its own.
enum class Channels { kTogether, kApart };

struct JpegXlPicture {
  Image image;        ///< decoded
  int64_t bytes = 0;  ///< of the code stream
};

/// An 8-bit RGB picture through libjxl, at effort 7. `distance`: Butteraugli distance, 0 (lossless)
/// to 15. Throws Error where libjxl fails.
JpegXlPicture ThroughJpegXl(const Image& image, float distance, Channels channels);

}  // namespace lfm::bench
