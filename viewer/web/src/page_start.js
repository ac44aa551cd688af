// SPDX-License-Identifier: BSD-3-Clause
// How a page begins, and what becomes of errors.
import { ModelError } from './model_error.js';

/** One line, fit to be shown. */
export function messageOf(error) {
  return error instanceof ModelError ? error.message
    : `this page could not show its model (${error?.message ?? error})`;
}

/** In the single file the model stands behind the script. */
export async function untilRead() {
  if (document.readyState !== 'loading') return;
  await new Promise((resolve) => document.addEventListener('DOMContentLoaded', resolve));
}

/**
 * Shows the app that `makeApp()` gives: {show(), fail(error), state(), set(settings)}. What goes
 * wrong, at any time, is said on the page. Pages that drive this one find it in `window.lfm`, with
 * what `drives(app)` adds; settings are those of the address.
 */
export function startPage(panel, makeApp, drives) {
  let app = null;
  const fail = (error) => {
    if (app !== null) app.fail(error);
    else panel.fail(messageOf(error));
  };
  window.addEventListener('error', (event) => fail(event.error ?? event));
  window.addEventListener('unhandledrejection', (event) => {
    event.preventDefault();
    fail(event.reason);
  });
  try {
    app = makeApp();
  } catch (error) {
    fail(error);
    window.lfm = {
      ready: Promise.resolve(),
      state: () => ({ error: messageOf(error) }),
    };
    return;
  }
  const ready = app.show().catch((error) => app.fail(error)).then(() => app.state());
  window.lfm = {
    ready,
    state: () => app.state(),
    set: (settings) => app.set(settings),
    ...drives(app),
  };
}
