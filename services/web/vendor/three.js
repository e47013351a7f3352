// What the pages use of three.js: `make page-libraries` bundles it, with what it needs, into static/js/vendor/three.js.

export {
  BufferAttribute,
  BufferGeometry,
  ColorManagement,
  DataTexture,
  Group,
  LinearFilter,
  LinearMipmapNearestFilter,
  LinearSRGBColorSpace,
  Mesh,
  NoColorSpace,
  PerspectiveCamera,
  RepeatWrapping,
  Scene,
  ShaderMaterial,
  Vector3,
  WebGLRenderer,
} from "three";
