// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

/// The hot loops of Gray decoding, compiled for several instruction sets and dispatched at run
/// time. Plain pointers only, since what is shared must not be compiled for one of them. Every
/// pixel is computed by the same operations in the same order whatever the instruction set: results
/// are the same on every machine.
namespace lfm::kernels {

constexpr int kGrayBlock = 256;     ///< pixels that one call handles at most
constexpr int kGrayIntervals = 15;  ///< odd: cells that no edge cuts have one of their own

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
  float strength[kGrayBlock];  ///< (o + f) / (white - black)
  uint8_t fit[kGrayBlock];     ///< not 0 where none of what these are made of is clipped
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
  int size;       ///< projector pixels
  float cell_px;  ///< projector pixels a cell
  float min_weakest, min_strength, min_direct;

  /// The intervals as they are looked up: offset + slope balance is the place from the cell's
  /// middle, projector pixels. The last is there twice, since 1 belongs to it.
  alignas(32) float offset[kGrayIntervals + 1], slope[kGrayIntervals + 1];
  alignas(32) float spread[kGrayIntervals + 1];
};

/// Sets the intervals of a placing whose cell_px is set.
void SetIntervals(const GrayInterval (&intervals)[kGrayIntervals], GrayPlacing& placing);

/// The position of a pixel that DecodeGray does not know.
constexpr float kNowhere = -1e9F;

/// Position, its standard deviation and confidence of a block; kNowhere, 0 and 0 where `usable` is
/// 0 or the reading is too weak.
struct GrayPlaces {
  float position[kGrayBlock], sigma[kGrayBlock], confidence[kGrayBlock];
};

/// Light of a block.
struct GrayLight {
  float white[kGrayBlock], contrast[kGrayBlock];  ///< linear
  uint8_t usable[kGrayBlock];                     ///< 1 where lit and not clipped
};

/// A picture of places.
struct GrayRaster {
  long width, height;
  float *position, *sigma, *confidence;
};

/// The loops as compiled for one instruction set. `contrast` is read in whole vectors.
struct GrayKernels {
  template <typename T>
  using Read = void(const GrayPlanes<T>&, const GrayNoise&, const float* contrast, long begin,
                    int count, GrayReading&);
  template <typename T>
  using Decode = void(const GrayPlanes<T>&, const GrayNoise&, const GrayPlacing&,
                      const float* contrast, const uint8_t* usable, long begin, int count,
                      GrayPlaces&);
  Read<uint8_t>* read_bytes;
  Read<float>* read_floats;
  Decode<uint8_t>* decode_bytes;
  Decode<float>* decode_floats;
  void (*light)(const float* linear_of_level, const uint8_t* lit, const uint8_t* dark,
                float min_contrast, int count, GrayLight&);
  void (*reject)(const GrayRaster&, long begin, long end, float reach, int32_t* kept);
};

/// Those that this processor runs, the fastest first; nullptr beyond the last.
const GrayKernels* GrayKernelsHere(int i);

/// Reads `count` pixels from `begin`. `contrast` is white - black, linear, of these pixels.
void ReadGray(const GrayPlanes<uint8_t>& planes, const GrayNoise& noise, const float* contrast,
              long begin, int count, GrayReading& reading,
              const GrayKernels& kernels = *GrayKernelsHere(0));
void ReadGray(const GrayPlanes<float>& planes, const GrayNoise& noise, const float* contrast,
              long begin, int count, GrayReading& reading,
              const GrayKernels& kernels = *GrayKernelsHere(0));

/// Reads and places them; `contrast` and `usable` are of these pixels.
void DecodeGray(const GrayPlanes<uint8_t>& planes, const GrayNoise& noise,
                const GrayPlacing& placing, const float* contrast, const uint8_t* usable,
                long begin, int count, GrayPlaces& places,
                const GrayKernels& kernels = *GrayKernelsHere(0));
void DecodeGray(const GrayPlanes<float>& planes, const GrayNoise& noise, const GrayPlacing& placing,
                const float* contrast, const uint8_t* usable, long begin, int count,
                GrayPlaces& places, const GrayKernels& kernels = *GrayKernelsHere(0));

/// Light of `count` pixels by the bytes of the lit and the dark frame. `linear_of_level` has the
/// 256 linear values.
void ReadGrayLight(const float* linear_of_level, const uint8_t* lit, const uint8_t* dark,
                   float min_contrast, int count, GrayLight& light,
                   const GrayKernels& kernels = *GrayKernelsHere(0));

/// Clears to 0 what is nowhere, and every pixel none of whose four neighbours lies within `reach`
/// projector pixels of it: a flipped bit moves one pixel, a surface has neighbours. Compares rows
/// `begin` to `end` - 1 with the rows beside them, which must not have been cleared, and clears the
/// rows one before each; so a picture takes all of [0, height + 1), in order, in one call or in
/// many as its rows come. `kept` is scratch of two rows.
void RejectIslands(const GrayRaster& raster, long begin, long end, float reach, int32_t* kept,
                   const GrayKernels& kernels = *GrayKernelsHere(0));

}  // namespace lfm::kernels
