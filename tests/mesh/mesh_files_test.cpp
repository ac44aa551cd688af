// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/mesh_files.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "core/atomic_file.h"
#include "tests/mesh/test_shapes.h"
#include "tests/support/scratch_folder.h"

namespace lfm {
namespace {

using test::ErrorOf;

MeshResult MakeResult() {
  MeshResult result;
  result.surface = test::MakeSphere(30, 3, {0, 0, 30});
  result.mesh = test::MakeSphere(30, 2, {0, 0, 30});
  for (TriangleMesh* mesh : {&result.surface, &result.mesh}) {
    mesh->normals = ComputeVertexNormals(*mesh);
    mesh->confidence.assign(mesh->vertices.size(), 0.25f);
    mesh->confidence[3] = 0;
  }
  result.pixel_mm = 0.23;
  result.deviation_mean_mm = 0.04;
  result.deviation_p95_mm = 0.11;
  result.deviation_max_mm = 0.37;
  result.samples_per_triangle = 42.5;
  result.method = "wrap";
  result.reasons = {"wrap: as asked", "and why not"};
  result.carved_points = 17;
  result.mesh_self_intersections = 2;
  return result;
}

TEST(MeshFiles, WhatIsSavedIsLoaded) {
  const ScratchFolder scratch;
  const MeshResult saved = MakeResult();
  SaveMesh(saved, scratch.folder / "mesh");
  const MeshResult loaded = LoadMesh(scratch.folder / "mesh");
  EXPECT_TRUE(loaded.surface.vertices == saved.surface.vertices);
  EXPECT_TRUE(loaded.surface.triangles == saved.surface.triangles);
  EXPECT_TRUE(loaded.mesh.triangles == saved.mesh.triangles);
  EXPECT_TRUE(loaded.mesh.confidence == saved.mesh.confidence);
  EXPECT_EQ(loaded.pixel_mm, saved.pixel_mm);
  EXPECT_EQ(loaded.deviation_mean_mm, saved.deviation_mean_mm);
  EXPECT_EQ(loaded.deviation_p95_mm, saved.deviation_p95_mm);
  EXPECT_EQ(loaded.deviation_max_mm, saved.deviation_max_mm);
  EXPECT_EQ(loaded.samples_per_triangle, saved.samples_per_triangle);
  EXPECT_EQ(loaded.method, saved.method);
  EXPECT_EQ(loaded.reasons, saved.reasons);
  EXPECT_EQ(loaded.carved_points, saved.carved_points);
  EXPECT_EQ(loaded.surface_self_intersections, 0);
  EXPECT_EQ(loaded.mesh_self_intersections, 2);
}

TEST(MeshFiles, SameResultSameBytes) {
  const ScratchFolder scratch;
  SaveMesh(MakeResult(), scratch.folder / "a");
  SaveMesh(MakeResult(), scratch.folder / "b");
  for (const char* name : {"surface.ply", "mesh.ply", "mesh.json"}) {
    EXPECT_EQ(ReadFile(scratch.folder / "a" / name), ReadFile(scratch.folder / "b" / name));
  }
}

TEST(MeshFiles, MissingAndTruncatedFilesAreNamed) {
  const ScratchFolder scratch;
  EXPECT_NE(ErrorOf([&] { LoadMesh(scratch.folder); }).find("mesh.json"), std::string::npos);
  for (const char* name : {"surface.ply", "mesh.ply", "mesh.json"}) {
    const auto file = scratch.folder / name;
    SaveMesh(MakeResult(), scratch.folder);
    std::filesystem::resize_file(file, std::filesystem::file_size(file) / 2);
    EXPECT_NE(ErrorOf([&] { LoadMesh(scratch.folder); }).find(name), std::string::npos);
    std::filesystem::remove(file);
    EXPECT_NE(ErrorOf([&] { LoadMesh(scratch.folder); }).find(name), std::string::npos);
  }
}

TEST(MeshFiles, HostileFiguresAreRefused) {
  const ScratchFolder scratch;
  SaveMesh(MakeResult(), scratch.folder);
  const std::string good = ReadFile(scratch.folder / "mesh.json");
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string changed = good;
    const size_t at = changed.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    changed.replace(at, from.size(), to);
    std::ofstream(scratch.folder / "mesh.json") << changed;
    return ErrorOf([&] { LoadMesh(scratch.folder); });
  };
  EXPECT_EQ(with("0.23", "0.24"), "");
  EXPECT_NE(with("0.23", "-1"), "");
  EXPECT_NE(with("0.23", "1e999"), "");
  EXPECT_NE(with("\"pixel_mm\"", "\"pixel\""), "");
  EXPECT_NE(with("\"version\": 2", "\"version\": 1"), "");
  EXPECT_NE(with("1280", "1281"), "");
  EXPECT_NE(with("\"carved_points\": 17", "\"carved_points\": -1"), "");
  EXPECT_NE(with("\"method\": \"wrap\"", "\"method\": 3"), "");
}

TEST(MeshFiles, MixedUpMeshesAreNoticed) {
  const ScratchFolder scratch;
  SaveMesh(MakeResult(), scratch.folder);
  std::filesystem::copy_file(scratch.folder / "surface.ply", scratch.folder / "mesh.ply",
                             std::filesystem::copy_options::overwrite_existing);
  EXPECT_NE(ErrorOf([&] { LoadMesh(scratch.folder); }).find("mesh.ply"), std::string::npos);
}

}  // namespace
}  // namespace lfm
