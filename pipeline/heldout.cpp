// SPDX-License-Identifier: BSD-3-Clause
#include "pipeline/heldout.h"

#include <algorithm>

#include "core/error.h"

namespace lfm {
namespace {

constexpr int kAllTerms = 1 << 20;

std::vector<const PosedImage*> TestPhotos(const CalibResult& calib) {
  std::vector<const PosedImage*> photos;
  for (const PosedImage& photo : calib.photos) {
    if (photo.split == PhotoSplit::kTest) photos.push_back(&photo);
  }
  if (photos.empty()) {
    throw Error(
        "evaluate: no test photograph has a pose; mark photographs as \"split\": \"test\" "
        "in capture.json");
  }
  return photos;
}

void Summarize(HeldoutScores& scores) {
  double squared = 0, squared_mean_only = 0, ssim = 0, ape = 0, psnr = 0;
  int64_t pixels = 0;
  for (const PhotoScore& photo : scores.photos) {
    const auto n = static_cast<double>(photo.full.pixels);
    squared += photo.full.mse * n;
    squared_mean_only += photo.mean_only.mse * n;
    ssim += photo.full.ssim * n;
    ape += photo.full.ape * n;
    psnr += photo.full.psnr_db;
    pixels += photo.full.pixels;
  }
  const auto n = static_cast<double>(pixels);
  scores.psnr_db = PsnrFromMse(squared / n);
  scores.psnr_mean_only_db = PsnrFromMse(squared_mean_only / n);
  scores.ssim = ssim / n;
  scores.ape = ape / n;
  scores.psnr_mean_of_photos_db = psnr / static_cast<double>(scores.photos.size());
}

nlohmann::json DifferenceToJson(const ImageDifference& d) {
  return {{"pixels", d.pixels}, {"psnr_db", d.psnr_db}, {"ssim", d.ssim}, {"ape", d.ape}};
}

}  // namespace

Image RenderPhotoCamera(const ReferenceRenderer& renderer, const CalibResult& calib,
                        const PosedImage& photo, int terms) {
  RenderOptions options;
  options.evaluation.terms = terms;
  options.samples_per_side = 2;
  const Image layer = renderer
                          .Render(calib.cameras.at(photo.camera), photo.camera_from_world, options,
                                  SilentProgress())
                          .layer;
  Image color(layer.width(), layer.height(), 3, PixelType::kUint8, ColorEncoding::kSrgb);
  const uint8_t* rgba = layer.Data<uint8_t>();
  uint8_t* rgb = color.Data<uint8_t>();
  for (size_t pixel = 0; pixel < color.size() / 3; ++pixel) {
    std::copy_n(rgba + 4 * pixel, 3, rgb + 3 * pixel);
  }
  return color;
}

HeldoutScores ScoreModel(const ReferenceRenderer& renderer, const CalibResult& calib,
                         const HeldoutPictures& pictures, Progress& progress) {
  const std::vector<const PosedImage*> photos = TestPhotos(calib);
  progress.Start("evaluate: held-out photographs", static_cast<int64_t>(photos.size()));
  HeldoutScores scores;
  for (const PosedImage* photo : photos) {
    const Image reference = pictures.reference(*photo);
    const Image mask = pictures.foreground(*photo);
    const Image full = RenderPhotoCamera(renderer, calib, *photo, kAllTerms);
    const Image mean_only = RenderPhotoCamera(renderer, calib, *photo, 0);
    scores.photos.push_back({photo->id, CompareImages(full, reference, mask),
                             CompareImages(mean_only, reference, mask)});
    progress.Advance();
  }
  Summarize(scores);
  return scores;
}

HeldoutScores ScorePictures(const PictureOf& rendering, const CalibResult& calib,
                            const HeldoutPictures& pictures, Progress& progress) {
  const std::vector<const PosedImage*> photos = TestPhotos(calib);
  progress.Start("evaluate: pictures", static_cast<int64_t>(photos.size()));
  HeldoutScores scores;
  for (const PosedImage* photo : photos) {
    scores.photos.push_back(
        {photo->id,
         CompareImages(rendering(*photo), pictures.reference(*photo), pictures.foreground(*photo)),
         {}});
    progress.Advance();
  }
  Summarize(scores);
  return scores;
}

nlohmann::json ScoresToJson(const HeldoutScores& scores) {
  nlohmann::json json = {{"heldout_psnr_db", scores.psnr_db},
                         {"heldout_psnr_mean_of_photos_db", scores.psnr_mean_of_photos_db},
                         {"heldout_ssim", scores.ssim},
                         {"heldout_ape", scores.ape},
                         {"photos", nlohmann::json::array()}};
  const bool has_mean_only = !scores.photos.empty() && scores.photos.front().mean_only.pixels > 0;
  if (has_mean_only) json["heldout_psnr_mean_only_db"] = scores.psnr_mean_only_db;
  for (const PhotoScore& photo : scores.photos) {
    nlohmann::json entry = {{"id", photo.id}, {"full", DifferenceToJson(photo.full)}};
    if (has_mean_only) entry["mean_only"] = DifferenceToJson(photo.mean_only);
    json["photos"].push_back(entry);
  }
  return json;
}

}  // namespace lfm
