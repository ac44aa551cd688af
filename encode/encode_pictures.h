// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/image.h"
#include "encode/model.h"

namespace lfm {

struct EncodePicture {
  std::string name;     ///< for a file: "mean-view", "surface-maps-1", "singular-values"
  std::string caption;  ///< one line for people
  Image image;          ///< 8-bit sRGB RGB
};

/// What the model's maps look like: the first page of the mean view, of the surface maps and of the
/// view maps of each term, as stored (codes; red, green and blue of a surface map are the
/// triangle's three corners), cropped to `max_side` texels a side; and the singular values.
std::vector<EncodePicture> DrawEncodePictures(const LightFieldModel& model,
                                              const std::vector<double>& singular_value_share,
                                              int max_side = 768);

/// Removes PNG files of these names, an earlier model's, and the folder when nothing else is in it.
void RemoveEncodePictures(const std::filesystem::path& folder);

/// Bars: each term's share of the view-dependent energy (blue), on top of those before it (grey);
/// the frame's top is 1. No shares: an empty frame.
Image DrawSingularValues(const std::vector<double>& shares);

}  // namespace lfm
