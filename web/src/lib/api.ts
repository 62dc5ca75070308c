/** Calls of the server: clients of the contract, and the token. */
import { Code, ConnectError, createClient, type Interceptor } from "@connectrpc/connect";
import { createGrpcWebTransport } from "@connectrpc/connect-web";

import { AssetService } from "../gen/d3dgen/v1/asset_service_pb";
import { DomainService } from "../gen/d3dgen/v1/domain_service_pb";
import { JobService } from "../gen/d3dgen/v1/job_service_pb";
import { KnowledgeService } from "../gen/d3dgen/v1/knowledge_service_pb";
import { LibraryService } from "../gen/d3dgen/v1/library_service_pb";
import { ServerService } from "../gen/d3dgen/v1/server_service_pb";
import { WorldService } from "../gen/d3dgen/v1/world_service_pb";
import { access } from "./access.svelte";

/** Sends the token, and asks the person for one when the server wants another. */
const withToken: Interceptor = (next) => async (request) => {
  for (;;) {
    const used = access.token;
    if (used) request.header.set("authorization", `Bearer ${used}`);
    try {
      return await next(request);
    } catch (error) {
      if (ConnectError.from(error).code !== Code.Unauthenticated || request.stream) throw error;
      await access.ask(used);
    }
  }
};

const transport = createGrpcWebTransport({ baseUrl: location.origin, interceptors: [withToken] });

export const server = createClient(ServerService, transport);
export const worlds = createClient(WorldService, transport);
export const assets = createClient(AssetService, transport);
export const domains = createClient(DomainService, transport);
export const knowledge = createClient(KnowledgeService, transport);
export const library = createClient(LibraryService, transport);
export const jobs = createClient(JobService, transport);

/** Returns the archive that a call sends in pieces; `told` hears how many bytes there are so far. */
export async function gathered(pieces: AsyncIterable<{ chunk: Uint8Array }>, told: (bytes: number) => void = () => {}): Promise<Blob> {
  const all: Uint8Array<ArrayBuffer>[] = [];
  let size = 0;
  for await (const { chunk } of pieces) {
    all.push(new Uint8Array(chunk));
    told((size += chunk.length));
  }
  return new Blob(all, { type: "application/zip" });
}
