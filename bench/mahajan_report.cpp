// SPDX-License-Identifier: BSD-3-Clause
#include "bench/mahajan_report.h"

#include "core/atomic_file.h"
#include "core/formatted_text.h"

namespace lfm {

void MahajanReport::Draw(const std::string& name, const LineChart& chart) const {
  WriteFileAtomically(out_ / (name + ".svg"), ChartToSvg(chart));
}

void MahajanReport::Add(const std::string& what, const std::string& measured,
                        const std::string& asked, bool reached) {
  lines_.push_back("| " + what + " | " + measured + " | " + asked + " | " +
                   (reached ? "yes" : "no") + " |");
}

void MahajanReport::Note(const std::string& what, const std::string& measured) {
  lines_.push_back("| " + what + " | " + measured + " | | |");
}

void MahajanReport::AddSlope(const std::string& what, const std::optional<SlopeFit>& fit,
                             double low, double high) {
  const std::string asked =
      high > 1.2 ? FormattedText(">= %.2f", low) : FormattedText("%.2f to %.2f", low, high);
  Add(what, SlopeText(fit), asked, fit && fit->slope >= low && fit->slope <= high);
}

std::string MahajanReport::Table() const {
  std::string text = "| what | measured | asked | reached |\n|---|---|---|---|\n";
  for (const std::string& line : lines_) text += line + "\n";
  return text;
}

std::string SlopeText(const std::optional<SlopeFit>& fit) {
  if (!fit) return "no slope";
  std::string text = FormattedText("%.3f", fit->slope);
  if (fit->half_width) text += FormattedText(" +- %.3f", *fit->half_width);
  return text;
}

}  // namespace lfm
