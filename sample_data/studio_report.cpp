// SPDX-License-Identifier: BSD-3-Clause
#include "sample_data/studio_report.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/formatted_text.h"
#include "core/json_reader.h"

namespace lfm {
namespace {

constexpr double kMillion = 1e6;

double Rms(double sum, int64_t count) {
  return count > 0 ? std::sqrt(sum / static_cast<double>(count)) : 0;
}

const char* QualityName(RenderQuality quality) {
  switch (quality) {
    case RenderQuality::kDraft:
      return "draft";
    case RenderQuality::kReference:
      return "reference";
    case RenderQuality::kDefault:
      break;
  }
  return "default";
}

void RequireNumbers(double value, double variance) {
  if (std::isfinite(value) && std::isfinite(variance)) return;
  throw Error("the light of a picture came out as no number; this is a fault of the studio",
              ErrorKind::kSystem);
}

}  // namespace

NoiseTally& NoiseTally::operator+=(const NoiseTally& other) {
  monte_carlo_variance += other.monte_carlo_variance;
  sensor_variance += other.sensor_variance;
  squares += other.squares;
  values += other.values;
  return *this;
}

double NoiseTally::MonteCarloRms() const { return Rms(monte_carlo_variance, values); }
double NoiseTally::SensorRms() const { return Rms(sensor_variance, values); }
double NoiseTally::ValueRms() const { return Rms(squares, values); }

void NoiseTally::Add(double level, double variance, const Sensor& sensor) {
  RequireNumbers(level, variance);
  if (!(level < 1)) return;
  sensor_variance += NoiseVariance(sensor, static_cast<float>(std::max(0.0, level)));
  Add(level, variance);
}

void NoiseTally::Add(double value, double variance) {
  RequireNumbers(value, variance);
  monte_carlo_variance += variance;
  squares += value * value;
  ++values;
}

NoiseTally TallyStandardErrors(const Image& radiance, const Image& standard_error, float exposure,
                               const Sensor& sensor) {
  NoiseTally tally;
  const float* value = radiance.Data<float>();
  const float* error = standard_error.Data<float>();
  for (size_t i = 0; i < radiance.size(); ++i) {
    const double e = static_cast<double>(exposure) * error[i];
    tally.Add(static_cast<double>(exposure) * value[i], e * e, sensor);
  }
  return tally;
}

NoiseTally TallyDifferences(const Image& radiance, const Image& again, float exposure,
                            const Sensor& sensor) {
  NoiseTally tally;
  const float* a = radiance.Data<float>();
  const float* b = again.Data<float>();
  for (size_t i = 0; i < radiance.size(); ++i) {
    const double difference = static_cast<double>(exposure) * (a[i] - b[i]);
    tally.Add(static_cast<double>(exposure) * a[i], difference * difference / 2, sensor);
  }
  return tally;
}

void StageClock::Stop(StageReport& stage) const {
  const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - wall_;
  stage.wall_in_seconds = wall.count();
  stage.cpu_in_seconds = static_cast<double>(std::clock() - cpu_) / CLOCKS_PER_SEC;
}

std::string DescribeRays(const StageReport& stage) {
  const auto million = [](int64_t rays) { return static_cast<double>(rays) / kMillion; };
  const double total = million(stage.rays.Total());
  return FormattedText(
      "%s: %.1f million rays (camera %.1f, bounce %.1f, shadow %.1f) in %.1f s: %.2f million "
      "rays/s (%.2f a CPU second)",
      stage.name.c_str(), total, million(stage.rays.camera), million(stage.rays.bounce),
      million(stage.rays.shadow), stage.wall_in_seconds,
      total / std::max(stage.wall_in_seconds, 1e-3), total / std::max(stage.cpu_in_seconds, 1e-3));
}

std::string DescribeNoise(const StageReport& stage) {
  if (!stage.noise || stage.noise->values == 0) return "";
  const double error = stage.noise->MonteCarloRms();
  if (!stage.has_sensor) {
    return FormattedText("%s: Monte Carlo error %.3g, values %.3g (RMS)", stage.name.c_str(), error,
                         stage.noise->ValueRms());
  }
  const double sensor = stage.noise->SensorRms();
  std::string text =
      FormattedText("%s: Monte Carlo error %.5f, sensor noise %.5f (RMS; 1: a full sensor)",
                    stage.name.c_str(), error, sensor);
  if (sensor > 0 && error > sensor) text += "; for studies of noise take --quality reference";
  return text;
}

void NoteReport(const StudioReport& report, Progress& progress) {
  for (const StageReport& stage : report) progress.Note(DescribeRays(stage));
  for (const StageReport& stage : report) {
    if (const std::string noise = DescribeNoise(stage); !noise.empty()) progress.Note(noise);
  }
}

void WriteStudioReport(const StudioOptions& options, const StudioReport& report,
                       const std::filesystem::path& file) {
  nlohmann::json json = {{"quality", QualityName(options.quality)},
                         {"seed", options.seed},
                         {"sensor_noise", std::isfinite(MakeSensor(options).full_well)},
                         {"stages", nlohmann::json::array()}};
  for (const StageReport& stage : report) {
    nlohmann::json entry = {{"name", stage.name},
                            {"rays",
                             {{"camera", stage.rays.camera},
                              {"bounce", stage.rays.bounce},
                              {"shadow", stage.rays.shadow}}}};
    if (stage.noise && stage.noise->values > 0) {
      entry["monte_carlo_rms"] = stage.noise->MonteCarloRms();
      if (stage.has_sensor) entry["sensor_rms"] = stage.noise->SensorRms();
      entry["value_rms"] = stage.noise->ValueRms();
      entry["values"] = stage.noise->values;
    }
    json["stages"].push_back(std::move(entry));
  }
  WriteJson(json, file);
}

}  // namespace lfm
