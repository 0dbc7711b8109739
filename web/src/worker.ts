// The renderer of one element, on a thread of its own: the page stays at the user's hand while a file is read and its light baked.

import candela, { type Module } from "./candela.js";
import { FileError, nameOf, Reader } from "./files.js";
import type { Call, Failure, FromWorker, Info, Look, Sight, Source, ToWorker } from "./messages.js";
import { decodePictures, picturesOf } from "./pictures.js";

declare const self: DedicatedWorkerGlobalScope;

/** What the module answers: a failure of its own is one line with its place. */
class ModuleError extends Error {
  constructor(readonly failure: Failure) {
    super(failure.message);
  }
}

function send(message: FromWorker, transfer: Transferable[] = []): void {
  self.postMessage(message, transfer);
}

function failureOf(error: unknown): Failure {
  if (error instanceof ModuleError) return error.failure;
  if (error instanceof FileError) return { message: error.message, where: error.where };
  return { message: error instanceof Error ? error.message : String(error), where: "" };
}

const kMostPixels = 4096 * 4096;

class Renderer {
  private look: Look = { sight: {} };
  private width = 1;
  private height = 1;
  private isLoaded = false;
  private isDirty = false;
  private isLost = false;
  private isBusy = false;
  private frameRequest = 0;
  private animation: { name: string; playing: boolean; time: number; from: number } | null = null;
  private shownTime: number | null = null;
  private info: Info | null = null;
  private folders = 0;
  private sceneFolder = "";
  private loading: AbortController | null = null;

  private constructor(
    private readonly module: Module,
    private readonly page: number,
    private readonly canvas: OffscreenCanvas,
    private readonly context: number,
  ) {
    canvas.addEventListener("webglcontextlost", (event) => {
      event.preventDefault(); // else it never comes back
      this.isLost = true;
      this.call({ call: "forget" }); // while it is lost nothing of it can be deleted wrongly
      send({ event: "context", lost: true });
    });
    canvas.addEventListener("webglcontextrestored", () => {
      this.restore();
    });
  }

  static async open(canvas: OffscreenCanvas): Promise<Renderer> {
    const context = canvas.getContext("webgl2", {
      alpha: false,
      antialias: false, // the renderer has its own samples
      depth: false,
      stencil: false,
      powerPreference: "high-performance",
    });
    if (context === null) throw new FileError("this browser or its graphics driver has no WebGL 2", "");
    const module = await candela({ print: () => undefined, printErr: () => undefined });
    const handle = module.GL.registerContext(context, { majorVersion: 2, minorVersion: 0 });
    module.GL.makeContextCurrent(handle);
    return new Renderer(module, module._candela_open(), canvas, handle);
  }

  private restore(): void {
    const known = this.module.GL.contexts[this.context];
    if (known !== undefined) {
      known.initExtensionsDone = false;
      this.module.GL.initExtensions(known);
    }
    const gl = this.canvas.getContext("webgl2");
    while (gl !== null && gl.getError() !== gl.NO_ERROR); // of calls that met no context
    this.isLost = false;
    send({ event: "context", lost: false });
    this.invalidate();
  }

  private call<T>(call: object): T {
    const { module } = this;
    const text = JSON.stringify(call);
    const bytes = module.lengthBytesUTF8(text) + 1;
    const at = module._malloc(bytes);
    if (at === 0) throw new ModuleError({ message: "the memory of a page does not suffice", where: "" });
    module.stringToUTF8(text, at, bytes);
    let answer: { result?: T; warnings?: string[]; error?: Failure };
    try {
      // Files are called as the page knows them, without the folder that only this worker has.
      answer = JSON.parse(module.UTF8ToString(module._candela_call(this.page, at)).replace(/\/files\/\d+\//g, ""));
    } finally {
      module._free(at);
    }
    if (answer.error !== undefined) throw new ModuleError(answer.error);
    if (answer.warnings !== undefined && answer.warnings.length > 0) send({ event: "warnings", texts: answer.warnings });
    return answer.result as T;
  }

  // ----- drawing

  resize(width: number, height: number): void {
    const scale = Math.min(1, Math.sqrt(kMostPixels / (width * height)));
    this.width = Math.max(1, Math.round(width * scale));
    this.height = Math.max(1, Math.round(height * scale));
    this.invalidate();
  }

  setLook(look: Look): void {
    this.look = look;
    this.invalidate();
  }

  invalidate(): void {
    this.isDirty = true;
    if (this.frameRequest === 0) this.frameRequest = self.requestAnimationFrame(() => this.frame());
  }

  private frame(): void {
    this.frameRequest = 0;
    if (!this.isLoaded || this.isLost || this.isBusy) return;
    try {
      this.pose();
      if (this.isDirty) this.draw();
    } catch (error) {
      this.isDirty = false;
      if (this.animation !== null) this.animation.playing = false;
      send({ event: "failed", failure: failureOf(error) });
    }
    if (this.animation?.playing === true) this.invalidate();
  }

  private pose(): void {
    const { animation } = this;
    if (animation === null) {
      if (this.shownTime === null) return;
      this.shownTime = null;
      this.call({ call: "pose" });
      this.isDirty = true;
      return;
    }
    const now = performance.now() / 1000;
    const length = this.durationOf(animation.name);
    if (animation.playing && length > 0) animation.time = (animation.time + now - animation.from) % length;
    animation.from = now;
    if (this.shownTime === animation.time) return;
    this.shownTime = animation.time;
    this.call({ call: "pose", animation: animation.name, time: animation.time });
    this.isDirty = true;
  }

  private durationOf(name: string): number {
    const all = this.info?.animations ?? [];
    if (name === "all") return Math.max(0, ...all.map((one) => one.duration));
    const found = all.find((one, i) => one.name === name || String(i) === name) ?? (name === "" ? all[0] : undefined);
    return found?.duration ?? 0;
  }

  private lookCall(): object {
    const { sight, exposure, tonemap } = this.look;
    return { sight, ...(exposure === undefined ? {} : { exposure }), ...(tonemap === undefined ? {} : { tonemap }) };
  }

  private draw(): void {
    const before = performance.now();
    this.isDirty = false;
    if (this.canvas.width !== this.width) this.canvas.width = this.width;
    if (this.canvas.height !== this.height) this.canvas.height = this.height;
    const sight = this.call<Required<Pick<Sight, "azimuth" | "elevation" | "scale">>>({
      call: "draw",
      width: this.width,
      height: this.height,
      ...this.lookCall(),
    });
    send({ event: "frame", sight, milliseconds: performance.now() - before });
  }

  // ----- files

  /** Fetches or reads what a scene consists of into a new folder; returns the path of the file itself. */
  private async take(source: Source, reader: Reader): Promise<{ path: string; bytes: Uint8Array; beside: Map<string, Uint8Array> }> {
    const folder = `/files/${++this.folders}`;
    this.module.FS.mkdirTree(folder);
    const write = (name: string, bytes: Uint8Array): string => {
      const path = `${folder}/${name}`;
      this.module.FS.mkdirTree(path.slice(0, path.lastIndexOf("/")));
      this.module.FS.writeFile(path, bytes, { canOwn: true });
      return path;
    };
    const beside = new Map<string, Uint8Array>();
    try {
      if ("files" in source) {
        const main = source.files.find(({ name }) => /\.(glb|gltf|zip)$/i.test(name)) ?? source.files[0];
        if (main === undefined) throw new FileError("no file was given", "");
        for (const { name, data } of source.files) {
          const bytes = await reader.blob(data, name);
          beside.set(name, bytes);
          write(name, bytes);
        }
        return { path: `${folder}/${main.name}`, bytes: beside.get(main.name) ?? new Uint8Array(0), beside };
      }
      const bytes = await reader.url(source.url);
      const path = write(nameOf(source.url), bytes);
      if (bytes[0] === 0x7b) {
        for (const name of this.call<string[]>({ call: "files", path })) {
          if (beside.has(name) || name.startsWith("/") || name.split("/").includes("..")) continue;
          const url = new URL(name.split("/").map(encodeURIComponent).join("/"), source.url).href;
          try {
            const found = await reader.url(url);
            beside.set(name, found);
            write(name, found);
          } catch (error) {
            // A picture may be missing; the reader of scenes says what is missing and what that means.
            if (!(error instanceof FileError)) throw error;
            send({ event: "warnings", texts: [`${error.where}: ${error.message}`] });
          }
        }
      }
      return { path, bytes, beside };
    } catch (error) {
      this.remove(folder);
      throw error;
    }
  }

  private remove(folder: string): void {
    const { FS } = this.module;
    if (folder === "" || !FS.analyzePath(folder).exists) return;
    for (const name of FS.readdir(folder)) {
      if (name === "." || name === "..") continue;
      const path = `${folder}/${name}`;
      if (FS.isDir(FS.stat(path).mode)) this.remove(path);
      else FS.unlink(path);
    }
    FS.rmdir(folder);
  }

  private folderOf(path: string): string {
    return path.split("/").slice(0, 3).join("/");
  }

  // ----- calls

  async load(source: Source, variant: string): Promise<Info> {
    const controller = (this.loading = new AbortController());
    const tell = (done: number, what: string): void => send({ event: "progress", done, what });
    tell(0, "fetching the model");
    const reader = new Reader(controller.signal, (received, expected) => {
      tell(0.7 * (expected === null ? 1 - 1 / (1 + received / 1e7) : received / expected), "fetching the model");
    });
    let path = "url" in source && source.url.startsWith("demo:") ? source.url : "";
    if (path === "") {
      const taken = await this.take(source, reader);
      path = taken.path;
      try {
        tell(0.7, "decoding its pictures");
        this.module._candela_forget_pictures(1);
        await decodePictures(picturesOf(taken.bytes, taken.beside), this.module, this.page);
        if (controller.signal.aborted) throw new DOMException("another model was asked for", "AbortError");
        tell(0.8, "reading the model");
        this.info = await this.busy(() => this.call<Info>({ call: "load", path, variant }));
      } catch (error) {
        this.remove(this.folderOf(path));
        throw error;
      } finally {
        this.module._candela_forget_pictures(0);
      }
      this.remove(this.sceneFolder);
      this.sceneFolder = this.folderOf(path);
    } else {
      this.info = await this.busy(() => this.call<Info>({ call: "load", path, variant }));
      this.remove(this.sceneFolder);
      this.sceneFolder = "";
    }
    this.animation = null;
    this.shownTime = null;
    this.isLoaded = true;
    tell(0.9, "preparing light and surfaces");
    await this.firstFrame();
    tell(1, "");
    return this.info;
  }

  /** The picture is there when a load ends; else its failure is the load's. */
  private async firstFrame(): Promise<void> {
    await new Promise((resolve) => setTimeout(resolve, 0)); // what was told comes first
    if (!this.isLost) this.draw();
  }

  private async busy<T>(work: () => T): Promise<T> {
    this.isBusy = true;
    try {
      await new Promise((resolve) => setTimeout(resolve, 0));
      return work();
    } finally {
      this.isBusy = false;
    }
  }

  private async setEnvironment(source: Source | { name: string }): Promise<void> {
    if ("name" in source) {
      this.call({ call: "environment", name: source.name });
    } else {
      const reader = new Reader(new AbortController().signal, () => undefined);
      const { path } = await this.take(source, reader);
      try {
        this.call({ call: "environment", name: path });
      } catch (error) {
        this.remove(this.folderOf(path));
        throw error;
      }
    }
    if (this.isLoaded) await this.firstFrame();
  }

  private picture(width: number, height: number, frames: number): ImageBitmap | Promise<ImageBitmap> {
    const made = this.call<{ width: number; height: number }>({ call: "picture", width, height, frames, ...this.lookCall() });
    const at = this.module._candela_picture(this.page);
    const pixels = new Uint8ClampedArray(this.module.HEAPU8.slice(at, at + 4 * made.width * made.height).buffer);
    this.invalidate();
    return createImageBitmap(new ImageData(pixels, made.width, made.height), { premultiplyAlpha: "none" });
  }

  private bake(size: number | undefined): { name: string; data: Blob }[] {
    const { FS } = this.module;
    const folder = "/baked";
    this.remove(folder);
    FS.mkdirTree(folder);
    this.call({ call: "bake", folder, ...(size === undefined ? {} : { size }) });
    const files = FS.readdir(folder)
      .filter((name) => name !== "." && name !== "..")
      .map((name) => ({ name, data: new Blob([FS.readFile(`${folder}/${name}`)]) }));
    this.remove(folder);
    return files;
  }

  private lose(): null {
    const kAwayMs = 100;
    const door = this.canvas.getContext("webgl2")?.getExtension("WEBGL_lose_context");
    if (!door) throw new FileError("this browser does not take its contexts away", "");
    door.loseContext();
    setTimeout(() => door.restoreContext(), kAwayMs);
    return null;
  }

  abortLoad(): void {
    this.loading?.abort();
  }

  async answer(call: Exclude<Call, { call: "open" }>): Promise<unknown> {
    switch (call.call) {
      case "load":
        return this.load(call.source, call.variant);
      case "environment":
        return this.setEnvironment(call.source);
      case "variant":
        this.call({ call: "variant", name: call.name });
        this.shownTime = null;
        return this.firstFrame();
      case "animation":
        this.animation =
          call.name === null
            ? null
            : { name: call.name, playing: call.playing, time: call.time ?? this.animation?.time ?? 0, from: performance.now() / 1000 };
        this.invalidate();
        return null;
      case "picture":
        return this.picture(call.width, call.height, call.frames);
      case "check":
        return this.call({ call: "check" });
      case "bake":
        return this.bake(call.size);
      case "lose":
        return this.lose();
    }
  }
}

let renderer: Renderer | null = null;
let queue: Promise<void> = Promise.resolve();

async function answer(message: Call & { id: number }): Promise<void> {
  const { id } = message;
  try {
    if (message.call === "open") {
      renderer = await Renderer.open(message.canvas);
      renderer.resize(message.width, message.height);
      send({ id, result: null });
      return;
    }
    if (renderer === null) throw new FileError("the renderer did not start", "");
    const result = await renderer.answer(message);
    send({ id, result }, result instanceof ImageBitmap ? [result] : []);
  } catch (error) {
    const aborted = error instanceof DOMException && error.name === "AbortError";
    send({ id, failure: failureOf(error), aborted });
  }
}

self.onmessage = ({ data }: MessageEvent<ToWorker>) => {
  if ("wish" in data) {
    if (data.wish === "size") renderer?.resize(data.width, data.height);
    else renderer?.setLook(data.look);
    return;
  }
  // What is still being fetched is of no use any more.
  if (data.call === "load") renderer?.abortLoad();
  queue = queue.then(() => answer(data));
};
