/** Which part of the plan is in sight. */
import type { World } from "../gen/d3dgen/v1/world_pb";
import { boundsOf, corners } from "../lib/geometry";
import { storeyOf } from "../lib/world";

/** A part of the drawing, m, y downwards. */
export interface View {
  x: number;
  y: number;
  width: number;
  height: number;
}

const MARGIN = 0.8;

/** Returns the whole storey with a margin. */
export function viewOf(world: World | undefined, level: number): View {
  const points = storeyOf(world, level).rooms.flatMap((r) => corners(r.polygon));
  if (points.length === 0) return { x: 0, y: -10, width: 12, height: 10 };
  const box = boundsOf(points);
  return {
    x: box.minX - MARGIN,
    y: -box.maxY - MARGIN,
    width: box.maxX - box.minX + 2 * MARGIN,
    height: box.maxY - box.minY + 2 * MARGIN,
  };
}

/** Returns a view nearer or farther, with a point of the drawing held where it is. */
export function zoomed(view: View, factor: number, x: number, y: number): View {
  const width = Math.min(2000, Math.max(0.5, view.width * factor));
  const by = width / view.width;
  return { x: x - (x - view.x) * by, y: y - (y - view.y) * by, width, height: view.height * by };
}
