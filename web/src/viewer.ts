// <candela-viewer>: a glTF model in physically based light, drawn by Candela's rasterizer in WebGL 2.

import { kSteepest, parseCameraOrbit, parseExposure } from "./attributes.js";
import type { Call, Failure, Finding, FromWorker, Info, Look, Sight, Source, Wish } from "./messages.js";
import { followInput } from "./orbit.js";

export type { Failure, Finding, Info } from "./messages.js";

/** What is wrong with a model, a light or this browser: one line. */
export class CandelaError extends Error {
  readonly where: string;
  constructor(failure: Failure) {
    super(failure.where === "" ? failure.message : `${failure.where}: ${failure.message}`);
    this.name = "CandelaError";
    this.where = failure.where;
  }
}

/** A model or a light: where it is, the file itself, or several of which one names the others. */
export type ModelSource = string | URL | Blob | Iterable<File>;

export interface PictureOptions {
  width?: number;
  height?: number;
  /** The picture is the mean of so many frames, each jittered within its pixels. */
  frames?: number;
}

/** What `candela check` says; docs/check.md. */
export interface Verdict {
  file: string;
  findings: Finding[];
  [more: string]: unknown;
}

const kStyle = `
  :host { display: block; position: relative; width: 300px; height: 300px; contain: content; background: #2a2c30; }
  :host([hidden]) { display: none; }
  canvas { position: absolute; inset: 0; width: 100%; height: 100%; outline: none; touch-action: var(--candela-touch-action, none); cursor: grab; }
  canvas:active { cursor: grabbing; }
  canvas:focus-visible { box-shadow: inset 0 0 0 3px #fff, inset 0 0 0 5px #1a5fd0; }
  progress { position: absolute; left: 0; bottom: 0; width: 100%; height: 4px; appearance: none; border: 0; background: #0006; }
  progress::-webkit-progress-bar { background: #0006; }
  progress::-webkit-progress-value { background: #ffd27d; }
  progress::-moz-progress-bar { background: #ffd27d; }
  p { position: absolute; left: 0; right: 0; bottom: 0; margin: 0; padding: 0.6em 0.8em; font: 14px/1.4 system-ui, sans-serif; color: #fff; background: #6d1a1aee; overflow-wrap: anywhere; }
  p.told { background: #1d2026e0; }
  [hidden] { display: none; }
`;

function sourceOf(model: ModelSource): { source: Source; name: string } {
  if (typeof model === "string" || model instanceof URL) {
    const text = String(model);
    if (text.startsWith("demo:")) return { source: { url: text }, name: text };
    return { source: { url: new URL(text, document.baseURI).href }, name: text };
  }
  if (model instanceof Blob) {
    const name = model instanceof File && model.name !== "" ? model.name : "model";
    return { source: { files: [{ name, data: model }] }, name };
  }
  const files = [...model].map((file) => ({ name: file.webkitRelativePath.split("/").slice(1).join("/") || file.name, data: file }));
  return { source: { files }, name: files[0]?.name ?? "" };
}

/** A worker of a server other than the page's is refused, but not one that imports it. */
function startWorker(): Worker {
  const url = new URL("worker.js", import.meta.url);
  if (url.origin === location.origin) return new Worker(url, { type: "module" });
  const wrapper = URL.createObjectURL(new Blob([`import ${JSON.stringify(url.href)};`], { type: "text/javascript" }));
  const worker = new Worker(wrapper, { type: "module" });
  setTimeout(() => URL.revokeObjectURL(wrapper), 60_000);
  return worker;
}

type DistributiveOmit<T, K extends PropertyKey> = T extends unknown ? Omit<T, K> : never;

export class CandelaViewer extends HTMLElement {
  static readonly observedAttributes = ["src", "env", "exposure", "tonemap", "variant", "camera-orbit", "animation", "alt"];

  private readonly canvas = document.createElement("canvas");
  private readonly message = document.createElement("p");
  private readonly bar = document.createElement("progress");
  private worker: Worker | null = null;
  private opened: Promise<void> | null = null;
  private waiting = new Map<number, { resolve(value: unknown): void; reject(error: unknown): void }>();
  private calls = 0;
  private listening: AbortController | null = null;
  private resizing: ResizeObserver | null = null;
  private turned: Sight | null = null;
  private shownSight = { azimuth: 0, elevation: 0, scale: 1 };
  private info_: Info | null = null;
  private isPlaying_ = false;
  private loads = 0;
  private isConnectedOnce = false;
  /** What the last frame took in the worker, until the driver had all calls. */
  frameMilliseconds = 0;

  constructor() {
    super();
    const root = this.attachShadow({ mode: "open" });
    const style = document.createElement("style");
    style.textContent = kStyle;
    this.message.hidden = true;
    this.bar.hidden = true;
    this.bar.max = 1;
    this.bar.setAttribute("aria-label", "loading");
    this.canvas.tabIndex = 0;
    this.canvas.setAttribute("role", "img");
    root.append(style, this.canvas, this.bar, this.message);
    this.describe();
  }

  // ----- the life of the element

  connectedCallback(): void {
    if (this.isConnectedOnce) return; // moved within the page: the canvas stays with its worker
    this.isConnectedOnce = true;
    this.start();
  }

  disconnectedCallback(): void {
    queueMicrotask(() => {
      if (!this.isConnected) this.stop();
    });
  }

  private start(): void {
    this.listening = new AbortController();
    followInput(
      this.canvas,
      {
        turn: (azimuth, elevation, scale) => this.turn(azimuth, elevation, scale),
        reset: () => this.resetCamera(),
        togglePlaying: () => (this.isPlaying_ ? this.pause() : this.play()),
      },
      this.listening.signal,
    );
    if (!("transferControlToOffscreen" in this.canvas) || typeof Worker === "undefined") {
      this.fail({ message: "this browser cannot draw on a thread of its own (OffscreenCanvas)", where: "" });
      return;
    }
    this.opened = this.open();
    this.opened.then(
      () => {
        if (this.getAttribute("env")) void this.applyEnvironment();
        if (this.getAttribute("src")) void this.applySource();
      },
      (error: unknown) => this.report(error),
    );
  }

  private stop(): void {
    this.worker?.terminate();
    this.worker = null;
    this.opened = null;
    this.listening?.abort();
    this.resizing?.disconnect();
    for (const { reject } of this.waiting.values()) reject(new CandelaError({ message: "the element was taken out of the page", where: "" }));
    this.waiting.clear();
    this.info_ = null;
    // A canvas gives its control away once: when the element comes back it starts with another.
    const fresh = this.canvas.cloneNode() as HTMLCanvasElement;
    this.canvas.replaceWith(fresh);
    (this as unknown as { canvas: HTMLCanvasElement }).canvas = fresh;
    this.isConnectedOnce = false;
  }

  private async open(): Promise<void> {
    const worker = startWorker();
    this.worker = worker;
    worker.onmessage = ({ data }: MessageEvent<FromWorker>) => this.receive(data);
    worker.onerror = (event) => {
      event.preventDefault(); // it is told here, and is no error of the page
      this.breakDown(event.message ? `the renderer stopped: ${event.message}` : "the renderer's worker cannot be loaded");
    };
    const offscreen = this.canvas.transferControlToOffscreen();
    const { width, height } = this.pixels();
    await this.call<null>({ call: "open", canvas: offscreen, width, height }, [offscreen as unknown as Transferable]);
    this.resizing = new ResizeObserver(() => this.wish({ wish: "size", ...this.pixels() }));
    this.resizing.observe(this);
    this.applyLook();
  }

  private breakDown(message: string): void {
    const failure = { message, where: "" };
    this.worker?.terminate();
    this.worker = null;
    const waiting = [...this.waiting.values()];
    this.waiting.clear();
    for (const { reject } of waiting) reject(new CandelaError(failure));
    if (waiting.length === 0) this.fail(failure);
  }

  private pixels(): { width: number; height: number } {
    const ratio = Math.min(window.devicePixelRatio || 1, 2);
    return { width: Math.max(1, Math.round(this.clientWidth * ratio)), height: Math.max(1, Math.round(this.clientHeight * ratio)) };
  }

  // ----- the worker

  private call<T>(call: DistributiveOmit<Call, "id">, transfer: Transferable[] = []): Promise<T> {
    const { worker } = this;
    if (worker === null) return Promise.reject(new CandelaError({ message: "the renderer does not run", where: "" }));
    const id = ++this.calls;
    return new Promise<T>((resolve, reject) => {
      this.waiting.set(id, { resolve: (value) => resolve(value as T), reject });
      worker.postMessage({ ...call, id }, transfer);
    });
  }

  private wish(wish: Wish): void {
    this.worker?.postMessage(wish);
  }

  private receive(message: FromWorker): void {
    if ("id" in message) {
      const waiting = this.waiting.get(message.id);
      this.waiting.delete(message.id);
      if ("result" in message) waiting?.resolve(message.result);
      else if (message.aborted) waiting?.reject(new DOMException(message.failure.message, "AbortError"));
      else waiting?.reject(new CandelaError(message.failure));
      return;
    }
    switch (message.event) {
      case "progress":
        this.bar.hidden = message.done >= 1;
        this.bar.value = message.done;
        this.dispatch("progress", { totalProgress: message.done, what: message.what });
        break;
      case "frame":
        this.shownSight = message.sight;
        this.frameMilliseconds = message.milliseconds;
        this.dispatch("frame", { milliseconds: message.milliseconds });
        break;
      case "warnings":
        this.dispatch("warning", { texts: message.texts });
        break;
      case "failed":
        this.fail(message.failure);
        break;
      case "context":
        if (message.lost) this.tell("The graphics driver was reset; the picture comes back with it.");
        else this.message.hidden = true;
        this.dispatch(message.lost ? "contextlost" : "contextrestored", {});
        break;
    }
  }

  private dispatch(type: string, detail: object): void {
    this.dispatchEvent(new CustomEvent(type, { detail }));
  }

  // ----- messages in the page

  private tell(text: string): void {
    this.message.className = "told";
    this.message.setAttribute("role", "status");
    this.message.textContent = text;
    this.message.hidden = false;
  }

  private fail(failure: Failure): void {
    const error = new CandelaError(failure);
    this.bar.hidden = true;
    this.message.className = "";
    this.message.setAttribute("role", "alert");
    this.message.textContent = error.message;
    this.message.hidden = false;
    this.dispatch("error", { message: failure.message, where: failure.where });
  }

  /** Shows what went wrong with what an attribute asked for; that another was asked for since is no failure. */
  private report(error: unknown): void {
    if (error instanceof DOMException && error.name === "AbortError") return;
    if (error instanceof CandelaError) {
      const where = error.where;
      this.fail({ message: where === "" ? error.message : error.message.slice(where.length + 2), where });
    } else {
      this.fail({ message: error instanceof Error ? error.message : String(error), where: "" });
    }
  }

  private describe(): void {
    const what = this.getAttribute("alt") || "3D model";
    this.canvas.setAttribute("aria-label", `${what}. Arrow keys turn it, plus and minus come nearer and go farther, Home starts over.`);
  }

  // ----- attributes

  attributeChangedCallback(name: string, before: string | null, now: string | null): void {
    if (name === "alt") this.describe();
    if (before === now || this.opened === null) return;
    void this.opened.then(
      () => {
        if (name === "src") void this.applySource();
        if (name === "env") void this.applyEnvironment();
        if (name === "variant" && this.info_ !== null) void this.applyVariant();
        if (name === "animation" && this.info_ !== null) this.applyAnimation();
        if (name === "camera-orbit") this.turned = null;
        if (name === "camera-orbit" || name === "exposure" || name === "tonemap") this.applyLook();
      },
      () => undefined,
    );
  }

  private applyLook(): void {
    const look: Look = { sight: {} };
    try {
      const orbit = this.getAttribute("camera-orbit");
      const exposure = this.getAttribute("exposure");
      const tonemap = this.getAttribute("tonemap");
      if (orbit !== null) look.sight = parseCameraOrbit(orbit);
      if (exposure !== null) look.exposure = parseExposure(exposure);
      if (tonemap !== null) look.tonemap = tonemap.trim();
    } catch (error) {
      this.report(error);
    }
    if (this.turned !== null) look.sight = this.turned;
    this.wish({ wish: "look", look });
  }

  private async applySource(): Promise<void> {
    const src = this.getAttribute("src");
    if (!src) return;
    try {
      await this.load(src);
    } catch (error) {
      this.report(error);
    }
  }

  private async applyEnvironment(): Promise<void> {
    const env = this.getAttribute("env") ?? "";
    try {
      await this.setEnvironment(env);
    } catch (error) {
      this.report(error);
    }
  }

  private async applyVariant(): Promise<void> {
    try {
      await this.call<null>({ call: "variant", name: this.getAttribute("variant") ?? "" });
    } catch (error) {
      this.report(error);
    }
  }

  private applyAnimation(): void {
    const name = this.getAttribute("animation");
    if (name === null) {
      this.isPlaying_ = false;
      void this.call<null>({ call: "animation", name: null, playing: false }).catch(() => undefined);
    } else if (window.matchMedia("(prefers-reduced-motion: reduce)").matches) {
      this.pause();
    } else {
      this.play();
    }
  }

  // ----- for scripts

  /** What the file says of itself; null before one is there. */
  get info(): Info | null {
    return this.info_;
  }
  get isPlaying(): boolean {
    return this.isPlaying_;
  }
  get loaded(): boolean {
    return this.info_ !== null;
  }

  get src(): string {
    return this.getAttribute("src") ?? "";
  }
  set src(value: string) {
    this.setAttribute("src", value);
  }
  get env(): string {
    return this.getAttribute("env") ?? "";
  }
  set env(value: string) {
    this.setAttribute("env", value);
  }

  /** Shows a model; resolves when its first frame is drawn. Throws CandelaError, and what was shown before stays. */
  async load(model: ModelSource): Promise<Info> {
    const load = ++this.loads;
    await this.ready();
    const { source, name } = sourceOf(model);
    this.message.hidden = true;
    try {
      const info = await this.call<Info>({ call: "load", source, variant: this.getAttribute("variant") ?? "" });
      if (load === this.loads) {
        this.info_ = info;
        this.turned = null;
        this.applyLook();
        this.applyAnimation();
        this.dispatch("load", { url: name, info });
      }
      return info;
    } finally {
      if (load === this.loads) this.bar.hidden = true;
    }
  }

  /** Light: "studio", "sky:35" and the like, a URL or a file (.hdr, .exr, a cube map); "" = what the model asks for. */
  async setEnvironment(light: ModelSource): Promise<void> {
    await this.ready();
    const isName = typeof light === "string" && (light === "" || /^(none|furnace|(studio|sky)(:[a-z0-9.-]+)?)$/.test(light));
    const source = isName ? { name: light } : sourceOf(light).source;
    this.message.hidden = true;
    await this.call<null>({ call: "environment", source });
    this.dispatch("environment-change", {});
  }

  /** A picture of what is shown, finer than a frame. */
  async render(options: PictureOptions = {}): Promise<ImageBitmap> {
    await this.ready();
    const { width, height } = this.pixels();
    const wanted = { width: options.width ?? width, height: options.height ?? height, frames: options.frames ?? 16 };
    for (const [what, number] of Object.entries(wanted)) {
      if (!Number.isInteger(number) || number < 1 || number > 8192) throw new CandelaError({ message: `${what} has to be a whole number from 1 to 8192`, where: "render" });
    }
    return this.call<ImageBitmap>({ call: "picture", ...wanted });
  }

  /** Judges the file against what is physically plausible. */
  async check(): Promise<Verdict> {
    await this.ready();
    return this.call<Verdict>({ call: "check" });
  }

  /** The light that the model stands in as KTX 2 cubes for engines, prefiltered, and its spherical harmonics. */
  async bake(options: { size?: number } = {}): Promise<File[]> {
    await this.ready();
    const files = await this.call<{ name: string; data: Blob }[]>({ call: "bake", ...options });
    return files.map(({ name, data }) => new File([data], name));
  }

  /** Takes the graphics context away and gives it back, as a driver's reset does: for tests of pages. */
  async loseContext(): Promise<void> {
    await this.ready();
    await this.call<null>({ call: "lose" });
  }

  play(): void {
    const first = this.info_?.animations[0];
    if (first === undefined) return;
    this.isPlaying_ = true;
    void this.call<null>({ call: "animation", name: this.getAttribute("animation") ?? "", playing: true }).catch((error: unknown) => this.report(error));
  }

  pause(): void {
    if (this.info_ === null || this.info_.animations.length === 0) return;
    this.isPlaying_ = false;
    void this.call<null>({ call: "animation", name: this.getAttribute("animation") ?? "", playing: false }).catch((error: unknown) => this.report(error));
  }

  /** Back to where the model is first seen from. */
  resetCamera(): void {
    this.turned = null;
    this.applyLook();
  }

  /** Turns the camera about the subject, radians, and multiplies its distance. */
  turn(azimuth: number, elevation: number, scale = 1): void {
    if (this.info_ === null) return;
    const from = { ...this.shownSight, ...this.turned };
    const steep = Math.max(-kSteepest, Math.min(kSteepest, from.elevation + elevation));
    this.turned = { azimuth: from.azimuth + azimuth, elevation: steep, scale: Math.max(0.05, Math.min(20, from.scale * scale)) };
    this.applyLook();
    this.dispatch("camera-change", {});
  }

  /** Of the camera as it stands, radians. */
  get cameraOrbit(): { azimuth: number; elevation: number; scale: number } {
    return { ...this.shownSight, ...this.turned };
  }

  private async ready(): Promise<void> {
    if (this.opened === null) throw new CandelaError({ message: "the element is not in a page, or its renderer did not start", where: "" });
    await this.opened;
  }
}

if (!customElements.get("candela-viewer")) customElements.define("candela-viewer", CandelaViewer);

declare global {
  interface HTMLElementTagNameMap {
    "candela-viewer": CandelaViewer;
  }
}
