// SPDX-License-Identifier: BSD-3-Clause
// What keeping every photograph is worth against a model: held-out photographs shown by the
// unstructured lumigraph (bench/lumigraph.h), by the mean over the photographs, and by models, by
// the rule of lfm-evaluate: lfm-bench-lumigraph CAPTURE WORK [--dense] [MODEL...]. The
// lumigraph lies on the mesh that carries the model, or, with --dense, on the dense surface. Prints
// a Markdown table.
#include <cstdio>
#include <filesystem>
#include <map>
#include <string>

#include "bench/lumigraph.h"
#include "calib/calib_files.h"
#include "core/error.h"
#include "core/ply.h"
#include "core/ray_scene.h"
#include "encode/transport_form.h"
#include "pipeline/heldout.h"
#include "pipeline/workspace.h"

namespace {

namespace fs = std::filesystem;

// The held-out photographs and their masks, read once for all ways.
struct HeldoutPhotos {
  std::map<std::string, lfm::Image> pictures, masks;
  lfm::HeldoutPictures For() const {
    return {{[this](const lfm::PosedImage& photo) { return pictures.at(photo.id); }},
            [this](const lfm::PosedImage& photo) { return masks.at(photo.id); }};
  }
};

HeldoutPhotos ReadHeldout(const lfm::Capture& capture, const lfm::CalibResult& calib,
                          const lfm::TriangleMesh& surface) {
  const lfm::RayScene rays(surface);
  const lfm::ImageLoader load = lfm::MakeImageLoader(capture);
  HeldoutPhotos heldout;
  for (const lfm::PosedImage& photo : calib.photos) {
    if (photo.split != lfm::PhotoSplit::kTest) continue;
    heldout.pictures[photo.id] = lfm::ToRgb8(load(photo.file));
    heldout.masks[photo.id] =
        lfm::RenderSilhouette(rays, calib.cameras.at(photo.camera), photo.camera_from_world);
  }
  return heldout;
}

class Table {
 public:
  Table(const lfm::CalibResult& calib, const HeldoutPhotos& heldout, int64_t photo_bytes)
      : calib_(calib), heldout_(heldout), photo_bytes_(photo_bytes) {
    std::printf("| way | bytes kept | photographs : 1 | PSNR | SSIM | APE |\n");
    std::printf("|---|---|---|---|---|---|\n");
  }
  void Row(const std::string& way, int64_t bytes, const lfm::PictureOf& picture) const {
    const lfm::HeldoutScores scores =
        lfm::ScorePictures(picture, calib_, heldout_.For(), lfm::SilentProgress()).front();
    std::printf("| %s | %lld | %.1f | %.2f dB | %.4f | %.2f |\n", way.c_str(),
                static_cast<long long>(bytes),
                static_cast<double>(photo_bytes_) / static_cast<double>(bytes), scores.psnr_db,
                scores.ssim, scores.ape);
    std::fflush(stdout);
  }

 private:
  const lfm::CalibResult& calib_;
  const HeldoutPhotos& heldout_;
  int64_t photo_bytes_;
};

struct Options {
  bool dense = false;
  std::vector<fs::path> models;
};

void Compare(const lfm::Capture& capture, const lfm::Workspace& work, const Options& options) {
  const lfm::CalibResult calib = lfm::CalibOfCapture(capture, work.Stage("calib"));
  const lfm::TriangleMesh surface = lfm::ReadPlyMesh(work.Stage("mesh") / "surface.ply");
  const HeldoutPhotos heldout = ReadHeldout(capture, calib, surface);
  const lfm::Lumigraph lumigraph(
      capture, calib, surface,
      options.dense ? surface : lfm::ReadPlyMesh(work.Stage("mesh") / "mesh.ply"));
  const Table table(calib, heldout, lumigraph.PhotoBytes());
  const std::vector<int> neighbors = {0, 1, 4, 5, 8};
  std::map<std::string, std::vector<lfm::Image>> pictures;
  for (const lfm::PosedImage& photo : calib.photos) {
    if (photo.split != lfm::PhotoSplit::kTest) continue;
    pictures[photo.id] =
        lumigraph.Render(calib.cameras.at(photo.camera), photo.camera_from_world, neighbors);
  }
  for (size_t i = 0; i < neighbors.size(); ++i) {
    const std::string way = neighbors[i] == 0 ? "mean of the photographs that see a point"
                                              : "lumigraph, " + std::to_string(neighbors[i]) +
                                                    " nearest" + (options.dense ? ", dense" : "");
    table.Row(way, lumigraph.PhotoBytes(),
              [&](const lfm::PosedImage& photo) { return pictures.at(photo.id)[i]; });
  }
  for (const fs::path& file : options.models) {
    const lfm::ReferenceRenderer renderer(lfm::ReadModel(file).model);
    table.Row("`" + file.filename().string() + "`", static_cast<int64_t>(fs::file_size(file)),
              [&](const lfm::PosedImage& photo) {
                return lfm::RenderPhotoCamera(renderer, calib, photo, 1 << 20);
              });
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) {
    std::fprintf(stderr, "usage: lfm-bench-lumigraph CAPTURE WORK [--dense] [MODEL...]\n");
    return 2;
  }
  try {
    Options options;
    for (int i = 3; i < argc; ++i) {
      if (std::string(argv[i]) == "--dense") {
        options.dense = true;
      } else {
        options.models.emplace_back(argv[i]);
      }
    }
    Compare(lfm::LoadCapture(argv[1]), {argv[2]}, options);
  } catch (const lfm::Error& error) {
    std::fprintf(stderr, "lfm-bench-lumigraph: error: %s\n", error.what());
    return 2;
  }
  return 0;
}
