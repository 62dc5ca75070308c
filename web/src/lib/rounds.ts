/** The round of a robot as one line, and where the robot is on it. */
import type { RobotTask } from "../gen/d3dgen/v1/scenario_pb";
import { type P, point } from "./geometry";

/** Speed at which rounds are played, m/s. */
export const SPEED = 0.8;

export interface Round {
  path: P[];
  length: number;
}

export function roundOf(robot: RobotTask): Round {
  const path = robot.routes.flatMap((route) => route.path.map(point));
  const start = { x: robot.start?.xM ?? 0, y: robot.start?.yM ?? 0 };
  const all = path.length > 0 ? path : [start];
  const length = all.slice(1).reduce((sum, p, i) => sum + Math.hypot(p.x - all[i].x, p.y - all[i].y), 0);
  return { path: all, length };
}

/** Returns the point of a round so far along it, m. */
export function alongOf(round: Round, far: number): P {
  let left = far;
  for (let i = 1; i < round.path.length; i++) {
    const [a, b] = [round.path[i - 1], round.path[i]];
    const length = Math.hypot(b.x - a.x, b.y - a.y);
    if (left <= length && length > 0) return { x: a.x + ((b.x - a.x) * left) / length, y: a.y + ((b.y - a.y) * left) / length };
    left -= length;
  }
  return round.path[round.path.length - 1];
}
