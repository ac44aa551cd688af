// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "calib/board.h"
#include "core/camera.h"
#include "core/capture.h"
#include "core/image.h"
#include "core/pose.h"

namespace lfm {

/// What the test's photographer does beside pointing the camera.
struct RenderSettings {
  double full_well = 20000;  ///< electrons at linear 1; 0: no noise
  double read_noise = 5;     ///< electrons
  uint32_t seed = 1;
  double light_gradient = 0.3;  ///< relative change of light across the picture
  double hidden_share = 0;      ///< an ellipse of this share of width and height hides the middle
  Eigen::Vector3d bend_per_mm = {0, 0, 0};  ///< of the plate, as PlatformShape has it
  Eigen::Vector3d gains = {1, 1, 1};        ///< white balance: factors of red, green, blue
  double blur_px = 0;                       ///< standard deviation
};

/// An 8-bit sRGB picture of the printed plate, and of those attached to it, before a gray
/// background: ink 0.05, paper 0.8. Pixels see exact areas of the print.
Image RenderBoard(const Board& board, const Camera& camera, const Pose& camera_from_world,
                  const RenderSettings& settings = {});

/// A lens of 480 x 360 pixels with distortion, principal point off the middle.
Camera SmallCamera();

/// Poses round the platform at elevations between 25 and 75 degrees with some roll, near enough
/// that the plate fills most of SmallCamera's picture.
std::vector<Pose> PosesAround(int count);

/// A capture of rendered pictures held in memory: photo i is "photo_i.png".
struct RenderedCapture {
  Capture capture;
  std::vector<Image> pictures;
  std::vector<Pose> poses;  ///< camera_from_world
  Camera camera;
  ImageLoader Loader() const;
};
/// Pictures from `poses`; the first `train` of them are for training. `settings.seed` is the first
/// picture's, the others' follow.
RenderedCapture RenderPoses(const Board& board, const std::vector<Pose>& poses, int train,
                            const RenderSettings& settings = {.hidden_share = 0.25},
                            const Camera& camera = SmallCamera());
/// `seed` 0: the poses of PosesAround; others: from places drawn at random round them.
RenderedCapture RenderCapture(const Board& board, int train, int test, uint32_t seed = 0,
                              const RenderSettings& settings = {.hidden_share = 0.25},
                              const Camera& camera = SmallCamera());

}  // namespace lfm
