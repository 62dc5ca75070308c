/** A scenario moved by the server: where everybody was, and what came of it. */
import type { World } from "../gen/d3dgen/v1/world_pb";
import { gathered, worlds } from "./api";
import type { P } from "./geometry";
import { unzipped } from "./zip";

/** Where somebody was: time, s, x and y, m, and the storey. */
type Sample = [number, number, number, string];

/** Somebody, or a robot, over the time. */
export interface Track {
  id: string;
  role: string;
  radius: number;
  samples: Sample[];
}

/** Figures of a robot or a person; absent where it met nobody. */
export interface MoverFigures {
  role: string;
  tasks_done: number;
  tasks_missed: number;
  path_length_m: number;
  closest_person_m?: number | null;
  time_in_intimate_space_s?: number;
  time_in_personal_space_s?: number;
}

/** Figures of social navigation, as `metrics.json` has them. */
export interface CrowdFigures {
  seconds: number;
  people: number;
  robots: Record<string, MoverFigures>;
  agents: Record<string, MoverFigures>;
  all: { tasks_done: number; tasks_missed: number; path_length_m: number; closest_m: number | null; time_in_intimate_space_s: number };
  conditions: { condition_id: string; text: string; holds: boolean | null }[];
}

export interface Simulation {
  people: Track[];
  robots: Track[];
  figures: CrowdFigures;
}

/** Returns a world's scenario as it goes for so many seconds. */
export async function simulated(world: World, seconds: number): Promise<Simulation> {
  const archive = await (await gathered(worlds.simulateWorld({ world, seconds }))).arrayBuffer();
  const read = async (name: string): Promise<unknown> => {
    const file = await unzipped(archive, (path) => path.endsWith(name));
    if (!file) throw new Error(`the server sent no ${name}`);
    return JSON.parse(new TextDecoder().decode(file));
  };
  const { agents, robots } = (await read("trajectory.json")) as { agents: Track[]; robots: Track[] };
  return { people: agents, robots, figures: (await read("metrics.json")) as CrowdFigures };
}

/** Returns where somebody is at a time, on a storey; nothing while they are elsewhere. */
export function spotOf(track: Track, seconds: number, level: number): P | undefined {
  const { samples } = track;
  let [low, high] = [0, samples.length - 1];
  if (high < 0 || seconds < samples[0][0] || seconds > samples[high][0]) return undefined;
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (samples[middle][0] <= seconds) low = middle;
    else high = middle;
  }
  const [a, b] = [samples[low], samples[high]];
  if (Number(a[3]) !== level) return undefined;
  const share = b[0] > a[0] && a[3] === b[3] ? Math.min(1, (seconds - a[0]) / (b[0] - a[0])) : 0;
  return { x: a[1] + (b[1] - a[1]) * share, y: a[2] + (b[2] - a[2]) * share };
}
