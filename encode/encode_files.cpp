// SPDX-License-Identifier: BSD-3-Clause
#include "encode/encode_files.h"

#include <limits>

#include "core/atomic_file.h"
#include "core/error.h"
#include "core/json_reader.h"
#include "encode/glb.h"

namespace lfm {
namespace {

constexpr int kMaxCount = std::numeric_limits<int>::max();

void RemoveOldTransport(const std::filesystem::path& file) {
  std::error_code error;
  std::filesystem::remove(file, error);
  if (error) {
    throw Error(file.string() + ": an earlier model's cannot be removed (" + error.message() +
                    "); remove it by hand",
                ErrorKind::kSystem);
  }
}

}  // namespace

nlohmann::json SaveEncode(const EncodeResult& result, const std::filesystem::path& folder) {
  nlohmann::json figures;
  WriteFilesTogether(folder, [&](const std::filesystem::path& files) {
    const int64_t model_bytes = WriteGlb(result.model, files / "model.glb");
    if (!result.transport.bytes.empty()) {
      WriteFileAtomically(files / "model.lfz", result.transport.bytes);
    }
    figures = {{"terms_mean", result.terms_mean},
               {"terms_max", result.terms_max},
               {"vertices_by_terms", result.vertices_by_terms},
               {"model_bytes", model_bytes},
               {"transport_bytes", result.transport.bytes.size()},
               {"transport_geometry_bytes", result.transport.geometry_bytes},
               {"transport_mean_bytes", result.transport.mean_bytes},
               {"maps_bytes", result.maps_bytes},
               {"compression_ratio", result.compression_ratio},
               {"matrix_psnr_db", result.matrix_psnr_db},
               {"matrix_psnr_mean_only_db", result.matrix_psnr_mean_only_db},
               {"matrix_psnr_by_terms_db", result.matrix_psnr_by_terms_db},
               {"singular_value_share", result.singular_value_share},
               {"unseen_triangles", result.unseen_triangles}};
    WriteJson(figures, files / "encode.json");
    // Before the others take their places: a model.lfz of another model does not stay beside them.
    if (result.transport.bytes.empty()) RemoveOldTransport(folder / "model.lfz");
  });
  return figures;
}

EncodeResult LoadEncode(const std::filesystem::path& folder) {
  const std::filesystem::path file = folder / "encode.json";
  const nlohmann::json json = ReadJson(file);
  EncodeResult result;
  result.model = ReadGlb(folder / "model.glb");
  JsonReader reader(json, file.string());
  result.terms_mean = reader.Number("terms_mean");
  result.terms_max = reader.Integer("terms_max", 0, 16);
  for (const double count :
       reader.Numbers("vertices_by_terms", static_cast<size_t>(result.terms_max) + 1)) {
    if (!(count >= 0 && count <= kMaxCount)) {
      throw Error(file.string() + ": \"vertices_by_terms\" is out of range; run lfm-encode again");
    }
    result.vertices_by_terms.push_back(static_cast<int>(count));
  }
  result.model_bytes = static_cast<int64_t>(reader.Number("model_bytes"));
  EncodedTransport& transport = result.transport;
  const bool has_transport = reader.Number("transport_bytes") > 0;
  transport.geometry_bytes = static_cast<int64_t>(reader.Number("transport_geometry_bytes"));
  transport.mean_bytes = static_cast<int64_t>(reader.Number("transport_mean_bytes"));
  if (has_transport) transport.bytes = ReadFile(folder / "model.lfz");
  result.maps_bytes = static_cast<int64_t>(reader.Number("maps_bytes"));
  result.compression_ratio = reader.Number("compression_ratio");
  result.matrix_psnr_db = reader.Number("matrix_psnr_db");
  result.matrix_psnr_mean_only_db = reader.Number("matrix_psnr_mean_only_db");
  result.matrix_psnr_by_terms_db =
      reader.Numbers("matrix_psnr_by_terms_db", static_cast<size_t>(result.terms_max) + 1);
  result.singular_value_share =
      reader.Numbers("singular_value_share", static_cast<size_t>(result.model.terms));
  result.unseen_triangles = reader.Integer("unseen_triangles", 0, kMaxCount);
  reader.Finish();
  return result;
}

}  // namespace lfm
