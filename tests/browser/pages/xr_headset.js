// An emulated headset for tests: `window.headset` is iwer's device; what it does otherwise than devices is mended here.
(() => {
  /** @type {any} */
  const { XRDevice, metaQuest3 } = /** @type {any} */ (window).IWER;
  const device = new XRDevice(metaQuest3, { stereoEnabled: true });
  device.installRuntime({ forceInstall: true });
  Object.defineProperty(XRPose.prototype, "emulatedPosition", { get: () => device.guesses === true }); // always, there
  device.position.set(0.4, 1.7, -0.2);

  // Both eyes of a scene take a processor half a second where others are busy, too: only what is looked at is drawn.
  device.draws = false;
  const { drawElements } = WebGL2RenderingContext.prototype;
  WebGL2RenderingContext.prototype.drawElements = function draw(...what) {
    if (device.draws) drawElements.apply(this, what);
  };
  Object.assign(window, { headset: device });
})();
