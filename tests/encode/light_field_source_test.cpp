// SPDX-License-Identifier: BSD-3-Clause
#include "encode/light_field_source.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>

#include "core/error.h"
#include "encode/encode.h"
#include "tests/encode/synthetic_light_field.h"

namespace lfm::testing {
namespace {

SyntheticLightField SmallField() {
  return MakeLightField(
      MakeSphere(1), 6, 20, [](int) { return 4; }, GlossyAppearance);
}

/// What encoding says of a light field that calls itself work/light_field.lfs.
std::string Complaint(const std::function<void(SyntheticLightField&)>& damage) {
  SyntheticLightField field = SmallField();
  damage(field);
  LightFieldSource source = field.Source();
  source.name = "work/light_field.lfs";
  try {
    Encode(source, {.terms = 1}, SilentProgress());
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

TEST(LightFieldSource, EveryErrorNamesTheFileAndTheCure) {
  using Field = SyntheticLightField;
  const struct {
    std::function<void(Field&)> damage;
    const char* problem;
  } cases[] = {
      {[](Field& f) { f.triangles[3].edge_samples = 1; }, "triangle 3: edge samples"},
      {[](Field& f) { f.triangles[3].edge_samples = 5000; }, "triangle 3: edge samples"},
      {[](Field& f) { f.triangles[4].values.pop_back(); }, "triangle 4: the patch"},
      {[](Field& f) { f.triangles[5].weights[1].view[7] = 65535; }, "triangle 5: a view weight"},
      {[](Field& f) { f.triangles[5].weights[2].weight[7] = -1; }, "triangle 5: view weights"},
      {[](Field& f) { f.triangles[5].weights[2].seen.pop_back(); }, "triangle 5: view weights"},
      {[](Field& f) { f.frames.pop_back(); }, "one frame a vertex"},
      {[](Field& f) { f.grid = 1; }, "the view grid"},
      {[](Field& f) {
         for (auto& t : f.triangles) t.photos.clear(), t.values.clear();
       },
       "no photograph shows enough"},
  };
  for (const auto& one : cases) {
    const std::string text = Complaint(one.damage);
    EXPECT_EQ(text.find("work/light_field.lfs: " + std::string(one.problem)), 0U) << text;
    EXPECT_NE(text.find("run lfm-resample again"), std::string::npos) << text;
    EXPECT_EQ(text.find('\n'), std::string::npos) << text;
  }
}

TEST(LightFieldSource, APhotographWithoutAPoseNamesTheFile) {
  try {
    EyesOfPhotos({}, {"p7"}, "work/light_field.lfs");
    FAIL() << "was found";
  } catch (const Error& error) {
    EXPECT_EQ(std::string(error.what()),
              "work/light_field.lfs: photograph 'p7' has no pose in the calibration; run "
              "lfm-resample again");
  }
}

}  // namespace
}  // namespace lfm::testing
