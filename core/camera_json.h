// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <nlohmann/json.hpp>

#include "core/camera.h"
#include "core/json_reader.h"

namespace lfm {

/// Whether a file must state k1, k2, k3, p1 and p2, or may leave out those that are 0.
enum class LensKeys { kRequired, kOptional };

/// {"fx", "fy", "cx", "cy", "k1", "k2", "k3", "p1", "p2"}, and "k4", "k5", "k6" unless all are 0;
/// with CameraToJson "width" and "height" too. Numbers round-trip.
nlohmann::json IntrinsicsToJson(const Camera& camera);
nlohmann::json CameraToJson(const Camera& camera);

/// The inverses. Throw Error, naming file and place, for missing, unknown and non-finite values,
/// sizes outside [1, max_side], and what no lens has: focal lengths outside [0.01, 1000] longer
/// sides of the picture, or a principal point more than 50 of them from the first pixel.
Camera IntrinsicsFromJson(JsonReader& reader, int width, int height, LensKeys keys);
Camera CameraFromJson(JsonReader& reader, int max_side, LensKeys keys);

}  // namespace lfm
