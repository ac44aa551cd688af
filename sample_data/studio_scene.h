// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <embree3/rtcore.h>

#include <Eigen/Core>
#include <array>
#include <optional>
#include <vector>

#include "calib/board.h"
#include "core/pose.h"
#include "core/triangle_mesh.h"

namespace lfm {

/// What a flat piece of the set is made of; all of it is diffuse.
enum class PatchMaterial { kPrint, kEdge, kTable };

/// A rectangle of the set: points origin + a u + b v, 0 <= a <= width, 0 <= b <= height (mm).
struct Patch {
  Eigen::Vector3d origin = {0, 0, 0};
  Eigen::Vector3d u = {1, 0, 0}, v = {0, 1, 0};  ///< unit; u x v is the normal
  double width = 0, height = 0;
  PatchMaterial material = PatchMaterial::kTable;
  int plate = 0;  ///< of PlatesOf(board): whose print or edge this is

  Eigen::Vector3d Normal() const { return u.cross(v); }
};

/// The plate (its print on top, z = 0), attached boards (print and edges, 1 mm thick), and, last,
/// the dark table. `world_from_table` moves the table: the platform may be lifted off it and
/// tilted.
std::vector<Patch> MakePlateAndTable(const Board& board, const Pose& world_from_table);

inline constexpr double kPlateThicknessMm = 5, kAttachedThicknessMm = 1;
inline constexpr double kTableSizeMm = 1600;
/// Albedo of the plate's paper, and the mean of the table's.
inline constexpr float kPaperAlbedo = 0.60f, kTableAlbedo = 0.07f;

/// Sixteen rays traced together. Rays without a use are switched off by `valid` 0.
struct alignas(64) RayPacket {
  RTCRayHit16 rays;
  alignas(64) int valid[16];

  RayPacket();
  void Set(int lane, const Eigen::Vector3f& origin, const Eigen::Vector3f& direction, float t_near,
           float t_far);
};

/// Whether a packet's rays run side by side.
enum class RayOrder { kCoherent, kScattered };

/// What a ray met: a triangle of the object, a patch, or nothing.
struct SurfaceHit {
  int triangle = -1;  ///< of the object
  int patch = -1;
  float u = 0, v = 0;  ///< barycentric weights of corners 1 and 2, for a triangle
  float distance = 0;  ///< in lengths of the direction
};

/// The object (none, when `object` is null) and the set, ready for rays. World frame, mm; float32
/// inside: near the origin hits are good to about 1e-5 mm. Immutable, usable from many threads.
class StudioScene {
 public:
  StudioScene(const TriangleMesh* object, std::vector<Patch> patches);
  ~StudioScene();
  StudioScene(const StudioScene&) = delete;
  StudioScene& operator=(const StudioScene&) = delete;

  const std::vector<Patch>& patches() const { return patches_; }
  /// First hits of the packet's valid rays; SurfaceHit of one lane by `Hit`. `order` only says what
  /// is faster.
  void Intersect(RayPacket& packet, RayOrder order) const;
  static SurfaceHit Hit(const RayPacket& packet, int lane);
  /// Afterwards `Blocked` says for each valid lane whether anything lies on the way.
  void Occlude(RayPacket& packet) const;
  static bool Blocked(const RayPacket& packet, int lane);

 private:
  std::vector<Patch> patches_;
  RTCDevice device_ = nullptr;
  RTCScene scene_ = nullptr;
};

/// Rec. 709 luminance of linear RGB: what a gray camera sees.
float Luminance(const Eigen::Vector3f& color);

/// Diffuse reflectance of the set.
class SetReflectance {
 public:
  explicit SetReflectance(const Board& board) : print_(board) {}
  /// Linear RGB albedo at `point` (world) on `patch`.
  Eigen::Vector3f Color(const Patch& patch, const Eigen::Vector3f& point) const;
  /// The mean of Color over a convex piece of a print with these corners (world), exact. No answer
  /// where more than two lines of the print cross it, on circles, on the plate's rim, and for other
  /// materials.
  std::optional<Eigen::Vector3f> PrintColor(const Patch& patch,
                                            const std::array<Eigen::Vector3f, 4>& piece) const;
  /// Its luminance.
  float Albedo(const Patch& patch, const Eigen::Vector3f& point) const;

 private:
  /// A print, and a point in its plate's frame.
  struct OnPrint {
    const BoardPrint* print;
    Eigen::Vector2d point;
  };
  OnPrint Locate(const Patch& patch, const Eigen::Vector3f& point) const;

  BoardPrint print_;
};

}  // namespace lfm
