// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <filesystem>
#include <string>

#include "calib/calib_files.h"
#include "core/command_line.h"
#include "core/error.h"
#include "core/image.h"
#include "core/output_folder.h"
#include "scan/scan.h"
#include "scan/scan_files.h"
#include "scan/scan_pictures.h"
#include "scan/scan_report.h"

namespace {

struct OutputOptions {
  bool pictures = false;
  void Declare(lfm::OptionVisitor& v) {
    v.Flag({"pictures",
            "Also draw projector columns, fringe phase and confidence of every scan, into "
            "WORK/scan/pictures."},
           pictures);
  }
};

void DrawPictures(const lfm::Capture& capture, const lfm::ScanOptions& options,
                  const lfm::ScanResult& result, const std::filesystem::path& folder,
                  lfm::Progress& progress) {
  const lfm::ImageLoader load_image = lfm::MakeImageLoader(capture);
  const auto& scans = capture.scanner->scans;
  progress.Start("drawing", static_cast<int64_t>(scans.size()));
  for (size_t i = 0; i < scans.size(); ++i) {
    progress.Advance();
    const std::string& id = scans[i].id;
    const bool used = std::any_of(result.scans.begin(), result.scans.end(),
                                  [&](const lfm::ScanCloud& scan) { return scan.id == id; });
    if (!used) continue;
    const lfm::ScanPictures pictures =
        lfm::DrawScan(capture, static_cast<int>(i), load_image, options);
    lfm::WriteImage(pictures.columns, folder / (id + "_columns.png"));
    lfm::WriteImage(pictures.phase, folder / (id + "_phase.png"));
    lfm::WriteImage(pictures.confidence, folder / (id + "_confidence.png"));
  }
}

}  // namespace

int main(int argc, char** argv) {
  std::string capture_folder, work_folder;
  lfm::ScanOptions options;
  OutputOptions output;
  lfm::CommandLine command("lfm-scan",
                           "Calibrates the structured-light rig, decodes its scans, and writes the "
                           "measured points to WORK/scan.",
                           "lfm-scan demo/capture demo/work");
  command.Positional("CAPTURE", "capture folder (holds capture.json)", capture_folder);
  command.Positional("WORK", "workspace folder; WORK/calib from lfm-calib is read", work_folder);
  command.Options(lfm::AnyOptions(options), "Scan");
  command.Options(lfm::AnyOptions(output), "Output");
  return command.Run(argc, argv, [&](lfm::Progress& progress) {
    const std::filesystem::path work = work_folder;
    lfm::RequireWritableFolder(work / "scan");
    const lfm::Capture capture = lfm::LoadCapture(capture_folder);
    if (capture.board.empty()) {
      throw lfm::Error(capture_folder + "/capture.json names no board; scans need the platform");
    }
    const lfm::Board board = lfm::ReadBoard(capture.folder / capture.board);
    const lfm::CalibResult calib = lfm::CalibOfCapture(capture, work / "calib");
    const lfm::ScanResult result = lfm::Scan(capture, board, calib, lfm::MakeImageLoader(capture),
                                             options, progress, lfm::KnownRigOf(options));
    lfm::SaveScan(result, work / "scan");
    if (output.pictures) {
      DrawPictures(capture, options, result, work / "scan" / "pictures", progress);
    }
    for (const lfm::ScanFailure& failure : result.rejected) {
      progress.Note("set aside " + failure.id + ": " + failure.reason);
    }
    for (const std::string& line : lfm::DescribeScans(result)) progress.Note(line);
    progress.Note(std::to_string(result.points.points.size()) + " points of " +
                  std::to_string(result.scans.size()) + " scans; projector " +
                  std::to_string(result.rig.projector_rms_px) + " px RMS");
  });
}
