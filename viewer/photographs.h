// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "core/camera.h"
#include "core/image.h"
#include "viewer/camera_file.h"

namespace lfm {

/// A photograph of a capture whose pose is known.
struct PosedPhotograph {
  std::string id;
  std::filesystem::path file;  ///< relative to the capture folder
  PosedCamera camera;          ///< its own lens
  bool held_out = false;       ///< a test photograph: the model was made without it
};

/// Those of a working folder (WORK/calib) that are also in `capture` (a capture folder), ascending
/// by id; file and `held_out` are the capture's. Pictures are not opened. Throws Error when either
/// folder cannot be read, or they have no photograph in common.
std::vector<PosedPhotograph> FindPhotographs(const std::filesystem::path& work,
                                             const std::filesystem::path& capture);

/// A picture as a pinhole camera would have taken it.
struct PinholePicture {
  Image color;    ///< 8-bit sRGB RGB; black where `seen` is 0
  Image seen;     ///< 8 bit, one channel: 255 where the photograph shows that pixel, else 0
  Camera camera;  ///< without distortion
};

/// Reads the photograph and takes its lens distortion out: bilinear in linear light, same size,
/// focal lengths and principal point. Without distortion and shrinking the bytes are those of
/// ToRgb8. Not seen is what lies off the sensor and what the lens model folds back at.
///
/// With sides longer than `max_side` (1 or more, else Error) it is made smaller by the least whole
/// factor f that fits, averaging in linear light: pixel (X, Y) is the mean of pixels f X to
/// f X + f - 1 and f Y to f Y + f - 1 of the full-size pinhole picture and seen where all of them
/// are; at the right and below, up to f - 1 pixels are left over.
///
/// 16-bit pictures need the capture's encoding, which is looked up in its manifest. Throws Error,
/// naming the file, when it cannot be read or is not of the camera's size. Parallel over rows.
PinholePicture ReadPinholePicture(const PosedPhotograph& photograph,
                                  const std::filesystem::path& capture, int max_side);

/// How a rendering differs from a photograph.
struct PhotographDifference {
  Image picture;       ///< 8-bit RGB: |difference| times `gain` a channel, black where not compared
  int64_t pixels = 0;  ///< compared: where the photograph is seen and the model covers all
  double psnr_db = 0;  ///< of those, as PsnrFromMse has it; 0 without any
  double ape = 0;      ///< mean absolute difference of their channels, levels; 0 without any
};
/// `rendering` (8-bit RGB) and `coverage` (8 bit, one channel, 255 where the model covers the pixel
/// wholly) of the photograph's pinhole camera. Throws Error when sizes or types differ, and for a
/// gain below 1.
PhotographDifference ComparePhotograph(const PinholePicture& photograph, const Image& rendering,
                                       const Image& coverage, int gain);

}  // namespace lfm
