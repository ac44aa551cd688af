// SPDX-License-Identifier: BSD-3-Clause
#include "sample_data/light_baking.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <atomic>
#include <cmath>
#include <numbers>

#include "core/parallel.h"
#include "sample_data/random.h"

namespace lfm {
namespace {

using V3f = Eigen::Vector3f;

constexpr float kPi = std::numbers::pi_v<float>;
constexpr float kOffsetMm = 0.02f;

double Fraction(double x) { return x - std::floor(x); }

struct Frame {
  V3f t, b, n;
  V3f World(const V3f& local) const { return local.x() * t + local.y() * b + local.z() * n; }
};

Frame MakeFrame(const V3f& n) {
  const V3f helper = std::abs(n.z()) < 0.9f ? V3f(0, 0, 1) : V3f(1, 0, 0);
  const V3f t = helper.cross(n).normalized();
  return {t, n.cross(t), n};
}

// What each surface sends out diffusely, once lamps and surroundings are baked.
struct Radiosity {
  const Subject* subject = nullptr;
  const std::vector<V3f>* object = nullptr;  // radiance a vertex
  const StudioScene* scene = nullptr;
  const SetReflectance* reflectance = nullptr;
  const std::vector<PatchIrradiance>* patches = nullptr;

  V3f Radiance(const SurfaceHit& hit, const V3f& point) const {
    if (hit.triangle >= 0) {
      const Eigen::Vector3i& t = subject->mesh.triangles[hit.triangle];
      return (1 - hit.u - hit.v) * (*object)[t[0]] + hit.u * (*object)[t[1]] +
             hit.v * (*object)[t[2]];
    }
    const Patch& patch = scene->patches()[hit.patch];
    const Eigen::Vector3d d = point.cast<double>() - patch.origin;
    const V3f albedo = patch.material == PatchMaterial::kTable ? V3f::Constant(kTableAlbedo)
                                                               : reflectance->Color(patch, point);
    return (albedo / kPi)
        .cwiseProduct((*patches)[hit.patch].Sample(patch, d.dot(patch.u), d.dot(patch.v)));
  }
};

struct Gathered {
  V3f irradiance = V3f::Zero();
  std::array<V3f, kHarmonics> harmonics;
};

enum class GatherHarmonics { kNo, kYes };

// Cosine-distributed rays (a lattice, turned at random for each point); without `radiosity`
// surfaces are black.
Gathered GatherSurroundings(const StudioScene& scene, const Lighting& lighting,
                            const Radiosity* radiosity, const V3f& point, const V3f& normal,
                            int rays, RandomStream random, GatherHarmonics with_harmonics) {
  Gathered sum;
  sum.harmonics.fill(V3f::Zero());
  const Frame frame = MakeFrame(normal);
  const V3f origin = point + kOffsetMm * normal;
  const double shift1 = random.Uniform(), shift2 = random.Uniform();
  for (int first = 0; first < rays; first += 16) {
    RayPacket packet;
    V3f directions[16];
    float cosines[16];
    const int count = std::min(16, rays - first);
    for (int lane = 0; lane < count; ++lane) {
      // A rank-1 lattice on the golden ratio.
      const int i = first + lane;
      const double u1 = Fraction((i + shift1) / rays);
      const double u2 = Fraction(i * 0.6180339887498949 + shift2);
      const float radius = static_cast<float>(std::sqrt(u1));
      const float angle = static_cast<float>(2 * std::numbers::pi * u2);
      cosines[lane] = std::max(0.02f, std::sqrt(std::max(0.0f, 1 - radius * radius)));
      directions[lane] =
          frame.World({radius * std::cos(angle), radius * std::sin(angle), cosines[lane]});
      packet.Set(lane, origin, directions[lane], 0, 1e6f);
    }
    scene.Intersect(packet, RayOrder::kScattered);
    for (int lane = 0; lane < count; ++lane) {
      const SurfaceHit hit = StudioScene::Hit(packet, lane);
      const V3f& d = directions[lane];
      V3f radiance = V3f::Zero();
      if (hit.triangle < 0 && hit.patch < 0) {
        radiance = lighting.Environment(d);
      } else if (radiosity != nullptr) {
        radiance = radiosity->Radiance(hit, origin + hit.distance * d);
      }
      sum.irradiance += kPi / static_cast<float>(rays) * radiance;
      if (with_harmonics == GatherHarmonics::kNo || radiance.isZero(0)) continue;
      const float weight = kPi / (cosines[lane] * static_cast<float>(rays));
      const V3f mirrored = d - 2 * d.dot(normal) * normal;
      const auto above = EvaluateHarmonics(d), below = EvaluateHarmonics(mirrored);
      for (int k = 0; k < kHarmonics; ++k) {
        sum.harmonics[k] += weight * (above[k] + below[k]) * radiance;
      }
    }
  }
  return sum;
}

// Grain of the random rays is evened out over each vertex's neighbours.
template <typename Value>
void SmoothOverRings(const TriangleMesh& mesh, const VertexRings& rings, std::vector<Value>& values,
                     size_t stride) {
  std::vector<Value> result(values.size());
  ParallelFor(
      0, static_cast<int64_t>(mesh.vertices.size()),
      [&](int64_t v) {
        Value* out = &result[v * stride];
        for (size_t k = 0; k < stride; ++k) out[k] = 2 * values[v * stride + k];
        float weight = 2;
        for (int i = rings.offsets[v]; i < rings.offsets[v + 1]; ++i) {
          for (int corner : mesh.triangles[rings.triangles[i]]) {
            if (corner == v || mesh.normals[corner].dot(mesh.normals[v]) < 0.7) continue;
            for (size_t k = 0; k < stride; ++k) out[k] += 0.5f * values[corner * stride + k];
            weight += 0.5f;
          }
        }
        for (size_t k = 0; k < stride; ++k) out[k] *= 1 / weight;
      },
      256);
  values = std::move(result);
}

class Baker {
 public:
  Baker(const StudioScene& scene, const Subject& subject, const Lighting& lighting,
        const SetReflectance& reflectance, const BakeOptions& options)
      : scene_(scene),
        subject_(subject),
        lighting_(lighting),
        reflectance_(reflectance),
        options_(options),
        vertices_(static_cast<int64_t>(subject.mesh.vertices.size())),
        rings_(ComputeVertexRings(subject.mesh)) {
    light_.cells = static_cast<int>(lighting.lights.size()) * kLightCells;
    light_.cell_visibility.resize(static_cast<size_t>(vertices_) * light_.cells);
    lamps_.resize(vertices_);
    for (const Patch& patch : scene.patches()) {
      const double spacing =
          options.plate_spacing_mm * (patch.material == PatchMaterial::kTable ? 8 : 1);
      PatchIrradiance grid;
      grid.columns = std::max(2, static_cast<int>(patch.width / spacing) + 1);
      grid.rows = std::max(2, static_cast<int>(patch.height / spacing) + 1);
      grid.irradiance.resize(static_cast<size_t>(grid.columns) * grid.rows);
      light_.patches.push_back(std::move(grid));
    }
  }

  std::vector<BakedLight> Run(std::span<const uint64_t> seeds, Progress& progress) {
    progress.Start("baking light", (1 + 2 * static_cast<int64_t>(seeds.size())) * vertices_);
    BakeLamps(progress);
    light_.rays.shadow = shadow_rays_;
    std::vector<BakedLight> baked;
    for (const uint64_t seed : seeds) {
      baked.push_back(light_);
      irradiance_ = lamps_;
      BakeSurroundings(seed, baked.back(), progress);
      light_.rays = {};  // the lamps' count once
    }
    return baked;
  }

 private:
  V3f Position(int64_t v) const { return subject_.mesh.vertices[v].cast<float>(); }
  V3f Normal(int64_t v) const { return subject_.mesh.normals[v].cast<float>(); }

  // Adds everything but the lamps to `light`, which holds them.
  void BakeSurroundings(uint64_t seed, BakedLight& light, Progress& progress) {
    // Surroundings first, since the bounce that follows reflects them too.
    const int first_rays = std::max(16, options_.gather_rays / 4);
    AddSurroundings(seed, nullptr, first_rays, light, progress);
    const std::vector<V3f> lamps_and_sky = irradiance_;
    const std::vector<PatchIrradiance> patches_once = light.patches;
    std::vector<V3f> bounced(vertices_);
    for (int64_t v = 0; v < vertices_; ++v) {
      // The coat's share of the bounce is spread as if it were diffuse.
      const V3f albedo = BaseAlbedo(subject_.paint[v]) + 0.8f * subject_.paint[v].coat;
      bounced[v] = albedo.cwiseProduct(lamps_and_sky[v]) / kPi;
    }
    irradiance_ = lamps_;
    light.patches = light_.patches;
    light.harmonics.resize(static_cast<size_t>(vertices_) * kHarmonics * 3);
    const Radiosity radiosity{&subject_, &bounced, &scene_, &reflectance_, &patches_once};
    AddSurroundings(seed, &radiosity, options_.gather_rays, light, progress);
    SmoothOverRings(subject_.mesh, rings_, light.harmonics, kHarmonics * 3);
    light.diffuse_radiance.resize(vertices_);
    for (int64_t v = 0; v < vertices_; ++v) {
      light.diffuse_radiance[v] = BaseAlbedo(subject_.paint[v]).cwiseProduct(irradiance_[v]) / kPi;
    }
  }

  void BakeLamps(Progress& progress) {
    ParallelFor(
        0, vertices_,
        [&](int64_t v) {
          const LampLight lamps =
              GatherLamps(scene_, lighting_, Position(v), Normal(v), options_.rays_per_cell);
          lamps_[v] = lamps.irradiance;
          shadow_rays_ += lamps.rays;
          for (int c = 0; c < light_.cells; ++c) {
            light_.cell_visibility[v * light_.cells + c] =
                static_cast<uint8_t>(std::lround(255 * lamps.visibility[c]));
          }
          if (v % 4096 == 0) progress.Advance(std::min<int64_t>(4096, vertices_ - v));
        },
        256);
    ForEachNode([&](size_t p, size_t node, const V3f& point, const V3f& normal) {
      const LampLight lamps = GatherLamps(scene_, lighting_, point, normal, options_.rays_per_cell);
      light_.patches[p].irradiance[node] = lamps.irradiance;
      shadow_rays_ += lamps.rays;
    });
  }

  void AddSurroundings(uint64_t seed, const Radiosity* radiosity, int rays, BakedLight& light,
                       Progress& progress) {
    std::vector<V3f> added(vertices_);
    ParallelFor(
        0, vertices_,
        [&](int64_t v) {
          const RandomStream random(seed, radiosity == nullptr ? 101 : 102,
                                    static_cast<uint64_t>(v));
          const Gathered gathered = GatherSurroundings(
              scene_, lighting_, radiosity, Position(v), Normal(v), rays, random,
              radiosity == nullptr ? GatherHarmonics::kNo : GatherHarmonics::kYes);
          added[v] = gathered.irradiance;
          if (radiosity != nullptr) {
            for (int k = 0; k < kHarmonics; ++k) {
              for (int c = 0; c < 3; ++c) {
                light.harmonics[(v * kHarmonics + k) * 3 + c] = gathered.harmonics[k][c];
              }
            }
          }
          if (v % 4096 == 0) progress.Advance(std::min<int64_t>(4096, vertices_ - v));
        },
        64);
    SmoothOverRings(subject_.mesh, rings_, added, 1);
    for (int64_t v = 0; v < vertices_; ++v) irradiance_[v] += added[v];
    light.rays.bounce += vertices_ * rays;
    ForEachNode([&](size_t p, size_t node, const V3f& point, const V3f& normal) {
      const RandomStream random(seed, 200 + p, node);
      light.patches[p].irradiance[node] +=
          GatherSurroundings(scene_, lighting_, radiosity, point, normal, rays / 2, random,
                             GatherHarmonics::kNo)
              .irradiance;
    });
    for (const PatchIrradiance& grid : light.patches) {
      light.rays.bounce += static_cast<int64_t>(grid.irradiance.size()) * (rays / 2);
    }
  }

  template <typename Body>
  void ForEachNode(const Body& body) {
    for (size_t p = 0; p < light_.patches.size(); ++p) {
      const PatchIrradiance& grid = light_.patches[p];
      ForEachPatchNode(
          scene_.patches()[p], grid.columns, grid.rows,
          [&](size_t node, const V3f& point, const V3f& normal) { body(p, node, point, normal); });
    }
  }

  const StudioScene& scene_;
  const Subject& subject_;
  const Lighting& lighting_;
  const SetReflectance& reflectance_;
  const BakeOptions& options_;
  int64_t vertices_;
  VertexRings rings_;
  BakedLight light_;  // of the lamps alone
  std::atomic<int64_t> shadow_rays_ = 0;
  std::vector<V3f> irradiance_, lamps_;
};

}  // namespace

V3f PatchIrradiance::Sample(const Patch& patch, double a, double b) const {
  const double x = std::clamp(a / patch.width, 0.0, 1.0) * (columns - 1);
  const double y = std::clamp(b / patch.height, 0.0, 1.0) * (rows - 1);
  const int x0 = std::min(static_cast<int>(x), columns - 2);
  const int y0 = std::min(static_cast<int>(y), rows - 2);
  const float fx = static_cast<float>(x - x0), fy = static_cast<float>(y - y0);
  const V3f* row = &irradiance[static_cast<size_t>(y0) * columns + x0];
  return (1 - fy) * ((1 - fx) * row[0] + fx * row[1]) +
         fy * ((1 - fx) * row[columns] + fx * row[columns + 1]);
}

void ForEachPatchNode(const Patch& patch, int columns, int rows,
                      const std::function<void(size_t, const V3f&, const V3f&)>& body) {
  const V3f normal = patch.Normal().cast<float>();
  ParallelFor(0, rows, [&](int64_t row) {
    for (int column = 0; column < columns; ++column) {
      const Eigen::Vector3d point = patch.origin + patch.width * column / (columns - 1) * patch.u +
                                    patch.height * row / (rows - 1) * patch.v;
      body(static_cast<size_t>(row) * columns + column, point.cast<float>(), normal);
    }
  });
}

V3f BaseAlbedo(const Paint& paint) { return paint.diffuse.cwiseProduct(V3f::Ones() - paint.coat); }

BakedLight BakeLight(const StudioScene& scene, const Subject& subject, const Lighting& lighting,
                     const SetReflectance& reflectance, const BakeOptions& options,
                     Progress& progress) {
  const uint64_t seeds[] = {options.seed};
  return std::move(
      BakeLights(scene, subject, lighting, reflectance, options, seeds, progress).front());
}

std::vector<BakedLight> BakeLights(const StudioScene& scene, const Subject& subject,
                                   const Lighting& lighting, const SetReflectance& reflectance,
                                   const BakeOptions& options, std::span<const uint64_t> seeds,
                                   Progress& progress) {
  return Baker(scene, subject, lighting, reflectance, options).Run(seeds, progress);
}

}  // namespace lfm
