// Reads a scene, as the server sends it once: a description and the numbers that it points to (docs/protocol.md). Pure.

const MAGIC = "MSC1";
const START = 8;
const LARGEST_DESCRIPTION = 4 * 1024 * 1024;

/**
 * The scene in these bytes. Raises an Error where they are none.
 * @param {ArrayBuffer} bytes
 * @returns {SceneFile.Parsed}
 */
export function parseScene(bytes) {
  const magic = new TextDecoder().decode(bytes.slice(0, MAGIC.length));
  const length = bytes.byteLength >= START ? new DataView(bytes).getUint32(MAGIC.length, true) : 0;
  if (magic !== MAGIC || length > LARGEST_DESCRIPTION || START + length > bytes.byteLength) {
    throw new Error("What came as the scene is none.");
  }
  const text = new TextDecoder().decode(new Uint8Array(bytes, START, length));
  return { description: JSON.parse(text), bytes, start: START + length };
}

/**
 * A mesh's numbers: positions in metres, normals in 1/127 (four bytes each, the last unused), and indices.
 * @param {SceneFile.Parsed} scene
 * @param {SceneFile.MeshEntry} mesh
 */
export function meshArrays({ bytes, start }, mesh) {
  const { offset, vertices, indices, wide_indices: wide, origin_m: originM, step_m: stepM } = mesh;
  const packed = new Uint16Array(bytes, start + offset, 3 * vertices);
  const positions = Float32Array.from(packed, (value, i) => (originM[i % 3] ?? 0) + value * (stepM[i % 3] ?? 0));
  const normalsAt = start + offset + aligned(6 * vertices);
  const packedNormals = new Int8Array(bytes, normalsAt, 3 * vertices);
  const normals = new Int8Array(4 * vertices);
  for (let i = 0; i < packedNormals.length; i += 1) normals[i + Math.floor(i / 3)] = packedNormals[i] ?? 0;
  const indicesAt = normalsAt + aligned(3 * vertices);
  const index = wide ? new Uint32Array(bytes, indicesAt, indices) : new Uint16Array(bytes, indicesAt, indices);
  return { positions, normals, index };
}

/**
 * A texture's pixels, four bytes each. They come as differences to the pixel on their left.
 * @param {SceneFile.Parsed} scene
 * @param {SceneFile.Texture} texture
 */
export function texturePixels({ bytes, start }, { offset, width, height, channels }) {
  const differences = new Uint8Array(bytes, start + offset, width * height * channels);
  const pixels = new Uint8Array(width * height * 4).fill(255);
  const left = [0, 0, 0, 0];
  for (let pixel = 0; pixel < width * height; pixel += 1) {
    if (pixel % width === 0) left.fill(0);
    for (let channel = 0; channel < channels; channel += 1) {
      const value = ((left[channel] ?? 0) + (differences[pixel * channels + channel] ?? 0)) & 255;
      left[channel] = value;
      pixels[4 * pixel + channel] = value;
    }
  }
  return pixels;
}

/** @param {number} size */
const aligned = (size) => Math.ceil(size / 4) * 4;
