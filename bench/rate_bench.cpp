// SPDX-License-Identifier: BSD-3-Clause
// Bytes against accuracy of one object, every way that the encoder knows, beside WebP and JPEG XL
// over the same maps: lfm-bench-rate WORK [transport]. "transport": only what the transport form is
// compared with, and how long it takes to decode. PSNR is that of the decoded maps against the
// resampled light field. Prints a Markdown table.
#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <initializer_list>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <string>

#include "bench/jpeg_xl.h"
#include "core/error.h"
#include "core/parallel.h"
#include "core/progress.h"
#include "encode/encode.h"
#include "encode/model_error.h"

namespace {

namespace fs = std::filesystem;

class Table {
 public:
  explicit Table(const lfm::LightField& light_field)
      : light_field_(light_field), source_(lfm::SourceFromLightField(light_field)) {
    std::printf("| way | terms a vertex | bytes | dense : 1 | PSNR |\n|---|---|---|---|---|\n");
  }
  lfm::EncodeResult Encode(const std::string& way, const lfm::EncodeOptions& options) const {
    lfm::EncodeResult result = lfm::Encode(light_field_, options, lfm::SilentProgress());
    Row(way, result.terms_mean, result.maps_bytes, result.matrix_psnr_db);
    return result;
  }
  void Row(const std::string& way, double terms, int64_t bytes, double psnr_db) const {
    std::printf("| %s | %.2f | %lld | %.0f | %.2f dB |\n", way.c_str(), terms,
                static_cast<long long>(bytes),
                static_cast<double>(source_.dense_bytes) / static_cast<double>(bytes), psnr_db);
    std::fflush(stdout);
  }
  double Psnr(const lfm::LightFieldModel& model) const {
    return lfm::CompareWithLightField(source_, model).psnr_db();
  }

 private:
  const lfm::LightField& light_field_;
  lfm::LightFieldSource source_;
};

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

void JpegXlRows(const Table& table, const std::string& way, const lfm::LightFieldModel& maps,
                double terms) {
  for (const double distance : {0.5, 1.0, 2.0, 4.0}) {
    lfm::LightFieldModel model = maps;
    const int64_t bytes = ThroughJpegXl(model, static_cast<float>(distance));
    char name[80];
    std::snprintf(name, sizeof name, "%s, JPEG XL, distance %.1f", way.c_str(), distance);
    table.Row(name, terms, bytes, table.Psnr(model));
  }
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

void TransportRows(const Table& table, const std::string& way, const lfm::LightFieldModel& model,
                   double terms, std::initializer_list<double> accuracies) {
  for (const double db : accuracies) {
    const lfm::EncodedTransport encoded = lfm::EncodeTransport(model, {db});
    char name[96];
    std::snprintf(name, sizeof name, "%s, transport form, %.0f dB (%.1f kB of geometry)",
                  way.c_str(), db, static_cast<double>(encoded.geometry_bytes) * 1e-3);
    table.Row(name, terms, static_cast<int64_t>(encoded.bytes.size()),
              table.Psnr(lfm::ReorderModel(lfm::DecodeTransport(encoded.bytes, "model.lfz").model,
                                           lfm::Inverse(encoded.order))));
    if (db == 52) PrintDecodeTime(encoded.bytes, model);
  }
}

// The transport form beside JPEG XL, of equal terms and of as many as needed.
void CompareTransport(const Table& table) {
  const lfm::EncodeResult three =
      table.Encode("3 terms, 8-bit maps", {.terms = 3, .transport_db = 0});
  JpegXlRows(table, "3 terms", three.model, 3);
  TransportRows(table, "3 terms", three.model, 3, {46, 49, 52});
  const lfm::EncodeResult fine =
      table.Encode("as many terms as needed, 8-bit maps", {.target_db = 47, .transport_db = 0});
  JpegXlRows(table, "as many terms as needed", fine.model, fine.terms_mean);
  TransportRows(table, "as many terms as needed", fine.model, fine.terms_mean,
                {44, 46, 48, 50, 52, 56});
}

void CompareAll(const Table& table) {
  double fixed_db = 0;
  lfm::LightFieldModel three;
  for (const int terms : {1, 2, 3}) {
    const lfm::EncodeResult result = table.Encode(std::to_string(terms) + " terms, 8-bit maps",
                                                  {.terms = terms, .transport_db = 0});
    if (terms != 3) continue;
    fixed_db = result.matrix_psnr_db;
    three = result.model;
  }
  table.Encode("nonnegative, 4 terms, 8-bit maps",
               {.factorization = lfm::Factorization::kNmf, .terms = 4, .transport_db = 0});
  for (const double db : {fixed_db, 45.0}) {
    table.Encode("as many terms as needed, 8-bit maps", {.target_db = db, .transport_db = 0});
  }
  for (const int quality : {60, 80, 90, 95, 100}) {
    lfm::LightFieldModel model = three;
    const int64_t bytes = ThroughWebp(model, quality);
    table.Row("3 terms, WebP, quality " + std::to_string(quality), 3, bytes, table.Psnr(model));
  }
  CompareTransport(table);
}

}  // namespace

int main(int argc, char** argv) {
  const std::string only = argc == 3 ? argv[2] : "";
  if (argc < 2 || argc > 3 || (argc == 3 && only != "transport")) {
    std::fprintf(stderr, "usage: lfm-bench-rate WORK [transport]\n");
    return 2;
  }
  try {
    const lfm::LightField light_field =
        lfm::LightField::Open(fs::path(argv[1]) / "resample/light_field.lfs");
    const Table table(light_field);
    only.empty() ? CompareAll(table) : CompareTransport(table);
  } catch (const lfm::Error& error) {
    std::fprintf(stderr, "lfm-bench-rate: error: %s\n", error.what());
    return 2;
  }
  return 0;
}
