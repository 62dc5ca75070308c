/** Reads one file of a zip archive: its directory, and what the browser itself can inflate. */
const END = 0x06054b50;
const ENTRY = 0x02014b50;

/** Returns the first file whose path is wanted; nothing when there is none. */
export async function unzipped(archive: ArrayBuffer, isWanted: (path: string) => boolean): Promise<Uint8Array | undefined> {
  const view = new DataView(archive);
  let end = archive.byteLength - 22;
  while (end >= 0 && view.getUint32(end, true) !== END) end--;
  if (end < 0) throw new Error("the file is no zip archive");
  let at = view.getUint32(end + 16, true);
  for (let left = view.getUint16(end + 10, true); left > 0 && view.getUint32(at, true) === ENTRY; left--) {
    const [nameLength, extra, comment] = [28, 30, 32].map((offset) => view.getUint16(at + offset, true));
    const path = new TextDecoder().decode(new Uint8Array(archive, at + 46, nameLength));
    if (isWanted(path)) return content(archive, view, at);
    at += 46 + nameLength + extra + comment;
  }
  return undefined;
}

async function content(archive: ArrayBuffer, view: DataView, entry: number): Promise<Uint8Array> {
  const [method, size, local] = [view.getUint16(entry + 10, true), view.getUint32(entry + 20, true), view.getUint32(entry + 42, true)];
  const start = local + 30 + view.getUint16(local + 26, true) + view.getUint16(local + 28, true);
  const packed = archive.slice(start, start + size);
  if (method === 0) return new Uint8Array(packed);
  const inflated = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate-raw"));
  return new Uint8Array(await new Response(inflated).arrayBuffer());
}
