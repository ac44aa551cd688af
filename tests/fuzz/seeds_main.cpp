// SPDX-License-Identifier: BSD-3-Clause
// What the fuzz targets start from: lfm-fuzz-seeds FOLDER writes small files of every format into
// FOLDER/FORMAT.
#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

#include "core/atomic_file.h"
#include "core/error.h"
#include "encode/afx.h"
#include "encode/encode.h"
#include "encode/glb.h"
#include "encode/png_header.h"
#include "encode/transport_form.h"
#include "resample/light_field.h"
#include "tests/encode/afx_light_maps.h"
#include "tests/encode/synthetic_light_field.h"

namespace lfm::testing {
namespace {

constexpr int kViews = 9;

// Eight triangles, with patches of different sizes.
SyntheticLightField SmallLightField(DirectionMap map) {
  SyntheticLightField field = MakeLightField(
      MakeSphere(0), 3, kViews, [](int t) { return t % 2 == 0 ? 3 : 2; }, GlossyAppearance);
  field.direction_map = map;
  return field;
}

std::vector<LightFieldModel> SmallModels() {
  const SyntheticLightField field = SmallLightField(DirectionMap::kHemiOctahedral);
  const SyntheticLightField disc = SmallLightField(DirectionMap::kOrthographic);
  const auto encode = [](const SyntheticLightField& from, const EncodeOptions& options) {
    return Encode(from.Source(), options, SilentProgress()).model;
  };
  return {encode(field, {.terms = 0}),
          encode(field, {.terms = 1}),
          encode(field, {.terms = 3}),
          encode(disc, {.terms = 2}),
          encode(field, {.tolerance = 4, .max_terms = 3}),
          encode(field, {.term_gain = 0.1, .max_terms = 3}),
          encode(field, {.factorization = Factorization::kNmf, .terms = 2})};
}

void WriteLightField(const SyntheticLightField& field, const std::filesystem::path& file) {
  std::filesystem::create_directories(file.parent_path());
  LightFieldWriter::Header header{field.mesh, field.frames, {}, field.direction_map, field.grid};
  for (int p = 0; p < kViews; ++p) header.photo_ids.push_back("p" + std::to_string(p));
  LightFieldWriter writer(file, header);
  for (const SyntheticLightField::Triangle& t : field.triangles) {
    writer.Write({t.edge_samples, t.photos, t.values, t.weights});
  }
  writer.Finish();
}

// The text of a file whose pictures are named as lfm-fuzz-wrl makes them.
std::string TextWithMadePictures(const AfxFiles& files) {
  std::string text = files.wrl;
  for (const AfxFiles::Picture& picture : files.pictures) {
    const std::string_view png(reinterpret_cast<const char*>(picture.png.data()),
                               picture.png.size());
    const PngHeader header = *ReadPngHeader(png);
    const std::string name = std::to_string(header.channels) + "-" + std::to_string(header.width) +
                             "-" + std::to_string(header.height) + ".png";
    for (size_t at = text.find(picture.name); at != std::string::npos;
         at = text.find(picture.name)) {
      text.replace(at, picture.name.size(), name);
    }
  }
  return text;
}

void WriteSeeds(const std::filesystem::path& folder) {
  WriteLightField(SmallLightField(DirectionMap::kHemiOctahedral), folder / "lfs" / "small.lfs");
  WriteLightField(SmallLightField(DirectionMap::kOrthographic), folder / "lfs" / "disc.lfs");
  int number = 0;
  for (const LightFieldModel& model : SmallModels()) {
    const std::string name = std::to_string(number++);
    WriteGlb(model, folder / "glb" / (name + ".glb"));
    WriteFileAtomically(folder / "lfz" / (name + ".lfz"), EncodeTransport(model, {70}).bytes);
    if (model.mean_in_terms) continue;
    const LightFieldModel form = WithThreeLightMaps(AfxForm(model, {}));
    WriteFileAtomically(folder / "wrl" / (name + ".wrl"), TextWithMadePictures(WriteAfxForm(form)));
  }
}

}  // namespace
}  // namespace lfm::testing

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: lfm-fuzz-seeds FOLDER\n");
    return 2;
  }
  try {
    lfm::testing::WriteSeeds(argv[1]);
  } catch (const lfm::Error& error) {
    std::fprintf(stderr, "lfm-fuzz-seeds: %s\n", error.what());
    return 1;
  }
  return 0;
}
