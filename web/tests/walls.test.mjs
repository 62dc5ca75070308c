/** A wall that is dragged leaves square rooms that share the floor among them as before, whatever the rooms beside it look like. */
import assert from "node:assert/strict";
import path from "node:path";
import { before, test } from "node:test";
import { pathToFileURL } from "node:url";
import { build } from "vite";

const source = path.resolve(import.meta.dirname, "../src/lib/walls.ts");
let walls;

before(async () => {
  const made = await build({ configFile: false, logLevel: "error", build: { write: false, lib: { entry: source, formats: ["es"], fileName: "walls" } } });
  const code = [made].flat()[0].output[0].code;
  walls = await import(`data:text/javascript;base64,${Buffer.from(code).toString("base64")}#${pathToFileURL(source)}`);
});

const at = ([xM, yM]) => ({ xM, yM });
const outline = (points) => ({ corners: points.map(at) });

/** Returns a room of corners on walls' center lines, its net outline 0.06 m within. */
function room(roomId, points) {
  const inward = (a, b) => [Math.sign(a[1] - b[1]), Math.sign(b[0] - a[0])];
  const net = points.map((p, i) => {
    const [one, two] = [inward(points.at(i - 1), p), inward(p, points[(i + 1) % points.length])];
    return [p[0] + 0.06 * (one[0] + two[0]), p[1] + 0.06 * (one[1] + two[1])];
  });
  return { roomId, level: 0, polygon: outline(points), netPolygon: outline(net), netAreaM2: 0 };
}

const wall = (wallId, roomIds, start, end) => ({ wallId, roomIds, exterior: roomIds.length < 2, thicknessM: 0.12, line: { start: at(start), end: at(end) } });

/** Two rooms whose common wall ends a little before the side of the lower one does. */
const offset = () => ({
  floorplan: {
    rooms: [
      room("low", [[3.55, 7], [6.35, 7], [6.35, 8.95], [3.55, 8.95]]),
      room("high", [[3.7, 8.95], [6.35, 8.95], [6.35, 10.9], [3.7, 10.9]]),
      room("round", [[0, 5], [6.35, 5], [6.35, 7], [3.55, 7], [3.55, 8.95], [3.7, 8.95], [3.7, 10.9], [6.35, 10.9], [6.35, 12], [0, 12]]),
    ],
    walls: [
      wall("low_high", ["low", "high"], [3.7, 8.95], [6.35, 8.95]),
      wall("stub", ["low", "round"], [3.55, 8.95], [3.7, 8.95]),
      wall("low_west", ["low", "round"], [3.55, 7], [3.55, 8.95]),
      wall("low_south", ["low", "round"], [3.55, 7], [6.35, 7]),
      wall("high_west", ["high", "round"], [3.7, 8.95], [3.7, 10.9]),
      wall("high_north", ["high", "round"], [3.7, 10.9], [6.35, 10.9]),
      wall("low_east", ["low"], [6.35, 7], [6.35, 8.95]),
      wall("high_east", ["high"], [6.35, 8.95], [6.35, 10.9]),
    ],
    doors: [],
    windows: [],
  },
});

/** Two rooms above a corridor with six corners, which goes up between them and a third one. */
const world = () => ({
  floorplan: {
    rooms: [
      room("a", [[0, 2], [4, 2], [4, 6], [0, 6]]),
      room("b", [[4, 2], [7, 2], [7, 6], [4, 6]]),
      room("hall", [[0, 0], [9, 0], [9, 6], [7, 6], [7, 2], [0, 2]]),
    ],
    walls: [
      wall("a_hall", ["a", "hall"], [0, 2], [1, 2]),
      wall("a_hall_2", ["a", "hall"], [2, 2], [4, 2]),
      wall("b_hall", ["b", "hall"], [4, 2], [7, 2]),
      wall("b_hall_side", ["b", "hall"], [7, 2], [7, 6]),
      wall("a_b", ["a", "b"], [4, 2], [4, 6]),
      wall("a_west", ["a"], [0, 2], [0, 6]),
      wall("a_north", ["a"], [0, 6], [4, 6]),
      wall("b_north", ["b"], [4, 6], [7, 6]),
      wall("hall_west", ["hall"], [0, 0], [0, 2]),
      wall("hall_south", ["hall"], [0, 0], [9, 0]),
      wall("hall_east", ["hall"], [9, 0], [9, 6]),
      wall("hall_north", ["hall"], [7, 6], [9, 6]),
    ],
    doors: [{ doorId: "door", roomIds: ["a", "hall"], line: { start: at([1, 2]), end: at([2, 2]) } }],
    windows: [],
  },
});

function area(corners) {
  return corners.reduce((sum, p, i) => sum + (p.xM * corners[(i + 1) % corners.length].yM - corners[(i + 1) % corners.length].xM * p.yM) / 2, 0);
}

function square(corners) {
  return corners.every((p, i) => {
    const [a, b] = [corners.at(i - 1), corners[(i + 1) % corners.length]];
    const [one, two] = [[p.xM - a.xM, p.yM - a.yM], [b.xM - p.xM, b.yM - p.yM]];
    return Math.abs(one[0] * two[0] + one[1] * two[1]) < 1e-9 && one.filter((v) => Math.abs(v) > 1e-6).length === 1;
  });
}

/** Returns whether a side of an outline is covered by walls and doors of its room, to the last centimeter. */
function enclosed({ floorplan: plan }, { roomId, polygon }) {
  return polygon.corners.every((a, i) => {
    const b = polygon.corners[(i + 1) % polygon.corners.length];
    const length = Math.hypot(b.xM - a.xM, b.yM - a.yM);
    const along = [(b.xM - a.xM) / length, (b.yM - a.yM) / length];
    const place = (p) => [(p.xM - a.xM) * along[0] + (p.yM - a.yM) * along[1], (p.yM - a.yM) * along[0] - (p.xM - a.xM) * along[1]];
    const covered = [...plan.walls, ...plan.doors]
      .filter((one) => one.roomIds.includes(roomId))
      .map((one) => [place(one.line.start), place(one.line.end)])
      .filter((both) => both.every(([, off]) => Math.abs(off) < 1e-3))
      .map(([p, q]) => Math.max(0, Math.min(length, Math.max(p[0], q[0])) - Math.max(0, Math.min(p[0], q[0]))));
    return Math.abs(covered.reduce((sum, one) => sum + one, 0) - length) < 0.01;
  });
}

for (const [name, wallId, by] of [
  ["into a corridor that goes on beyond it", "a_hall", -0.5],
  ["into a room, away from such a corridor", "a_hall_2", 0.5],
  ["at the corner of a corridor with six corners", "b_hall", 0.5],
  ["there, the other way", "b_hall", -0.4],
  ["the long side of the six corners", "b_hall_side", 0.6],
  ["there, inwards", "b_hall_side", -0.6],
  ["between two rooms, to the east", "a_b", 0.7],
  ["between two rooms, to the west", "a_b", -0.7],
]) {
  test(`a wall is dragged ${name}`, () => {
    const before = world();
    const after = walls.withWallMoved(before, wallId, by);
    const floor = (w) => w.floorplan.rooms.reduce((sum, { polygon }) => sum + area(polygon.corners), 0);
    assert.ok(Math.abs(floor(after) - floor(before)) < 1e-6, `${floor(after)} m2 of ${floor(before)} m2`);
    for (const one of after.floorplan.rooms) {
      assert.ok(square(one.polygon.corners), `${one.roomId}: ${JSON.stringify(one.polygon.corners)}`);
      assert.ok(square(one.netPolygon.corners), `net of ${one.roomId}: ${JSON.stringify(one.netPolygon.corners)}`);
      assert.ok(enclosed(after, one), `walls of ${one.roomId}: ${JSON.stringify(after.floorplan.walls.filter((w) => w.roomIds.includes(one.roomId)))}`);
    }
    assert.deepEqual(before, world(), "what it was made of stays as it is");
  });
}

test("a stub beside a wall stays, and no room is left with a slit of floor", () => {
  for (const by of [-0.6, 0.6]) {
    const after = walls.withWallMoved(offset(), "low_high", by);
    for (const one of after.floorplan.rooms) {
      assert.ok(square(one.polygon.corners) && square(one.netPolygon.corners), `${by}, ${one.roomId}: ${JSON.stringify(one)}`);
    }
    for (const id of ["low", "high"]) assert.ok(enclosed(after, after.floorplan.rooms.find((one) => one.roomId === id)), `${by}: walls of ${id}`);
  }
});

test("an outer wall is dragged out and in, and the walls beside it go with it", () => {
  for (const [by, more] of [[0.5, 2], [-0.5, -2]]) {
    const after = walls.withWallMoved(world(), "a_north", by);
    const a = after.floorplan.rooms.find((one) => one.roomId === "a");
    assert.ok(square(a.polygon.corners) && Math.abs(area(a.polygon.corners) - 16 - more) < 1e-6);
    for (const one of after.floorplan.rooms) assert.ok(enclosed(after, one), `${by}: walls of ${one.roomId}`);
  }
});

test("a wall does not go beyond the end of the wall beside it", () => {
  assert.equal(walls.withWallMoved(world(), "b_hall", 4.5), undefined);
  assert.equal(walls.withWallMoved(world(), "a_hall", -2.5) === undefined, true);
});
