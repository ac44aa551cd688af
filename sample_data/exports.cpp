// SPDX-License-Identifier: BSD-3-Clause
#include "sample_data/exports.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <map>
#include <nlohmann/json.hpp>

#include "core/atomic_file.h"
#include "core/error.h"
#include "core/image.h"
#include "core/json_reader.h"

namespace lfm {
namespace {

constexpr double kCornerFromCenter = 0.5;  // pixels
constexpr double kUnitLength_abs = 1e-6;
// instant-ngp trains inside a unit cube.
constexpr double kCubeMm = 300, kCubeCenterMm = 60;

std::string Exact(double value) {
  char text[40];
  std::snprintf(text, sizeof(text), "%.17g", value);
  return text;
}

void RequireOneWord(const std::string& name, const char* format) {
  const bool bad = name.empty() || std::any_of(name.begin(), name.end(), [](unsigned char c) {
                     return std::isspace(c) != 0;
                   });
  if (bad) {
    throw Error("the file name \"" + name + "\" is empty or holds white space, which " + format +
                " cannot hold; rename the picture");
  }
}

/// A photograph with everything that is known of it.
struct PosedPhoto {
  const Photo* photo = nullptr;  // of the capture
  const Photo* truth = nullptr;
  const Camera* camera = nullptr;
};

std::vector<PosedPhoto> JoinPhotos(const Capture& capture, const Capture& truth) {
  std::map<std::string, const Photo*> by_id;
  for (const Photo& photo : truth.photos) by_id[photo.id] = &photo;
  std::vector<PosedPhoto> joined;
  for (const Photo& photo : capture.photos) {
    const auto found = by_id.find(photo.id);
    const auto camera =
        found == by_id.end() ? truth.cameras.end() : truth.cameras.find(found->second->camera);
    if (camera == truth.cameras.end() || !camera->second.intrinsics ||
        !found->second->camera_from_world) {
      throw Error("photograph \"" + photo.id +
                  "\" has no intrinsics or pose in the ground truth; it cannot be exported");
    }
    joined.push_back({&photo, found->second, &*camera->second.intrinsics});
  }
  return joined;
}

std::string RelativeTo(const std::filesystem::path& folder, const std::filesystem::path& file) {
  return std::filesystem::absolute(file)
      .lexically_normal()
      .lexically_relative(std::filesystem::absolute(folder).lexically_normal())
      .generic_string();
}

std::string ColmapCamera(int id, const Camera& c) {
  const bool full = c.k3 != 0 || c.IsRational();
  std::string line = std::to_string(id) + (full ? " FULL_OPENCV " : " OPENCV ") +
                     std::to_string(c.width) + " " + std::to_string(c.height);
  std::vector<double> terms = {
      c.fx, c.fy, c.cx + kCornerFromCenter, c.cy + kCornerFromCenter, c.k1, c.k2, c.p1, c.p2};
  if (full) terms.insert(terms.end(), {c.k3, c.k4, c.k5, c.k6});
  for (double term : terms) line += " " + Exact(term);
  return line + "\n";
}

nlohmann::json OpenGlMatrix(const Pose& camera_from_world) {
  const Pose world_from_camera = camera_from_world.Inverse();
  Eigen::Matrix4d m = Eigen::Matrix4d::Identity();
  m.topLeftCorner<3, 3>() =
      world_from_camera.rotation * Eigen::Vector3d(1, -1, -1).asDiagonal().toDenseMatrix();
  m.topRightCorner<3, 1>() = world_from_camera.translation;
  nlohmann::json rows = nlohmann::json::array();
  for (int r = 0; r < 4; ++r) rows.push_back({m(r, 0), m(r, 1), m(r, 2), m(r, 3)});
  return rows;
}

Image Inverted(Image mask) {
  uint8_t* values = mask.Data<uint8_t>();
  for (size_t i = 0; i < mask.size(); ++i) values[i] = static_cast<uint8_t>(255 - values[i]);
  return mask;
}

}  // namespace

void WriteColmapModel(const Capture& capture, const Capture& truth,
                      const std::filesystem::path& folder) {
  const std::vector<PosedPhoto> photos = JoinPhotos(capture, truth);
  std::map<std::string, int> camera_ids;
  std::string cameras = "# CAMERA_ID MODEL WIDTH HEIGHT PARAMS[]\n";
  std::string images =
      "# IMAGE_ID QW QX QY QZ TX TY TZ CAMERA_ID NAME\n# POINTS2D[] as X Y POINT3D_ID\n";
  std::string names[2];
  int image_id = 0;
  for (const PosedPhoto& p : photos) {
    RequireOneWord(p.photo->file, "a COLMAP text model");
    const auto [camera, added] =
        camera_ids.emplace(p.truth->camera, static_cast<int>(camera_ids.size()) + 1);
    if (added) cameras += ColmapCamera(camera->second, *p.camera);
    const Pose& pose = *p.truth->camera_from_world;
    const Eigen::Quaterniond q = pose.Quaternion();
    images += std::to_string(++image_id);
    for (double value : {q.w(), q.x(), q.y(), q.z(), pose.translation.x(), pose.translation.y(),
                         pose.translation.z()}) {
      images += " " + Exact(value);
    }
    // The empty line is the list of this image's points.
    images += " " + std::to_string(camera->second) + " " + p.photo->file + "\n\n";
    names[p.photo->split == PhotoSplit::kTest] += p.photo->file + "\n";
  }
  WriteFileAtomically(folder / "cameras.txt", cameras);
  WriteFileAtomically(folder / "images.txt", images);
  WriteFileAtomically(folder / "points3D.txt",
                      "# POINT3D_ID X Y Z R G B ERROR TRACK[] as IMAGE_ID POINT2D_IDX\n");
  WriteFileAtomically(folder / "train.txt", names[0]);
  WriteFileAtomically(folder / "test.txt", names[1]);
}

void WriteNerfTransforms(const Capture& capture, const Capture& truth,
                         const std::filesystem::path& file) {
  const std::filesystem::path folder = file.parent_path();
  nlohmann::json json = {{"camera_model", "OPENCV"},
                         {"aabb_scale", 1},
                         // Nothing was applied to the world frame: mm survive a way through tools.
                         {"applied_transform", {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}},
                         {"applied_scale", 1},
                         {"scale", 1 / kCubeMm},
                         {"offset", {0.5, 0.5, 0.5 - kCubeCenterMm / kCubeMm}},
                         {"frames", nlohmann::json::array()},
                         {"train_filenames", nlohmann::json::array()},
                         {"test_filenames", nlohmann::json::array()}};
  for (const PosedPhoto& p : JoinPhotos(capture, truth)) {
    const Camera& c = *p.camera;
    if (c.IsRational()) {
      throw Error(file.string() + ": transforms.json has no k4, k5, k6 of the rational lens model");
    }
    const std::string path = RelativeTo(folder, capture.folder / p.photo->file);
    nlohmann::json frame = {{"file_path", path},
                            {"w", c.width},
                            {"h", c.height},
                            {"fl_x", c.fx},
                            {"fl_y", c.fy},
                            {"cx", c.cx + kCornerFromCenter},
                            {"k1", c.k1},
                            {"cy", c.cy + kCornerFromCenter},
                            {"k2", c.k2},
                            {"k3", c.k3},
                            {"p1", c.p1},
                            {"p2", c.p2},
                            {"transform_matrix", OpenGlMatrix(*p.truth->camera_from_world)}};
    if (!p.truth->mask.empty()) {
      frame["mask_path"] = RelativeTo(folder, truth.folder / p.truth->mask);
    }
    json["frames"].push_back(std::move(frame));
    json[p.photo->split == PhotoSplit::kTest ? "test_filenames" : "train_filenames"].push_back(
        path);
  }
  WriteJson(json, file);
}

void WriteToolMasks(const Capture& capture, const Capture& truth,
                    const std::filesystem::path& folder) {
  for (const PosedPhoto& p : JoinPhotos(capture, truth)) {
    if (p.truth->mask.empty()) continue;
    const Image mask = ReadImage(truth.folder / p.truth->mask);
    WriteImage(mask, folder / "colmap" / (p.photo->file + ".png"));
    const std::string stem = std::filesystem::path(p.photo->file).stem().string();
    WriteImage(Inverted(mask), folder / "instant-ngp" / ("dynamic_mask_" + stem + ".png"));
  }
}

void WriteLightPositions(const std::vector<LightPosition>& lights,
                         const std::filesystem::path& file) {
  if (lights.empty()) throw Error(file.string() + ": there is no light position to write");
  std::string content = std::to_string(lights.size()) + "\n";
  for (const LightPosition& light : lights) {
    RequireOneWord(light.file, "a light position file");
    const Eigen::Vector3d& d = light.to_light;
    if (!(std::abs(d.norm() - 1) <= kUnitLength_abs)) {
      throw Error(file.string() + ": the light direction of " + light.file +
                  " is not a unit vector");
    }
    content += light.file + " " + Exact(d.x()) + " " + Exact(d.y()) + " " + Exact(d.z()) + "\n";
  }
  WriteFileAtomically(file, content);
}

std::vector<LightPosition> FieldLightPositions(const Capture& capture,
                                               const std::filesystem::path& folder) {
  if (!capture.reflectance_field) {
    throw Error("capture \"" + capture.name + "\" has no reflectance field; it has no lights");
  }
  const ReflectanceField& field = *capture.reflectance_field;
  Eigen::Matrix3d rti_from_world = Eigen::Matrix3d::Identity();
  if (field.camera_from_world) {
    rti_from_world = Eigen::Vector3d(1, -1, -1).asDiagonal() * field.camera_from_world->rotation;
  }
  std::vector<LightPosition> lights;
  for (const LitPicture& picture : field.pictures) {
    if (picture.split == PhotoSplit::kTest) continue;
    lights.push_back({RelativeTo(folder, capture.folder / picture.file),
                      (rti_from_world * picture.to_light).normalized()});
  }
  return lights;
}

void WriteExports(const Capture& capture, const Capture& truth) {
  const std::filesystem::path folder = truth.folder / "exports";
  if (!capture.photos.empty()) {
    WriteColmapModel(capture, truth, folder / "colmap");
    WriteNerfTransforms(capture, truth, folder / "nerf" / "transforms.json");
    WriteToolMasks(capture, truth, folder / "masks");
  }
  if (capture.reflectance_field) {
    WriteLightPositions(FieldLightPositions(capture, folder / "rti"), folder / "rti" / "lights.lp");
  }
}

}  // namespace lfm
