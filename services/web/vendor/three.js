// What the pages use of three.js: tools/page-libraries bundles it, with what it needs, into static/vendor/three.mjs.

export {
  BufferAttribute,
  BufferGeometry,
  ColorManagement,
  DataTexture,
  Group,
  LinearFilter,
  LinearMipmapNearestFilter,
  LinearSRGBColorSpace,
  Matrix4,
  Mesh,
  NoColorSpace,
  PerspectiveCamera,
  RepeatWrapping,
  Scene,
  ShaderMaterial,
  Vector3,
  WebGLRenderer,
} from "three";
