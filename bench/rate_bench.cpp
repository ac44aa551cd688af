// SPDX-License-Identifier: BSD-3-Clause
// Bytes against accuracy of one object, with the encoder's defaults: lfm-bench-rate WORK [DB].
// Prints Markdown tables: --target-db against fixed numbers of terms; and fixed numbers of terms,
// JPEG XL and WebP over pages of maps against the transport form, all brought to DB (that of three
// terms) by interpolation. PSNR is that of the decoded maps against the resampled light field,
// whose directions are filled as lfm-encode fills them.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <initializer_list>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <string>
#include <vector>

#include "bench/jpeg_xl.h"
#include "calib/calib_files.h"
#include "core/error.h"
#include "core/parallel.h"
#include "core/progress.h"
#include "encode/encode.h"
#include "encode/model_error.h"
#include "encode/model_layout.h"
#include "encode/reflection_model.h"

namespace {

namespace fs = std::filesystem;

constexpr int kMostTerms = 8;

// One way to spend bytes, and what it reaches.
struct Point {
  double psnr_db = 0, bytes = 0;
};

// Bytes at a PSNR between two neighbouring points: their logarithm is nearly linear in decibels.
// None outside of what was measured. Points go by rising PSNR.
std::optional<double> BytesAt(const std::vector<Point>& points, double psnr_db) {
  for (size_t i = 1; i < points.size(); ++i) {
    const Point &a = points[i - 1], &b = points[i];
    if (psnr_db < a.psnr_db || psnr_db > b.psnr_db || !(b.psnr_db > a.psnr_db)) continue;
    const double along = (psnr_db - a.psnr_db) / (b.psnr_db - a.psnr_db);
    return a.bytes * std::pow(b.bytes / a.bytes, along);
  }
  return std::nullopt;
}

// Light field and eyes with its directions filled: what all models here are compared with.
class Reference {
 public:
  explicit Reference(const fs::path& work)
      : light_field_(lfm::LightField::Open(work / "resample/light_field.lfs")),
        blended_(lfm::SourceFromLightField(
            light_field_, lfm::EyesOfPhotos(lfm::LoadCalib(work / "calib"),
                                            light_field_.photo_ids(), light_field_.name()))),
        filled_(lfm::WithReflections(blended_, lfm::FitReflections(blended_))) {}

  lfm::EncodeResult Encode(lfm::EncodeOptions options) const {
    options.fill = lfm::DirectionFill::kBlend;  // it is filled already
    options.transport_db = 0;
    return lfm::Encode(filled_, options, lfm::SilentProgress());
  }
  double Psnr(const lfm::LightFieldModel& model) const {
    return lfm::CompareWithLightField(filled_, model).psnr_db();
  }
  // A row of the second table.
  Point Row(const std::string& way, double terms, int64_t bytes, double psnr_db) const {
    std::printf("| %s | %.2f | %lld | %.0f | %.2f dB |\n", way.c_str(), terms,
                static_cast<long long>(bytes),
                static_cast<double>(filled_.dense_bytes) / static_cast<double>(bytes), psnr_db);
    std::fflush(stdout);
    return {psnr_db, static_cast<double>(bytes)};
  }
  // Bytes of the maps when each vertex has its first `terms` terms alone.
  int64_t BytesOfFirst(const lfm::LightFieldModel& model, int terms) const {
    std::vector<int> edge_samples, vertex_terms = model.vertex_terms;
    for (const lfm::PatchPlacement& placement : model.placements) {
      edge_samples.push_back(placement.edge_samples);
    }
    for (int& own : vertex_terms) own = std::min(own, terms);
    return lfm::LayOutModel(filled_, edge_samples, vertex_terms,
                            lfm::EncodeOptions{}.max_texture_size)
        .MapsBytes();
  }

 private:
  lfm::LightField light_field_;
  lfm::LightFieldSource blended_, filled_;
};

// Terms add up one by one: K of them are the first K of more. Returns a point for each K.
std::vector<Point> CompareTargets(const Reference& reference) {
  const lfm::EncodeResult all = reference.Encode({.terms = kMostTerms});
  std::printf(
      "| K | PSNR | fixed K | `--target-db` of that: terms a vertex | bytes | fewer | bytes with "
      "`--patch-detail full --view-detail full` |\n|---|---|---|---|---|---|---|\n");
  std::vector<Point> fixed;
  for (int terms = 0; terms <= all.model.terms; ++terms) {
    const double psnr_db = all.matrix_psnr_by_terms_db[terms];
    const int64_t bytes = reference.BytesOfFirst(all.model, terms);
    fixed.push_back({psnr_db, static_cast<double>(bytes)});
    if (terms == 0 || terms == kMostTerms) continue;  // nothing to choose from
    const lfm::EncodeResult chosen = reference.Encode({.target_db = psnr_db});
    const lfm::EncodeResult full = reference.Encode({.target_db = psnr_db,
                                                     .patch_detail = lfm::MapDetail::kFull,
                                                     .view_detail = lfm::MapDetail::kFull});
    std::printf("| %d | %.2f dB | %lld | %.2f | %lld | %.1f %% | %lld |\n", terms, psnr_db,
                static_cast<long long>(bytes), chosen.terms_mean,
                static_cast<long long>(chosen.maps_bytes),
                100 - 100 * static_cast<double>(chosen.maps_bytes) / static_cast<double>(bytes),
                static_cast<long long>(full.maps_bytes));
    std::fflush(stdout);
  }
  std::printf("\n");
  return fixed;
}

// A page as it comes back, and its bytes.
using PageCoder = std::function<int64_t(lfm::Image& page, lfm::bench::Channels channels)>;

// All pages through a picture format; returns its bytes, and what ranges take.
int64_t ThroughPictures(lfm::LightFieldModel& model, const PageCoder& coder) {
  int64_t bytes = 0;
  const auto code = [&](std::vector<lfm::Image>& pages, lfm::bench::Channels channels) {
    for (lfm::Image& page : pages) bytes += coder(page, channels);
  };
  code(model.mean_pages, lfm::bench::Channels::kTogether);
  // Three corners' maps: not colours.
  for (auto& pages : model.surface_pages) code(pages, lfm::bench::Channels::kApart);
  for (auto& pages : model.view_pages) code(pages, lfm::bench::Channels::kTogether);
  const size_t ranges = model.surface_ranges.size() + model.view_ranges.size();
  return bytes + static_cast<int64_t>(ranges * sizeof(lfm::MapRange));
}

int64_t ThroughWebp(lfm::LightFieldModel& model, int quality) {
  return ThroughPictures(model, [quality](lfm::Image& page, lfm::bench::Channels) {
    cv::Mat rgb(page.height(), page.width(), CV_8UC3, page.Data<uint8_t>()), bgr;
    cv::cvtColor(rgb, bgr, cv::COLOR_RGB2BGR);
    std::vector<uint8_t> coded;
    // Qualities above 100 are lossless, to OpenCV.
    cv::imencode(".webp", bgr, coded, {cv::IMWRITE_WEBP_QUALITY, quality});
    cv::cvtColor(cv::imdecode(coded, cv::IMREAD_COLOR), rgb, cv::COLOR_BGR2RGB);
    return static_cast<int64_t>(coded.size());
  });
}

int64_t ThroughJpegXl(lfm::LightFieldModel& model, float distance) {
  return ThroughPictures(model, [distance](lfm::Image& page, lfm::bench::Channels channels) {
    lfm::bench::JpegXlPicture picture = lfm::bench::ThroughJpegXl(page, distance, channels);
    page = std::move(picture.image);
    return picture.bytes;
  });
}

// Of the whole decoding, the best of five.
void PrintDecodeTime(const std::string& bytes, const lfm::LightFieldModel& model) {
  double least = HUGE_VAL;
  for (int run = 0; run < 5; ++run) {
    const auto start = std::chrono::steady_clock::now();
    lfm::DecodeTransport(bytes, "model.lfz");
    const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start;
    least = std::min(least, elapsed.count());
  }
  const auto vertices = static_cast<double>(model.mesh.vertices.size());
  std::printf(
      "decoded to 8-bit maps: %.3f s on %d threads, %.3f s for 3 300 vertices at that rate\n",
      least, lfm::ThreadCount(), least * 3300 / vertices);
  std::fflush(stdout);
}

using Through = std::function<int64_t(lfm::LightFieldModel& model, double setting)>;

// The pages of a model in a picture format, by settings of falling loss.
std::vector<Point> PictureRows(const Reference& reference, const lfm::EncodeResult& maps,
                               const std::string& way, const Through& through,
                               std::initializer_list<double> settings) {
  std::vector<Point> points;
  for (const double setting : settings) {
    lfm::LightFieldModel model = maps.model;
    const int64_t bytes = through(model, setting);
    char name[120];
    std::snprintf(name, sizeof name, "%s %g", way.c_str(), setting);
    points.push_back(reference.Row(name, maps.terms_mean, bytes, reference.Psnr(model)));
  }
  return points;
}

std::vector<Point> TransportRows(const Reference& reference, const lfm::EncodeResult& maps,
                                 std::initializer_list<double> accuracies) {
  std::vector<Point> points;
  for (const double db : accuracies) {
    const lfm::EncodedTransport encoded = lfm::EncodeTransport(maps.model, {db});
    char name[120];
    std::snprintf(name, sizeof name, "transport form, `--transport-db %g` (%.1f kB of geometry)",
                  db, static_cast<double>(encoded.geometry_bytes) * 1e-3);
    const lfm::LightFieldModel decoded = lfm::ReorderModel(
        lfm::DecodeTransport(encoded.bytes, "model.lfz").model, lfm::Inverse(encoded.order));
    points.push_back(reference.Row(name, maps.terms_mean,
                                   static_cast<int64_t>(encoded.bytes.size()),
                                   reference.Psnr(decoded)));
  }
  return points;
}

constexpr const char* kTransport = "transport form, geometry too";

struct Curve {
  std::string name;
  std::vector<Point> points;
};

// Of a model a little finer than the PSNR asked for, so that what is lost after it can be spent.
std::vector<Curve> CompareCoding(const Reference& reference, double psnr_db) {
  constexpr double kFiner_db = 1;
  const auto webp = [](lfm::LightFieldModel& model, double quality) {
    return ThroughWebp(model, static_cast<int>(quality));
  };
  const auto jpeg_xl = [](lfm::LightFieldModel& model, double distance) {
    return ThroughJpegXl(model, static_cast<float>(distance));
  };
  const lfm::EncodeResult maps = reference.Encode({.target_db = psnr_db + kFiner_db,
                                                   .patch_detail = lfm::MapDetail::kFull,
                                                   .view_detail = lfm::MapDetail::kFull});
  std::printf("| way | terms a vertex | bytes | dense : 1 | PSNR |\n|---|---|---|---|---|\n");
  reference.Row("as many terms as needed, 8-bit maps", maps.terms_mean, maps.maps_bytes,
                maps.matrix_psnr_db);
  std::vector<Curve> curves = {
      {kTransport, TransportRows(reference, maps, {38, 41, 44, 47, 50, 53})},
      {"JPEG XL", PictureRows(reference, maps, "JPEG XL, distance", jpeg_xl, {2, 1, 0.5, 0.25})},
      {"WebP", PictureRows(reference, maps, "WebP, quality", webp, {90, 100, 101})}};
  PrintDecodeTime(lfm::EncodeTransport(maps.model, {}).bytes, maps.model);
  std::printf("\n");
  return curves;
}

// All ways at one PSNR, against the best of the transport form's.
void PrintAt(double psnr_db, const std::vector<Curve>& curves) {
  std::optional<double> transport;
  for (const Curve& curve : curves) {
    if (curve.name == kTransport) transport = BytesAt(curve.points, psnr_db);
  }
  std::printf("| way, at %.2f dB | bytes | times the transport form's |\n|---|---|---|\n", psnr_db);
  for (const Curve& curve : curves) {
    const std::optional<double> bytes = BytesAt(curve.points, psnr_db);
    if (bytes && transport) {
      std::printf("| %s | %.0f | %.2f |\n", curve.name.c_str(), *bytes, *bytes / *transport);
    } else {
      std::printf("| %s | not within the settings tried | - |\n", curve.name.c_str());
    }
  }
}

void Compare(const fs::path& work, std::optional<double> asked_db) {
  const Reference reference(work);
  const std::vector<Point> fixed = CompareTargets(reference);
  const double psnr_db = asked_db.value_or(fixed[std::min<size_t>(3, fixed.size() - 1)].psnr_db);
  std::vector<Curve> curves = CompareCoding(reference, psnr_db);
  curves.insert(curves.begin(), {"fixed K, 8-bit maps (between two K)", fixed});
  PrintAt(psnr_db, curves);
}

}  // namespace

int main(int argc, char** argv) {
  std::optional<double> psnr_db;
  if (argc == 3) psnr_db = std::strtod(argv[2], nullptr);
  if (argc < 2 || argc > 3 || (psnr_db && !(*psnr_db >= 30 && *psnr_db <= 60))) {
    std::fprintf(stderr, "usage: lfm-bench-rate WORK [DB from 30 to 60]\n");
    return 2;
  }
  try {
    Compare(argv[1], psnr_db);
  } catch (const lfm::Error& error) {
    std::fprintf(stderr, "lfm-bench-rate: error: %s\n", error.what());
    return 2;
  }
  return 0;
}
