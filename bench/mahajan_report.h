// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/line_chart.h"
#include "fields/slope_fit.h"

namespace lfm {

/// What a run found: charts as SVG files, and a table of figures beside what is asked of them.
class MahajanReport {
 public:
  explicit MahajanReport(std::filesystem::path out) : out_(std::move(out)) {}

  void Draw(const std::string& name, const LineChart& chart) const;
  /// A slope that has to lie in [low, high].
  void AddSlope(const std::string& what, const std::optional<SlopeFit>& fit, double low,
                double high);
  void Add(const std::string& what, const std::string& measured, const std::string& asked,
           bool reached);
  /// Without anything that is asked.
  void Note(const std::string& what, const std::string& measured);
  /// Markdown, as far as it goes.
  std::string Table() const;

 private:
  std::filesystem::path out_;
  std::vector<std::string> lines_;
};

/// "0.93 +- 0.02 (areas 256 to 2048)".
std::string SlopeText(const std::optional<SlopeFit>& fit);

/// Figures 4 and 5, Equation 12.
void DrawFlatland(MahajanReport& report);
/// Figures 6 and 7a.
void DrawSpheres(MahajanReport& report);
/// Figures 7b to 7f in closed form.
void DrawClosedForms(MahajanReport& report);
/// Figures 7a to 7h from transport captures in `data`, those that there are.
void DrawCaptures(const std::filesystem::path& data, MahajanReport& report);

}  // namespace lfm
