// The services of a server over any transport, and the call that most programs begin with.

import { type Client as ServiceClient, createClient, type Interceptor, type Transport } from "@connectrpc/connect";

import { AdminService } from "../gen/d3dgen/v1/admin_service_pb.js";
import { AssetService } from "../gen/d3dgen/v1/asset_service_pb.js";
import { DomainService } from "../gen/d3dgen/v1/domain_service_pb.js";
import { JobService } from "../gen/d3dgen/v1/job_service_pb.js";
import { KnowledgeService } from "../gen/d3dgen/v1/knowledge_service_pb.js";
import { LibraryService } from "../gen/d3dgen/v1/library_service_pb.js";
import { ServerService } from "../gen/d3dgen/v1/server_service_pb.js";
import type { World } from "../gen/d3dgen/v1/world_pb.js";
import { type CheckedWorld, WorldService } from "../gen/d3dgen/v1/world_service_pb.js";

/** How a server is reached. */
export interface Settings {
  /** Token of the server, where it asks for one. */
  token?: string;
}

/** How far a world is. */
export interface Progress {
  /** Share of the work that is done, 0 to 1. */
  fraction: number;
  /** The stage that is under way: `scene_graph`, `floorplan`, `placement`, `scenario`, `world`. */
  stage: string;
}

/** What is asked for beside the sentence. */
export interface GenerateOptions {
  /** The same sentence and seed give the same world; 0 when absent. */
  seed?: number | bigint;
  /** Called as the work goes on. */
  onProgress?: (progress: Progress) => void;
  /** Gives the call up; work on the server stops too. */
  signal?: AbortSignal;
}

/** All services of a server, and `generate` and `archive` for what most programs do. */
export class Client {
  readonly worlds: ServiceClient<typeof WorldService>;
  readonly domains: ServiceClient<typeof DomainService>;
  readonly knowledge: ServiceClient<typeof KnowledgeService>;
  readonly assets: ServiceClient<typeof AssetService>;
  readonly jobs: ServiceClient<typeof JobService>;
  readonly library: ServiceClient<typeof LibraryService>;
  readonly server: ServiceClient<typeof ServerService>;
  readonly admin: ServiceClient<typeof AdminService>;

  constructor(transport: Transport) {
    this.worlds = createClient(WorldService, transport);
    this.domains = createClient(DomainService, transport);
    this.knowledge = createClient(KnowledgeService, transport);
    this.assets = createClient(AssetService, transport);
    this.jobs = createClient(JobService, transport);
    this.library = createClient(LibraryService, transport);
    this.server = createClient(ServerService, transport);
    this.admin = createClient(AdminService, transport);
  }

  /**
   * Makes a checked world of a sentence and returns it with its report.
   *
   * Throws a `ConnectError`: `InvalidArgument` with the place in the request, `FailedPrecondition` when no world meets it.
   */
  async generate(prompt: string, options: GenerateOptions = {}): Promise<CheckedWorld> {
    const request = { start: { case: "building" as const, value: { prompt, seed: BigInt(options.seed ?? 0) } } };
    let checked: CheckedWorld | undefined;
    for await (const { progress, event } of this.worlds.generateWorld(request, { signal: options.signal })) {
      if (progress) options.onProgress?.({ fraction: progress.fraction, stage: progress.stage });
      if (event.case === "world") checked = event.value;
    }
    if (!checked) throw new Error("the server ended the stream without a world");
    return checked;
  }

  /** Returns the pieces of the zip archive with the files of a world, to be written one after the other. */
  async *archive(world: World, formats: string[] = []): AsyncGenerator<Uint8Array> {
    for await (const { chunk } of this.worlds.exportWorld({ world, formats })) yield chunk;
  }
}

/** Returns what puts the token into each call. */
export function interceptors({ token }: Settings): Interceptor[] {
  if (!token) return [];
  return [
    (next) => (request) => {
      request.header.set("authorization", `Bearer ${token}`);
      return next(request);
    },
  ];
}
