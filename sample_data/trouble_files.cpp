// SPDX-License-Identifier: BSD-3-Clause
#include "sample_data/trouble_files.h"

#include <nlohmann/json.hpp>
#include <system_error>

#include "core/json_reader.h"
#include "sample_data/plate.h"

namespace lfm {

void WriteTrouble(const StudioOptions& options, const StudioResult& result,
                  const std::filesystem::path& folder) {
  Trouble trouble = options.trouble, none;
  const nlohmann::json knobs = OptionsToJson(AnyOptions(trouble));
  if (knobs == OptionsToJson(AnyOptions(none))) {
    for (const char* name : {"trouble.json", "board.json", "platform.json"}) {
      std::error_code ignored;
      std::filesystem::remove(folder / name, ignored);
    }
    return;
  }
  nlohmann::json json = {{"knobs", knobs}, {"photos", nlohmann::json::array()}};
  for (size_t i = 0; i < result.conditions.size(); ++i) {
    const PhotoConditions& c = result.conditions[i];
    json["photos"].push_back(
        {{"id", result.truth.photos[i].id},
         {"exposure_stops", c.exposure_stops},
         {"white_balance_gains", {c.gains.x(), c.gains.y(), c.gains.z()}},
         {"travel_in_camera_mm", {c.travel_mm.x(), c.travel_mm.y(), c.travel_mm.z()}},
         {"occluded", c.occluded},
         {"half_framed", c.half_framed}});
  }
  WriteJson(json, folder / "trouble.json");
  WriteBoard(result.printed, folder / "board.json");
  WritePlatformTruth(result.printed, options.trouble.platform.plate_sag_mm,
                     folder / "platform.json");
}

}  // namespace lfm
