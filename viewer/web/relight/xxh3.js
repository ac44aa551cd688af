// SPDX-License-Identifier: BSD-3-Clause
// XXH3, 64 bits, without seed (Y. Collet, xxHash, BSD-2-Clause), of what .lfr files check: whole
// 8-byte words, at least three. Long input goes through halves of 32 bits, the rest through BigInt.

const kPrime32 = [0x9e3779b1, 0x85ebca77, 0xc2b2ae3d];
const kPrime64 = [0x9e3779b185ebca87n, 0xc2b2ae3d27d4eb4fn, 0x165667b19e3779f9n,
                  0x85ebca77c2b2ae63n, 0x27d4eb2f165667c5n];
const kSecret = Uint8Array.from(('b8fe6c3923a44bbe7c01812cf721ad1cded46de9839097db7240a4a4b7b3671f' +
  'cb79e64eccc0e578825ad07dccff7221b8084674f743248ee03590e6813a264c' +
  '3c2852bb91c300cb88d0658b1b532ea371644897a20df94e3819ef46a9deacd8' +
  'a8fa763fe39c343ff9dcbbc7c70b4f1d8a51e04bcdb45931c89f7ec9d9787364' +
  'eac5ac8334d3ebc3c581a0fffa1363eb170ddd51b7f0da49d316552629d4689e' +
  '2b16be587d47a1fc8ff8b8d17ad031ce45cb3a8f95160428afd7fbcabb4b407e').match(/../g),
  (digits) => parseInt(digits, 16));
const kStripe = 64, kBlock = 16 * kStripe; // bytes

const viewOf = (bytes) => new DataView(bytes.buffer, bytes.byteOffset, bytes.length);
const kSecretView = viewOf(kSecret);
const secretAt = (at) => kSecretView.getBigUint64(at, true);
const wrap = (x) => BigInt.asUintN(64, x);

/** A BigInt. */
export function xxh3(bytes) {
  const input = viewOf(bytes);
  if (bytes.length > 240) return hashLong(input);
  return bytes.length > 128 ? hashMiddle(input) : hashShort(input);
}

function avalanche(x) {
  const mixed = wrap((x ^ x >> 37n) * 0x165667919e3779f9n);
  return mixed ^ mixed >> 32n;
}

function foldedProduct(a, b) {
  const product = a * b;
  return wrap(product) ^ product >> 64n;
}

const mix16 = (input, at, secret) => foldedProduct(
  input.getBigUint64(at, true) ^ secretAt(secret),
  input.getBigUint64(at + 8, true) ^ secretAt(secret + 8));

// 17 to 128 bytes, from both ends inwards.
function hashShort(input) {
  const length = input.byteLength;
  let sum = BigInt(length) * kPrime64[0];
  for (let i = Math.ceil(length / 32) - 1; i >= 0; --i) {
    sum += mix16(input, 16 * i, 32 * i) + mix16(input, length - 16 * (i + 1), 32 * i + 16);
  }
  return avalanche(wrap(sum));
}

function hashMiddle(input) {
  const length = input.byteLength;
  let sum = BigInt(length) * kPrime64[0];
  for (let i = 0; i < 8; ++i) sum += mix16(input, 16 * i, 16 * i);
  sum = avalanche(wrap(sum));
  for (let i = 8; i < length >> 4; ++i) sum += mix16(input, 16 * i, 16 * (i - 8) + 3);
  return avalanche(wrap(sum + mix16(input, length - 16, 136 - 17)));
}

// Eight sums of 64 bits, in halves.
class Lanes {
  constructor() {
    const start = [BigInt(kPrime32[2]), ...kPrime64.slice(0, 4), BigInt(kPrime32[1]), kPrime64[4],
                   BigInt(kPrime32[0])];
    this.low = Uint32Array.from(start, (x) => Number(x & 0xffffffffn));
    this.high = Uint32Array.from(start, (x) => Number(x >> 32n));
  }

  add(lane, low, high) {
    const sum = this.low[lane] + low;
    this.low[lane] = sum;
    this.high[lane] = this.high[lane] + high + (sum > 0xffffffff ? 1 : 0) | 0;
  }

  // a b, of 32 bits each.
  addProduct(lane, a, b) {
    const al = a & 0xffff, ah = a >>> 16, bl = b & 0xffff, bh = b >>> 16;
    const ll = Math.imul(al, bl), lh = Math.imul(al, bh), hl = Math.imul(ah, bl);
    const middle = (ll >>> 16) + (lh & 0xffff) + (hl & 0xffff);
    this.add(lane, (middle << 16 | ll & 0xffff) >>> 0,
             Math.imul(ah, bh) + (lh >>> 16) + (hl >>> 16) + (middle >>> 16) | 0);
  }

  takeStripe(input, at, secret) {
    for (let i = 0; i < 8; ++i) {
      const low = input.getUint32(at + 8 * i, true), high = input.getUint32(at + 8 * i + 4, true);
      this.add(i ^ 1, low, high);
      this.addProduct(i, (low ^ kSecretView.getUint32(secret + 8 * i, true)) >>> 0,
                      (high ^ kSecretView.getUint32(secret + 8 * i + 4, true)) >>> 0);
    }
  }

  scramble() {
    const secret = kSecret.length - kStripe;
    for (let i = 0; i < 8; ++i) {
      const low = (this.low[i] ^ this.high[i] >>> 15 ^
        kSecretView.getUint32(secret + 8 * i, true)) >>> 0;
      const high = this.high[i] ^ kSecretView.getUint32(secret + 8 * i + 4, true);
      this.low[i] = 0;
      this.high[i] = Math.imul(high, kPrime32[0]);
      this.addProduct(i, low, kPrime32[0]);
    }
  }

  at(lane) {
    return BigInt(this.high[lane]) << 32n | BigInt(this.low[lane]);
  }
}

function hashLong(input) {
  const lanes = new Lanes(), length = input.byteLength;
  const blocks = Math.floor((length - 1) / kBlock);
  for (let at = 0; at < blocks * kBlock; at += kStripe) {
    lanes.takeStripe(input, at, at % kBlock / 8);
    if (at % kBlock === kBlock - kStripe) lanes.scramble();
  }
  const stripes = Math.floor((length - 1 - blocks * kBlock) / kStripe);
  for (let i = 0; i < stripes; ++i) lanes.takeStripe(input, blocks * kBlock + kStripe * i, 8 * i);
  lanes.takeStripe(input, length - kStripe, kSecret.length - kStripe - 7);
  let sum = BigInt(length) * kPrime64[0];
  for (let i = 0; i < 4; ++i) {
    sum += foldedProduct(lanes.at(2 * i) ^ secretAt(11 + 16 * i),
                         lanes.at(2 * i + 1) ^ secretAt(19 + 16 * i));
  }
  return avalanche(wrap(sum));
}
