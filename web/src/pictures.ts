// The pictures of a scene, decoded by the browser: on threads of its own, faster than WebAssembly does, and AVIF at all. What it
// does not decode exactly as glTF means it, is left to Candela's decoders: 16 bits, animations, pictures that say how they are turned.

import type { Module } from "./candela.js";

interface Document {
  buffers?: { uri?: string }[];
  bufferViews?: { buffer?: number; byteOffset?: number; byteLength?: number }[];
  images?: { uri?: string; bufferView?: number }[];
}

const kGlb = 0x46546c67;
const kJson = 0x4e4f534a;
const kBin = 0x004e4942;

/** JSON and binary chunk of a .glb or a .gltf; nothing where it is neither: the reader of scenes says what is wrong. */
function parse(bytes: Uint8Array): { document: Document; binary: Uint8Array | null } | null {
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  let json: Uint8Array | null = null;
  let binary: Uint8Array | null = null;
  if (bytes.length >= 12 && view.getUint32(0, true) === kGlb) {
    for (let at = 12; at + 8 <= bytes.length; ) {
      const length = view.getUint32(at, true);
      const kind = view.getUint32(at + 4, true);
      const chunk = bytes.subarray(at + 8, at + 8 + length);
      if (kind === kJson && json === null) json = chunk;
      if (kind === kBin && binary === null) binary = chunk;
      at += 8 + length + ((4 - (length % 4)) % 4);
    }
  } else if (bytes[0] === 0x7b) {
    json = bytes;
  }
  if (json === null) return null;
  try {
    const document: unknown = JSON.parse(new TextDecoder().decode(json));
    return typeof document === "object" && document !== null ? { document: document as Document, binary } : null;
  } catch {
    return null;
  }
}

/** The files of a scene's pictures. */
export function picturesOf(bytes: Uint8Array, beside: Map<string, Uint8Array>): Uint8Array[] {
  const parsed = parse(bytes);
  if (parsed === null || !Array.isArray(parsed.document.images)) return [];
  const { document, binary } = parsed;
  const named = (uri: string): Uint8Array | undefined => {
    try {
      return beside.get(decodeURIComponent(uri));
    } catch {
      return beside.get(uri);
    }
  };
  const pictures: Uint8Array[] = [];
  for (const image of document.images ?? []) {
    if (typeof image?.uri === "string") {
      const file = named(image.uri);
      if (file !== undefined) pictures.push(file);
      continue;
    }
    const view = document.bufferViews?.[image?.bufferView ?? -1];
    if (view === undefined || view === null) continue;
    const index = view.buffer ?? 0;
    const uri = document.buffers?.[index]?.uri;
    const buffer = typeof uri === "string" ? named(uri) : index === 0 ? binary : null;
    const start = view.byteOffset ?? 0;
    if (buffer) pictures.push(buffer.subarray(start, start + (view.byteLength ?? 0)));
  }
  return pictures;
}

function has(bytes: Uint8Array, at: number, text: string): boolean {
  for (let i = 0; i < text.length; ++i) {
    if (bytes[at + i] !== text.charCodeAt(i)) return false;
  }
  return true;
}

/** Its MIME type where the browser shall decode it. */
function typeOf(bytes: Uint8Array): string | null {
  const kPngBits = 24;
  const kWebpFlags = 20;
  if (has(bytes, 1, "PNG\r\n")) return bytes[kPngBits] === 16 ? null : "image/png";
  if (bytes[0] === 0xff && bytes[1] === 0xd8) {
    // Exif, which may turn it, stands in one of the first segments.
    for (let at = 2; at + 10 < bytes.length && bytes[at] === 0xff && bytes[at + 1] !== 0xda; ) {
      if (bytes[at + 1] === 0xe1 && has(bytes, at + 4, "Exif")) return null;
      at += 2 + (bytes[at + 2] ?? 0) * 256 + (bytes[at + 3] ?? 0);
    }
    return "image/jpeg";
  }
  if (has(bytes, 0, "RIFF") && has(bytes, 8, "WEBP")) {
    return has(bytes, 12, "VP8X") && ((bytes[kWebpFlags] ?? 0) & 2) !== 0 ? null : "image/webp";
  }
  if (has(bytes, 4, "ftypavif")) return "image/avif";
  return null;
}

/** A context of its own, which reads pixels exactly: a 2-D canvas would multiply them by their alpha. */
class PixelReader {
  private readonly gl = new OffscreenCanvas(1, 1).getContext("webgl2");

  read(picture: ImageBitmap, place: (width: number, height: number) => Uint8Array | null): void {
    const gl = this.gl;
    if (gl === null || picture.width > gl.getParameter(gl.MAX_TEXTURE_SIZE) || picture.height > gl.getParameter(gl.MAX_TEXTURE_SIZE)) return;
    const texture = gl.createTexture();
    const framebuffer = gl.createFramebuffer();
    gl.bindTexture(gl.TEXTURE_2D, texture);
    gl.pixelStorei(gl.UNPACK_PREMULTIPLY_ALPHA_WEBGL, false);
    gl.pixelStorei(gl.UNPACK_COLORSPACE_CONVERSION_WEBGL, gl.NONE);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA, gl.RGBA, gl.UNSIGNED_BYTE, picture);
    gl.bindFramebuffer(gl.FRAMEBUFFER, framebuffer);
    gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, texture, 0);
    if (gl.checkFramebufferStatus(gl.FRAMEBUFFER) === gl.FRAMEBUFFER_COMPLETE) {
      const pixels = place(picture.width, picture.height);
      if (pixels !== null) gl.readPixels(0, 0, picture.width, picture.height, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
    }
    gl.deleteFramebuffer(framebuffer);
    gl.deleteTexture(texture);
  }

  close(): void {
    this.gl?.getExtension("WEBGL_lose_context")?.loseContext();
  }
}

/** Decodes what it can and hands it over; whatever fails here is tried by Candela's decoders, which say what is wrong with it. */
export async function decodePictures(pictures: Uint8Array[], module: Module, page: number): Promise<void> {
  const wanted = pictures.filter((bytes) => typeOf(bytes) !== null);
  if (wanted.length === 0) return;
  const reader = new PixelReader();
  const decode = async (bytes: Uint8Array): Promise<ImageBitmap | null> => {
    try {
      const blob = new Blob([bytes], { type: typeOf(bytes) ?? "" });
      return await createImageBitmap(blob, { premultiplyAlpha: "none", colorSpaceConversion: "none" });
    } catch {
      return null;
    }
  };
  // Some at a time: a picture of 4096² takes 64 MiB.
  const kAtOnce = 4;
  for (let first = 0; first < wanted.length; first += kAtOnce) {
    const some = wanted.slice(first, first + kAtOnce);
    const decoded = await Promise.all(some.map(decode));
    decoded.forEach((picture, i) => {
      const bytes = some[i];
      if (picture === null || bytes === undefined) return;
      let isThere = false;
      reader.read(picture, (width, height) => {
        const at = module._candela_begin_picture(page, width, height);
        isThere = at !== 0;
        return isThere ? module.HEAPU8.subarray(at, at + 4 * width * height) : null;
      });
      picture.close();
      if (!isThere) return;
      const file = module._malloc(bytes.length);
      if (file === 0) return;
      module.HEAPU8.set(bytes, file);
      module._candela_end_picture(page, file, bytes.length);
      module._free(file);
    });
  }
  reader.close();
}
