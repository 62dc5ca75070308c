/** A wall moved across its line, and the rooms and walls at its sides with it. */
import type { Door, Floorplan, PlanRoom, Segment, Wall } from "../gen/d3dgen/v1/floorplan_pb";
import type { World } from "../gen/d3dgen/v1/world_pb";
import { areaOf, corners, ends, inside, type P, point, tidy } from "./geometry";

/** Two points nearer than this are one, m. */
const ONE = 1e-3;

/** Rooms as a key, in any order. */
const sidesOf = (roomIds: string[]) => [...roomIds].sort().join();

/** Returns all pieces of the wall that a piece belongs to: those on its line that part the same two sides. */
export function wallPieces(plan: Floorplan, wallId: string): Wall[] {
  const piece = plan.walls.find((w) => w.wallId === wallId);
  if (!piece) return [];
  const { a, across } = ends(piece.line);
  const off = (p: P) => Math.abs((p.x - a.x) * across.x + (p.y - a.y) * across.y);
  return plan.walls.filter((w) => {
    const line = ends(w.line);
    return sidesOf(w.roomIds) === sidesOf(piece.roomIds) && off(line.a) < ONE && off(line.b) < ONE;
  });
}

/** The strip of floor that a moved wall sweeps: `l` along the wall, `o` across it, from the wall's line. */
interface Strip {
  from: number;
  to: number;
  /** Width with its sign, m. */
  by: number;
  l(p: P): number;
  o(p: P): number;
  at(l: number, o: number): P;
  /** Half the thickness of the wall, m. */
  half: number;
}

function stripOf(pieces: Wall[], doors: Door[], by: number): Strip {
  const { a, along, across } = ends(pieces[0].line);
  const l = (p: P) => (p.x - a.x) * along.x + (p.y - a.y) * along.y;
  const o = (p: P) => (p.x - a.x) * across.x + (p.y - a.y) * across.y;
  const inIt = [...pieces, ...doors].flatMap(({ line }) => [point(line?.start), point(line?.end)]).filter((p) => Math.abs(o(p)) < ONE);
  const spots = inIt.map(l);
  return {
    from: Math.min(...spots),
    to: Math.max(...spots),
    // towards east or north, as WallMove counts
    by: across.x + across.y > 0 ? by : -by,
    l,
    o,
    at: (along1, across1) => ({
      x: tidy(a.x + along.x * along1 + across.x * across1),
      y: tidy(a.y + along.y * along1 + across.y * across1),
    }),
    half: Math.max(...pieces.map((w) => w.thicknessM)) / 2,
  };
}

/**
 * Returns an outline whose side along the strip is moved with it: a side that goes on beyond the strip gets corners there, `inset` m
 * within it. Nothing where a side beside it would have less than no length. `slack` is how far the side may be from the wall's line, m.
 */
function withSideMoved(outline: P[], strip: Strip, slack: number, inset: number): P[] | undefined {
  // a stub of wall shorter than this gets no corners of its own: it moves with the strip
  const stub = 2 * slack + ONE;
  const [low, high] = [strip.from + inset - stub, strip.to - inset + stub];
  const onLine = (p: P) => Math.abs(strip.o(p)) <= slack;
  const span = (p: P, q: P) => [strip.l(p), strip.l(q)].sort((a, b) => a - b);
  const isSide = (p: P, q: P) => onLine(p) && onLine(q) && span(p, q)[0] < strip.to - slack - ONE && span(p, q)[1] > strip.from + slack + ONE;
  const moved = (p: P) => strip.at(strip.l(p), strip.o(p) + strip.by);
  const square = straightened(outline);
  const found: P[] = [];
  for (const [i, p] of square.entries()) {
    const [before, q] = [square.at(i - 1) as P, square[(i + 1) % square.length]];
    const moves = (isSide(p, q) || isSide(before, p)) && strip.l(p) >= low && strip.l(p) <= high;
    if (moves && !keepsDirection(strip, p, isSide(p, q) ? before : q)) return undefined;
    found.push(moves ? moved(p) : p);
    if (!isSide(p, q)) continue;
    const [least, most] = span(p, q);
    const reaches = (cut: number) => cut > least + stub && cut < most - stub;
    const cuts = [strip.from + inset, strip.to - inset].map((cut) => ({ cut, enters: cut === strip.from + inset }));
    const ahead = strip.l(q) > strip.l(p);
    for (const { cut, enters } of ahead ? cuts : cuts.reverse()) {
      if (!reaches(cut)) continue;
      const corner = strip.at(cut, strip.o(p));
      found.push(...(enters === ahead ? [corner, moved(corner)] : [moved(corner), corner]));
    }
  }
  return found;
}

/** Returns an outline without the corners that lie on a straight side. */
function straightened(outline: P[]): P[] {
  return outline.filter((p, i) => {
    const [a, b] = [outline.at(i - 1) as P, outline[(i + 1) % outline.length]];
    return Math.abs((p.x - a.x) * (b.y - p.y) - (p.y - a.y) * (b.x - p.x)) > 1e-6;
  });
}

/** Returns whether the side from a corner that moves to one that stays keeps its direction. */
function keepsDirection(strip: Strip, corner: P, stays: P): boolean {
  const length = strip.o(stays) - strip.o(corner);
  return length * (length - strip.by) > 0;
}

function roomMoved(room: PlanRoom, strip: Strip, grows: boolean): PlanRoom | undefined {
  const moved = <T extends { corners: object[] }>(outline: T | undefined, points: P[], slack: number, inset: number): T | undefined => {
    const after = withSideMoved(points, strip, slack, inset);
    return outline && after && { ...outline, corners: after.map((p) => ({ ...outline.corners[0], xM: p.x, yM: p.y })) };
  };
  const polygon = moved(room.polygon, corners(room.polygon), ONE, 0);
  const netPolygon = moved(room.netPolygon, corners(room.netPolygon), strip.half + 0.01, grows ? strip.half : -strip.half);
  return polygon && netPolygon && { ...room, polygon, netPolygon, netAreaM2: tidy(areaOf(corners(netPolygon))) };
}

/** The walls of a storey after the strip: those that were in it part other rooms now. */
function wallsMoved(walls: Wall[], pieces: Wall[], strip: Strip, shrinks: string | undefined, grows: string | undefined): Wall[] {
  const moving = new Set(pieces.map((w) => w.wallId));
  const segment = (line: Segment, a: P, b: P): Segment =>
    ({ ...line, start: { ...line.start, xM: a.x, yM: a.y }, end: { ...line.end, xM: b.x, yM: b.y } }) as Segment;
  const kept = walls.filter((w) => !moving.has(w.wallId));
  const found: Wall[] = pieces.map((w) => {
    const line = ends(w.line);
    const at = (p: P) => strip.at(strip.l(p), strip.by);
    return { ...w, line: segment(w.line as Segment, at(line.a), at(line.b)) };
  });
  for (const end of [strip.from, strip.to]) {
    const [corner, far] = [strip.at(end, 0), strip.at(end, strip.by)];
    const same = (p: P) => Math.hypot(p.x - corner.x, p.y - corner.y) < strip.half + 0.01;
    const ahead = (p: P) => (shrinks ? strip.o(p) * strip.by > ONE : strip.o(p) * strip.by < -ONE);
    const beside = kept.findIndex((w) => {
      const { a, b } = ends(w.line);
      const meets = (same(a) && ahead(b)) || (same(b) && ahead(a));
      return meets && (shrinks ? w.roomIds.includes(shrinks) : w.exterior);
    });
    const piece = { ...pieces[0], wallId: `${pieces[0].wallId}_${end === strip.from ? "start" : "end"}`, line: segment(pieces[0].line as Segment, corner, far) };
    if (beside < 0) {
      found.push(piece); // what went straight on stays, and the wall turns the corner
      continue;
    }
    const wall = kept[beside];
    const { a, b } = ends(wall.line);
    kept[beside] = { ...wall, line: segment(wall.line as Segment, same(a) ? far : a, same(b) ? far : b) };
    // what parted the room that shrinks from a third one now parts the room that grows from it
    const roomIds = wall.roomIds.flatMap((id) => (id !== shrinks ? [id] : grows ? [grows] : []));
    if (shrinks && roomIds.length > 0) found.push({ ...wall, wallId: `${wall.wallId}_strip`, roomIds, exterior: roomIds.length < 2, line: piece.line });
  }
  return [...kept, ...found];
}

/**
 * Returns the world with a wall moved across its line, the rooms at its sides with it, and nothing else repaired; nothing where a
 * wall beside it ends before.
 */
export function withWallMoved(world: World, wallId: string, by: number): World | undefined {
  const plan = world.floorplan;
  const pieces = plan ? wallPieces(plan, wallId) : [];
  if (!plan || pieces.length === 0) return undefined;
  const sides = pieces[0].roomIds;
  const strip = stripOf(pieces, plan.doors.filter((d) => sidesOf(d.roomIds) === sidesOf(sides)), by);
  const ahead = strip.at((strip.from + strip.to) / 2, Math.sign(strip.by) * 0.2);
  const shrinks = sides.find((id) => inside(corners(plan.rooms.find((r) => r.roomId === id)?.polygon), ahead));
  const grows = sides.find((id) => id !== shrinks);
  const rooms = plan.rooms.map((room) => (sides.includes(room.roomId) ? roomMoved(room, strip, room.roomId === grows) : room));
  if (!rooms.every((room) => room !== undefined)) return undefined;
  const inStrip = (p: P) => Math.abs(strip.o(p)) < ONE && strip.l(p) > strip.from - ONE && strip.l(p) < strip.to + ONE;
  const opening = <T extends { line?: Segment }>(one: T): T => {
    const { a, b } = ends(one.line);
    if (!one.line?.start || !one.line.end || !inStrip(a) || !inStrip(b)) return one;
    const [start, end] = [a, b].map((p) => strip.at(strip.l(p), strip.by));
    return { ...one, line: { ...one.line, start: { ...one.line.start, xM: start.x, yM: start.y }, end: { ...one.line.end, xM: end.x, yM: end.y } } };
  };
  return {
    ...world,
    floorplan: {
      ...plan,
      rooms,
      walls: wallsMoved(plan.walls, pieces, strip, shrinks, grows),
      doors: plan.doors.map((d) => (d.roomIds.some((id) => sides.includes(id)) ? opening(d) : d)),
      windows: plan.windows.map((w) => (sides.includes(w.roomId) ? opening(w) : w)),
    },
  };
}
