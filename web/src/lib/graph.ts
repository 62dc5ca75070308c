/** Rooms and their relations with one thing put otherwise, before the building is planned anew. */
import { clone, create } from "@bufbuild/protobuf";

import { Connector, type GraphEdge, GraphEdgeSchema, type SceneGraph, SceneGraphSchema } from "../gen/d3dgen/v1/scene_graph_pb";

/** Reason that a relation has which a person asked for. */
const BY_PERSON = "asked for on the page";

const joins = (edge: GraphEdge, a: string, b: string) =>
  (edge.aRoomId === a && edge.bRoomId === b) || (edge.aRoomId === b && edge.bRoomId === a);

/** Returns the relations of a room, each with the room at its other end. */
export function linksOf(graph: SceneGraph, roomId: string): { edge: GraphEdge; other: string }[] {
  return graph.edges.flatMap((edge) => {
    if (edge.aRoomId === roomId) return [{ edge, other: edge.bRoomId }];
    return edge.bRoomId === roomId ? [{ edge, other: edge.aRoomId }] : [];
  });
}

/** Returns the graph with another area to aim for; the limits of the room give way where it lies outside of them. */
export function withArea(graph: SceneGraph, roomId: string, areaM2: number): SceneGraph {
  const next = clone(SceneGraphSchema, graph);
  const room = next.rooms.find((r) => r.roomId === roomId);
  if (!room) return next;
  room.targetAreaM2 = areaM2;
  if (room.areaRangeM2) {
    room.areaRangeM2.minM2 = Math.min(room.areaRangeM2.minM2, areaM2);
    room.areaRangeM2.maxM2 = Math.max(room.areaRangeM2.maxM2, areaM2);
  }
  return next;
}

/** Returns the graph with two rooms joined so, or not joined without a connector. */
export function withLink(graph: SceneGraph, a: string, b: string, connector: Connector | undefined): SceneGraph {
  const next = clone(SceneGraphSchema, graph);
  const known = next.edges.find((edge) => joins(edge, a, b));
  if (connector === undefined) next.edges = next.edges.filter((edge) => edge !== known);
  else if (known) Object.assign(known, { connector, required: true, reason: BY_PERSON });
  else next.edges.push(create(GraphEdgeSchema, { aRoomId: a, bRoomId: b, connector, required: true, reason: BY_PERSON }));
  return next;
}
