// For Node: gRPC itself.

import { createGrpcTransport } from "@connectrpc/connect-node";

import { Client, interceptors, type Settings } from "./client.js";

export * from "./client.js";
export type { CheckedWorld } from "../gen/d3dgen/v1/world_service_pb.js";
export type { World } from "../gen/d3dgen/v1/world_pb.js";

/** How a server is reached from Node. */
export interface NodeSettings extends Settings {
  /** Certificates (PEM) of an authority that the system does not trust. */
  ca?: string | Buffer;
}

/** Returns the services of a server: `connect("http://127.0.0.1:50051")`. */
export function connect(baseUrl: string, settings: NodeSettings = {}): Client {
  const nodeOptions = settings.ca ? { ca: settings.ca } : {};
  return new Client(createGrpcTransport({ baseUrl, nodeOptions, interceptors: interceptors(settings) }));
}
