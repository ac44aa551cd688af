// SPDX-License-Identifier: BSD-3-Clause
#include "encode/encode_files.h"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "core/atomic_file.h"
#include "core/error.h"
#include "core/json_reader.h"
#include "encode/encode_pictures.h"
#include "encode/glb.h"
#include "encode/transport_form.h"
#include "tests/encode/synthetic_light_field.h"

namespace lfm::testing {
namespace {

namespace fs = std::filesystem;

class EncodeFiles : public ::testing::Test {
 protected:
  EncodeFiles()
      : work_(fs::temp_directory_path() / ("lfm_encode_test_" + std::to_string(::getpid()))),
        field_(MakeLightField(
            MakeSphere(1), 8, 60, [](int) { return 5; }, GlossyAppearance)) {
    fs::create_directories(work_ / "resample");
  }
  ~EncodeFiles() override { fs::remove_all(work_); }

  fs::path LightFieldFile() const { return work_ / "resample" / "light_field.lfs"; }
  void WriteLightField() const {
    LightFieldWriter::Header header{
        field_.mesh, field_.frames, {}, field_.direction_map, field_.grid};
    for (int p = 0; p < 60; ++p) header.photo_ids.push_back("p" + std::to_string(p));
    LightFieldWriter writer(LightFieldFile(), header);
    for (const auto& t : field_.triangles) {
      writer.Write({t.edge_samples, t.photos, t.values, t.weights});
    }
    writer.Finish();
  }
  // Exit status of lfm-encode; what it says goes to work/log.
  int Run(const std::string& arguments) const {
    const std::string command =
        "'" LFM_BIN_DIR "/lfm-encode' " + arguments + " > '" + (work_ / "log").string() + "' 2>&1";
    const int status = std::system(command.c_str());
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }
  std::string Log() const { return ReadFile(work_ / "log"); }

  fs::path work_;
  SyntheticLightField field_;
};

TEST_F(EncodeFiles, SaveAndLoadAgree) {
  const EncodeResult result = Encode(field_.Source(), {.terms = 2}, SilentProgress());
  const nlohmann::json figures = SaveEncode(result, work_ / "encode");
  const EncodeResult back = LoadEncode(work_ / "encode");
  EXPECT_EQ(back.model_bytes, figures["model_bytes"].get<int64_t>());
  EXPECT_EQ(back.model_bytes, static_cast<int64_t>(fs::file_size(work_ / "encode/model.glb")));
  EXPECT_EQ(back.maps_bytes, result.maps_bytes);
  EXPECT_EQ(back.terms_mean, result.terms_mean);
  EXPECT_EQ(back.terms_max, result.terms_max);
  EXPECT_EQ(back.compression_ratio, result.compression_ratio);
  EXPECT_EQ(back.matrix_psnr_db, result.matrix_psnr_db);
  EXPECT_EQ(back.matrix_psnr_mean_only_db, result.matrix_psnr_mean_only_db);
  EXPECT_EQ(back.matrix_psnr_by_terms_db, result.matrix_psnr_by_terms_db);
  EXPECT_EQ(back.singular_value_share, result.singular_value_share);
  EXPECT_EQ(back.unseen_triangles, result.unseen_triangles);
}

TEST_F(EncodeFiles, AModelWithFewerTermsThanWantedComesBack) {
  const SyntheticLightField matte = MakeLightField(
      MakeSphere(1), 6, 40, [](int) { return 4; },
      [](const Eigen::Vector3d&, const Eigen::Vector3d&) -> Eigen::Vector3d {
        return {0.5, 0.4, 0.3};
      });
  SaveEncode(Encode(matte.Source(), {.terms = 3}, SilentProgress()), work_ / "encode");
  const EncodeResult back = LoadEncode(work_ / "encode");
  EXPECT_LT(back.terms_max, 2);  // one at most, for what rounding the mean left over
  EXPECT_EQ(back.model.terms, back.terms_max);
  EXPECT_EQ(back.singular_value_share.size(), static_cast<size_t>(back.terms_max));
}

TEST_F(EncodeFiles, LoadRefusesDamagedFigures) {
  SaveEncode(Encode(field_.Source(), {.terms = 2}, SilentProgress()), work_ / "encode");
  const fs::path file = work_ / "encode" / "encode.json";
  const nlohmann::json good = ReadJson(file);
  for (const char* key : {"terms_mean", "maps_bytes", "singular_value_share"}) {
    nlohmann::json damaged = good;
    damaged[key] = "many";
    WriteJson(damaged, file);
    EXPECT_THROW(LoadEncode(work_ / "encode"), Error) << key;
    damaged.erase(key);
    WriteJson(damaged, file);
    EXPECT_THROW(LoadEncode(work_ / "encode"), Error) << key;
  }
  nlohmann::json unknown = good;
  unknown["surprise"] = 1;
  WriteJson(unknown, file);
  EXPECT_THROW(LoadEncode(work_ / "encode"), Error);
  EXPECT_THROW(LoadEncode(work_ / "nowhere"), Error);
}

TEST_F(EncodeFiles, FileAndMemoryGiveTheSameModel) {
  WriteLightField();
  const EncodeResult from_file = Encode(LightField::Open(LightFieldFile()), {}, SilentProgress());
  const EncodeResult from_memory = Encode(field_.Source(), {}, SilentProgress());
  EXPECT_EQ(from_file.model.mean_pages[0].Bytes(), from_memory.model.mean_pages[0].Bytes());
  EXPECT_NEAR(from_file.matrix_psnr_db, from_memory.matrix_psnr_db, 0.05);
  EXPECT_EQ(from_file.maps_bytes, from_memory.maps_bytes);
}

TEST_F(EncodeFiles, CommandWritesModelFiguresAndPictures) {
  WriteLightField();
  ASSERT_EQ(Run("'" + work_.string() + "' --terms 2 --pictures"), 0) << Log();
  EXPECT_EQ(ReadGlb(work_ / "encode" / "model.glb").terms, 2);
  EXPECT_GT(LoadEncode(work_ / "encode").matrix_psnr_db, 30);
  for (const char* name : {"mean-view", "surface-maps-2", "view-maps-1", "singular-values"}) {
    EXPECT_TRUE(fs::exists(work_ / "encode" / "pictures" / (std::string(name) + ".png"))) << name;
  }
  // An earlier model's do not stay.
  ASSERT_EQ(Run("'" + work_.string() + "' --terms 1 --pictures"), 0) << Log();
  EXPECT_TRUE(fs::exists(work_ / "encode/pictures/surface-maps-1.png"));
  EXPECT_FALSE(fs::exists(work_ / "encode/pictures/surface-maps-2.png"));
  ASSERT_EQ(Run("'" + work_.string() + "' --terms 1"), 0) << Log();
  EXPECT_FALSE(fs::exists(work_ / "encode/pictures"));
}

// AFX is written on request, and an earlier model's does not stay.
TEST_F(EncodeFiles, CommandWritesAndRemovesAfx) {
  WriteLightField();
  const fs::path folder = work_ / "encode";
  ASSERT_EQ(Run("'" + work_.string() + "' --terms 2 --afx disc"), 0) << Log();
  const LightFieldModel model = ReadModel(folder / "model.wrl").model;
  EXPECT_EQ(model.vertex_terms, ReadGlb(folder / "model.glb").vertex_terms);
  EXPECT_EQ(model.direction_map, DirectionMap::kOrthographic);
  ASSERT_EQ(Run("'" + work_.string() + "' --terms 1 --afx as-is"), 0) << Log();
  EXPECT_EQ(ReadModel(folder / "model.wrl").model.direction_map, DirectionMap::kHemiOctahedral);
  EXPECT_EQ(Run("'" + work_.string() + "' --afx disc --factorization nmf"), 2) << Log();
  EXPECT_TRUE(fs::exists(folder / "model.wrl"));
  ASSERT_EQ(Run("'" + work_.string() + "' --terms 1"), 0) << Log();
  EXPECT_FALSE(fs::exists(folder / "model.wrl"));
  EXPECT_FALSE(fs::exists(folder / "model_afx"));
}

TEST_F(EncodeFiles, CommandRefusesBadInputInOneLine) {
  const auto expect_refused = [&](const std::string& arguments) {
    EXPECT_EQ(Run(arguments), 2) << arguments;
    const std::string log = Log();
    EXPECT_NE(log.find("error"), std::string::npos) << log;
    EXPECT_EQ(std::count(log.begin(), log.end(), '\n'), 1) << log;
    EXPECT_FALSE(fs::exists(work_ / "encode"));
  };
  expect_refused("'" + work_.string() + "'");  // no light field yet
  WriteLightField();
  expect_refused("'" + work_.string() + "' --terms 99");
  expect_refused("'" + work_.string() + "' --guessed-weight nan");
  // What has no effect beside the rest.
  for (const char* idle :
       {"--terms 3 --term-gain 1", "--terms 3 --max-terms 4", "--target-db 40 --term-gain 0.5",
        "--factorization nmf --fill mirror", "--vq-start pairwise", "--edge-weight 2",
        "--block-quality best", "--transport-db 0 --geometry-error 0.1",
        "--factorization nmf --max-terms 3"}) {
    expect_refused("'" + work_.string() + "' " + idle);
    EXPECT_NE(Log().find("has no effect"), std::string::npos) << Log();
  }
  // There are no poses.
  expect_refused("'" + work_.string() + "' --fill mirror -q");
  EXPECT_NE(Log().find("poses.json"), std::string::npos) << Log();
  EXPECT_NE(Log().find("--fill blend"), std::string::npos) << Log();
  fs::resize_file(LightFieldFile(), fs::file_size(LightFieldFile()) / 2);
  expect_refused("'" + work_.string() + "'");
}

// Truncated anywhere, or with any byte changed: one line that names the file and the cure.
TEST_F(EncodeFiles, CommandNamesADamagedLightField) {
  WriteLightField();
  const std::string good = ReadFile(LightFieldFile());
  const auto expect_named = [&](const std::string& bytes, size_t at) {
    WriteFileAtomically(LightFieldFile(), bytes);
    EXPECT_EQ(Run("'" + work_.string() + "'"), 2) << at;
    const std::string log = Log();
    EXPECT_NE(log.find(LightFieldFile().string() + ": "), std::string::npos) << log;
    EXPECT_NE(log.find("run lfm-resample again"), std::string::npos) << log;
    EXPECT_EQ(std::count(log.begin(), log.end(), '\n'), 1) << log;
  };
  constexpr size_t kPlaces = 12;
  for (size_t i = 0; i < kPlaces; ++i) {
    const size_t at = i * (good.size() - 1) / (kPlaces - 1);
    expect_named(good.substr(0, at), at);
    std::string patched = good;
    patched[at] = static_cast<char>(patched[at] ^ 0x5a);
    expect_named(patched, at);
  }
}

TEST_F(EncodeFiles, CommandSaysWhatItCouldNotReach) {
  WriteLightField();
  const std::string plain = "'" + work_.string() + "' --terms 1 --transport-db 0";
  ASSERT_EQ(Run(plain), 0) << Log();
  EXPECT_NE(Log().find("blending alone"), std::string::npos) << Log();  // no poses, by default
  ASSERT_EQ(Run(plain + " --fill blend --vq-ratio 2"), 0) << Log();
  EXPECT_EQ(Log().find("blending alone"), std::string::npos) << Log();
  EXPECT_EQ(Log().find("not reached"), std::string::npos) << Log();
  ASSERT_EQ(Run(plain + " --vq-ratio 1000"), 0) << Log();
  EXPECT_NE(Log().find("--vq-ratio 1000 is not reached"), std::string::npos) << Log();
  ASSERT_EQ(Run(plain + " --vq-db 30"), 0) << Log();
  EXPECT_EQ(Log().find("asked for"), std::string::npos) << Log();
  ASSERT_EQ(Run(plain + " --vq-db 99 --blocks bc1"), 0) << Log();
  EXPECT_NE(Log().find("--vq-db 99 was asked for"), std::string::npos) << Log();
}

TEST_F(EncodeFiles, CommandLeavesAnOldModelAloneWhenItFails) {
  WriteLightField();
  ASSERT_EQ(Run("'" + work_.string() + "' --terms 1"), 0) << Log();
  const std::string before = ReadFile(work_ / "encode" / "model.glb");
  fs::resize_file(LightFieldFile(), 100);
  EXPECT_EQ(Run("'" + work_.string() + "'"), 2);
  EXPECT_EQ(ReadFile(work_ / "encode" / "model.glb"), before);
}

// Model, transport form and figures are replaced together or not at all.
TEST_F(EncodeFiles, CommandMixesNoOldAndNewFiles) {
  WriteLightField();
  const fs::path folder = work_ / "encode";
  ASSERT_EQ(Run("'" + work_.string() + "' --terms 1"), 0) << Log();
  const std::string model = ReadFile(folder / "model.glb"),
                    figures = ReadFile(folder / "encode.json");
  fs::remove(folder / "model.lfz");
  fs::create_directories(folder / "model.lfz" / "in the way");
  EXPECT_EQ(Run("'" + work_.string() + "' --terms 2"), 1);
  EXPECT_NE(Log().find("model.lfz"), std::string::npos) << Log();
  EXPECT_EQ(Run("'" + work_.string() + "' --terms 2 --transport-db 0"), 1);
  EXPECT_NE(Log().find("model.lfz"), std::string::npos) << Log();
  EXPECT_EQ(ReadFile(folder / "model.glb"), model);
  EXPECT_EQ(ReadFile(folder / "encode.json"), figures);
}

TEST_F(EncodeFiles, CommandReportsAFolderThatCannotBeWritten) {
  WriteLightField();
  std::ofstream(work_ / "encode") << "a file where the folder should be";
  EXPECT_NE(Run("'" + work_.string() + "'"), 0);
  EXPECT_EQ(ReadFile(work_ / "encode"), "a file where the folder should be");
}

TEST(EncodePictures, ShowsTheMapsAndTheShares) {
  const SyntheticLightField field = MakeLightField(
      MakeSphere(1), 8, 60, [](int) { return 5; }, GlossyAppearance);
  const EncodeResult result = Encode(field.Source(), {.terms = 2}, SilentProgress());
  const auto pictures = DrawEncodePictures(result.model, result.singular_value_share, 8);
  ASSERT_EQ(pictures.size(), 6u);
  EXPECT_EQ(pictures[0].name, "mean-view");
  EXPECT_EQ(pictures[0].image.width(), 8);
  EXPECT_EQ(pictures[0].image.At<uint8_t>(6, 3), result.model.mean_pages[0].At<uint8_t>(6, 3));
  EXPECT_EQ(pictures[2].image.At<uint8_t>(5, 7), result.model.view_pages[0][0].At<uint8_t>(5, 7));
}

TEST(EncodePictures, BarsHaveTheHeightsOfTheShares) {
  const Image chart = DrawSingularValues({0.5, 0.25});
  const auto count = [&](int bar) {
    int blue = 0;
    for (int y = 0; y < chart.height(); ++y) {
      const uint8_t* p = &chart.At<uint8_t>(16 + bar * 56 + 20, y);
      blue += p[2] > 150 && p[0] < 100;
    }
    return blue;
  };
  EXPECT_NEAR(count(0), 0.5 * (chart.height() - 2), 1);
  EXPECT_NEAR(count(1), 0.25 * (chart.height() - 2), 1);
  EXPECT_FALSE(DrawSingularValues({}).empty());
}

}  // namespace
}  // namespace lfm::testing
