// SPDX-License-Identifier: BSD-3-Clause
#include "viewer/model_loader.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <fstream>
#include <thread>

#include "core/atomic_file.h"
#include "core/parallel.h"
#include "encode/glb.h"
#include "encode/glb_container.h"
#include "encode/model_evaluation.h"
#include "encode/transport_form.h"
#include "tests/support/scratch_folder.h"
#include "tests/viewer/compressed_models.h"
#include "tests/viewer/synthetic_model.h"

namespace lfm {
namespace {

using Arrival = ModelLoader::Arrival;

constexpr const char* kGolden = LFM_SOURCE_DIR "/tests/encode/data/golden_v2.lfz";

LightFieldModel Model() { return MakeSmoothRandomModel(1, DirectionMap::kHemiOctahedral); }

// Everything that arrives, as a window that is drawn now and then asks for it.
std::vector<Arrival> AllOf(ModelLoader& loader) {
  std::vector<Arrival> all;
  while (!loader.Done()) {
    if (std::optional<Arrival> arrival = loader.Next()) {
      all.push_back(std::move(*arrival));
    } else {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  }
  EXPECT_FALSE(loader.Next());
  return all;
}

std::vector<Arrival> Loaded(std::vector<SceneEntry> entries) {
  ModelLoader loader(std::move(entries));
  return AllOf(loader);
}

void ExpectNote(const Arrival& arrival, const std::filesystem::path& file,
                const std::string& what = "") {
  EXPECT_FALSE(arrival.model.model);
  EXPECT_TRUE(arrival.whole);
  EXPECT_TRUE(arrival.note.starts_with(file.string())) << arrival.note;
  EXPECT_NE(arrival.note.find(what), std::string::npos) << arrival.note;
  EXPECT_EQ(arrival.note.find('\n'), std::string::npos) << arrival.note;
}

// Seen from above each triangle's middle and corners.
void ExpectShowsTheSame(const LightFieldModel& a, const LightFieldModel& b, int terms_of_b) {
  ASSERT_EQ(a.mesh.triangles, b.mesh.triangles);
  for (int t = 0; t < static_cast<int>(a.mesh.triangles.size()); ++t) {
    const Eigen::Vector3d to_eye = TriangleNormal(a.mesh, t);
    for (const Eigen::Vector3d& weights :
         {Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(0.3, 0.3, 0.4), Eigen::Vector3d(0, 0.5, 0.5)}) {
      ASSERT_EQ(EvaluateModel(a, t, weights, to_eye),
                EvaluateModel(b, t, weights, to_eye, {.terms = terms_of_b}))
          << t;
    }
  }
}

TEST(ModelLoader, BringsTheMeanViewFirst) {
  const ScratchFolder scratch;
  std::vector<LightFieldModel> models = {Model(), InBlocks(Model(), BlockFormat::kBc4),
                                         InBlocks(Sharing(Model()), BlockFormat::kBc1),
                                         Coarser(Model())};
  models.push_back(Model());
  models.back().mean_in_terms = true;
  std::vector<SceneEntry> entries;
  for (size_t i = 0; i < models.size(); ++i) {
    SceneEntry& entry = entries.emplace_back();
    entry.file = scratch.folder / (std::to_string(i) + ".glb");
    entry.placement.scale = 2.0 + static_cast<double>(i);
    entry.placement.world_from_model.translation = {1, 2, 3.0 * static_cast<double>(i)};
    WriteGlb(models[i], entry.file);
  }
  const std::vector<Arrival> arrivals = Loaded(entries);
  ASSERT_EQ(arrivals.size(), 2 * models.size());
  for (size_t i = 0; i < models.size(); ++i) {
    const Arrival &mean = arrivals[2 * i], &all = arrivals[2 * i + 1];
    const LightFieldModel read = ReadGlb(entries[i].file);
    ASSERT_TRUE(mean.model.model && all.model.model) << mean.note << all.note;
    EXPECT_FALSE(mean.whole);
    EXPECT_TRUE(all.whole);
    for (const Arrival* arrival : {&mean, &all}) {
      EXPECT_EQ(arrival->entry, i);
      EXPECT_EQ(arrival->note, "");
      EXPECT_EQ(arrival->model.name, std::to_string(i) + ".glb");
      EXPECT_EQ(arrival->model.placement.scale, entries[i].placement.scale);
      EXPECT_EQ(arrival->model.placement.world_from_model.translation,
                entries[i].placement.world_from_model.translation);
    }
    EXPECT_EQ(mean.model.model->terms, 0);
    EXPECT_EQ(all.model.model->terms, 3);
    ExpectShowsTheSame(*mean.model.model, read, 0);
    ExpectShowsTheSame(*all.model.model, read, read.terms);
  }
}

TEST(ModelLoader, TellsFormsByTheirContent) {
  const ScratchFolder scratch;
  WriteGlb(Model(), scratch.folder / "a.wrl");
  WriteFileAtomically(scratch.folder / "b.glb", ReadFile(kGolden));
  const std::vector<Arrival> arrivals =
      Loaded({{scratch.folder / "a.wrl", {}}, {scratch.folder / "b.glb", {}}});
  ASSERT_EQ(arrivals.size(), 3u);
  EXPECT_FALSE(arrivals[0].whole);
  ASSERT_TRUE(arrivals[1].model.model) << arrivals[1].note;
  EXPECT_EQ(arrivals[1].model.model->terms, 3);
  ASSERT_TRUE(arrivals[2].model.model) << arrivals[2].note;
  EXPECT_TRUE(arrivals[2].whole);
  EXPECT_EQ(arrivals[2].note, "");
  ExpectShowsTheSame(*arrivals[2].model.model, ReadModel(kGolden).model, 2);
}

TEST(ModelLoader, TellsWhatIsMissing) {
  const ScratchFolder scratch;
  const std::filesystem::path file = scratch.folder / "cut.lfz";
  const std::string bytes = ReadFile(kGolden);
  WriteFileAtomically(file, std::string_view(bytes).substr(0, bytes.size() - 1));
  const std::vector<Arrival> arrivals = Loaded({{file, {}}});
  ASSERT_EQ(arrivals.size(), 1u);
  EXPECT_TRUE(arrivals[0].model.model);
  EXPECT_TRUE(arrivals[0].whole);
  EXPECT_TRUE(arrivals[0].note.starts_with(file.string())) << arrivals[0].note;
  EXPECT_NE(arrivals[0].note.find("is cut off"), std::string::npos) << arrivals[0].note;
}

TEST(ModelLoader, FailuresAreNotes) {
  const ScratchFolder scratch;
  const std::string glb = GlbBytes(Model()), lfz = ReadFile(kGolden);
  const std::pair<const char*, std::string> bad[] = {
      {"empty.glb", ""},
      {"four.glb", "glTF"},
      {"half.glb", glb.substr(0, glb.size() / 2)},
      {"longer.glb", glb + "tail"},
      {"head.lfz", lfz.substr(0, 20)},
      {"text.txt", "no model\nat all"},
      {"vrml.wrl", "#VRML V2.0 utf8\nShape {"},
      {"two\nlines.glb", "glTF and more than twelve bytes"},
  };
  std::vector<SceneEntry> entries;
  for (const auto& [name, content] : bad) {
    entries.push_back({scratch.folder / name, {}});
    WriteFileAtomically(entries.back().file, content);
  }
  entries.push_back({scratch.folder / "absent.glb", {}});
  entries.push_back({scratch.folder, {}});
  entries.push_back({"", {}});
  entries.push_back({scratch.folder / "good.glb", {}});
  WriteGlb(Model(), entries.back().file);
  const std::vector<Arrival> arrivals = Loaded(entries);
  ASSERT_EQ(arrivals.size(), entries.size() + 1);
  for (size_t i = 0; i + 1 < entries.size(); ++i) {
    EXPECT_EQ(arrivals[i].entry, i);
    const std::string name = entries[i].file.string();
    ExpectNote(arrivals[i], name.substr(0, name.find('\n')), ": ");
  }
  EXPECT_TRUE(arrivals.back().model.model);  // what went wrong before does not matter
}

// A file that is longer than the memory that there may be.
TEST(ModelLoader, LackOfMemoryIsANote) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "sanitizers end the program where memory lacks";
#endif
  const ScratchFolder scratch;
  const std::filesystem::path file = scratch.folder / "long.glb";
  WriteFileAtomically(file, "glTF");
  std::filesystem::resize_file(file, uintmax_t{8} << 30);
  rlim_t pages = 0;
  std::ifstream("/proc/self/statm") >> pages;
  rlimit before;
  ASSERT_EQ(getrlimit(RLIMIT_AS, &before), 0);
  rlimit less = before;
  less.rlim_cur = pages * static_cast<rlim_t>(sysconf(_SC_PAGESIZE)) + (rlim_t{1} << 30);
  ASSERT_EQ(setrlimit(RLIMIT_AS, &less), 0);
  const std::vector<Arrival> arrivals = Loaded({{file, {}}});
  ASSERT_EQ(setrlimit(RLIMIT_AS, &before), 0);
  ASSERT_EQ(arrivals.size(), 1u);
  ExpectNote(arrivals[0], file, "not enough memory");
}

// The mean view is there; the last picture, of a term's view maps, is not.
TEST(ModelLoader, MayFailBehindTheMeanView) {
  const ScratchFolder scratch;
  const std::filesystem::path file = scratch.folder / "damaged.glb";
  std::string bytes = GlbBytes(Model());
  const size_t end = bytes.rfind("IDAT");
  ASSERT_NE(end, std::string::npos);
  bytes.replace(end + 4, 8, 8, '\xff');
  WriteFileAtomically(file, bytes);
  const std::vector<Arrival> arrivals = Loaded({{file, {}}});
  ASSERT_EQ(arrivals.size(), 2u);
  ASSERT_TRUE(arrivals[0].model.model);
  EXPECT_FALSE(arrivals[0].whole);
  EXPECT_EQ(arrivals[0].note, "");
  ExpectNote(arrivals[1], file);
}

TEST(ModelLoader, AFileThatComesTwiceIsReadOnce) {
  const ScratchFolder scratch;
  const std::filesystem::path file = scratch.folder / "a.glb", other = scratch.folder / "b.glb";
  WriteGlb(Model(), file);
  WriteGlb(Model(), other);
  Placement moved;
  moved.world_from_model.translation = {7, 8, 9};
  const std::vector<Arrival> arrivals = Loaded({{file, {}}, {other, {}}, {file, moved}});
  ASSERT_EQ(arrivals.size(), 5u);
  EXPECT_EQ(arrivals[4].entry, 2u);
  EXPECT_TRUE(arrivals[4].whole);
  EXPECT_EQ(arrivals[4].model.model, arrivals[1].model.model);
  EXPECT_NE(arrivals[3].model.model, arrivals[1].model.model);
  EXPECT_EQ(arrivals[4].model.placement.world_from_model.translation,
            moved.world_from_model.translation);
}

TEST(ModelLoader, NamesModelsApart) {
  const ScratchFolder scratch;
  const std::filesystem::path first = scratch.folder / "one" / "model.glb";
  const std::filesystem::path second = scratch.folder / "two" / "model.glb";
  const std::filesystem::path third = scratch.folder / "two" / "bust.glb";
  const std::vector<Arrival> arrivals =
      Loaded({{first, {}}, {second, {}}, {third, {}}, {third, {}}});
  ASSERT_EQ(arrivals.size(), 4u);
  EXPECT_EQ(arrivals[0].model.name, first.string());
  EXPECT_EQ(arrivals[1].model.name, second.string());
  EXPECT_EQ(arrivals[2].model.name, "bust.glb");
  EXPECT_EQ(arrivals[3].model.name, "bust.glb");
}

TEST(ModelLoader, TellsHowFarItIs) {
  const ScratchFolder scratch;
  std::vector<SceneEntry> entries;
  for (const char* name : {"a.glb", "b.glb", "c.glb"}) {
    entries.push_back({scratch.folder / name, {}});
    WriteGlb(Model(), entries.back().file);
  }
  ModelLoader loader(entries);
  double share = 0;
  std::vector<std::string> names;
  while (!loader.Done()) {
    const double now = loader.Share();
    EXPECT_GE(now, share);
    EXPECT_LE(now, 1);
    share = now;
    const std::string name = loader.What();
    if (names.empty() || names.back() != name) names.push_back(name);
    if (loader.Next()) {
      EXPECT_GT(loader.Share(), 0);
    }
  }
  EXPECT_EQ(loader.Share(), 1);
  EXPECT_EQ(loader.What(), "");
  for (const std::string& name : names) {
    EXPECT_TRUE(name.empty() || name == "a.glb" || name == "b.glb" || name == "c.glb") << name;
  }
  EXPECT_TRUE(std::is_sorted(names.begin(), names.end() - (names.back().empty() ? 1 : 0)));
}

TEST(ModelLoader, NothingToReadIsDone) {
  ModelLoader loader({});
  EXPECT_TRUE(loader.Done());
  EXPECT_EQ(loader.Share(), 1);
  EXPECT_EQ(loader.What(), "");
  EXPECT_FALSE(loader.Next());
}

// A window that is closed early, at different moments.
TEST(ModelLoader, MayGoWhileItReads) {
  const ScratchFolder scratch;
  std::vector<SceneEntry> entries(50, {scratch.folder / "a.glb", {}});
  WriteGlb(Model(), entries.front().file);
  for (int moment = 0; moment < 8; ++moment) {
    ModelLoader loader(entries);
    for (int i = 0; i < moment;) {
      const std::optional<Arrival> arrival = loader.Next();
      if (!arrival) continue;
      EXPECT_EQ(arrival->note, "");
      ++i;
    }
  }
}

TEST(ModelLoader, ReadsBesideOtherWork) {
  const ScratchFolder scratch;
  const std::filesystem::path file = scratch.folder / "a.glb";
  WriteGlb(Model(), file);
  ModelLoader loader({{file, {}}, {scratch.folder / "absent.glb", {}}, {file, {}}});
  while (!loader.Done()) {
    std::atomic<int64_t> sum{0};
    ParallelFor(0, 1000, [&](int64_t i) { sum += i; });
    ASSERT_EQ(sum, 499500);
    if (const std::optional<Arrival> arrival = loader.Next()) {
      EXPECT_EQ(arrival->model.model == nullptr, arrival->entry == 1) << arrival->note;
    }
  }
}

}  // namespace
}  // namespace lfm
