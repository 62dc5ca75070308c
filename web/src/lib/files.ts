/** Files that come from the person's disk and go to it. */
import { library, reasonOf } from "./api";
import { session } from "./session.svelte";
import { t } from "./texts.svelte";
import { unzipped } from "./zip";

const WORLD = "world.json";

/** Hands a file to the browser to keep. */
export function save(content: Blob, name: string) {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(content);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 60_000);
}

/** Opens a world of a folder, an archive or a single document. */
export async function opened(files: File[]) {
  try {
    const content = await documentOf(files);
    if (!content) return session.say(t("open.none"));
    const { world, report } = (await library.parseWorld({ content })).world ?? {};
    if (!world || !report) return;
    session.prompt = world.brief?.prompt ?? world.sceneGraph?.prompt ?? "";
    session.push({ world, report, label: t("open.did") });
  } catch (error) {
    session.say(reasonOf(error));
  }
}

async function documentOf(files: File[]): Promise<Uint8Array | undefined> {
  const named = files.find((f) => f.name === WORLD) ?? (files.length === 1 && files[0].name.endsWith(".json") ? files[0] : undefined);
  if (named) return new Uint8Array(await named.arrayBuffer());
  const archive = files.find((f) => f.name.endsWith(".zip"));
  return archive && unzipped(await archive.arrayBuffer(), (path) => path === WORLD || path.endsWith(`/${WORLD}`));
}
