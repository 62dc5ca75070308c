/** Rooms as circles of their area, near where they lie on the plan and clear of each other. */
import type { World } from "../gen/d3dgen/v1/world_pb";
import { corners, labelPoint } from "./geometry";
import { names } from "./names.svelte";
import { roomOf } from "./world";

export interface Bubble {
  id: string;
  name: string;
  area: number;
  circulation: boolean;
  x: number;
  y: number;
  r: number;
}

const ROUNDS = 60;
const GAP = 0.25;

/** Returns the bubbles of a storey; before there is a plan, they begin on a circle. */
export function bubblesOf(world: World, level: number): Bubble[] {
  const rooms = (world.sceneGraph?.rooms ?? []).filter((r) => r.level === level);
  const bubbles = rooms.map((room, i): Bubble => {
    const planned = roomOf(world, room.roomId);
    const turn = (i / rooms.length) * 2 * Math.PI;
    const at = planned ? labelPoint(corners(planned.polygon)) : { x: 6 * Math.cos(turn), y: 6 * Math.sin(turn) };
    const area = planned?.netAreaM2 ?? room.targetAreaM2;
    return { id: room.roomId, name: names.room(room), area, circulation: room.circulation, ...at, r: Math.sqrt(area / Math.PI) };
  });
  for (let round = 0; round < ROUNDS && push(bubbles); round++);
  return bubbles;
}

/** Pushes bubbles that overlap apart by half of what is missing; returns true while some did. */
function push(bubbles: Bubble[]): boolean {
  let moved = false;
  for (let i = 0; i < bubbles.length; i++) {
    for (let j = i + 1; j < bubbles.length; j++) {
      const [a, b] = [bubbles[i], bubbles[j]];
      const [dx, dy] = [b.x - a.x || 0.01, b.y - a.y];
      const far = Math.hypot(dx, dy);
      const lacking = a.r + b.r + GAP - far;
      if (lacking < 1e-3) continue;
      const share = lacking / far / 2;
      a.x -= dx * share;
      a.y -= dy * share;
      b.x += dx * share;
      b.y += dy * share;
      moved = true;
    }
  }
  return moved;
}
