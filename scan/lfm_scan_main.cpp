// SPDX-License-Identifier: BSD-3-Clause
#include <filesystem>
#include <string>

#include "calib/calib_files.h"
#include "core/command_line.h"
#include "core/error.h"
#include "scan/scan.h"
#include "scan/scan_files.h"

int main(int argc, char** argv) {
  std::string capture_folder, work_folder;
  lfm::ScanOptions options;
  lfm::CommandLine command("lfm-scan",
                           "Calibrates the structured-light rig, decodes its scans, and writes the "
                           "measured points to WORK/scan.",
                           "lfm-scan demo/capture demo/work");
  command.Positional("CAPTURE", "capture folder (holds capture.json)", capture_folder);
  command.Positional("WORK", "workspace folder; WORK/calib from lfm-calib is read", work_folder);
  command.Options(lfm::AnyOptions(options), "Scan");
  return command.Run(argc, argv, [&](lfm::Progress& progress) {
    const lfm::Capture capture = lfm::LoadCapture(capture_folder);
    if (capture.board.empty()) {
      throw lfm::Error(capture_folder + "/capture.json names no board; scans need the platform");
    }
    const std::filesystem::path work = work_folder;
    const lfm::Board board = lfm::ReadBoard(capture.folder / capture.board);
    const lfm::CalibResult calib = lfm::LoadCalib(work / "calib");
    const lfm::ScanResult result =
        lfm::Scan(capture, board, calib, lfm::MakeImageLoader(capture), options, progress);
    lfm::SaveScan(result, work / "scan");
    for (const lfm::ScanFailure& failure : result.rejected) {
      progress.Note("set aside " + failure.id + ": " + failure.reason);
    }
    progress.Note(std::to_string(result.points.points.size()) + " points of " +
                  std::to_string(result.scans.size()) + " scans; projector " +
                  std::to_string(result.rig.projector_rms_px) + " px RMS");
  });
}
