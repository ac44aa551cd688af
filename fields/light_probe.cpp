// SPDX-License-Identifier: BSD-3-Clause
#include "fields/light_probe.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "core/error.h"

namespace lfm {
namespace {

constexpr int kMostColumns = 2048;
constexpr double kPi = std::numbers::pi;

// Where the cells of one division of [0, 1] lie in another: cell, and the share of it in units of
// `measure`, which grows from 0 to 1.
struct Overlap {
  int cell;
  double measure;
};
template <typename Measure>
std::vector<std::vector<Overlap>> Overlaps(int to, int from, const Measure& measure) {
  std::vector<std::vector<Overlap>> overlaps(static_cast<size_t>(to));
  for (int i = 0; i < to; ++i) {
    const double begin = static_cast<double>(i) / to, end = static_cast<double>(i + 1) / to;
    for (int j = static_cast<int>(begin * from); j < from; ++j) {
      const double low = std::max(begin, static_cast<double>(j) / from);
      const double high = std::min(end, static_cast<double>(j + 1) / from);
      if (low >= end) break;
      if (high > low) overlaps[i].push_back({j, measure(high) - measure(low)});
    }
  }
  return overlaps;
}

double PolarMeasure(double v) { return 0.5 * (1 - std::cos(kPi * v)); }

// Radiance times solid angle in cells of rows x columns: [row][column][channel].
std::vector<double> EnergyOn(const Image& picture, int rows, int columns) {
  const auto vertical = Overlaps(rows, picture.height(), PolarMeasure);
  const auto horizontal = Overlaps(columns, picture.width(), [](double u) { return u; });
  const bool gray = picture.channels() < 3;
  std::vector<double> energy(static_cast<size_t>(rows) * columns * 3);
  std::vector<double> line(static_cast<size_t>(picture.width()) * 3);
  for (int y = 0; y < rows; ++y) {
    std::fill(line.begin(), line.end(), 0.0);
    for (const Overlap& band : vertical[y]) {
      for (int x = 0; x < picture.width(); ++x) {
        for (int c = 0; c < 3; ++c) {
          line[3 * x + c] += 4 * kPi * band.measure * picture.At<float>(x, band.cell, gray ? 0 : c);
        }
      }
    }
    for (int x = 0; x < columns; ++x) {
      double* out = &energy[(static_cast<size_t>(y) * columns + x) * 3];
      for (const Overlap& stretch : horizontal[x]) {
        for (int c = 0; c < 3; ++c) out[c] += stretch.measure * line[3 * stretch.cell + c];
      }
    }
  }
  return energy;
}

void RequireRadiance(const Image& picture, const std::string& name) {
  if (picture.empty() || picture.type() != PixelType::kFloat32 ||
      picture.encoding() != ColorEncoding::kLinear) {
    throw Error(name + ": light is measured in linear float pictures; give an .hdr or .exr file");
  }
  const int colors = picture.channels() < 3 ? 1 : 3;
  for (int y = 0; y < picture.height(); ++y) {
    for (int x = 0; x < picture.width(); ++x) {
      for (int c = 0; c < colors; ++c) {
        const float value = picture.At<float>(x, y, c);
        if (!std::isfinite(value) || value < 0) {
          throw Error(name + ": pixel (" + std::to_string(x) + ", " + std::to_string(y) + ") is " +
                      std::to_string(value) + "; radiance must be finite and not negative");
        }
      }
    }
  }
}

}  // namespace

Eigen::Vector3d ProbeDirection(double u, double v) {
  const double azimuth = 2 * kPi * (0.5 - u), polar = kPi * v;
  return {std::sin(polar) * std::cos(azimuth), std::sin(polar) * std::sin(azimuth),
          std::cos(polar)};
}

LightProbe MakeLightProbe(const Image& picture, const std::string& name) {
  RequireRadiance(picture, name);
  LightProbe probe;
  probe.columns = std::min(picture.width(), kMostColumns);
  const std::vector<double> rows = EnergyOn(picture, kProbeRows, probe.columns);
  probe.sums.reserve(static_cast<size_t>(kProbeRows) * (probe.columns + 1) * 3);
  for (int y = 0; y < kProbeRows; ++y) {
    double sum[3] = {};
    probe.sums.insert(probe.sums.end(), sum, sum + 3);
    for (int x = 0; x < probe.columns; ++x) {
      for (int c = 0; c < 3; ++c) {
        sum[c] += rows[(static_cast<size_t>(y) * probe.columns + x) * 3 + c];
      }
      probe.sums.insert(probe.sums.end(), sum, sum + 3);
    }
  }
  // Fine enough that pixels of coarse pictures do not fall into a cell as a whole.
  constexpr int kColumns = 512, kRows = 256;
  const std::vector<double> pixels = EnergyOn(picture, kRows, kColumns);
  for (int y = 0; y < kRows; ++y) {
    const double band =
        PolarMeasure((y + 1.0) / kRows) - PolarMeasure(static_cast<double>(y) / kRows);
    for (int x = 0; x < kColumns; ++x) {
      const double* energy = &pixels[(static_cast<size_t>(y) * kColumns + x) * 3];
      probe.direction.push_back(
          ProbeDirection((x + 0.5) / kColumns, (y + 0.5) / kRows).cast<float>());
      probe.solid_angle.push_back(static_cast<float>(4 * kPi * band / kColumns));
      probe.energy.push_back(Eigen::Vector3d(energy[0], energy[1], energy[2]).cast<float>());
    }
  }
  return probe;
}

LightProbe ReadLightProbe(const std::filesystem::path& file) {
  return MakeLightProbe(ReadImage(file, ColorEncoding::kLinear), file.string());
}

}  // namespace lfm
