// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <cstdint>
#include <ctime>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/image.h"
#include "core/progress.h"
#include "sample_data/path_tracer.h"
#include "sample_data/sensor.h"
#include "sample_data/studio_options.h"

namespace lfm {

/// How far rendered values can be trusted, beside what the sensor adds to them. Variances are
/// summed over values in the unit of a full sensor (1: saturated, linear); values that saturate
/// count in neither, since they show no noise.
struct NoiseTally {
  double monte_carlo_variance = 0, sensor_variance = 0, squares = 0;  ///< the last: of the values
  int64_t values = 0;

  NoiseTally& operator+=(const NoiseTally& other);
  /// Root mean square over the values; 0 without any.
  double MonteCarloRms() const;
  double SensorRms() const;
  double ValueRms() const;
  /// Counts one value: its level and the variance of its estimate, both at `sensor`.
  void Add(double level, double variance, const Sensor& sensor);
  /// Counts a value that no sensor sees, in a unit of its own.
  void Add(double value, double variance);
};

/// The tally of a picture (float, linear; `exposure` brings it to the sensor) whose values have
/// these standard errors.
NoiseTally TallyStandardErrors(const Image& radiance, const Image& standard_error, float exposure,
                               const Sensor& sensor);
/// The tally of a picture that was rendered twice with independent random numbers: half the squared
/// difference of two equal estimates is, in the mean, the variance of either.
NoiseTally TallyDifferences(const Image& radiance, const Image& again, float exposure,
                            const Sensor& sensor);

/// What one piece of the studio's work took, and the noise of what it made.
struct StageReport {
  std::string name;
  RayCounts rays;              ///< those that measured the noise included
  double wall_in_seconds = 0;  ///< from first to last, exposing and writing the pictures included
  double cpu_in_seconds = 0;   ///< of all threads of the process
  std::optional<NoiseTally> noise;
  bool has_sensor = true;  ///< false: nothing but light is recorded; the unit is that of the values
};
using StudioReport = std::vector<StageReport>;

/// Measures one stage from its construction on.
class StageClock {
 public:
  StageClock() : wall_(std::chrono::steady_clock::now()), cpu_(std::clock()) {}
  /// Sets the times of `stage`.
  void Stop(StageReport& stage) const;

 private:
  std::chrono::steady_clock::time_point wall_;
  std::clock_t cpu_;
};

/// "photographs: 123.4 million rays (...) in 5.6 s: 22.0 million rays/s (11.5 a CPU second)".
std::string DescribeRays(const StageReport& stage);
/// "photographs: Monte Carlo error 0.0012, sensor noise 0.0071 (RMS; 1: a full sensor)", or,
/// without a sensor, the error beside the values' own root mean square; empty when nothing was
/// measured.
std::string DescribeNoise(const StageReport& stage);

/// Tells `progress` both sentences of every stage.
void NoteReport(const StudioReport& report, Progress& progress);

/// studio.json (docs/formats.md): quality, seed, rays and noise of every stage. Times are left out:
/// the same options write the same bytes.
void WriteStudioReport(const StudioOptions& options, const StudioReport& report,
                       const std::filesystem::path& file);

}  // namespace lfm
