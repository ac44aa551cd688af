// SPDX-License-Identifier: BSD-3-Clause
// Binary glTF from memory or from a stream: a buffer view can be read as soon as its bytes are
// there. Trusts nothing: what the file says of its size is checked before it is used.
import { ModelError } from './model_error.js';

const kMagic = 0x46546c67; // "glTF"
const kJsonChunk = 0x4e4f534a;
const kBinaryChunk = 0x004e4942;
const kHeaderBytes = 12;
const kChunkHeaderBytes = 8;
const kMaxBytes = 2 ** 31 - 1;
const kFirstCapacity = 1 << 20;
const kCure = 'run lfm-encode again';

/** Bytes that arrive; grows as they do, whatever length the file claims. */
class ArrivingBytes {
  constructor(name) {
    this.name = name;
    this.bytes = new Uint8Array(0);
    this.length = 0;
    this.ended = false;
    this.error = null;
    this.waiting = [];
  }

  reserve(capacity) {
    if (capacity <= this.bytes.length) return;
    const grown = new Uint8Array(capacity);
    grown.set(this.bytes.subarray(0, this.length));
    this.bytes = grown;
  }

  append(chunk) {
    const needed = this.length + chunk.length;
    if (needed > kMaxBytes) throw new ModelError(`${this.name}: larger than a browser can hold`);
    if (needed > this.bytes.length) {
      this.reserve(Math.min(kMaxBytes, Math.max(needed, 2 * this.bytes.length, kFirstCapacity)));
    }
    this.bytes.set(chunk, this.length);
    this.length = needed;
    this.wake();
  }

  end(error = null) {
    this.ended = true;
    this.error = error;
    this.wake();
  }

  wake() {
    const still = [];
    for (const waiter of this.waiting) {
      if (this.length >= waiter.end) waiter.resolve();
      else if (this.ended) waiter.reject(this.shortage());
      else still.push(waiter);
    }
    this.waiting = still;
  }

  shortage() {
    return this.error ?? new ModelError(`${this.name}: not a GLB file, or cut off; ${kCure}`);
  }

  /** Resolves when the first `end` bytes are there. */
  until(end) {
    if (this.length >= end) return Promise.resolve();
    if (this.ended) return Promise.reject(this.shortage());
    return new Promise((resolve, reject) => this.waiting.push({ end, resolve, reject }));
  }
}

/**
 * A glTF document whose buffer views arrive: `json`, `name` (for messages) and
 * `bufferView(index)`, a promise of a Uint8Array. Anything of this form can be read.
 */
export class GlbSource {
  constructor(arriving, json, binaryStart, binaryBytes) {
    this.name = arriving.name;
    this.json = json;
    this.arriving = arriving;
    this.binaryStart = binaryStart;
    this.binaryBytes = binaryBytes;
  }

  /** Of a whole file in memory. */
  static fromBytes(bytes, name) {
    const arriving = new ArrivingBytes(name);
    arriving.bytes = new Uint8Array(bytes.buffer, bytes.byteOffset, bytes.byteLength);
    arriving.length = bytes.length;
    arriving.end();
    return parseHead(arriving);
  }

  /**
   * Of a ReadableStream of Uint8Arrays; resolves when the JSON is there, and reads on.
   * `declaredBytes`: length of the stream as the server says, if it does.
   * `onProgress(bytes, total)`: `total` is what the file says.
   */
  static async fromStream(stream, name, { declaredBytes = 0, onProgress = () => {} } = {}) {
    const arriving = new ArrivingBytes(name);
    readAll(stream, arriving, declaredBytes, onProgress);
    return parseHead(arriving);
  }

  /** Whether all of the file is there. */
  get whole() {
    return this.arriving.ended;
  }

  async bufferView(index) {
    const view = this.json.bufferViews?.[index];
    const offset = view?.byteOffset ?? 0;
    const length = view?.byteLength;
    const fits =
      Number.isSafeInteger(offset) && offset >= 0 && Number.isSafeInteger(length) && length >= 0 &&
      (view.buffer ?? 0) === 0 && offset + length <= this.binaryBytes;
    if (!fits) throw new ModelError(`${this.name}: a buffer view lies outside the file; ${kCure}`);
    const start = this.binaryStart + offset;
    await this.arriving.until(start + length);
    return this.arriving.bytes.subarray(start, start + length);
  }
}

async function readAll(stream, arriving, declaredBytes, onProgress) {
  const reader = stream.getReader();
  try {
    for (;;) {
      const { done, value } = await reader.read();
      if (done) break;
      arriving.append(value);
      if (arriving.length < kHeaderBytes) continue;
      const total = word(arriving.bytes, 8);
      // Two witnesses are believed; one alone could name any size.
      if (total === declaredBytes) arriving.reserve(Math.min(total, kMaxBytes));
      onProgress(arriving.length, total);
    }
    arriving.end();
  } catch (error) {
    const reason = error instanceof RangeError ? 'larger than this browser can hold; encode fewer terms'
      : 'the connection broke; load the page again';
    const problem = error instanceof ModelError ? error
      : new ModelError(`${arriving.name}: ${reason}`);
    arriving.end(problem);
    reader.cancel().catch(() => {});
  }
}

function word(bytes, at) {
  return new DataView(bytes.buffer, bytes.byteOffset + at, 4).getUint32(0, true);
}

async function parseHead(arriving) {
  const fail = (problem) => {
    throw new ModelError(`${arriving.name}: ${problem}; ${kCure}`);
  };
  await arriving.until(4);
  if (word(arriving.bytes, 0) !== kMagic) fail('not a GLB file');
  await arriving.until(kHeaderBytes + kChunkHeaderBytes);
  if (word(arriving.bytes, 4) !== 2) fail('not version 2 of GLB');
  const total = word(arriving.bytes, 8);
  if (arriving.ended && total !== arriving.length) fail('shorter or longer than it says');
  const jsonBytes = word(arriving.bytes, kHeaderBytes);
  if (word(arriving.bytes, kHeaderBytes + 4) !== kJsonChunk) {
    fail('GLB chunks are not JSON, then binary');
  }
  const jsonStart = kHeaderBytes + kChunkHeaderBytes;
  const binaryStart = jsonStart + jsonBytes + kChunkHeaderBytes;
  if (binaryStart > total) fail('a GLB chunk is cut off');
  await arriving.until(binaryStart);
  if (word(arriving.bytes, binaryStart - 4) !== kBinaryChunk) {
    fail('GLB chunks are not JSON, then binary');
  }
  const binaryBytes = word(arriving.bytes, binaryStart - kChunkHeaderBytes);
  if (binaryStart + binaryBytes !== total) fail('a GLB chunk is cut off');
  let json;
  try {
    const text = arriving.bytes.subarray(jsonStart, jsonStart + jsonBytes);
    json = JSON.parse(new TextDecoder('utf-8', { fatal: true }).decode(text));
  } catch {
    fail('its JSON is damaged');
  }
  if (json === null || typeof json !== 'object') fail('its JSON is damaged');
  return new GlbSource(arriving, json, binaryStart, binaryBytes);
}
