// SPDX-License-Identifier: BSD-3-Clause
#include "encode/memory_need.h"

#include <gtest/gtest.h>

#include <fstream>

#include "core/error.h"
#include "core/process_memory.h"
#include "tests/encode/synthetic_light_field.h"

namespace lfm::testing {
namespace {

// With sanitizers their own memory would be measured.
#if !defined(__SANITIZE_ADDRESS__)
TEST(MemoryNeed, IsNotExceededAndNotFarOff) {
  const SyntheticLightField field = MakeLightField(
      MakeSphere(5), 16, 20, [](int) { return 4; }, GlossyAppearance);
  const LightFieldSource source = field.Source();
  EncodeOptions options;
  options.term_gain = 0.01;  // as many terms as there may be
  const std::vector<int> edge_samples(field.triangles.size(), 4);
  const auto need = static_cast<double>(EncodeBytes(source, edge_samples, options));
  const auto before = static_cast<double>(ResidentMemoryBytes());
  std::ofstream("/proc/self/clear_refs") << "5";  // forgets the peak
  const EncodeResult result = Encode(source, options, SilentProgress());
  EXPECT_GT(result.terms_mean, 2);
  const double taken = PeakMemoryMib() * (1 << 20) - before;
  RecordProperty("need_mib", static_cast<int>(need / (1 << 20)));
  RecordProperty("taken_mib", static_cast<int>(taken / (1 << 20)));
  EXPECT_LT(taken, need);
  EXPECT_GT(taken, 0.25 * need);
}
#endif

TEST(MemoryNeed, IsRefusedBeforeAnythingIsFactorised) {
  const SyntheticLightField field = MakeLightField(
      MakeSphere(1), 8, 20, [](int) { return 4; }, GlossyAppearance);
  EncodeOptions options;
  options.memory_mib = 1;
  try {
    Encode(field.Source(), options, SilentProgress());
    FAIL() << "was not refused";
  } catch (const Error& error) {
    const std::string text = error.what();
    EXPECT_EQ(text.find("--encode-memory-mib 1: encoding 32 triangles of 8 x 8 directions"), 0U)
        << text;
    EXPECT_NE(text.find("--max-terms"), std::string::npos) << text;
    EXPECT_NE(text.find("--triangle-count"), std::string::npos) << text;
    EXPECT_EQ(text.find('\n'), std::string::npos);
  }
}

TEST(MemoryNeed, WhatIsNamedIsEnough) {
  const SyntheticLightField field = MakeLightField(
      MakeSphere(1), 8, 20, [](int) { return 4; }, GlossyAppearance);
  const std::vector<int> edge_samples(field.triangles.size(), 4);
  EncodeOptions options;
  options.memory_mib = 1;
  try {
    RequireMemory(field.Source(), edge_samples, options);
    FAIL() << "was not refused";
  } catch (const Error& error) {
    const std::string text = error.what(), before = "takes some ";
    options.memory_mib = std::stoi(text.substr(text.find(before) + before.size()));
  }
  constexpr int kOfThisTest_mib = 2;  // what it has come to hold meanwhile
  options.memory_mib += kOfThisTest_mib;
  EXPECT_NO_THROW(RequireMemory(field.Source(), edge_samples, options));
  options.memory_mib = options.memory_mib * 9 / 10;
  EXPECT_THROW(RequireMemory(field.Source(), edge_samples, options), Error);
}

// Two million triangles of the default 16 x 16 directions: nobody has the memory, and all are told.
TEST(MemoryNeed, OfTwoMillionTrianglesIsSaid) {
  TriangleMesh mesh = MakeSphere(0);
  mesh.vertices.resize(1000000);
  const std::vector<Eigen::Matrix3d> frames;
  const LightFieldSource source{mesh, frames, DirectionMap::kHemiOctahedral, 16, {}, {}};
  const std::vector<int> edge_samples(2000000, 4);
  EncodeOptions options;
  EXPECT_GT(EncodeBytes(source, edge_samples, options), int64_t{20} << 30);
  options.memory_mib = 8192;
  EXPECT_THROW(RequireMemory(source, edge_samples, options), Error);
  options.max_terms = 1;
  options.memory_mib = 16384;
  RequireMemory(source, edge_samples, options);
}

}  // namespace
}  // namespace lfm::testing
