// SPDX-License-Identifier: BSD-3-Clause
// What the page for relighting computes, without a browser.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { coefficientsOf, evaluateRow, prepareLight } from '../../viewer/web/relight/evaluation.js';
import { gainFor } from '../../viewer/web/relight/exposure.js';
import { halfValue } from '../../viewer/web/relight/half_floats.js';
import { parseRelightable } from '../../viewer/web/relight/lfr_file.js';
import { makeTables } from '../../viewer/web/relight/model_tables.js';
import { readSettings } from '../../viewer/web/relight/settings.js';
import { xxh3 } from '../../viewer/web/relight/xxh3.js';
import { ModelError } from '../../viewer/web/src/model_error.js';
import {
  denseRows, halfBits, tinyContent, withChecksums, writeRelightable,
} from './tiny_relightable.mjs';

const kValue_rel = 1e-12;

const parse = (bytes) => parseRelightable(new Uint8Array(bytes), 'm.lfr');

function fails(act, expected) {
  assert.throws(act, (error) => {
    assert.ok(error instanceof ModelError, String(error.stack));
    assert.match(error.message, expected);
    assert.ok(error.message.startsWith('m.lfr: ') && !error.message.includes('\n'));
    return true;
  });
}

const edited = (edit) => {
  const content = tinyContent();
  edit(content);
  return content;
};

test('halfValue: every kind of float16', () => {
  for (const [bits, value] of [[0, 0], [0x3c00, 1], [0xc000, -2], [0x7bff, 65504], [1, 2 ** -24],
                               [0x03ff, 1023 * 2 ** -24], [0x0400, 2 ** -14], [0x3555, 1365 / 4096],
                               [0x7c00, Infinity], [0xfc00, -Infinity]]) {
    assert.equal(halfValue(bits), value);
    if (Number.isFinite(value)) assert.equal(halfBits(value), bits);
  }
  assert.equal(Object.is(halfValue(0x8000), -0), true);
  assert.ok(Number.isNaN(halfValue(0x7e00)));
});

// From xxhash 0.8.1.
test('xxh3: is that of the library, short, middle and long', () => {
  const expected = {
    24: '1ad5119b2a87c861',
    32: '774140158f21ff0a',
    64: '70a70e66815e67e5',
    96: 'a97f9ae93c0ff67a',
    128: '421a9c905c6e66ba',
    136: 'e6f83ba76622cc5e',
    240: 'b714c5fd22744964',
    248: '740fb910001724b2',
    1024: '1fd15e7d36f5e1bc',
    1032: '1db5f5effb6308f2',
    1096: 'c1e37fb5f11dcf72',
    2048: '81ec4a6a9ee23d55',
  };
  for (const [length, digits] of Object.entries(expected)) {
    const bytes = Uint8Array.from({ length: Number(length) }, (_, i) => Math.imul(i, 2654435761) >>> 13);
    assert.equal(xxh3(bytes).toString(16), digits, length);
  }
});

test('parseRelightable: a file gives its content', () => {
  const model = parse(writeRelightable(tinyContent()));
  assert.equal(model.name, 'tiny');
  assert.deepEqual([model.kind, model.channels, model.width, model.height, model.points,
                    model.columns, model.mostResiduals], [0, 3, 3, 2, 6, 4, 2]);
  assert.deepEqual([...model.directions].slice(9), [0.6, 0, 0.8]);
  assert.deepEqual([...model.firstWeight].slice(0, 4), [0, 2, 3, 5]);
  assert.deepEqual([...model.firstResidual].slice(0, 5), [0, 0, 1, 3, 3]);
  assert.equal(model.columnBasis, null);
});

test('parseRelightable: bytes that lie askew are read as well', () => {
  const bytes = writeRelightable(tinyContent()), askew = new Uint8Array(bytes.length + 3);
  askew.set(bytes, 3);
  const model = parseRelightable(askew.subarray(3), 'm.lfr');
  assert.deepEqual([...model.directions], [...parse(bytes).directions]);
  assert.deepEqual([...model.weights], [...parse(bytes).weights]);
});

test('parseRelightable: every prefix is refused, and so is more', () => {
  const whole = writeRelightable(tinyContent());
  for (let length = 0; length < whole.length; ++length) {
    fails(() => parse(whole.subarray(0, length)), /not a model for relighting|cut short|should have/);
  }
  fails(() => parse(Buffer.concat([whole, Buffer.alloc(8)])), /should have/);
});

test('parseRelightable: heads that cannot be are refused before memory is taken', () => {
  const cases = [
    [{ version: 2 }, /version 2; this page reads version 1/],
    [{ kind: 3 }, /unknown kind/],
    [{ channels: 2 }, /2 channels/],
    [{ points: 0 }, /0 points/],
    [{ points: 2n ** 63n }, /points; it must be/],
    [{ columns: 0 }, /0 columns/],
    [{ columns: 65537 }, /columns; it must be/],
    [{ columns: 5 }, /4 directions for 5 columns/],
    [{ directions: 0 }, /0 directions/],
    [{ clusters: 0 }, /0 clusters/],
    [{ clusters: 0xffffffff }, /clusters; it must be/],
    [{ functions: 2n ** 64n - 1n }, /2\^40 entries/],
    [{ weights: 2n ** 41n }, /2\^40 entries/],
    [{ weights: 2n ** 40n }, /contradict/],
    [{ residuals: 2n ** 39n }, /contradict/],
    [{ positions: 5 }, /some of its points/],
    [{ nameBytes: 5000 }, /name of more than/],
    [{ weightExponent: 121 }, /scale out of range/],
    [{ residualExponent: -171 }, /scale out of range/],
    [{ hasBasis: 2 }, /marks that contradict/],
    [{ countBytes: 3 }, /marks that contradict/],
    [{ countBytes: 0 }, /marks that contradict/],
    [{ entries: 1 }, /marks that contradict/],
    [{ zero: 1 }, /marks that contradict/],
    [{ width: 0 }, /picture of 0 x 2/],
    [{ width: 2 }, /picture of 2 x 2 pixels for 6 points/],
    [{ width: 4000000000, height: 4000000000 }, /picture of/],
    [{ fileBytes: 2n ** 60n }, /contradict/],
  ];
  for (const [change, expected] of cases) {
    fails(() => parse(writeRelightable(tinyContent(), (head) => Object.assign(head, change))),
          expected);
  }
  // Sizes that agree with each other, of a file that is not there.
  fails(() => parse(writeRelightable(tinyContent(), (head) => {
    Object.assign(head, { residuals: head.residuals + 2 ** 30, fileBytes: head.fileBytes + 3 * 2 ** 30 });
  })), /should have|contradict/);
});

test('parseRelightable: content that contradicts itself is refused', () => {
  const cases = [
    [(c) => { c.directions[1] = [0, 1.1, 0]; }, /direction 1 is not of unit length/],
    [(c) => { c.directions[2] = [0, NaN, 1]; }, /direction 2 is not of unit length/],
    [(c) => { c.terms = [2, 2]; }, /terms that there are/],
    [(c) => { c.terms = [0xffffffff, 2]; }, /terms that there are/],
    [(c) => { c.functionExponents[1] = 121; }, /scale is out of range/],
    [(c) => { c.functionExponents[1] = -171; }, /scale is out of range/],
    [(c) => { c.functions[0][0] = 32768; c.functionExponents[0] = 113; }, /out of the range/],
    [(c) => { c.weights[0] = 32768; c.weightExponent = 113; }, /weight is out of the range/],
    [(c) => { c.cluster[7] = 2; }, /cluster that is not there/],
    [(c) => { c.cluster[0] = 1; }, /weights that there are/],
    [(c) => { c.residuals[2][0] = [4, 1]; }, /beyond its columns/],
    [(c) => { c.countBytes = 2; }, null],
  ];
  for (const [edit, expected] of cases) {
    const bytes = writeRelightable(edited(edit));
    if (expected === null) parse(bytes);
    else fails(() => parse(bytes), expected);
  }
  const bytes = writeRelightable(tinyContent());
  const counts = bytes.length - 2 * 24 - 24; // a row each, before columns and values
  bytes[counts] = 5;
  fails(() => parse(withChecksums(bytes)), /residuals that there are/);
});

test('parseRelightable: numbers that are not finite are refused wherever they stand', () => {
  const whole = writeRelightable(tinyContent());
  const sections = parse(whole);
  for (const key of ['functions', 'weights', 'residualValue']) {
    for (const bits of [0x7c00, 0xfc00, 0x7e01]) {
      const bytes = new Uint8Array(whole);
      new Uint16Array(bytes.buffer, sections[key].byteOffset, 1)[0] = bits;
      fails(() => parse(withChecksums(bytes)), /a number is not finite/);
    }
  }
});

test('parseRelightable: a column basis that leaves its tables is refused', () => {
  const basis = [[[0, 1], [1, 0.5]], [[2, -1]], [], [[3, 2]]];
  assert.deepEqual([...parse(writeRelightable(edited((c) => { c.basis = basis; }))).columnBasis.first],
                   [0, 2, 3, 3, 4]);
  for (const entry of [[4, 1], [0xffffffff, 1], [0, Infinity], [0, NaN]]) {
    const bad = [[entry, [1, 0.5]], ...basis.slice(1)];
    fails(() => parse(writeRelightable(edited((c) => { c.basis = bad; }))), /column basis has an entry/);
  }
  const whole = writeRelightable(edited((c) => { c.basis = basis; }));
  const first = 136 + 8 + 4 * 24;
  for (const [at, value, expected] of [[0, 1, /do not fit/], [8, 4, /goes backwards/],
                                       [32, 5, /do not fit/], [12, 1, /goes backwards/]]) {
    const bytes = Buffer.from(whole);
    bytes.writeUInt32LE(value, first + at);
    fails(() => parse(withChecksums(bytes)), expected);
  }
});

test('parseRelightable: damage anywhere is seen, and harmless where somebody hides it', () => {
  const whole = writeRelightable(edited((c) => { c.basis = [[[0, 1]], [[1, 1]], [[2, 1]], [[3, 1]]]; }));
  for (let at = 0; at < whole.length; ++at) {
    for (const value of [0, 0x7f, 0xff]) {
      const bytes = Buffer.from(whole);
      bytes[at] = value;
      if (value !== whole[at]) {
        fails(() => parse(bytes), /not a model|version|header is damaged|content is damaged/);
      }
      let model;
      try {
        model = parse(withChecksums(bytes));
      } catch (error) {
        assert.ok(error instanceof ModelError, `${at}: ${error.stack}`);
        continue;
      }
      makeTables(model);
      const light = Array(model.channels).fill(Float64Array.from(model.directions.slice(0, 4)));
      const prepared = prepareLight(model, light);
      for (let row = 0; row < model.cluster.length; ++row) {
        assert.ok(Number.isFinite(evaluateRow(model, row, prepared[0])), `byte ${at} = ${value}`);
      }
    }
  }
});

function expectNear(found, expected) {
  assert.ok(Math.abs(found - expected) <= kValue_rel * Math.max(1, Math.abs(expected)),
            `${found} instead of ${expected}`);
}

for (const [what, basis] of [['directions', null],
                             ['a column basis', [[[0, 0.5], [1, 0.5]], [[0, 1], [3, -1]], [], [[2, 3]]]]]) {
  test(`evaluateRow: is the dense product, over ${what}`, () => {
    const content = edited((c) => { c.basis = basis; });
    const model = parse(writeRelightable(content)), dense = denseRows(content);
    const light = [[1, 2, -0.5, 0], [0, 0, 0, 3], [1, 1, 1, 1]];
    const prepared = prepareLight(model, light);
    dense.forEach((columns, row) => {
      const channel = Math.floor(row / 6);
      const expected = columns.reduce((sum, value, i) => sum + value * light[channel][i], 0);
      expectNear(evaluateRow(model, row, prepared[channel]), expected);
    });
  });
}

test('evaluateRow: takes the first residuals', () => {
  const content = tinyContent(), light = [[1, 2, 4, 8]];
  const model = parse(writeRelightable(content));
  const [prepared] = prepareLight(model, [...light, ...light, ...light]);
  for (const count of [0, 1, 2, 3]) {
    const cut = edited((c) => { c.residuals = c.residuals.map((own) => own.slice(0, count)); });
    denseRows(cut).forEach((columns, row) => {
      expectNear(evaluateRow(model, row, prepared, count),
                 columns.reduce((sum, value, i) => sum + value * light[0][i], 0));
    });
  }
});

test('coefficientsOf: reads every function of the basis', () => {
  const model = parse(writeRelightable(edited((c) => {
    c.basis = [[[0, 2], [3, -1]], [], [[1, 0.5]], [[0, 1], [1, 1], [2, 1], [3, 1]]];
  })));
  assert.deepEqual([...coefficientsOf(model, [1, 10, 100, 1000])], [-998, 0, 5, 1111]);
});

test('makeTables: holds rows in groups of four', () => {
  const content = tinyContent();
  const model = parse(writeRelightable(content)), { rows, weights, residuals } = makeTables(model);
  let weight = 0;
  content.cluster.forEach((cluster, row) => {
    const [firstGroup, firstFunction, residualGroup, counts] = rows.slice(4 * row, 4 * row + 4);
    assert.equal(firstFunction, [0, 2][cluster]);
    assert.equal(counts & 0xffff, content.terms[cluster]);
    assert.equal(counts >>> 16, content.residuals[row].length);
    for (let t = 0; t < 4; ++t) {
      const expected = t < content.terms[cluster] ? content.weights[weight++] : 0;
      assert.equal(halfValue(weights[4 * firstGroup + t]), expected);
    }
    content.residuals[row].forEach(([column, value], i) => {
      const entry = residuals[4 * residualGroup + i];
      assert.deepEqual([entry >>> 16, halfValue(entry & 0xffff)], [column, value]);
    });
  });
});

test('gainFor: brings the bright part of a picture to one level, at any scale', () => {
  const gainOf = (exponent) => {
    const model = parse(writeRelightable(edited((c) => {
      c.weightExponent = exponent;
      c.residualExponent = exponent;
    })));
    return gainFor(model, [Array(3).fill([1, 1, 1, 1])]) * 2 ** exponent;
  };
  assert.ok(gainOf(0) > 0);
  expectNear(gainOf(-100), gainOf(0));
  expectNear(gainOf(90), gainOf(0));
  const black = parse(writeRelightable(tinyContent()));
  assert.equal(gainFor(black, [Array(3).fill([0, 0, 0, 0])]), 1);
});

test('readSettings: takes what makes sense', () => {
  const settings = readSettings('#light=0,3,4&turn=30&residuals=5&exposure=-1.5&around=sky&gain=2');
  assert.deepEqual(settings, { background: '181a1f', panel: '1', light: [0, 0.6, 0.8], turn: 30,
                               residuals: 5, exposure: -1.5, around: 'sky', gain: 2 });
  const { light, turn, residuals, gain, background } =
    readSettings('#light=0,0,0&turn=x&residuals=-1&gain=Infinity&background=red&light=1,2');
  assert.deepEqual([light, turn, residuals, gain, background],
                   [undefined, 0, undefined, undefined, '181a1f']);
});
