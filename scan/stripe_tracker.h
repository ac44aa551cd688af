// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "scan/patterns.h"

namespace lfm {

/// Watches a stripe pass over all pixels, frame by frame, and keeps what each pixel saw about its
/// brightest moment: memory does not grow with the number of frames.
///
/// Frames are averaged in bins of width / (8 step), at least one, so that the moment is some ten
/// bins long whatever the stripe. A bin's response is its sum with the bins within half a stripe's
/// width; the brightest response is the moment, and `radius` bins to either side are kept.
class StripeTracker {
 public:
  StripeTracker(const StripeShape& stripe, int frames, size_t pixels);

  /// Linear values of the next frame.
  void Add(const float* values);
  /// After the last frame.
  void Finish();

  int window() const { return 2 * radius_ + 1; }
  double CenterPx(int bin) const;  ///< of the stripe in a bin, projector pixels
  double BinPx() const { return static_cast<double>(bin_) * stripe_.step_px; }

  /// What one pixel saw: bins [first, first + count), values of these bins.
  struct Moment {
    int peak = -1;  ///< bin of the brightest response; -1: nothing finite was seen
    int first = 0, count = 0;
    const float* values = nullptr;
    /// Brightest response more than `radius` bins away from the peak's, over the peak's, both
    /// above the darkest: 1 when the pixel saw two stripes alike.
    double rival = 0;
  };
  Moment At(size_t pixel) const;

 private:
  void CloseBin();
  void JudgeBin(int bin);
  const float* BinValues(int bin) const;
  float* BinValues(int bin);

  StripeShape stripe_;
  int bin_ = 1, bins_ = 0, radius_ = 1, reach_ = 0;
  size_t pixels_ = 0;
  int bins_seen_ = 0, in_bin_ = 0;
  std::vector<float> ring_;                    ///< `window` bins, all pixels each
  std::vector<float> best_, rival_, darkest_;  ///< responses
  std::vector<int32_t> peak_;
  std::vector<float> windows_;  ///< pixel after pixel
};

}  // namespace lfm
