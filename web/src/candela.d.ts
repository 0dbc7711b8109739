// What emscripten makes of web/module.
export interface Module {
  HEAPU8: Uint8Array;
  GL: {
    registerContext(context: WebGL2RenderingContext, attributes: { majorVersion: number; minorVersion: number }): number;
    makeContextCurrent(handle: number): boolean;
    initExtensions(context: unknown): void;
    contexts: Record<number, { initExtensionsDone?: boolean }>;
  };
  FS: {
    mkdirTree(path: string): void;
    writeFile(path: string, data: Uint8Array, options?: { canOwn: boolean }): void;
    readFile(path: string): Uint8Array;
    readdir(path: string): string[];
    unlink(path: string): void;
    rmdir(path: string): void;
    isDir(mode: number): boolean;
    stat(path: string): { mode: number };
    analyzePath(path: string): { exists: boolean };
  };
  UTF8ToString(pointer: number): string;
  stringToUTF8(text: string, pointer: number, bytes: number): void;
  lengthBytesUTF8(text: string): number;
  _malloc(bytes: number): number;
  _free(pointer: number): void;
  _candela_open(): number;
  _candela_call(page: number, call: number): number;
  _candela_picture(page: number): number;
  _candela_begin_picture(page: number, width: number, height: number): number;
  _candela_end_picture(page: number, file: number, bytes: number): void;
  _candela_forget_pictures(all: number): void;
}
export default function candela(options?: { print?(text: string): void; printErr?(text: string): void }): Promise<Module>;
