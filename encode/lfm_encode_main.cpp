// SPDX-License-Identifier: BSD-3-Clause
#include <cstdio>
#include <filesystem>
#include <string>

#include "calib/calib_files.h"
#include "core/command_line.h"
#include "core/image.h"
#include "core/output_folder.h"
#include "encode/encode.h"
#include "encode/encode_files.h"
#include "encode/encode_pictures.h"

namespace {

struct OutputOptions {
  bool pictures = false;
  void Declare(lfm::OptionVisitor& v) {
    v.Flag({"pictures", "Also write pictures of the maps to WORK/encode/pictures."}, pictures);
  }
};

std::string Figures(const lfm::EncodeResult& result, int64_t model_bytes) {
  char line[320];
  std::snprintf(line, sizeof line,
                "%.2f terms a vertex, %.1f : 1 (maps of %.1f MB), %.1f dB against the resampled "
                "light field (mean view alone: %.1f); model.glb %.1f MB",
                result.terms_mean, result.compression_ratio,
                static_cast<double>(result.maps_bytes) * 1e-6, result.matrix_psnr_db,
                result.matrix_psnr_mean_only_db, static_cast<double>(model_bytes) * 1e-6);
  std::string text = line;
  if (!result.transport.bytes.empty()) {
    std::snprintf(line, sizeof line, ", model.lfz %.2f MB",
                  static_cast<double>(result.transport.bytes.size()) * 1e-6);
    text += line;
  }
  return text;
}

// Where the photographs were taken; nothing where nobody asks or the calibration is not there.
std::vector<Eigen::Vector3d> Eyes(const std::filesystem::path& calib_folder,
                                  const lfm::LightField& light_field,
                                  const lfm::EncodeOptions& options, lfm::Progress& progress) {
  if (options.fill == lfm::DirectionFill::kBlend) return {};
  if (!std::filesystem::exists(calib_folder / "poses.json")) {
    progress.Note("no " + (calib_folder / "poses.json").string() +
                  ": directions are filled by blending alone");
    return {};
  }
  return lfm::EyesOfPhotos(lfm::LoadCalib(calib_folder), light_field.photo_ids());
}

}  // namespace

int main(int argc, char** argv) {
  lfm::CommandLine command(
      "lfm-encode",
      "Factorises and quantises the light field: WORK/resample/light_field.lfs "
      "and the places of the photographs, WORK/calib, go in; WORK/encode/model.glb, and the same "
      "for transport, model.lfz, come out.",
      "lfm-encode demo/work --terms 3");
  std::string work_folder;
  command.Positional("WORK", "workspace folder", work_folder);
  lfm::EncodeOptions options;
  OutputOptions output;
  command.Options(lfm::AnyOptions(options));
  command.Options(lfm::AnyOptions(output), "Output");
  return command.Run(argc, argv, [&](lfm::Progress& progress) {
    const std::filesystem::path work = work_folder;
    lfm::RequireWritableFolder(work / "encode");
    const lfm::LightField light_field =
        lfm::LightField::Open(work / "resample" / "light_field.lfs");
    const lfm::EncodeResult result =
        lfm::Encode(lfm::SourceFromLightField(light_field,
                                              Eyes(work / "calib", light_field, options, progress)),
                    options, progress);
    const int64_t model_bytes =
        lfm::SaveEncode(result, work / "encode").at("model_bytes").get<int64_t>();
    progress.Note(Figures(result, model_bytes));
    if (!output.pictures) return;
    for (const lfm::EncodePicture& picture :
         lfm::DrawEncodePictures(result.model, result.singular_value_share)) {
      lfm::WriteImage(picture.image, work / "encode" / "pictures" / (picture.name + ".png"));
    }
  });
}
