// For web pages: gRPC-Web; the server has to allow the page's origin (`cors_origins`).

import { createGrpcWebTransport } from "@connectrpc/connect-web";

import { Client, interceptors, type Settings } from "./client.js";

export * from "./client.js";
export type { CheckedWorld } from "../gen/d3dgen/v1/world_service_pb.js";
export type { World } from "../gen/d3dgen/v1/world_pb.js";

/** Returns the services of a server: `connect("https://worlds.example.org")`. */
export function connect(baseUrl: string, settings: Settings = {}): Client {
  return new Client(createGrpcWebTransport({ baseUrl, interceptors: interceptors(settings) }));
}
