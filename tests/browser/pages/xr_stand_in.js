// A WebXR runtime for tests: `window.xrDevice` is the phone, its pose is set by hand. Only what a phone page uses.
(() => {
  /** @typedef {ReturnType<typeof device.viewerPose>} Pose */

  class Session extends EventTarget {
    visibilityState = "visible";
    #ended = false;

    updateRenderState() {
      // Nothing is drawn.
    }

    /** @param {string} type */
    async requestReferenceSpace(type) {
      return Object.assign(device.space, { type });
    }

    /** @param {(nowMs: number, frame: { session: Session, getViewerPose: () => Pose }) => void} callback */
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
    space: new EventTarget(), // "reset": its origin is somewhere else
    session: /** @type {Session | null} */ (null),

    viewerPose() {
      const { position, orientation } = this;
      const transform = { position: { ...position }, orientation: { ...orientation } };
      return { transform, emulatedPosition: !this.tracked };
    },
  };

  const system = {
    /** @param {string} mode */
    isSessionSupported: async (mode) => mode === "immersive-ar",
    requestSession: async () => (device.session = new Session()),
  };

  Object.assign(window, { xrDevice: device, XRWebGLLayer: class {} });
  Object.defineProperty(navigator, "xr", { value: system, configurable: true });
})();
