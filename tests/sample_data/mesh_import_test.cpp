// SPDX-License-Identifier: BSD-3-Clause
#include "sample_data/mesh_import.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <set>

#include "core/error.h"
#include "core/image.h"
#include "core/ply.h"
#include "tests/support/scratch_folder.h"

namespace lfm {
namespace {

class MeshImportTest : public testing::Test {
 protected:
  std::filesystem::path Write(const std::string& name, const std::string& text) {
    const std::filesystem::path file = scratch_.folder / name;
    std::ofstream(file, std::ios::binary) << text;
    return file;
  }
  // The message of the error, which must be one line that names the file.
  std::string Failure(const std::filesystem::path& file) {
    try {
      ImportMesh(file);
    } catch (const Error& e) {
      const std::string what = e.what();
      EXPECT_NE(what.find(file.string()), what.npos) << what;
      EXPECT_EQ(what.find('\n'), what.npos) << what;
      return what;
    }
    return "";
  }
  ScratchFolder scratch_;
};

constexpr char kTetrahedron[] =
    "# a comment\nmtllib none.mtl\no thing\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n"
    "f 1 3 2\nf 1 2 4\nusemtl m\nf 2 3 4\nf 1 4 3\n";

TEST_F(MeshImportTest, ReadsObjWithGroupsPolygonsAndRelativeIndices) {
  const ImportedMesh solid = ImportMesh(Write("solid.obj", kTetrahedron));
  ASSERT_EQ(solid.warnings.size(), 1u);
  EXPECT_NE(solid.warnings[0].find("there is no file"), std::string::npos);
  EXPECT_TRUE(ExamineTopology(solid.mesh).closed);
  EXPECT_NEAR(SignedVolume(solid.mesh), 1.0 / 6, 1e-12);
  const ImportedMesh quad = ImportMesh(
      Write("quad.OBJ",
            "v 0 0 0\r\nv 2 0 0\r\nv 2 \\\n 2 0\nv 0 2 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n"
            "vn 0 0 2\nf -4/-4/1 -3/-3/1 -2/-2/1 -1/-1/1\n"));
  ASSERT_EQ(quad.mesh.triangles.size(), 2u);
  ASSERT_EQ(quad.uv.size(), 4u);
  EXPECT_EQ(quad.uv[2], Eigen::Vector2f(1, 1));
  EXPECT_EQ(quad.mesh.normals[0], Eigen::Vector3d(0, 0, 1));
  EXPECT_EQ(quad.mesh.vertices[2], Eigen::Vector3d(2, 2, 0));
}

// A corner with other texture coordinates is another vertex, but no hole.
TEST_F(MeshImportTest, SeamsOfTextureCoordinatesAreNoHoles) {
  const ImportedMesh seam =
      ImportMesh(Write("seam.obj",
                       "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nvt 0 0\nvt 1 0\nvt 0 1\nvt 1 1\n"
                       "f 1/1 3/3 2/2\nf 1/4 2/3 4/1\nf 2/1 3/2 4/3\nf 1/2 4/4 3/1\n"));
  EXPECT_GT(seam.mesh.vertices.size(), 4u);
  EXPECT_EQ(seam.uv.size(), seam.mesh.vertices.size());
  EXPECT_TRUE(seam.warnings.empty());
}

TEST_F(MeshImportTest, ReadsPlyWithTextureCoordinatesAndColours) {
  const ImportedMesh mesh = ImportMesh(Write(
      "m.ply",
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float "
      "z\n"
      "property float s\nproperty float t\nproperty uchar red\nproperty uchar green\n"
      "property uchar blue\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
      "0 0 0 0.25 0.5 255 0 0\n1 0 0 1 0 0 255 0\n0 1 0 0 1 0 0 255\n3 0 1 2\n"));
  ASSERT_EQ(mesh.uv.size(), 3u);
  EXPECT_EQ(mesh.uv[0], Eigen::Vector2f(0.25f, 0.5f));
  ASSERT_EQ(mesh.mesh.colors.size(), 3u);
  EXPECT_EQ(mesh.mesh.colors[1], Eigen::Vector3f(0, 1, 0));
  EXPECT_EQ(mesh.mesh.normals[0], Eigen::Vector3d(0, 0, 1));
}

TEST_F(MeshImportTest, RepairsAndSaysSo) {
  const ImportedMesh mesh =
      ImportMesh(Write("repair.obj",
                       "v 9 9 9\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 2 0 0\nv 1 1 1\n"
                       "f 2 3 4\nf 2 3 5\nf 2 2 3\n"));
  EXPECT_EQ(mesh.mesh.triangles.size(), 1u);
  EXPECT_EQ(mesh.mesh.vertices.size(), 3u);
  ASSERT_EQ(mesh.warnings.size(), 3u);
  EXPECT_EQ(mesh.warnings[0], "2 triangles of no area dropped");
  EXPECT_EQ(mesh.warnings[1], "dropped points of no triangle: 1");
  EXPECT_NE(mesh.warnings[2].find("holes: 3 open edges"), std::string::npos);
}

TEST_F(MeshImportTest, ReportsEdgesOfThreeTriangles) {
  const ImportedMesh mesh = ImportMesh(Write(
      "fan.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nv 0 -1 0\nf 1 2 3\nf 1 2 4\nf 1 2 5\n"));
  ASSERT_EQ(mesh.warnings.size(), 2u);
  EXPECT_NE(mesh.warnings[1].find("no clean surface"), std::string::npos);
}

// Two materials, one with a picture of two colours, its name with a space and behind options.
TEST_F(MeshImportTest, TakesColoursFromMaterialsAndTheirPictures) {
  Image picture(2, 1, 3, PixelType::kUint8, ColorEncoding::kSrgb);
  for (int c = 0; c < 3; ++c) picture.At<uint8_t>(c == 0 ? 0 : 1, 0, c) = 255;  // red, cyan
  WriteImage(picture, scratch_.folder / "two colours.png");
  Write("m.mtl",
        "# library\nnewmtl plain\nKa 1 1 1\nKd 0.25 0.5 1\nmap_Ks gone.png\n"
        "newmtl pictured\nKd 1 1 1\nmap_Kd -s 1 1 1 -clamp on two colours.png\n");
  const ImportedMesh mesh = ImportMesh(
      Write("m.obj",
            "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nvt 0.25 0.5\nvt 0.75 0.5\n"
            "usemtl plain\nf 1/1 3/1 2/1\nusemtl pictured\nf 1/1 2/2 4/1\nf 2/1 3/2 4/1\n"
            "f 1/1 4/2 3/1\n"));
  EXPECT_TRUE(mesh.warnings.empty());
  ASSERT_EQ(mesh.materials.size(), 2u);
  const std::vector<Eigen::Vector3f> colors = MaterialColors(mesh);
  ASSERT_EQ(colors.size(), mesh.mesh.vertices.size());
  std::set<std::vector<int>> seen;
  for (size_t v = 0; v < colors.size(); ++v) {
    std::vector<int> color = {mesh.material[v]};
    for (int c = 0; c < 3; ++c) {
      color.push_back(static_cast<int>(std::lround(100 * LinearFromSrgb(colors[v][c]))));
    }
    seen.insert(color);
  }
  EXPECT_EQ(seen, (std::set<std::vector<int>>{{0, 25, 50, 100}, {1, 100, 0, 0}, {1, 0, 100, 100}}));
}

TEST_F(MeshImportTest, APictureThatIsNoneAndAMaterialThatIsNowhereAreNamed) {
  Write("no.png", "this is no picture");
  Write("m.mtl", "newmtl a\nmap_Kd no.png\n");
  const std::string body = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nf 1/1 2/1 3/1\n";
  const ImportedMesh bad = ImportMesh(Write("bad.obj", "mtllib m.mtl\nusemtl a\n" + body));
  try {
    MaterialColors(bad);
    ADD_FAILURE() << "no error";
  } catch (const Error& e) {
    EXPECT_NE(std::string(e.what()).find("no.png"), std::string::npos) << e.what();
  }
  const ImportedMesh lost = ImportMesh(Write("lost.obj", "mtllib m.mtl\nusemtl b\n" + body));
  EXPECT_NE(lost.warnings.at(0).find("material 'b'"), std::string::npos);
  EXPECT_EQ(lost.material, std::vector<int>(3, -1));
  EXPECT_NEAR(LinearFromSrgb(MaterialColors(lost).at(0).x()), 0.8, 1e-5);
}

TEST_F(MeshImportTest, RefusesHostileMaterialLibraries) {
  const std::pair<std::string, const char*> cases[] = {
      {"Kd 1 1 1\n", "line 1: 'Kd' stands before the first newmtl"},
      {"newmtl a\nKd 1 2\n", "line 2: the colour Kd needs three numbers"},
      {"newmtl a\nKd one\n", "line 2: the colour Kd needs three numbers"},
      {"newmtl a\nKd 0.5 junk\n", "line 2: the colour Kd needs three numbers"},
      {"newmtl a\nKd nan 1 1\n", "line 2: the colour Kd is not finite"},
      {"newmtl a\nKd inf 1 1\n", "line 2: the colour Kd is not finite"},
      {"newmtl a\nmap_Kd\n", "line 2: map_Kd names no file"},
      {"newmtl a\nmap_Kd -s 1 1\n", "line 2: map_Kd names no file"},
      {std::string("newmtl \0\n", 9), "line 1: binary content"},
  };
  for (const auto& [text, message] : cases) {
    const std::filesystem::path file = Write("hostile.mtl", text);
    try {
      ReadObjMaterials(file);
      ADD_FAILURE() << text;
    } catch (const Error& e) {
      EXPECT_NE(std::string(e.what()).find(message), std::string::npos) << e.what();
    }
  }
  EXPECT_TRUE(ReadObjMaterials(Write("empty.mtl", "")).empty());
  EXPECT_TRUE(ReadObjMaterials(Write("cut.mtl", "newm")).empty());
  EXPECT_EQ(ReadObjMaterials(Write("gray.mtl", "newmtl g\r\nKd 3\r\n")).at(0).diffuse,
            Eigen::Vector3f(1, 1, 1));
  EXPECT_THROW(ReadObjMaterials(scratch_.folder / "absent.mtl"), Error);
}

struct HostileObj {
  const char* text;
  const char* message;
};

TEST_F(MeshImportTest, RefusesHostileObj) {
  const HostileObj cases[] = {
      {"", "empty"},
      {"v 0 0 0\nv 1 0 0\nv 0 1 0\n", "no faces"},
      {"v 0 0 0\nv 1 0\n", "line 2: the coordinate of vertex 1 is missing"},
      {"v 0 0 0\nv nan 0 0\n", "line 2: the coordinate of vertex 1 is not finite"},
      {"v 0 0 0\nv 0 inf 0\n", "line 2: the coordinate of vertex 1 is not finite"},
      {"v 0 1e-999 1e999\n", "the coordinate of vertex 0 is not finite"},
      {"v 0 0 zero\n", "line 1: the coordinate of vertex 0 is 'zero', not a number"},
      {"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n", "line 4: the face names vertex 4"},
      {"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 -4\n", "the face names vertex -4"},
      {"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 0 1 2\n", "the face names vertex 0"},
      {"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 99999999999999999999\n", "not the index"},
      {"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1/1 2 3\n", "the face names texture coordinate 1"},
      {"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1/1/1/1 2 3\n", "more than three indices"},
      {"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2\n", "fewer than three corners"},
      {"v 0 0 0\nvt 1e300 0\n", "line 2: a texture coordinate is too large"},
      {"v 0 0 0\nv 1 0 0\nv 0 1 0\nf // 1 2\n", "names no vertex"},
      {"v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n", "no triangle of any area"},
      {"v 1 1 1\nv 1 1 1\nv 1 1 1\nf 1 2 3\n", "no extent"},
      {"v 0 0 0\nv 1e12 0 0\nv 0 1 0\nf 1 2 3\n", "vertex 1 lies farther than 1e9"},
      {"hello, world!\n", "is no statement of an OBJ file"},
      {"<html><body>404</body></html>\n", "is no statement of an OBJ file"},
  };
  for (const HostileObj& c : cases) {
    const std::string failure = Failure(Write("hostile.obj", c.text));
    EXPECT_NE(failure.find(c.message), failure.npos) << c.text << "gave: " << failure;
  }
  EXPECT_NE(Failure(Write("binary.obj", std::string("v 0 0 0\n\0\1\2", 12))).find("binary content"),
            std::string::npos);
}

TEST_F(MeshImportTest, EveryTruncationOfAnObjIsAnErrorOrAMesh) {
  const std::string text = kTetrahedron;
  for (size_t length = 0; length < text.size(); ++length) {
    try {
      const ImportedMesh mesh = ImportMesh(Write("cut.obj", text.substr(0, length)));
      ASSERT_FALSE(mesh.mesh.triangles.empty());
      for (const auto& n : mesh.mesh.normals) ASSERT_TRUE(n.allFinite());
    } catch (const Error&) {
    }
  }
}

TEST_F(MeshImportTest, RefusesHostilePlyAndOtherFiles) {
  const std::string header =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
      "property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n";
  EXPECT_NE(Failure(Write("a.ply", header + "0 0 0\n1 0 0\n")), "");
  EXPECT_NE(Failure(Write("b.ply", header + "0 0 0\n1 nan 0\n0 1 0\n3 0 1 2\n")).find("vertex 1"),
            std::string::npos);
  EXPECT_NE(Failure(Write("c.ply", header + "0 0 0\n1 0 0\n0 1 0\n3 0 1 7\n")), "");
  EXPECT_NE(Failure(Write("d.ply", "")), "");
  EXPECT_NE(Failure(Write("e.ply", "v 0 0 0\n")), "");
  EXPECT_NE(Failure(Write("mesh.stl", "solid")).find("PLY or OBJ"), std::string::npos);
  EXPECT_NE(Failure(scratch_.folder / "absent.obj"), "");
  EXPECT_NE(Failure(scratch_.folder), "");
}

TEST_F(MeshImportTest, TakesAMillionTrianglesAndRefusesMoreThanFour) {
  const auto sheet = [&](int n) {
    TriangleMesh mesh;
    for (int j = 0; j <= n; ++j) {
      for (int i = 0; i <= n; ++i) mesh.vertices.emplace_back(i, j, 0);
    }
    for (int j = 0; j < n; ++j) {
      for (int i = 0; i < n; ++i) {
        const int a = j * (n + 1) + i;
        mesh.triangles.emplace_back(a, a + 1, a + n + 2);
        mesh.triangles.emplace_back(a, a + n + 2, a + n + 1);
      }
    }
    const std::filesystem::path file = scratch_.folder / "sheet.ply";
    WritePly(mesh, file);
    return file;
  };
  EXPECT_EQ(ImportMesh(sheet(708)).mesh.triangles.size(), 1'002'528u);
  EXPECT_NE(Failure(sheet(1415)).find("more than 4 million"), std::string::npos);
}

}  // namespace
}  // namespace lfm
