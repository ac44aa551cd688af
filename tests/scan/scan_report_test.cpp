// SPDX-License-Identifier: BSD-3-Clause
#include "scan/scan_report.h"

#include <gtest/gtest.h>

namespace lfm {
namespace {

std::string Joined(const std::vector<std::string>& lines) {
  std::string text;
  for (const std::string& line : lines) text += line + "\n";
  return text;
}

TEST(ScanReport, SaysWhatHeldThePoses) {
  ScanResult result;
  EXPECT_EQ(Joined(DescribeScans(result)),
            "registration: scans stand where the platform puts them\n");
  result.turntables = {{.scans = {"scan_00", "scan_01"}, .rms_mm = 0.0123}};
  result.registration = {
      .kept = true, .pairs = 5, .held_out = 100, .before_mm = 0.05, .after_mm = 0.02};
  EXPECT_EQ(Joined(DescribeScans(result)),
            "2 scans, from scan_00 on, share a turntable's axis to 0.0123 mm\n"
            "registration: 5 pairs of scans, held-out points 0.0500 mm before, 0.0200 mm after: "
            "refined poses kept\n");
  result.registration.kept = false;
  EXPECT_NE(Joined(DescribeScans(result)).find("poses of the platform kept"), std::string::npos);
}

TEST(ScanReport, WarnsOfAProjectorThatExplainsItsPatternsBadly) {
  ScanResult result;
  result.rig.projector_rms_px = 0.19;
  EXPECT_EQ(Joined(DescribeScans(result)).find("warning"), std::string::npos);
  result.rig.projector_rms_px = 0.61;
  EXPECT_NE(Joined(DescribeScans(result)).find("warning: projector 0.61 px RMS"),
            std::string::npos);
}

}  // namespace
}  // namespace lfm
