/** Geometry of plans: meters, x east, y north, counter-clockwise. */
import type { Point, Polygon } from "../gen/d3dgen/v1/common_pb";
import type { Segment } from "../gen/d3dgen/v1/floorplan_pb";
import type { Placement } from "../gen/d3dgen/v1/placements_pb";

export interface P {
  x: number;
  y: number;
}

export interface Box {
  minX: number;
  minY: number;
  maxX: number;
  maxY: number;
}

/** Steps of lengths on the plan, m. */
export const STEP = 0.05;

export const point = (p: Point | undefined): P => ({ x: p?.xM ?? 0, y: p?.yM ?? 0 });
export const corners = (polygon: Polygon | undefined): P[] => (polygon?.corners ?? []).map(point);
export const onStep = (value: number): number => Math.round(value / STEP) * STEP;

/** Returns a length as it is stored: without the noise of sums. */
export const tidy = (value: number): number => Math.round(value * 1e4) / 1e4;

/** Returns start, end, length and direction of a segment. */
export function ends(line: Segment | undefined) {
  const a = point(line?.start);
  const b = point(line?.end);
  const length = Math.hypot(b.x - a.x, b.y - a.y);
  const along = length > 0 ? { x: (b.x - a.x) / length, y: (b.y - a.y) / length } : { x: 1, y: 0 };
  return { a, b, length, along, across: { x: -along.y, y: along.x } };
}

/** Returns the four corners of a strip along a segment, longer by `more` at both ends. */
export function strip(line: Segment | undefined, thickness: number, more = 0): P[] {
  const { a, b, along, across } = ends(line);
  const at = (p: P, l: number, s: number) => ({
    x: p.x + along.x * l + (across.x * s * thickness) / 2,
    y: p.y + along.y * l + (across.y * s * thickness) / 2,
  });
  return [at(a, -more, -1), at(b, more, -1), at(b, more, 1), at(a, -more, 1)];
}

/** Returns the corners of an object's footprint: its depth lies along its front's heading. */
export function footprint(placement: Placement): P[] {
  const pose = placement.pose;
  const [depth, width] = [placement.sizeM?.depthM ?? 0, placement.sizeM?.widthM ?? 0];
  const [c, s] = [Math.cos(pose?.yawRad ?? 0), Math.sin(pose?.yawRad ?? 0)];
  const at = (x: number, y: number) => ({ x: (pose?.xM ?? 0) + x * c - y * s, y: (pose?.yM ?? 0) + x * s + y * c });
  const [d, w] = [depth / 2, width / 2];
  return [at(-d, -w), at(d, -w), at(d, w), at(-d, w)];
}

export function boundsOf(points: P[]): Box {
  const box = { minX: Infinity, minY: Infinity, maxX: -Infinity, maxY: -Infinity };
  for (const p of points) {
    box.minX = Math.min(box.minX, p.x);
    box.minY = Math.min(box.minY, p.y);
    box.maxX = Math.max(box.maxX, p.x);
    box.maxY = Math.max(box.maxY, p.y);
  }
  return box;
}

export function inside(polygon: P[], p: P): boolean {
  let within = false;
  for (let i = 0, j = polygon.length - 1; i < polygon.length; j = i++) {
    const [a, b] = [polygon[i], polygon[j]];
    if (a.y > p.y !== b.y > p.y && p.x < ((b.x - a.x) * (p.y - a.y)) / (b.y - a.y) + a.x) within = !within;
  }
  return within;
}

/** Returns where a ray along an axis meets an outline first: the distance from `from`, or nothing. */
export function reach(polygon: P[], from: P, dx: number, dy: number): number | undefined {
  let nearest: number | undefined;
  for (let i = 0, j = polygon.length - 1; i < polygon.length; j = i++) {
    const [a, b] = [polygon[j], polygon[i]];
    const [ex, ey] = [b.x - a.x, b.y - a.y];
    const cross = dx * ey - dy * ex;
    if (Math.abs(cross) < 1e-9) continue;
    const along = ((a.x - from.x) * ey - (a.y - from.y) * ex) / cross;
    const share = ((a.x - from.x) * dy - (a.y - from.y) * dx) / cross;
    if (along > 1e-6 && share >= 0 && share <= 1) nearest = Math.min(nearest ?? Infinity, along);
  }
  return nearest;
}

/** Returns the area of an outline, m2; below 0 for one that runs clockwise. */
export function areaOf(polygon: P[]): number {
  let twice = 0;
  for (let i = 0, j = polygon.length - 1; i < polygon.length; j = i++) {
    twice += polygon[j].x * polygon[i].y - polygon[i].x * polygon[j].y;
  }
  return twice / 2;
}

/** Returns a point well inside of an outline, for its label: the best of a small grid. */
export function labelPoint(polygon: P[]): P {
  const box = boundsOf(polygon);
  const [w, h] = [box.maxX - box.minX, box.maxY - box.minY];
  let best = { x: box.minX + w / 2, y: box.minY + h / 2 };
  let free = -1;
  for (let i = 1; i < 8; i++) {
    for (let j = 1; j < 8; j++) {
      const p = { x: box.minX + (w * i) / 8, y: box.minY + (h * j) / 8 };
      if (!inside(polygon, p)) continue;
      const sides = [reach(polygon, p, 1, 0), reach(polygon, p, -1, 0), reach(polygon, p, 0, 1), reach(polygon, p, 0, -1)];
      const [e, west, n, s] = sides.map((side) => side ?? 0);
      // names are wide: room to the sides counts most, and the middle of it
      const score = Math.min(e, west) + 0.6 * Math.min(n, s);
      if (score > free + 1e-9) [best, free] = [p, score];
    }
  }
  return best;
}
