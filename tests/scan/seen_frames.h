// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "core/image.h"
#include "scan/decode.h"

namespace lfm::testing {

/// How a camera sees a slanted wall under the projector. Pixel (x, y) sees column
/// first + slope x + shear y, averaged over `slope` projector columns and blurred.
struct View {
  int width = 96, height = 64;
  double first = 20.3, slope = 1.35, shear = 0.37;
  double light = 0.6, ambient = 0.02;
  double blur_px = 0.4;  ///< Gaussian: defocus, or light that spreads in the material
  double gamma = 1;      ///< the projector shows a value to this power
  double crosstalk = 0;  ///< share that leaks between the three frames of one colour picture
  double bounced = 0;    ///< of the direct light: share of the picture's mean that comes as well
  double full_well = 20000, read_noise = 5;  ///< electrons; 0: no noise and float frames
  unsigned seed = 1;

  double Column(int x, int y) const { return first + slope * x + shear * y; }
};

/// What the projector really sends through each of its columns.
inline std::vector<std::vector<double>> SentProfiles(const PatternSequence& sequence,
                                                     const View& view) {
  std::vector<std::vector<double>> sent;
  std::vector<size_t> colored;
  for (size_t f = 0; f < sequence.patterns.size(); ++f) {
    const Pattern& pattern = sequence.patterns[f];
    std::vector<double>& out = sent.emplace_back();
    for (int i = 0; i < sequence.projector_width; ++i) {
      out.push_back(std::pow(PatternValue(sequence, pattern, i, 0), view.gamma));
    }
    if (pattern.kind != PatternKind::kWhite && pattern.kind != PatternKind::kBlack) {
      colored.push_back(f);
    }
  }
  for (size_t g = 0; view.crosstalk > 0 && g + 2 < colored.size(); g += 3) {
    for (size_t i = 0; i < sent[0].size(); ++i) {
      double sum = 0;
      for (size_t k = 0; k < 3; ++k) sum += sent[colored[g + k]][i];
      for (size_t k = 0; k < 3; ++k) {
        double& own = sent[colored[g + k]][i];
        own = (1 - 3 * view.crosstalk) * own + view.crosstalk * sum;
      }
    }
  }
  return sent;
}

/// Share of column k's square in a pixel at `column`: box of `slope` and Gaussian blur.
inline double PixelShare(double column, int k, const View& view) {
  constexpr int kSteps = 9;
  const double scale = 1 / (std::max(view.blur_px, 1e-3) * std::sqrt(2.0));
  double share = 0;
  for (int s = 0; s < kSteps; ++s) {
    const double at = column + view.slope * ((s + 0.5) / kSteps - 0.5) - k;
    share += 0.5 * (std::erf((at + 0.5) * scale) - std::erf((at - 0.5) * scale)) / kSteps;
  }
  return share;
}

/// Frames of the view: 8-bit sRGB with noise, or linear float without.
inline std::vector<Image> SeenFrames(const PatternSequence& sequence, const View& view) {
  const std::vector<std::vector<double>> sent = SentProfiles(sequence, view);
  const size_t pixels = static_cast<size_t>(view.width) * view.height;
  std::vector<std::vector<std::pair<int, double>>> shares(pixels);
  const int reach = static_cast<int>(std::ceil(view.slope / 2 + 4 * view.blur_px)) + 1;
  for (size_t p = 0; p < pixels; ++p) {
    const double column =
        view.Column(static_cast<int>(p) % view.width, static_cast<int>(p) / view.width);
    const int middle = static_cast<int>(std::lround(column));
    for (int k = middle - reach; k <= middle + reach; ++k) {
      if (k < 0 || k >= sequence.projector_width) continue;
      shares[p].emplace_back(k, PixelShare(column, k, view));
    }
  }
  std::vector<Image> frames;
  std::mt19937 random(view.seed);
  std::normal_distribution<double> normal;
  for (const std::vector<double>& profile : sent) {
    double mean = 0;
    for (const double v : profile) mean += v / static_cast<double>(profile.size());
    Image linear(view.width, view.height, 1, PixelType::kFloat32, ColorEncoding::kLinear);
    for (size_t p = 0; p < pixels; ++p) {
      double value = view.bounced * mean;
      for (const auto& [k, share] : shares[p]) value += share * profile[static_cast<size_t>(k)];
      value = view.ambient + view.light * value;
      if (view.full_well > 0) {
        const double variance =
            value / view.full_well + std::pow(view.read_noise / view.full_well, 2);
        value += std::sqrt(variance) * normal(random);
      }
      linear.Data<float>()[p] = static_cast<float>(value);
    }
    frames.push_back(view.full_well > 0 ? ToSrgb8(linear) : linear);
  }
  return frames;
}

/// Errors of decoded columns against the view.
struct ColumnErrors {
  double rms = 0;         ///< projector pixels, of those less than 1 pixel off
  double normalized = 0;  ///< mean of (error / sigma)^2
  double coverage = 0;    ///< decoded, of all
  double wrong = 0;       ///< more than 1 pixel off, of those decoded
};

inline ColumnErrors CompareColumns(const DecodedPixels& decoded, const View& view) {
  ColumnErrors errors;
  double count = 0, right = 0;
  const size_t pixels = decoded.column.position.size();
  for (size_t p = 0; p < pixels; ++p) {
    if (decoded.column.confidence[p] <= 0) continue;
    count += 1;
    const double error = decoded.column.position[p] - view.Column(static_cast<int>(p) % view.width,
                                                                  static_cast<int>(p) / view.width);
    if (!(std::abs(error) < 1)) {
      errors.wrong += 1;
      continue;
    }
    right += 1;
    errors.rms += error * error;
    errors.normalized += std::pow(error / decoded.column.sigma[p], 2);
  }
  errors.rms = std::sqrt(errors.rms / std::max(1.0, right));
  errors.normalized /= std::max(1.0, right);
  errors.wrong /= std::max(1.0, count);
  errors.coverage = count / static_cast<double>(pixels);
  return errors;
}

}  // namespace lfm::testing
