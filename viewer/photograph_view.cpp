// SPDX-License-Identifier: BSD-3-Clause
#include "viewer/photograph_view.h"

#include <algorithm>
#include <utility>

#include "core/ply.h"
#include "viewer/gl_framebuffer.h"
#include "viewer/reference_renderer.h"

namespace lfm {
namespace {

constexpr int kMaxPictureSide = 1600;
constexpr int kSamples = 4;
constexpr int kDifferenceGain = 8;  // as in the report
constexpr double kGapPixels = 6;
constexpr int kPictures = 3;

bool ShowsTheSame(const GlRenderOptions& a, const GlRenderOptions& b) {
  return a.evaluation.terms == b.evaluation.terms &&
         a.evaluation.term_alone == b.evaluation.term_alone &&
         a.view_coordinates == b.view_coordinates && a.passes == b.passes &&
         a.tone.exposure_stops == b.tone.exposure_stops && a.tone.curve == b.tone.curve &&
         a.background == b.background;
}

// A rendering as it is shown and as it is judged.
struct Layers {
  Image shown;     ///< over the background
  Image alone;     ///< the model's colour also where it covers a pixel in part; else black
  Image coverage;  ///< 255 where it covers the pixel wholly
};

Layers Split(const Image& rgba, const Eigen::Vector3f& background) {
  Layers layers;
  layers.shown = layers.alone =
      Image(rgba.width(), rgba.height(), 3, PixelType::kUint8, ColorEncoding::kSrgb);
  layers.coverage =
      Image(rgba.width(), rgba.height(), 1, PixelType::kUint8, ColorEncoding::kLinear);
  const uint8_t* from = rgba.Data<uint8_t>();
  uint8_t* shown = layers.shown.Data<uint8_t>();
  uint8_t* alone = layers.alone.Data<uint8_t>();
  uint8_t* coverage = layers.coverage.Data<uint8_t>();
  for (size_t i = 0; i < layers.coverage.size(); ++i, from += 4) {
    const int alpha = coverage[i] = from[3];
    for (int c = 0; c < 3; ++c, ++shown, ++alone) {
      *alone =
          static_cast<uint8_t>(alpha > 0 ? std::min(255, (from[c] * 255 + alpha / 2) / alpha) : 0);
      *shown =
          static_cast<uint8_t>(std::min(255.0f, from[c] + (255 - alpha) * background[c] + 0.5f));
    }
  }
  return layers;
}

Layers RenderFor(const GlScene& scene, const Camera& camera, const Pose& camera_from_world,
                 GlRenderOptions options) {
  const Eigen::Vector3f background = std::exchange(options.background, {0, 0, 0});
  options.background_alpha = 0;
  options.edges = EdgeOverlay::kNone;
  const GlFramebuffer drawn(camera.width, camera.height, kSamples);
  const GlFramebuffer smooth(camera.width, camera.height, 1);
  drawn.Bind();
  scene.Draw(camera, camera_from_world, options);
  drawn.ResolveInto(smooth);
  return Split(smooth.Read(4), background);
}

// Three pictures in the cells of a grid, row by row.
struct Arrangement {
  int columns, rows;
};

PixelRectangle CellOf(const Arrangement& grid, int cell, int width, int height) {
  const double w = static_cast<double>(width) / grid.columns;
  const double h = static_cast<double>(height) / grid.rows;
  const int column = cell % grid.columns, row = cell / grid.columns;
  return {column * w + kGapPixels / 2, row * h + kGapPixels / 2, std::max(w - kGapPixels, 1.0),
          std::max(h - kGapPixels, 1.0)};
}

Arrangement LargestArrangement(int width, int height, int picture_width, int picture_height) {
  Arrangement best{kPictures, 1};
  double largest = 0;
  for (const Arrangement& grid :
       {Arrangement{kPictures, 1}, Arrangement{2, 2}, Arrangement{1, kPictures}}) {
    const double shown =
        FitInto(CellOf(grid, 0, width, height), picture_width, picture_height).width;
    if (shown > largest) {
      best = grid;
      largest = shown;
    }
  }
  return best;
}

}  // namespace

PhotographView::PhotographView(const std::filesystem::path& work,
                               const std::filesystem::path& capture)
    : capture_(capture) {
  if (capture.empty()) {
    for (const auto& [id, camera] : PhotoCameras(work)) photographs_.push_back({id, {}, camera});
    return;
  }
  photographs_ = FindPhotographs(work, capture);
  const std::filesystem::path surface = work / "mesh" / "surface.ply";
  std::error_code unknown;
  if (std::filesystem::exists(surface, unknown)) surface_.emplace(ReadPlyMesh(surface));
}

const PosedPhotograph* PhotographView::Find(const std::string& id) const {
  const auto found = std::find_if(photographs_.begin(), photographs_.end(),
                                  [&](const PosedPhotograph& one) { return one.id == id; });
  return found == photographs_.end() ? nullptr : &*found;
}

void PhotographView::Read(const PosedPhotograph& photograph) {
  if (read_ == photograph.id) return;
  picture_ = ReadPinholePicture(photograph, capture_, kMaxPictureSide);
  read_ = photograph.id;
}

void PhotographView::Compare(const PosedPhotograph& photograph, const Pose& camera_from_world,
                             const GlScene& scene, const ViewerState& state) {
  const GlRenderOptions options = MakeGlRenderOptions(state);
  if (compared_ && compared_->id == photograph.id && ShowsTheSame(compared_->options, options)) {
    return;
  }
  Read(photograph);
  const Layers rendered = RenderFor(scene, picture_.camera, camera_from_world, options);
  const Image foreground =
      surface_ ? RenderSilhouette(*surface_, picture_.camera, photograph.camera.camera_from_world)
               : rendered.coverage;
  difference_ = ComparePhotograph(picture_, rendered.alone, foreground, kDifferenceGain);
  shown_.clear();
  for (const Image* image :
       {&std::as_const(picture_.color), &rendered.shown, &std::as_const(difference_.picture)}) {
    shown_.emplace_back(*image);
  }
  compared_ = Compared{photograph.id, options};
}

void PhotographView::Draw(int left, int width, int height,
                          const Eigen::Vector3f& background) const {
  ClearPicture(background, 1);
  if (shown_.empty()) return;
  const int picture_width = shown_[0].width(), picture_height = shown_[0].height();
  const Arrangement best = LargestArrangement(width - left, height, picture_width, picture_height);
  for (int i = 0; i < kPictures; ++i) {
    PixelRectangle cell = CellOf(best, i, width - left, height);
    cell.x += left;
    shown_[i].DrawInto(FitInto(cell, picture_width, picture_height), width, height);
  }
}

Camera CameraInWindow(const Camera& camera, int width, int height) {
  const double scale = std::min(static_cast<double>(width) / camera.width,
                                static_cast<double>(height) / camera.height);
  Camera pinhole;
  pinhole.width = width;
  pinhole.height = height;
  pinhole.fx = camera.fx * scale;
  pinhole.fy = camera.fy * scale;
  pinhole.cx = (camera.cx + 0.5 - camera.width / 2.0) * scale + width / 2.0 - 0.5;
  pinhole.cy = (camera.cy + 0.5 - camera.height / 2.0) * scale + height / 2.0 - 0.5;
  return pinhole;
}

}  // namespace lfm
