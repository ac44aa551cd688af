// SPDX-License-Identifier: BSD-3-Clause
// Bytes against accuracy of one object, every way that the encoder knows, beside WebP over the same
// maps: lfm-bench-rate WORK. PSNR is that of the decoded maps against the resampled light field.
// Prints a Markdown table.
#include <cstdio>
#include <filesystem>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <string>

#include "core/error.h"
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

// All pages through WebP; returns its bytes, and what ranges take.
int64_t ThroughWebp(lfm::LightFieldModel& model, int quality) {
  int64_t bytes = 0;
  const auto code = [&](std::vector<lfm::Image>& pages) {
    for (lfm::Image& page : pages) {
      cv::Mat rgb(page.height(), page.width(), CV_8UC3, page.Data<uint8_t>()), bgr;
      cv::cvtColor(rgb, bgr, cv::COLOR_RGB2BGR);
      std::vector<uint8_t> coded;
      cv::imencode(".webp", bgr, coded, {cv::IMWRITE_WEBP_QUALITY, quality});
      bytes += static_cast<int64_t>(coded.size());
      cv::cvtColor(cv::imdecode(coded, cv::IMREAD_COLOR), rgb, cv::COLOR_BGR2RGB);
    }
  };
  code(model.mean_pages);
  for (auto& pages : model.surface_pages) code(pages);
  for (auto& pages : model.view_pages) code(pages);
  const size_t ranges = model.surface_ranges.size() + model.view_ranges.size();
  return bytes + static_cast<int64_t>(ranges * sizeof(lfm::MapRange));
}

void Compare(const fs::path& work) {
  const lfm::LightField light_field = lfm::LightField::Open(work / "resample/light_field.lfs");
  const Table table(light_field);
  double fixed_db = 0;
  lfm::LightFieldModel three;
  for (const int terms : {1, 2, 3, 4, 6}) {
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
  const lfm::EncodeResult fine =
      table.Encode("as many terms as needed, 8-bit maps", {.target_db = 47, .transport_db = 0});
  for (const double db : {44.0, 46.0, 48.0, 50.0, 52.0, 56.0}) {
    const std::string bytes = lfm::EncodeTransport(fine.model, {db}).bytes;
    char way[80];
    std::snprintf(way, sizeof way, "transport form of that, %.0f dB, geometry too", db);
    table.Row(way, fine.terms_mean, static_cast<int64_t>(bytes.size()),
              table.Psnr(lfm::DecodeTransport(bytes, "model.lfz").model));
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: lfm-bench-rate WORK\n");
    return 2;
  }
  try {
    Compare(argv[1]);
  } catch (const lfm::Error& error) {
    std::fprintf(stderr, "lfm-bench-rate: error: %s\n", error.what());
    return 2;
  }
  return 0;
}
