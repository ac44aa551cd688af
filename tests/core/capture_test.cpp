// SPDX-License-Identifier: BSD-3-Clause
#include "core/capture.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "test_files.h"

namespace lfm {
namespace {

Capture FullCapture(const std::filesystem::path& folder) {
  Capture capture;
  capture.folder = folder;
  capture.name = "bust";
  capture.board = "board.json";
  capture.mesh = "truth/mesh.ply";
  Camera intrinsics;
  intrinsics.width = 960;
  intrinsics.height = 720;
  intrinsics.fx = 1000.0 / 3;
  intrinsics.fy = 333;
  intrinsics.cx = 479.5;
  intrinsics.cy = 359.5;
  intrinsics.k1 = -0.1;
  intrinsics.p2 = 1e-4;
  capture.cameras["hand"] = {960, 720, intrinsics, std::nullopt};
  capture.cameras["rig"] = {640, 480, std::nullopt, ColorEncoding::kLinear};
  const Pose pose = LookAt({100, 200, 300}, {0, 0, 50}, {0, 0, 1});
  capture.photos.push_back({"p0", "photos/0.png", "hand", PhotoSplit::kTrain, pose, "m/0.png"});
  capture.photos.push_back({"p1", "photos/1.png", "hand", PhotoSplit::kTest, std::nullopt, ""});
  Scanner scanner;
  scanner.camera = "rig";
  scanner.projector_width = 1024;
  scanner.projector_height = 768;
  scanner.projector = intrinsics;
  scanner.projector->width = 1024;
  scanner.projector->height = 768;
  scanner.projector_from_camera = pose;
  scanner.scan_roles = {"white", "black"};
  scanner.placement_roles = {"white"};
  scanner.scans = {{"s0", {"s/0.png", "s/1.png"}, pose}, {"s1", {"s/2.png", "s/3.png"}, {}}};
  scanner.placements = {{"t0", {"t/0.png"}, std::nullopt}};
  capture.scanner = scanner;
  ReflectanceField field;
  field.camera = "hand";
  field.camera_from_world = pose;
  field.encoding = ColorEncoding::kSrgb;
  field.pictures = {{"lit/0.png", {0, 0, 1}, PhotoSplit::kTrain},
                    {"lit/1.png", Eigen::Vector3d(3, -1, 2).normalized(), PhotoSplit::kTest,
                     Eigen::Vector3d(0.1, 2.5, 1.0 / 3)}};
  field.mask = "lit/mask.png";
  capture.reflectance_field = field;
  capture.transport = TransportField{"t.ltm", TransportKind::kMesh, 32,
                                     "",      "truth/mesh.ply",     {{1, 2, 3}, {-4, 5, 0.5}}};
  return capture;
}

nlohmann::json FullManifest() {
  const TestFolder folder;
  SaveCapture(FullCapture(folder.path()));
  return nlohmann::json::parse(Get(folder / "capture.json"));
}

void ExpectSamePose(const std::optional<Pose>& a, const std::optional<Pose>& b) {
  ASSERT_EQ(a.has_value(), b.has_value());
  if (!a) return;
  EXPECT_LT((a->rotation - b->rotation).norm(), 1e-14);
  EXPECT_EQ(a->translation, b->translation);
}

void ExpectSameIntrinsics(const std::optional<Camera>& a, const std::optional<Camera>& b) {
  ASSERT_EQ(a.has_value(), b.has_value());
  if (!a) return;
  EXPECT_EQ(a->width, b->width);
  EXPECT_EQ(a->height, b->height);
  for (double Camera::*p : {&Camera::fx, &Camera::fy, &Camera::cx, &Camera::cy, &Camera::k1,
                            &Camera::k2, &Camera::k3, &Camera::p1, &Camera::p2}) {
    EXPECT_EQ((*a).*p, (*b).*p);
  }
}

TEST(Capture, SavingAndLoadingAreInverse) {
  const TestFolder folder;
  const Capture saved = FullCapture(folder.path());
  SaveCapture(saved);
  EXPECT_EQ(folder.FileCount(), 1);
  const Capture loaded = LoadCapture(folder.path());
  EXPECT_EQ(loaded.folder, saved.folder);
  EXPECT_EQ(loaded.name, saved.name);
  EXPECT_EQ(loaded.board, saved.board);
  EXPECT_EQ(loaded.mesh, saved.mesh);
  ASSERT_EQ(loaded.cameras.size(), 2u);
  ExpectSameIntrinsics(loaded.cameras.at("hand").intrinsics, saved.cameras.at("hand").intrinsics);
  EXPECT_EQ(loaded.cameras.at("rig").width, 640);
  EXPECT_FALSE(loaded.cameras.at("rig").intrinsics.has_value());
  EXPECT_EQ(loaded.cameras.at("rig").encoding, ColorEncoding::kLinear);
  ASSERT_EQ(loaded.photos.size(), 2u);
  for (int i = 0; i < 2; ++i) {
    EXPECT_EQ(loaded.photos[i].id, saved.photos[i].id);
    EXPECT_EQ(loaded.photos[i].file, saved.photos[i].file);
    EXPECT_EQ(loaded.photos[i].camera, saved.photos[i].camera);
    EXPECT_EQ(loaded.photos[i].split, saved.photos[i].split);
    EXPECT_EQ(loaded.photos[i].mask, saved.photos[i].mask);
    ExpectSamePose(loaded.photos[i].camera_from_world, saved.photos[i].camera_from_world);
  }
  ASSERT_TRUE(loaded.scanner.has_value());
  EXPECT_EQ(loaded.scanner->camera, "rig");
  ExpectSameIntrinsics(loaded.scanner->projector, saved.scanner->projector);
  ExpectSamePose(loaded.scanner->projector_from_camera, saved.scanner->projector_from_camera);
  EXPECT_EQ(loaded.scanner->scan_roles, saved.scanner->scan_roles);
  EXPECT_EQ(loaded.scanner->placement_roles, saved.scanner->placement_roles);
  ASSERT_EQ(loaded.scanner->scans.size(), 2u);
  EXPECT_EQ(loaded.scanner->scans[1].frames, saved.scanner->scans[1].frames);
  ExpectSamePose(loaded.scanner->scans[0].camera_from_world,
                 saved.scanner->scans[0].camera_from_world);
  EXPECT_EQ(loaded.scanner->placements.at(0).id, "t0");
  ASSERT_TRUE(loaded.reflectance_field.has_value());
  EXPECT_EQ(loaded.reflectance_field->camera, "hand");
  EXPECT_EQ(loaded.reflectance_field->encoding, ColorEncoding::kSrgb);
  ExpectSamePose(loaded.reflectance_field->camera_from_world,
                 saved.reflectance_field->camera_from_world);
  ASSERT_EQ(loaded.reflectance_field->pictures.size(), 2u);
  for (int i = 0; i < 2; ++i) {
    const LitPicture& a = loaded.reflectance_field->pictures[i];
    const LitPicture& b = saved.reflectance_field->pictures[i];
    EXPECT_EQ(a.file, b.file);
    EXPECT_LT((a.to_light - b.to_light).norm(), 1e-15);
    EXPECT_EQ(a.split, b.split);
    EXPECT_EQ(a.intensity, b.intensity);
  }
  EXPECT_EQ(loaded.reflectance_field->mask, "lit/mask.png");
  ASSERT_TRUE(loaded.transport.has_value());
  EXPECT_EQ(loaded.transport->file, "t.ltm");
  EXPECT_EQ(loaded.transport->kind, TransportKind::kMesh);
  EXPECT_EQ(loaded.transport->cube_resolution, 32);
  EXPECT_EQ(loaded.transport->mesh, "truth/mesh.ply");
  EXPECT_EQ(loaded.transport->eyes, saved.transport->eyes);
}

TEST(Capture, MinimalManifestLoads) {
  const TestFolder folder;
  Put(folder / "capture.json",
      R"({"format": "lfm-capture", "version": 1, "cameras": {}, "photos": []})");
  const Capture capture = LoadCapture(folder.path());
  EXPECT_TRUE(capture.photos.empty());
  EXPECT_FALSE(capture.scanner.has_value());
  EXPECT_FALSE(capture.reflectance_field.has_value());
  EXPECT_FALSE(capture.transport.has_value());
  EXPECT_FALSE(capture.BringsGeometry());
}

TEST(Capture, BringsGeometryOnlyWhenNothingIsMissing) {
  Capture capture = FullCapture("folder");
  EXPECT_FALSE(capture.BringsGeometry());
  capture.photos[1].camera_from_world = Pose{};
  EXPECT_FALSE(capture.BringsGeometry());
  capture.cameras["rig"].intrinsics = capture.cameras["hand"].intrinsics;
  EXPECT_TRUE(capture.BringsGeometry());
  Capture without_mesh = capture;
  without_mesh.mesh.clear();
  EXPECT_FALSE(without_mesh.BringsGeometry());
  capture.photos.clear();
  EXPECT_FALSE(capture.BringsGeometry());
}

using Pointer = nlohmann::json::json_pointer;

void ExpectRefused(const nlohmann::json& manifest, const std::string& message) {
  const TestFolder folder;
  Put(folder / "capture.json", manifest.dump());
  ExpectError([&] { LoadCapture(folder.path()); }, message);
  ExpectError([&] { LoadCapture(folder.path()); }, "capture.json");
}

TEST(Capture, EveryMissingKeyIsNamed) {
  const nlohmann::json manifest = FullManifest();
  for (const char* place : {"/format",
                            "/version",
                            "/cameras",
                            "/photos",
                            "/cameras/hand/width",
                            "/cameras/rig/height",
                            "/cameras/hand/intrinsics/fx",
                            "/cameras/hand/intrinsics/cy",
                            "/photos/1/id",
                            "/photos/1/file",
                            "/photos/1/camera",
                            "/photos/1/split",
                            "/photos/0/camera_from_world/rotation",
                            "/photos/0/camera_from_world/translation",
                            "/scanner/camera",
                            "/scanner/projector",
                            "/scanner/projector/width",
                            "/scanner/scan_roles",
                            "/scanner/placement_roles",
                            "/scanner/scans",
                            "/scanner/placements",
                            "/scanner/scans/1/id",
                            "/scanner/scans/1/frames",
                            "/reflectance_field/camera",
                            "/reflectance_field/encoding",
                            "/reflectance_field/pictures",
                            "/reflectance_field/pictures/1/file",
                            "/reflectance_field/pictures/1/direction",
                            "/reflectance_field/pictures/0/split",
                            "/transport/file",
                            "/transport/kind",
                            "/transport/cube_resolution",
                            "/transport/mesh"}) {
    nlohmann::json broken = manifest;
    const Pointer pointer(place);
    broken[pointer.parent_pointer()].erase(pointer.back());
    ExpectRefused(broken, pointer.back() + ": is missing");
  }
}

TEST(Capture, EveryUnknownKeyIsNamed) {
  const nlohmann::json manifest = FullManifest();
  for (const char* place :
       {"", "/cameras/hand", "/cameras/hand/intrinsics", "/photos/1", "/photos/0/camera_from_world",
        "/scanner", "/scanner/projector", "/scanner/projector/intrinsics",
        "/scanner/projector_from_camera", "/scanner/scans/0", "/scanner/scans/0/camera_from_world",
        "/scanner/placements/0", "/reflectance_field", "/reflectance_field/camera_from_world",
        "/reflectance_field/pictures/0", "/transport"}) {
    nlohmann::json broken = manifest;
    broken[Pointer(place)]["phtoo"] = 1;
    ExpectRefused(broken, "phtoo: unknown key");
  }
}

TEST(Capture, EveryWrongTypeOrValueIsNamed) {
  const nlohmann::json manifest = FullManifest();
  struct Case {
    const char* place;
    nlohmann::json value;
    const char* message;
  };
  const Case cases[] = {
      {"/format", "colmap", "format: expected"},
      {"/version", 2, "version"},
      {"/name", 3, "name: expected a string"},
      {"/board", 3, "board: expected a string"},
      {"/cameras", nlohmann::json::array(), "cameras must be"},
      {"/cameras/hand/width", 0, "cameras.hand.width"},
      {"/cameras/hand/width", 65537, "cameras.hand.width"},
      {"/cameras/hand/width", 1.5, "cameras.hand.width"},
      {"/cameras/hand/encoding", "gamma", "expected \"linear\" or \"srgb\""},
      {"/cameras/hand/intrinsics/fx", 0, "intrinsics.fx: must be positive"},
      {"/cameras/hand/intrinsics/fy", -1, "intrinsics.fy: must be positive"},
      {"/cameras/hand/intrinsics/cx", nullptr, "intrinsics.cx: expected a number"},
      {"/photos", 1, "photos: expected an array"},
      {"/photos/1", "p1", "photos[1]"},
      {"/photos/1/id", "p0", "photos[1].id: 'p0' is used twice"},
      {"/photos/1/id", "", "photos[1].id: is empty"},
      {"/photos/1/camera", "phone", "photos[1].camera: no camera 'phone'"},
      {"/photos/1/split", "validation", "photos[1].split: expected \"train\" or \"test\""},
      {"/photos/0/camera_from_world/rotation", {1, 0, 0}, "photos[0].camera_from_world.rotation"},
      {"/photos/0/camera_from_world/rotation", {0, 0, 0, 0}, "unit quaternion"},
      {"/scanner/camera", "phone", "scanner.camera: no camera"},
      {"/scanner/projector/height", 0, "scanner.projector.height"},
      {"/scanner/scan_roles", {"white", 3}, "scanner.scan_roles"},
      {"/scanner/scan_roles", {"white", "white"}, "a role is listed twice"},
      {"/scanner/scan_roles", {"white", ""}, "a role is empty"},
      {"/scanner/scans/1/frames", {"a.png"}, "scanner.scans[1].frames: 1 frames for 2 roles"},
      {"/scanner/placements/0/frames", {"a.png", "b.png"}, "2 frames for 1 roles"},
      {"/scanner/scans/1/id", "s0", "scanner.scans[1].id: 's0' is used twice"},
      {"/scanner/scans/1/id", "p1", "scanner.scans[1].id: 'p1' is used twice"},
      {"/scanner/placements/0/id", "s1", "scanner.placements[0].id: 's1' is used twice"},
      {"/reflectance_field/camera", "phone", "reflectance_field.camera: no camera"},
      {"/reflectance_field/encoding", "raw", "expected \"linear\" or \"srgb\""},
      {"/reflectance_field/pictures", nlohmann::json::array(), "pictures: is empty"},
      {"/reflectance_field/pictures/1/file", "lit/0.png", "'lit/0.png' is used twice"},
      {"/reflectance_field/pictures/1/direction", {0, 0, 0}, "must be a unit vector"},
      {"/reflectance_field/pictures/1/direction", {0, 0, 1.01}, "must be a unit vector"},
      {"/reflectance_field/pictures/1/direction", {1e200, 1e200, 0}, "must be a unit vector"},
      {"/reflectance_field/pictures/1/direction", {0, 0, nullptr}, "pictures[1].direction"},
      {"/reflectance_field/pictures/1/direction", {0, 1}, "pictures[1].direction"},
      {"/reflectance_field/pictures/0/split", "dev", "pictures[0].split: expected"},
      {"/reflectance_field/mask", 3, "reflectance_field.mask: expected a string"},
      {"/reflectance_field/pictures/1/intensity", {1, 0, 1}, "intensity: must be positive"},
      {"/reflectance_field/pictures/1/intensity", {1, 1, nullptr}, "pictures[1].intensity"},
      {"/transport/kind", "texture", "expected \"image\" or \"mesh\""},
      {"/transport/kind", "image", "mesh: belongs to kind \"mesh\" only"},
      {"/transport/eyes", nlohmann::json::array(), "transport.eyes: is empty"},
      {"/transport/eyes", {{1, 2}}, "transport.eyes: expected an array of rows of 3"},
      {"/transport/cube_resolution", 0, "transport.cube_resolution"},
      {"/transport/cube_resolution", 2048, "transport.cube_resolution"},
  };
  for (const Case& c : cases) {
    nlohmann::json broken = manifest;
    broken[Pointer(c.place)] = c.value;
    ExpectRefused(broken, c.message);
  }
}

TEST(Capture, IdsThatAreNoPlainFileNamesAreRefused) {
  const nlohmann::json manifest = FullManifest();
  for (const char* place : {"/photos/1/id", "/scanner/scans/1/id", "/scanner/placements/0/id"}) {
    for (const std::string& id :
         {std::string("/tmp/x"), std::string("../../x"), std::string("a/b"), std::string("a\\b"),
          std::string(".hidden"), std::string(".."), std::string("two words"), std::string("l\nf"),
          std::string("n\0l", 3), std::string("caf\xc3\xa9"), std::string("a:b")}) {
      nlohmann::json broken = manifest;
      broken[Pointer(place)] = id;
      ExpectRefused(broken, "id: must be made of letters");
    }
    nlohmann::json fine = manifest;
    fine[Pointer(place)] = "IMG_20.0-b" + std::string(54, 'x');
    const TestFolder folder;
    Put(folder / "capture.json", fine.dump());
    EXPECT_NO_THROW(LoadCapture(folder.path()));
    fine[Pointer(place)] = std::string(65, 'x');
    ExpectRefused(fine, "id: is longer than 64 characters");
  }
}

TEST(Capture, PathsThatLeaveTheFolderAreRefused) {
  const nlohmann::json manifest = FullManifest();
  for (const char* place :
       {"/board", "/mesh", "/photos/0/file", "/photos/0/mask", "/scanner/scans/0/frames/1",
        "/scanner/placements/0/frames/0", "/reflectance_field/pictures/1/file",
        "/reflectance_field/mask", "/transport/file", "/transport/mesh"}) {
    for (const char* path : {"/etc/passwd", "../a.png", "photos/../../a.png", "photos/..", ""}) {
      nlohmann::json broken = manifest;
      broken[Pointer(place)] = path;
      ExpectRefused(broken, *path == '/' ? "absolute"
                            : *path      ? "leaves the capture folder"
                                         : "file name is empty");
    }
  }
}

TEST(Capture, SymbolicLinksOutOfTheFolderAreRefused) {
  const TestFolder outside, folder;
  Put(outside / "secret.png", "secret");
  SaveCapture(FullCapture(folder.path()));
  std::filesystem::create_directory_symlink(outside.path(), folder / "photos");
  ExpectError([&] { LoadCapture(folder.path()); }, "photos[0].file");
  ExpectError([&] { LoadCapture(folder.path()); }, "symbolic link");
  std::filesystem::remove(folder / "photos");
  std::filesystem::create_directory(folder / "photos");
  std::filesystem::create_symlink(outside / "secret.png", folder / "photos/0.png");
  ExpectError([&] { LoadCapture(folder.path()); }, "symbolic link");
  std::filesystem::remove(folder / "photos/0.png");
  std::filesystem::create_symlink(folder / "photos/0.png", folder / "photos/0.png");
  ExpectError([&] { LoadCapture(folder.path()); }, "photos[0].file");
}

TEST(Capture, SymbolicLinksInsideTheFolderAreFine) {
  const TestFolder folder, other;
  SaveCapture(FullCapture(folder.path()));
  std::filesystem::create_directory(folder / "originals");
  std::filesystem::create_directory_symlink(folder / "originals", folder / "photos");
  EXPECT_NO_THROW(LoadCapture(folder.path()));
  std::filesystem::create_directory_symlink(folder.path(), other / "link");
  EXPECT_NO_THROW(LoadCapture(other / "link"));
}

TEST(Capture, MalformedOrMissingManifestIsAnError) {
  const TestFolder folder;
  ExpectError([&] { LoadCapture(folder.path()); }, "capture.json");
  Put(folder / "capture.json", "");
  ExpectError([&] { LoadCapture(folder.path()); }, "not valid JSON");
  Put(folder / "capture.json", "[]");
  ExpectError([&] { LoadCapture(folder.path()); }, "must be a JSON object");
  const std::string whole = FullManifest().dump();
  for (size_t length = 0; length < whole.size(); length += 97) {
    Put(folder / "capture.json", whole.substr(0, length));
    ExpectError([&] { LoadCapture(folder.path()); }, "not valid JSON");
  }
}

TEST(Capture, WhatWouldNotLoadIsNotSaved) {
  const TestFolder folder;
  Capture capture = FullCapture(folder.path());
  capture.photos[1].id = "p0";
  ExpectError([&] { SaveCapture(capture); }, "used twice");
  EXPECT_EQ(folder.FileCount(), 0);
}

TEST(ImageLoader, LoadsInsideTheFolderOnlyAndKnowsTheEncoding) {
  const TestFolder folder;
  Capture capture = FullCapture(folder.path());
  const Image image(2, 2, 1, PixelType::kUint16, ColorEncoding::kLinear);
  WriteImage(image, folder / "s/0.png");
  const ImageLoader load = MakeImageLoader(capture);
  EXPECT_EQ(load("s/0.png").encoding(), ColorEncoding::kLinear);
  // The reflectance field states an encoding of its own.
  WriteImage(Image(2, 2, 1, PixelType::kUint16, ColorEncoding::kSrgb), folder / "lit/1.png");
  EXPECT_EQ(load("lit/1.png").encoding(), ColorEncoding::kSrgb);
  ExpectError([&] { load("../x.png"); }, "leaves the capture folder");
  ExpectError([&] { load("photos/0.png"); }, "photos/0.png");
  WriteImage(image, folder / "photos/0.png");
  ExpectError([&] { load("photos/0.png"); }, "state its encoding");
}

}  // namespace
}  // namespace lfm
