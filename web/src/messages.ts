// What the element and its worker say to each other.

/** A file: where it is, or itself; several where one names the others. */
export type Source = { url: string } | { files: { name: string; data: Blob }[] };

/** From where the subject is seen; radians. What is missing is the file's own camera, or what suits the subject. */
export interface Sight {
  azimuth?: number;
  elevation?: number;
  /** Of the distance from where all of it is seen. */
  scale?: number;
  /** Metres, in place of it. */
  distance?: number;
}

export interface Look {
  sight: Sight;
  /** A factor, or "auto" for one that is metered; missing = as the scene and its light ask for. */
  exposure?: number | "auto";
  tonemap?: string;
}

/** What a file says of itself, and what of it is drawn. */
export interface Info {
  generator: string;
  copyright: string;
  extensions: string[];
  ignored: string[];
  variants: string[];
  animations: { name: string; duration: number }[];
  triangles: number;
  materials: number;
  images: number;
  lights: number;
  nodes: number;
  /** Metres. */
  size: [number, number, number];
}

/** One thing that `check` has found; docs/check.md has the codes. */
export interface Finding {
  severity: "note" | "warning" | "error";
  code: string;
  message: string;
  fix?: string | null;
  material?: string | null;
  texture?: string | null;
  subject?: string | null;
}

/** A failure in one line. */
export interface Failure {
  message: string;
  /** A file, a JSON pointer; may be empty. */
  where: string;
}

export type Call =
  | { call: "open"; canvas: OffscreenCanvas; width: number; height: number }
  | { call: "load"; source: Source; variant: string }
  | { call: "environment"; source: Source | { name: string } }
  | { call: "variant"; name: string }
  | { call: "animation"; name: string | null; playing: boolean; time?: number }
  | { call: "picture"; width: number; height: number; frames: number }
  | { call: "check" }
  | { call: "lose" }
  | { call: "bake"; size?: number };

/** Without an answer: what is asked for last counts. */
export type Wish = { wish: "size"; width: number; height: number } | { wish: "look"; look: Look };

export type ToWorker = (Call & { id: number }) | Wish;

export type FromWorker =
  | { id: number; result: unknown }
  | { id: number; failure: Failure; aborted: boolean }
  | { event: "progress"; done: number; what: string }
  | { event: "frame"; sight: Required<Pick<Sight, "azimuth" | "elevation" | "scale">>; milliseconds: number }
  | { event: "warnings"; texts: string[] }
  | { event: "failed"; failure: Failure }
  | { event: "context"; lost: boolean };
