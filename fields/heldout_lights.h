// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "core/image.h"
#include "core/progress.h"
#include "fields/field.h"
#include "fields/light_methods.h"

namespace lfm {

/// The linear value that is shown as white: the 99.9th percentile of what the rows show at most
/// (those that show anything), or 1 where that lies from 1/16 to 1, as it does of 8-bit pictures; 1
/// for a black field.
double DisplayWhite(const Field& field);

/// Values of a picture's rows (channel after channel) as 8-bit sRGB, three channels.
Image PictureOfRows(const Field& field, const std::vector<float>& values, double white);
/// Column `column` of a picture's field.
Image PictureOfColumn(const Field& field, int column, double white);

/// The pixels that count, 8 bit, one channel: the field's mask, or, where it has none, those that
/// some training light brings above `kNoiseLevel` (a level of 8-bit sRGB) in some channel; all,
/// when no pixel is.
Image ObjectMask(const Field& train, double white);
inline constexpr int kNoiseLevel = 8;

/// How one method shows the held-out lights.
struct LightMethodScore {
  std::string name, family;
  int64_t bytes = 0;
  /// Over the mask's pixels of all held-out pictures, 8-bit sRGB (core/image_metrics.h).
  double psnr_db = 0, ssim = 0, ape = 0;
  /// sum |R - prediction|^2 / sum |R|^2 over the same, linear radiance; 0 when all is black.
  double relative_error = 0;
  std::vector<double> light_psnr_db;  ///< a held-out light
};

struct LightScores {
  int lights = 0;      ///< held out
  int64_t pixels = 0;  ///< that count in each
  double white = 1;    ///< the linear value shown as white
  std::vector<LightMethodScore> methods;
};

/// Scores every method on every column of `held_out`, a picture's field. `mask` as ObjectMask gives
/// it. Without held-out lights the methods' names and bytes are all there is. Throws Error when
/// the field is no picture, sizes do not agree, or a method gives another number of values.
LightScores ScoreLightMethods(const Field& held_out, const Image& mask, double white,
                              const std::vector<LightMethod>& methods, Progress& progress);

/// {"lights": .., "pixels": .., "white": .., "methods": [{"name": .., "bytes": .., "psnr_db": ..,
/// ...}]} (docs/formats.md).
nlohmann::json LightScoresToJson(const LightScores& scores);
/// Such figures as lines of text for a terminal.
std::string LightFiguresToTable(const nlohmann::json& figures);

}  // namespace lfm
