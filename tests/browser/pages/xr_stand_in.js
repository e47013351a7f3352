// A WebXR runtime for tests: `window.xrDevice` is the phone, its pose is set by hand. Only what a phone page uses.
(() => {
  class Session extends EventTarget {
    visibilityState = "visible";
    #ended = false;

    updateRenderState(state) {
      this.renderState = state;
    }

    async requestReferenceSpace(type) {
      return { type };
    }

    requestAnimationFrame(callback) {
      return window.requestAnimationFrame((nowMs) => {
        if (!this.#ended) callback(nowMs, { session: this, getViewerPose: () => device.viewerPose() });
      });
    }

    async end() {
      this.#ended = true;
      this.dispatchEvent(new Event("end"));
    }
  }

  const device = {
    position: { x: 0, y: 1.4, z: 0 },
    orientation: { x: 0, y: 0, z: 0, w: 1 },
    tracked: true, // false: the runtime guesses the position
    session: null,

    viewerPose() {
      const { position, orientation } = this;
      return { transform: { position: { ...position }, orientation: { ...orientation } }, emulatedPosition: !this.tracked };
    },
  };

  const system = {
    isSessionSupported: async (mode) => mode === "immersive-ar",
    requestSession: async () => (device.session = new Session()),
  };

  window.xrDevice = device;
  window.XRWebGLLayer = class {};
  Object.defineProperty(navigator, "xr", { value: system, configurable: true });
})();
