// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "resample/patch_sampling.h"

namespace lfm {

/// One of the bilinear readings that a sample is the weighted mean of.
struct FootprintTap {
  Eigen::Vector2d offset_px;  ///< from the sample's own pixel
  float weight = 0;           ///< > 0; one in the sum
};

/// The readings for a patch whose samples lie `a` and `b` pixels apart along its two edges: an
/// elliptical weighted average (Heckbert 1989, section 3.5), the centre first.
///
/// Patches are shown by linear interpolation between neighbouring samples. The hat function of a
/// sample has the covariance (a a' + b b' + (a - b)(a - b)') / 12, a bilinear reading 1 / 6 in
/// each direction. What the first has more, along its axes, is made up by a Gaussian of readings
/// (up to 2.5 standard deviations away, one pixel apart or less, but 65 x 65 at most: what is
/// wider has gaps). Where samples lie closer than pixels there is one reading, the centre: never
/// narrower than bilinear. Axes of less than 0.1 px of standard deviation are left out. `a` and `b`
/// must be finite.
std::vector<FootprintTap> FootprintTaps(const Eigen::Vector2d& a, const Eigen::Vector2d& b);

/// SampleView with each sample averaged over its footprint: the spacing of `points`, a patch of
/// `edge_samples` in order of PatchSampleIndex, as its three corners show it in the photograph.
///
/// The centre must be data, as for SampleView. Of the other readings those take part that are data
/// and that nothing but data lies between the centre and: beyond a depth edge stands something
/// else. With less than half of the weight the sample is missing. A lower bound where a pixel that
/// took part stands at 255. The same as SampleView, bit for bit, where FootprintTaps has one
/// reading, or a corner does not project.
SampledView SampleViewByArea(const PhotoPixels& photo, const Camera& camera,
                             const Pose& camera_from_world,
                             const std::vector<Eigen::Vector3d>& points, int edge_samples);

}  // namespace lfm
