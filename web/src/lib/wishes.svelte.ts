/** What a person asks for: the words as they were read, with what the person changed of it. */
import { create, equals } from "@bufbuild/protobuf";

import { type Ask, AskSchema, type Brief, BriefSchema, type Fact, ReadBy } from "../gen/d3dgen/v1/brief_pb";
import { worlds } from "./api";

const byPerson = (ask: Ask) => ask.readBy === ReadBy.PERSON;
const stated = (ask: Ask) => `${ask.fact?.kind.case} ${ask.words.map((w) => w.text).join(" ")}`;

async function read(prompt: string): Promise<Brief> {
  return (await worlds.generateBrief({ prompt })).brief ?? create(BriefSchema, { prompt });
}

/** Returns true for a brief that says what its prompt says, and nothing else. */
export async function isAsRead(brief: Brief): Promise<boolean> {
  return equals(BriefSchema, await read(brief.prompt), brief);
}

class Wishes {
  /** The facts as they are asked for; nothing before words were read. */
  brief = $state.raw<Brief | undefined>();
  /** Facts of the words that the person left out. */
  removed = $state.raw<Ask[]>([]);
  #newest = 0;
  /** Words on their way: who asks for the same waits for the same. */
  #reading: { prompt: string; done: Promise<void> } | undefined;

  /** True when the person asks for something else than the words say. */
  get areChanged(): boolean {
    return this.removed.length > 0 || (this.brief?.asks ?? []).some(byPerson);
  }

  /** Reads words; what the person changed of the words before stays changed. */
  read(prompt: string): Promise<void> {
    if (this.#reading?.prompt === prompt) return this.#reading.done;
    const done = this.#read(prompt).finally(() => {
      if (this.#reading?.done === done) this.#reading = undefined;
    });
    this.#reading = { prompt, done };
    return done;
  }

  async #read(prompt: string) {
    if (prompt === (this.brief?.prompt ?? "")) return;
    const turn = ++this.#newest;
    const now = prompt ? await read(prompt) : undefined;
    if (turn !== this.#newest) return;
    const before = { asks: this.brief?.asks ?? [], removed: this.removed };
    this.brief = now;
    this.removed = [];
    if (!now) return;
    for (const ask of before.removed) {
      const same = this.brief?.asks.find((a) => stated(a) === stated(ask));
      if (same) this.remove(same);
    }
    for (const ask of before.asks.filter(byPerson)) {
      const same = this.brief?.asks.find((a) => stated(a) === stated(ask));
      if (same && ask.fact) this.change(same, ask.fact);
      else if (ask.words.length === 0 && ask.fact) this.add(ask.fact);
    }
  }

  /** Takes the brief of a world that is opened. */
  async take(brief: Brief | undefined) {
    const turn = ++this.#newest;
    this.brief = brief;
    this.removed = [];
    if (!brief?.prompt) return;
    const said = await read(brief.prompt).catch(() => undefined);
    if (turn !== this.#newest || !said) return;
    const ids = new Set(brief.asks.map((ask) => ask.id));
    this.removed = said.asks.filter((ask) => !ids.has(ask.id));
  }

  /** Asks for another fact in the place of one. */
  change(ask: Ask, fact: Fact) {
    const changed = { ...ask, fact, readBy: ReadBy.PERSON };
    this.#set((asks) => asks.map((a) => (a.id === ask.id ? changed : a)));
  }

  /** Asks for something that no words say. */
  add(fact: Fact) {
    const taken = [...(this.brief?.asks ?? []), ...this.removed].map((a) => Number(/\d+$/.exec(a.id)?.[0] ?? 0));
    const id = `ask_${Math.max(0, ...taken) + 1}`;
    this.#set((asks) => [...asks, create(AskSchema, { id, fact, readBy: ReadBy.PERSON })]);
  }

  /** Leaves a fact out. */
  remove(ask: Ask) {
    this.#set((asks) => asks.filter((a) => a.id !== ask.id));
    if (ask.words.length > 0) this.removed = [...this.removed, ask];
  }

  /** Asks again for what was left out. */
  putBack(ask: Ask) {
    this.removed = this.removed.filter((a) => a.id !== ask.id);
    const first = (a: Ask) => a.words[0]?.start ?? Infinity;
    this.#set((asks) => [...asks, ask].sort((a, b) => first(a) - first(b)));
  }

  #set(next: (asks: Ask[]) => Ask[]) {
    if (this.brief) this.brief = { ...this.brief, asks: next(this.brief.asks) };
  }
}

export const wishes = new Wishes();
