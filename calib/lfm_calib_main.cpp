// SPDX-License-Identifier: BSD-3-Clause
#include <cstdio>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "calib/board.h"
#include "calib/calib.h"
#include "calib/calib_files.h"
#include "calib/calib_pictures.h"
#include "core/capture.h"
#include "core/command_line.h"
#include "core/output_folder.h"

namespace {

struct CommandOptions {
  bool pictures = false;
  void Declare(lfm::OptionVisitor& v) {
    v.Flag({"pictures",
            "Also draw tags and residuals on every picture, into "
            "WORK/calib/pictures/KIND-ID.png."},
           pictures);
  }
};

void DrawPictures(const lfm::Capture& capture, const lfm::CalibResult& result,
                  const std::filesystem::path& folder, lfm::Progress& progress) {
  const lfm::Board board = lfm::ReadBoard(capture.folder / capture.board);
  const lfm::ImageLoader load_image = lfm::MakeImageLoader(capture);
  progress.Start("drawing", static_cast<int64_t>(result.photos.size() + result.scans.size() +
                                                 result.placements.size()));
  const std::pair<const char*, const std::vector<lfm::PosedImage>&> kinds[] = {
      {"photo", result.photos}, {"scan", result.scans}, {"placement", result.placements}};
  // A photograph, a scan and a placement may share an id.
  for (const auto& [kind, images] : kinds) {
    for (const lfm::PosedImage& image : images) {
      const lfm::Image drawing =
          lfm::DrawCalibration(load_image(image.file), board, result.cameras.at(image.camera),
                               result.platform_shape, image);
      lfm::WriteImage(drawing, folder / (std::string(kind) + "-" + image.id + ".png"));
      progress.Advance();
    }
  }
}

void Report(const lfm::CalibResult& result, lfm::Progress& progress) {
  for (const lfm::RejectedImage& image : result.rejected) {
    progress.Note("set aside " + image.file + ": " + image.reason);
  }
  char line[200];
  std::snprintf(line, sizeof line,
                "%zu photographs, %zu scans, %zu placements posed, %zu pictures set aside; "
                "reprojection RMS %.3f px",
                result.photos.size(), result.scans.size(), result.placements.size(),
                result.rejected.size(), result.reprojection_rms_px);
  progress.Note(line);
}

}  // namespace

int main(int argc, char** argv) {
  std::string capture_folder, work_folder;
  lfm::CalibOptions options;
  CommandOptions command_options;
  lfm::CommandLine command("lfm-calib",
                           "Finds the platform in every photograph and scan: cameras and poses.",
                           "lfm-calib demo/capture demo/work");
  command.Positional("CAPTURE", "Folder that holds capture.json.", capture_folder);
  command.Positional("WORK", "Workspace folder; WORK/calib is written.", work_folder);
  command.Options(lfm::AnyOptions(options), "Calibration");
  command.Options(lfm::AnyOptions(command_options));
  return command.Run(argc, argv, [&](lfm::Progress& progress) {
    const std::filesystem::path folder = std::filesystem::path(work_folder) / "calib";
    lfm::RequireWritableFolder(folder);
    const lfm::Capture capture = lfm::LoadCapture(capture_folder);
    const lfm::CalibResult result = lfm::CalibrateCapture(capture, options, progress);
    lfm::SaveCalib(result, folder);
    if (command_options.pictures && !capture.board.empty()) {
      DrawPictures(capture, result, folder / "pictures", progress);
    }
    Report(result, progress);
  });
}
