// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

/// The hot loops of Gray decoding, compiled for several instruction sets and dispatched at run
/// time. Plain pointers only. Every pixel is computed by the same operations in the same order
/// whatever the instruction set: results are the same on every machine.
namespace lfm::kernels {

constexpr int kGrayBlock = 256;     ///< pixels that one call handles at most
constexpr int kGrayIntervals = 33;  ///< odd: cells that no edge cuts have one of their own

/// Frames of one axis, the finest bit first. T is uint8_t (sRGB-coded) or float (linear).
template <typename T>
struct GrayPlanes {
  const T* white;
  const T* black;
  const T* const* pattern;
  const T* const* inverse;
  int bits;
};

/// Noise of a frame's linear value I: offset + slope I is its variance. A pair's difference
/// p - q has the variance pair_offset offset + slope (own p + both (p + q)).
struct GrayNoise {
  float offset, slope;
  float pair_offset, own, both;
};

/// What the code says at each pixel of a block.
///
/// A cell is what lies between two neighbouring stripe edges. Of the two edges of a cell one
/// belongs to the finest bit, the other to another bit; f and o are the sizes of these two bits'
/// linear differences |pattern - inverse|. A pixel that an edge cuts shows a small difference.
struct GrayReading {
  uint16_t cell[kGrayBlock];
  float balance[kGrayBlock];   ///< (o - f) / (o + f): 1 on the finest bit's edge, -1 on the other's
  float variance[kGrayBlock];  ///< of `balance`
  float strength[kGrayBlock];  ///< (o + f) / (white - black); 0 where what it is made of is clipped
  float weakest[kGrayBlock];   ///< least difference of all other bits / (white - black)
  /// Largest difference of three bits with narrow stripes / (white - black). Light that wandered
  /// between surfaces has seen both the bright and the dark stripes, so this is the share of light
  /// that came straight (Nayar et al. 2006).
  float direct[kGrayBlock];
};

/// Where in the cell (0: on the other bit's edge, 1: on the finest bit's) pixels lie whose balance
/// is in an interval: place + slope (balance - start of the interval), with this variance.
struct GrayInterval {
  float place, slope, spread;
};

/// From a reading to projector coordinates; the intervals divide [-1, 1] evenly.
struct GrayPlacing {
  GrayInterval intervals[kGrayIntervals];
  int size;       ///< projector pixels
  float cell_px;  ///< projector pixels a cell
  float min_weakest, min_strength, min_direct;
};

/// Reads `count` pixels from `begin`. `contrast` is white - black, linear, of these pixels.
void ReadGray(const GrayPlanes<uint8_t>& planes, const GrayNoise& noise, const float* contrast,
              long begin, int count, GrayReading& reading);
void ReadGray(const GrayPlanes<float>& planes, const GrayNoise& noise, const float* contrast,
              long begin, int count, GrayReading& reading);

/// The position of a pixel that PlaceGray does not know.
constexpr float kNowhere = -1e9F;

/// Position, its standard deviation and confidence of the `count` pixels of a reading; kNowhere, 0
/// and 0 where `usable` is 0 or the reading is too weak.
void PlaceGray(const GrayReading& reading, const GrayPlacing& placing, const uint8_t* usable,
               int count, float* position, float* sigma, float* confidence);

/// Clears to 0 what is nowhere, and every pixel none of whose four neighbours lies within `reach`
/// projector pixels of it: a flipped bit moves one pixel, a surface has neighbours. `kept` is
/// scratch of two rows.
void RejectIslands(long width, long height, float reach, uint32_t* kept, float* position,
                   float* sigma, float* confidence);

}  // namespace lfm::kernels
