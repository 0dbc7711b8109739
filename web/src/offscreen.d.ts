// What the TypeScript of Debian 12 does not know of browsers yet; later ones declare the same.

interface OffscreenCanvas extends EventTarget {
  width: number;
  height: number;
  getContext(kind: "webgl2", options?: WebGLContextAttributes): WebGL2RenderingContext | null;
}

declare var OffscreenCanvas: {
  prototype: OffscreenCanvas;
  new (width: number, height: number): OffscreenCanvas;
};

interface HTMLCanvasElement {
  transferControlToOffscreen(): OffscreenCanvas;
}

interface AbortController {
  abort(reason?: any): void;
}
