// SPDX-License-Identifier: BSD-3-Clause
#include "sample_data/environment_light.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <string>

#include "core/error.h"
#include "sample_data/lanes/lane_convert.h"
#include "sample_data/lanes/lane_lights.h"

namespace lfm {
namespace {

using V3f = Eigen::Vector3f;

constexpr float kPi = std::numbers::pi_v<float>;

float Luminance(const V3f& c) { return 0.2126f * c.x() + 0.7152f * c.y() + 0.0722f * c.z(); }

V3f PixelOf(const Image& image, int x, int y) {
  const float* p = &image.At<float>(x, y);
  return {p[0], p[1], p[2]};
}

void RequireRadiance(const Image& image, float gain, const std::string& where) {
  if (image.empty() || image.type() != PixelType::kFloat32 || image.channels() < 3) {
    throw Error(where + ": an environment must be a float RGB picture; give an .hdr or .exr file");
  }
  double sum = 0;
  for (int y = 0; y < image.height(); ++y) {
    for (int x = 0; x < image.width(); ++x) {
      for (int c = 0; c < 3; ++c) {
        const float value = gain * image.At<float>(x, y, c);
        if (!std::isfinite(value) || value < 0) {
          throw Error(where + ": the environment's pixel (" + std::to_string(x) + ", " +
                      std::to_string(y) + ") with its gain is " + std::to_string(value) +
                      "; radiance must be finite and not negative");
        }
        sum += value;
      }
    }
  }
  if (!(sum > 0)) throw Error(where + ": the environment is black everywhere; give one with light");
}

void Accumulate(const std::vector<double>& weights, float* cumulative) {
  double total = 0;
  for (double w : weights) total += w;
  double sum = 0;
  cumulative[0] = 0;
  for (size_t i = 0; i < weights.size(); ++i) {
    sum += weights[i];
    cumulative[i + 1] = total > 0 ? static_cast<float>(sum / total) : 0;
  }
  if (total > 0) cumulative[weights.size()] = 1;
}

}  // namespace

Eigen::Vector2f EnvironmentPixel(const V3f& direction, int width, int height) {
  const float azimuth = std::atan2(direction.y(), direction.x());
  const float polar = std::atan2(std::hypot(direction.x(), direction.y()), direction.z());
  return {(0.5f - azimuth / (2 * kPi)) * static_cast<float>(width) - 0.5f,
          polar / kPi * static_cast<float>(height) - 0.5f};
}

V3f EnvironmentDirection(const Eigen::Vector2f& pixel, int width, int height) {
  const float azimuth = kPi * (1 - 2 * (pixel.x() + 0.5f) / static_cast<float>(width));
  const float polar = kPi * (pixel.y() + 0.5f) / static_cast<float>(height);
  return {std::sin(polar) * std::cos(azimuth), std::sin(polar) * std::sin(azimuth),
          std::cos(polar)};
}

EnvironmentLight::EnvironmentLight(const Lighting& room, const EnvironmentMap& map) {
  tables_.room_is_black = room.sky.isZero(0) && room.wall.isZero(0) && room.ground.isZero(0);
  for (int c = 0; c < 3; ++c) {
    tables_.sky[c] = room.sky[c];
    tables_.wall[c] = room.wall[c];
    tables_.ground[c] = room.ground[c];
  }
  if (map.image == nullptr) return;
  if (!(map.gain > 0) || !std::isfinite(map.gain)) {
    throw Error("the environment map's gain must be positive; leave the map out for none");
  }
  RequireRadiance(*map.image, map.gain, "environment map");
  const int width = map.image->width(), height = map.image->height();
  if (map.image->size() > static_cast<size_t>(std::numeric_limits<int32_t>::max())) {
    throw Error("the environment map has more than 700 million pixels; make it smaller");
  }
  pixels_.reserve(3 * static_cast<size_t>(width) * height);
  std::vector<double> luminance;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const V3f d =
          EnvironmentDirection({static_cast<float>(x), static_cast<float>(y)}, width, height);
      const V3f pixel = PixelOf(*map.image, x, y);
      pixels_.insert(pixels_.end(), pixel.data(), pixel.data() + 3);
      luminance.push_back(Luminance(map.gain * pixel +
                                    (tables_.room_is_black ? V3f(0, 0, 0) : room.Environment(d))));
    }
  }
  tables_.width = width;
  tables_.height = height;
  tables_.gain = map.gain;
  Tabulate(luminance);
  tables_.pixels = pixels_.data();
  tables_.rows = rows_.data();
  tables_.columns = columns_.data();
  tables_.density = density_.data();
}

void EnvironmentLight::Tabulate(const std::vector<double>& luminance) {
  const int width = tables_.width, height = tables_.height;
  // Mean over a pixel of the bilinear interpolant: 1/8, 3/4, 1/8 along each axis.
  rows_.resize(height + 1);
  columns_.resize(static_cast<size_t>(height) * (width + 1));
  density_.resize(luminance.size());
  const auto band = [height](int y) {
    return std::cos(std::numbers::pi * y / height) - std::cos(std::numbers::pi * (y + 1) / height);
  };
  std::vector<double> row_weights(height), weights(width);
  for (int y = 0; y < height; ++y) {
    row_weights[y] = 0;
    for (int x = 0; x < width; ++x) {
      double mean = 0;
      for (int dy = -1; dy <= 1; ++dy) {
        const double* row =
            &luminance[static_cast<size_t>(std::clamp(y + dy, 0, height - 1)) * width];
        const double line =
            0.75 * row[x] + 0.125 * (row[(x + 1) % width] + row[(x + width - 1) % width]);
        mean += (dy == 0 ? 0.75 : 0.125) * line;
      }
      weights[x] = mean * band(y);
      row_weights[y] += weights[x];
    }
    Accumulate(weights, &columns_[static_cast<size_t>(y) * (width + 1)]);
  }
  Accumulate(row_weights, rows_.data());
  for (int y = 0; y < height; ++y) {
    const float* columns = &columns_[static_cast<size_t>(y) * (width + 1)];
    for (int x = 0; x < width; ++x) {
      // From the cumulative sums as they are stored, since these are what Draw follows.
      const double probability = (rows_[y + 1] - rows_[y]) * (columns[x + 1] - columns[x]);
      density_[static_cast<size_t>(y) * width + x] =
          static_cast<float>(probability * width / (2 * std::numbers::pi * band(y)));
    }
  }
}

V3f EnvironmentLight::Radiance(const V3f& direction) const {
  return FromLane(EnvironmentRadiance(tables_, ToLane(direction)));
}

EnvironmentLight::Sample EnvironmentLight::Draw(float u1, float u2) const {
  const EnvironmentSample<float> drawn = DrawEnvironment<float>(tables_, u1, u2);
  return {FromLane(drawn.direction), FromLane(EnvironmentRadiance(tables_, drawn.direction)),
          drawn.density};
}

float EnvironmentLight::Density(const V3f& direction) const {
  return EnvironmentDensity(tables_, ToLane(direction));
}

EnvironmentMap MakeStudioEnvironment(int width) {
  if (width < 8) throw Error("a studio environment needs a width of 8 pixels at least");
  const int height = width / 2;
  Image image(width, height, 3, PixelType::kFloat32, ColorEncoding::kLinear);
  const auto soft = [](float x, float half, float edge) {
    const float t = std::clamp((half + edge - std::abs(x)) / (2 * edge), 0.0f, 1.0f);
    return t * t * (3 - 2 * t);
  };
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const V3f d =
          EnvironmentDirection({static_cast<float>(x), static_cast<float>(y)}, width, height);
      const float azimuth = std::atan2(d.y(), d.x());
      const float up = 0.5f * (1 + d.z());
      V3f value = (1 - up) * V3f(0.05f, 0.045f, 0.04f) + up * V3f(0.42f, 0.45f, 0.50f);
      // A warm wall behind.
      value += 0.35f * std::pow(0.5f * (1 + std::cos(azimuth - 1.7f)), 3.0f) *
               soft(d.z() - 0.1f, 0.35f, 0.25f) * V3f(1, 0.72f, 0.45f);
      // The softbox overhead, on a ceiling at height 1.
      if (d.z() > 0.2f) {
        const float bx = d.x() / d.z() + 0.35f, by = d.y() / d.z() + 0.25f;
        value += 7 * soft(bx, 0.42f, 0.04f) * soft(by, 0.34f, 0.04f) * V3f(1, 0.97f, 0.93f);
      }
      // Two strips and a window of four panes.
      const auto beside = [&](float at) { return std::remainder(azimuth - at, 2 * kPi); };
      const float elevation = std::asin(std::clamp(d.z(), -1.0f, 1.0f));
      value += 9 * soft(beside(-2.35f), 0.09f, 0.02f) * soft(elevation - 0.45f, 0.42f, 0.03f) *
               V3f(1, 0.94f, 0.86f);
      value += 5 * soft(beside(2.75f), 0.07f, 0.02f) * soft(elevation - 0.4f, 0.4f, 0.03f) *
               V3f(0.95f, 0.97f, 1);
      const float panes =
          (1 - soft(beside(-0.55f), 0.015f, 0.01f)) * (1 - soft(elevation - 0.5f, 0.015f, 0.01f));
      value += 3.2f * panes * soft(beside(-0.55f), 0.3f, 0.02f) *
               soft(elevation - 0.5f, 0.3f, 0.02f) * V3f(0.78f, 0.9f, 1.1f);
      for (int c = 0; c < 3; ++c) image.At<float>(x, y, c) = value[c];
    }
  }
  return {std::make_shared<const Image>(std::move(image)), 1};
}

EnvironmentMap ReadEnvironmentMap(const std::filesystem::path& file, float gain) {
  Image image = ReadImage(file);
  RequireRadiance(image, gain, file.string());
  return {std::make_shared<const Image>(std::move(image)), gain};
}

}  // namespace lfm
