// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <limits>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace lfm {

/// What is declared once about an option: the command line, the config file, the report, the hash
/// of a stage's inputs and the validation all read it.
struct OptionInfo {
  const char* name;  ///< as typed after "--": "samples-per-triangle"
  const char* help;  ///< one sentence; for a knob, what it trades
  const char* unit = "";
  double min = -std::numeric_limits<double>::infinity();
  double max = std::numeric_limits<double>::infinity();
};

/// Visits every option of a struct. A stage declares its options by
///
///   struct ScanOptions {
///     double min_confidence = 0.3;
///     void Declare(OptionVisitor& v) {
///       v.Number({"min-confidence", "Drop points below this.", "", 0, 1}, min_confidence);
///     }
///   };
///
/// The defaults are the member initialisers.
class OptionVisitor {
 public:
  virtual ~OptionVisitor() = default;
  virtual void Number(const OptionInfo& info, double& value) = 0;
  virtual void Integer(const OptionInfo& info, int& value) = 0;
  virtual void Flag(const OptionInfo& info, bool& value) = 0;
  virtual void Text(const OptionInfo& info, std::string& value) = 0;
  /// An enumeration: `value` is an index into `names`.
  virtual void Choice(const OptionInfo& info, const std::vector<std::string>& names,
                      int& value) = 0;

  /// A choice whose value is no int: `set` takes the index chosen. A visitor that learns values
  /// only after Declare has returned (a command line) overrides this and keeps `set`.
  virtual void ChoiceBySetter(const OptionInfo& info, const std::vector<std::string>& names,
                              int current, const std::function<void(int)>& set) {
    int index = current;
    Choice(info, names, index);
    set(index);
  }

  template <typename Enum>
  void Enumeration(const OptionInfo& info, const std::vector<std::string>& names, Enum& value) {
    ChoiceBySetter(info, names, static_cast<int>(value),
                   [&value](int index) { value = static_cast<Enum>(index); });
  }
};

/// Declares an OptionVisitor over any struct with a `Declare` member, for functions that need no
/// template: `AnyOptions options(scan_options);`
class AnyOptions {
 public:
  template <typename Options>
  explicit AnyOptions(Options& options)
      : object_(&options),
        declare_([](void* o, OptionVisitor& v) { static_cast<Options*>(o)->Declare(v); }) {}
  void Declare(OptionVisitor& visitor) const { declare_(object_, visitor); }

 private:
  void* object_;
  void (*declare_)(void*, OptionVisitor&);
};

/// {"min-confidence": 0.3, ...}: for the report and for hashing.
nlohmann::json OptionsToJson(AnyOptions options);
/// Sets the options named in `json`; unknown names, wrong types and values out of range throw
/// Error naming `where` and the option.
void OptionsFromJson(AnyOptions options, const nlohmann::json& json, const std::string& where);
/// Throws Error that names option, value and violated range. NaN violates every range.
void ValidateOptions(AnyOptions options);

}  // namespace lfm
