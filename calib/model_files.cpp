// SPDX-License-Identifier: BSD-3-Clause
#include "calib/model_files.h"

#include <cmath>
#include <cstdio>
#include <limits>

#include "calib/corner_projection.h"
#include "core/error.h"

namespace lfm {
namespace {

using nlohmann::json;

constexpr int kMostLensTerms = kIntrinsics - kFirstLensTerm;
// A plate of 200 mm that is a twentieth of its size out of flat, 10 mm over 100; a larger one lies
// flatter.
constexpr double kMostBendPerMm = 1e-3;
// Ten times the coarsest print that a calibration may be told of (--print-error-mm).
constexpr double kMostShiftMm = 100;

// JSON has no infinity: a model that is none has no error.
void AddError(double rms_px, json& trial) {
  if (std::isfinite(rms_px)) trial["heldout_rms_px"] = rms_px;
}

// A coordinate of a platform's shape. NaN and infinity are no JSON.
void RequireWithin(const JsonReader& reader, const std::string& key, double value, double most,
                   const char* unit) {
  if (std::abs(value) <= most) return;
  char problem[160];
  std::snprintf(problem, sizeof problem,
                "%g %s is more than any platform departs from its print (%g); run lfm-calib again",
                value, unit, most);
  reader.Fail(key, problem);
}

double ErrorFromJson(JsonReader& reader) {
  const std::string key = "heldout_rms_px";
  if (!reader.Has(key)) return std::numeric_limits<double>::infinity();
  const double rms_px = reader.Number(key);
  if (rms_px < 0) reader.Fail(key, "must not be negative");
  return rms_px;
}

}  // namespace

void LensModelsToJson(const CalibResult& result, json& cameras) {
  cameras["lens_trials"] = json::object();
  for (const auto& [name, trials] : result.lens_trials) {
    json list = json::array();
    for (const LensTrial& trial : trials) {
      list.push_back({{"terms", trial.terms}, {"model", LensModelName(trial.terms)}});
      AddError(trial.heldout_rms_px, list.back());
    }
    cameras["lens_trials"][name] = list;
  }
  cameras["intrinsics_covariance"] = json::object();
  for (const auto& [name, covariance] : result.intrinsics_covariance) {
    json of = json::array(), values = json::array();
    for (Eigen::Index row = 0; row < covariance.rows(); ++row) {
      of.push_back(kIntrinsicNames[static_cast<size_t>(row)]);
      for (Eigen::Index column = 0; column < covariance.cols(); ++column) {
        values.push_back(covariance(row, column));
      }
    }
    cameras["intrinsics_covariance"][name] = {{"of", of}, {"values", values}};
  }
}

void LensModelsFromJson(JsonReader& reader, CalibResult& result) {
  JsonReader trials = reader.Object("lens_trials");
  for (const std::string& name : trials.Keys()) {
    if (!result.cameras.contains(name)) trials.Fail(name, "is not among the cameras");
    result.lens_trials[name] = {};
    for (JsonReader& item : trials.Objects(name)) {
      LensTrial trial;
      trial.terms = item.Integer("terms", 0, kMostLensTerms);
      if (item.Text("model") != LensModelName(trial.terms)) item.Fail("model", "is another one");
      trial.heldout_rms_px = ErrorFromJson(item);
      result.lens_trials[name].push_back(trial);
      item.Finish();
    }
  }
  JsonReader covariances = reader.Object("intrinsics_covariance");
  for (const std::string& name : covariances.Keys()) {
    const auto terms = result.lens_terms.find(name);
    if (terms == result.lens_terms.end()) covariances.Fail(name, "has no lens_terms");
    JsonReader item = covariances.Object(name);
    const int size = kFirstLensTerm + terms->second;
    const std::vector<std::string> of = item.Texts("of");
    bool agree = of.size() == static_cast<size_t>(size);
    for (size_t i = 0; agree && i < of.size(); ++i) agree = of[i] == kIntrinsicNames[i];
    if (!agree) item.Fail("of", "expected fx, fy, cx, cy and the lens terms");
    const std::vector<double> values = item.Numbers("values", static_cast<size_t>(size) * size);
    Eigen::MatrixXd covariance(size, size);
    for (int i = 0; i < size * size; ++i) covariance(i / size, i % size) = values[i];
    result.intrinsics_covariance[name] = covariance;
    item.Finish();
  }
}

json PlatformToJson(const CalibResult& result) {
  json trials = json::array(), shifts = json::array();
  for (const PlatformTrial& trial : result.platform_trials) {
    trials.push_back({{"model", trial.model}});
    AddError(trial.heldout_rms_px, trials.back());
  }
  for (const Eigen::Vector2d& shift : result.platform_shape.shifts_mm) {
    shifts.push_back({shift.x(), shift.y()});
  }
  const Eigen::Vector3d& bend = result.platform_shape.bend_per_mm;
  return {{"model", result.platform_model},
          {"trials", trials},
          {"bend_per_mm", {bend.x(), bend.y(), bend.z()}},
          {"shifts_mm", shifts}};
}

void LoadPlatform(const std::filesystem::path& file, CalibResult& result) {
  const json content = ReadJson(file);
  JsonReader reader(content, file.string());
  result.platform_model = reader.Text("model");
  try {
    PlatformModelFromName(result.platform_model);
  } catch (const Error& error) {
    reader.Fail("model", error.what());
  }
  for (JsonReader& item : reader.Objects("trials")) {
    result.platform_trials.push_back({item.Text("model"), ErrorFromJson(item)});
    item.Finish();
  }
  const std::vector<double> bend = reader.Numbers("bend_per_mm", 3);
  for (const double b : bend) RequireWithin(reader, "bend_per_mm", b, kMostBendPerMm, "per mm");
  result.platform_shape.bend_per_mm = {bend[0], bend[1], bend[2]};
  for (const std::vector<double>& shift : reader.NumberRows("shifts_mm", 2)) {
    for (const double s : shift) RequireWithin(reader, "shifts_mm", s, kMostShiftMm, "mm");
    result.platform_shape.shifts_mm.emplace_back(shift[0], shift[1]);
  }
  reader.Finish();
}

}  // namespace lfm
