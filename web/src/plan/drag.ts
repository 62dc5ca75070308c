/** What happens while something is dragged: where it goes, what it snaps to, and the edit that it comes to. */
import type { Segment } from "../gen/d3dgen/v1/floorplan_pb";
import type { World } from "../gen/d3dgen/v1/world_pb";
import { areaOf, boundsOf, corners, ends, footprint, inside, onStep, type P, reach, STEP, tidy } from "../lib/geometry";
import type { EditInit } from "../lib/session.svelte";
import { t } from "../lib/texts.svelte";
import { withWallMoved } from "../lib/walls";
import { nameOf, objectOf, roomOf, snapLines, withDoorMoved, withMoved, withWindowMoved } from "../lib/world";

/** A wall stops before a room has less floor than this, m2. */
const LEAST = 0.3;

/** A straight line across the plan that something snapped to. */
export interface Guide {
  x?: number;
  y?: number;
}

/** A distance that is shown while dragging. */
export interface Dimension {
  from: P;
  to: P;
}

/** Where a drag has come to. */
export interface Dragged {
  world: World;
  guides: Guide[];
  dimensions: Dimension[];
  label: string;
  /** What the server is to do; nothing where the documents are changed as they are. */
  edits: EditInit[];
}

/** Something that can be dragged: `to` tells what comes of dragging it by so much, `snap` m being near enough to snap. */
export interface Drag {
  to(by: P, snap: number): Dragged | undefined;
}

function nearest(edges: number[], lines: number[], by: number, snap: number): { by: number; line: number } | undefined {
  let best: { by: number; line: number; off: number } | undefined;
  for (const edge of edges) {
    for (const line of lines) {
      const off = Math.abs(edge + by - line);
      if (off < (best?.off ?? snap)) best = { by: line - edge, line, off };
    }
  }
  return best;
}

function roomDimensions(world: World, id: string): Dimension[] {
  const object = objectOf(world, id);
  const net = corners(roomOf(world, object?.roomId ?? "")?.netPolygon);
  if (!object || net.length === 0) return [];
  const box = boundsOf(footprint(object));
  const middle = { x: (box.minX + box.maxX) / 2, y: (box.minY + box.maxY) / 2 };
  const sides: [P, number, number][] = [
    [{ x: box.maxX, y: middle.y }, 1, 0],
    [{ x: box.minX, y: middle.y }, -1, 0],
    [{ x: middle.x, y: box.maxY }, 0, 1],
    [{ x: middle.x, y: box.minY }, 0, -1],
  ];
  return sides.flatMap(([from, dx, dy]) => {
    const far = reach(net, from, dx, dy);
    return far === undefined || far < 0.02 ? [] : [{ from, to: { x: from.x + dx * far, y: from.y + dy * far } }];
  });
}

export function ofObjects(world: World, ids: string[]): Drag {
  const first = objectOf(world, ids[0]);
  const box = boundsOf(first ? footprint(first) : []);
  const lines = snapLines(world, ids[0]);
  const label = t("did.moved", { name: nameOf(world, ids[0]) });
  return {
    to(by, snap) {
      const x = nearest([box.minX, (box.minX + box.maxX) / 2, box.maxX], lines.x, by.x, snap);
      const y = nearest([box.minY, (box.minY + box.maxY) / 2, box.maxY], lines.y, by.y, snap);
      const go = { x: x?.by ?? onStep(by.x), y: y?.by ?? onStep(by.y) };
      const moved = withMoved(world, ids, go);
      const edits = ids.flatMap((id): EditInit[] => {
        const pose = objectOf(moved, id)?.pose;
        return pose ? [{ case: "movedObject", value: { placementId: id, xM: pose.xM, yM: pose.yM } }] : [];
      });
      const guides: Guide[] = [...(x ? [{ x: x.line }] : []), ...(y ? [{ y: y.line }] : [])];
      return { world: moved, guides, dimensions: roomDimensions(moved, ids[0]), label, edits };
    },
  };
}

export function ofWall(world: World, wallId: string): Drag {
  const walls = world.floorplan?.walls ?? [];
  const line = ends(walls.find((w) => w.wallId === wallId)?.line);
  const upright = Math.abs(line.along.y) > Math.abs(line.along.x);
  const across = (p: P) => (upright ? p.x : p.y);
  const lines = walls
    .filter((w) => w.wallId !== wallId)
    .map((w) => ends(w.line))
    .filter((l) => Math.abs(l.along.y) > Math.abs(l.along.x) === upright)
    .map((l) => across(l.a));
  const label = t("did.wall");
  /** Leaves every room at the wall a floor. */
  const leaves = (moved: World, sides: string[]) =>
    sides.every((id) => {
      const room = roomOf(moved, id);
      return room !== undefined && areaOf(corners(room.netPolygon)) > LEAST && areaOf(corners(room.polygon)) > LEAST;
    });
  let last: Dragged | undefined;
  return {
    to(by, snap) {
      const from = across(line.a);
      const snapped = nearest([from], lines.filter((l) => Math.abs(l - from) > 0.01), across(by), snap);
      const go = tidy(onStep(snapped?.by ?? across(by)));
      if (go === 0) return undefined;
      const moved = withWallMoved(world, wallId, go);
      const sides = walls.find((w) => w.wallId === wallId)?.roomIds ?? [];
      if (!moved || !leaves(moved, sides)) return last;
      const guides: Guide[] = snapped ? [upright ? { x: snapped.line } : { y: snapped.line }] : [];
      const dimensions = sides.flatMap((id): Dimension[] => {
        const net = corners(roomOf(moved, id)?.netPolygon);
        if (net.length === 0) return [];
        const middle = { x: (line.a.x + line.b.x) / 2, y: (line.a.y + line.b.y) / 2 };
        const spot = upright ? { x: middle.x + go, y: middle.y } : { x: middle.x, y: middle.y + go };
        const box = boundsOf(net);
        const low = upright ? box.minX : box.minY;
        const high = upright ? box.maxX : box.maxY;
        const sign = (low + high) / 2 > across(spot) ? 1 : -1;
        const start = upright ? { x: spot.x + sign * 0.13, y: spot.y } : { x: spot.x, y: spot.y + sign * 0.13 };
        const far = reach(net, start, upright ? sign : 0, upright ? 0 : sign);
        if (far === undefined) return [];
        const to = upright ? { x: start.x + sign * far, y: start.y } : { x: start.x, y: start.y + sign * far };
        return [{ from: start, to }];
      });
      last = { world: moved, guides, dimensions, label, edits: [{ case: "movedWall", value: { wallId, byM: go } }] };
      return last;
    },
  };
}

/** A door or a window in its wall. */
interface Opening {
  id: string;
  label: string;
  /** A room at whose side it is. */
  roomId: string;
  lineIn(world: World): Segment | undefined;
  /** Returns the world with it moved along its line by so much, m; nothing where it cannot go so far. */
  moved(by: number): World | undefined;
}

function ofOpening(world: World, opening: Opening): Drag {
  const line = ends(opening.lineIn(world));
  return {
    to(by) {
      const wished = onStep(by.x * line.along.x + by.y * line.along.y);
      let moved: World | undefined;
      // as far as there is wall
      for (let left = Math.abs(wished); !moved && left > STEP / 2; left -= STEP) moved = opening.moved(Math.sign(wished) * left);
      if (!moved) return undefined;
      const now = ends(opening.lineIn(moved));
      const outline = corners(roomOf(world, opening.roomId)?.polygon);
      const dimensions = [-1, 1].flatMap((sign): Dimension[] => {
        const from = sign < 0 ? now.a : now.b;
        const far = besideOf(outline, from, now.across, { x: now.along.x * sign, y: now.along.y * sign });
        return far === undefined ? [] : [{ from, to: { x: from.x + now.along.x * sign * far, y: from.y + now.along.y * sign * far } }];
      });
      const east = line.along.x > 1e-3 || (Math.abs(line.along.x) <= 1e-3 && line.along.y > 0) ? 1 : -1;
      const byM = tidy(((now.a.x - line.a.x) * line.along.x + (now.a.y - line.a.y) * line.along.y) * east);
      const edits: EditInit[] = [{ case: "movedOpening", value: { openingId: opening.id, byM } }];
      return { world: moved, guides: [], dimensions, label: opening.label, edits };
    },
  };
}

/** Returns how much wall is beside the end of an opening in a direction, m; the room may be on either side. */
function besideOf(outline: P[], from: P, across: P, along: P): number | undefined {
  const [left, right] = [1, -1].map((side) => ({ x: from.x + across.x * 0.01 * side, y: from.y + across.y * 0.01 * side }));
  const inward = inside(outline, left) ? left : right;
  return reach(outline, inward, along.x, along.y);
}

export function ofDoor(world: World, doorId: string): Drag {
  const doorIn = (w: World) => w.floorplan?.doors.find((d) => d.doorId === doorId);
  return ofOpening(world, {
    id: doorId,
    label: t("did.door"),
    roomId: doorIn(world)?.roomIds[0] ?? "",
    lineIn: (w) => doorIn(w)?.line,
    moved: (by) => withDoorMoved(world, doorId, by),
  });
}

export function ofWindow(world: World, windowId: string): Drag {
  const windowIn = (w: World) => w.floorplan?.windows.find((one) => one.windowId === windowId);
  return ofOpening(world, {
    id: windowId,
    label: t("did.window"),
    roomId: windowIn(world)?.roomId ?? "",
    lineIn: (w) => windowIn(w)?.line,
    moved: (by) => withWindowMoved(world, windowId, by),
  });
}
