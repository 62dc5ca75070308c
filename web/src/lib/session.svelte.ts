/** The work of a person: the world with its verdict, every state it went through, and what is being made. */
import { clone, create, fromBinary, toBinary } from "@bufbuild/protobuf";
import { Code } from "@connectrpc/connect";

import type { Floorplan } from "../gen/d3dgen/v1/floorplan_pb";
import { type KeptWorld, KeptWorldSchema } from "../gen/d3dgen/v1/library_service_pb";
import type { Placements } from "../gen/d3dgen/v1/placements_pb";
import { type Report, ReportSchema } from "../gen/d3dgen/v1/report_pb";
import type { Scenario } from "../gen/d3dgen/v1/scenario_pb";
import { type Clutter, type SceneGraph, SceneGraphSchema, StyleSchema } from "../gen/d3dgen/v1/scene_graph_pb";
import type { Brief } from "../gen/d3dgen/v1/brief_pb";
import { type World, WorldSchema } from "../gen/d3dgen/v1/world_pb";
import { type BuildingRequest, BuildingRequestSchema, type GenerateWorldRequest, type WorldEdit } from "../gen/d3dgen/v1/world_service_pb";
import { library, worlds } from "./api";
import { codeOf, isRefusal, learnTitles, reasonOf } from "./refusals";
import { keep, kept } from "./keep";
import { reasonIn } from "./problems";
import { ofDragged } from "./rules";
import { type TextKey, t } from "./texts.svelte";
import { isAsRead, wishes } from "./wishes.svelte";

/** A state of the world, and what made it. */
export interface Step {
  world: World;
  report: Report;
  label: string;
  /** Where the server keeps it. */
  home: Home;
  /** Number of the state there; 0 until the server has it. */
  revision: bigint;
}

/** A world of the server's library; states of one world share it. */
export interface Home {
  kept?: KeptWorld;
}

/** A world with its verdict and what made it. */
export type Made = Pick<Step, "world" | "report" | "label">;

/** How far a world is that is being made. */
interface Making {
  stage: string;
  fraction: number;
  world: World;
}

/** Something a person may do about a notice. */
export interface Action {
  label: string;
  act: () => void;
}

/** What the page has to say, and what a person may do about it. */
export interface Notice {
  text: string;
  actions: Action[];
}

type Start = GenerateWorldRequest["start"];
/** An edit as it is written: `{ case: "movedObject", value: { ... } }`. */
export type EditInit = { case: Exclude<WorldEdit["edit"]["case"], undefined>; value: unknown };

const KEPT = "session";
/** Wait before a server that did not answer is asked again, ms. */
const AGAIN = 1500;
/** Letters of the title of a kept world at most. */
const TITLE = 80;
/** States that undo can go back to. */
const STEPS = 100;

interface KeptSession {
  prompt: string;
  at: number;
  steps: { world: Uint8Array; report: Uint8Array; label: string; revision: bigint; home: number }[];
  homes: (Uint8Array | undefined)[];
}

class Session {
  prompt = $state("");
  /** What the person chose of the manner; empty for what the sentence says. */
  manner = $state({ clutter: "", space: "", layout: "", symmetry: "" });
  /** Kind of building that the person chose; empty for what the sentence says. */
  domainId = $state("");
  seed = $state(0);
  steps = $state.raw<Step[]>([]);
  at = $state(-1);
  making = $state.raw<Making | undefined>();
  /** World as it would be if what is dragged were let go here, and its verdict as soon as it is known. */
  preview = $state.raw<World | undefined>();
  previewReport = $state.raw<Report | undefined>();
  alternatives = $state.raw<Made[]>([]);
  /** How the server's copy stands. */
  saved = $state<"" | "saving" | "saved" | "waiting" | "conflict">("");
  /** True when the server lets this person keep worlds. */
  canKeep = $state(false);
  notice = $state.raw<Notice | undefined>();
  /** Reason of the last refusal: `UNKNOWN_BUILDING`. */
  refused = "";
  busy = $state(false);
  /** Ids of selected rooms, walls, doors and objects. */
  selected = $state.raw<string[]>([]);
  level = $state(0);
  #stop: AbortController | undefined;
  #checking = false;
  /** Worlds whose verdict is of rules that have changed since. */
  #judgedBefore = new Set<World>();
  #turn: Promise<void> = Promise.resolve();

  /** The world with its verdict, once there is one. */
  get step(): Step | undefined {
    return this.steps[this.at];
  }

  /** The world to show: being dragged, being made, or as it is. */
  get shown(): World | undefined {
    return this.preview ?? this.making?.world ?? this.step?.world;
  }

  /** The newest verdict on what is shown. */
  get report(): Report | undefined {
    return (this.preview && this.previewReport) ?? this.step?.report;
  }

  get canUndo(): boolean {
    return this.at > 0;
  }

  get canRedo(): boolean {
    return this.at + 1 < this.steps.length;
  }

  undo() {
    if (this.canUndo) this.#go(this.at - 1);
  }

  redo() {
    if (this.canRedo) this.#go(this.at + 1);
  }

  #go(at: number) {
    this.at = at;
    this.endPreview();
    this.notice = undefined;
    this.#save();
    this.#judgeAgain().catch((error: unknown) => this.say(reasonOf(error)));
  }

  /** Adds a state behind the present one; what was undone is gone. */
  push(made: Made, home: Home = this.step?.home ?? {}, revision = 0n) {
    learnTitles(made.report.rules);
    this.steps = [...this.steps.slice(0, this.at + 1), { ...made, home, revision }].slice(-STEPS);
    this.at = this.steps.length - 1;
    this.endPreview();
    this.#save();
  }

  say(text: string, ...actions: Action[]) {
    this.notice = { text, actions };
  }

  /** Has browser and server keep the present state, one change after the other. */
  #save() {
    void this.#keep();
    const step = this.step;
    if (!step || !this.canKeep) return;
    this.saved = "saving";
    this.#turn = this.#turn.then(async () => {
      // a state that was left again before its turn came is not worth keeping
      if (step !== this.step) return;
      this.saved = await this.#hand(step);
      await this.#keep();
    });
  }

  async #hand(step: Step): Promise<typeof this.saved> {
    try {
      await put(step);
      return "saved";
    } catch (error) {
      switch (codeOf(error)) {
        case Code.Aborted:
          this.say(
            t("conflict.about"),
            { label: t("conflict.theirs"), act: () => void this.#theirs(step) },
            { label: t("conflict.mine"), act: () => void this.#mine(step) },
          );
          return "conflict";
        case Code.NotFound:
          step.home.kept = undefined;
          step.revision = 0n;
          return this.#hand(step);
        case Code.Unavailable:
        case Code.Unknown:
          setTimeout(() => step === this.step && this.#save(), AGAIN);
          return "waiting";
        default:
          this.say(reasonOf(error));
          return "";
      }
    }
  }

  /** Takes up the state that somebody else made of this world. */
  async #theirs(step: Step) {
    const worldId = step.home.kept?.worldId;
    if (worldId) await this.open(worldId, step.home);
  }

  /** Puts the state of here behind the one that somebody else made. */
  async #mine(step: Step) {
    const worldId = step.home.kept?.worldId ?? "";
    this.notice = undefined;
    try {
      step.home.kept = (await library.getWorld({ worldId })).kept;
      step.revision = 0n;
      this.#save();
    } catch (error) {
      this.say(reasonOf(error));
    }
  }

  /** Takes a world that was not made of the words at hand; its own are at hand from now on. */
  takeUp(made: Made) {
    this.#take(made.world);
    this.push(made, {});
  }

  #take(world: World) {
    this.prompt = world.brief?.prompt ?? world.sceneGraph?.prompt ?? "";
    this.selected = [];
    this.domainId = "";
    void wishes.take(world.brief);
  }

  /** Opens a world of the server's library. */
  async open(worldId: string, home: Home = {}): Promise<boolean> {
    this.notice = undefined;
    try {
      const { kept, world: found } = await library.getWorld({ worldId });
      const { world, report } = found ?? {};
      if (!kept || !world || !report) return false;
      home.kept = kept;
      this.#take(world);
      this.push({ world, report, label: t("open.did") }, home, kept.revision);
      return true;
    } catch (error) {
      this.say(reasonOf(error));
      return false;
    }
  }

  /**
   * Makes a world of the prompt, one stage after the other; returns true when there is one. What contradicts itself is
   * refused unless it is `allowed`; `refused` says why there is none.
   */
  async generate(allowed = false): Promise<boolean> {
    return await this.#make(async () => ({ case: "building", value: await this.asked() }), t("made"), {}, undefined, allowed);
  }

  /** Returns what is asked for: the words at hand with what was changed of them, in the manner and variant that were chosen. */
  async asked(): Promise<BuildingRequest> {
    const prompt = this.prompt.trim();
    const seed = BigInt(Math.max(0, Math.trunc(this.seed || 0)));
    await wishes.read(prompt);
    return this.#building(prompt, seed, wishes.areChanged ? wishes.brief : undefined);
  }

  #building(prompt: string, seed: bigint, brief?: Brief): BuildingRequest {
    const { clutter, ...styles } = this.manner;
    const value = { prompt, brief, seed, domainId: this.domainId || undefined, clutter: clutter || undefined, styles: Object.values(styles).filter(Boolean) };
    return create(BuildingRequestSchema, value);
  }

  /** Returns the start of a world like another one, with another seed. */
  async #like(world: World, seed: bigint): Promise<Start> {
    const graph = clone(SceneGraphSchema, world.sceneGraph as SceneGraph);
    graph.seed = seed;
    const { brief } = world;
    const prompt = brief?.prompt ?? graph.prompt;
    // of words alone, the stages are free to find other rooms; what is locked needs the rooms as they are
    if (hasLocks(world) || (!prompt && !brief)) return { case: "sceneGraph", value: graph };
    const isSaid = !brief || (await isAsRead(brief));
    return { case: "building", value: this.#building(prompt, seed, isSaid ? undefined : brief) };
  }

  /** Furnishes a plan that the person brought, as it is; `companions` are files that it names. Returns true when there is a world. */
  async bring(fileName: string, content: Uint8Array, companions: Record<string, Uint8Array>): Promise<boolean> {
    this.notice = undefined;
    try {
      const { sceneGraph, floorplan } = await worlds.importFloorplan({ fileName, content, companions, addDoors: true });
      if (!sceneGraph || !floorplan) return false;
      this.prompt = "";
      return await this.#make(async () => ({ case: "sceneGraph", value: sceneGraph }), fileName, {}, create(WorldSchema, { sceneGraph, floorplan }));
    } catch (error) {
      this.say(reasonOf(error));
      return false;
    }
  }

  /** Makes the world anew with another seed; what is locked stays. */
  async another() {
    const world = this.step?.world;
    if (!world?.sceneGraph) return;
    const seed = world.sceneGraph.seed + 1n;
    await this.#make(() => this.#like(world, seed), t("another"), this.step?.home, world);
  }

  /** Plans rooms that the person put otherwise; what is locked stays. Returns true when there is a world. */
  async replan(graph: SceneGraph, label: string): Promise<boolean> {
    return await this.#make(async () => ({ case: "sceneGraph", value: graph }), label, this.step?.home, this.step?.world);
  }

  /** Furnishes all rooms anew with more or fewer everyday things; the plan stays, and so does what is locked. Returns true when there is a world. */
  async clutter(amount: Clutter, label: string): Promise<boolean> {
    const world = this.step?.world;
    const plan = world?.floorplan;
    if (!world?.sceneGraph || !plan) return false;
    const graph = clone(SceneGraphSchema, world.sceneGraph);
    graph.style = create(StyleSchema, { ...graph.style, clutter: amount });
    const whole = { ...world, floorplan: { ...plan, rooms: plan.rooms.map((room) => ({ ...room, locked: true })) } };
    const made = await this.#run(async () => ({ case: "sceneGraph", value: graph }), label, whole);
    if (!made?.world.floorplan) return false;
    // the plan was held for this one time
    this.push({ ...made, world: { ...made.world, floorplan: freed(made.world.floorplan, plan) } });
    return true;
  }

  /** Makes three worlds with seeds of their own to choose from. */
  async three() {
    const world = this.step?.world;
    if (!world?.sceneGraph) return;
    const { seed } = world.sceneGraph;
    const found: Made[] = [];
    for (let more = 1n; more <= 3n && !this.#stop?.signal.aborted; more++) {
      const step = await this.#run(() => this.#like(world, seed + more), t("alternative"), world);
      if (!step) break;
      found.push(step);
      this.alternatives = [...found];
    }
  }

  /** Takes one of the alternatives. */
  choose(made: Made) {
    this.alternatives = [];
    this.push(made);
  }

  async #make(start: () => Promise<Start>, label: string, home?: Home, pinned?: World, allowed = false): Promise<boolean> {
    this.alternatives = [];
    this.selected = [];
    const made = await this.#run(start, label, pinned, allowed);
    if (made) {
      this.level = 0;
      this.push(made, home);
    }
    return made !== undefined;
  }

  async #run(start: () => Promise<Start>, label: string, pinned?: World, allowConflicts = false): Promise<Made | undefined> {
    this.#stop?.abort();
    const stop = new AbortController();
    this.#stop = stop;
    this.notice = undefined;
    this.refused = "";
    const world = create(WorldSchema, {});
    this.making = { stage: "scene_graph", fraction: 0, world };
    const pins = pinned && hasLocks(pinned);
    try {
      const request = {
        start: await start(),
        allowConflicts,
        pinnedFloorplan: pins ? pinned.floorplan : undefined,
        pinnedPlacements: pins ? pinned.placements : undefined,
      };
      for await (const news of worlds.generateWorld(request, { signal: stop.signal })) {
        if (news.event.case === "world" && news.event.value.world && news.event.value.report) {
          return { world: news.event.value.world, report: news.event.value.report, label };
        }
        this.making = {
          stage: news.progress?.stage ?? "",
          fraction: news.progress?.fraction ?? 0,
          world: withPart(this.making.world, news.event),
        };
      }
    } catch (error) {
      if (!stop.signal.aborted) {
        this.refused = reasonIn(error).reason;
        this.say(reasonOf(error));
      }
    } finally {
      if (this.#stop === stop) this.making = undefined;
    }
    return undefined;
  }

  /** Gives up what is being made. */
  cancel() {
    this.#stop?.abort();
    this.making = undefined;
  }

  /** Shows a world that is not there yet, and has it judged; the last one wins while verdicts are on their way. */
  show(world: World) {
    this.preview = world;
    if (!this.#checking) void this.#judge();
  }

  /** Has the present state judged by the rules as they are now; the others are when somebody goes back to them. */
  async rejudge() {
    this.#judgedBefore = new Set(this.steps.map((step) => step.world));
    await this.#judgeAgain();
  }

  async #judgeAgain() {
    const step = this.step;
    if (!step || !this.#judgedBefore.has(step.world)) return;
    const { report } = await worlds.checkWorld({ world: step.world });
    const at = this.steps.indexOf(step);
    if (!report || at < 0) return;
    this.#judgedBefore.delete(step.world);
    this.steps = this.steps.with(at, { ...step, report });
    this.#save();
  }

  async #judge() {
    this.#checking = true;
    let judged: World | undefined;
    try {
      while (this.preview && this.preview !== judged) {
        judged = this.preview;
        const answer = await worlds.checkWorld({ world: judged });
        if (this.preview) this.previewReport = ofDragged(answer.report);
      }
    } catch (error) {
      if (!isRefusal(error)) this.say(reasonOf(error));
    } finally {
      this.#checking = false;
    }
  }

  endPreview() {
    this.preview = undefined;
    this.previewReport = undefined;
  }

  /**
   * Carries out edits as one step. Where no repair keeps the rules, offers to do `instead` all the same, which shows what
   * it breaks.
   */
  async edit(edits: EditInit[], label: string, instead?: World): Promise<boolean> {
    const step = this.step;
    if (!step) return false;
    this.busy = true;
    this.notice = undefined;
    try {
      const answer = await worlds.editWorld({ world: step.world, edits: edits.map((edit) => ({ edit: edit as never })) });
      const { world, report } = answer.world ?? {};
      if (!world || !report) return false;
      this.push({ world, report, label });
      return true;
    } catch (error) {
      this.endPreview();
      const anyway = instead && { label: t("anyway"), act: () => void this.replace(instead, label) };
      this.say(reasonOf(error, step.world), ...(anyway && isRefusal(error) ? [anyway] : []));
      return false;
    } finally {
      this.busy = false;
    }
  }

  /** Carries out edits as part of the last step; where they cannot be, that step stays as it is. */
  async amend(edits: EditInit[]) {
    const last = this.step;
    if (!last) return;
    this.busy = true;
    try {
      const answer = await worlds.editWorld({ world: last.world, edits: edits.map((edit) => ({ edit: edit as never })) });
      const { world, report } = answer.world ?? {};
      if (!world || !report || this.step !== last) return;
      this.steps = this.steps.with(this.at, { ...last, world, report, revision: 0n });
      this.#save();
    } catch (error) {
      if (!isRefusal(error)) this.say(reasonOf(error));
    } finally {
      this.busy = false;
    }
  }

  /** Takes a world as it is, whatever it breaks, with its verdict. */
  async replace(world: World, label: string): Promise<boolean> {
    this.notice = undefined;
    this.busy = true;
    try {
      const { report } = await worlds.checkWorld({ world });
      if (report) this.push({ world, report, label });
      return report !== undefined;
    } catch (error) {
      this.endPreview();
      this.say(reasonOf(error));
      return false;
    } finally {
      this.busy = false;
    }
  }

  async #keep() {
    const homes = [...new Set(this.steps.map((step) => step.home))];
    const steps = this.steps.map(({ world, report, label, revision, home }) => ({
      world: toBinary(WorldSchema, world),
      report: toBinary(ReportSchema, report),
      label,
      revision,
      home: homes.indexOf(home),
    }));
    const kept = homes.map((home) => home.kept && toBinary(KeptWorldSchema, home.kept));
    await keep(KEPT, { prompt: this.prompt, at: this.at, steps, homes: kept } satisfies KeptSession);
  }

  /** Takes up the work of the last visit; returns true when there is some. */
  async restore(): Promise<boolean> {
    const last = await kept<KeptSession>(KEPT);
    if (!last || this.steps.length > 0) return false;
    this.prompt = last.prompt;
    const homes = last.homes.map((kept): Home => ({ kept: kept && fromBinary(KeptWorldSchema, kept) }));
    this.steps = last.steps.map(({ world, report, label, revision, home }) => ({
      world: fromBinary(WorldSchema, world),
      report: fromBinary(ReportSchema, report),
      label,
      revision,
      home: homes[home] ?? {},
    }));
    this.at = Math.min(last.at, this.steps.length - 1);
    const brief = this.step?.world.brief;
    if (brief && brief.prompt === this.prompt) void wishes.take(brief);
    return this.step !== undefined;
  }
}

export const session = new Session();

/** Has the server keep a state: a new world, a new state of one, or one that it has already. */
async function put(step: Step) {
  const { world, label, home } = step;
  const kept = home.kept;
  if (!kept) {
    home.kept = (await library.createWorld({ world, label, title: titleOf(world) })).kept;
  } else if (step.revision === 0n) {
    home.kept = (await library.updateWorld({ worldId: kept.worldId, etag: kept.etag, world, label })).kept;
  } else if (step.revision !== kept.revision) {
    const asked = { worldId: kept.worldId, etag: kept.etag, revision: step.revision };
    home.kept = (await library.restoreWorld(asked)).kept;
  }
  step.revision = home.kept?.revision ?? 0n;
}

function titleOf(world: World): string {
  const said = Array.from(world.brief?.prompt || world.name);
  if (said.length <= TITLE) return said.join("");
  const cut = said.slice(0, TITLE).join("");
  return `${cut.slice(0, cut.lastIndexOf(" ") > 0 ? cut.lastIndexOf(" ") : undefined)}…`;
}

function hasLocks(world: World): boolean {
  const plan = world.floorplan;
  const parts = [plan?.rooms, plan?.walls, plan?.doors, plan?.windows, world.placements?.placements];
  return parts.some((all) => all?.some((part) => part.locked));
}

/** Returns a plan in which only those rooms are locked that were so before. */
function freed(plan: Floorplan, before: Floorplan): Floorplan {
  const locked = new Set(before.rooms.filter((room) => room.locked).map((room) => room.roomId));
  return { ...plan, rooms: plan.rooms.map((room) => ({ ...room, locked: locked.has(room.roomId) })) };
}

/** Returns a world with what a stage has made. */
function withPart(world: World, event: { case?: string; value?: unknown }): World {
  switch (event.case) {
    case "sceneGraph":
      return { ...world, sceneGraph: event.value as SceneGraph };
    case "floorplan":
      return { ...world, floorplan: event.value as Floorplan, placements: undefined, scenario: undefined };
    case "placements":
      return { ...world, placements: merged(world.placements, event.value as Placements) };
    case "scenario":
      return { ...world, scenario: event.value as Scenario };
    default:
      return world;
  }
}

/** Returns placements with those of another room, or all of them, put in. */
function merged(before: Placements | undefined, news: Placements): Placements {
  if (!before) return news;
  const rooms = new Set(news.placements.map((p) => p.roomId));
  return { ...news, placements: [...before.placements.filter((p) => !rooms.has(p.roomId)), ...news.placements] };
}

/** Returns the name of a stage in the reader's language. */
export function stageName(stage: string): string {
  const key = `stage.${stage}`;
  return t((key in STAGE_KEYS ? key : "stage.other") as TextKey);
}

const STAGE_KEYS: Record<string, true> = {
  "stage.scene_graph": true,
  "stage.floorplan": true,
  "stage.placement": true,
  "stage.scenario": true,
  "stage.world": true,
};
