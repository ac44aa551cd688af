// SPDX-License-Identifier: BSD-3-Clause
// Gray decoding against OpenCV's structured_light, on the same 42 frames in memory: 1024 x 768
// columns and rows with inverses, white and black, seen by a 640 x 480 camera. The scene is made
// here: a wavy surface and a box in front of it, textured paint, a shadow beside the box, a corner
// that the projector does not reach, defocus, photon and read noise, 8-bit sRGB levels. Truth is
// the projector column and row at each pixel's centre.
//
// Both decode all pixels. OpenCV's rejects by its own rules (its shadow threshold of 40 levels
// between white and black, as its decode() does, and 5 between pattern and inverse). A pixel is
// wrong when it is decoded more than 3/4 of a projector pixel, in column or row, from everything
// lit that it sees (whole-pixel answers are right up to 1/2); missed when its centre is lit and it
// is not decoded. Pixels on depth edges and shadow borders count as well. Times are the least of
// several runs that alternate: CPU seconds of one thread, and, since Decode takes columns and rows
// in parallel while OpenCV has no parallel form, time on the clock with all threads. Run
// build/release/bench/lfm-bench-scan.
#include <malloc.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <opencv2/structured_light.hpp>
#include <random>
#include <vector>

#include "core/image.h"
#include "core/parallel.h"
#include "scan/decode.h"

namespace lfm {
namespace {

constexpr int kWidth = 640, kHeight = 480;
constexpr int kProjectorWidth = 1024, kProjectorHeight = 768;
constexpr double kDefocusPx = 0.6, kFullWell = 8000, kReadNoise = 10;
constexpr int kRuns = 25;

double Seconds(clockid_t clock) {
  timespec t{};
  clock_gettime(clock, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

/// What a camera ray meets.
struct Place {
  double column = 0, row = 0;
  double albedo = 0;
  bool lit = false;
};

Place SceneAt(double x, double y) {
  Place p;
  const bool box = x > 230 && x < 410 && y > 150 && y < 350;
  const bool shadow = !box && x > 190 && x <= 230 && y > 150 && y < 350;
  const double disparity = box ? 130 : 60 + 14 * std::sin(x / 47) * std::cos(y / 61);
  p.column = 1.35 * x + 0.06 * y + disparity - 20;
  p.row = 1.42 * y - 0.04 * x + 45;
  p.albedo = 0.45 + 0.3 * std::sin(x / 9.0) * std::sin(y / 13.0);
  p.lit = !shadow && p.column >= -0.5 && p.column < kProjectorWidth - 0.5 && p.row >= -0.5 &&
          p.row < kProjectorHeight - 0.5 && x + y > 160;
  return p;
}

/// A pattern along its axis, blurred by the projector's lens, at `kFine` places a pixel.
constexpr int kFine = 8;
std::vector<double> BlurredProfile(const PatternSequence& sequence, const Pattern& pattern,
                                   PatternAxis axis) {
  const int size = axis == PatternAxis::kColumn ? kProjectorWidth : kProjectorHeight;
  std::vector<double> value(static_cast<size_t>(size)), profile(value.size() * kFine, 0);
  for (int i = 0; i < size; ++i) {
    value[static_cast<size_t>(i)] = axis == PatternAxis::kColumn
                                        ? PatternValue(sequence, pattern, i, 0)
                                        : PatternValue(sequence, pattern, 0, i);
  }
  const double scale = 1 / (kDefocusPx * std::sqrt(2.0));
  for (int i = 0; i < size * kFine; ++i) {
    const double at = (i + 0.5) / kFine;
    for (int k = std::max(0, i / kFine - 4); k <= std::min(size - 1, i / kFine + 4); ++k) {
      const double weight = 0.5 * (std::erf((k + 1 - at) * scale) - std::erf((k - at) * scale));
      profile[static_cast<size_t>(i)] += weight * value[static_cast<size_t>(k)];
    }
  }
  return profile;
}

constexpr int kSide = 4;  // samples along a pixel's side

/// Places at the pixels' centres, and kSide x kSide in each pixel.
struct Truth {
  std::vector<Place> centers, samples;
};

Truth MakeTruth() {
  Truth truth;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      truth.centers.push_back(SceneAt(x, y));
      for (int s = 0; s < kSide * kSide; ++s) {
        truth.samples.push_back(
            SceneAt(x - 0.5 + (s % kSide + 0.5) / kSide, y - 0.5 + (s / kSide + 0.5) / kSide));
      }
    }
  }
  return truth;
}

std::vector<Image> RenderFrames(const PatternSequence& sequence, const Truth& truth) {
  const std::vector<Place>& samples = truth.samples;
  std::vector<Image> frames;
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  for (const Pattern& pattern : sequence.patterns) {
    const bool columns = pattern.axis == PatternAxis::kColumn;
    const std::vector<double> profile = BlurredProfile(sequence, pattern, pattern.axis);
    Image linear(kWidth, kHeight, 1, PixelType::kFloat32, ColorEncoding::kLinear);
    for (size_t p = 0; p < truth.centers.size(); ++p) {
      double sum = 0;
      for (size_t s = p * kSide * kSide; s < (p + 1) * kSide * kSide; ++s) {
        sum += 0.015 * samples[s].albedo;
        if (!samples[s].lit) continue;
        const double at = ((columns ? samples[s].column : samples[s].row) + 0.5) * kFine;
        sum += samples[s].albedo * profile[std::min(profile.size() - 1, static_cast<size_t>(at))];
      }
      const double value = sum / (kSide * kSide);
      const double noise = std::sqrt(value / kFullWell + std::pow(kReadNoise / kFullWell, 2));
      linear.Data<float>()[p] = static_cast<float>(value + noise * normal(random));
    }
    frames.push_back(ToSrgb8(linear));
  }
  return frames;
}

struct Count {
  int decoded = 0, wrong = 0, missed = 0, right = 0;
  double square = 0;  ///< of the columns of what is right and lit at its centre
};

void Score(const Truth& truth, size_t p, bool decoded, double column, double row, Count& count) {
  if (!decoded) {
    count.missed += truth.centers[p].lit ? 1 : 0;
    return;
  }
  ++count.decoded;
  bool right = false;
  for (size_t s = p * kSide * kSide; s < (p + 1) * kSide * kSide; ++s) {
    const Place& seen = truth.samples[s];
    right |= seen.lit && std::abs(column - seen.column) <= 0.75 && std::abs(row - seen.row) <= 0.75;
  }
  count.wrong += right ? 0 : 1;
  if (right && truth.centers[p].lit) {
    count.right += 1;
    count.square += std::pow(column - truth.centers[p].column, 2);
  }
}

void Print(const char* who, double seconds, const Count& c) {
  std::printf("%-28s %8.2f ms  %d decoded, %d wrong, %d missed, column error %.3f px RMS\n", who,
              1e3 * seconds, c.decoded, c.wrong, c.missed,
              std::sqrt(c.square / std::max(1, c.right)));
}

int Main() {
  // A program that decodes one scan after the other keeps its memory; new pages from the system
  // would cost more than decoding.
  mallopt(M_MMAP_THRESHOLD, 1 << 30);
  mallopt(M_TRIM_THRESHOLD, 1 << 30);
  PatternOptions options;
  options.scheme = PatternScheme::kGray;
  const PatternSequence sequence =
      MakePatternSequence(kProjectorWidth, kProjectorHeight, PatternRows::kWith, options);
  const Truth truth = MakeTruth();
  const size_t pixels = truth.centers.size();
  const std::vector<Image> frames = RenderFrames(sequence, truth);
  // White and black stand first here; OpenCV wants the pairs alone.
  std::vector<cv::Mat> pairs;
  for (size_t i = 2; i < frames.size(); ++i) {
    pairs.emplace_back(kHeight, kWidth, CV_8UC1, const_cast<uint8_t*>(frames[i].Data<uint8_t>()));
  }
  cv::structured_light::GrayCodePattern::Params params;
  params.width = kProjectorWidth;
  params.height = kProjectorHeight;
  const auto peer = cv::structured_light::GrayCodePattern::create(params);

  double ours = 1e9, theirs = 1e9, ours_on_clock = 1e9, theirs_on_clock = 1e9;
  DecodedPixels decoded;
  std::vector<cv::Point> found(pixels);
  std::vector<uint8_t> failed(pixels);
  for (int run = 0; run < kRuns; ++run) {
    SetThreadCount(0);
    double clock = Seconds(CLOCK_MONOTONIC);
    decoded = Decode(sequence, frames, {});
    ours_on_clock = std::min(ours_on_clock, Seconds(CLOCK_MONOTONIC) - clock);
    SetThreadCount(1);
    double start = Seconds(CLOCK_THREAD_CPUTIME_ID);
    decoded = Decode(sequence, frames, {});
    ours = std::min(ours, Seconds(CLOCK_THREAD_CPUTIME_ID) - start);
    start = Seconds(CLOCK_THREAD_CPUTIME_ID);
    clock = Seconds(CLOCK_MONOTONIC);
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        const size_t p = static_cast<size_t>(y) * kWidth + x;
        failed[p] = peer->getProjPixel(pairs, x, y, found[p]) ? 1 : 0;
      }
    }
    theirs = std::min(theirs, Seconds(CLOCK_THREAD_CPUTIME_ID) - start);
    theirs_on_clock = std::min(theirs_on_clock, Seconds(CLOCK_MONOTONIC) - clock);
  }
  Count our_count, their_count;
  constexpr int kPeersShadowLevels = 40;
  for (size_t p = 0; p < pixels; ++p) {
    Score(truth, p, decoded.column.confidence[p] > 0 && decoded.row.confidence[p] > 0,
          decoded.column.position[p], decoded.row.position[p], our_count);
    const int swing = frames[0].Data<uint8_t>()[p] - frames[1].Data<uint8_t>()[p];
    Score(truth, p, !failed[p] && swing > kPeersShadowLevels, found[p].x, found[p].y, their_count);
  }
  std::printf("Gray code, %zu frames of %d x %d; CPU time of one thread\n", frames.size(), kWidth,
              kHeight);
  Print("lfm::Decode", ours, our_count);
  Print("OpenCV getProjPixel", theirs, their_count);
  std::printf("ratio %.1f in CPU time, %.1f on the clock (aim 30); wrong %d against %d\n",
              theirs / ours, theirs_on_clock / ours_on_clock, our_count.wrong, their_count.wrong);
  return 0;
}

}  // namespace
}  // namespace lfm

int main() { return lfm::Main(); }
