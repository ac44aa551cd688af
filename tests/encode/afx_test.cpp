// SPDX-License-Identifier: BSD-3-Clause
#include "encode/afx.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <random>

#include "core/atomic_file.h"
#include "core/error.h"
#include "encode/encode.h"
#include "encode/model_evaluation.h"
#include "encode/transport_form.h"
#include "encode/vrml_scene.h"
#include "tests/encode/afx_light_maps.h"
#include "tests/encode/edge_jump.h"
#include "tests/encode/synthetic_light_field.h"

namespace lfm::testing {
namespace {

namespace fs = std::filesystem;

LightFieldModel MakeModel(int levels, DirectionMap map, const EncodeOptions& options) {
  SyntheticLightField field = MakeLightField(
      MakeSphere(levels), 12, 120, [](int t) { return t % 2 == 0 ? 5 : 9; }, GlossyAppearance);
  field.direction_map = map;
  return Encode(field.Source(), options, SilentProgress()).model;
}

LightFieldModel ReadBack(const AfxFiles& files, const AfxReadOptions& options = {}) {
  const AfxPictureSource pictures = [&](const std::string& name) -> std::string {
    for (const AfxFiles::Picture& picture : files.pictures) {
      if (picture.name == name) {
        return {reinterpret_cast<const char*>(picture.png.data()), picture.png.size()};
      }
    }
    throw Error(name + ": no such picture");
  };
  return ReadAfxText(files.wrl, "model.wrl", pictures, options);
}

void ExpectSameFiles(const AfxFiles& a, const AfxFiles& b) {
  EXPECT_EQ(a.wrl.size(), b.wrl.size());
  EXPECT_TRUE(a.wrl == b.wrl);
  ASSERT_EQ(a.pictures.size(), b.pictures.size());
  for (size_t i = 0; i < a.pictures.size(); ++i) {
    EXPECT_EQ(a.pictures[i].name, b.pictures[i].name);
    EXPECT_TRUE(a.pictures[i].png == b.pictures[i].png);
  }
}

// The largest difference of what two models show, in 8-bit levels, over random points and
// directions in front of the triangle. Triangles may stand in another order.
double LargestDifference(const LightFieldModel& a, const LightFieldModel& b, double least_cosine) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> unit(0, 1), sign(-1, 1);
  const auto same_corners = [](const Eigen::Vector3i& x, const Eigen::Vector3i& y) {
    return x == y;
  };
  double largest = 0;
  for (int s = 0; s < 4000; ++s) {
    const int t = static_cast<int>(random() % a.placements.size());
    int other = 0;
    while (!same_corners(a.mesh.triangles[t], b.mesh.triangles[other])) ++other;
    Eigen::Vector3d weights(unit(random), unit(random), unit(random));
    weights /= weights.sum();
    const Eigen::Vector3d normal = TriangleNormal(a.mesh, t);
    Eigen::Vector3d to_eye;
    do {
      to_eye = Eigen::Vector3d(sign(random), sign(random), sign(random)).normalized();
    } while (to_eye.dot(normal) < least_cosine);
    const Eigen::Vector3f difference =
        EvaluateModel(a, t, weights, to_eye) - EvaluateModel(b, other, weights, to_eye);
    largest = std::max<double>(largest, 255 * difference.cwiseAbs().maxCoeff());
  }
  return largest;
}

class Afx : public ::testing::Test {
 protected:
  Afx() : folder_(fs::temp_directory_path() / ("lfm_afx_test_" + std::to_string(::getpid()))) {
    fs::create_directories(folder_);
  }
  ~Afx() override { fs::remove_all(folder_); }
  fs::path folder_;
};

// Writing what was read gives the same bytes: text and pictures, with several light maps a term
// too.
TEST_F(Afx, RoundTripGivesTheSameBytes) {
  for (const DirectionMap map : {DirectionMap::kHemiOctahedral, DirectionMap::kOrthographic,
                                 DirectionMap::kHemiOctahedralSkirt}) {
    for (const int terms : {0, 1, 3}) {
      const LightFieldModel model = MakeModel(1, map, {.terms = terms, .transport_db = 0});
      const AfxFiles written = WriteAfxForm(WithThreeLightMaps(AfxForm(model, {})));
      ExpectSameFiles(written, WriteAfxForm(ReadBack(written)));
      ExpectSameFiles(written, WriteAfxForm(AfxForm(ReadBack(written), {})));
    }
  }
}

// Several pages: several shapes that share vertices, view maps and tiles.
TEST_F(Afx, RoundTripOfSeveralPagesGivesTheSameBytes) {
  SyntheticLightField field = MakeLightField(
      MakeSphere(2), 8, 60, [](int t) { return t % 3 == 0 ? 49 : 25; }, GlossyAppearance);
  const LightFieldModel model =
      Encode(field.Source(), {.terms = 2, .transport_db = 0, .max_texture_size = 256},
             SilentProgress())
          .model;
  ASSERT_GT(model.mean_pages.size(), 1u);
  const AfxFiles written = WriteAfxForm(AfxForm(model, {}));
  const LightFieldModel back = ReadBack(written);
  EXPECT_GT(back.mean_pages.size(), 1u);
  for (const Image& page : back.mean_pages) EXPECT_LE(std::max(page.width(), page.height()), 256);
  EXPECT_EQ(back.vertex_terms, model.vertex_terms);
  ExpectSameFiles(written, WriteAfxForm(AfxForm(back, {})));
}

// What is read back shows what was written: exactly, for the form that was written.
TEST_F(Afx, ReadsWhatWasWritten) {
  const LightFieldModel form =
      AfxForm(MakeModel(1, DirectionMap::kHemiOctahedral, {.terms = 3, .transport_db = 0}), {});
  const LightFieldModel back = ReadBack(WriteAfxForm(form));
  EXPECT_EQ(back.terms, 3);
  EXPECT_EQ(back.grid, form.grid);
  EXPECT_EQ(back.direction_map, DirectionMap::kOrthographic);
  EXPECT_EQ(back.mesh.triangles, form.mesh.triangles);
  EXPECT_EQ(back.mesh.vertices, form.mesh.vertices);
  EXPECT_EQ(back.vertex_frames, form.vertex_frames);
  EXPECT_EQ(LargestDifference(form, back, -1), 0);
}

// The loss against the model itself: of ranges that vertices share, and of the disc.
TEST_F(Afx, ShowsWhatTheModelShows) {
  for (const int terms : {0, 1, 3}) {
    const LightFieldModel disc =
        MakeModel(2, DirectionMap::kOrthographic, {.terms = terms, .transport_db = 0});
    constexpr double kSharedRange_levels = 2.5, kDisc_levels = 8;
    EXPECT_LE(LargestDifference(disc, ReadBack(WriteAfxForm(AfxForm(disc, {}))), -1),
              terms == 0 ? 1e-3 : kSharedRange_levels)
        << terms;
    const LightFieldModel square =
        MakeModel(2, DirectionMap::kHemiOctahedral, {.terms = terms, .transport_db = 0});
    const LightFieldModel onto_disc = ReadBack(WriteAfxForm(AfxForm(square, {})));
    EXPECT_LE(LargestDifference(square, onto_disc, 0.5), terms == 0 ? 1e-3 : kDisc_levels) << terms;
    const LightFieldModel as_is = ReadBack(WriteAfxForm(AfxForm(square, AfxViewMaps::kAsTheyAre)));
    EXPECT_EQ(as_is.direction_map,
              terms == 0 ? DirectionMap::kOrthographic : DirectionMap::kHemiOctahedral);
    EXPECT_LE(LargestDifference(square, as_is, -1), terms == 0 ? 1e-3 : kSharedRange_levels)
        << terms;
  }
}

// Vertices with different numbers of terms, and with none.
TEST_F(Afx, KeepsHowManyTermsEachVertexHas) {
  const LightFieldModel model = MakeModel(2, DirectionMap::kOrthographic,
                                          {.tolerance = 1.2, .max_terms = 5, .transport_db = 0});
  const auto [least, most] =
      std::minmax_element(model.vertex_terms.begin(), model.vertex_terms.end());
  ASSERT_EQ(*least, 0);
  ASSERT_GT(*most, 1);
  const AfxFiles written = WriteAfxForm(AfxForm(model, {}));
  const LightFieldModel back = ReadBack(written);
  EXPECT_EQ(back.vertex_terms, model.vertex_terms);
  EXPECT_LE(LargestDifference(model, back, -1), 2.5);
  ExpectSameFiles(written, WriteAfxForm(back));
}

TEST_F(Afx, IsContinuousAcrossEdges) {
  const LightFieldModel model =
      MakeModel(2, DirectionMap::kHemiOctahedral, {.terms = 3, .transport_db = 0});
  EXPECT_LE(LargestJumpAcrossEdges(AfxForm(model, {})),
            std::max(LargestJumpAcrossEdges(model), 1.0));
}

// A reader may stop after any priority level: ours are the terms.
TEST_F(Afx, StopsAfterAPriorityLevel) {
  const LightFieldModel form =
      AfxForm(MakeModel(1, DirectionMap::kOrthographic, {.terms = 3, .transport_db = 0}), {});
  const AfxFiles files = WriteAfxForm(form);
  for (const int level : {0, 1, 2, 3}) {
    const LightFieldModel part = ReadBack(files, {.priority_level = level});
    EXPECT_EQ(part.terms, level);
    std::mt19937 random(5);
    for (int s = 0; s < 50; ++s) {
      const int t = static_cast<int>(random() % form.placements.size());
      const Eigen::Vector3d to_eye = TriangleNormal(form.mesh, t);
      EXPECT_EQ(EvaluateModel(part, t, {0.2, 0.3, 0.5}, to_eye),
                EvaluateModel(form, t, {0.2, 0.3, 0.5}, to_eye, {.terms = level}));
    }
  }
}

// The prototypes let any VRML97 browser show the mean view.
TEST_F(Afx, PrototypesAreWhatPlainBrowsersNeed) {
  const AfxFiles files = WriteAfxForm(
      AfxForm(MakeModel(0, DirectionMap::kHemiOctahedral, {.terms = 1, .transport_db = 0}),
              AfxViewMaps::kAsTheyAre));
  const vrml::Scene scene = vrml::ParseScene(files.wrl, "model.wrl");
  std::map<std::string, const vrml::Prototype*> prototypes;
  for (const vrml::Prototype& prototype : scene.prototypes) prototypes[prototype.name] = &prototype;
  ASSERT_EQ(prototypes.size(), 6u);
  const vrml::Node& first = scene.nodes[prototypes.at("LFM_Appearance")->nodes.at(0)];
  EXPECT_EQ(first.type, "Appearance");
  EXPECT_EQ(first.Find("texture")->is, "texture");
  // Every field that an instance gives is declared, and Smirnov's defaults are the prototypes'.
  std::map<std::string, int> instances;
  for (const vrml::Node& node : scene.nodes) {
    if (!prototypes.contains(node.type)) continue;
    ++instances[node.type];
    for (const vrml::Field& field : node.fields) {
      const auto& interface = prototypes.at(node.type)->interface;
      EXPECT_TRUE(std::any_of(interface.begin(), interface.end(),
                              [&](const auto& declared) { return declared.name == field.name; }))
          << node.type << "." << field.name;
    }
  }
  EXPECT_EQ(instances.size(), 6u);
  const auto default_of = [&](const char* type, const char* name) {
    for (const auto& field : prototypes.at(type)->interface) {
      if (field.name == name) return field.value.numbers;
    }
    return std::vector<double>{-99};
  };
  EXPECT_EQ(default_of("LFM_FrameList", "index"), std::vector<double>{-1});
  EXPECT_EQ(default_of("LFM_FrameList", "frame"), (std::vector<double>{1, 0, 0, 0, 1, 0, 0, 0, 1}));
  EXPECT_EQ(default_of("LFM_LightMap", "scaleRGB"), (std::vector<double>{1, 1, 1}));
  EXPECT_EQ(default_of("LFM_LightMap", "biasRGB"), (std::vector<double>{0, 0, 0}));
  EXPECT_EQ(default_of("LFM_LightMap", "priorityLevel"), std::vector<double>{0});
}

TEST_F(Afx, SavesAndRemovesFileAndPictures) {
  const LightFieldModel model =
      MakeModel(1, DirectionMap::kOrthographic, {.terms = 2, .transport_db = 0});
  const LightFieldModel form = AfxForm(model, {});
  SaveAfx(WriteAfxForm(form), folder_);
  EXPECT_EQ(LargestDifference(form, ReadModel(folder_ / "model.wrl").model, -1), 0);
  const auto count = [&] {
    return std::distance(fs::directory_iterator(folder_ / "model_afx"), fs::directory_iterator());
  };
  const auto before = count();
  const AfxFiles fewer = WriteAfxForm(ReadAfx(folder_ / "model.wrl", {.priority_level = 1}));
  const int64_t bytes = SaveAfx(fewer, folder_);  // what is no longer named goes
  EXPECT_LT(count(), before);
  int64_t on_disk = static_cast<int64_t>(fs::file_size(folder_ / "model.wrl"));
  for (const auto& file : fs::directory_iterator(folder_ / "model_afx")) {
    on_disk += static_cast<int64_t>(file.file_size());
  }
  EXPECT_EQ(bytes, on_disk);
  EXPECT_EQ(ReadAfx(folder_ / "model.wrl").terms, 1);
  std::ofstream(folder_ / "model_afx" / "holiday.png") << "somebody's";
  RemoveAfx(folder_);
  EXPECT_TRUE(fs::remove(folder_ / "model_afx" / "holiday.png")) << "not ours";
  fs::remove(folder_ / "model_afx");
  EXPECT_TRUE(fs::is_empty(folder_));
  RemoveAfx(folder_ / "nowhere");
}

TEST_F(Afx, RefusesNonnegativeTerms) {
  const LightFieldModel model =
      MakeModel(0, DirectionMap::kOrthographic,
                {.factorization = Factorization::kNmf, .terms = 1, .transport_db = 0});
  try {
    AfxForm(model, {});
    FAIL();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("--factorization pca"), std::string::npos);
  }
}

}  // namespace
}  // namespace lfm::testing
