// SPDX-License-Identifier: BSD-3-Clause
#include "calib/calib_files.h"

#include <Eigen/Eigenvalues>
#include <cmath>
#include <set>

#include "calib/board.h"
#include "calib/bundle_adjustment.h"
#include "calib/model_files.h"
#include "core/atomic_file.h"
#include "core/camera_json.h"
#include "core/error.h"
#include "core/hash.h"
#include "core/json_reader.h"

namespace lfm {
namespace {

constexpr int kMaxCount = 1000000000;
constexpr int kMaxSide = 65536;

nlohmann::json SeenToJson(const std::vector<SeenCorner>& seen) {
  nlohmann::json rows = nlohmann::json::array();
  for (const SeenCorner& c : seen) {
    const Eigen::Vector3d& p = c.point_in_world;
    rows.push_back({p.x(), p.y(), p.z(), c.pixel.x(), c.pixel.y()});
  }
  return rows;
}

nlohmann::json PosedImagesToJson(const std::vector<PosedImage>& images) {
  nlohmann::json list = nlohmann::json::array();
  for (const PosedImage& image : images) {
    std::vector<double> covariance;
    for (int row = 0; row < 6; ++row) {
      for (int column = 0; column < 6; ++column)
        covariance.push_back(image.covariance(row, column));
    }
    list.push_back({{"id", image.id},
                    {"file", image.file},
                    {"camera", image.camera},
                    {"split", image.split == PhotoSplit::kTest ? "test" : "train"},
                    {"camera_from_world", PoseToJson(image.camera_from_world)},
                    {"covariance", covariance},
                    {"tags", image.tags},
                    {"corners", image.corners},
                    {"reprojection_rms_px", image.reprojection_rms_px}});
    if (!image.fingerprint.empty()) list.back()["fingerprint"] = image.fingerprint;
    if (!image.seen.empty()) list.back()["seen"] = SeenToJson(image.seen);
  }
  return list;
}

// Symmetric and positive semidefinite but for what rounding does.
bool IsCovariance(const Eigen::Matrix<double, 6, 6>& matrix) {
  constexpr double kRounding = 1e-9;
  Eigen::Matrix<double, 6, 1> sigma = matrix.diagonal();
  if (!(sigma.minCoeff() >= 0)) return false;
  for (double& s : sigma) s = s > 0 ? std::sqrt(s) : 1;
  const Eigen::Matrix<double, 6, 6> scaled = matrix.array() / (sigma * sigma.transpose()).array();
  if (!((scaled - scaled.transpose()).cwiseAbs().maxCoeff() <= kRounding)) return false;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 6, 6>> eigen(scaled);
  return eigen.eigenvalues()(0) >= -kRounding;
}

PosedImage PosedImageFromJson(JsonReader& reader, const std::map<std::string, Camera>& cameras) {
  PosedImage image;
  image.id = reader.Text("id");
  const std::string problem = PictureIdProblem(image.id);
  if (!problem.empty()) reader.Fail("id", "\"" + image.id + "\" " + problem);
  image.file = reader.Text("file");
  image.camera = reader.Text("camera");
  if (!cameras.contains(image.camera)) {
    reader.Fail("camera", "\"" + image.camera + "\" is not in cameras.json");
  }
  const std::string split = reader.Text("split");
  if (split != "train" && split != "test") reader.Fail("split", "expected \"train\" or \"test\"");
  image.split = split == "test" ? PhotoSplit::kTest : PhotoSplit::kTrain;
  JsonReader pose = reader.Object("camera_from_world");
  image.camera_from_world = PoseFromJson(pose);
  const std::vector<double> covariance = reader.Numbers("covariance", 36);
  for (int i = 0; i < 36; ++i) image.covariance(i / 6, i % 6) = covariance[i];
  if (!IsCovariance(image.covariance)) {
    reader.Fail("covariance", "is not one: it must be symmetric, with no negative variance");
  }
  image.tags = reader.Integer("tags", 0, kMaxCount);
  image.corners = reader.Integer("corners", 0, kMaxCount);
  image.reprojection_rms_px = reader.Number("reprojection_rms_px");
  if (image.reprojection_rms_px < 0) reader.Fail("reprojection_rms_px", "must not be negative");
  if (reader.Has("fingerprint")) image.fingerprint = reader.Text("fingerprint");
  if (reader.Has("seen")) {
    for (const std::vector<double>& row : reader.NumberRows("seen", 5)) {
      image.seen.push_back({{row[0], row[1], row[2]}, {row[3], row[4]}});
    }
  }
  reader.Finish();
  return image;
}

std::vector<PosedImage> PosedImagesFromJson(JsonReader& poses, const std::string& key,
                                            const std::map<std::string, Camera>& cameras) {
  std::vector<PosedImage> images;
  std::set<std::string> ids;
  for (JsonReader& item : poses.Objects(key)) {
    images.push_back(PosedImageFromJson(item, cameras));
    if (!ids.insert(images.back().id).second) {
      item.Fail("id", "\"" + images.back().id + "\" is used twice");
    }
  }
  return images;
}

CalibResult LoadCameras(const std::filesystem::path& file) {
  CalibResult result;
  const nlohmann::json json = ReadJson(file);
  JsonReader reader(json, file.string());
  JsonReader cameras = reader.Object("cameras");
  for (const std::string& name : cameras.Keys()) {
    JsonReader camera = cameras.Object(name);
    result.cameras[name] = CameraFromJson(camera, kMaxSide, LensKeys::kRequired);
  }
  cameras.Finish();
  result.reprojection_rms_px = reader.Number("reprojection_rms_px");
  result.corner_noise_px = reader.Number("corner_noise_px");
  JsonReader lens_terms = reader.Object("lens_terms");
  for (const std::string& name : lens_terms.Keys()) {
    if (!result.cameras.contains(name)) lens_terms.Fail(name, "is not among the cameras");
    result.lens_terms[name] = lens_terms.Integer(name, 0, kAllLensTerms);
    if (!IsLensModel(result.lens_terms[name])) {
      lens_terms.Fail(name, "expected 0, 1, 2, 4, 5 or 8");
    }
  }
  LensModelsFromJson(reader, result);
  if (result.reprojection_rms_px < 0) reader.Fail("reprojection_rms_px", "must not be negative");
  if (result.corner_noise_px < 0) reader.Fail("corner_noise_px", "must not be negative");
  reader.Finish();
  return result;
}

PosedImage GivenImage(const std::string& id, const std::string& camera, const std::string& file,
                      const Pose& camera_from_world) {
  PosedImage image;
  image.id = id;
  image.camera = camera;
  image.file = file;
  image.camera_from_world = camera_from_world;
  return image;
}

std::vector<PosedImage> GivenScans(const std::vector<ScanSet>& sets, const std::string& camera) {
  std::vector<PosedImage> images;
  for (const ScanSet& set : sets) {
    if (!set.camera_from_world) continue;
    images.push_back(GivenImage(set.id, camera, set.frames.empty() ? "" : set.frames.front(),
                                *set.camera_from_world));
  }
  return images;
}

// Refuses a calibration of other pictures that bear the same names.
void RequireSamePictures(const Capture& capture, const std::vector<PosedImage>& images,
                         const std::filesystem::path& calib_folder) {
  for (const PosedImage& image : images) {
    if (image.fingerprint.empty()) continue;
    const std::filesystem::path file = capture.folder / image.file;
    const std::string now = FileFingerprint(file);
    if (now.empty() || now == image.fingerprint) continue;
    throw Error((calib_folder / "poses.json").string() +
                ": is the calibration of another capture, "
                "or older than " +
                file.string() + "; run lfm-calib again, or name its own workspace");
  }
}

}  // namespace

void SaveCalib(const CalibResult& result, const std::filesystem::path& folder) {
  nlohmann::json cameras = {{"cameras", nlohmann::json::object()},
                            {"reprojection_rms_px", result.reprojection_rms_px},
                            {"corner_noise_px", result.corner_noise_px},
                            {"lens_terms", result.lens_terms}};
  LensModelsToJson(result, cameras);
  for (const auto& [name, camera] : result.cameras) {
    cameras["cameras"][name] = CameraToJson(camera);
  }
  nlohmann::json poses = {{"photos", PosedImagesToJson(result.photos)},
                          {"scans", PosedImagesToJson(result.scans)},
                          {"placements", PosedImagesToJson(result.placements)},
                          {"rejected", nlohmann::json::array()}};
  for (const RejectedImage& image : result.rejected) {
    poses["rejected"].push_back({{"id", image.id}, {"file", image.file}, {"reason", image.reason}});
  }
  WriteFilesTogether(folder, [&](const std::filesystem::path& together) {
    WriteJson(cameras, together / "cameras.json");
    WriteJson(PlatformToJson(result), together / "platform.json");
    WriteJson(poses, together / "poses.json");
  });
}

CalibResult LoadCalib(const std::filesystem::path& folder) {
  CalibResult result = LoadCameras(folder / "cameras.json");
  LoadPlatform(folder / "platform.json", result);
  const std::filesystem::path file = folder / "poses.json";
  const nlohmann::json json = ReadJson(file);
  JsonReader reader(json, file.string());
  result.photos = PosedImagesFromJson(reader, "photos", result.cameras);
  result.scans = PosedImagesFromJson(reader, "scans", result.cameras);
  result.placements = PosedImagesFromJson(reader, "placements", result.cameras);
  for (JsonReader& item : reader.Objects("rejected")) {
    result.rejected.push_back({item.Text("id"), item.Text("file"), item.Text("reason")});
    item.Finish();
  }
  reader.Finish();
  return result;
}

CalibResult CalibrateCapture(const Capture& capture, const CalibOptions& options,
                             Progress& progress) {
  if (capture.BringsGeometry()) return CalibFromCapture(capture);
  if (capture.board.empty()) {
    throw Error((capture.folder / "capture.json").string() +
                ": board: missing; name the board's file, or give every camera, pose and a mesh");
  }
  const Board board = ReadBoard(capture.folder / capture.board);
  CalibResult result = Calibrate(capture, board, MakeImageLoader(capture), options, progress);
  for (std::vector<PosedImage>* images : {&result.photos, &result.scans, &result.placements}) {
    for (PosedImage& image : *images) {
      image.fingerprint = FileFingerprint(capture.folder / image.file);
    }
  }
  return result;
}

CalibResult CalibOfCapture(const Capture& capture, const std::filesystem::path& folder) {
  return capture.BringsGeometry() ? CalibFromCapture(capture) : LoadCalibOf(capture, folder);
}

CalibResult LoadCalibOf(const Capture& capture, const std::filesystem::path& folder) {
  CalibResult calib = LoadCalib(folder);
  RequireSamePictures(capture, calib.photos, folder);
  RequireSamePictures(capture, calib.scans, folder);
  RequireSamePictures(capture, calib.placements, folder);
  return calib;
}

CalibResult CalibFromCapture(const Capture& capture) {
  const std::string where = (capture.folder / "capture.json").string();
  CalibResult result;
  for (const auto& [name, camera] : capture.cameras) {
    if (!camera.intrinsics) throw Error(where + ": cameras." + name + ": intrinsics are not given");
    result.cameras[name] = *camera.intrinsics;
  }
  for (const Photo& photo : capture.photos) {
    if (!photo.camera_from_world) {
      throw Error(where + ": photo \"" + photo.id + "\": camera_from_world is not given");
    }
    result.photos.push_back(
        GivenImage(photo.id, photo.camera, photo.file, *photo.camera_from_world));
    result.photos.back().split = photo.split;
  }
  if (capture.scanner) {
    result.scans = GivenScans(capture.scanner->scans, capture.scanner->camera);
    result.placements = GivenScans(capture.scanner->placements, capture.scanner->camera);
  }
  return result;
}

}  // namespace lfm
