// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace lfm {

/// What a photograph is for.
enum class PhotoSplit {
  kTrain,  ///< calibrates, and feeds the light field
  kTest,  ///< held out: posed by its own tags once intrinsics are fixed, then used for scoring only
};

}  // namespace lfm
