// SPDX-License-Identifier: BSD-3-Clause
#include <cstdio>
#include <filesystem>
#include <string>

#include "calib/calib_files.h"
#include "core/atomic_file.h"
#include "core/command_line.h"
#include "core/error.h"
#include "core/image.h"
#include "core/output_folder.h"
#include "encode/afx.h"
#include "encode/encode.h"
#include "encode/encode_files.h"
#include "encode/encode_pictures.h"
#include "encode/memory_need.h"
#include "encode/option_effects.h"
#include "fields/field_encoding.h"
#include "fields/relightable_file.h"
#include "fields/vertex_functions.h"

namespace {

/// What MPEG-4 AFX is written with.
enum class Afx { kOff, kDisc, kAsTheyAre };

struct OutputOptions {
  bool pictures = false;
  Afx afx = Afx::kOff;
  void Declare(lfm::OptionVisitor& v) {
    v.Flag({"pictures", "Also write pictures of the maps to WORK/encode/pictures."}, pictures);
    v.Enumeration({"afx",
                   "Also write the model as MPEG-4 AFX: WORK/encode/model.wrl, pictures in "
                   "model_afx. View maps are brought onto the disc that AFX has (disc), or kept "
                   "in a form that only lfm reads (as-is)."},
                  {"off", "disc", "as-is"}, afx);
  }
};

/// The light field as functions of vertices in place of surface and view maps.
struct VertexModelOptions {
  bool vertex_model = false;
  lfm::VertexFunctionOptions functions;
  lfm::FieldEncodeOptions encode;
  void Declare(lfm::OptionVisitor& v) {
    v.Flag({"vertex-model",
            "Write WORK/encode/model.lfr, and leave model.glb as it is: what each vertex sends "
            "into every "
            "direction, in clusters with a basis each (--field-method and the options below)."},
           vertex_model);
    functions.Declare(v);
    encode.Declare(v);
  }
};

void EncodeVertices(const lfm::LightField& light_field, const VertexModelOptions& options,
                    const std::filesystem::path& folder, lfm::Progress& progress) {
  const lfm::VertexFunctions vertices =
      lfm::ReadVertexFunctions(light_field, options.functions, progress);
  lfm::FieldEncodeResult result = lfm::EncodeField(vertices.field, options.encode, progress);
  result.model.triangles = light_field.mesh().triangles;
  result.figures["unseen_vertices"] = vertices.unseen_vertices.size();
  lfm::WriteRelightable(result.model, folder / "model.lfr");
  lfm::WriteFileAtomically(folder / "vertex_model.json", result.figures.dump(2) + "\n");
  char line[200];
  std::snprintf(line, sizeof line, "%lld vertices, %.1f : 1; model.lfr %.2f MB",
                static_cast<long long>(vertices.field.points),
                result.figures["compression_ratio"].get<double>(),
                result.figures["model_bytes"].get<double>() * 1e-6);
  std::string text = line;
  if (result.figures.contains("relative_error")) {
    std::snprintf(line, sizeof line, "; relative error %.5f, without residual %.5f",
                  result.figures["relative_error"].get<double>(),
                  result.figures["relative_error_without_residual"].get<double>());
    text += line;
  }
  progress.Note(text);
}

std::string WriteAfx(const lfm::LightFieldModel& model, const OutputOptions& output,
                     const std::filesystem::path& folder) {
  const auto view_maps =
      output.afx == Afx::kDisc ? lfm::AfxViewMaps::kDisc : lfm::AfxViewMaps::kAsTheyAre;
  const int64_t bytes = lfm::SaveAfx(lfm::WriteAfxForm(lfm::AfxForm(model, view_maps)), folder);
  char text[80];
  std::snprintf(text, sizeof text, "model.wrl and its pictures %.1f MB",
                static_cast<double>(bytes) * 1e-6);
  return text;
}

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

// Where the photographs were taken. Nothing where nobody asks, or where the calibration is not
// there: unless mirror directions are more than the default.
std::vector<Eigen::Vector3d> Eyes(const std::filesystem::path& calib_folder,
                                  const lfm::LightField& light_field,
                                  const lfm::EncodeOptions& options, bool fill_given,
                                  lfm::Progress& progress) {
  if (options.fill == lfm::DirectionFill::kBlend ||
      options.factorization == lfm::Factorization::kNmf) {
    return {};
  }
  const std::filesystem::path poses = calib_folder / "poses.json";
  if (!std::filesystem::exists(poses)) {
    if (fill_given) {
      throw lfm::Error(poses.string() +
                       ": no such file, and --fill mirror needs it; run lfm-calib, or take --fill "
                       "blend");
    }
    progress.Note("no " + poses.string() + ": directions are filled by blending alone");
    return {};
  }
  return lfm::EyesOfPhotos(lfm::LoadCalib(calib_folder), light_field.photo_ids(),
                           light_field.name());
}

}  // namespace

int main(int argc, char** argv) {
  lfm::CommandLine command(
      "lfm-encode",
      "Factorises and quantises the light field: WORK/resample/light_field.lfs "
      "and the places of the photographs, WORK/calib, go in; WORK/encode/model.glb, and the same "
      "for transport, model.lfz, come out; with --vertex-model functions of vertices, model.lfr.",
      "lfm-encode demo/work --term-gain 0.5");
  std::string work_folder;
  command.Positional("WORK", "workspace folder", work_folder);
  lfm::EncodeOptions options;
  OutputOptions output;
  command.Options(lfm::AnyOptions(options));
  command.Options(lfm::AnyOptions(output), "Output");
  VertexModelOptions vertices;
  command.Options(lfm::AnyOptions(vertices), "Functions of vertices");
  return command.Run(argc, argv, [&](lfm::Progress& progress) {
    const std::filesystem::path work = work_folder;
    const auto given = [&command](const std::string& name) { return command.Given(name); };
    lfm::RequireEffect(options, given);
    if (output.afx != Afx::kOff && options.factorization == lfm::Factorization::kNmf) {
      throw lfm::Error(
          "--afx: nonnegative terms hold the mean view, which AFX would add twice; take "
          "--factorization pca");
    }
    if (output.afx != Afx::kOff && options.compression.WantsCodebooks()) {
      throw lfm::Error("--afx: AFX is written of whole maps; leave --vq-ratio and --vq-db out");
    }
    if (output.afx != Afx::kOff && lfm::ChoosesDetail(options)) {
      if ((given("patch-detail") && options.patch_detail == lfm::MapDetail::kAsNeeded) ||
          (given("view-detail") && options.view_detail == lfm::MapDetail::kAsNeeded)) {
        throw lfm::Error(
            "--afx: AFX is written of whole maps; leave --patch-detail and --view-detail out");
      }
      options.patch_detail = options.view_detail = lfm::MapDetail::kFull;
      progress.Note("AFX is written of whole maps: --patch-detail full --view-detail full");
    }
    lfm::RequireWritableFolder(work / "encode");
    const lfm::LightField light_field = lfm::LightField::Open(work / "resample" / "light_field.lfs",
                                                              lfm::ResidentFileBytes(options));
    if (vertices.vertex_model) {
      EncodeVertices(light_field, vertices, work / "encode", progress);
      return;
    }
    const lfm::LightFieldSource source = lfm::SourceFromLightField(
        light_field, Eyes(work / "calib", light_field, options, given("fill"), progress));
    const lfm::EncodeResult result = lfm::Encode(source, options, progress);
    const int64_t model_bytes =
        lfm::SaveEncode(result, work / "encode").at("model_bytes").get<int64_t>();
    progress.Note(Figures(result, model_bytes));
    if (output.afx == Afx::kOff) {
      lfm::RemoveAfx(work / "encode");  // an earlier model's
    } else {
      progress.Note(WriteAfx(result.model, output, work / "encode"));
    }
    lfm::RemoveEncodePictures(work / "encode" / "pictures");
    if (!output.pictures) return;
    for (const lfm::EncodePicture& picture :
         lfm::DrawEncodePictures(result.model, result.singular_value_share)) {
      lfm::WriteImage(picture.image, work / "encode" / "pictures" / (picture.name + ".png"));
    }
  });
}
