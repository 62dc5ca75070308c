/** Files that come from the person's disk and go to it. */
import { library } from "./api";
import { reasonOf } from "./refusals";
import { session } from "./session.svelte";
import { t } from "./texts.svelte";
import { unzipped } from "./zip";

const WORLD = "world.json";
/** Endings of plans that the server reads; a nav2 map comes with its picture. */
const PLANS = ["floorplan.json", ".geojson", ".svg", ".dxf", ".yaml", ".yml"];

/** Hands a file to the browser to keep. */
export function save(content: Blob, name: string) {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(content);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 60_000);
}

/** Opens a world of a folder, an archive or a single document, or furnishes a plan; returns true when there is a world. */
export async function opened(files: File[]): Promise<boolean> {
  try {
    const content = await documentOf(files);
    if (!content) return await broughtPlan(files);
    const { world, report } = (await library.parseWorld({ content })).world ?? {};
    if (!world || !report) return false;
    session.takeUp({ world, report, label: t("open.did") });
    return true;
  } catch (error) {
    session.say(reasonOf(error));
    return false;
  }
}

const bytesOf = async (file: File) => new Uint8Array(await file.arrayBuffer());
const isPlan = (name: string) => PLANS.some((ending) => name.toLowerCase().endsWith(ending));

async function broughtPlan(files: File[]): Promise<boolean> {
  const plan = files.find((file) => isPlan(file.name));
  if (!plan) {
    session.say(t("open.none"));
    return false;
  }
  const others = await Promise.all(files.filter((f) => f !== plan).map(async (f) => [f.name, await bytesOf(f)] as const));
  return session.bring(plan.name, await bytesOf(plan), Object.fromEntries(others));
}

async function documentOf(files: File[]): Promise<Uint8Array | undefined> {
  const only = files.length === 1 && files[0].name.endsWith(".json") && !isPlan(files[0].name) ? files[0] : undefined;
  const named = files.find((f) => f.name === WORLD) ?? only;
  if (named) return bytesOf(named);
  const archive = files.find((f) => f.name.endsWith(".zip"));
  return archive && unzipped(await archive.arrayBuffer(), (path) => path === WORLD || path.endsWith(`/${WORLD}`));
}
