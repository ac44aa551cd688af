// SPDX-License-Identifier: BSD-3-Clause

/** What is wrong with a model or with the device that shows it: one line, fit to be shown. */
export class ModelError extends Error {
  constructor(message) {
    super(message);
    this.name = 'ModelError';
  }
}
