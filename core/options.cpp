// SPDX-License-Identifier: BSD-3-Clause
#include "core/options.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "core/error.h"

namespace lfm {
namespace {

std::string Quoted(const OptionInfo& info) { return std::string("--") + info.name; }

std::string Shortest(double value) {
  constexpr double kManyDigits = 1e15;  // all whole numbers below are exact
  if (std::abs(value) < kManyDigits && value == std::trunc(value)) {
    return std::to_string(static_cast<int64_t>(value));
  }
  std::ostringstream text;
  text.precision(6);
  text << value;
  return text.str();
}

[[noreturn]] void FailRange(const OptionInfo& info, double value) {
  std::string range;
  if (std::isfinite(info.min) && std::isfinite(info.max)) {
    range = "between " + Shortest(info.min) + " and " + Shortest(info.max);
  } else if (std::isfinite(info.min)) {
    range = "at least " + Shortest(info.min);
  } else if (std::isfinite(info.max)) {
    range = "at most " + Shortest(info.max);
  } else {
    range = "a finite number";
  }
  const std::string unit = *info.unit == '\0' ? "" : std::string(" ") + info.unit;
  throw Error(Quoted(info) + " is " + Shortest(value) + " but must be " + range + unit);
}

void CheckRange(const OptionInfo& info, double value) {
  if (!std::isfinite(value) || value < info.min || value > info.max) FailRange(info, value);
}

class Validator : public OptionVisitor {
 public:
  void Number(const OptionInfo& info, double& value) override { CheckRange(info, value); }
  void Integer(const OptionInfo& info, int& value) override { CheckRange(info, value); }
  void Flag(const OptionInfo&, bool&) override {}
  void Text(const OptionInfo&, std::string&) override {}
  void Choice(const OptionInfo& info, const std::vector<std::string>& names, int& value) override {
    if (value < 0 || value >= static_cast<int>(names.size())) FailRange(info, value);
  }
};

class JsonWriter : public OptionVisitor {
 public:
  nlohmann::json json = nlohmann::json::object();
  void Number(const OptionInfo& info, double& value) override { json[info.name] = value; }
  void Integer(const OptionInfo& info, int& value) override { json[info.name] = value; }
  void Flag(const OptionInfo& info, bool& value) override { json[info.name] = value; }
  void Text(const OptionInfo& info, std::string& value) override { json[info.name] = value; }
  void Choice(const OptionInfo& info, const std::vector<std::string>& names, int& value) override {
    json[info.name] = names.at(value);
  }
};

class JsonSetter : public OptionVisitor {
 public:
  JsonSetter(const nlohmann::json& json, const std::string& where) : json_(json), where_(where) {}

  void Number(const OptionInfo& info, double& value) override {
    if (const nlohmann::json* v = Find(info)) {
      if (!v->is_number()) Fail(info, "a number");
      value = v->get<double>();
    }
  }
  void Integer(const OptionInfo& info, int& value) override {
    if (const nlohmann::json* v = Find(info)) {
      if (!v->is_number_integer()) Fail(info, "a whole number");
      const double wide = v->get<double>();
      CheckRange({info.name, info.help, info.unit, std::max(info.min, -2147483648.0),
                  std::min(info.max, 2147483647.0)},
                 wide);
      value = v->get<int>();
    }
  }
  void Flag(const OptionInfo& info, bool& value) override {
    if (const nlohmann::json* v = Find(info)) {
      if (!v->is_boolean()) Fail(info, "true or false");
      value = v->get<bool>();
    }
  }
  void Text(const OptionInfo& info, std::string& value) override {
    if (const nlohmann::json* v = Find(info)) {
      if (!v->is_string()) Fail(info, "a string");
      value = v->get<std::string>();
    }
  }
  void Choice(const OptionInfo& info, const std::vector<std::string>& names, int& value) override {
    if (const nlohmann::json* v = Find(info)) {
      const auto name = v->is_string()
                            ? std::find(names.begin(), names.end(), v->get<std::string>())
                            : names.end();
      if (name == names.end()) {
        std::string list;
        for (const std::string& n : names) list += (list.empty() ? "" : ", ") + n;
        Fail(info, "one of: " + list);
      }
      value = static_cast<int>(name - names.begin());
    }
  }

  void RejectUnknown() const {
    for (const auto& [key, value] : json_.items()) {
      if (!seen_.contains(key)) throw Error(where_ + ": unknown option '" + key + "'");
    }
  }

 private:
  const nlohmann::json* Find(const OptionInfo& info) {
    seen_.insert(info.name);
    const auto it = json_.find(info.name);
    return it == json_.end() ? nullptr : &*it;
  }
  [[noreturn]] void Fail(const OptionInfo& info, const std::string& expected) const {
    throw Error(where_ + ": option '" + info.name + "' must be " + expected);
  }
  const nlohmann::json& json_;
  const std::string& where_;
  std::set<std::string> seen_;
};

}  // namespace

nlohmann::json OptionsToJson(AnyOptions options) {
  JsonWriter writer;
  options.Declare(writer);
  return writer.json;
}

void OptionsFromJson(AnyOptions options, const nlohmann::json& json, const std::string& where) {
  if (!json.is_object()) throw Error(where + ": options must be a JSON object");
  JsonSetter setter(json, where);
  options.Declare(setter);
  setter.RejectUnknown();
  ValidateOptions(options);
}

void ValidateOptions(AnyOptions options) {
  Validator validator;
  options.Declare(validator);
}

}  // namespace lfm
