// Where the phone is, from WebXR: a session with the page as its overlay.

import { IDENTITY } from "../drive/quaternion.js";

/** @import { Quaternion, Vector } from "../drive/quaternion.js" */

/**
 * Where a hand is, as phone frames tell it; `flags`: the bits that say what the pose is.
 * @typedef {{ position: Vector, quaternionWxyz: Quaternion, tracking: boolean, flags: number }} Sample
 */

const STALE_MS = 150; // phones track at 30 to 60 Hz

/** Whether this browser can follow the phone through the room. */
export const canTrack = async () =>
  (await navigator.xr?.isSessionSupported("immersive-ar").catch(() => false)) ?? false;

/** A phone that is followed through the room. */
export class XrTracker {
  /** @type {Vector} */
  #position = [0, 0, 0];
  /** @type {Quaternion} */
  #quaternionWxyz = IDENTITY;
  #seenMs = -Infinity;
  #jumpedMs = -Infinity;
  #session;

  /**
   * Must be called from a press.
   * @param {HTMLElement} root what the person sees and touches
   * @param {() => void} onEnd called when the session is over
   */
  static async start(root, onEnd) {
    if (!navigator.xr) throw new Error("This browser has no WebXR.");
    const session = await navigator.xr.requestSession("immersive-ar", {
      requiredFeatures: ["local"],
      optionalFeatures: ["dom-overlay"],
      domOverlay: { root },
    });
    const tracker = new XrTracker(session);
    session.addEventListener("end", onEnd);
    root.addEventListener("beforexrselect", (event) => event.preventDefault());
    const gl = document.createElement("canvas").getContext("webgl", { xrCompatible: true });
    if (!gl) throw new Error("This browser cannot draw with WebGL.");
    session.updateRenderState({ baseLayer: new XRWebGLLayer(session, gl, { antialias: false, depth: false }) });
    const space = await session.requestReferenceSpace("local");
    space.addEventListener("reset", () => tracker.#jump(performance.now()));
    /** @type {XRFrameRequestCallback} */
    const onFrame = (_, frame) => {
      session.requestAnimationFrame(onFrame);
      tracker.#take(frame.getViewerPose(space), performance.now());
    };
    session.requestAnimationFrame(onFrame);
    return tracker;
  }

  /** @param {XRSession} session */
  constructor(session) {
    this.#session = session;
  }

  /**
   * The newest pose in the session frame; `tracking` only while the camera really knows where it is.
   * @param {number} nowMs
   * @returns {Sample}
   */
  sample(nowMs) {
    const known = nowMs - this.#seenMs < STALE_MS && nowMs - this.#jumpedMs > STALE_MS;
    const tracking = known && this.#session.visibilityState === "visible";
    return { position: this.#position, quaternionWxyz: this.#quaternionWxyz, tracking, flags: 0 };
  }

  /**
   * The runtime has found itself somewhere else: what was the same place has other coordinates from now on.
   * @param {number} nowMs
   */
  #jump(nowMs) {
    this.#jumpedMs = nowMs;
  }

  /**
   * @param {XRViewerPose | undefined} pose
   * @param {number} nowMs
   */
  #take(pose, nowMs) {
    if (!pose || pose.emulatedPosition) return;
    const { position: p, orientation: o } = pose.transform;
    this.#position = [p.x, p.y, p.z];
    this.#quaternionWxyz = [o.w, o.x, o.y, o.z];
    this.#seenMs = nowMs;
  }
}
