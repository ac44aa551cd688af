// SPDX-License-Identifier: BSD-3-Clause
#include "sample_data/studio_report.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "sample_data/random.h"
#include "tests/support/scratch_folder.h"

namespace lfm {
namespace {

constexpr float kExposure = 0.5f;

Image Flat(float value) {
  Image image(40, 30, 3, PixelType::kFloat32, ColorEncoding::kLinear);
  for (size_t i = 0; i < image.size(); ++i) image.Data<float>()[i] = value;
  return image;
}

Image Noisy(float value, float sigma, uint64_t seed) {
  Image image = Flat(value);
  RandomStream random(seed, 1, 2);
  for (size_t i = 0; i < image.size(); ++i) {
    image.Data<float>()[i] += sigma * static_cast<float>(random.Normal());
  }
  return image;
}

TEST(NoiseTally, StandardErrorsAndShotNoiseInTheUnitOfAFullSensor) {
  const Sensor sensor{10000, 20};
  const NoiseTally tally = TallyStandardErrors(Flat(0.6f), Flat(0.01f), kExposure, sensor);
  EXPECT_EQ(tally.values, 40 * 30 * 3);
  EXPECT_NEAR(tally.MonteCarloRms(), 0.005, 1e-7);
  EXPECT_NEAR(tally.SensorRms(), std::sqrt(0.3 / 10000 + 4e-6), 1e-7);
  EXPECT_NEAR(tally.ValueRms(), 0.3, 1e-6);
}

// Two renderings of known error: half the squared difference is one rendering's variance.
TEST(NoiseTally, DifferencesOfTwoRenderingsGiveTheErrorOfOne) {
  constexpr float kSigma = 0.02f;
  const NoiseTally tally =
      TallyDifferences(Noisy(0.6f, kSigma, 1), Noisy(0.6f, kSigma, 2), kExposure, Sensor());
  const double expected = kExposure * kSigma;
  EXPECT_NEAR(tally.MonteCarloRms() / expected, 1, 3 / std::sqrt(2.0 * 3600));
}

TEST(NoiseTally, SaturatedValuesShowNoNoiseAndNoValuesAreNoNumber) {
  EXPECT_EQ(TallyStandardErrors(Flat(2), Flat(1), kExposure, Sensor()).values, 0);
  NoiseTally tally;
  EXPECT_EQ(tally.MonteCarloRms(), 0);
  EXPECT_EQ(tally.SensorRms(), 0);
  tally.Add(-0.1, 0.04, Sensor{100, 1});  // below black: read noise alone
  EXPECT_NEAR(tally.SensorRms(), 0.01, 1e-9);
  EXPECT_NEAR(tally.MonteCarloRms(), 0.2, 1e-9);
  for (const double bad : {std::nan(""), HUGE_VAL}) {
    EXPECT_THROW(tally.Add(bad, 0, Sensor()), Error);
    EXPECT_THROW(tally.Add(0, bad, Sensor()), Error);
    EXPECT_THROW(tally.Add(bad, 0), Error);
  }
}

TEST(NoiseTally, ASensorWithoutNoiseHasNone) {
  const Sensor silent{std::numeric_limits<double>::infinity(), 0};
  EXPECT_EQ(NoiseVariance(silent, 0.7f), 0);
  EXPECT_EQ(NoisyValue(silent, 0.7f, 3), 0.7f);
  EXPECT_EQ(TallyStandardErrors(Flat(1), Flat(0), kExposure, silent).SensorRms(), 0);
}

StageReport SampleStage() {
  StageReport stage;
  stage.name = "photographs";
  stage.rays = {3'000'000, 2'000'000, 1'000'000};
  stage.wall_in_seconds = 2;
  stage.cpu_in_seconds = 4;
  stage.noise = TallyStandardErrors(Flat(0.6f), Flat(0.01f), kExposure, Sensor{10000, 0});
  return stage;
}

TEST(StudioReport, SentencesNameCountsRatesAndBothErrors) {
  StageReport stage = SampleStage();
  EXPECT_EQ(DescribeRays(stage),
            "photographs: 6.0 million rays (camera 3.0, bounce 2.0, shadow 1.0) in 2.0 s: 3.00 "
            "million rays/s (1.50 a CPU second)");
  EXPECT_EQ(DescribeNoise(stage),
            "photographs: Monte Carlo error 0.00500, sensor noise 0.00548 (RMS; 1: a full sensor)");
  stage.noise->monte_carlo_variance *= 4;
  EXPECT_NE(DescribeNoise(stage).find("--quality reference"), std::string::npos);
  stage.noise.reset();
  EXPECT_EQ(DescribeNoise(stage), "");
}

TEST(StudioReport, FileHoldsCountsAndErrorsAndNoTimes) {
  const ScratchFolder scratch;
  StageReport light;
  light.name = "light";
  const std::filesystem::path file = scratch.folder / "studio.json";
  WriteStudioReport(StudioOptions(), {light, SampleStage()}, file);
  std::ifstream stream(file);
  const nlohmann::json json = nlohmann::json::parse(stream);
  EXPECT_EQ(json.at("quality"), "default");
  EXPECT_EQ(json.at("sensor_noise"), true);
  ASSERT_EQ(json.at("stages").size(), 2u);
  EXPECT_FALSE(json.at("stages")[0].contains("monte_carlo_rms"));
  const nlohmann::json& stage = json.at("stages")[1];
  EXPECT_EQ(stage.at("rays").at("shadow"), 1'000'000);
  EXPECT_NEAR(stage.at("monte_carlo_rms"), 0.005, 1e-7);
  EXPECT_NEAR(stage.at("sensor_rms"), std::sqrt(0.3 / 10000), 1e-7);
  EXPECT_FALSE(stage.contains("wall_in_seconds"));
}

}  // namespace
}  // namespace lfm
