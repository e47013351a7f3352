// One shader that lights and textures as MuJoCo's renderer does, so that a picture drawn here is like the server's.
//
// Light is computed at the corners, in gamma space, and clamped before the texture multiplies it. What is transparent
// is drawn twice over there, which one draw does here with 1 - (1 - a)². Directions are kept in world axes.

import {
  DataTexture,
  LinearFilter,
  LinearMipmapNearestFilter,
  NoColorSpace,
  RepeatWrapping,
  ShaderMaterial,
  Vector3,
} from "../../vendor/three.mjs";
import { texturePixels } from "./scene-file.js";

const OPAQUE = 0.995; // what MuJoCo takes for opaque

const VERTEX = `
uniform vec4 rgba;
uniform float emission, specular, shininess;
uniform vec3 headlightDirection;
uniform vec3 ambient[LIGHTS], diffuse[LIGHTS], gloss[LIGHTS], direction[LIGHTS];
varying vec4 lit;
#ifdef TEXTURED
uniform vec2 textureScale;
varying vec2 place;
#endif

void main() {
  vec4 eye = modelViewMatrix * vec4(position, 1.0);
  vec3 n = normalize(normalMatrix * normal);
  vec3 toEye = normalize(-eye.xyz);
  vec3 color = emission * rgba.rgb;
  for (int i = 0; i < LIGHTS; i++) {
    vec3 way = i == HEADLIGHT ? headlightDirection : direction[i];
    vec3 toLight = normalize((viewMatrix * vec4(-way, 0.0)).xyz);
    float slope = max(dot(n, toLight), 0.0);
    color += rgba.rgb * (ambient[i] + diffuse[i] * slope);
    float shine = max(dot(n, normalize(toLight + toEye)), 0.0);
    if (slope > 0.0 && shine > 0.0) color += specular * gloss[i] * pow(shine, shininess);
  }
  lit = vec4(clamp(color, 0.0, 1.0), rgba.a);
#ifdef TEXTURED
  place = vec2(position.x, -position.y) * textureScale - 0.5;
#endif
  gl_Position = projectionMatrix * eye;
}`;

const FRAGMENT = `
varying vec4 lit;
#ifdef TEXTURED
uniform sampler2D picture;
varying vec2 place;
#endif

void main() {
  vec4 color = lit;
#ifdef TEXTURED
  color *= texture2D(picture, place);
#endif
  float through = 1.0 - color.a;
  gl_FragColor = vec4(color.rgb, 1.0 - through * through);
}`;

/** Makes the materials of one scene. `headlightDirection`: where the camera looks, in world axes. */
export class Materials {
  headlightDirection = new Vector3(0, 0, -1);
  #textures;
  #lights;
  #defines;
  /** @type {ShaderMaterial[]} */
  #made = [];

  /** @param {SceneFile.Parsed} scene */
  constructor(scene) {
    const { headlight, lights, textures } = scene.description;
    const all = [...(headlight ? [{ ...headlight, direction: [0, 0, -1] }] : []), ...lights];
    this.#lights = {
      ambient: { value: all.map(({ ambient }) => new Vector3(...ambient)) },
      diffuse: { value: all.map(({ diffuse }) => new Vector3(...diffuse)) },
      gloss: { value: all.map(({ specular }) => new Vector3(...specular)) },
      direction: { value: all.map(({ direction }) => new Vector3(...direction)) },
      headlightDirection: { value: this.headlightDirection },
    };
    this.#defines = { LIGHTS: all.length, HEADLIGHT: headlight ? 0 : -1 };
    this.#textures = textures.map((texture) => madeTexture(scene, texture));
  }

  /**
   * The material of a geom.
   * @param {SceneFile.Geom} geom
   */
  of({ rgba, emission, specular, shininess, texture, texture_scale: scale = [1, 1] }) {
    const picture = texture === undefined ? null : (this.#textures[texture] ?? null);
    const transparent = (rgba[3] ?? 1) < OPAQUE;
    const material = new ShaderMaterial({
      defines: { ...this.#defines, ...(picture && { TEXTURED: 1 }) },
      uniforms: {
        ...this.#lights,
        rgba: { value: rgba },
        emission: { value: emission },
        specular: { value: specular },
        shininess: { value: shininess },
        ...(picture && { picture: { value: picture }, textureScale: { value: scale } }),
      },
      vertexShader: VERTEX,
      fragmentShader: FRAGMENT,
      transparent,
      depthWrite: !transparent,
    });
    this.#made.push(material);
    return material;
  }

  /** Gives back what the materials hold of the graphics card. */
  dispose() {
    for (const held of [...this.#made, ...this.#textures]) held.dispose();
  }
}

/**
 * @param {SceneFile.Parsed} scene
 * @param {SceneFile.Texture} texture
 */
function madeTexture(scene, texture) {
  const made = new DataTexture(texturePixels(scene, texture), texture.width, texture.height);
  made.wrapS = RepeatWrapping;
  made.wrapT = RepeatWrapping;
  made.magFilter = LinearFilter;
  made.minFilter = LinearMipmapNearestFilter;
  made.generateMipmaps = true;
  made.colorSpace = NoColorSpace;
  made.needsUpdate = true;
  return made;
}
