// SPDX-License-Identifier: BSD-3-Clause
#include "pipeline/heldout.h"

#include <algorithm>
#include <memory>

#include "core/error.h"
#include "core/ray_scene.h"

namespace lfm {
namespace {

constexpr int kAllTerms = 1 << 20;

std::vector<const PosedImage*> TestPhotos(const CalibResult& calib) {
  std::vector<const PosedImage*> photos;
  for (const PosedImage& photo : calib.photos) {
    if (photo.split == PhotoSplit::kTest) photos.push_back(&photo);
  }
  return photos;
}

void Summarize(HeldoutScores& scores) {
  if (scores.photos.empty()) return;
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

bool HasForeground(const Image& mask) {
  if (mask.type() != PixelType::kUint8) return true;  // CompareImages says what is wrong
  const uint8_t* values = mask.Data<uint8_t>();
  return std::any_of(values, values + mask.size(), [](uint8_t v) { return v >= 128; });
}

struct Renderings {
  Image full, mean_only;  // mean_only may be empty
};

PhotoScore ScorePhoto(const PosedImage& photo, const Renderings& renderings, const Image& reference,
                      const Image& mask) {
  try {
    PhotoScore score{photo.id, CompareImages(renderings.full, reference, mask), {}};
    if (!renderings.mean_only.empty()) {
      score.mean_only = CompareImages(renderings.mean_only, reference, mask);
    }
    return score;
  } catch (const Error& e) {
    throw Error("photograph '" + photo.id + "' (" + photo.file + "): " + e.what(), e.kind());
  }
}

std::vector<HeldoutScores> ScoreAll(const std::function<Renderings(const PosedImage&)>& render,
                                    const CalibResult& calib, const HeldoutPictures& pictures,
                                    Progress& progress) {
  const std::vector<const PosedImage*> photos = TestPhotos(calib);
  progress.Start("evaluate: held-out photographs", static_cast<int64_t>(photos.size()));
  std::vector<HeldoutScores> scores(pictures.references.size());
  for (const PosedImage* photo : photos) {
    const Image mask = pictures.foreground(*photo);
    if (HasForeground(mask)) {
      const Renderings renderings = render(*photo);
      for (size_t i = 0; i < scores.size(); ++i) {
        scores[i].photos.push_back(
            ScorePhoto(*photo, renderings, pictures.references[i](*photo), mask));
      }
    } else {
      for (HeldoutScores& s : scores) {
        s.missing.push_back({photo->id, photo->file + ": the object is not in the picture"});
      }
    }
    progress.Advance();
  }
  for (HeldoutScores& s : scores) Summarize(s);
  return scores;
}

}  // namespace

PictureOf PhotographsOf(const Capture& capture) {
  const ImageLoader load = MakeImageLoader(capture);
  return [load](const PosedImage& photo) { return ToRgb8(load(photo.file)); };
}

PictureOf SilhouettesOf(const TriangleMesh& surface, const CalibResult& calib) {
  return [rays = std::make_shared<RayScene>(surface), &calib](const PosedImage& photo) {
    return RenderSilhouette(*rays, calib.cameras.at(photo.camera), photo.camera_from_world);
  };
}

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

std::vector<HeldoutScores> ScoreModel(const ReferenceRenderer& renderer, const CalibResult& calib,
                                      const HeldoutPictures& pictures, Progress& progress) {
  const auto render = [&](const PosedImage& photo) -> Renderings {
    return {RenderPhotoCamera(renderer, calib, photo, kAllTerms),
            RenderPhotoCamera(renderer, calib, photo, 0)};
  };
  return ScoreAll(render, calib, pictures, progress);
}

std::vector<HeldoutScores> ScorePictures(const PictureOf& rendering, const CalibResult& calib,
                                         const HeldoutPictures& pictures, Progress& progress) {
  const auto take = [&](const PosedImage& photo) -> Renderings { return {rendering(photo), {}}; };
  return ScoreAll(take, calib, pictures, progress);
}

void AddUnposedPhotos(const Capture& capture, const CalibResult& calib, HeldoutScores& scores) {
  for (const Photo& photo : capture.photos) {
    const auto is_it = [&](const auto& image) { return image.id == photo.id; };
    if (photo.split != PhotoSplit::kTest ||
        std::any_of(calib.photos.begin(), calib.photos.end(), is_it)) {
      continue;
    }
    const auto rejected = std::find_if(calib.rejected.begin(), calib.rejected.end(), is_it);
    scores.missing.push_back({photo.id, "it has no pose" + (rejected == calib.rejected.end()
                                                                ? std::string()
                                                                : ": " + rejected->reason)});
  }
}

nlohmann::json ScoresToJson(const HeldoutScores& scores) {
  nlohmann::json json = {{"photos_scored", scores.photos.size()},
                         {"photos_missing", scores.missing.size()},
                         {"photos", nlohmann::json::array()},
                         {"missing", nlohmann::json::array()}};
  for (const MissingPhoto& photo : scores.missing) {
    json["missing"].push_back({{"id", photo.id}, {"reason", photo.reason}});
  }
  if (scores.photos.empty()) {
    json["note"] = scores.missing.empty()
                       ? "no score: mark photographs as \"split\": \"test\" in capture.json"
                       : "no score: none of the test photographs could be used";
    return json;
  }
  if (!scores.missing.empty()) json["note"] = "the score lacks some of the test photographs";
  json["heldout_psnr_db"] = scores.psnr_db;
  json["heldout_psnr_mean_of_photos_db"] = scores.psnr_mean_of_photos_db;
  json["heldout_ssim"] = scores.ssim;
  json["heldout_ape"] = scores.ape;
  const bool has_mean_only = scores.photos.front().mean_only.pixels > 0;
  if (has_mean_only) json["heldout_psnr_mean_only_db"] = scores.psnr_mean_only_db;
  for (const PhotoScore& photo : scores.photos) {
    nlohmann::json entry = {{"id", photo.id}, {"full", DifferenceToJson(photo.full)}};
    if (has_mean_only) entry["mean_only"] = DifferenceToJson(photo.mean_only);
    json["photos"].push_back(entry);
  }
  return json;
}

}  // namespace lfm
