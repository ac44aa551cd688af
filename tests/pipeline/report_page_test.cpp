// SPDX-License-Identifier: BSD-3-Clause
#include "pipeline/report_page.h"

#include <gtest/gtest.h>

#include "core/atomic_file.h"
#include "tests/support/scratch_folder.h"

namespace lfm {
namespace {

nlohmann::json SmallReport() {
  return {
      {"calib",
       {{"photos_used", 12}, {"rejected", {{{"id", "photo_3"}, {"reason", "no tags <found>"}}}}}},
      {"encode", {{"singular_value_share", {0.8, 0.15, 0.05}}}},
      {"time", {{"calib_s", 1.5}, {"total_s", 2.5}}},
      {"memory", {{"peak_mib", 100.0}}},
      {"options", {{"calib", {{"min-corners", 12}}}}}};
}

std::string WritePage(const nlohmann::json& report, const std::vector<ReportPicture>& pictures) {
  const ScratchFolder scratch;
  WriteReportPage("a <b> & \"c\"", report, pictures, scratch.folder / "index.html");
  return ReadFile(scratch.folder / "index.html");
}

TEST(ReportPage, EscapesEveryText) {
  const std::string page =
      WritePage(SmallReport(), {{"calib", "pictures/x.png", "<script>alert(1)</script>"}});
  EXPECT_EQ(page.find("<script"), std::string::npos);
  EXPECT_EQ(page.find("<found>"), std::string::npos);
  EXPECT_NE(page.find("a &lt;b&gt; &amp; &quot;c&quot;"), std::string::npos);
}

TEST(ReportPage, ShowsFiguresPicturesAndRejectedPhotographs) {
  const std::string page = WritePage(SmallReport(), {{"calib", "pictures/x.png", "the tags"}});
  EXPECT_NE(page.find("photos_used</td><td class=n>12<"), std::string::npos);
  EXPECT_NE(page.find("src=\"pictures/x.png\""), std::string::npos);
  EXPECT_NE(page.find("photo_3"), std::string::npos);
  EXPECT_NE(page.find("term 3"), std::string::npos);
}

TEST(ReportPage, ListsPhotographsThatWereNotScored) {
  nlohmann::json report = SmallReport();
  report["evaluate"] = {{"photos_scored", 0},
                        {"photos", nlohmann::json::array()},
                        {"missing", {{{"id", "photo_9"}, {"reason", "it has no pose"}}}},
                        {"note", "no score"}};
  const std::string page = WritePage(report, {});
  for (const char* part : {"photo_9", "it has no pose", "no score"}) {
    EXPECT_NE(page.find(part), std::string::npos) << part;
  }
}

TEST(ReportPage, ShowsWhatLensAndPlatformRequired) {
  nlohmann::json report = SmallReport();
  report["calib"]["lens_trials"] = {
      {"photo<1>",
       {{{"model", "k1"}, {"chosen", true}, {"heldout_rms_px", 0.0312}},
        {{"model", "k1 k2"}, {"chosen", false}}}}};
  report["calib"]["platform_trials"] = {
      {{"model", "as printed"}, {"chosen", true}, {"heldout_rms_px", 0.0456}}};
  const std::string page = WritePage(report, {});
  for (const char* part : {"photo&lt;1&gt;", "<b>k1</b>", "0.0312", "<td>k1 k2</td>", "folds over",
                           "<b>as printed</b>", "0.0456"}) {
    EXPECT_NE(page.find(part), std::string::npos) << part;
  }
}

TEST(ReportPage, FetchesNothing) {
  const std::string page = WritePage(SmallReport(), {});
  EXPECT_EQ(page.find("http://"), std::string::npos);
  EXPECT_EQ(page.find("https://"), std::string::npos);
}

TEST(ReportPage, LeavesOutStagesWithoutFigures) {
  EXPECT_EQ(WritePage(SmallReport(), {}).find("id=truth"), std::string::npos);
}

}  // namespace
}  // namespace lfm
