// SPDX-License-Identifier: BSD-3-Clause
#include "sample_data/photo_shoot.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "sample_data/exposed_picture.h"
#include "sample_data/occluder.h"
#include "sample_data/random.h"

namespace lfm {
namespace {

constexpr uint64_t kOccluderStream = 34;

// The mean of the exposure's pinhole pictures.
Image AverageExposure(const PhotoShoot& shoot, const std::vector<ExposureSample>& samples,
                      const PhotoRenderer& render, RayCounts& counts) {
  Image sum;
  for (const ExposureSample& sample : samples) {
    const PixelRays rays = shoot.rays.Shifted(sample.shift_x, sample.shift_y);
    RenderedPhoto one = render(rays, sample.camera_from_world);
    counts += one.rays;
    if (sum.empty()) {
      sum = std::move(one.radiance);
      continue;
    }
    float* total = sum.Data<float>();
    const float* values = one.radiance.Data<float>();
    for (size_t i = 0; i < sum.size(); ++i) total[i] += values[i];
  }
  const float share = 1 / static_cast<float>(samples.size());
  for (size_t i = 0; i < sum.size(); ++i) sum.Data<float>()[i] *= share;
  return sum;
}

// Exposure, white balance and vignetting, beyond the nominal exposure.
void ApplyConditions(const PhotoShoot& shoot, const PhotoConditions& conditions, int y,
                     std::vector<float>& row) {
  const auto factor = static_cast<float>(std::exp2(conditions.exposure_stops));
  for (size_t x = 0; x < row.size() / 3; ++x) {
    const auto gain = static_cast<float>(VignettingGain(
        shoot.rays.camera(), shoot.trouble.vignetting_stops, static_cast<double>(x), y));
    for (int c = 0; c < 3; ++c) row[3 * x + c] *= factor * gain * conditions.gains[c];
  }
}

}  // namespace

TakenPhoto TakePhoto(const PhotoShoot& shoot, int index, const Pose& camera_from_world,
                     PhotoSplit split, const PhotoConditions& conditions) {
  PhotoRenderer render = split == PhotoSplit::kTest ? shoot.render_test : shoot.render;
  if (conditions.occluded) {
    RandomStream random(shoot.seed, kOccluderStream, static_cast<uint64_t>(index));
    render = shoot.render_occluded(MakeOccluder(shoot.trouble.occluder, shoot.rays.camera(),
                                                camera_from_world, shoot.center, random));
  }
  RenderedPhoto sharp = render(shoot.rays, camera_from_world);
  const int width = sharp.radiance.width(), height = sharp.radiance.height();
  TakenPhoto taken;
  taken.rays = sharp.rays;
  if (!sharp.standard_error.empty()) {
    taken.noise =
        TallyStandardErrors(sharp.radiance, sharp.standard_error, shoot.exposure, shoot.sensor);
  }
  if (split == PhotoSplit::kTest) {
    taken.clean = Image(width, height, 3, PixelType::kUint8, ColorEncoding::kSrgb);
    RenderedPhoto open;
    if (conditions.occluded) open = shoot.render_test(shoot.rays, camera_from_world);
    const float* in = (conditions.occluded ? open : sharp).radiance.Data<float>();
    uint8_t* out = taken.clean.Data<uint8_t>();
    for (size_t i = 0; i < taken.clean.size(); ++i) out[i] = EncodeSrgb8(shoot.exposure * in[i]);
  }
  taken.mask = std::move(sharp.mask);

  const double focus_depth_mm =
      std::max(1.0, (camera_from_world * shoot.center).z() + shoot.trouble.focus_error_mm);
  const std::vector<ExposureSample> samples =
      ExposureSamples(camera_from_world, conditions.travel_mm, shoot.trouble.aperture_mm,
                      focus_depth_mm, shoot.trouble.blur_samples);
  const Image radiance = samples.size() == 1 ? std::move(sharp.radiance)
                                             : AverageExposure(shoot, samples, render, taken.rays);
  const bool plain = conditions.exposure_stops == 0 && shoot.trouble.vignetting_stops == 0 &&
                     conditions.gains == Eigen::Vector3f(1, 1, 1);
  taken.picture = MakePicture(width, height, shoot.trouble.format);
  std::vector<float> row(static_cast<size_t>(width) * 3);
  for (int y = 0; y < height; ++y) {
    const float* in = &radiance.At<float>(0, y);
    for (size_t i = 0; i < row.size(); ++i) row[i] = shoot.exposure * in[i];
    if (!plain) ApplyConditions(shoot, conditions, y, row);
    ExposePictureRow(shoot.sensor, row, shoot.seed, static_cast<uint64_t>(index), y, taken.picture);
  }
  return taken;
}

}  // namespace lfm
