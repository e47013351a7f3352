// What is left of a scene where it is laid over another: what moves, in one translucent colour. Pure.

const OPAQUE = 0.995; // what is less is a shadow or a line
const OWN_SHARE = 0.25; // of a geom's own colour, so that its parts can be told apart
const ALPHA = 0.32;

const OVERLAY_RGB = Object.freeze([0.66, 0.42, 0.95]);

/**
 * The scene's description for an overlay; it points to the same numbers.
 * @param {SceneFile.Parsed} scene
 * @returns {SceneFile.Parsed}
 */
export function overlaid(scene) {
  const { geoms } = scene.description;
  const moving = geoms.filter(({ body, rgba }) => body >= 0 && (rgba[3] ?? 1) >= OPAQUE).map(tinted);
  return { ...scene, description: { ...scene.description, geoms: moving, ghosts: [], plumb_lines: [] } };
}

/** @param {SceneFile.Geom} geom */
function tinted(geom) {
  const rgb = OVERLAY_RGB.map((part, i) => OWN_SHARE * (geom.rgba[i] ?? 0) + (1 - OWN_SHARE) * part);
  const plain = { ...geom, rgba: [...rgb, ALPHA] };
  delete plain.texture;
  return plain;
}
