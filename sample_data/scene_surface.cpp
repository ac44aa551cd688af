// SPDX-License-Identifier: BSD-3-Clause
#include "sample_data/scene_surface.h"

#include <algorithm>
#include <sstream>

#include "core/error.h"
#include "sample_data/texture.h"

namespace lfm {
namespace {

const std::vector<std::string> kMaterialKinds = {"lambert", "phong", "conductor", "paint",
                                                 "plastic", "glass", "fuzz"};
const std::vector<std::string> kTextureKinds = {"none",  "checker", "stripes",
                                                "noise", "marble",  "image"};
const std::vector<std::string> kMappings = {"solid", "planar", "cylinder", "sphere", "uv"};

Eigen::Vector3f Color(JsonReader& reader, const std::string& key,
                      const Eigen::Vector3f& otherwise) {
  return VectorInRange(reader, key, otherwise.cast<double>(), 0, 1).cast<float>();
}

float Roughness(JsonReader& reader, const std::string& key, float otherwise) {
  return static_cast<float>(NumberInRange(reader, key, otherwise, 0, 1));
}

// "alpha", or "alpha_u" and "alpha_v" where the surface may be brushed.
void ReadRoughness(JsonReader& reader, bool brushed, Material& material) {
  if (brushed && (reader.Has("alpha_u") || reader.Has("alpha_v"))) {
    if (reader.Has("alpha")) reader.Fail("alpha", "give alpha, or alpha_u and alpha_v, not both");
    material.alpha_u = Roughness(reader, "alpha_u", material.alpha_u);
    material.alpha_v = Roughness(reader, "alpha_v", material.alpha_v);
    return;
  }
  material.alpha_u = material.alpha_v = Roughness(reader, "alpha", material.alpha_u);
}

Image ReadTexturePicture(JsonReader& reader, const std::filesystem::path& file) {
  try {
    return ReadTextureImage(file);
  } catch (const Error& e) {
    reader.Fail("file", e.what());
  }
}

}  // namespace

double NumberInRange(JsonReader& reader, const std::string& key, double otherwise, double min,
                     double max) {
  const double value = reader.NumberOr(key, otherwise);
  if (!(value >= min && value <= max)) {
    std::ostringstream text;
    text << "expected a number between " << min << " and " << max;
    reader.Fail(key, text.str());
  }
  return value;
}

Eigen::Vector3d VectorInRange(JsonReader& reader, const std::string& key,
                              const Eigen::Vector3d& otherwise, double min, double max) {
  if (!reader.Has(key)) return otherwise;
  const std::vector<double> v = reader.Numbers(key, 3);
  for (const double value : v) {
    if (value >= min && value <= max) continue;
    std::ostringstream text;
    text << "expected three numbers between " << min << " and " << max;
    reader.Fail(key, text.str());
  }
  return {v[0], v[1], v[2]};
}

int WordIndex(JsonReader& reader, const std::string& key, const std::vector<std::string>& words) {
  const std::string word = reader.Text(key);
  const auto found = std::find(words.begin(), words.end(), word);
  if (found == words.end()) {
    std::string all;
    for (const std::string& w : words) all += (all.empty() ? "" : ", ") + w;
    reader.Fail(key, "'" + word + "' is none of " + all);
  }
  return static_cast<int>(found - words.begin());
}

std::filesystem::path ExistingFile(JsonReader& reader, const std::string& key,
                                   const std::filesystem::path& folder) {
  const std::string name = reader.Text(key);
  if (name.empty()) reader.Fail(key, "expected the name of a file");
  const std::filesystem::path file = folder / name;
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(file, ignored)) {
    reader.Fail(key, "there is no file " + file.string());
  }
  return file;
}

Material ReadMaterial(JsonReader reader) {
  Material m;
  m.kind = static_cast<MaterialKind>(WordIndex(reader, "kind", kMaterialKinds));
  switch (m.kind) {
    case MaterialKind::kLambert:
      m.diffuse = Color(reader, "diffuse", m.diffuse);
      break;
    case MaterialKind::kPhong:
      m.diffuse = Color(reader, "diffuse", m.diffuse);
      m.specular = Color(reader, "specular", m.specular);
      m.exponent = static_cast<float>(NumberInRange(reader, "exponent", m.exponent, 0, 1e6));
      if ((m.diffuse + m.specular).maxCoeff() > 1) {
        reader.Fail("specular", "together with diffuse above 1: more than all light is reflected");
      }
      break;
    case MaterialKind::kConductor:
      m.specular = Color(reader, "specular", {0.9f, 0.9f, 0.9f});
      ReadRoughness(reader, true, m);
      break;
    case MaterialKind::kPaint:
      m.diffuse = Color(reader, "diffuse", m.diffuse);
      m.specular = Color(reader, "specular", {0.1f, 0.1f, 0.1f});
      ReadRoughness(reader, false, m);
      break;
    case MaterialKind::kPlastic:
      m.diffuse = Color(reader, "diffuse", m.diffuse);
      m.ior = static_cast<float>(NumberInRange(reader, "ior", m.ior, 1, 4));
      ReadRoughness(reader, true, m);
      break;
    case MaterialKind::kGlass:
      m.ior = static_cast<float>(NumberInRange(reader, "ior", m.ior, 1, 4));
      m.alpha_u = m.alpha_v = 0;
      ReadRoughness(reader, false, m);
      m.absorption_per_mm =
          VectorInRange(reader, "absorption_per_mm", Eigen::Vector3d::Zero(), 0, 100).cast<float>();
      break;
    case MaterialKind::kFuzz:
      m.diffuse = Color(reader, "diffuse", m.diffuse);
      m.specular = Color(reader, "specular", {0.2f, 0.2f, 0.2f});
      ReadRoughness(reader, false, m);
      break;
  }
  reader.Finish();
  return m;
}

Texture ReadTexture(JsonReader reader, const std::filesystem::path& folder) {
  Texture t;
  t.kind = static_cast<TextureKind>(WordIndex(reader, "kind", kTextureKinds));
  if (t.kind == TextureKind::kNone) {
    reader.Finish();
    return t;
  }
  if (reader.Has("mapping")) {
    t.mapping = static_cast<TextureMapping>(WordIndex(reader, "mapping", kMappings));
  }
  if (t.kind == TextureKind::kImage) {
    if (t.mapping == TextureMapping::kSolid) {
      reader.Fail("mapping", "a picture needs one of planar, cylinder, sphere, uv");
    }
    t.image =
        std::make_shared<Image>(ReadTexturePicture(reader, ExistingFile(reader, "file", folder)));
  } else {
    t.color_a = Color(reader, "color_a", t.color_a);
    t.color_b = Color(reader, "color_b", t.color_b);
    t.scale_mm = NumberInRange(reader, "scale_mm", t.scale_mm, 1e-3, 1e5);
    if (reader.Has("seed"))
      t.seed = static_cast<uint64_t>(reader.Integer("seed", 0, 1'000'000'000));
  }
  reader.Finish();
  return t;
}

}  // namespace lfm
