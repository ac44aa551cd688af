// SPDX-License-Identifier: BSD-3-Clause
#include "sample_data/texture.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/error.h"
#include "sample_data/bsdf.h"
#include "sample_data/paint.h"

namespace lfm {
namespace {

using V3 = Eigen::Vector3d;
using V3f = Eigen::Vector3f;
using V2 = Eigen::Vector2d;

constexpr double kPi = std::numbers::pi;

double Turbulence(const V3& p, uint64_t seed) {
  return GradientNoise(p, seed) + 0.5 * GradientNoise(2.03 * p, seed + 1) +
         0.25 * GradientNoise(4.01 * p, seed + 2);
}

int Wrapped(int i, int n) { return ((i % n) + n) % n; }

V3f ImageValue(const Image& image, const V2& uv) {
  // Into the first tile, however far away it was.
  const double u = uv.x() - std::floor(uv.x()), v = uv.y() - std::floor(uv.y());
  const double x = u * image.width() - 0.5, y = (1 - v) * image.height() - 0.5;
  const double x0 = std::floor(x), y0 = std::floor(y);
  const float fx = static_cast<float>(x - x0), fy = static_cast<float>(y - y0);
  const auto pixel = [&](int dx, int dy) {
    const float* p = &image.At<float>(Wrapped(static_cast<int>(x0) + dx, image.width()),
                                      Wrapped(static_cast<int>(y0) + dy, image.height()));
    return V3f(p[0], p[1], p[2]);
  };
  return (1 - fy) * ((1 - fx) * pixel(0, 0) + fx * pixel(1, 0)) +
         fy * ((1 - fx) * pixel(0, 1) + fx * pixel(1, 1));
}

// Weight of color_b.
double ProcedureWeight(const Texture& texture, const V3& p) {
  switch (texture.kind) {
    case TextureKind::kChecker: {
      const double cells = std::floor(p.x()) + std::floor(p.y()) + std::floor(p.z());
      return std::fmod(std::abs(cells), 2.0);
    }
    case TextureKind::kStripes:
      return std::fmod(std::abs(std::floor(p.x())), 2.0);
    case TextureKind::kNoise:
      return std::clamp(0.5 + 0.7 * Turbulence(p, texture.seed), 0.0, 1.0);
    case TextureKind::kMarble: {
      const double warp = Turbulence(p, texture.seed + 31);
      const double vein =
          std::abs(GradientNoise(1.3 * p + V3(warp, -warp, warp), texture.seed + 33));
      return std::exp(-std::pow(vein / 0.06, 2)) * 0.8 + 0.1 * (1 + warp) * 0.5;
    }
    case TextureKind::kNone:
    case TextureKind::kImage:
      break;
  }
  return 0;
}

[[noreturn]] void Fail(const SceneObject& object, const std::string& what) {
  throw Error("object '" + object.name + "': " + what);
}

}  // namespace

TextureFrame MakeTextureFrame(const SceneObject& object) {
  TextureFrame frame;
  for (const V3& p : object.mesh.vertices) frame.bounds.extend(p);
  if (frame.bounds.isEmpty()) return frame;
  const V3 sizes = frame.bounds.sizes().cwiseMax(1e-6);
  const double radius = 0.5 * std::max(sizes.x(), sizes.y());
  switch (object.texture.mapping) {
    case TextureMapping::kPlanar:
      frame.size_mm = sizes.head<2>();
      break;
    case TextureMapping::kCylinder:
      frame.size_mm = {2 * kPi * radius, sizes.z()};
      break;
    case TextureMapping::kSphere:
      frame.size_mm = {2 * kPi * radius, kPi * 0.5 * sizes.z()};
      break;
    case TextureMapping::kSolid:
    case TextureMapping::kUv:
      frame.size_mm = V2::Constant(sizes.maxCoeff());
      break;
  }
  return frame;
}

V2 TextureCoordinates(TextureMapping mapping, const TextureFrame& frame, const V3& point,
                      const V2& uv) {
  if (mapping == TextureMapping::kUv) return uv;
  if (mapping == TextureMapping::kSolid || frame.bounds.isEmpty()) return V2::Zero();
  const V3 unit =
      ((point - frame.bounds.min()).array() / frame.bounds.sizes().cwiseMax(1e-6).array())
          .cwiseMax(0)
          .cwiseMin(1);
  if (mapping == TextureMapping::kPlanar) return unit.head<2>();
  const V3 d = point - frame.bounds.center();
  const double azimuth = std::clamp(0.5 + std::atan2(d.y(), d.x()) / (2 * kPi), 0.0, 1.0);
  if (mapping == TextureMapping::kCylinder) return {azimuth, unit.z()};
  const double polar = std::atan2(std::hypot(d.x(), d.y()), d.z());
  return {azimuth, std::clamp(1 - polar / kPi, 0.0, 1.0)};
}

V3f TextureValue(const Texture& texture, const TextureFrame& frame, const V3& point, const V2& uv) {
  if (texture.kind == TextureKind::kNone) return V3f::Ones();
  const V2 place = TextureCoordinates(texture.mapping, frame, point, uv);
  if (texture.kind == TextureKind::kImage) {
    return texture.image == nullptr ? V3f(V3f::Ones()) : ImageValue(*texture.image, place);
  }
  const V3 p = texture.mapping == TextureMapping::kSolid
                   ? V3(point / texture.scale_mm)
                   : V3(place.x() * frame.size_mm.x() / texture.scale_mm,
                        place.y() * frame.size_mm.y() / texture.scale_mm, 0.5);
  const float w = static_cast<float>(std::clamp(ProcedureWeight(texture, p), 0.0, 1.0));
  return texture.color_a + w * (texture.color_b - texture.color_a);
}

Material ResolveMaterial(const SceneObject& object, const TextureFrame& frame, int triangle,
                         float u, float v, const V3f& point) {
  Material material = object.material;
  const bool textured = object.texture.kind != TextureKind::kNone;
  if (object.paint.empty() && !textured) return material;
  const Eigen::Vector3i& t = object.mesh.triangles[triangle];
  const float w = 1 - u - v;
  if (!object.paint.empty()) {
    const Paint &a = object.paint[t[0]], &b = object.paint[t[1]], &c = object.paint[t[2]];
    material.kind = MaterialKind::kPaint;
    material.diffuse = w * a.diffuse + u * b.diffuse + v * c.diffuse;
    material.specular = w * a.coat + u * b.coat + v * c.coat;
    material.alpha_u = material.alpha_v = w * a.alpha + u * b.alpha + v * c.alpha;
    return material;
  }
  V2 uv = V2::Zero();
  if (!object.uv.empty()) {
    uv = (w * object.uv[t[0]] + u * object.uv[t[1]] + v * object.uv[t[2]]).cast<double>();
  }
  const V3f value = TextureValue(object.texture, frame, point.cast<double>(), uv);
  material.diffuse = material.diffuse.cwiseProduct(value).cwiseMin(1.0f);
  if (material.kind == MaterialKind::kFuzz || material.kind == MaterialKind::kConductor) {
    material.specular = material.specular.cwiseProduct(value).cwiseMin(1.0f);
  }
  return material;
}

void ValidateSurface(const SceneObject& object) {
  ValidateMaterial(object.material, "object '" + object.name + "'");
  const size_t vertices = object.mesh.vertices.size();
  if (!object.paint.empty() && object.paint.size() != vertices) {
    Fail(object, "paint must be given for every vertex");
  }
  if (!object.uv.empty() && object.uv.size() != vertices) {
    Fail(object, "texture coordinates must be given for every vertex");
  }
  const Texture& texture = object.texture;
  if (texture.kind == TextureKind::kNone) return;
  if (texture.mapping == TextureMapping::kUv && object.uv.empty()) {
    Fail(object, "its texture needs coordinates, which the mesh has not; map it by a projection");
  }
  if (texture.kind != TextureKind::kImage) {
    if (!(texture.scale_mm > 0) || !std::isfinite(texture.scale_mm)) {
      Fail(object, "its texture's scale must be positive");
    }
    for (int c = 0; c < 3; ++c) {
      if (!(texture.color_a[c] >= 0 && texture.color_a[c] <= 1 && texture.color_b[c] >= 0 &&
            texture.color_b[c] <= 1)) {
        Fail(object, "its texture's colours must lie in [0, 1]");
      }
    }
    return;
  }
  if (texture.image == nullptr || texture.image->empty()) Fail(object, "its texture has no image");
  if (texture.image->type() != PixelType::kFloat32 || texture.image->channels() != 3) {
    Fail(object, "its texture's image must be float RGB");
  }
  const float* values = texture.image->Data<float>();
  for (size_t i = 0; i < texture.image->size(); ++i) {
    if (!(values[i] >= 0 && values[i] <= 10)) {
      Fail(object, "its texture's image has values outside [0, 10] or not finite");
    }
  }
}

Image ReadTextureImage(const std::filesystem::path& file) {
  // A 16-bit PNG does not say what it holds: as 8-bit ones, take it as sRGB.
  const Image picture = ToLinearFloat(ReadImage(file, ColorEncoding::kSrgb));
  const size_t used = picture.channels() < 3 ? 1 : 3;  // alpha is left out
  Image rgb(picture.width(), picture.height(), 3, PixelType::kFloat32, ColorEncoding::kLinear);
  const float* from = picture.Data<float>();
  float* to = rgb.Data<float>();
  for (size_t i = 0; i < rgb.size() / 3; ++i) {
    for (size_t c = 0; c < 3; ++c) {
      const float value = from[i * picture.channels() + (used == 3 ? c : 0)];
      if (!(value >= 0 && value <= 1)) {
        throw Error(file.string() + ": a texture's values must lie between 0 and 1");
      }
      to[3 * i + c] = value;
    }
  }
  return rgb;
}

}  // namespace lfm
