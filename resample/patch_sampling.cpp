// SPDX-License-Identifier: BSD-3-Clause
#include "resample/patch_sampling.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/error.h"
#include "resample/light_field.h"

namespace lfm {
namespace {

std::optional<Eigen::Vector3d> CrossingAlong(const RayScene& surface, const Eigen::Vector3d& point,
                                             const Eigen::Vector3d& normal, double max_shift_mm) {
  const auto outwards = surface.Intersect(point, normal, 0, max_shift_mm);
  const double reach = outwards ? outwards->distance : max_shift_mm;
  const auto inwards = surface.Intersect(point, -normal, 0, reach);
  if (inwards) return point - inwards->distance * normal;
  if (outwards) return point + outwards->distance * normal;
  return std::nullopt;
}

}  // namespace

std::array<std::array<float, 256>, 3> LevelsWithGain(const Eigen::Vector3d& gain) {
  std::array<std::array<float, 256>, 3> levels;
  for (int c = 0; c < 3; ++c) {
    for (int v = 0; v < 256; ++v) {
      const auto level = static_cast<float>(v);
      // Exactly itself without a gain: such captures keep their bytes.
      levels[static_cast<size_t>(c)][static_cast<size_t>(v)] =
          gain[c] == 1
              ? level
              : 255 * SrgbFromLinear(LinearFromSrgb(level / 255) / static_cast<float>(gain[c]));
    }
  }
  return levels;
}

PhotoPixels MakePhotoPixels(const Image& picture, const std::vector<PixelUse>& usable,
                            const Camera& camera, const std::string& file) {
  if (picture.width() != camera.width || picture.height() != camera.height) {
    throw Error(file + ": is " + std::to_string(picture.width()) + " x " +
                std::to_string(picture.height()) + " pixels, but its camera has " +
                std::to_string(camera.width) + " x " + std::to_string(camera.height) +
                "; do not crop or scale photographs");
  }
  const Image coded = picture.type() == PixelType::kUint8 ? picture : ToSrgb8(picture);
  const int channels = coded.channels();
  const std::array<int, 3> from =
      channels >= 3 ? std::array<int, 3>{0, 1, 2} : std::array<int, 3>{0, 0, 0};
  PhotoPixels photo;
  photo.width = coded.width();
  photo.height = coded.height();
  photo.rgbu.resize(4 * usable.size());
  const uint8_t* in = coded.Data<uint8_t>();
  for (size_t i = 0; i < usable.size(); ++i) {
    for (size_t c = 0; c < 3; ++c) photo.rgbu[4 * i + c] = in[i * channels + from[c]];
    photo.rgbu[4 * i + 3] = static_cast<uint8_t>(usable[i]);
  }
  return photo;
}

std::optional<BilinearTap> TapAt(int width, int height, const Eigen::Vector2d& pixel) {
  const bool inside = width >= 2 && height >= 2 && pixel.x() >= 0 && pixel.y() >= 0 &&
                      pixel.x() <= width - 1 && pixel.y() <= height - 1;
  if (!inside) return std::nullopt;
  BilinearTap tap;
  tap.x = std::min(static_cast<int>(pixel.x()), width - 2);
  tap.y = std::min(static_cast<int>(pixel.y()), height - 2);
  tap.fx = static_cast<float>(pixel.x() - tap.x);
  tap.fy = static_cast<float>(pixel.y() - tap.y);
  return tap;
}

std::vector<Eigen::Vector3d> PatchPoints(const TriangleMesh& mesh, int triangle, int edge_samples,
                                         SampleOn sample_on, const RayScene& surface,
                                         double max_shift_mm) {
  const Eigen::Vector3i& corners = mesh.triangles[static_cast<size_t>(triangle)];
  const auto mix = [&](const std::vector<Eigen::Vector3d>& of, const Eigen::Vector3d& weights) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (int c = 0; c < 3; ++c) sum += weights[c] * of[static_cast<size_t>(corners[c])];
    return sum;
  };
  std::vector<Eigen::Vector3d> points;
  points.reserve(static_cast<size_t>(PatchSampleCount(edge_samples)));
  for (int j = 0; j < edge_samples; ++j) {
    for (int i = 0; i + j < edge_samples; ++i) {
      const Eigen::Vector3d weights = PatchSampleWeights(edge_samples, i, j);
      Eigen::Vector3d point = mix(mesh.vertices, weights);
      if (sample_on == SampleOn::kSurface) {
        const Eigen::Vector3d normal = mix(mesh.normals, weights);
        const double length = normal.norm();
        if (length > 0) {
          point = CrossingAlong(surface, point, normal / length, max_shift_mm).value_or(point);
        }
      }
      points.push_back(point);
    }
  }
  return points;
}

std::optional<PixelReading> ReadBilinear(const PhotoPixels& photo, const Eigen::Vector2d& pixel) {
  const auto tap = TapAt(photo.width, photo.height, pixel);
  if (!tap) return std::nullopt;
  const std::array<const uint8_t*, 4> pixels = {
      photo.At(tap->x, tap->y), photo.At(tap->x + 1, tap->y), photo.At(tap->x, tap->y + 1),
      photo.At(tap->x + 1, tap->y + 1)};
  const std::array<float, 4> weights = {(1 - tap->fx) * (1 - tap->fy), tap->fx * (1 - tap->fy),
                                        (1 - tap->fx) * tap->fy, tap->fx * tap->fy};
  PixelReading reading;
  for (size_t k = 0; k < 4; ++k) {
    if (weights[k] > 0) reading.use = std::min(reading.use, static_cast<PixelUse>(pixels[k][3]));
  }
  for (size_t c = 0; c < 3; ++c) {
    reading.level[c] = 0;
    reading.saturated[c] = false;
    for (size_t k = 0; k < 4; ++k) {
      reading.level[c] += weights[k] * photo.levels[c][pixels[k][c]];
      reading.saturated[c] = reading.saturated[c] || (weights[k] > 0 && pixels[k][c] == 255);
    }
  }
  return reading;
}

SampledView UnknownView(size_t samples) {
  SampledView view;
  view.values.assign(3 * samples, 0);
  view.knowledge.assign(3 * samples, Knowledge::kMissing);
  return view;
}

void SetSample(SampledView& view, size_t sample, const PixelReading& reading) {
  constexpr float kScale = static_cast<float>(LightField::kOne) / 255;
  if (reading.use != PixelUse::kData) return;
  view.data_samples += 1;
  for (size_t c = 0; c < 3; ++c) {
    view.values[3 * sample + c] =
        static_cast<uint16_t>(std::min(reading.level[c] * kScale + 0.5F, 65535.0F));
    view.knowledge[3 * sample + c] =
        reading.saturated[c] ? Knowledge::kLowerBound : Knowledge::kData;
  }
}

void HideSample(SampledView& view, size_t sample) {
  const auto begin = view.knowledge.begin() + static_cast<std::ptrdiff_t>(3 * sample);
  view.data_samples -= *begin != Knowledge::kMissing ? 1 : 0;
  view.hidden_samples += 1;
  std::fill_n(begin, 3, Knowledge::kMissing);
}

SampledView SampleView(const PhotoPixels& photo, const Camera& camera,
                       const Pose& camera_from_world, const std::vector<Eigen::Vector3d>& points) {
  SampledView view = UnknownView(points.size());
  for (size_t s = 0; s < points.size(); ++s) {
    const auto pixel = Project(camera, camera_from_world * points[s]);
    const auto reading = pixel ? ReadBilinear(photo, *pixel) : std::nullopt;
    if (!reading || reading->use == PixelUse::kForbidden) {
      HideSample(view, s);
    } else {
      SetSample(view, s, *reading);
    }
  }
  return view;
}

}  // namespace lfm
