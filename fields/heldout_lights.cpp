// SPDX-License-Identifier: BSD-3-Clause
#include "fields/heldout_lights.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/image_metrics.h"
#include "core/parallel.h"

namespace lfm {
namespace {

bool Counts(const Image& mask, int64_t point) { return mask.Data<uint8_t>()[point] >= 128; }

void RequirePicture(const Field& field) {
  if (field.width < 1 || static_cast<int64_t>(field.width) * field.height != field.points) {
    throw Error(field.name + ": its points are no picture's pixels");
  }
}

struct Energies {
  double difference = 0, truth = 0;
};

Energies CompareLinear(const Field& held_out, int column, const std::vector<float>& shown,
                       const Image& mask) {
  Energies sums;
  for (int c = 0; c < held_out.channels; ++c) {
    for (int64_t point = 0; point < held_out.points; ++point) {
      if (!Counts(mask, point)) continue;
      const int64_t row = held_out.RowOf(point, c);
      const double truth = held_out.functions.Row(row)[column], d = truth - shown[row];
      sums.difference += d * d;
      sums.truth += truth * truth;
    }
  }
  return sums;
}

// What one held-out light adds to a method's score.
struct Sums {
  double mse = 0, ssim = 0, ape = 0;
  Energies energies;
};

void AddLight(const ImageDifference& difference, Sums& sums, LightMethodScore& score) {
  sums.mse += difference.mse;
  sums.ssim += difference.ssim;
  sums.ape += difference.ape;
  score.light_psnr_db.push_back(difference.psnr_db);
}

void Finish(const Sums& sums, int lights, LightMethodScore& score) {
  score.psnr_db = PsnrFromMse(sums.mse / lights);
  score.ssim = sums.ssim / lights;
  score.ape = sums.ape / lights;
  if (sums.energies.truth > 0) {
    score.relative_error = sums.energies.difference / sums.energies.truth;
  }
}

}  // namespace

double DisplayWhite(const Field& field) {
  constexpr double kShare = 0.999;
  std::vector<float> brightest;  // of each row that shows anything
  for (int64_t r = 0; r < field.functions.rows; ++r) {
    const float* row = field.functions.Row(r);
    const float largest = *std::max_element(row, row + field.functions.columns);
    if (largest > 0) brightest.push_back(largest);
  }
  if (brightest.empty()) return 1;
  const auto at =
      brightest.begin() + static_cast<int64_t>(kShare * static_cast<double>(brightest.size() - 1));
  std::nth_element(brightest.begin(), at, brightest.end());
  return *at >= 1.0f / 16 && *at <= 1 ? 1 : *at;
}

Image PictureOfRows(const Field& field, const std::vector<float>& values, double white) {
  RequirePicture(field);
  if (static_cast<int64_t>(values.size()) != field.points * field.channels) {
    throw Error(field.name + ": a picture with another number of values", ErrorKind::kSystem);
  }
  Image picture(field.width, field.height, 3, PixelType::kFloat32, ColorEncoding::kLinear);
  for (int64_t point = 0; point < field.points; ++point) {
    for (int c = 0; c < 3; ++c) {
      const int64_t row = field.RowOf(point, std::min(c, field.channels - 1));
      picture.Data<float>()[point * 3 + c] = static_cast<float>(values[row] / white);
    }
  }
  return ToSrgb8(picture);
}

Image PictureOfColumn(const Field& field, int column, double white) {
  std::vector<float> values(static_cast<size_t>(field.functions.rows));
  for (int64_t r = 0; r < field.functions.rows; ++r) values[r] = field.functions.Row(r)[column];
  return PictureOfRows(field, values, white);
}

Image ObjectMask(const Field& train, double white) {
  RequirePicture(train);
  Image mask(train.width, train.height, 1, PixelType::kUint8, ColorEncoding::kLinear);
  auto* pixels = mask.Data<uint8_t>();
  const auto floor = static_cast<float>(white * LinearFromSrgb(kNoiseLevel / 255.0f));
  bool any = false;
  for (int64_t point = 0; point < train.points; ++point) {
    bool counts = !train.mask.empty() && train.mask[point] != 0;
    for (int c = 0; train.mask.empty() && c < train.channels; ++c) {
      const float* row = train.functions.Row(train.RowOf(point, c));
      counts = counts || *std::max_element(row, row + train.functions.columns) > floor;
    }
    pixels[point] = counts ? 255 : 0;
    any = any || counts;
  }
  if (!any) std::fill_n(pixels, train.points, uint8_t{255});
  return mask;
}

LightScores ScoreLightMethods(const Field& held_out, const Image& mask, double white,
                              const std::vector<LightMethod>& methods, Progress& progress) {
  LightScores scores;
  scores.white = white;
  const size_t count = methods.size();
  scores.methods.resize(count);
  for (size_t i = 0; i < count; ++i) {
    scores.methods[i].name = methods[i].name;
    scores.methods[i].family = methods[i].family;
    scores.methods[i].bytes = methods[i].bytes;
  }
  if (held_out.functions.rows == 0) return scores;
  RequirePicture(held_out);
  if (mask.width() != held_out.width || mask.height() != held_out.height) {
    throw Error(held_out.name + ": scored over a mask of another size", ErrorKind::kSystem);
  }
  scores.lights = held_out.functions.columns;
  for (int64_t point = 0; point < held_out.points; ++point) scores.pixels += Counts(mask, point);
  std::vector<Sums> sums(count);
  progress.Start("evaluate: held-out lights", scores.lights);
  for (int light = 0; light < scores.lights; ++light) {
    const Image truth = PictureOfColumn(held_out, light, white);
    std::vector<Image> pictures(count);
    for (size_t i = 0; i < count; ++i) {
      const std::vector<float> shown = methods[i].predict(held_out.directions[light]);
      pictures[i] = PictureOfRows(held_out, shown, white);
      const Energies energies = CompareLinear(held_out, light, shown, mask);
      sums[i].energies.difference += energies.difference;
      sums[i].energies.truth += energies.truth;
    }
    ParallelFor(0, static_cast<int64_t>(count), [&](int64_t i) {
      AddLight(CompareImages(pictures[i], truth, mask), sums[i], scores.methods[i]);
    });
    progress.Advance();
  }
  for (size_t i = 0; i < count; ++i) Finish(sums[i], scores.lights, scores.methods[i]);
  return scores;
}

nlohmann::json LightScoresToJson(const LightScores& scores) {
  nlohmann::json methods = nlohmann::json::array();
  for (const LightMethodScore& score : scores.methods) {
    nlohmann::json method = {
        {"name", score.name}, {"family", score.family}, {"bytes", score.bytes}};
    if (scores.lights > 0) {
      method["psnr_db"] = score.psnr_db;
      method["ssim"] = score.ssim;
      method["ape"] = score.ape;
      method["relative_error"] = score.relative_error;
      method["light_psnr_db"] = score.light_psnr_db;
    }
    methods.push_back(method);
  }
  return {{"lights", scores.lights},
          {"pixels", scores.pixels},
          {"white", scores.white},
          {"methods", methods}};
}

std::string LightFiguresToTable(const nlohmann::json& figures) {
  char line[160];
  std::snprintf(line, sizeof line, "%-30s %12s %8s %7s %7s %9s\n", "", "bytes", "PSNR dB", "SSIM",
                "APE", "rel. err.");
  std::string table = line;
  for (const nlohmann::json& method : figures.at("methods")) {
    std::snprintf(line, sizeof line, "%-30s %12lld", method.value("name", "").c_str(),
                  method.value("bytes", 0LL));
    table += line;
    if (method.contains("psnr_db")) {
      std::snprintf(line, sizeof line, " %8.2f %7.4f %7.2f %9.5f", method.value("psnr_db", 0.0),
                    method.value("ssim", 0.0), method.value("ape", 0.0),
                    method.value("relative_error", 0.0));
      table += line;
    }
    table += "\n";
  }
  return table;
}

}  // namespace lfm
