// SPDX-License-Identifier: BSD-3-Clause
// Checked access to the JSON and the accessors of a glTF source ({json, name, bufferView}).
import { ModelError } from './model_error.js';

const kComponents = {
  5121: Uint8Array,
  5123: Uint16Array,
  5125: Uint32Array,
  5126: Float32Array,
};
const kShapes = { SCALAR: 1, VEC2: 2, VEC3: 3, VEC4: 4 };
const kAnyIndex = 2 ** 31 - 1;

export const kUint8 = 5121, kUint16 = 5123, kUint32 = 5125, kFloat = 5126;

export class GltfDocument {
  constructor(source) {
    this.source = source;
  }

  require(condition, problem) {
    if (!condition) throw new ModelError(`${this.source.name}: ${problem}; run lfm-encode again`);
  }

  object(value, what) {
    this.require(value !== null && typeof value === 'object' && !Array.isArray(value),
                 `${what} is missing or no object`);
    return value;
  }

  list(value, what, length = -1) {
    this.require(Array.isArray(value), `${what} is missing or no list`);
    this.require(length < 0 || value.length === length, `${what} does not have one entry a term`);
    return value;
  }

  integer(value, what, low, high) {
    this.require(Number.isInteger(value) && value >= low && value <= high,
                 `${what} is missing or out of range`);
    return value;
  }

  index(value, what) {
    return this.integer(value, what, 0, kAnyIndex);
  }

  /**
   * The values of an accessor of one of `components` and of `shape`; `count` elements, or any
   * number where it is negative.
   */
  async accessor(index, what, components, shape, count = -1) {
    const name = `accessor "${what}"`;
    const accessor = this.source.json.accessors?.[this.index(index, name)];
    this.object(accessor, name);
    const fits =
      components.includes(accessor.componentType) && accessor.type === shape &&
      !('sparse' in accessor) && accessor.normalized !== true;
    this.require(fits, `${name} has another form`);
    this.index(accessor.count, name);
    this.require(count < 0 || accessor.count === count, `${name} has another length`);
    const offset = accessor.byteOffset === undefined ? 0 : this.index(accessor.byteOffset, name);
    const viewIndex = this.index(accessor.bufferView, name);
    const Values = kComponents[accessor.componentType];
    const elementBytes = Values.BYTES_PER_ELEMENT * kShapes[shape];
    const stride = this.source.json.bufferViews?.[viewIndex]?.byteStride ?? elementBytes;
    this.require(stride === elementBytes, `${name} is not packed tightly`);
    const bytes = await this.source.bufferView(viewIndex);
    const length = accessor.count * elementBytes;
    this.require(offset + length <= bytes.length, `${name} is longer than its buffer view`);
    // Copied: views of a file begin at multiples of 4 of the file, not of every buffer.
    return new Values(bytes.slice(offset, offset + length).buffer);
  }

  /** The same for floats, all of which are finite. */
  async floats(index, what, shape, count = -1) {
    const values = await this.accessor(index, what, [kFloat], shape, count);
    this.require(values.every(Number.isFinite), `accessor "${what}" holds what is not a number`);
    return values;
  }
}
