// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <random>

#include "core/atomic_file.h"
#include "core/error.h"
#include "encode/afx.h"
#include "encode/encode.h"
#include "encode/model_evaluation.h"
#include "tests/encode/synthetic_light_field.h"

namespace lfm::testing {
namespace {

namespace fs = std::filesystem;

// A small file, and what stands around it.
class AfxHostile : public ::testing::Test {
 protected:
  AfxHostile()
      : folder_(fs::temp_directory_path() / ("lfm_afx_hostile_" + std::to_string(::getpid()))) {
    fs::create_directories(folder_);
    const SyntheticLightField field = MakeLightField(
        MakeSphere(0), 3, 20, [](int) { return 3; }, GlossyAppearance);
    form_ = AfxForm(Encode(field.Source(), {.terms = 1, .transport_db = 0}, SilentProgress()).model,
                    {});
    files_ = WriteAfxForm(form_);
  }
  ~AfxHostile() override { fs::remove_all(folder_); }

  LightFieldModel Read(const std::string& text) const {
    const AfxPictureSource pictures = [this](const std::string& name) -> std::string {
      for (const AfxFiles::Picture& picture : files_.pictures) {
        if (picture.name == name) {
          return {reinterpret_cast<const char*>(picture.png.data()), picture.png.size()};
        }
      }
      throw Error(name + ": no such picture");
    };
    return ReadAfxText(text, "model.wrl", pictures);
  }
  // The file with its first `from` behind `after` replaced.
  std::string With(const std::string& from, const std::string& to,
                   const std::string& after = "Transform {") const {
    std::string text = files_.wrl;
    const size_t at = text.find(from, text.find(after));
    EXPECT_NE(at, std::string::npos) << from;
    return text.replace(at, from.size(), to);
  }
  // The file with the first number of a list behind `after` replaced.
  std::string WithFirst(const std::string& list, const std::string& value,
                        const std::string& after = "Transform {") const {
    std::string text = files_.wrl;
    const size_t at = text.find(list + " [\n", text.find(after)) + list.size() + 3;
    return text.replace(at, text.find_first_of(" \n", at) - at, value);
  }
  void ExpectRefused(const std::string& text, const std::string& why) const {
    try {
      Read(text);
      FAIL() << why;
    } catch (const Error& error) {
      const std::string message = error.what();
      EXPECT_NE(message.find(why), std::string::npos) << message;
      EXPECT_NE(message.find("model.wrl"), std::string::npos) << message;
      EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    }
  }

  fs::path folder_;
  LightFieldModel form_;
  AfxFiles files_;
};

TEST_F(AfxHostile, EveryPrefixIsRefused) {
  const size_t whole = files_.wrl.find_last_not_of('\n') + 1;
  ASSERT_NO_THROW(Read(files_.wrl.substr(0, whole)));
  for (size_t length = 0; length < whole; length += 1 + length / 400) {
    const std::string prefix = files_.wrl.substr(0, length);
    EXPECT_THROW(Read(prefix), Error) << length;
  }
  for (size_t length = whole - 300; length < whole; ++length) {
    EXPECT_THROW(Read(files_.wrl.substr(0, length)), Error) << length;
  }
}

// Whatever bytes are damaged: an Error, or a model that can be looked at.
TEST_F(AfxHostile, DamagedBytesAreSafe) {
  std::mt19937 random(11);
  const std::string bytes = "0123456789-+.eE[]{}\"# \nNaU\\\xff";
  int refused = 0;
  constexpr int kTries = 1500;
  for (int i = 0; i < kTries; ++i) {
    std::string text = files_.wrl;
    for (int k = 0; k < 3; ++k) text[random() % text.size()] = bytes[random() % bytes.size()];
    try {
      const LightFieldModel model = Read(text);
      for (int t = 0; t < static_cast<int>(model.placements.size()); ++t) {
        EXPECT_TRUE(EvaluateModel(model, t, {0.1, 0.2, 0.7}, {0, 0.6, 0.8}).allFinite());
      }
    } catch (const Error& error) {
      EXPECT_EQ(std::string(error.what()).rfind("model.wrl", 0), 0U) << error.what();
      ++refused;
    }
  }
  EXPECT_GT(refused, kTries / 3);
}

TEST_F(AfxHostile, RefusesWhatAModelCannotHold) {
  const std::string lists = "LFM_LightMap { # term 1";
  ExpectRefused(With("scaleRGB ", "scaleRGB 1e7 1e7 1e7 scaleRGBs ", lists), "larger than 1e6");
  ExpectRefused(With("scaleRGB ", "scaleRGB 1 2 1 others ", lists), "the same for red");
  ExpectRefused(With("scaleRGB ", "scaleRGB -1 -1 -1 others ", lists), "no scale below 0");
  ExpectRefused(With("scaleRGB ", "scaleRGB 1 1 others ", lists), "3 numbers");
  ExpectRefused(With("biasRGB ", "biasRGB nan ", lists), "\"nan\"");
  ExpectRefused(With("priorityLevel 1", "priorityLevel -1", lists), "priorityLevel");
  ExpectRefused(WithFirst("blendMode", "2"), "blend mode");
  ExpectRefused(WithFirst("blendMode", "1"), "cannot be negative");
  ExpectRefused(WithFirst("lightMapIndex", "9"), "not there");
  ExpectRefused(WithFirst("viewMapIndex", "77", lists), "not there");
  ExpectRefused(WithFirst("viewMapIndex", "-1", lists), "not there");
  ExpectRefused(WithFirst("viewMapIndex", "0"), "must be -1");
  ExpectRefused(WithFirst("triangleIndex", "2147483647", lists), "not there");
  ExpectRefused(WithFirst("triangleIndex", "1e30", lists), "32 bits");
  ExpectRefused(WithFirst("triangleIndex", "0 0", lists), "differ in length");
  ExpectRefused(WithFirst("triangleIndex", "1"), "two plain textures");
  ExpectRefused(WithFirst("vertexIndex", "-5", lists), "not there");
  ExpectRefused(WithFirst("tileIndex", "99", lists), "not there");
  ExpectRefused(WithFirst("tileIndex", "0 0", lists), "differ in length");
  ExpectRefused(WithFirst("coordIndex", "8"), "not there");
  // A view map of a vertex that the triangle does not have.
  const Eigen::Vector3i& corners = form_.mesh.triangles[0];
  int other = 0;
  while ((corners.array() == other).any()) ++other;
  ExpectRefused(WithFirst("viewMapIndex", std::to_string(other), lists), "does not have");
  ExpectRefused(With("coordIndex [\n", "ccw FALSE coordIndex [\n"), "clockwise");
  ExpectRefused(WithFirst("index", "99", "vertexFrameList DEF"), "not there");
  ExpectRefused(WithFirst("frame", "9", "vertexFrameList DEF"), "at right angles");
  ExpectRefused(With("frame [\n", "frame [\n3 ", "vertexFrameList DEF"), "9 numbers");
  ExpectRefused(With("LFM_LightMap { # mean", "Group { # mean"), "holds other than");
  ExpectRefused(With("appearance LFM_Appearance", "appearance Appearance"), "not a light field");
}

TEST_F(AfxHostile, RefusesTextureCoordinatesOffTheTexels) {
  const std::string points = "point [\n";
  const std::string of_mean = "texCoord DEF";
  ExpectRefused(With(points, points + "-0.2 0.1 0.2 0.3 0.4 0.5\n", of_mean), "differ in length");
  std::string text = files_.wrl;
  const size_t at = text.find(points, text.find(of_mean)) + points.size();
  const size_t end = text.find('\n', at);
  for (const auto& [line, why] : {std::pair("7 7 7 7 7 7", "texture coordinates"),
                                  std::pair("0 0 0 0 0 0", "texture coordinates"),
                                  std::pair("-1e30 0 1e38 0 0 0", "texture coordinates")}) {
    std::string hostile = text;
    ExpectRefused(hostile.replace(at, end - at, line), why);
  }
}

TEST_F(AfxHostile, BoundsWhatItTakesForManyLists) {
  // One list of view maps, named by a thousand light maps: the same maps each time.
  std::string text = files_.wrl;
  const size_t list = text.find("lightMapList [", text.find("Transform {")) + 14;
  std::string maps;
  for (int i = 0; i < 1000; ++i) {
    maps +=
        "LFM_LightMap { viewMapList LFM_ViewMapList { vertexIndex 0 tileIndex 0 textureOrigin "
        "TextureCoordinate { point 0.5 0.5 } textureSize TextureCoordinate { point 0 0 } } "
        "surfaceMapList LFM_SurfaceMapList {} }\n";
  }
  ExpectRefused(text.insert(list, maps), "more than 16 view maps");
}

// Lists and face sets that are named again and again are not work again and again.
TEST_F(AfxHostile, RefusesListsThatAreUsedTooOften) {
  const std::string surfaces = "LFM_SurfaceMapList {";
  const size_t scene = files_.wrl.find("Transform {");
  std::string text = files_.wrl;
  text.insert(text.find(surfaces, scene), "DEF MEAN ");
  const std::string maps = "LFM_LightMap { surfaceMapList USE MEAN }\n";
  size_t at = text.find("LFM_LightMap { # term 1");
  for (int i = 0; i < 1000; ++i) text.insert(at, maps);
  ExpectRefused(text, "two plain textures");

  text = files_.wrl;
  text.insert(text.find(surfaces, text.find("# term 1")), "DEF TERM ");
  at = text.find("]\nblendList");
  std::string uses;
  for (int i = 0; i < 1000; ++i) {
    uses += "LFM_LightMap { surfaceMapList USE TERM viewMapList USE VIEWS_1 scaleRGB 1 1 1 }\n";
  }
  ExpectRefused(std::string(text).insert(at, uses), "with different ranges");

  text = files_.wrl;
  text.insert(text.find("IndexedFaceSet", scene), "DEF FACES ");
  at = text.rfind("]\n}");
  text.insert(at, "Shape { geometry USE FACES appearance LFM_Appearance {} }\n");
  ExpectRefused(text, "one face set");
}

TEST_F(AfxHostile, UsesManyTimesAreWalkedOnce) {
  std::string text = "#VRML V2.0 utf8\nDEF G0 Group {}\n";
  for (int i = 1; i <= 60; ++i) {
    const std::string before = "USE G" + std::to_string(i - 1);
    text += "DEF G" + std::to_string(i) + " Group { children [ " + before + " " + before + " ] }\n";
  }
  ExpectRefused(text, "not a light field");
}

TEST_F(AfxHostile, PicturesMustLieBesideTheFile) {
  SaveAfx(files_, folder_ / "inside");
  const std::string good = files_.pictures[0].name;
  fs::copy_file(folder_ / "inside" / good, folder_ / "outside.png");
  fs::create_symlink(folder_ / "outside.png", folder_ / "inside" / "link.png");
  const auto refused = [&](const std::string& name, const char* why) {
    std::string text = files_.wrl;
    text.replace(text.find(good), good.size(), name);
    WriteFileAtomically(folder_ / "inside" / "model.wrl", text);
    try {
      ReadAfx(folder_ / "inside" / "model.wrl");
      ADD_FAILURE() << name;
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find(why), std::string::npos) << error.what();
    }
  };
  ASSERT_NO_THROW(ReadAfx(folder_ / "inside" / "model.wrl"));
  refused("../outside.png", "leaves the file's folder");
  refused("model_afx/../../outside.png", "leaves the file's folder");
  refused("link.png", "leaves the file's folder");
  refused((folder_ / "outside.png").string(), "relative path");
  refused("http://localhost/mean.png", "relative path");
  refused("file:outside.png", "relative path");
  refused("", "relative path");
  refused("two\nlines.png", "relative path");
  refused("missing.png", "no such file");
  refused("model_afx", "is not a file");
  std::ofstream(folder_ / "inside" / "text.png") << "no picture";
  refused("text.png", "is not a PNG");
}

// The names that we give say what the pictures hold: swapped ones would show nonsense.
TEST_F(AfxHostile, RefusesPicturesUnderEachOthersNames) {
  const auto bytes = [&](size_t i) -> std::string {
    const std::vector<std::byte>& png = files_.pictures[i].png;
    return {reinterpret_cast<const char*>(png.data()), png.size()};
  };
  // The mean view, the three corners' surface maps and the view maps of one term.
  ASSERT_EQ(files_.pictures.size(), 5U);
  for (const auto& [first, second] : {std::pair(1, 2), std::pair(2, 3), std::pair(0, 4)}) {
    ASSERT_NE(bytes(first), bytes(second));
    const auto swapped = [&](const std::string& name) -> std::string {
      for (int i = 0; i < 5; ++i) {
        if (files_.pictures[i].name != name) continue;
        return bytes(i == first ? second : i == second ? first : i);
      }
      throw Error(name + ": no such picture");
    };
    try {
      ReadAfxText(files_.wrl, "model.wrl", swapped);
      ADD_FAILURE() << first << " and " << second;
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find("swapped"), std::string::npos) << error.what();
    }
  }
}

// A picture's header is looked at before anything is decoded.
TEST_F(AfxHostile, RefusesPicturesThatLieAboutTheirSize) {
  for (const std::string& size :
       {std::string("\0\0\x3f\xff\0\0\x3f\xff", 8), std::string("\xff\xff\xff\xff\0\0\0\1", 8),
        std::string("\0\0\0\0\0\0\0\0", 8), std::string("\0\0\0\1\0\0\0\1", 8)}) {
    // Under names that say nothing of their content.
    std::string text = files_.wrl;
    for (size_t i = 0; i < files_.pictures.size(); ++i) {
      const std::string& name = files_.pictures[i].name;
      text.replace(text.find(name), name.size(), std::to_string(i));
    }
    const auto picture = [&](const std::string& name) -> std::string {
      const std::vector<std::byte>& png = files_.pictures.at(std::stoul(name)).png;
      return {reinterpret_cast<const char*>(png.data()), png.size()};
    };
    const auto lying = [&](const std::string& name) { return picture(name).replace(16, 8, size); };
    ASSERT_NO_THROW(ReadAfxText(text, "model.wrl", picture));
    EXPECT_THROW(ReadAfxText(text, "model.wrl", lying), Error);
  }
}

// Prototypes of one's own are read; what they hold is not looked into. Without ours the nodes are
// those that MPEG-4 knows.
TEST_F(AfxHostile, ReadsFilesWithoutOurPrototypes) {
  const size_t scene = files_.wrl.find("NavigationInfo");
  const std::string text = "#VRML V2.0 utf8\nPROTO Other [] { Group { children " +
                           std::string("Shape { appearance LFM_Appearance {} } } }\nOther {}\n") +
                           files_.wrl.substr(scene);
  const LightFieldModel model = Read(text);
  EXPECT_EQ(model.mesh.triangles, form_.mesh.triangles);
  EXPECT_EQ(model.vertex_terms, form_.vertex_terms);
}

// A term that is subtracted shows the opposite of one that is added.
TEST_F(AfxHostile, SubtractsATerm) {
  const LightFieldModel added = Read(files_.wrl);
  const LightFieldModel subtracted = Read(With("blendMode [\n0 0", "blendMode [\n0 1"));
  constexpr float kRounding_abs = 1e-5f;
  bool differs = false;
  for (int t = 0; t < static_cast<int>(added.placements.size()); ++t) {
    const Eigen::Vector3d to_eye = TriangleNormal(added.mesh, t), weights(0.3, 0.3, 0.4);
    const Eigen::Vector3f mean = EvaluateModel(added, t, weights, to_eye, {.terms = 0});
    const Eigen::Vector3f plus = EvaluateModel(added, t, weights, to_eye),
                          minus = EvaluateModel(subtracted, t, weights, to_eye);
    const bool clamped = std::min(plus.minCoeff(), minus.minCoeff()) <= 0 ||
                         std::max(plus.maxCoeff(), minus.maxCoeff()) >= 1;
    if (!clamped) {
      EXPECT_LT((plus + minus - 2 * mean).cwiseAbs().maxCoeff(), kRounding_abs);
    }
    differs = differs || (plus - minus).norm() > 0.01;
  }
  EXPECT_TRUE(differs);
}

// Scale and bias of a plain texture, and a vertex's frame left-handed: the same model.
TEST_F(AfxHostile, AppliesScaleAndBiasOfAPlainTexture) {
  const LightFieldModel half =
      Read(With("priorityLevel 0", "scaleRGB 0.5 0.5 0.5 biasRGB 0.25 0 0 priorityLevel 0"));
  for (int t = 0; t < static_cast<int>(form_.placements.size()); ++t) {
    const Eigen::Vector3f before = EvaluateModel(form_, t, {1, 0, 0}, {0, 0, 1}, {.terms = 0});
    const Eigen::Vector3f after = EvaluateModel(half, t, {1, 0, 0}, {0, 0, 1}, {.terms = 0});
    EXPECT_LT((after - (before / 2 + Eigen::Vector3f(0.25f, 0, 0))).cwiseAbs().maxCoeff(),
              0.6f / 255);
  }
}

}  // namespace
}  // namespace lfm::testing
