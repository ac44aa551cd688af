// SPDX-License-Identifier: BSD-3-Clause
// The command, and the capture in sample_data/tiny that it made.
#include <gtest/gtest.h>

#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <string>

#include "calib/board.h"
#include "core/atomic_file.h"
#include "core/capture.h"
#include "tests/support/scratch_folder.h"

namespace lfm {
namespace {

TEST(TinyCapture, LoadsCompleteAndStaysSmall) {
  const std::filesystem::path folder = std::filesystem::path(LFM_SOURCE_DIR) / "sample_data/tiny";
  const Capture capture = LoadCapture(folder);
  const Capture truth = LoadCapture(folder / "ground_truth");
  EXPECT_TRUE(truth.BringsGeometry());
  EXPECT_GE(capture.photos.size(), 20u);
  const ImageLoader load = MakeImageLoader(capture);
  for (const Photo& photo : capture.photos) EXPECT_EQ(load(photo.file).width(), 320);
  ASSERT_TRUE(capture.scanner);
  for (const ScanSet& set : capture.scanner->placements) {
    for (const std::string& frame : set.frames) EXPECT_EQ(load(frame).channels(), 1);
  }
  uintmax_t bytes = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    if (entry.is_regular_file()) bytes += entry.file_size();
  }
  EXPECT_LE(bytes, 2'000'000u);
}

int RunCommand(const std::string& arguments) {
  const std::string command =
      std::string(LFM_BIN_DIR) + "/lfm-capture " + arguments + " > /dev/null 2>&1";
  return WEXITSTATUS(std::system(command.c_str()));
}

TEST(CaptureCommand, ExitsAsDocumented) {
  EXPECT_EQ(RunCommand("--help"), 0);
  EXPECT_EQ(RunCommand(""), 2);
  EXPECT_EQ(RunCommand("--out /nowhere/x --photos -3"), 2);
  EXPECT_EQ(RunCommand("--out /proc/none/x --tiny --photos 1 --test-photos 0 --scans 0 "
                       "--placements 0 --photo-width 32 --photo-height 24 --edge 4"),
            2);
}

TEST(CaptureCommand, OptionsThatCannotBeFollowedLeaveNoFolderAndAnEarlierCaptureAsItIs) {
  const ScratchFolder scratch;
  Board metres = DefaultBoard();
  metres.width_mm /= 1000, metres.height_mm /= 1000, metres.tag_size_mm /= 1000;
  metres.checker_square_mm /= 1000;
  for (BoardTag& tag : metres.tags) tag.center_mm /= 1000;
  const std::string board = (scratch.folder / "metres.json").string();
  WriteBoard(metres, board);
  const std::filesystem::path fresh = scratch.folder / "fresh",
                              earlier = scratch.folder / "earlier";
  WriteFileAtomically(earlier / "capture.json", "an earlier capture");
  for (const std::string& options : {std::string("--scene nope"), std::string("--mesh nope.ply"),
                                     std::string("--board nope.json"), "--board " + board,
                                     std::string("--photos 4 --test-photos 9")}) {
    for (const std::filesystem::path& folder : {fresh, earlier}) {
      EXPECT_EQ(RunCommand("--tiny --out " + folder.string() + " " + options), 2) << options;
    }
    EXPECT_FALSE(std::filesystem::exists(fresh)) << options;
    EXPECT_EQ(ReadFile(earlier / "capture.json"), "an earlier capture") << options;
  }
}

}  // namespace
}  // namespace lfm
