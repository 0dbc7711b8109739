// Files from the network or from the user, never read when they are too large.

/** Most bytes of all files of a scene together: the memory of a page has to hold them beside what is made of them. */
export const kMostBytes = 2 ** 30;

export class FileError extends Error {
  constructor(message: string, readonly where: string) {
    super(message);
  }
}

function tooLarge(bytes: number | null, where: string): FileError {
  const size = bytes === null ? "it has more than" : `${(bytes / 2 ** 20).toFixed(0)} MiB are too many, a page reads at most`;
  return new FileError(`${size} ${kMostBytes / 2 ** 20} MiB`, where);
}

/** How a URL is named to people: as it is, but no data: of many kilobytes. */
export function shown(url: string): string {
  return url.length > 200 ? `${url.slice(0, 60)}…` : url;
}

export class Reader {
  private left = kMostBytes;

  constructor(
    private readonly signal: AbortSignal,
    private readonly progress: (received: number, expected: number | null) => void,
  ) {}

  async blob(data: Blob, where: string): Promise<Uint8Array> {
    if (data.size > this.left) throw tooLarge(data.size, where);
    this.left -= data.size;
    try {
      return new Uint8Array(await data.arrayBuffer());
    } catch {
      throw new FileError("cannot be read", where);
    }
  }

  async url(url: string): Promise<Uint8Array> {
    const where = shown(url);
    let response: Response;
    try {
      response = await fetch(url, { signal: this.signal });
    } catch (error) {
      if (this.signal.aborted) throw error;
      throw new FileError("cannot be fetched: no such server, or it forbids this page to read it (CORS)", where);
    }
    if (!response.ok) throw new FileError(`cannot be fetched: ${response.status} ${response.statusText}`.trim(), where);
    const length = response.headers.get("content-length");
    // What is packed on its way says how long it is then.
    const expected = length !== null && !response.headers.has("content-encoding") ? Number(length) : null;
    if (expected !== null && expected > this.left) {
      await response.body?.cancel();
      throw tooLarge(expected, where);
    }
    return this.stream(response, expected, where);
  }

  private async stream(response: Response, expected: number | null, where: string): Promise<Uint8Array> {
    const reader = response.body?.getReader();
    if (reader === undefined) return new Uint8Array(0);
    const parts: Uint8Array[] = [];
    let received = 0;
    for (;;) {
      let part: { done: boolean; value?: Uint8Array };
      try {
        part = await reader.read();
      } catch (error) {
        if (this.signal.aborted) throw error;
        throw new FileError("the connection broke off", where);
      }
      if (part.done || part.value === undefined) break;
      received += part.value.length;
      if (received > this.left) {
        await reader.cancel();
        throw tooLarge(null, where);
      }
      parts.push(part.value);
      this.progress(received, expected);
    }
    this.left -= received;
    const only = parts[0];
    if (parts.length === 1 && only !== undefined) return only;
    const all = new Uint8Array(received);
    let at = 0;
    for (const part of parts) {
      all.set(part, at);
      at += part.length;
    }
    return all;
  }
}

/** The last part of a URL's path, as a file is called. */
export function nameOf(url: string): string {
  const path = new URL(url).pathname.split("/").pop() ?? "";
  try {
    return decodeURIComponent(path).replace(/[/\0]/g, "_") || "scene";
  } catch {
    return path || "scene";
  }
}
