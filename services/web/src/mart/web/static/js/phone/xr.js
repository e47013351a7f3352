// Where the phone is, from WebXR: a session with the page as its overlay.

import { IDENTITY } from "../drive/quaternion.js";

const STALE_MS = 150; // phones track at 30 to 60 Hz

export const canTrack = async () =>
  Boolean(navigator.xr && (await navigator.xr.isSessionSupported("immersive-ar").catch(() => false)));

export class XrTracker {
  #position = [0, 0, 0];
  #quaternionWxyz = IDENTITY;
  #seenMs = -Infinity;

  /** Must be called from a press. `root` is what the person sees and touches; `onEnd()` when the session is over. */
  static async start(root, onEnd) {
    const session = await navigator.xr.requestSession("immersive-ar", {
      requiredFeatures: ["local"],
      optionalFeatures: ["dom-overlay"],
      domOverlay: { root },
    });
    const tracker = new XrTracker(session);
    session.addEventListener("end", onEnd);
    root.addEventListener("beforexrselect", (event) => event.preventDefault());
    const gl = document.createElement("canvas").getContext("webgl", { xrCompatible: true });
    session.updateRenderState({ baseLayer: new XRWebGLLayer(session, gl, { antialias: false, depth: false }) });
    const space = await session.requestReferenceSpace("local");
    const onFrame = (nowMs, frame) => {
      session.requestAnimationFrame(onFrame);
      tracker.#take(frame.getViewerPose(space), performance.now());
    };
    session.requestAnimationFrame(onFrame);
    return tracker;
  }

  constructor(session) {
    this.session = session;
  }

  /** The newest pose in the session frame; `tracking` only while the camera really knows where it is. */
  sample(nowMs) {
    const tracking = nowMs - this.#seenMs < STALE_MS && this.session.visibilityState === "visible";
    return { position: this.#position, quaternionWxyz: this.#quaternionWxyz, tracking, flags: 0 };
  }

  #take(pose, nowMs) {
    if (!pose || pose.emulatedPosition) return;
    const { position: p, orientation: o } = pose.transform;
    this.#position = [p.x, p.y, p.z];
    this.#quaternionWxyz = [o.w, o.x, o.y, o.z];
    this.#seenMs = nowMs;
  }
}
