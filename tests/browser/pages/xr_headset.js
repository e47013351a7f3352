// An emulated headset for tests: `window.headset` is iwer's device; what it never does as devices do is mended here.
(() => {
  /** @type {any} */
  const { XRDevice, metaQuest3 } = /** @type {any} */ (window).IWER;
  const device = new XRDevice(metaQuest3, { stereoEnabled: true });
  device.installRuntime({ forceInstall: true });
  Object.defineProperty(XRPose.prototype, "emulatedPosition", { get: () => device.guesses === true }); // always, there
  device.position.set(0.4, 1.7, -0.2);
  Object.assign(window, { headset: device });
})();
