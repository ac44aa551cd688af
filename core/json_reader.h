// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "core/pose.h"

namespace lfm {

/// Strict access to one JSON object: every problem is an Error that names the file and the place
/// ("capture.json: photos[3].camera: expected a string"), and keys that nobody asked for are an
/// Error in Finish().
class JsonReader {
 public:
  JsonReader(const nlohmann::json& object, std::string file, std::string place = "");

  bool Has(const std::string& key) const;
  double Number(const std::string& key);  ///< finite
  double NumberOr(const std::string& key, double otherwise);
  int Integer(const std::string& key, int min, int max);
  bool Bool(const std::string& key);
  std::string Text(const std::string& key);
  std::string TextOr(const std::string& key, const std::string& otherwise);
  std::vector<std::string> Texts(const std::string& key);
  std::vector<double> Numbers(const std::string& key, size_t count);  ///< exactly `count`
  /// An array of rows, `columns` finite numbers each; may be empty.
  std::vector<std::vector<double>> NumberRows(const std::string& key, size_t columns);
  JsonReader Object(const std::string& key);
  std::vector<JsonReader> Objects(const std::string& key);  ///< an array of objects
  std::vector<std::string> Keys() const;
  /// Throws Error when a key was never read: a misspelt key is worse than a missing one.
  void Finish() const;
  [[noreturn]] void Fail(const std::string& key, const std::string& problem) const;

 private:
  const nlohmann::json& Get(const std::string& key);
  const nlohmann::json* object_;
  std::string file_, place_;
  std::set<std::string> seen_;
};

/// Parses JSON text; Error with line and column, naming `file`, when it is malformed or nested more
/// than 64 deep.
nlohmann::json ParseJson(std::string_view text, const std::string& file);
/// Parses a JSON file of at most 256 MB; Error with line and column when it is malformed.
nlohmann::json ReadJson(const std::filesystem::path& file);
/// Indented, keys in order, numbers round-trip; atomic. Throws Error when it cannot be written, or
/// a text in it is not UTF-8.
void WriteJson(const nlohmann::json& json, const std::filesystem::path& file);

/// {"rotation": [w, x, y, z], "translation": [x, y, z]} (mm).
nlohmann::json PoseToJson(const Pose& pose);
Pose PoseFromJson(JsonReader& reader);

}  // namespace lfm
