// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

namespace lfm {

/// Light over a field's directions (Yamada 2009, I): what each column is to be multiplied with. In
/// the unit of the field's columns: irradiance of parallel lights, or mean radiance of texels
/// (FieldColumns).
struct LightVector {
  int directions = 0;
  int channels = 1;           ///< 1 or 3
  std::vector<float> values;  ///< channel after channel

  float* Channel(int channel) { return values.data() + size_t(channel) * directions; }
  const float* Channel(int channel) const { return values.data() + size_t(channel) * directions; }
};

inline LightVector MakeLightVector(int directions, int channels) {
  return {directions, channels,
          std::vector<float>(static_cast<size_t>(directions) * static_cast<size_t>(channels))};
}

/// With as many channels: three from one are its copies, one from three their Rec. 709 luminance.
inline LightVector WithChannels(const LightVector& light, int channels) {
  if (light.channels == channels) return light;
  LightVector result = MakeLightVector(light.directions, channels);
  for (int i = 0; i < light.directions; ++i) {
    if (channels == 1) {
      result.values[i] = 0.2126f * light.Channel(0)[i] + 0.7152f * light.Channel(1)[i] +
                         0.0722f * light.Channel(2)[i];
    } else {
      for (int c = 0; c < channels; ++c) result.Channel(c)[i] = light.Channel(0)[i];
    }
  }
  return result;
}

}  // namespace lfm
