// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/mesh_files.h"

#include <string>

#include "core/atomic_file.h"
#include "core/error.h"
#include "core/json_reader.h"
#include "core/ply.h"

namespace lfm {
namespace {

constexpr int kVersion = 2;

nlohmann::json CountsToJson(const TriangleMesh& mesh) {
  const MeshTopology topology = ExamineTopology(mesh);
  return {{"vertices", mesh.vertices.size()},
          {"triangles", mesh.triangles.size()},
          {"components", topology.components},
          {"closed_manifold", topology.closed && topology.manifold}};
}

constexpr int kMost = 2000000000;

// Returns the self-intersections that were left.
int CheckCounts(JsonReader reader, const TriangleMesh& mesh, const std::string& file) {
  const int vertices = reader.Integer("vertices", 0, kMost);
  const int triangles = reader.Integer("triangles", 0, kMost);
  reader.Integer("components", 0, kMost);
  reader.Bool("closed_manifold");
  const int self_intersections = reader.Integer("self_intersections", 0, kMost);
  reader.Finish();
  if (static_cast<size_t>(vertices) != mesh.vertices.size() ||
      static_cast<size_t>(triangles) != mesh.triangles.size()) {
    throw Error(file + ": its size differs from what mesh.json says; run lfm-mesh again");
  }
  return self_intersections;
}

TriangleMesh ReadWithData(const std::filesystem::path& file) {
  TriangleMesh mesh = ReadPlyMesh(file);
  ValidateMesh(mesh, file.string().c_str());
  if (mesh.normals.empty() || mesh.confidence.empty()) {
    throw Error(file.string() + ": normals or confidence are missing; run lfm-mesh again");
  }
  return mesh;
}

}  // namespace

void SaveMesh(const MeshResult& result, const std::filesystem::path& folder) {
  nlohmann::json json = {{"version", kVersion},
                         {"method", result.method},
                         {"reasons", result.reasons},
                         {"carved_points", result.carved_points},
                         {"pixel_mm", result.pixel_mm},
                         {"samples_per_triangle", result.samples_per_triangle},
                         {"deviation_mean_mm", result.deviation_mean_mm},
                         {"deviation_p95_mm", result.deviation_p95_mm},
                         {"deviation_max_mm", result.deviation_max_mm},
                         {"surface", CountsToJson(result.surface)},
                         {"mesh", CountsToJson(result.mesh)}};
  json["surface"]["self_intersections"] = result.surface_self_intersections;
  json["mesh"]["self_intersections"] = result.mesh_self_intersections;
  WriteFilesTogether(folder, [&](const std::filesystem::path& together) {
    WritePly(result.surface, together / "surface.ply");
    WritePly(result.mesh, together / "mesh.ply");
    WriteJson(json, together / "mesh.json");
  });
}

MeshResult LoadMesh(const std::filesystem::path& folder) {
  const std::filesystem::path file = folder / "mesh.json";
  const nlohmann::json json = ReadJson(file);
  JsonReader reader(json, file.string());
  reader.Integer("version", kVersion, kVersion);
  MeshResult result;
  result.pixel_mm = reader.Number("pixel_mm");
  if (!(result.pixel_mm > 0)) reader.Fail("pixel_mm", "expected a positive number");
  result.deviation_mean_mm = reader.Number("deviation_mean_mm");
  result.deviation_p95_mm = reader.Number("deviation_p95_mm");
  result.deviation_max_mm = reader.Number("deviation_max_mm");
  result.samples_per_triangle = reader.Number("samples_per_triangle");
  result.method = reader.Text("method");
  result.reasons = reader.Texts("reasons");
  result.carved_points = reader.Integer("carved_points", 0, kMost);
  result.surface = ReadWithData(folder / "surface.ply");
  result.mesh = ReadWithData(folder / "mesh.ply");
  result.surface_self_intersections =
      CheckCounts(reader.Object("surface"), result.surface, (folder / "surface.ply").string());
  result.mesh_self_intersections =
      CheckCounts(reader.Object("mesh"), result.mesh, (folder / "mesh.ply").string());
  reader.Finish();
  return result;
}

}  // namespace lfm
