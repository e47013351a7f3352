// What a page draws: docs/protocol.md, sections "Scene" and "Body poses".

declare namespace SceneFile {
  type Numbers = number[];

  interface MeshEntry {
    offset: number;
    vertices: number;
    indices: number;
    wide_indices: boolean;
    origin_m: Numbers;
    step_m: Numbers;
  }

  interface Texture {
    offset: number;
    width: number;
    height: number;
    channels: number;
  }

  interface Geom {
    body: number;
    mesh: number;
    plane: boolean;
    position_m: Numbers;
    quaternion: Numbers;
    scale: Numbers;
    rgba: Numbers;
    emission: number;
    specular: number;
    shininess: number;
    texture?: number;
    texture_scale?: Numbers;
  }

  /** A line from a tool, at `position_m` of a body, down to `foot_m` of another; `geom`: a metre of it. */
  interface PlumbLine {
    body: number;
    position_m: Numbers;
    foot_body: number;
    foot_m: Numbers;
    geom: Geom;
  }

  /** What is shown until a subtask is done; `after`: by arm whose step it is, when which others are. */
  interface Ghost {
    subtask: string;
    after: Record<string, string[]>;
    geoms: Geom[];
  }

  interface Light {
    ambient: Numbers;
    diffuse: Numbers;
    specular: Numbers;
  }

  interface Camera {
    name: string;
    fov_y_deg: number;
    position_m: Numbers;
    quaternion: Numbers;
  }

  interface Description {
    bodies: string[];
    cameras: Camera[];
    near_m: number;
    far_m: number;
    geoms: Geom[];
    ghosts: Ghost[];
    headlight: Light | null;
    lights: (Light & { direction: Numbers })[];
    meshes: MeshEntry[];
    plumb_lines: PlumbLine[];
    textures: Texture[];
  }

  /** A parsed scene. `start`: where the buffer begins in `bytes`. */
  interface Parsed {
    description: Description;
    bytes: ArrayBuffer;
    start: number;
  }

  /** One tick's poses. `numbers`: seven a body, position in steps of `stepM` and quaternion wxyz in 1/32767. */
  interface Poses {
    scene: string;
    tick: number;
    stepM: number;
    numbers: Int16Array;
  }
}
