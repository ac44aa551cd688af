// SPDX-License-Identifier: BSD-3-Clause
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/atomic_file.h"
#include "core/command_line.h"
#include "core/error.h"
#include "core/output_folder.h"
#include "core/ply.h"
#include "fields/analysis.h"
#include "fields/field_capture.h"
#include "fields/field_reading.h"
#include "fields/transport_reading.h"
#include "fields/vertex_functions.h"
#include "resample/light_field.h"

namespace {

namespace fs = std::filesystem;

struct OutputOptions {
  std::string out;
  void Declare(lfm::OptionVisitor& v) {
    v.Text({"out", "Folder for analysis.json and the charts; default: IN/analyze."}, out);
  }
};

/// A field and, of a mesh, its triangles.
struct Subject {
  lfm::Field field;
  std::vector<Eigen::Vector3i> triangles;
};

Subject ReadWork(const fs::path& file, const lfm::VertexFunctionOptions& options,
                 lfm::Progress& progress) {
  const lfm::LightField light_field = lfm::LightField::Open(file);
  Subject subject{lfm::ReadVertexFunctions(light_field, options, progress).field,
                  light_field.mesh().triangles};
  return subject;
}

Subject ReadCapture(const fs::path& path, const lfm::FieldCaptureOptions& capture_options,
                    const lfm::FieldReadOptions& read_options, lfm::Progress& progress) {
  const lfm::Capture capture = lfm::OpenFieldCapture(path, capture_options, progress);
  if (capture.reflectance_field) {
    return {lfm::ReadReflectanceField(capture, read_options, progress).train, {}};
  }
  Subject subject{lfm::ReadTransportField(capture, {}, progress), {}};
  if (capture.transport->kind == lfm::TransportKind::kMesh) {
    // Of one eye: points of several repeat the vertices.
    if (capture.transport->eyes.size() == 1) {
      subject.triangles = lfm::ReadPlyMesh(capture.folder / capture.transport->mesh).triangles;
    }
  }
  return subject;
}

void WriteResult(const lfm::AnalysisResult& result, const fs::path& folder) {
  lfm::WriteFilesTogether(folder, [&](const fs::path& files) {
    lfm::WriteFileAtomically(files / "analysis.json", lfm::AnalysisToJson(result).dump(2) + "\n");
    lfm::WriteFileAtomically(files / "dimensions.svg", lfm::AnalysisToSvg(result));
    if (!result.block_costs.empty()) {
      lfm::WriteFileAtomically(files / "block_costs.svg", lfm::BlockCostsToSvg(result));
    }
  });
}

}  // namespace

int main(int argc, char** argv) {
  lfm::CommandLine command(
      "lfm-analyze",
      "How many terms a patch needs against its area, how large patches should be, and what they "
      "cost (Mahajan 2007): of a capture with a reflectance field or light transport, or of a "
      "workspace's light field. analysis.json and charts come out, a finding a line on standard "
      "output.",
      "lfm-analyze demo/plant --out demo/plant_analysis");
  std::string in;
  command.Positional("IN", "capture (folder, .lp file or DiLiGenT folder) or workspace folder", in);
  lfm::AnalysisOptions options;
  OutputOptions output;
  lfm::FieldCaptureOptions capture_options;
  lfm::FieldReadOptions read_options;
  lfm::VertexFunctionOptions vertex_options;
  command.Options(lfm::AnyOptions(options));
  command.Options(lfm::AnyOptions(output), "Output");
  command.Options(lfm::AnyOptions(capture_options), "Captures of other programs");
  command.Options(lfm::AnyOptions(read_options), "Reflectance fields");
  command.Options(lfm::AnyOptions(vertex_options), "Light fields");
  return command.Run(argc, argv, [&](lfm::Progress& progress) {
    const fs::path path = in;
    const fs::path folder = output.out.empty()
                                ? (fs::is_directory(path) ? path : path.parent_path()) / "analyze"
                                : fs::path(output.out);
    lfm::CheckAnalysisOptions(options);
    lfm::RequireWritableFolder(folder);
    const fs::path light_field = path / "resample" / "light_field.lfs";
    const Subject subject = fs::exists(light_field)
                                ? ReadWork(light_field, vertex_options, progress)
                                : ReadCapture(path, capture_options, read_options, progress);
    const lfm::AnalysisResult result =
        lfm::AnalyzeField(subject.field, subject.triangles, {}, options, progress);
    WriteResult(result, folder);
    for (const std::string& line : lfm::Findings(result)) std::printf("%s\n", line.c_str());
  });
}
