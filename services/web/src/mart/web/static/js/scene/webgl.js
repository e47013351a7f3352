// Who draws for WebGL on this device.

const SOFTWARE = /swiftshader|llvmpipe|softpipe|software|basic render/i;

/** Whether this renderer draws without a graphics card. @param {string} renderer */
export const isSoftware = (renderer) => SOFTWARE.test(renderer);

/** What a context's renderer is called. @param {WebGL2RenderingContext} gl */
export function rendererOf(gl) {
  const info = gl.getExtension("WEBGL_debug_renderer_info");
  return String(gl.getParameter(info ? info.UNMASKED_RENDERER_WEBGL : gl.RENDERER)) || "unnamed";
}

/** Who draws WebGL here, empty where nobody does. Asked before three.js is, which complains aloud. */
export function webglRenderer() {
  const gl = new OffscreenCanvas(1, 1).getContext("webgl2");
  if (!gl) return "";
  const name = rendererOf(gl);
  gl.getExtension("WEBGL_lose_context")?.loseContext(); // a page has sixteen
  return name;
}

/** There is no WebGL here: trying again would not help. */
export class WebGLMissing extends Error {}
