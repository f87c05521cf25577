// Declares the types of two parts of three.js's ColladaLoader that the page uses. No types are
// published.
declare module 'three/examples/jsm/loaders/collada/ColladaParser.js' {
  export interface Geometry {
    sources: Record<string, {array: ArrayLike<number>}>;
    primitives: {type: string; stride: number; p?: ArrayLike<number>; vcount?: ArrayLike<number>}[];
  }
  export interface Library {
    geometries: Record<string, Geometry>;
  }
  export class ColladaParser {
    // Returns null if the XML is not well-formed.
    parse(text: string): {library: Library; asset: {unit: number}; collada: Element} | null;
  }
}

declare module 'three/examples/jsm/loaders/collada/ColladaComposer.js' {
  import {Group, Texture} from 'three';
  import {Library} from 'three/examples/jsm/loaders/collada/ColladaParser.js';

  interface TextureSource {
    load(name: string): Texture;
  }
  export class ColladaComposer {
    constructor(library: Library, collada: Element, textures: TextureSource, tga: TextureSource);
    compose(): {scene: Group};
  }
}
