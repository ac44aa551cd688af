// SPDX-License-Identifier: BSD-3-Clause
#include "scan/scan_report.h"

#include <cstdio>

namespace lfm {
namespace {

// The default capture shows 0.045 px (docs/figures.md).
constexpr double kUsualProjectorRms = 0.2;

std::string Millimetres(double mm) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4f mm", mm);
  return text;
}

}  // namespace

std::vector<std::string> DescribeScans(const ScanResult& result) {
  std::vector<std::string> lines;
  for (const TurntableReport& t : result.turntables) {
    lines.push_back(std::to_string(t.scans.size()) + " scans, from " + t.scans.front() +
                    " on, share a turntable's axis to " + Millimetres(t.rms_mm));
  }
  const RegistrationReport& r = result.registration;
  if (r.held_out == 0) {
    lines.emplace_back("registration: scans stand where the platform puts them");
  } else {
    lines.push_back("registration: " + std::to_string(r.pairs) +
                    " pairs of scans, held-out points " + Millimetres(r.before_mm) + " before, " +
                    Millimetres(r.after_mm) +
                    " after: " + (r.kept ? "refined poses kept" : "poses of the platform kept"));
  }
  if (result.rig.projector_rms_px > kUsualProjectorRms) {
    char text[192];
    std::snprintf(text, sizeof text,
                  "warning: projector %.2f px RMS, usually below %.1f: the platform moved between "
                  "the frames of a placement, or the calibration is of other pictures",
                  result.rig.projector_rms_px, kUsualProjectorRms);
    lines.emplace_back(text);
  }
  return lines;
}

}  // namespace lfm
