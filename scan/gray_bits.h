// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// What the bits of a block of pixels say, part of gray_kernel_body.h: compiled once for each
// instruction set, so all of it is without linkage.
#include <cstdint>

#include "scan/gray_kernel.h"
#include "scan/gray_vectors.h"

namespace lfm::kernels {
namespace {

constexpr uint8_t kCeiling = 254;  // a level of 254 may be a clipped one and its noise

/// A saturated byte or a float that is not finite cannot be measured.
LFM_INLINE Bytes Unfit(Bytes bright, Bytes) { return bright; }
LFM_INLINE Floats Unfit(Floats a, Floats b) { return (a - b) * 0.0F; }
LFM_INLINE ByteMask IsFit(Bytes worst) {
  const Bytes ceiling = Bytes{} + kCeiling;
  return worst < ceiling;
}
LFM_INLINE Ints IsFit(Floats worst) { return worst == 0.0F; }
LFM_INLINE Bytes Worse(Bytes a, Bytes b) { return Max(a, b); }
LFM_INLINE Floats Worse(Floats a, Floats b) { return a + b; }

/// A pair of frames that show a bit: bytes as the brighter and the darker, since of pairs that were
/// measured only sum and distance count; floats as pattern and inverse.
template <typename V>
struct BitPair {
  V p, q;
  V bright, apart;
};

LFM_INLINE BitPair<Bytes> PairOf(Bytes p, Bytes q) {
  const Bytes bright = Max(p, q), dark = Min(p, q);
  return {bright, dark, bright, bright - dark};
}
LFM_INLINE BitPair<Floats> PairOf(Floats p, Floats q) {
  return {p, q, Max(p, q), Max(p, q) - Min(p, q)};
}

/// No distance is greater than what this gives where `mask` is set.
LFM_INLINE Bytes OrMost(ByteMask mask, Bytes apart) { return apart | Bytes(mask); }
LFM_INLINE Floats OrMost(Ints mask, Floats apart) {
  return Select(mask, Floats{} + __FLT_MAX__, apart);
}

/// Of a block of pixels. A distance goes with the brighter value of its pair.
template <typename T>
struct BitBlock {
  T finest_p[kGrayBlock], finest_q[kGrayBlock];
  T other_p[kGrayBlock], other_q[kGrayBlock];
  T weak[kGrayBlock], weak_bright[kGrayBlock];
  T strong[kGrayBlock], strong_bright[kGrayBlock];
};

/// Binary digits of each lane, bit by bit.
template <typename Mask>
struct Digits;
template <>
struct Digits<ByteMask> {
  ByteMask low{}, high{}, digit = ByteMask{} + 1;
  LFM_INLINE void Add(ByteMask on, int bit) {
    if (bit == 8) {
      low = high;
      high = ByteMask{};
      digit = ByteMask{} + 1;
    }
    high |= on & digit;
    digit = ByteMask(Bytes(digit) + Bytes(digit));  // unsigned: the eighth digit wraps
  }
  /// Turns the digits round where `all` is.
  LFM_INLINE void Finish(ByteMask all, int bits, uint16_t* out) {
    const ByteMask turned = high ^ (all & ByteMask(Bytes(digit) - 1));
    if (bits <= 8) {
      StoreWords(turned, ByteMask{}, out);
    } else {
      StoreWords(low ^ all, turned, out);
    }
  }
};
template <>
struct Digits<Ints> {
  Ints low{}, digit = Ints{} + 1;
  LFM_INLINE void Add(Ints on, int) {
    low |= on & digit;
    digit += digit;
  }
  LFM_INLINE void Finish(Ints all, int, uint16_t* out) {
    StoreWords(low ^ (all & (digit - 1)), out);
  }
};

/// One vector of pixels, from the finest bit to the coarsest. The cell's other edge belongs to the
/// bit left of the rightmost 1 of the Gray code: its value as seen here is taken when it comes by.
/// A cell's digit is the parity of the Gray code's digits from it on: of all, less those before it.
template <typename T>
LFM_INLINE void ReadBits(const GrayPlanes<T>& planes, long at, int count, BitBlock<T>& out,
                         GrayReading& reading, int i) {
  using V = typename VectorsOf<T>::Values;
  using Mask = typename VectorsOf<T>::Mask;
  const V white = Load<V>(planes.white + at, count), black = Load<V>(planes.black + at, count);
  const BitPair<V> all = PairOf(white, black);
  V other_p = all.p, other_q = all.q, weak = all.apart, weak_bright = all.bright;
  V strong{}, strong_bright{};
  Digits<Mask> digits;
  Mask parity{}, unseen = ~Mask{}, take{};
  V worst = Unfit(all.p, all.q);
  // Of the bits whose stripes are narrow, but not so narrow that blur takes them, the clearest.
  const int first_clear = planes.bits > 2 ? 2 : planes.bits - 1, end_clear = first_clear + 3;
  for (int bit = 0; bit < planes.bits; ++bit) {
    const V p = Load<V>(planes.pattern[bit] + at, count);
    const V q = Load<V>(planes.inverse[bit] + at, count);
    // Forty frames are more streams than the processor fetches ahead by itself.
    __builtin_prefetch(planes.pattern[bit] + at + 2 * kGrayBlock);
    __builtin_prefetch(planes.inverse[bit] + at + 2 * kGrayBlock);
    const BitPair<V> pair = PairOf(p, q);
    const Mask on = ~Mask(pair.bright == q);
    digits.Add(parity, bit);
    parity ^= on;
    if (bit >= first_clear && bit < end_clear) {
      strong = Max(strong, pair.apart);
      strong_bright = Select(strong == pair.apart, pair.bright, strong_bright);
    }
    if (bit == 0) {
      Store(pair.p, out.finest_p + i);
      Store(pair.q, out.finest_q + i);
      worst = Worse(worst, Unfit(pair.p, pair.q));
    } else {
      const V before = weak;
      weak = Min(weak, OrMost(take, pair.apart));
      weak_bright = Select(before == weak, weak_bright, pair.bright);
      other_p = Select(take, pair.p, other_p);
      other_q = Select(take, pair.q, other_q);
    }
    take = unseen & on;
    unseen &= ~on;
    if constexpr (sizeof(T) > 1) worst = Worse(worst, Unfit(pair.p, pair.q));
  }
  digits.Finish(parity, planes.bits, reading.cell + i);
  Store(other_p, out.other_p + i);
  Store(other_q, out.other_q + i);
  Store(weak, out.weak + i);
  Store(weak_bright, out.weak_bright + i);
  Store(strong, out.strong + i);
  Store(strong_bright, out.strong_bright + i);
  StoreBytes(IsFit(Worse(worst, Unfit(other_p, other_q))), reading.fit + i);
}

template <typename T>
LFM_INLINE void ReadBlock(const GrayPlanes<T>& planes, long begin, int count, BitBlock<T>& out,
                          GrayReading& reading) {
  constexpr int kLanes = kVectorBytes / static_cast<int>(sizeof(T));
  int i = 0;
  for (; i + kLanes <= count; i += kLanes) ReadBits(planes, begin + i, kLanes, out, reading, i);
  if (i < count) ReadBits(planes, begin + i, count - i, out, reading, i);
}

}  // namespace
}  // namespace lfm::kernels
