/** What rooms, things, people and rules are called in the reader's language: in the words of the page, else in those of the domain. */
import { domains } from "./api";
import { type Kind, kindsOf } from "./kinds";
import { inWords, type Patterns, type Speaker } from "./sentences";
import { figure, t, texts, words } from "./texts.svelte";
import { patternsOf, type Subject, type Wording, wordingOf } from "./wording";

/** What is called by its kind and a number where nobody gave it a name. */
const NUMBERED = /^(.*?)[ _](\d+)$/;
const PARTS = { door: "part.door", wall: "part.wall", window: "part.window" } as const;

/** Returns the kinds of rooms with these ids, of whichever domain has them. */
async function lent(ids: string[]): Promise<Kind[]> {
  if (ids.length === 0) return [];
  const all = (await domains.listDomains({})).domains;
  const kinds = await Promise.all(all.map(({ domainId }) => kindsOf(domainId)));
  return kinds.flatMap(({ room }) => room.filter(({ id }) => ids.includes(id)));
}

class Names {
  #kinds = $state.raw(new Map<string, string>());
  /** English names of kinds of rooms, which rooms are called by. */
  #labels = $state.raw(new Map<string, string>());
  /** Kinds of rooms by their English names, in small letters. */
  #labelled = new Map<string, string>();
  #wording = $state.raw<Wording | undefined>();
  #patterns = $state.raw<Patterns>([]);

  /** Learns what things are called: the kinds of a domain too, and of those kinds of rooms that others lend it. */
  async learn(domainId: string | undefined, roomTypes: string[]) {
    const language = texts.language;
    if (language === "en") {
      this.#kinds = this.#labels = new Map();
      this.#wording = undefined;
      this.#patterns = [];
      return;
    }
    const none = { room: [], object: [] };
    const [kinds, wording, patterns] = await Promise.all([domainId ? kindsOf(domainId) : none, wordingOf(language), patternsOf(language)]);
    const own = new Set(kinds.room.map(({ id }) => id));
    const rooms = [...(await lent(roomTypes.filter((id) => !own.has(id)))), ...kinds.room];
    if (language !== texts.language) return;
    this.#kinds = new Map([...rooms, ...kinds.object].map(({ id, name }) => [id, name]));
    this.#labels = new Map(rooms.map(({ id, label }) => [id, label]));
    this.#labelled = new Map(rooms.map(({ id, label }) => [label.toLowerCase(), id]));
    this.#wording = wording;
    this.#patterns = patterns;
  }

  /** Returns a sentence of the server in the reader's language; in English where nobody has said how it goes. */
  sentence(text: string): string {
    return inWords(text, this.#patterns, this.#speaker) ?? text;
  }

  #speaker: Speaker = {
    figure: (value) => figure(value),
    named: (name) => this.english(name),
    quoted: (said) => t("said.quoted", { said: this.english(said) }),
    listed: (all, more) => (more > 0 ? [...all, t("said.more", { n: more })].join(", ") : all.join(", ")),
  };

  /** Returns what a room or thing with an English name, or with an id, is called; the name itself where that is not known. */
  english(name: string): string {
    const [, kind = name, number = ""] = NUMBERED.exec(name) ?? [];
    const known = this.#kindOf(kind) ?? this.#kindOf(kind.replace(/s$/, ""));
    return known ? `${known} ${number}`.trim() : name;
  }

  #kindOf(name: string): string | undefined {
    const id = name.toLowerCase().replaceAll(" ", "_");
    const room = this.#labelled.get(name.toLowerCase());
    return (room && this.of(room)) ?? this.#kinds.get(id) ?? this.#said("rooms", id) ?? this.#said("objects", id) ?? this.#said("robots", id) ?? this.#said("buildings", id);
  }

  /** Returns the name of a kind of room or thing; its id in words until it is known. */
  of(id: string): string {
    return this.#kinds.get(id) ?? this.#said("objects", id) ?? this.#said("rooms", id) ?? words(id);
  }

  /** Returns the name of a room: the one that somebody gave it, or that of its kind with its number. */
  room({ roomType, name }: { roomType: string; name: string }): string {
    const [, kind = name, number = ""] = NUMBERED.exec(name) ?? [];
    const label = this.#labels.get(roomType) ?? words(roomType);
    if (!this.#wording || kind.toLowerCase() !== label.toLowerCase()) return name;
    return `${this.of(roomType)} ${number}`.trim();
  }

  /** Returns what a robot, a person, or a door, wall or window is called: its kind with its number. */
  one(id: string): string {
    const [, kind = id, number = ""] = NUMBERED.exec(id) ?? [];
    if (kind in PARTS) return t(PARTS[kind as keyof typeof PARTS], { number });
    const name = this.#said("roles", kind) ?? this.#said("robots", kind.replace(/_robot$/, ""));
    return name ? `${name} ${number}`.trim() : words(id);
  }

  /** Returns who people of a role are. */
  role(id: string): string {
    return this.#said("roles", id) ?? words(id);
  }

  /** Returns what kind of building a domain is for, and what that is about. */
  building({ domainId, title, description }: { domainId: string; title: string; description: string }): { title: string; about: string } {
    return { title: this.#said("buildings", domainId) ?? title, about: this.#said("about", domainId) ?? description };
  }

  /** Returns what a hard rule demands, in the reader's language where that is known. */
  rule(id: string, title = words(id)): string {
    return this.#said("rules", id) ?? title;
  }

  /** Returns what a rule measures. */
  measure(id: string): string {
    return this.#said("measures", id) ?? words(id);
  }

  /** True where the server's English sentences are another language than the reader's. */
  get areTranslated(): boolean {
    return this.#wording !== undefined;
  }

  #said(subject: Subject, id: string): string | undefined {
    return this.#wording?.[subject][id];
  }
}

export const names = new Names();
