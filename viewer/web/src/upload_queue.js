// SPDX-License-Identifier: BSD-3-Clause
// Which page of which light field goes to the device next.

// Pages are sent for a quarter of the time from draw to draw, within these limits.
const kLeastUploadMilliseconds = 12, kMostUploadMilliseconds = 100;
const kMostTexelsWaiting = 2 ** 25; // decoded, not yet sent: 128 MB

/**
 * Sends the pages of several LightFieldObjects within draws: mean views first, each of them whole,
 * then the first term of each, the second of each, and so on.
 */
export class UploadQueue {
  constructor() {
    this.objects = [];
    this.waiting = []; // those who wait for something to be sent
    this.frame = -1; // the draw that has sent its share: renderer.info.render.frame
    this.lastDraw = 0; // performance.now()
  }

  add(object) {
    this.objects.push(object);
  }

  /** Of an object that is not to be drawn any more. */
  remove(object) {
    this.objects = this.objects.filter((other) => other !== object);
    this.wake();
  }

  /** Whether so much waits that no more should be decoded. */
  get full() {
    return this.objects.reduce((sum, { maps }) => sum + maps.texelsWaiting, 0) > kMostTexelsWaiting;
  }

  /** Resolves when `condition()` holds; it is asked whenever something was sent. */
  async until(condition) {
    while (!condition()) await new Promise((resolve) => this.waiting.push(resolve));
  }

  wake() {
    for (const resolve of this.waiting.splice(0)) resolve();
  }

  /** To be called within draws, by every object: the first sends for all. */
  upload(renderer) {
    if (renderer.info.render.frame === this.frame) return;
    this.frame = renderer.info.render.frame;
    if (this.next() !== null) this.uploadPages(renderer);
    this.lastDraw = performance.now();
  }

  uploadPages(renderer) {
    const share = (performance.now() - this.lastDraw) / 4;
    const milliseconds =
      Math.min(Math.max(share, kLeastUploadMilliseconds), kMostUploadMilliseconds);
    const changed = new Set();
    const restore = setUnpacking(renderer.getContext()); // may wait for the device
    try {
      const until = performance.now() + milliseconds;
      let object = this.next();
      do { // one page at least: draws go on only where something changes
        changed.add(object);
        object.uploadPage(renderer);
        object = this.next();
      } while (object !== null && (object.loadedTerms < 0 || performance.now() < until));
    } finally {
      restore();
    }
    this.wake();
    // Not within a draw: listeners may want to draw at once.
    queueMicrotask(() => changed.forEach((object) => object.noteChange()));
  }

  // Of those with pages to send, the one that shows the fewest terms.
  next() {
    let first = null;
    for (const object of this.objects) {
      const fewer = first === null || object.loadedTerms < first.loadedTerms;
      if (fewer && object.maps.queue.length > 0) first = object;
    }
    return first;
  }
}

// three.js remembers what it has set, so that it has to be found as it was.
function setUnpacking(gl) {
  const wanted = [
    [gl.UNPACK_FLIP_Y_WEBGL, false],
    [gl.UNPACK_PREMULTIPLY_ALPHA_WEBGL, false],
    [gl.UNPACK_COLORSPACE_CONVERSION_WEBGL, gl.NONE],
    [gl.UNPACK_ALIGNMENT, 4],
    [gl.UNPACK_ROW_LENGTH, 0],
    [gl.UNPACK_IMAGE_HEIGHT, 0],
    [gl.UNPACK_SKIP_PIXELS, 0],
    [gl.UNPACK_SKIP_ROWS, 0],
    [gl.UNPACK_SKIP_IMAGES, 0],
  ];
  const before = wanted.map(([key]) => [key, gl.getParameter(key)]);
  for (const [key, value] of wanted) gl.pixelStorei(key, value);
  return () => before.forEach(([key, value]) => gl.pixelStorei(key, value));
}
