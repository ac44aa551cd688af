// SPDX-License-Identifier: BSD-3-Clause
#include "core/json_reader.h"

#include <cmath>
#include <limits>

#include "core/atomic_file.h"
#include "core/error.h"

namespace lfm {

JsonReader::JsonReader(const nlohmann::json& object, std::string file, std::string place)
    : object_(&object), file_(std::move(file)), place_(std::move(place)) {
  if (!object.is_object()) {
    throw Error(file_ + ": " + (place_.empty() ? "the file" : place_) + " must be a JSON object");
  }
}

void JsonReader::Fail(const std::string& key, const std::string& problem) const {
  std::string where = place_;
  if (!key.empty()) where += (where.empty() ? "" : ".") + key;
  throw Error(file_ + ": " + (where.empty() ? "" : where + ": ") + problem);
}

bool JsonReader::Has(const std::string& key) const { return object_->contains(key); }

const nlohmann::json& JsonReader::Get(const std::string& key) {
  seen_.insert(key);
  const auto it = object_->find(key);
  if (it == object_->end()) Fail(key, "is missing");
  return *it;
}

double JsonReader::Number(const std::string& key) {
  const nlohmann::json& value = Get(key);
  if (!value.is_number()) Fail(key, "expected a number");
  const double number = value.get<double>();
  if (!std::isfinite(number)) Fail(key, "expected a finite number");
  return number;
}

double JsonReader::NumberOr(const std::string& key, double otherwise) {
  return Has(key) ? Number(key) : otherwise;
}

int JsonReader::Integer(const std::string& key, int min, int max) {
  const nlohmann::json& value = Get(key);
  // Compared as double first: an integer beyond 64 bits must not wrap into the range.
  const double wide =
      value.is_number_integer() ? value.get<double>() : std::numeric_limits<double>::quiet_NaN();
  if (!(wide >= min && wide <= max)) {
    Fail(key,
         "expected a whole number between " + std::to_string(min) + " and " + std::to_string(max));
  }
  return value.get<int>();
}

bool JsonReader::Bool(const std::string& key) {
  const nlohmann::json& value = Get(key);
  if (!value.is_boolean()) Fail(key, "expected true or false");
  return value.get<bool>();
}

std::string JsonReader::Text(const std::string& key) {
  const nlohmann::json& value = Get(key);
  if (!value.is_string()) Fail(key, "expected a string");
  return value.get<std::string>();
}

std::string JsonReader::TextOr(const std::string& key, const std::string& otherwise) {
  return Has(key) ? Text(key) : otherwise;
}

std::vector<std::string> JsonReader::Texts(const std::string& key) {
  const nlohmann::json& value = Get(key);
  if (!value.is_array()) Fail(key, "expected an array of strings");
  std::vector<std::string> texts;
  for (const nlohmann::json& item : value) {
    if (!item.is_string()) Fail(key, "expected an array of strings");
    texts.push_back(item.get<std::string>());
  }
  return texts;
}

std::vector<double> JsonReader::Numbers(const std::string& key, size_t count) {
  const nlohmann::json& value = Get(key);
  const std::string expected = "expected an array of " + std::to_string(count) + " finite numbers";
  if (!value.is_array() || value.size() != count) Fail(key, expected);
  std::vector<double> numbers;
  for (const nlohmann::json& item : value) {
    if (!item.is_number() || !std::isfinite(item.get<double>())) Fail(key, expected);
    numbers.push_back(item.get<double>());
  }
  return numbers;
}

std::vector<std::vector<double>> JsonReader::NumberRows(const std::string& key, size_t columns) {
  const nlohmann::json& value = Get(key);
  const std::string expected =
      "expected an array of rows of " + std::to_string(columns) + " finite numbers";
  if (!value.is_array()) Fail(key, expected);
  std::vector<std::vector<double>> rows;
  for (const nlohmann::json& row : value) {
    if (!row.is_array() || row.size() != columns) Fail(key, expected);
    rows.emplace_back();
    for (const nlohmann::json& item : row) {
      if (!item.is_number() || !std::isfinite(item.get<double>())) Fail(key, expected);
      rows.back().push_back(item.get<double>());
    }
  }
  return rows;
}

JsonReader JsonReader::Object(const std::string& key) {
  const nlohmann::json& value = Get(key);
  const std::string place = place_.empty() ? key : place_ + "." + key;
  return JsonReader(value, file_, place);
}

std::vector<JsonReader> JsonReader::Objects(const std::string& key) {
  const nlohmann::json& value = Get(key);
  if (!value.is_array()) Fail(key, "expected an array of objects");
  const std::string place = place_.empty() ? key : place_ + "." + key;
  std::vector<JsonReader> objects;
  for (size_t i = 0; i < value.size(); ++i) {
    objects.emplace_back(value[i], file_, place + "[" + std::to_string(i) + "]");
  }
  return objects;
}

std::vector<std::string> JsonReader::Keys() const {
  std::vector<std::string> keys;
  for (const auto& [key, value] : object_->items()) keys.push_back(key);
  return keys;
}

void JsonReader::Finish() const {
  for (const auto& [key, value] : object_->items()) {
    if (!seen_.contains(key)) Fail(key, "unknown key; remove it or check its spelling");
  }
}

nlohmann::json ParseJson(std::string_view text, const std::string& file) {
  // A deeply nested file would exhaust the stack when it is destroyed.
  constexpr int kMaxDepth = 64;
  const auto limit_depth = [](int depth, nlohmann::json::parse_event_t, nlohmann::json&) {
    if (depth > kMaxDepth) throw Error("nested too deeply");
    return true;
  };
  try {
    return nlohmann::json::parse(text, limit_depth);
  } catch (const nlohmann::json::exception& e) {
    const std::string what = e.what();  // "[json...] parse error at line 1, column 2: ..."
    const size_t start = what.find("] ");
    throw Error(file + ": is not valid JSON: " +
                (start == std::string::npos ? what : what.substr(start + 2)));
  } catch (const Error& e) {
    throw Error(file + ": is not valid JSON: " + e.what());
  }
}

nlohmann::json ReadJson(const std::filesystem::path& file) {
  constexpr size_t kMaxBytes = size_t{256} << 20;
  return ParseJson(ReadFile(file, kMaxBytes), file.string());
}

void WriteJson(const nlohmann::json& json, const std::filesystem::path& file) {
  try {
    WriteFileAtomically(file, json.dump(2) + "\n");
  } catch (const nlohmann::json::type_error&) {  // JSON is UTF-8, names of files may be anything
    throw Error("cannot write " + file.string() +
                ": a name in it is not UTF-8; rename that file or folder");
  }
}

nlohmann::json PoseToJson(const Pose& pose) {
  const Eigen::Quaterniond q = pose.Quaternion();
  const Eigen::Vector3d& t = pose.translation;
  return {{"rotation", {q.w(), q.x(), q.y(), q.z()}}, {"translation", {t.x(), t.y(), t.z()}}};
}

Pose PoseFromJson(JsonReader& reader) {
  const std::vector<double> q = reader.Numbers("rotation", 4);
  const std::vector<double> t = reader.Numbers("translation", 3);
  const Eigen::Quaterniond rotation(q[0], q[1], q[2], q[3]);
  constexpr double kUnit_abs = 1e-3;
  if (std::abs(rotation.norm() - 1) > kUnit_abs) {
    reader.Fail("rotation", "must be a unit quaternion w, x, y, z");
  }
  return Pose::FromQuaternion(rotation, {t[0], t[1], t[2]});
}

}  // namespace lfm
