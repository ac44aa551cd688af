// SPDX-License-Identifier: BSD-3-Clause
#include "scan/decode.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <string>

#include "core/error.h"
#include "tests/scan/synthetic_rig.h"

namespace lfm {
namespace {

using testing::HitPlate;
using testing::KnownRig;
using testing::RenderScan;
using testing::RenderSettings;
using testing::TiltedPlatform;

FrameLoader FromMemory(const std::vector<Image>& frames) {
  return [&frames](int index) { return frames[static_cast<size_t>(index)]; };
}

/// Linear float frames of a strip whose pixel i sees projector column `columns[i]` exactly, the
/// cosine taken at the continuous column so that positions have a closed form.
std::vector<Image> StripFrames(const PatternSequence& sequence, const std::vector<double>& columns,
                               double light, double ambient) {
  std::vector<Image> frames;
  for (const Pattern& pattern : sequence.patterns) {
    Image image(static_cast<int>(columns.size()), 1, 1, PixelType::kFloat32,
                ColorEncoding::kLinear);
    for (size_t i = 0; i < columns.size(); ++i) {
      double value = PatternValue(sequence, pattern, columns[i], 0);
      if (pattern.kind == PatternKind::kPhase) {
        value = 0.5 + 0.5 * std::cos(2 * std::numbers::pi *
                                     (columns[i] / sequence.phase_period_px -
                                      static_cast<double>(pattern.index) / sequence.phase_steps));
      }
      image.Data<float>()[i] = static_cast<float>(ambient + light * value);
    }
    frames.push_back(image);
  }
  return frames;
}

Image& FrameOf(std::vector<Image>& frames, const PatternSequence& sequence,
               const std::string& name) {
  for (size_t i = 0; i < frames.size(); ++i) {
    if (PatternName(sequence.patterns[i]) == name) return frames[i];
  }
  throw Error("no frame " + name);
}

TEST(Decode, ExactFramesGiveExactColumnsOverTheWholePicture) {
  const PatternSequence sequence = MakePatternSequence(1024, 8, PatternRows::kWithout);
  std::vector<double> columns;
  for (double x = -0.45; x < 1023.5; x += 0.37) columns.push_back(x);
  const DecodedPixels decoded =
      Decode(sequence, FromMemory(StripFrames(sequence, columns, 0.6, 0.05)), {});
  for (size_t i = 0; i < columns.size(); ++i) {
    EXPECT_NEAR(decoded.column.position[i], columns[i], 1e-3);
    EXPECT_GT(decoded.column.confidence[i], 0.9);
    EXPECT_GT(decoded.column.sigma[i], 0);
  }
  EXPECT_TRUE(decoded.row.position.empty());
}

TEST(Decode, CodeOffByUpToThreePixelsNeverShiftsThePeriod) {
  const PatternSequence sequence = MakePatternSequence(256, 8, PatternRows::kWithout);
  std::vector<double> columns;
  for (double x = 8; x < 248; x += 0.25) columns.push_back(x);
  for (double shift : {-3.0, -1.0, 1.0, 3.0}) {
    std::vector<double> shifted = columns;
    for (double& x : shifted) x += shift;
    std::vector<Image> frames = StripFrames(sequence, columns, 0.6, 0.05);
    const std::vector<Image> code = StripFrames(sequence, shifted, 0.6, 0.05);
    for (size_t i = 0; i < frames.size(); ++i) {
      if (sequence.patterns[i].kind != PatternKind::kPhase) frames[i] = code[i];
    }
    const DecodedPixels decoded = Decode(sequence, FromMemory(frames), {});
    for (size_t i = 0; i < columns.size(); ++i) {
      ASSERT_GT(decoded.column.confidence[i], 0) << columns[i] << " shift " << shift;
      EXPECT_NEAR(decoded.column.position[i], columns[i], 1e-2) << "shift " << shift;
    }
  }
}

TEST(Decode, AGrayBitWithoutContrastNeverMisplacesAPixel) {
  const PatternSequence sequence = MakePatternSequence(512, 8, PatternRows::kWithout);
  std::vector<double> columns;
  for (double x = 0.3; x < 511; x += 1.7) columns.push_back(x);
  for (int bit = 0; bit < 9; ++bit) {
    std::vector<Image> frames = StripFrames(sequence, columns, 0.6, 0.05);
    const std::string name = "column-gray-" + std::to_string(bit);
    // A bit that every pixel sees half lit.
    for (const std::string& frame : {name, name + "-inverse"}) {
      Image& image = FrameOf(frames, sequence, frame);
      std::fill_n(image.Data<float>(), image.size(), 0.35F);
    }
    const DecodedPixels decoded = Decode(sequence, FromMemory(frames), {});
    for (size_t i = 0; i < columns.size(); ++i) {
      if (decoded.column.confidence[i] > 0) {
        EXPECT_NEAR(decoded.column.position[i], columns[i], 1e-2) << "bit " << bit;
      }
    }
  }
}

TEST(Decode, SaturatedDarkFlatAndNonFinitePixelsAreRejected) {
  const PatternSequence sequence = MakePatternSequence(64, 8, PatternRows::kWithout);
  const std::vector<double> columns(5, 20.25);
  std::vector<Image> frames = StripFrames(sequence, columns, 0.6, 0.05);
  for (size_t i = 0; i < frames.size(); ++i) {
    float* v = frames[i].Data<float>();
    v[1] = 0.05F + 0.02F * (v[1] - 0.05F);                               // in the dark
    if (sequence.patterns[i].kind == PatternKind::kPhase) v[2] = 0.35F;  // no fringe
    if (i == 5) v[3] = std::numeric_limits<float>::quiet_NaN();          // broken
    if (sequence.patterns[i].kind == PatternKind::kPhase && i % 3 == 0) {
      v[4] = std::numeric_limits<float>::infinity();
    }
  }
  const DecodedPixels decoded = Decode(sequence, FromMemory(frames), {});
  EXPECT_GT(decoded.column.confidence[0], 0.9);
  for (size_t i : {1U, 2U, 4U}) EXPECT_EQ(decoded.column.confidence[i], 0) << i;
  for (size_t i = 0; i < 5; ++i) {
    EXPECT_TRUE(std::isfinite(decoded.column.position[i]));
    EXPECT_TRUE(std::isfinite(decoded.column.sigma[i]));
  }

  std::vector<Image> bright = StripFrames(sequence, {20.25, 20.25}, 0.6, 0.05);
  for (Image& frame : bright) {
    frame.Data<float>()[1] *= 1.8F;
    frame = ToSrgb8(frame);
  }
  const DecodedPixels saturated = Decode(sequence, FromMemory(bright), {});
  EXPECT_GT(saturated.column.confidence[0], 0.9);
  EXPECT_EQ(saturated.column.confidence[1], 0);
}

TEST(Decode, LightThatWandersBetweenSurfacesDoesNotMoveTheColumns) {
  const PatternSequence sequence = MakePatternSequence(512, 8, PatternRows::kWithout);
  std::vector<double> columns;
  for (double x = 0.3; x < 511; x += 1.7) columns.push_back(x);
  std::vector<Image> frames = StripFrames(sequence, columns, 0.4, 0.02);
  for (Image& frame : frames) {
    // A third of what 120 columns about the middle of the picture send reaches every pixel.
    double bounced = 0;
    int lamps = 0;
    for (size_t i = 0; i < columns.size(); ++i) {
      if (std::abs(columns[i] - 256) > 60) continue;
      bounced += frame.Data<float>()[i];
      ++lamps;
    }
    for (size_t i = 0; i < columns.size(); ++i) {
      frame.Data<float>()[i] += static_cast<float>(0.33 * bounced / lamps);
    }
  }
  const DecodedPixels decoded = Decode(sequence, FromMemory(frames), {});
  for (size_t i = 0; i < columns.size(); ++i) {
    ASSERT_GT(decoded.column.confidence[i], 0) << columns[i];
    EXPECT_NEAR(decoded.column.position[i], columns[i], 0.1);
  }
}

TEST(Decode, AnOrderOfFramesDoesNotMatter) {
  PatternSequence sequence = MakePatternSequence(64, 8, PatternRows::kWithout);
  std::vector<Image> frames = StripFrames(sequence, {3.25, 17.5, 60.75}, 0.6, 0.05);
  const DecodedPixels forward = Decode(sequence, FromMemory(frames), {});
  std::reverse(sequence.patterns.begin(), sequence.patterns.end());
  std::reverse(frames.begin(), frames.end());
  const DecodedPixels backward = Decode(sequence, FromMemory(frames), {});
  EXPECT_EQ(forward.column.position, backward.column.position);
  EXPECT_EQ(forward.column.confidence, backward.column.confidence);
}

TEST(Decode, GrayCodeAloneGivesWholePixels) {
  PatternSequence sequence = MakePatternSequence(64, 8, PatternRows::kWithout);
  std::erase_if(sequence.patterns, [](const Pattern& p) { return p.kind == PatternKind::kPhase; });
  std::vector<double> columns;
  for (int x = 0; x < 64; ++x) columns.push_back(x + 0.3);
  const DecodedPixels decoded =
      Decode(sequence, FromMemory(StripFrames(sequence, columns, 0.6, 0.05)), {});
  for (int x = 0; x < 64; ++x) {
    EXPECT_NEAR(decoded.column.position[static_cast<size_t>(x)], x, 0.01);
    EXPECT_GT(decoded.column.sigma[static_cast<size_t>(x)], 0.1);
    EXPECT_LT(decoded.column.sigma[static_cast<size_t>(x)], 0.3);
  }
}

TEST(Decode, MissingPatternsAndUnequalFramesAreErrors) {
  const PatternSequence whole = MakePatternSequence(64, 8, PatternRows::kWithout);
  std::vector<Image> frames = StripFrames(whole, {3.25, 17.5}, 0.6, 0.05);
  for (const char* needed : {"column-phase-2", "column-gray-2"}) {
    PatternSequence sequence = whole;
    std::vector<Image> some;
    sequence.patterns.clear();
    for (size_t i = 0; i < frames.size(); ++i) {
      const std::string name = PatternName(whole.patterns[i]);
      if (name == needed || name == std::string(needed) + "-inverse") continue;
      sequence.patterns.push_back(whole.patterns[i]);
      some.push_back(frames[i]);
    }
    EXPECT_THROW(Decode(sequence, FromMemory(some), {}), Error) << needed;
  }
  frames[7] = Image(3, 1, 1, PixelType::kFloat32, ColorEncoding::kLinear);
  EXPECT_THROW(Decode(whole, FromMemory(frames), {}), Error);
}

/// Mean and spread of decoded minus true projector columns and rows over a rendered plane.
struct PlaneErrors {
  double bias = 0, rms = 0, coverage = 0, calibration = 0;
};

PlaneErrors DecodePlane(double noise) {
  const RigCalibration rig = KnownRig(false);
  const PatternSequence sequence = MakePatternSequence(512, 384, PatternRows::kWith);
  const Pose pose = TiltedPlatform(20, 30, 15);
  RenderSettings settings;
  settings.noise = noise;
  settings.samples = 4;
  const std::vector<Image> frames = RenderScan(rig, pose, HitPlate, sequence, settings);
  const DecodedPixels decoded = Decode(sequence, FromMemory(frames), {});
  const Pose world_from_camera = pose.Inverse();
  PlaneErrors errors;
  double count = 0, lit = 0;
  for (int y = 0; y < rig.camera.height; ++y) {
    for (int x = 0; x < rig.camera.width; ++x) {
      const Eigen::Vector3d direction =
          world_from_camera.rotation * Unproject(rig.camera, Eigen::Vector2d(x, y));
      const auto hit = HitPlate(pose.Center(), direction);
      if (!hit) continue;
      const auto truth =
          Project(rig.projector,
                  rig.projector_from_camera * (pose * (pose.Center() + hit->distance * direction)));
      if (!truth || truth->x() < 3 || truth->y() < 3 || truth->x() > 508 || truth->y() > 380) {
        continue;
      }
      lit += 1;
      const size_t p = static_cast<size_t>(y) * rig.camera.width + x;
      if (decoded.column.confidence[p] <= 0 || decoded.row.confidence[p] <= 0) continue;
      const Eigen::Vector2d error =
          Eigen::Vector2d(decoded.column.position[p], decoded.row.position[p]) - *truth;
      errors.bias += error.sum() / 2;
      errors.rms += error.squaredNorm() / 2;
      errors.calibration += std::pow(error.x() / decoded.column.sigma[p], 2);
      count += 1;
    }
  }
  errors.bias /= count;
  errors.rms = std::sqrt(errors.rms / count);
  errors.calibration = std::sqrt(errors.calibration / count);
  errors.coverage = count / lit;
  return errors;
}

TEST(Decode, RenderedPlaneComesBackWithoutBiasAndFarBelowAStripe) {
  const PlaneErrors errors = DecodePlane(0.003);
  EXPECT_LT(std::abs(errors.bias), 0.02);
  EXPECT_LT(errors.rms, 0.08);
  EXPECT_GT(errors.coverage, 0.99);
}

TEST(Decode, ItsSigmaIsTheErrorThatNoiseCauses) {
  const PlaneErrors errors = DecodePlane(0.02);
  EXPECT_GT(errors.calibration, 0.7);
  EXPECT_LT(errors.calibration, 1.4);
}

TEST(Decode, WhatCannotBeDecodedIsRefusedBeforeAnythingIsLoaded) {
  const FrameLoader never = [](int) -> Image { throw std::logic_error("was loaded"); };
  PatternSequence sequence = MakePatternSequence(64, 48, PatternRows::kWith);
  std::erase_if(sequence.patterns, [](const Pattern& p) {
    return p.kind == PatternKind::kGray || p.kind == PatternKind::kGrayInverse;
  });
  try {
    Decode(sequence, never, {});
    ADD_FAILURE();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("column phase patterns repeat"), std::string::npos)
        << error.what();
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
  }
  for (const PatternScheme scheme : {PatternScheme::kGray, PatternScheme::kGrayPhase,
                                     PatternScheme::kMultiPhase, PatternScheme::kStripe}) {
    PatternOptions options;
    options.scheme = scheme;
    EXPECT_NO_THROW(RequireComplete(MakePatternSequence(64, 48, PatternRows::kWith, options)));
  }
}

}  // namespace
}  // namespace lfm
