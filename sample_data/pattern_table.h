// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "sample_data/trouble.h"
#include "scan/patterns.h"

namespace lfm {

/// A stretch of the projector's columns (or rows): `index`, and `share` of it on the one after.
struct ProjectedSpan {
  int index = 0;
  float share = 0;
};

/// The stretch [center - width / 2, center + width / 2] over pixels of unit width, at most one
/// pixel wide and inside [0, count).
ProjectedSpan MakeSpan(double center, double width, int count);

/// One sample of a pixel under the projector: light proportional to `weight` times what the
/// projector shows at its columns and rows.
struct ProjectedSample {
  ProjectedSpan column, row;
  float weight = 0;
};

/// What a projector really shows of a pattern sequence, for all frames at once:
/// 1. each pixel sends its pattern's value to the power `projector_gamma`;
/// 2. crosstalk: frames other than white and black are sent three at a time as red, green and blue
///    of one picture, in the order of the sequence, columns and rows each for themselves; the gray
///    camera takes each colour through its filter, which passes the share `crosstalk_percent` of
///    each of the other two: (1 - (m - 1) c) own + c (the others), m <= 3 frames in the picture.
///    White and black have the same in all three colours and keep their values;
/// 3. defocus: convolution with a Gaussian of `projector_defocus_px`; no light comes from outside
///    the picture. Since patterns are constant along the other axis it is done along one, and the
///    picture's other borders stay sharp.
/// Without trouble, pixels are squares of constant value; a blurred pattern is kept at four places
/// a pixel.
class PatternTable {
 public:
  explicit PatternTable(const PatternSequence& sequence, const ScanTrouble& trouble = {});
  int frames() const { return frames_; }
  /// Span around projector coordinate `center` (pixels, column or row) for a stretch of `width`.
  ProjectedSpan ColumnSpan(double center, double width) const;
  ProjectedSpan RowSpan(double center, double width) const;
  /// sums[f] += weight * mean of what frame f shows over the sample's span, for all frames.
  void Accumulate(const ProjectedSample& sample, float* sums) const;
  /// Frames as Accumulate orders them, to manifest order: the frame of slot i.
  const std::vector<int>& frame_of_slot() const { return frame_of_slot_; }

 private:
  static void AddSpan(const std::vector<float>& table, int slots, const ProjectedSpan& span,
                      float weight, float* sums);

  int frames_ = 0, column_slots_ = 0, row_slots_ = 0;
  int columns_ = 0, rows_ = 0, places_ = 1;  // places a pixel
  std::vector<int> frame_of_slot_;
  std::vector<float> by_column_, by_row_;
};

}  // namespace lfm
